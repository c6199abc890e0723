"""Nastran bulk data: GRID and CTETRA, read and written at the speed of the disk.

A card is a name and fields. It stands on one line or goes on in continuation lines, each in one of three
forms (MSC Nastran Quick Reference Guide, "Bulk Data Entries", Format of Bulk Data):

    small field   10 fields of 8 columns:         GRID    7               1.5     -.25    2.+1
    large field   `*` in field 1, 4 of 16:        GRID*   7                               1.5             -.25
                                                  *       2.+1
    free field    a comma anywhere on the line:   GRID,7,,1.5,-.25,2.+1

The reader works in layers, so that a dialect touches one of them: `line_kind` (what a line is), `split_card`
(a card of any form to one list of fields), `parse_integer` and `parse_real`, `scan` (the loop over the cards;
fills a `Deck`), and `read_nastran`, which makes the mesh of the deck. Kernels raise nothing: they return a
reason, and leave what was wrong as a span of bytes.
"""

import codecs
import os
import re
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tetrabench.errors import InputError
from tetrabench.jit import kernel
from tetrabench.mesh.check import find_fault
from tetrabench.mesh.quality import signed_volumes
from tetrabench.mesh.tetra_mesh import MeshReport, TetraMesh

Bytes = NDArray[np.uint8]
Integers = NDArray[np.int64]
Reals = NDArray[np.float64]

TAB, NEWLINE, BLANK, DOLLAR, STAR, PLUS, COMMA, MINUS, DOT, ZERO, NINE = b"\t\n $*+,-.09"
EQUALS, SMALL_D, SMALL_E = b"=de"

# What a line is: nothing, a continuation, or a card, whose kind is its name (8 capitals at most) as the bytes
# of one integer.
NOTHING, CONTINUATION = 0, 1
GRID, CTETRA, GRDSET, INCLUDE, BEGIN, ENDDATA, END, BULK = (
    int.from_bytes(name, "big")
    for name in (b"GRID", b"CTETRA", b"GRDSET", b"INCLUDE", b"BEGIN", b"ENDDATA", b"END", b"BULK")
)

# Why a card is refused.
TABBED, DANGLING, FOREIGN, UNSTARRED, CROWDED, CUT = range(1, 7)
INTEGER, REAL, SYSTEM, INCOMPLETE, MIDSIDE, INCLUDED, REPLICATED = range(7, 14)
REASONS = {
    TABBED: "a tab in a fixed field is not supported; replace it by blanks, or use commas",
    DANGLING: "the continuation of this card is missing on the line after it",
    FOREIGN: "this line continues another card than the one above it",
    UNSTARRED: "the continuation of a large-field line must begin with *",
    CROWDED: "more fields than this card can have",
    CUT: "the file ends within this card",
    INTEGER: "{field!r} is not a whole number above 0",
    REAL: "{field!r} is not a number",
    SYSTEM: "coordinate system {field} is not supported, only the basic one (0 or blank)",
    INCOMPLETE: "a CTETRA needs four corner nodes",
    MIDSIDE: "CTETRA with midside nodes ({field} is the first) is not supported",
    INCLUDED: "INCLUDE is not supported; paste the file in",
    REPLICATED: "replication (=) of GRID or CTETRA is not supported",
}

POINTS, TETS, SKIPPED, HARD = range(4)  # places in Deck.counts
MOST_FIELDS = 40
MALFORMED, EXACT, INEXACT = range(3)  # what parse_real says of a number
EXACT_POWERS = 22  # powers of ten up to this one are exact in float64
POWERS = np.array([float(f"1e{k}") for k in range(EXACT_POWERS + 1)])


class Deck(NamedTuple):
    """What `scan` finds. Every array has room for all lines of the file; `counts` says how far each is
    filled.

    Attributes:
        points: (lines, 3) float64, coordinates.
        point_ids: (lines,) int64.
        point_places: (lines,) int64, first byte of the card.
        tets: (lines, 4) int64, ids of the corner nodes.
        tet_ids: (lines,) int64.
        tet_places: (lines,) int64, first byte of the card.
        skipped: (lines,) int64, names of other cards (see `line_kind`).
        hard: (3 lines, 3) int64, numbers left to Python's float(): index in points.ravel(), first byte, end.
        counts: (4,) int64, entries in points, tets, skipped and hard.
        fields: (MOST_FIELDS, 2) int64, first byte and end of each field of the card at hand, without blanks
            around it.
        wrong: (2,) int64, first byte and end of the field, or of nothing in the line, for which the card is
            refused.
    """

    points: Reals
    point_ids: Integers
    point_places: Integers
    tets: Integers
    tet_ids: Integers
    tet_places: Integers
    skipped: Integers
    hard: Integers
    counts: Integers
    fields: Integers
    wrong: Integers


