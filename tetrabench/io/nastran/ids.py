"""Ids of points and tetras: from the ids that a deck uses to the rows that a mesh uses."""

import numpy as np
from numpy.typing import NDArray

from tetrabench.io.nastran.cards import Integers
from tetrabench.jit import kernel


def indices_of(ids: Integers, point_ids: Integers) -> tuple[NDArray[np.int32], NDArray[np.int32], int]:
    """Translate ids to indices into `point_ids`, to the first of equal ones.

    Args:
        ids: (m, 4), positive.
        point_ids: (n,), positive.

    Returns:
        (m, 4) int32; (n,) int32, the same for `point_ids` themselves; the flat index of the first id that is not
        there, or -1.
    """
    count = len(point_ids)
    most = int(point_ids.max(initial=0))
    if most < 16 * count + 1_000_000:
        table = np.full(most + 2, -1, np.int32)  # the last entry stands for all ids beyond
        table[point_ids[::-1]] = np.arange(count - 1, -1, -1, dtype=np.int32)
        found = np.empty(ids.shape, np.int32)
        missing = look_up(ids, table, found)
        return found, table[point_ids], missing
    ordered, first = np.unique(point_ids, return_index=True)
    places = np.minimum(np.searchsorted(ordered, ids), len(ordered) - 1)
    found = np.where(ordered[places] == ids, first[places], -1).astype(np.int32)
    missing = int(np.argmin(found.ravel())) if found.min(initial=0) < 0 else -1
    return found, first[np.searchsorted(ordered, point_ids)].astype(np.int32), missing


@kernel
def look_up(ids: Integers, table: NDArray[np.int32], found: NDArray[np.int32]) -> int:
    """Fill `found` from the table, whose last entry stands for all ids beyond; return the first that is missing."""
    missing, last = -1, len(table) - 1
    for row in range(len(ids) - 1, -1, -1):
        for k in range(3, -1, -1):
            found[row, k] = table[min(ids[row, k], last)]
            if found[row, k] < 0:
                missing = 4 * row + k
    return missing


def first_repeated(ids: Integers) -> int | None:
    """Find the first row whose id stands in an earlier row."""
    if (ids[1:] > ids[:-1]).all():
        return None
    order = np.argsort(ids, kind="stable")
    again = order[1:][ids[order[1:]] == ids[order[:-1]]]
    return int(again.min()) if again.size else None
