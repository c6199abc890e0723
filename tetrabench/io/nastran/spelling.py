"""Numbers that `parse_real` leaves, or that stand in rare cards: spelled as Python does, and rounded by float()."""

import re

import numpy as np

from tetrabench.io.nastran.cards import (
    BLANK,
    INTEGER,
    MINUS,
    PLUS,
    REAL,
    REASONS,
    SMALL_D,
    SMALL_E,
    Bytes,
    Integers,
    Reals,
)
from tetrabench.jit import kernel

NUMBER = re.compile(r"([+-]?(?:\d+\.?\d*|\.\d+)) *(?:[ED] *([+-]?\d+)|([+-]\d+))?", re.ASCII | re.IGNORECASE)
ROOM = 32  # bytes of a number as it is usually written


def real_number(words: str) -> float:
    """The number in a field, in any of the spellings that `parse_real` takes.

    Raises:
        ValueError: it is none, or beyond the largest one.
    """
    match = NUMBER.fullmatch(words.strip())
    if match is None:
        raise ValueError(REASONS[REAL].format(field=words))
    value = float(f"{match[1]}e{match[2] or match[3] or 0}")
    if not np.isfinite(value):
        raise ValueError(f"{words} is beyond the largest number")
    return value


def whole_number(words: str) -> int:
    """The whole number in a field.

    Raises:
        ValueError: it is none.
    """
    if not re.fullmatch("[+]?[0-9]+", words):
        raise ValueError(REASONS[INTEGER].format(field=words))
    return int(words)


def convert(text: Bytes, spans: Integers) -> Reals:
    """Convert many numbers at once.

    Args:
        text: bytes of a file.
        spans: (n, 2) int64, first byte and end of each number in `text`; `parse_real` has found that they are some.

    Returns:
        (n,) float64; what is not finite is left to `real_number`: a number beyond the largest one, or of many digits.
    """
    short = spans[:, 1] - spans[:, 0] < ROOM  # an `e` may be put in
    spelled = np.zeros((np.count_nonzero(short), ROOM), np.uint8)
    spell(text, spans[short], spelled)
    values = np.full(len(spans), np.nan)
    with np.errstate(over="ignore"):
        values[short] = spelled.view(f"S{ROOM}").ravel().astype(np.float64)
    return values


@kernel
def spell(text: Bytes, spans: Integers, spelled: Bytes) -> None:
    """Copy each number into a row of `spelled`, as Python spells it: 1.5-3 and 1.5D-3 mean 1.5e-3."""
    for row in range(len(spans)):
        length, exponent = 0, False
        for i in range(spans[row, 0], spans[row, 1]):
            lettered = text[i] | 32 == SMALL_D or text[i] | 32 == SMALL_E
            signed = text[i] == PLUS or text[i] == MINUS
            if lettered or (signed and length > 0 and not exponent):
                spelled[row, length] = SMALL_E
                length += 1
                exponent = True
            if text[i] > BLANK and not lettered:
                spelled[row, length] = text[i]
                length += 1
