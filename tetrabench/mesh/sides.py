"""Which tetra lies behind each side, for all tetras at once: sides in buckets by their smallest vertex, hashed there."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from tetrabench.errors import InputError
from tetrabench.jit import kernel
from tetrabench.memory import refuse_if_too_large
from tetrabench.mesh.tetra_mesh import as_vertices

Tets = NDArray[np.int32]

SIDE = np.dtype([("key", np.int64), ("side", np.int64)])
"""A side in its bucket: the middle one of its vertices << 32 | the largest; 4 * tetra + number of the side in it."""

_NONE, _MATCHED = -1, -1
_KNUTH = 2654435769  # 2^32 times the golden section (The Art of Computer Programming 3, 6.4)


def side_neighbours(tets: Tets) -> NDArray[np.int32]:
    """The tetra behind each side.

    Args:
        tets: (n, 4) int32, vertices of each tetra, all different and not negative.

    Returns:
        (n, 4) int32: row of the tetra that shares the side opposite vertex i, -1 where there is none.

    Raises:
        InputError: tets of another shape, or with a negative vertex; a tetra repeats a vertex, or a side is shared by
            three tetras or more: names them, counted from 0.
        MemoryRefusedError: the largest vertex is so large that a counter for each vertex is beyond the memory.
    """
    pairs = side_pairs(tets)
    pairs >>= 2  # what has no partner stays -1
    return pairs.astype(np.int32, copy=False)


def side_pairs(tets: Tets) -> NDArray[Any]:
    """The side behind each side.

    Args:
        tets: (n, 4) int32, vertices of each tetra, all different and not negative.

    Returns:
        (n, 4) int32, int64 from 2^29 tetras on: 4 * row + number of the side that is the same as the one opposite vertex i,
        -1 where there is none.

    Raises:
        InputError, MemoryRefusedError: as `side_neighbours`.
    """
    pairs, crowded = _match(tets)
    if len(crowded):
        one, two, three = _first_sharers(tets, crowded[0])
        raise InputError(f"tetras {one}, {two} and {three} (counted from 0) share one side: no net can hold that")
    return pairs


def crowded_tetras(tets: Tets) -> NDArray[np.int64]:
    """The tetras that are one too many at some side: all who share it but the first two.

    Without them no side is shared by more than two.

    Args:
        tets: (n, 4) int32, vertices of each tetra, all different and not negative.

    Returns:
        (k,) int64, their rows, ascending.

    Raises:
        InputError: as `side_neighbours`, but for what it is here to find.
    """
    return _match(tets)[1]


def _match(tets: Tets) -> tuple[NDArray[Any], NDArray[np.int64]]:
    """Pairs (n, 4), of sides with two tetras, and the rows of crowded tetras (k,)."""
    tets = as_vertices(tets)
    points = int(tets.max()) + 1 if len(tets) else 0
    if points > 4 * len(tets):  # numbers with gaps, how wide nobody knows
        refuse_if_too_large(f"matching sides of vertices up to {points - 1:,}", 8 * points, "number them without gaps")
    # allocated here, not in a kernel: numpy asks the system for large pages, numba does not
    pairs = np.full((len(tets), 4), _NONE, np.int32 if len(tets) < 2**29 else np.int64)
    starts, sides = np.zeros(points + 2, np.int64), np.empty(4 * len(tets), SIDE)
    fullest = _distribute(tets, starts, sides)
    if fullest < 0:
        raise InputError(f"tetra {-1 - fullest} (counted from 0) repeats a vertex")
    table, crowded = np.empty(_table_size(fullest), SIDE), np.zeros(len(tets), np.bool_)
    _match_buckets(starts, sides, table, pairs, crowded)
    return pairs, np.flatnonzero(crowded)


def _first_sharers(tets: Tets, crowded: int) -> list[int]:
    """The first three of the tetras that share a side of this one."""
    for i in range(4):
        side = np.delete(tets[crowded], i)
        sharers = np.flatnonzero(np.isin(tets, side).sum(axis=1) == 3)
        if len(sharers) > 2:
            break
    return [int(row) for row in sharers[:3]]


@kernel(allocates=False)
def _distribute(tets: Any, starts: Any, sides: Any) -> Any:
    """Put the sides into buckets by their smallest vertex v, sides[starts[v]:starts[v + 1]], where the tetras ascend.

    `starts` comes with zeros. Returns the size of the fullest bucket; -1 - t, where tetra t repeats a vertex.
    """
    fullest = np.int64(0)
    for t in range(len(tets)):
        a, b, c, d = ascending(tets[t, 0], tets[t, 1], tets[t, 2], tets[t, 3])
        if a >> 2 == b >> 2 or b >> 2 == c >> 2 or c >> 2 == d >> 2:
            return np.int64(-1 - t)
        # the smallest vertex is the smallest of three sides, the second smallest of the fourth
        starts[(a >> 2) + 2] += 3
        starts[(b >> 2) + 2] += 1
    for v in range(2, len(starts)):
        fullest = max(fullest, starts[v])
        starts[v] += starts[v - 1]
    for t in range(len(tets)):
        a, b, c, d = ascending(tets[t, 0], tets[t, 1], tets[t, 2], tets[t, 3])
        bc, bd, cd = b >> 2 << 32 | c >> 2, b >> 2 << 32 | d >> 2, c >> 2 << 32 | d >> 2
        place = starts[(a >> 2) + 1]
        starts[(a >> 2) + 1] = place + 3
        sides[place]["key"], sides[place]["side"] = bc, 4 * t + (d & 3)
        sides[place + 1]["key"], sides[place + 1]["side"] = bd, 4 * t + (c & 3)
        sides[place + 2]["key"], sides[place + 2]["side"] = cd, 4 * t + (b & 3)
        place = starts[(b >> 2) + 1]
        starts[(b >> 2) + 1] = place + 1
        sides[place]["key"], sides[place]["side"] = cd, 4 * t + (a & 3)
    return fullest


@kernel(allocates=False, inline=True)
def ascending(a: Any, b: Any, c: Any, d: Any) -> tuple[Any, Any, Any, Any]:
    """The vertices of a tetra in ascending order, each as 4 * vertex + its number in the tetra."""
    a, b = np.int64(a) << 2, np.int64(b) << 2 | 1
    c, d = np.int64(c) << 2 | 2, np.int64(d) << 2 | 3
    a, b = min(a, b), max(a, b)
    c, d = min(c, d), max(c, d)
    a, c = min(a, c), max(a, c)
    b, d = min(b, d), max(b, d)
    return a, min(b, c), max(b, c), d


@kernel(allocates=False)
def _match_buckets(starts: Any, sides: Any, table: Any, pairs: Any, crowded: Any) -> None:
    """Find the sides of each bucket that are the same, by a hash table of the bucket (open addressing).

    The table is at most half full and stays in the processor's cache; a bucket of any size takes linear time.
    """
    for v in range(len(starts) - 2):
        begin, end = starts[v], starts[v + 1]
        size = _table_size(end - begin)
        for place in range(size):
            table[place]["key"] = _NONE
        for j in range(begin, end):
            key, side = sides[j]["key"], sides[j]["side"]
            place = _hash(key) & (size - 1)
            while table[place]["key"] != _NONE and table[place]["key"] != key:
                place = (place + 1) & (size - 1)
            other = table[place]["side"]
            if table[place]["key"] == _NONE:
                table[place]["key"], table[place]["side"] = key, side
            elif other == _MATCHED:
                crowded[side >> 2] = True
            else:
                pairs[side >> 2, side & 3] = other
                pairs[other >> 2, other & 3] = side
                table[place]["side"] = _MATCHED


@kernel(allocates=False, inline=True)
def _table_size(sides: int) -> int:
    """A power of two, twice as many as `sides` at least."""
    size = 32
    while size < 2 * sides:
        size *= 2
    return size


@kernel(allocates=False, inline=True)
def _hash(key: int) -> int:
    """32 bits that depend on all bits of a key."""
    mixed = (key >> 32) * _KNUTH >> 1 & 0x7FFFFFFF ^ key & 0x7FFFFFFF  # 31 bits times 32 bits stay below 2^63
    mixed = mixed * _KNUTH & 0xFFFFFFFF
    return mixed >> 16 ^ mixed