def read_nastran(path: str | os.PathLike[str], *, unused: str = "drop") -> TetraMesh:
    """Read GRID and CTETRA of a Nastran bulk data file.

    Coordinates are rounded correctly, as by float(). Other cards are skipped, whatever they hold, and counted
    in `report.skipped`.

    Args:
        path: the file.
        unused: "drop" leaves out the points that no tetra uses, "keep" keeps them; `report.unreferenced`
            counts them.

    Raises:
        InputError: `path:line: reason` for anything that cannot be taken: a malformed card, a node that does
            not exist, an id used twice, a dialect not supported (coordinate systems, midside nodes, INCLUDE,
            tabs); `path: reason` for a file that cannot be read or holds no CTETRA.
    """
    if unused not in ("drop", "keep"):
        raise InputError(f"unused points can be 'drop' or 'keep', not {unused!r}")
    text = read_bytes(path)
    deck = empty_deck(lines=count_lines(text) + 1)
    reason, ended = scan(text, deck)
    if reason:
        begin, end = deck.wrong.tolist()
        field = text[begin:end].tobytes().decode("latin-1")
        raise refusal(path, text, begin, REASONS[reason].format(field=field))
    points, tets, skipped, hard = deck.counts.tolist()
    report = MeshReport(source=str(path), skipped=count_names(deck.skipped[:skipped]))
    if not tets:
        cards = {"GRID": points} | report.skipped
        held = ", ".join(f"{name} {count}" for name, count in cards.items() if count)
        raise InputError(f"{path}: holds no CTETRA; it holds {held or 'no card at all'}")
    if not ended:
        report.warnings.append(f"{path}: no ENDDATA; if the file's end were missing, nothing would show it")
    parse_hard(path, text, deck, hard)

    coordinates, point_ids = deck.points[:points], deck.point_ids[:points]
    corners, first = indices_of(deck.tets[:tets], point_ids)
    if corners.min() < 0:
        row, corner = np.argwhere(corners < 0)[0]
        reason = f"CTETRA {deck.tet_ids[row]} uses GRID {deck.tets[row, corner]}, which does not exist"
        raise refusal(path, text, deck.tet_places[row], reason)
    again = np.flatnonzero(first != np.arange(points))
    for row in again[(coordinates[again] != coordinates[first[again]]).any(axis=1)][:1]:
        raise refusal(path, text, deck.point_places[row], f"GRID {point_ids[row]} twice, at different places")
    row = first_repeated(deck.tet_ids[:tets])
    if row is not None:
        raise refusal(path, text, deck.tet_places[row], f"CTETRA {deck.tet_ids[row]} twice")

    used = np.zeros(points, np.bool_)
    used[corners.ravel()] = True
    report.unreferenced = int(points - len(again) - np.count_nonzero(used))
    kept = used if unused == "drop" else first == np.arange(points)
    moved = corners if kept.all() else (np.cumsum(kept, dtype=np.int32) - np.int32(1))[corners]
    mesh = TetraMesh(
        points=coordinates[kept],
        tets=moved,
        point_ids=point_ids[kept],
        tet_ids=deck.tet_ids[:tets].copy(),
        report=report,
    )
    fault = find_fault(mesh.points, mesh.tets)
    if fault is not None:
        _, row, sentence = fault
        raise refusal(path, text, deck.tet_places[row], f"CTETRA {mesh.tet_ids[row]} {sentence}")
    report.inverted = int(np.count_nonzero(signed_volumes(mesh.points, mesh.tets) < 0))
    return mesh


def read_bytes(path: str | os.PathLike[str]) -> Bytes:
    """Read a whole file that is not empty."""
    try:
        text = np.fromfile(path, np.uint8)
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror or error}") from error
    if not text.size:
        raise InputError(f"{path}: is empty")
    return text[3:] if text[:3].tobytes() == codecs.BOM_UTF8 else text


