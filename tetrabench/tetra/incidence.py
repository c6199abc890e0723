"""The tetras around each point as linked lists in one pool, new entries to the front; and how tetras come and go with them.

Most contestants take it: it is one way to implement what the interface has under "around a point".
"""

from typing import Any, NamedTuple

import numpy as np
from numba.extending import register_jitable
from numpy.typing import NDArray

from tetrabench.jit import implements, kernel
from tetrabench.tetra import interface
from tetrabench.tetra.audit import is_known
from tetrabench.tetra.edit import check_editable, insert_point, reserve
from tetrabench.tetra.geometry import set_geometry
from tetrabench.tetra.interface import (
    NONE,
    STATES,
    Net,
    capacity,
    centroid,
    drop_slot,
    neighbour,
    number_of_tetras,
    set_neighbour,
    set_state,
    set_vertex,
    state,
    take_slot,
    vertex,
)
from tetrabench.tetra.nearest import make_stack
from tetrabench.tetra.points import COUNT, EDITS, grown

USED, FREE = 0, 1  # places in the counters
END = -1  # no further entry

FIRST = np.int64(0)
"""A zero of the type that sides have: a plain 0 would be another type to numba, and compile what it is passed to twice."""


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


# ---------------------------------------------------------------------------------------------------- questions


@implements(interface.a_tetra_around, Incidence)
def a_tetra_around(net: Net, point: int) -> Any:
    """The one that came last."""
    place = first_around(net.incidence, point)
    return ref_around(net.incidence, place) if place != END else NONE


@implements(interface.fill_around, Incidence)
def fill_around(net: Net, point: int, buffer: NDArray[np.int64]) -> int:
    """The list from the front, as far as it fits: its entries are anywhere in memory."""
    n, place = 0, first_around(net.incidence, point)
    while place != END and n < len(buffer):
        buffer[n] = ref_around(net.incidence, place)
        n += 1
        place = next_around(net.incidence, place)
    return n if place == END else n + 1


# ---------------------------------------------------------------------------------------------------- room


@implements(interface.enter_point, Incidence)
def enter_point(net: Net, point: int) -> None:
    """Nothing: its list is empty, as heads beyond the points are END."""


@implements(interface.incidence_room, Incidence)
def incidence_room(net: Net) -> int:
    """Four entries a tetra."""
    return len(net.incidence.entries) // 4


@implements(interface.grown_incidence, Incidence)
def grown_incidence(net: Net, points: int, tetras: int) -> Incidence:
    """New heads are END; new entries hold anything."""
    heads = net.incidence.heads
    if points > len(heads):
        heads = grown(heads, points)
        heads[len(net.incidence.heads) :] = END
    entries = net.incidence.entries
    if 4 * tetras > len(entries):
        entries = grown(entries, 4 * tetras)
    return Incidence(heads, entries, net.incidence.counters.copy())


# ---------------------------------------------------------------------------------------------------- edits


@implements(interface.insert_tetra, Incidence)
def insert_tetra(net: Net, a: int, b: int, c: int, d: int) -> int:
    """Its neighbours are found among the tetras around two of its points."""
    return _insert(net, a, b, c, d)


@kernel(allocates=False)
def _insert(net: Net, a: int, b: int, c: int, d: int) -> int:
    check_editable(net)
    if a == b or a == c or a == d or b == c or b == d or c == d:
        raise ValueError("the four points of a tetra must differ")
    if min(min(a, b), min(c, d)) < 0 or max(max(a, b), max(c, d)) >= net.points.counters[COUNT]:
        raise ValueError("there is no such point")
    if number_of_tetras(net) >= capacity(net) or 4 * number_of_tetras(net) + 4 > len(net.incidence.entries):
        raise ValueError("no room for a tetra: call reserve first")
    # sides 1, 2, 3 hold point a: their other tetras are around a
    n0, n1, n2, n3 = NONE, NONE, NONE, NONE
    i0, i1, i2, i3 = FIRST, FIRST, FIRST, FIRST  # the side of the neighbour that is shared
    place = first_around(net.incidence, a)
    while place != END:
        u = ref_around(net.incidence, place)
        place = next_around(net.incidence, place)
        shared, other = FIRST, FIRST
        for j in range(4):
            v = vertex(net, u, j)
            match = np.int64(v == b) | np.int64(v == c) << 1 | np.int64(v == d) << 2
            shared |= match
            other += j * np.int64((match == 0) & (v != a))
        if shared == 0b111:
            raise ValueError("there is such a tetra already")
        if shared == 0b110:
            _check_free(net, u, other, n1)
            n1, i1 = u, other
        elif shared == 0b101:
            _check_free(net, u, other, n2)
            n2, i2 = u, other
        elif shared == 0b011:
            _check_free(net, u, other, n3)
            n3, i3 = u, other
    # side 0 is (b, c, d): its other tetra is around b, without a
    place = first_around(net.incidence, b)
    while place != END:
        u = ref_around(net.incidence, place)
        place = next_around(net.incidence, place)
        shared, other = FIRST, FIRST
        for j in range(4):
            v = vertex(net, u, j)
            match = np.int64(v == c) | np.int64(v == d) << 1
            shared |= match
            other += j * np.int64((match == 0) & (v != b))
        if shared == 0b11:
            _check_free(net, u, other, n0)
            n0, i0 = u, other

    t = take_slot(net)
    set_vertex(net, t, 0, a)
    set_vertex(net, t, 1, b)
    set_vertex(net, t, 2, c)
    set_vertex(net, t, 3, d)
    _join(net, t, 0, n0, i0)
    _join(net, t, 1, n1, i1)
    _join(net, t, 2, n2, i2)
    _join(net, t, 3, n3, i3)
    for k in range(STATES):
        set_state(net, t, k, 0.0)
    set_geometry(net, t)
    for i in range(4):
        add_incidence(net.incidence, vertex(net, t, i), t)
    net.points.counters[EDITS] += 1
    return t


