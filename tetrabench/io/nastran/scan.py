"""The loop over the cards of a file: GRID and CTETRA go into a `Deck`, the places of what is rarer too."""

from typing import Any, NamedTuple

import numpy as np

from tetrabench.io.nastran.cards import (
    BLANK,
    COMMA,
    CONTINUATION,
    CTETRA,
    CUT,
    DANGLING,
    EQUALS,
    EXACT,
    GRID,
    INCOMPLETE,
    INTEGER,
    MALFORMED,
    MOST_FIELDS,
    NEWLINE,
    NOTHING,
    REAL,
    REPLICATED,
    SYSTEM,
    Bytes,
    Integers,
    Reals,
    eight_bytes,
    kind_of,
    line_end,
    line_kind,
    parse_eight,
    parse_integer,
    parse_real,
    split_card,
    trimmed,
    word_end,
)
from tetrabench.jit import kernel

GRDSET, INCLUDE = map(kind_of, ("GRDSET", "INCLUDE"))
BEGIN, ENDDATA, END, BULK = map(kind_of, ("BEGIN", "ENDDATA", "END", "BULK"))
CORD = {kind_of(f"CORD{number}{form}"): (number, form) for number in (1, 2) for form in "RCS"}
CORD1R, CORD1C, CORD1S, CORD2R, CORD2C, CORD2S = CORD

# Why `scan` stops before the end, beside the reasons against a card.
NO_ROOM, NO_TEXT, AT_INCLUDE = 101, 102, 103

# Places in Deck.state.
POSITION, LAST, BEGUN, ENDED, DEFAULT_SYSTEM, QUADRATIC = range(6)
POINTS, TETS, HARD, LOOSE, CORDS, NAMES = range(6, 12)

GRDSET_SYSTEM = -1  # of a point whose field 3 is blank
FULL_NAMES = 256
OTHERS = 0  # the kind of all cards of rarer names, where there are too many names
EXTRA = 8  # rows that one card may take
POINT_FIELDS, TETRA_FIELDS = 5, 6  # that a GRID and a CTETRA must have
RETURN = 13
LONGEST_PLAIN = 8 + 8 + 6 * 16 + 2 * 8  # bytes of a card in large field, with room for ends of lines and a word
SMALL_CTETRA, LARGE_CTETRA, SMALL_GRID, LARGE_GRID, BARE_STAR = (
    np.uint64(int.from_bytes(name.ljust(8), "little")) for name in (b"CTETRA", b"CTETRA*", b"GRID", b"GRID*", b"*")
)
BLANKS = np.uint64(int.from_bytes(b" " * 8, "little"))
CTETRA_BEGINS, GRID_BEGINS = b"CG"
NOT_PLAIN = -2  # instead of the number of a coordinate system


class Deck(NamedTuple):
    """What `scan` finds. Every array has more room than it needs; `state` says how far each is filled.

    A place is a byte of all files read so far, one after the other: see `base` of `scan`.

    Attributes:
        points: (room, 3) float64, coordinates, in the system of each point.
        point_ids: (room,) int64.
        point_places: (room,) int64, first byte of the card.
        systems: (room,) int64, coordinate system of each point, GRDSET_SYSTEM where it is blank.
        tets: (room, 4) int64, ids of the corner nodes.
        tet_ids: (room,) int64.
        tet_places: (room,) int64, first byte of the card.
        hard: (room, 3) int64, numbers left to `parse_hard`: index in points.ravel(), first byte, end.
        loose: (room, 6) int64, continuations that stand elsewhere: first byte and end of the name that a card asks
            for, first byte and kind of the card, its row, how many fields there are of it; or for a line that
            belongs to no card above it, its first byte and zeros.
        cords: (room, 2) int64, kind and first byte of the cards of coordinate systems.
        names: (FULL_NAMES, 2) int64, kinds of the other cards and how many there are.
        state: (12,) int64, where the scan is, and how far the arrays are filled.
        fields: (MOST_FIELDS, 2) int64, the fields of the card at hand: see `split_card`.
        wrong: (2,) int64, first byte and end of the field, or of nothing in the line, for which a card is
            refused.
    """

    points: Reals
    point_ids: Integers
    point_places: Integers
    systems: Integers
    tets: Integers
    tet_ids: Integers
    tet_places: Integers
    hard: Integers
    loose: Integers
    cords: Integers
    names: Integers
    state: Integers
    fields: Integers
    wrong: Integers


