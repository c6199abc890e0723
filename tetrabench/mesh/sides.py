"""Side neighbours of all tetras at once: faces in buckets by their smallest vertex, sorted and matched in the bucket."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from tetrabench.errors import InputError
from tetrabench.jit import kernel

_LONG = 200  # faces in a bucket from which on insertion sort would be quadratic in earnest


def side_neighbours(tets: NDArray[np.int32]) -> NDArray[np.int32]:
    """The tetra behind each side.

    Args:
        tets: (n, 4) int32, vertices of each tetra, all different and not negative.

    Returns:
        (n, 4) int32: row of the tetra that shares the side opposite vertex i, -1 where there is none.

    Raises:
        InputError: a side is shared by three tetras or more; names them, counted from 0.
    """
    tets = np.require(tets, np.int32, ["C", "W", "O"])
    neighbours = np.empty((len(tets), 4), np.int32)
    points = int(tets.max()) + 1 if len(tets) else 0
    one, two, three = match_sides(tets, points, neighbours)
    if three >= 0:
        raise InputError(f"tetras {one}, {two} and {three} (counted from 0) share one side: no net can hold that")
    return neighbours


@kernel
def match_sides(tets: Any, points: int, neighbours: Any) -> tuple[int, int, int]:
    """Fill `neighbours`; returns three tetras that share a side, or (-1, -1, -1).

    O(n) but for the sorting of each vertex's few faces. A face is kept as one key (its two larger vertices) and one
    number (4 * tetra + side).
    """
    starts = np.zeros(points + 2, np.int64)
    keys = np.empty(4 * len(tets), np.int64)
    sides = np.empty(4 * len(tets), np.int32)
    for t in range(len(tets)):
        a, b, c, d = tets[t, 0], tets[t, 1], tets[t, 2], tets[t, 3]
        low, high = min(a, b), max(a, b)
        low_other, high_other = min(c, d), max(c, d)
        smallest = min(low, low_other)
        second = min(max(low, low_other), min(high, high_other))
        # the smallest vertex is the smallest of three sides, the second smallest of the fourth
        starts[smallest + 2] += 3
        starts[second + 2] += 1
    for v in range(points):
        starts[v + 2] += starts[v + 1]
    for t in range(len(tets)):
        for i in range(4):
            a, b, c = tets[t, (i + 1) & 3], tets[t, (i + 2) & 3], tets[t, (i + 3) & 3]
            low, high = min(a, b), max(a, b)
            smallest, largest = min(low, c), max(high, c)
            middle = max(low, min(high, c))
            place = starts[smallest + 1]
            starts[smallest + 1] = place + 1
            keys[place] = np.int64(middle) << 32 | np.int64(largest)
            sides[place] = 4 * t + i
            neighbours[t, i] = -1
    for v in range(points):
        begin, end = starts[v], starts[v + 1]
        if end - begin > _LONG:
            order = np.argsort(keys[begin:end], kind="mergesort")
            keys[begin:end] = keys[begin:end][order]
            sides[begin:end] = sides[begin:end][order]
        else:
            for j in range(begin + 1, end):
                key, side = keys[j], sides[j]
                while j > begin and keys[j - 1] > key:
                    keys[j], sides[j] = keys[j - 1], sides[j - 1]
                    j -= 1
                keys[j], sides[j] = key, side
        for j in range(begin, end - 1):
            if keys[j] == keys[j + 1]:
                s, r = sides[j], sides[j + 1]
                if j + 2 < end and keys[j + 2] == keys[j]:
                    return s >> 2, r >> 2, sides[j + 2] >> 2
                neighbours[s >> 2, s & 3] = r >> 2
                neighbours[r >> 2, r & 3] = s >> 2
    return -1, -1, -1
