"""Cards: what a line is, the fields of a card in any form, the number in a field. Kernels on the bytes of a file.

They raise nothing: they return a reason, and leave what was wrong as a span of bytes. Those that are called for
each line have one way out: numba then does without reference counts of their arrays, which cost more than the work.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from tetrabench.jit import kernel

Bytes = NDArray[np.uint8]
Integers = NDArray[np.int64]
Reals = NDArray[np.float64]

TAB, NEWLINE, BLANK, DOLLAR, STAR, PLUS, COMMA, MINUS, DOT, ZERO, NINE = b"\t\n $*+,-.09"
EQUALS, SMALL_D, SMALL_E = b"=de"

# What a line is: nothing, a continuation, or a card, whose kind is its name (8 capitals at most) as the bytes
# of one integer.
NOTHING, CONTINUATION = 0, 1

# Why a card is refused.
OVERLONG, DANGLING, UNSTARRED, CROWDED, CUT = range(1, 6)
INTEGER, SYSTEM, REAL, INCOMPLETE, REPLICATED = range(6, 11)
REASONS = {
    OVERLONG: "{field!r} crosses the columns of its field on a line with tabs; use blanks or commas",
    DANGLING: "the continuation of this card is missing",
    UNSTARRED: "the continuation of a large-field line must begin with *",
    CROWDED: "more fields than this card can have",
    CUT: "the file ends within this card",
    INTEGER: "{field!r} is not a whole number above 0",
    SYSTEM: "{field!r} is not the number of a coordinate system",
    REAL: "{field!r} is not a number",
    INCOMPLETE: "a CTETRA needs four corner nodes",
    REPLICATED: "replication (=) of GRID or CTETRA is not supported; write the cards out",
}

MOST_FIELDS = 40
MALFORMED, EXACT, INEXACT = range(3)  # what parse_real says of a number
EXACT_POWERS = 22  # powers of ten up to this one are exact in float64
POWERS = np.array([float(f"1e{k}") for k in range(EXACT_POWERS + 1)])


def kind_of(name: str) -> int:
    """The kind of a card as `line_kind` gives it."""
    return int.from_bytes(name.encode(), "big")


GRID, CTETRA = kind_of("GRID"), kind_of("CTETRA")


@kernel
def line_kind(text: Bytes, place: int) -> int:
    """Return NOTHING for a blank line or a comment, CONTINUATION, or a card's name as one integer.

    What begins beyond the first field goes on with the card above it; but GRID or CTETRA before a comma is a card in
    free field that somebody has indented, and to take it for a list of numbers would be to lose it.
    """
    i, column = place, 0
    while i < text.size and text[i] <= BLANK and text[i] != NEWLINE:
        column += 8 if text[i] == TAB else 1
        i += 1
    blank = i >= text.size or text[i] == NEWLINE or text[i] == DOLLAR
    continued = not blank and (text[i] == PLUS or text[i] == STAR or text[i] == COMMA)
    kind = CONTINUATION if continued else NOTHING
    end = i if blank or continued else min(i + 8, text.size)
    while i < end and text[i] > BLANK and text[i] != COMMA and text[i] != STAR:
        letter = min(int(text[i]), 127)  # the names of cards are ASCII; others shall not overflow
        kind = kind << 8 | (letter - 32 if 97 <= letter <= 122 else letter)
        i += 1
    if column >= 8 and not blank:
        while i < text.size and (text[i] == BLANK or text[i] == TAB or text[i] == STAR):
            i += 1
        free = i < text.size and text[i] == COMMA
        kind = kind if free and (kind == GRID or kind == CTETRA) else CONTINUATION
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
def split_card(text: Bytes, place: int, fields: Integers, wrong: Integers) -> tuple[int, int, int]:
    """Split the card that begins at `place` into `fields`, without its name, whatever the form of its lines.

    Every line gives 8 fields, or 4 large ones, blank where it ends early. Its last field may name the
    continuation, which repeats the name in its first field, but for the sign before it; a continuation
    without a name belongs to the line above it. A line with another name belongs to another card, and ends
    this one.

    Args:
        text: the file.
        place: first byte of the card.
        fields: (MOST_FIELDS, 2), out: first byte and end of each field, without blanks around it.
        wrong: (2,), out: the span of what is wrong; of the name of the continuation where that is DANGLING.

    Returns:
        The reason against the card, or 0; the number of its fields; the place of the line after it.
    """
    count, position, reason, kind = 0, place, 0, CONTINUATION
    begin, stop = place, place  # the name of the continuation
    awaited, starred = False, False
    while kind == CONTINUATION and reason == 0:
        end, free, tabbed, large = line_form(text, position)
        cursor = field_end(text, position, end) if free else min(position + 8, end)
        if position > place:
            first, last = bare_name(text, position, name_end(text, position, cursor))
            if first < last and not same_bytes(text, first, last, begin, stop):
                break
            if starred and not large and not free:
                reason = UNSTARRED
        number, width = (4, 16) if large else (8, 8)
        if count + number > MOST_FIELDS:
            reason, number = CROWDED, 0
        wrong[0] = wrong[1] = position
        if tabbed and not free:
            begin, stop = split_at_tabs(text, position, end, width, fields, count, count + number, wrong)
            if wrong[0] < wrong[1]:
                reason = OVERLONG
        else:
            for k in range(count, count + number):
                begin = min(cursor + 1, end) if free else cursor
                cursor = field_end(text, begin, end) if free else min(cursor + width, end)
                fields[k, 0], fields[k, 1] = trimmed(text, begin, cursor)
            begin = min(cursor + 1, end) if free else cursor
            cursor = stop = field_end(text, begin, end) if free else min(cursor + 8, end)
        count += number

        begin, stop = trimmed(text, begin, stop)
        if free and cursor < end:  # more than ten fields: they go on, and no continuation has a name
            extra = begin
            while extra < end and reason == 0:
                cursor = field_end(text, extra, end)
                first, last = trimmed(text, extra, cursor)
                signed = first < last and (text[first] == PLUS or text[first] == STAR)
                if not signed and count < MOST_FIELDS:
                    fields[count, 0], fields[count, 1] = first, last
                    count += 1
                elif first < last and not signed:
                    reason = CROWDED
                extra = cursor + 1
            begin = stop = end
        awaited = begin < stop and (text[begin] == PLUS or text[begin] == STAR)
        begin, stop = bare_name(text, begin, stop)

        position, starred = line_end(text, end) + 1, large
        kind = line_kind(text, position)
        while kind == NOTHING and position < text.size:
            position = line_end(text, position) + 1
            kind = line_kind(text, position)
    if reason == 0 and awaited:
        wrong[0], wrong[1] = begin, stop
        reason = DANGLING
    return reason, count, position


@kernel
def split_at_tabs(
    text: Bytes, place: int, end: int, width: int, fields: Integers, first: int, last: int, wrong: Integers
) -> tuple[int, int]:
    """Put the fields of a fixed line with tabs into `fields[first:last]`; a tab goes to the next multiple of 8
    columns.

    Nothing tells a number that is too long for its columns from two that touch: both are refused, as the
    `wrong` span.

    Returns:
        First byte and end of what stands in the field after these, the name of the continuation.
    """
    for k in range(first, last):
        fields[k, 0] = fields[k, 1] = end
    begin, stop, column = end, end, 0
    start, slot_before = place, -2  # of the word at hand; -2 where the byte before is blank
    for i in range(place, end):
        slot = first + (column - 8) // width if column >= 8 else -1
        if text[i] <= BLANK:
            slot_before = -2
        else:
            if slot_before == -2:
                start = i
            elif slot_before != slot:
                wrong[0], wrong[1] = start, word_end(text, i, end)
            if slot >= last:
                begin, stop = min(begin, i), i + 1
            elif slot >= 0:
                fields[slot, 0], fields[slot, 1] = min(fields[slot, 0], i), i + 1
            slot_before = slot
        column = (column // 8 + 1) * 8 if text[i] == TAB else column + 1
    return begin, stop


@kernel
def word_end(text: Bytes, place: int, end: int) -> int:
    """Return the place of the next blank, or `end`."""
    while place < end and text[place] > BLANK:
        place += 1
    return place


@kernel
def name_end(text: Bytes, place: int, end: int) -> int:
    """Return the end of the first field of a line: 8 columns, or up to a tab."""
    end, i = min(place + 8, end), place
    while i < end and text[i] != TAB:
        i += 1
    return i


@kernel
def field_end(text: Bytes, begin: int, end: int) -> int:
    """Return the place of the next comma, or `end`."""
    while begin < end and text[begin] != COMMA:
        begin += 1
    return begin


@kernel
def trimmed(text: Bytes, begin: int, end: int) -> tuple[int, int]:
    """Strip the blanks around a span."""
    while begin < end and text[begin] <= BLANK:
        begin += 1
    while begin < end and text[end - 1] <= BLANK:
        end -= 1
    return begin, end


@kernel
def bare_name(text: Bytes, begin: int, end: int) -> tuple[int, int]:
    """Strip the blanks around the name of a continuation, and the sign before it."""
    begin, end = trimmed(text, begin, end)
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
    i = begin + 1 if begin < end and text[begin] == PLUS else begin
    number = 0 if 0 < end - i <= 18 else -1
    while i < end and number >= 0:
        digit = int(text[i]) - ZERO
        number = 10 * number + digit if 0 <= digit <= 9 else -1
        i += 1
    return number


# Eight characters at once, in the bytes of one word (Lemire, Quickly parsing eight digits, 2022; here with blanks
# before or after the digits). Five times as fast as one by one, and most of a file is whole numbers.
SEVENS = np.uint64(0x7F7F7F7F7F7F7F7F)
DIGITS = np.uint64(0x3030303030303030)
BEYOND_NINE = np.uint64(0x7676767676767676)  # added to the seven low bits, sets the eighth from 10 on
TOP_BITS = np.uint64(0x8080808080808080)
SPACED = np.uint64(0x1010101010101010)  # the bit that tells a digit from a blank
LOW = np.uint64(0xFF)


@kernel(allocates=False, inline=True)
def eight_bytes(text: Bytes, place: int) -> Any:
    """The eight bytes from `place` on as a word, the first one lowest."""
    word, at = np.uint64(0), np.uint64(place)
    for k in range(8):
        word |= np.uint64(text[at + np.uint64(k)]) << np.uint64(8 * k)
    return word


@kernel(allocates=False, inline=True)
def parse_eight(word: Any) -> Any:
    """The whole number in a word of `eight_bytes`, 0 where all are blank; -1 for anything but blanks, digits, blanks."""
    shifts = 0
    while word >> np.uint64(56) == np.uint64(BLANK) and shifts < 8:
        word = word << np.uint64(8) | np.uint64(BLANK)
        shifts += 1
    digits = (word | SPACED) ^ DIGITS  # a blank becomes 0
    blanks = (~word & SPACED) >> np.uint64(4)  # 1 in each byte that may be a blank
    wrong = (((digits & SEVENS) + BEYOND_NINE) | digits) & TOP_BITS
    wrong |= (blanks * np.uint64(0x0F)) & word  # an exclamation mark, say, which is 1 but for that bit
    full = blanks * LOW
    wrong |= full & (~full << np.uint64(8))  # a blank after a digit
    number = np.int64(-1)
    if wrong == np.uint64(0):
        pairs = digits * np.uint64(10) + (digits >> np.uint64(8))  # in the bytes 0, 2, 4, 6
        tens = (pairs & LOW) * np.uint64(10_000) + (pairs >> np.uint64(16) & LOW) * np.uint64(100)
        tens += pairs >> np.uint64(32) & LOW
        number = np.int64(tens * np.uint64(100) + (pairs >> np.uint64(48) & LOW))
    return number


@kernel
def parse_real(text: Bytes, begin: int, end: int) -> tuple[int, float]:
    """Parse the number in a field that is not blank: `1.5`, `-.25`, `1.5-3`, `1.+2`, `1.0D+3`, `2e5`, `1.5  -3`.

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
    while i < end and text[i] == BLANK:  # an exponent may stand at the right of its field
        i += 1
    lettered = i < end and (text[i] | 32 == SMALL_E or text[i] | 32 == SMALL_D)
    if lettered:
        i += 1
        while i < end and text[i] == BLANK:
            i += 1
    signed = i < end and (text[i] == PLUS or text[i] == MINUS)
    sign = -1 if signed and text[i] == MINUS else 1
    if signed:
        i += 1
    exponent, exponent_begin = 0, i
    while (lettered or signed) and i < end and ZERO <= text[i] <= NINE:
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