def empty_deck(room: int) -> Deck:
    """Allocate a deck for about so many cards; what is never touched costs no memory."""
    return Deck(
        points=np.empty((room, 3), np.float64),
        point_ids=np.empty(room, np.int64),
        point_places=np.empty(room, np.int64),
        systems=np.empty(room, np.int64),
        tets=np.empty((room, 4), np.int64),
        tet_ids=np.empty(room, np.int64),
        tet_places=np.empty(room, np.int64),
        hard=np.empty((room, 3), np.int64),
        loose=np.zeros((room, 6), np.int64),
        cords=np.empty((room, 2), np.int64),
        names=np.zeros((FULL_NAMES, 2), np.int64),
        state=np.zeros(12, np.int64),
        fields=np.zeros((MOST_FIELDS, 2), np.int64),
        wrong=np.zeros(2, np.int64),
    )


def roomier(deck: Deck) -> Deck:
    """The same deck, with twice the room in each array that is nearly full."""
    filled = {
        POINTS: ("points", "point_ids", "point_places", "systems"),
        TETS: ("tets", "tet_ids", "tet_places"),
        HARD: ("hard",),
        LOOSE: ("loose",),
        CORDS: ("cords",),
    }
    larger = {}
    for place, names in filled.items():
        count = int(deck.state[place])
        for name in names:
            array = getattr(deck, name)
            if count + EXTRA > len(array):
                larger[name] = np.empty((2 * len(array) + EXTRA, *array.shape[1:]), array.dtype)
                larger[name][:count] = array[:count]
    return deck._replace(**larger)