@implements(interface.delete_tetra, Incidence)
def delete_tetra(net: Net, t: int) -> None:
    """At once, and altogether."""
    _delete(net, t)


@kernel(allocates=False, inline=True)
def _delete(net: Net, t: int) -> None:
    check_editable(net)
    for i in range(4):
        if not remove_incidence(net.incidence, vertex(net, t, i), t):
            raise ValueError("there is no such tetra")
    for i in range(4):
        u = neighbour(net, t, i)
        if u != NONE:
            for j in range(4):
                if neighbour(net, u, j) == t:
                    set_neighbour(net, u, j, NONE)
    drop_slot(net, t)
    net.points.counters[EDITS] += 1


@kernel(allocates=False)
def _check_free(net: Net, u: int, side: int, found: int) -> None:
    if found != NONE or neighbour(net, u, side) != NONE:
        raise ValueError("two tetras share that side already")


@register_jitable
def _join(net: Net, t: int, i: int, u: int, j: int) -> None:
    set_neighbour(net, t, i, u)
    if u != NONE:
        set_neighbour(net, u, j, t)


@implements(interface.split_many, Incidence)
def split_many(net: Net, refs: NDArray[np.int64]) -> tuple[Net, int]:
    """One after the other: insert the point, delete the parent, insert four children."""
    stack, states = make_stack(), np.empty(STATES)  # before the net is outgrown: there may be no memory for them
    net = reserve(net, 3 * len(refs) + 1, len(refs))
    return net, _split_all(net, refs, stack, states)


@kernel(allocates=False)
def _split_all(net: Net, refs: Any, stack: Any, states: Any) -> int:
    skipped = 0
    for t in refs:
        points = net.points.counters[COUNT]
        centre = insert_point(net, centroid(net, t, 0), centroid(net, t, 1), centroid(net, t, 2), stack)
        if centre < points:
            skipped += 1
            continue
        a, b, c, d = vertex(net, t, 0), vertex(net, t, 1), vertex(net, t, 2), vertex(net, t, 3)
        for k in range(STATES):
            states[k] = state(net, t, k)
        _delete(net, t)
        for i in range(4):
            child = _insert(
                net,
                centre if i == 0 else a,
                centre if i == 1 else b,
                centre if i == 2 else c,
                centre if i == 3 else d,
            )
            for k in range(STATES):
                set_state(net, child, k, states[k])
    return skipped


@implements(interface.collect, Incidence)
def collect(net: Net) -> tuple[Net, bool]:
    """Nothing: a deletion leaves nothing."""
    return net, False


# ---------------------------------------------------------------------------------------------------- self-audit


@implements(interface.incidence_faults, Incidence)
def incidence_faults(net: Net, refs: NDArray[np.int64]) -> int:
    """See `_faults`."""
    return _faults(net, refs)


@kernel
def _faults(net: Net, refs: Any) -> int:
    """Each entry is in one list; each list holds tetras that use its point; 4 entries a tetra, none twice."""
    incidence, faults = net.incidence, 0
    used = incidence.counters[USED]
    if used < 0 or used > len(incidence.entries):
        return faults + 1
    seen = np.zeros(used, np.bool_)
    entries = 0
    for point in range(net.points.counters[COUNT]):
        place = first_around(incidence, point)
        while place != END:
            if place < 0 or place >= used or seen[place]:
                return faults + 1
            seen[place] = True
            entries += 1
            t = ref_around(incidence, place)
            if not is_known(refs, t):
                return faults + 1
            uses = 0
            for i in range(4):
                uses += int(vertex(net, t, i) == point)
            faults += int(uses != 1)
            other = first_around(incidence, point)
            while other != place:  # the same tetra twice in one list
                faults += int(ref_around(incidence, other) == t)
                other = next_around(incidence, other)
            place = next_around(incidence, place)
    faults += int(entries != 4 * len(refs))
    place, free = incidence.counters[FREE], 0
    while place != END:
        if place < 0 or place >= used or seen[place]:
            return faults + 1
        seen[place] = True
        free += 1
        place = next_around(incidence, place)
    faults += int(entries + free != used)
    return faults