def count_lines(text: Bytes) -> int:
    """Count the newlines, a megabyte at a time: what fits into the processor's cache."""
    return sum(int(np.count_nonzero(text[i : i + 2**20] == NEWLINE)) for i in range(0, text.size, 2**20))


def empty_deck(lines: int) -> Deck:
    """Allocate a deck; what is never touched costs no memory."""
    return Deck(
        points=np.empty((lines, 3), np.float64),
        point_ids=np.empty(lines, np.int64),
        point_places=np.empty(lines, np.int64),
        tets=np.empty((lines, 4), np.int64),
        tet_ids=np.empty(lines, np.int64),
        tet_places=np.empty(lines, np.int64),
        skipped=np.empty(lines, np.int64),
        hard=np.empty((3 * lines, 3), np.int64),
        counts=np.zeros(4, np.int64),
        fields=np.zeros((MOST_FIELDS, 2), np.int64),
        wrong=np.zeros(2, np.int64),
    )


def refusal(path: str | os.PathLike[str], text: Bytes, place: int, reason: str) -> InputError:
    """Name the file and the line of the byte at `place`."""
    return InputError(f"{path}:{count_lines(text[:place]) + 1}: {reason}")


def count_names(names: Integers) -> dict[str, int]:
    """Count the cards by name, the most frequent first."""
    kinds, counts = np.unique(names, return_counts=True)
    spelled = (kind.to_bytes(8, "big").lstrip(b"\0").decode() for kind in kinds.tolist())
    return dict(Counter(dict(zip(spelled, counts.tolist(), strict=True))).most_common())


def parse_hard(path: str | os.PathLike[str], text: Bytes, deck: Deck, count: int) -> None:
    """Let float() convert the numbers whose exact value `parse_real` could not reach with one rounding."""
    values = deck.points.reshape(-1)
    for index, begin, end in deck.hard[:count].tolist():
        field = text[begin:end].tobytes().decode("latin-1")
        # 1.5-3 and 1.5D-3 mean 1.5e-3
        values[index] = float(re.sub(r"(?<=[\d.])e?([+-])", r"e\1", field.lower().replace("d", "e")))
        if not np.isfinite(values[index]):
            raise refusal(path, text, begin, f"{field} is beyond the largest number")


def indices_of(ids: Integers, point_ids: Integers) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """Translate ids to indices into `point_ids`, to the first of equal ones.

    Args:
        ids: any shape, positive.
        point_ids: (n,), positive.

    Returns:
        int32 of the shape of `ids`, -1 where there is no such id; (n,) int32, the same for `point_ids`
        themselves.
    """
    count = len(point_ids)
    most = int(point_ids.max(initial=0))
    if most < 16 * count + 1_000_000:
        table = np.full(most + 2, -1, np.int32)  # the last entry stands for all ids beyond
        table[point_ids[::-1]] = np.arange(count - 1, -1, -1, dtype=np.int32)
        return table[np.minimum(ids, most + 1)], table[point_ids]
    ordered, first = np.unique(point_ids, return_index=True)
    places = np.minimum(np.searchsorted(ordered, ids), len(ordered) - 1)
    found = np.where(ordered[places] == ids, first[places], -1)
    return found.astype(np.int32), first[np.searchsorted(ordered, point_ids)].astype(np.int32)


def first_repeated(ids: Integers) -> int | None:
    """Find the first row whose id stands in an earlier row."""
    if (ids[1:] > ids[:-1]).all():
        return None
    order = np.argsort(ids, kind="stable")
    again = order[1:][ids[order[1:]] == ids[order[:-1]]]
    return int(again.min()) if again.size else None


# Kernels that are called for each line have one way out: numba then does without reference counts of their
# arrays, which cost more than the work.