@kernel
def scan(text: Bytes, base: int, whole: bool, deck: Deck) -> int:
    """Go through the cards of a window of a file from `deck.state[POSITION]` on, and fill the deck.

    Args:
        text: the window, which begins at the beginning of a line.
        base: the place of its first byte.
        whole: whether the file ends with it; else the scan stops before a card that might go on beyond it.
        deck: in and out.

    Returns:
        0 at the end, NO_ROOM where the deck needs more room, NO_TEXT where the window must move on, AT_INCLUDE, each
        with POSITION at the next card; or the reason why a card is refused, with its place in `deck.wrong`.
    """
    point_ids, point_places, coordinates = deck.point_ids, deck.point_places, deck.points
    systems, tet_ids, tet_places, corners = deck.systems, deck.tet_ids, deck.tet_places, deck.tets
    hard_numbers, loose_ones, cards_of_systems = deck.hard, deck.loose, deck.cords
    state, fields, wrong = deck.state, deck.fields, deck.wrong
    points, tets, hard, loose, cords = state[POINTS], state[TETS], state[HARD], state[LOOSE], state[CORDS]
    position, last, quadratic = state[POSITION], state[LAST], state[QUADRATIC]
    most_points, most_tets = len(point_ids) - EXTRA, len(tet_ids) - EXTRA
    most_hard, most_loose, most_cords = (
        len(hard_numbers) - EXTRA,
        len(loose_ones) - EXTRA,
        len(cards_of_systems) - EXTRA,
    )
    known_end = text.size if whole else text.size - LONGEST_PLAIN
    reason, ended = 0, False
    while position < text.size and reason == 0 and not ended:
        place = position
        if points > most_points or tets > most_tets or hard > most_hard or loose > most_loose or cords > most_cords:
            reason = NO_ROOM
            break
        if place >= known_end:
            reason = NO_TEXT
            break
        position = take_plain_tetra(text, place, tet_ids, corners, tets)
        if position > place:
            tet_places[tets] = base + place
            tets, last = tets + 1, CTETRA
            continue
        position = take_plain_point(text, place, point_ids, systems, coordinates, points)
        if position > place:
            point_places[points] = base + place
            points, last = points + 1, GRID
            continue

        kind, count = line_kind(text, place), 0
        if kind == CTETRA or kind == GRID or kind == GRDSET:
            reason, count, position = split_card(text, place, fields, wrong)
        elif kind != INCLUDE:
            position = line_end(text, place) + 1
        if not whole and position >= known_end:
            position, reason = place, NO_TEXT
            break
        dangling = reason == DANGLING
        if kind == CTETRA:
            if dangling:
                loose, reason = note_lost(loose_ones, loose, wrong, base, place, kind, tets, count), 0
            if reason == 0 and count < TETRA_FIELDS:
                reason = 0 if dangling else DANGLING
            elif reason == 0:
                quadratic += count > TETRA_FIELDS and fields[TETRA_FIELDS, 0] < fields[TETRA_FIELDS, 1]
                reason = take_tetra(text, fields, count, tet_ids, corners, tets, wrong)
            tet_places[tets] = base + place
            tets += 1
        elif kind == GRID:
            cut = position >= text.size and text[text.size - 1] != NEWLINE
            if dangling:
                loose, reason = note_lost(loose_ones, loose, wrong, base, place, kind, points, count), 0
            if reason == 0 and count < POINT_FIELDS:
                reason = 0 if dangling else DANGLING
            elif reason == 0:
                reason = take_point(text, fields, cut, point_ids, systems, coordinates, points, wrong)
                for k in range(3):
                    if reason == 0 and np.isnan(coordinates[points, k]):
                        hard_numbers[hard, 0] = 3 * points + k
                        hard_numbers[hard, 1] = base + fields[2 + k, 0]
                        hard_numbers[hard, 2] = base + fields[2 + k, 1]
                        hard += 1
            point_places[points] = base + place
            points += 1
        elif kind == GRDSET:  # the defaults of all GRIDs
            reason = 0 if dangling else reason
            system = parse_integer(text, fields[1, 0], fields[1, 1]) if fields[1, 0] < fields[1, 1] else 0
            if reason == 0 and system < 0:
                reason = at_field(fields, 1, wrong, SYSTEM)
            state[DEFAULT_SYSTEM] = system
        elif is_cord(kind):
            cards_of_systems[cords, 0], cards_of_systems[cords, 1] = kind, base + place
            cords += 1
        elif kind == ENDDATA or (kind == END and second_word(text, place) == BULK):
            ended = True
        elif kind == INCLUDE or kind >> 8 == INCLUDE:  # a quote may follow at once
            position, reason = place, AT_INCLUDE
        elif kind == BEGIN:  # so far it was executive and case control
            state[BEGUN], state[NAMES] = 1, 0
        elif (last == GRID or last == CTETRA) and text[place] == EQUALS:
            reason = REPLICATED
            wrong[0] = wrong[1] = place
        elif kind == CONTINUATION and (last == GRID or last == CTETRA):
            wrong[0] = wrong[1] = place
            loose = note_lost(loose_ones, loose, wrong, base, place, NOTHING, NOTHING, NOTHING)
        elif kind != NOTHING and kind != CONTINUATION:
            count_name(deck.names, state, kind)
        if kind != NOTHING and kind != CONTINUATION:
            last = kind
    state[POSITION], state[LAST], state[QUADRATIC] = position, last, quadratic
    state[POINTS], state[TETS], state[HARD], state[LOOSE], state[CORDS] = points, tets, hard, loose, cords
    if ended:
        state[ENDED] = 1
    return reason


@kernel
def note_lost(loose: Integers, row: int, wrong: Integers, base: int, place: int, kind: int, of: int, count: int) -> int:
    """Write down a card whose continuation stands elsewhere, or a line that stands elsewhere; return the next row."""
    loose[row, 0], loose[row, 1] = base + wrong[0], base + wrong[1]
    loose[row, 2], loose[row, 3], loose[row, 4], loose[row, 5] = base + place, kind, of, count
    return row + 1


@kernel
def second_word(text: Bytes, place: int) -> Any:
    """The word behind that with which a line begins, as `line_kind` gives it."""
    end = line_end(text, place)
    first, _ = trimmed(text, place, end)
    return line_kind(text, word_end(text, first, end))


@kernel
def is_cord(kind: int) -> bool:
    """Tell whether a card defines coordinate systems."""
    return bool(
        kind == CORD2R or kind == CORD2C or kind == CORD2S or kind == CORD1R or kind == CORD1C or kind == CORD1S
    )


@kernel
def count_name(names: Integers, state: Integers, kind: int) -> None:
    """Count a card of another name; the last place is for all names beyond the first FULL_NAMES - 1."""
    k = 0
    while k < state[NAMES] and names[k, 0] != kind:
        k += 1
    if k == FULL_NAMES:
        k -= 1
    elif k == state[NAMES]:
        names[k, 0], names[k, 1] = kind if k < FULL_NAMES - 1 else OTHERS, 0
        state[NAMES] = k + 1
    names[k, 1] += 1


