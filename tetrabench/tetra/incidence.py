"""The tetras around each point: an array of linked lists whose entries live in one pool; new entries go to the front."""

from typing import Any, NamedTuple

import numpy as np
from numba.extending import register_jitable
from numpy.typing import NDArray

from tetrabench.jit import kernel
from tetrabench.tetra.points import grown

USED, FREE = 0, 1  # places in the counters
END = -1  # no further entry


class Incidence(NamedTuple):
    """For each point the list of its tetras.

    Attributes:
        heads: (capacity of points,) int32, first entry of each point's list, END where no tetra uses the point.
        entries: (capacity,) records of `ref` (int32 index or int64 address) and `next` (int32, END at the end).
        counters: (2,) int64: entries USED so far, and the first of the chain of FREE ones among them, or END.
    """

    heads: NDArray[np.int32]
    entries: NDArray[np.void]
    counters: NDArray[np.int64]


def make_incidence(points: int, tetras: int, ref_dtype: type) -> Incidence:
    """Empty lists with room for `points` points and `tetras` tetras, whose refs are of `ref_dtype`."""
    entry = np.dtype([("ref", ref_dtype), ("next", np.int32)], align=True)
    return Incidence(np.full(points, END, np.int32), np.zeros(4 * tetras, entry), np.array([0, END], np.int64))


@register_jitable
def grown_incidence(incidence: Incidence, points: int, tetras: int) -> Incidence:
    """The same lists with room for more (never for less), and counters of their own."""
    heads = incidence.heads
    if points > len(heads):
        heads = grown(heads, points)
        heads[len(incidence.heads) :] = END
    entries = incidence.entries
    if 4 * tetras > len(entries):
        entries = grown(entries, 4 * tetras)
    return Incidence(heads, entries, incidence.counters.copy())


@kernel(allocates=False)
def add_incidence(incidence: Incidence, point: int, t: int) -> None:
    """Put tetra t at the front of a point's list; the room was made before."""
    place = incidence.counters[FREE]
    if place != END:
        incidence.counters[FREE] = incidence.entries[place]["next"]
    else:
        place = incidence.counters[USED]
        incidence.counters[USED] = place + 1
    entry = incidence.entries[place]
    entry["ref"] = t
    entry["next"] = incidence.heads[point]
    incidence.heads[point] = place


@kernel(allocates=False)
def remove_incidence(incidence: Incidence, point: int, t: int) -> bool:
    """Take tetra t out of a point's list; False, and nothing changed, where it is not in it."""
    before = np.int64(END)
    place = np.int64(incidence.heads[point])
    while place != END and incidence.entries[place]["ref"] != t:
        before = place
        place = np.int64(incidence.entries[place]["next"])
    if place == END:
        return False
    after = incidence.entries[place]["next"]
    if before == END:
        incidence.heads[point] = after
    else:
        incidence.entries[before]["next"] = after
    incidence.entries[place]["next"] = incidence.counters[FREE]
    incidence.counters[FREE] = place
    return True


@kernel(allocates=False)
def first_around(incidence: Incidence, point: int) -> Any:
    """The first entry of a point's list, END where there is none."""
    return np.int64(incidence.heads[point])


@kernel(allocates=False)
def next_around(incidence: Incidence, place: int) -> Any:
    """The entry after this one, or END."""
    return np.int64(incidence.entries[place]["next"])


@kernel(allocates=False)
def ref_around(incidence: Incidence, place: int) -> Any:
    """The tetra of an entry, int64."""
    return np.int64(incidence.entries[place]["ref"])