@kernel
def scan(text: Bytes, deck: Deck) -> tuple[int, bool]:
    """Go through the cards of a file and fill the deck.

    Returns:
        The reason why a card is refused (0 where none is), its place in `deck.wrong`; whether the file came
        to its ENDDATA.
    """
    point_ids, point_places, coordinates = deck.point_ids, deck.point_places, deck.points
    tet_ids, tet_places, corners = deck.tet_ids, deck.tet_places, deck.tets
    skipped_names, hard_numbers, fields, wrong = deck.skipped, deck.hard, deck.fields, deck.wrong
    zero = int(np.int64(0))  # a literal would make numba compile the kernels below once more
    position, points, tets, skipped, hard = zero, zero, zero, zero, zero
    last, reason, ended = NOTHING, 0, False
    while position < text.size and reason == 0 and not ended:
        wrong[0] = wrong[1] = place = position
        kind = line_kind(text, place)
        if kind == CTETRA:
            position = take_plain_tetra(text, place, tet_ids, corners, tets)
            if position == place:
                reason, count, position = split_card(text, place, fields, wrong)
                if reason == 0:
                    reason = take_tetra(text, fields, count, tet_ids, corners, tets, wrong)
            tet_places[tets] = place
            tets += 1
        elif kind == GRID:
            reason, count, position = split_card(text, place, fields, wrong)
            cut = position >= text.size and text[text.size - 1] != NEWLINE
            if reason == 0:
                reason = take_point(text, fields, count, cut, point_ids, coordinates, points, wrong)
            for k in range(3):
                if reason == 0 and np.isnan(coordinates[points, k]):
                    hard_numbers[hard, 0] = 3 * points + k
                    hard_numbers[hard, 1], hard_numbers[hard, 2] = fields[2 + k, 0], fields[2 + k, 1]
                    hard += 1
            point_places[points] = place
            points += 1
        elif kind == GRDSET:  # the defaults of all GRIDs
            reason, count, position = split_card(text, place, fields, wrong)
            if reason == 0 and not is_basic(text, fields):
                reason = at_field(fields, 1, wrong, SYSTEM)
        elif kind == ENDDATA or (kind == END and line_kind(text, place + 3) == BULK):
            ended = True
        elif kind == INCLUDE:
            reason = INCLUDED
        elif last in (GRID, CTETRA) and text[place] == EQUALS:
            reason = REPLICATED
        else:
            if kind == BEGIN:
                skipped = 0  # so far it was executive and case control
            elif kind != NOTHING and kind != CONTINUATION:
                skipped_names[skipped] = kind
                skipped += 1
            position = line_end(text, place) + 1
        if kind != NOTHING and kind != CONTINUATION:
            last = kind
    counts = deck.counts
    counts[POINTS], counts[TETS], counts[SKIPPED], counts[HARD] = points, tets, skipped, hard
    return reason, ended


