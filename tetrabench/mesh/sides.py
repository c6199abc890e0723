"""Sides of tetras, matched with each other. (A stand-in: replaced by the kernels of tetra/adjacency.py.)"""

import numpy as np
from numpy.typing import NDArray

from tetrabench.errors import InputError


def side_neighbours(tets: NDArray[np.int32]) -> NDArray[np.int32]:
    """The tetra behind each side.

    Args:
        tets: (n, 4) int32, vertices of each tetra, all different and not negative.

    Returns:
        (n, 4) int32: row of the tetra that shares the side opposite vertex i, -1 where there is none.

    Raises:
        InputError: a side is shared by three tetras or more.
    """
    sides, starts = _sorted_sides(tets)
    lengths = np.diff(starts)
    if (lengths > 2).any():
        first = starts[np.argmax(lengths > 2)]
        one, two, three = (sides[first : first + 3] // 4).tolist()
        raise InputError(f"tetras {one}, {two} and {three} (counted from 0) share one side: no net can hold that")
    neighbours = np.full(4 * len(tets), -1, np.int32)
    pairs = starts[:-1][lengths == 2]
    neighbours[sides[pairs]] = sides[pairs + 1] // 4
    neighbours[sides[pairs + 1]] = sides[pairs] // 4
    return neighbours.reshape(-1, 4)


def crowded_tetras(tets: NDArray[np.int32]) -> NDArray[np.int64]:
    """Rows, ascending, of the tetras that are one too many at some side: all but its first two."""
    sides, starts = _sorted_sides(tets)
    rank = np.arange(len(sides)) - np.repeat(starts[:-1], np.diff(starts))
    return np.unique(sides[rank > 1] // 4)


def _sorted_sides(tets: NDArray[np.int32]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Numbers 4 * tetra + side, equal sides together in the order of the file; where each group starts."""
    corners = np.sort(np.asarray(tets)[:, [[1, 2, 3], [2, 3, 0], [3, 0, 1], [0, 1, 2]]].reshape(-1, 3), axis=1)
    sides = np.lexsort(corners.T)
    ordered = corners[sides]
    new = np.append(True, (ordered[1:] != ordered[:-1]).any(axis=1))[: len(sides)]
    return sides, np.append(np.flatnonzero(new), len(sides))
