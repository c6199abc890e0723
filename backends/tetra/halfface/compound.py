"""Compound numbers: a base in the lower bits of a word, an extension of three bits above. Source: thesis, 5.6.1.

A half-face is a compound number: half-face X of tetra t is (t, INNER + X), border half-face b is (b, BORDER). So is what a
vertex says of itself (`V2HF`), and a word of a tetra's connectivity, whose extension holds flags.

A word is a uint32 with a base of 29 bits, or an int64 with a base of 60: the kernels read the width off the array, which
costs nothing, for it is part of its type. In kernels and handles all numbers are int64.
"""

from typing import Any

import numpy as np

from tetrabench.errors import InputError
from tetrabench.jit import kernel

BORDER, INNER = 0, 1
"""Extensions of half-faces: INNER + X for half-face X = 0..3 of a tetra."""

DELETED, SPECIAL = 5, 6
"""Further extensions of what a vertex says: deleted, with the next deleted one as base; isolated (base 0) or non-manifold."""

FLAG = 4
"""In the extension of a tetra's first vertex: the delete flag."""

WORDS = {32: np.uint32, 64: np.int64}
"""The type of a word, by its bits."""

_BASES = {32: 29, 64: 60}
_VERTICES = 31  # bits of a vertex in an edge, and in a mesh


@kernel(allocates=False, inline=True)
def base_bits(words: Any) -> Any:
    """How many bits the base of a word has."""
    return np.int64(29 if words.itemsize == 4 else 60)


@kernel(allocates=False, inline=True)
def base_mask(words: Any) -> Any:
    """The largest base, all ones: the base of no element."""
    return (np.int64(1) << base_bits(words)) - 1


@kernel(allocates=False, inline=True)
def base_of(words: Any, number: int) -> Any:
    """The base of a compound number, int64."""
    return np.int64(number) & base_mask(words)


@kernel(allocates=False, inline=True)
def extension_of(words: Any, number: int) -> Any:
    """The extension of a compound number, 0..7."""
    return np.int64(number) >> base_bits(words)


@kernel(allocates=False, inline=True)
def compound(words: Any, base: int, extension: int) -> Any:
    """The compound number of a base and an extension."""
    return np.int64(extension) << base_bits(words) | np.int64(base)


def refuse_beyond(bits: int, **counts: int) -> None:
    """Refuse a mesh that compound numbers of this width cannot count.

    Args:
        bits: of a word, 32 or 64.
        counts: how many of what, such as tetrahedra=3.

    Raises:
        InputError: one of them is too many, or below 0.
    """
    if bits not in WORDS:
        raise InputError(f"a half-face mesh has words of 32 or 64 bits, not {bits}")
    for what, count in counts.items():
        if count < 0:
            raise InputError(f"there cannot be {count:,} {what.replace('_', ' ')}")
        power = min(_BASES[bits], _VERTICES) if what == "vertices" else _BASES[bits]
        if count >= 2**power:
            way_out = "; say bits=64" if bits == 32 else ""
            raise InputError(
                f"{count:,} {what.replace('_', ' ')}: words of {bits} bits count up to 2^{power} - 1{way_out}"
            )