@kernel
def take_point(
    text: Bytes,
    fields: Integers,
    count: int,
    cut: bool,
    ids: Integers,
    points: Reals,
    row: int,
    wrong: Integers,
) -> int:
    """Put a GRID into a row of `ids` and `points`; return the reason against it, or 0.

    Args:
        text: the file.
        fields: id, coordinate system, x, y, z and others: see `Deck`.
        count: how many fields there are.
        cut: whether the file ends with this card, without a newline.
        ids: out, see `Deck`.
        points: out, see `Deck`; NaN for a number that is left to Python.
        row: where to put it.
        wrong: out, see `Deck`.
    """
    reason = 0
    ids[row] = parse_integer(text, fields[0, 0], fields[0, 1])
    if ids[row] <= 0:
        reason = at_field(fields, 0, wrong, INTEGER)
    elif not is_basic(text, fields):
        reason = at_field(fields, 1, wrong, SYSTEM)
    elif count < 5:
        reason = DANGLING
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

    Its fields are id, property, corner nodes and midside nodes. Arguments as for `take_point`.
    """
    reason = 0 if count >= 6 else DANGLING
    ids[row] = parse_integer(text, fields[0, 0], fields[0, 1])
    if ids[row] <= 0:
        reason = at_field(fields, 0, wrong, INTEGER)
    for k in range(2, count):
        blank = fields[k, 0] == fields[k, 1]
        if reason == 0 and k < 6:
            tets[row, k - 2] = parse_integer(text, fields[k, 0], fields[k, 1])
            if blank:
                reason = INCOMPLETE
            elif tets[row, k - 2] <= 0:
                reason = at_field(fields, k, wrong, INTEGER)
        elif reason == 0 and not blank:
            reason = at_field(fields, k, wrong, MIDSIDE)
    return reason


@kernel
def take_plain_tetra(text: Bytes, place: int, ids: Integers, tets: Integers, row: int) -> int:
    """Put the commonest CTETRA, a line of six small fields of digits, into a row, in one pass over its bytes.

    Returns:
        The place of the next line, which begins another card; where anything is otherwise, `place` again, for
        `split_card` to look into.
    """
    following = place + 57
    plain = text.size > following and text[place + 6] == BLANK and text[place + 7] == BLANK
    plain = plain and text[following - 1] == NEWLINE and text[following] > COMMA
    for k in range(6 if plain else 0):
        number, i, end = 0, place + 8 + 8 * k, place + 16 + 8 * k
        while i < end and text[i] == BLANK:
            i += 1
        while i < end and ZERO <= text[i] <= NINE:
            number = 10 * number + int(text[i]) - ZERO
            i += 1
        while i < end and text[i] == BLANK:
            i += 1
        plain = plain and i == end and number > 0
        if k == 0:
            ids[row] = number
        elif k >= 2:
            tets[row, k - 2] = number
    return following if plain else place


@kernel
def is_basic(text: Bytes, fields: Integers) -> bool:
    """Tell whether field 2 of a GRID or a GRDSET names the basic coordinate system: blank or 0."""
    return bool(fields[1, 0] == fields[1, 1] or parse_integer(text, fields[1, 0], fields[1, 1]) == 0)


@kernel
def at_field(fields: Integers, field: int, wrong: Integers, reason: int) -> int:
    """Set the wrong span to a field, and return the reason."""
    wrong[0], wrong[1] = fields[field, 0], fields[field, 1]
    return reason


@kernel
def split_card(text: Bytes, place: int, fields: Integers, wrong: Integers) -> tuple[int, int, int]:
    """Split the card that begins at `place` into `fields`, without its name, whatever the form of its lines.

    Every line gives 8 fields, or 4 large ones, blank where it ends early. Its last field may name the
    continuation, which repeats the name in its first field, but for the sign before it; a continuation
    without a name belongs to the line above it.

    Returns:
        The reason against the card, or 0; the number of its fields; the place of the line after it.
    """
    count, position, reason, kind = 0, place, 0, CONTINUATION
    begin, stop = place, place  # the name of the continuation
    awaited, starred = False, False
    while kind == CONTINUATION and reason == 0:
        wrong[0] = wrong[1] = position
        end, free, tabbed, large = line_form(text, position)
        number, width = (4, 16) if large else (8, 8)
        cursor = field_end(text, position, end) if free else min(position + 8, end)
        if position > place:
            first, last = bare_name(text, position, min(position + 8, cursor))
            if first < last and not same_bytes(text, first, last, begin, stop):
                reason = FOREIGN
            elif starred and not large and not free:
                reason = UNSTARRED
        if tabbed and not free:
            reason = TABBED
        elif count + number > MOST_FIELDS:
            reason = CROWDED
            number = 0
        for k in range(count, count + number):
            begin = min(cursor + 1, end) if free else cursor
            cursor = field_end(text, begin, end) if free else min(cursor + width, end)
            stop = cursor
            while begin < stop and text[begin] <= BLANK:
                begin += 1
            while begin < stop and text[stop - 1] <= BLANK:
                stop -= 1
            fields[k, 0], fields[k, 1] = begin, stop
        count += number

        begin = min(cursor + 1, end) if free else cursor
        cursor = stop = field_end(text, begin, end) if free else min(cursor + 8, end)
        awaited = begin < stop and (text[begin] == PLUS or text[begin] == STAR)
        if begin < stop:
            begin, stop = bare_name(text, begin, stop)
        while free and cursor < end:
            if text[cursor] != COMMA and text[cursor] > BLANK:
                reason = CROWDED
            cursor += 1

        position, starred = line_end(text, end) + 1, large
        kind = line_kind(text, position)
        while kind == NOTHING and position < text.size:
            position = line_end(text, position) + 1
            kind = line_kind(text, position)
    if reason == 0:
        wrong[0] = wrong[1] = place
        if awaited:
            reason = DANGLING
    return reason, count, position


@kernel
def line_kind(text: Bytes, place: int) -> int:
    """Return NOTHING for a blank line or a comment, CONTINUATION, or a card's name as one integer."""
    i, column = place, 0
    while i < text.size and text[i] <= BLANK and text[i] != NEWLINE:
        column += 8 if text[i] == TAB else 1
        i += 1
    blank = i >= text.size or text[i] == NEWLINE or text[i] == DOLLAR
    continued = not blank and (column >= 8 or text[i] == PLUS or text[i] == STAR or text[i] == COMMA)
    kind = CONTINUATION if continued else NOTHING
    end = i if blank or continued else min(i + 8, text.size)
    while i < end and text[i] > BLANK and text[i] != COMMA and text[i] != STAR:
        letter = min(int(text[i]), 127)  # the names of cards are ASCII; others shall not overflow
        kind = kind << 8 | (letter - 32 if 97 <= letter <= 122 else letter)
        i += 1
    return kind