@kernel
def take_point(
    text: Bytes,
    fields: Integers,
    cut: bool,
    ids: Integers,
    systems: Integers,
    points: Reals,
    row: int,
    wrong: Integers,
) -> int:
    """Put a GRID into a row of `ids`, `systems` and `points`; return the reason against it, or 0.

    Args:
        text: the file.
        fields: id, coordinate system, x, y, z and others: see `Deck`.
        cut: whether the file ends with this card, without a newline.
        ids: out, see `Deck`.
        systems: out, see `Deck`.
        points: out, see `Deck`; NaN for a number that is left to `parse_hard`.
        row: where to put it.
        wrong: out, see `Deck`.
    """
    reason = 0
    ids[row] = parse_integer(text, fields[0, 0], fields[0, 1])
    systems[row] = GRDSET_SYSTEM
    if ids[row] <= 0:
        reason = at_field(fields, 0, wrong, INTEGER)
    elif fields[1, 0] < fields[1, 1]:
        systems[row] = parse_integer(text, fields[1, 0], fields[1, 1])
        if systems[row] < 0:
            reason = at_field(fields, 1, wrong, SYSTEM)
    for k in range(3):
        begin, end = fields[2 + k, 0], fields[2 + k, 1]
        status, value = EXACT, 0.0  # a blank coordinate is 0
        if reason == 0 and begin < end:
            status, value = parse_real(text, begin, end)
        elif reason == 0 and cut:
            reason = CUT
        if status == MALFORMED:
            reason = at_field(fields, 2 + k, wrong, REAL)
        points[row, k] = value
    return reason


@kernel
def take_tetra(
    text: Bytes, fields: Integers, count: int, ids: Integers, tets: Integers, row: int, wrong: Integers
) -> int:
    """Put a CTETRA into a row of `ids` and `tets`; return the reason against it, or 0.

    Its fields are id, property, corner nodes and midside nodes, of which any may be blank or 0. Arguments as for
    `take_point`.
    """
    reason = 0
    ids[row] = parse_integer(text, fields[0, 0], fields[0, 1])
    if ids[row] <= 0:
        reason = at_field(fields, 0, wrong, INTEGER)
    for k in range(2, count):
        blank = fields[k, 0] == fields[k, 1]
        node = 0 if blank else parse_integer(text, fields[k, 0], fields[k, 1])
        if reason == 0 and k < 6:
            tets[row, k - 2] = node
            if blank:
                reason = INCOMPLETE
            elif node <= 0:
                reason = at_field(fields, k, wrong, INTEGER)
        elif reason == 0 and node < 0:
            reason = at_field(fields, k, wrong, INTEGER)
    return reason


@kernel
def at_field(fields: Integers, field: int, wrong: Integers, reason: int) -> int:
    """Set the wrong span to a field, and return the reason."""
    wrong[0], wrong[1] = fields[field, 0], fields[field, 1]
    return reason


# The commonest cards, in one pass over their bytes: whole, in small or large field, without comments, each followed
# by another card. Where anything is otherwise they return `place` again, for `split_card` to look into.


@kernel
def take_plain_tetra(text: Bytes, place: int, ids: Integers, tets: Integers, row: int) -> int:
    """Put a CTETRA of six whole numbers into a row; return the place of the next line, or `place`."""
    following = place
    if place + LONGEST_PLAIN < text.size and text[place] == CTETRA_BEGINS:
        name = eight_bytes(text, place)
        if name == SMALL_CTETRA:
            number = parse_eight(eight_bytes(text, place + 8))
            least = min(number, parse_eight(eight_bytes(text, place + 16)) + 1)  # the property may be blank
            ids[row] = number
            for k in range(3):
                number = parse_eight(eight_bytes(text, place + 24 + 8 * k))
                least = min(least, number)
                tets[row, k] = number
            number, end = parse_last(text, place + 48, place + 56)
            tets[row, 3] = number
            if min(least, number) > 0:
                following = next_card(text, end, place)
        elif name == LARGE_CTETRA:
            number = parse_sixteen(text, place + 8)
            least = min(number, parse_sixteen(text, place + 24) + 1)
            ids[row] = number
            for k in range(2):
                number = parse_sixteen(text, place + 40 + 16 * k)
                least = min(least, number)
                tets[row, k] = number
            begin = next_starred(text, place + 72)
            if least > 0 and begin > 0:
                number = parse_sixteen(text, begin)
                tets[row, 2] = number
                tets[row, 3], end = parse_last(text, begin + 16, begin + 32)
                if min(number, tets[row, 3]) > 0:
                    following = next_card(text, end, place)
    return following


