"""The order in which a tetra's vertices were given, as one of 24 numbers: tetras are stored with ascending vertices.

Source: thesis, 5.6.3. A permutation is a byte, two bits for each vertex: bits 2i and 2i + 1 are the place, among the
ascending ones, of vertex i as it was given. NUMBERS says which of the 24 it is, PLACES which byte a number stands for.
"""

from itertools import permutations
from typing import Any

import numpy as np

from tetrabench.jit import kernel
from tetrabench.mesh.sides import ascending

_BYTES = [sum(place << 2 * i for i, place in enumerate(places)) for places in permutations(range(4))]

PLACES = np.array(_BYTES + [_BYTES[0]] * 8, np.uint8)
"""(32,) uint8: the byte of each number; a tetra has five bits for the number, of which 24 values are in use."""

NUMBERS = np.zeros(256, np.uint8)
"""(256,) uint8: the number of each byte that is a permutation."""
NUMBERS[_BYTES] = np.arange(24)


@kernel(allocates=False, inline=True)
def sorted_with_number(a: int, b: int, c: int, d: int) -> tuple[Any, Any, Any, Any, Any]:
    """Four vertices in ascending order, and the number of the permutation that restores their order."""
    a, b, c, d = ascending(a, b, c, d)
    places = (1 << 2 * (b & 3)) | (2 << 2 * (c & 3)) | (3 << 2 * (d & 3))  # (a has place 0)
    return a >> 2, b >> 2, c >> 2, d >> 2, np.int64(NUMBERS[places])


@kernel(allocates=False, inline=True)
def place_of(number: int, i: int) -> Any:
    """The place, among the ascending vertices, of vertex i as it was given."""
    return np.int64(PLACES[np.uint64(number)]) >> 2 * i & 3