@kernel
def line_end(text: Bytes, place: int) -> int:
    """Return the place of the newline, or the end of the file."""
    while place < text.size and text[place] != NEWLINE:
        place += 1
    return place


@kernel
def line_form(text: Bytes, place: int) -> tuple[int, bool, bool, bool]:
    """Return the end of a line without its comment, and whether it is free, holds a tab, has large fields."""
    free, tabbed, large = False, False, False
    i = place
    while i < text.size and text[i] != NEWLINE and text[i] != DOLLAR:
        if text[i] <= COMMA and text[i] != BLANK:  # digits, capitals, `-` and `.` come after the comma
            free |= text[i] == COMMA
            tabbed |= text[i] == TAB
            large |= text[i] == STAR and i < place + 8 and not free
        i += 1
    return i, free, tabbed, large


@kernel
def field_end(text: Bytes, begin: int, end: int) -> int:
    """Return the place of the next comma, or `end`."""
    while begin < end and text[begin] != COMMA:
        begin += 1
    return begin


@kernel
def bare_name(text: Bytes, begin: int, end: int) -> tuple[int, int]:
    """Strip the blanks around the name of a continuation, and the sign before it."""
    while begin < end and text[begin] <= BLANK:
        begin += 1
    while begin < end and text[end - 1] <= BLANK:
        end -= 1
    if begin < end and (text[begin] == PLUS or text[begin] == STAR):
        begin += 1
    return begin, end


@kernel
def same_bytes(text: Bytes, begin: int, end: int, other: int, other_end: int) -> bool:
    """Compare two spans of the file."""
    k = 0
    while begin + k < end and other + k < other_end and text[begin + k] == text[other + k]:
        k += 1
    return begin + k == end and other + k == other_end


@kernel
def parse_integer(text: Bytes, begin: int, end: int) -> int:
    """Return the whole number in a field of digits, up to 18 of them; -1 for anything else."""
    number = 0 if 0 < end - begin <= 18 else -1
    i = begin
    while i < end and number >= 0:
        digit = int(text[i]) - ZERO
        number = 10 * number + digit if 0 <= digit <= 9 else -1
        i += 1
    return number


@kernel
def parse_real(text: Bytes, begin: int, end: int) -> tuple[int, float]:
    """Parse the number in a field that is not blank: `1.5`, `-.25`, `1.5-3`, `1.+2`, `1.0D+3`, `2e5`.

    A whole number below 2^53, multiplied or divided by a power of ten that is exact too, is rounded once,
    hence correctly (Clinger, How to Read Floating Point Numbers Accurately, 1990).

    Returns:
        EXACT and the number; INEXACT and NaN where this is a number, but beyond that rule; MALFORMED and NaN.
    """
    i = begin
    negative = text[i] == MINUS
    if negative or text[i] == PLUS:
        i += 1
    mantissa, power, digits, after_dot = 0, 0, 0, False
    while i < end and (ZERO <= text[i] <= NINE or (text[i] == DOT and not after_dot)):
        if text[i] == DOT:
            after_dot = True
        else:
            digits += 1
            power -= after_dot
            if mantissa < 2**53:  # beyond that the number is left to others
                mantissa = 10 * mantissa + int(text[i]) - ZERO
        i += 1

    lettered = i < end and (text[i] | 32 == SMALL_E or text[i] | 32 == SMALL_D)
    if lettered:
        i += 1
    signed = i < end and (text[i] == PLUS or text[i] == MINUS)
    sign = -1 if signed and text[i] == MINUS else 1
    if signed:
        i += 1
    exponent, exponent_begin = 0, i
    while i < end and ZERO <= text[i] <= NINE:
        exponent = min(10 * exponent + int(text[i]) - ZERO, 9999)
        i += 1
    power += sign * exponent

    status, value = EXACT, np.nan
    if digits == 0 or i < end or ((lettered or signed) and i == exponent_begin):
        status = MALFORMED
    elif mantissa >= 2**53 or abs(power) > EXACT_POWERS:
        status = INEXACT
    else:
        value = mantissa / POWERS[-power] if power < 0 else mantissa * POWERS[power]
        value = -value if negative else value
    return status, value