@kernel
def take_plain_point(text: Bytes, place: int, ids: Integers, systems: Integers, points: Reals, row: int) -> int:
    """Put a GRID with easy numbers into a row; return the place of the next line, or `place`."""
    following = place
    if place + LONGEST_PLAIN < text.size and text[place] == GRID_BEGINS:
        name = eight_bytes(text, place)
        begin, system = place + 8, GRDSET_SYSTEM
        if name == SMALL_GRID:
            ids[row] = parse_eight(eight_bytes(text, begin))
            if eight_bytes(text, begin + 8) != BLANKS:
                system = parse_eight(eight_bytes(text, begin + 8))
                system = NOT_PLAIN if system < 0 else system
            begin, width = begin + 16, 8
        else:
            ids[row] = parse_sixteen(text, begin) if name == LARGE_GRID else -1
            if eight_bytes(text, begin + 16) != BLANKS or eight_bytes(text, begin + 24) != BLANKS:
                system = parse_sixteen(text, begin + 16)
                system = NOT_PLAIN if system < 0 else system
            begin, width = begin + 32, 16
        plain = ids[row] > 0 and system != NOT_PLAIN
        systems[row] = system
        for k in range(3):
            if k == 2 and width == 16 and plain:
                begin = next_starred(text, begin)
                plain = begin > 0
            if plain:
                end = begin + width
                if k == 2:  # the last one may end with its line
                    end = line_end_before(text, begin, end)
                first, last = without_blanks(text, begin, end)
                status, value = MALFORMED, 0.0
                if first < last:
                    status, value = parse_real(text, first, last)
                plain = status == EXACT
                points[row, k] = value
                begin = end
        if plain:
            following = next_card(text, begin, place)
    return following


@kernel(allocates=False)
def parse_sixteen(text: Bytes, place: int) -> Any:
    """The whole number in 16 columns, 0 where all are blank; -1 for anything else than `parse_eight` takes."""
    first, second = eight_bytes(text, place), eight_bytes(text, place + 8)
    high, low = parse_eight(first), parse_eight(second)
    number = np.int64(-1)
    if first == BLANKS:
        number = low
    elif second == BLANKS:
        number = high
    elif min(high, low) >= 0 and min(text[place + 7], text[place + 8], text[place + 15]) > BLANK:
        number = 100_000_000 * high + low
    return number


@kernel(allocates=False)
def parse_last(text: Bytes, place: int, end: int) -> tuple[int, int]:
    """The whole number in a field that may end with its line, 0 or less for anything else; and the end of the field."""
    if end - place == 8:
        number = parse_eight(eight_bytes(text, place))
    else:
        number = parse_sixteen(text, place)
    if number < 0:
        end = line_end_before(text, place, end)
        first, last = without_blanks(text, place, end)
        number = parse_integer(text, first, last)
    return number, end


@kernel(allocates=False)
def line_end_before(text: Bytes, place: int, end: int) -> int:
    """Return the end of the line, or `end` if that comes first."""
    while place < end and text[place] != NEWLINE and text[place] != RETURN:
        place += 1
    return place


@kernel(allocates=False)
def without_blanks(text: Bytes, begin: int, end: int) -> tuple[int, int]:
    """Strip the blanks around a span, but no tabs and no ends of lines."""
    while begin < end and text[begin] == BLANK:
        begin += 1
    while begin < end and text[end - 1] == BLANK:
        end -= 1
    return begin, end


@kernel(allocates=False)
def next_starred(text: Bytes, place: int) -> int:
    """Return the place of the first field of the next line, if this one is over and that one begins with `*` and blanks;
    else 0."""
    if text[place] == RETURN:
        place += 1
    return place + 9 if text[place] == NEWLINE and eight_bytes(text, place + 1) == BARE_STAR else 0


@kernel(allocates=False)
def next_card(text: Bytes, begin: int, place: int) -> int:
    """Return the place of the next line, if this one holds no more and that one begins a card; else `place`."""
    while begin < text.size and (text[begin] == BLANK or text[begin] == RETURN):
        begin += 1
    plain = begin + 1 < text.size and text[begin] == NEWLINE and text[begin + 1] > COMMA
    return begin + 1 if plain else place