class Layout(NamedTuple):
    """Where the fields of a form stand, for records of fixed length (one line, or two in large field).

    Attributes:
        width: columns a number may take.
        grid: record of a GRID with blank fields.
        grid_ends: the columns before which its id, x, y and z end.
        tetra: record of a CTETRA with blank fields.
        tetra_ends: the columns before which its id, property and four nodes end.
    """

    width: int
    grid: bytes
    grid_ends: tuple[int, ...]
    tetra: bytes
    tetra_ends: tuple[int, ...]


SMALL = Layout(
    width=8,
    grid=b"GRID".ljust(48) + b"\n",
    grid_ends=(16, 32, 40, 48),
    tetra=b"CTETRA".ljust(56) + b"\n",
    tetra_ends=(16, 24, 32, 40, 48, 56),
)
LARGE = Layout(
    width=16,
    grid=b"GRID*".ljust(72) + b"\n" + b"*".ljust(24) + b"\n",
    grid_ends=(24, 56, 72, 97),
    tetra=b"CTETRA*".ljust(72) + b"\n" + b"*".ljust(40) + b"\n",
    tetra_ends=(24, 40, 56, 72, 97, 113),
)


def write_nastran(
    mesh: TetraMesh, path: str | os.PathLike[str], *, field: str = "small", comments: Sequence[str] = ()
) -> None:
    """Write a mesh as Nastran bulk data: a whole file, or none.

    Args:
        mesh: its ids are kept; every tetra gets property 1.
        path: the file; one that exists is replaced.
        field: "small" and "large" round coordinates to what 8 and 16 columns hold (5 to 7 and 13 to 15
            digits), "free" keeps every bit.
        comments: lines for the top of the file, without the `$`.

    Raises:
        InputError: an unknown form, an id that is not positive or too long for its field, a coordinate that
            is NaN or infinite, a file that cannot be written.
    """
    if field not in ("small", "large", "free"):
        raise InputError(f"unknown field form {field!r}; there are small, large, free")
    points = np.require(mesh.points, np.float64, ["C", "W"])
    point_ids = np.require(mesh.point_ids, np.int64, ["C", "W"])
    tets = np.column_stack([mesh.tet_ids, np.ones(len(mesh.tets), np.int64), point_ids[mesh.tets]])
    if not np.isfinite(points).all():
        raise InputError(f"{path}: a coordinate that is NaN or infinite cannot be written")
    low, high = (int(edge(np.append(tets, point_ids))) for edge in (np.min, np.max))
    layout = {"small": SMALL, "large": LARGE, "free": free_layout(len(str(high)))}[field]
    if low < 1 or len(str(high)) > layout.width:
        held = f"{field} field holds whole numbers from 1, of up to {layout.width} digits"
        raise InputError(f"{path}: ids run from {low} to {high}, but {held}")
    head = "".join(f"$ {line}\n" for comment in comments for line in comment.splitlines())
    write_whole(
        path,
        (head + "BEGIN BULK\n").encode(),
        free_points(points, point_ids) if field == "free" else point_records(points, point_ids, layout),
        integer_records(tets, layout.tetra, layout.tetra_ends),
        b"ENDDATA\n",
    )


def write_whole(path: str | os.PathLike[str], *parts: bytes | Bytes) -> None:
    """Write a file beside `path` and give it that name when it is complete."""
    draft = Path(f"{os.fspath(path)}.{os.getpid()}.part")
    try:
        with draft.open("wb") as file:
            for part in parts:
                file.write(part if isinstance(part, bytes) else part.data)
        draft.replace(path)
    except OSError as error:
        raise InputError(f"{path}: cannot be written: {error.strerror or error}") from error
    finally:
        draft.unlink(missing_ok=True)


def free_layout(width: int) -> Layout:
    """Make the layout of a free-field CTETRA, padded with blanks to one length (GRIDs have none)."""
    blank = b" " * width
    ends = tuple(np.cumsum([7 + width, 2, *[width + 1] * 4]).tolist())
    return Layout(width, b"", (), b"CTETRA," + b",".join([blank, b" ", *[blank] * 4]) + b"\n", ends)


def free_points(points: Reals, point_ids: Integers) -> bytes:
    """Write GRIDs in free field, each coordinate as the shortest number that is read as the same bits."""
    lines = (
        f"GRID,{number},,{x!r},{y!r},{z!r}\n"
        for number, (x, y, z) in zip(point_ids.tolist(), points.tolist(), strict=True)
    )
    # Python writes 1e-05, Nastran wants the decimal point.
    return re.sub(r"(?<=[,-])(\d)e", r"\1.e", "".join(lines)).encode()


def point_records(points: Reals, point_ids: Integers, layout: Layout) -> Bytes:
    """Write GRIDs in fixed fields: one uint8 row of text for each point."""
    records = integer_records(point_ids[:, None], layout.grid, layout.grid_ends[:1])
    ends = np.array(layout.grid_ends[1:], np.int64)
    left = np.empty(points.size, np.int64)
    for place in left[: put_reals(records, ends, layout.width, points, left)]:
        row, k = divmod(int(place), 3)
        field = scientific(float(points[row, k]), layout.width).rjust(layout.width)
        records[row, ends[k] - layout.width : ends[k]] = np.frombuffer(field.encode(), np.uint8)
    return records


def integer_records(values: Integers, blank: bytes, ends: Sequence[int]) -> Bytes:
    """Copy `blank` for each row of (n, k) `values`, and write these into it, ending before columns `ends`."""
    records = np.tile(np.frombuffer(blank, np.uint8), (len(values), 1))
    put_integers(records, np.array(ends, np.int64), np.require(values, np.int64, ["C", "W"]))
    return records


def scientific(value: float, width: int) -> str:
    """Write a number with an exponent, as `-1.2345-6`, with the most digits that fit."""
    for digits in range(width, -1, -1):
        mantissa, exponent = f"{value:#.{digits}e}".split("e")
        field = f"{mantissa.rstrip('0')}{int(exponent):+d}"
        if len(field) <= width:
            break
    return field


@kernel
def put_integers(records: Bytes, ends: Integers, values: Integers) -> None:
    """Write positive `values[i, k]` into `records[i]`, right-justified before column `ends[k]`."""
    for i in range(values.shape[0]):
        for k in range(values.shape[1]):
            rest, column = values[i, k], ends[k]
            while rest > 0:
                column -= 1
                records[i, column] = ZERO + rest % 10
                rest //= 10


@kernel
def put_reals(records: Bytes, ends: Integers, width: int, values: Reals, left: Integers) -> int:
    """Write `values[i, k]` into `records[i]` with the most decimals, right-justified before column `ends[k]`.

    Numbers better written with an exponent (below 0.001, or too large) are left out: their flat indices go
    into `left`.

    Returns:
        How many are left out.
    """
    count = 0
    for i in range(values.shape[0]):
        for k in range(values.shape[1]):
            size, decimals = abs(values[i, k]), width - 1
            if values[i, k] < 0:
                decimals -= 1
            limit = POWERS[decimals]
            if (size < 0.001 and size != 0) or np.rint(size) >= limit:
                left[count] = i * values.shape[1] + k
                count += 1
                continue
            while np.rint(size * POWERS[decimals]) >= limit:
                decimals -= 1
            rest = int(np.rint(size * POWERS[decimals]))
            while decimals > 0 and rest % 10 == 0:
                decimals -= 1
                rest //= 10
            column = ends[k]
            for _ in range(decimals):
                column -= 1
                records[i, column] = ZERO + rest % 10
                rest //= 10
            column -= 1
            records[i, column] = DOT
            while rest > 0 or size == 0:
                column -= 1
                records[i, column] = ZERO + rest % 10
                rest //= 10
                size = 1.0
            if values[i, k] < 0:
                records[i, column - 1] = MINUS
    return count
