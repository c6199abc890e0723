"""Sorted list of holes (V3, V5): singly linked, in increasing order; its last element is the end of the net.

Insert takes the first element; delete walks the list to the right place, O(holes); iteration advances the index and the
list in parallel. Source: thesis, 4.4.1 and 4.4.5. Holes that touch the end are dropped from the list.
"""

from typing import NamedTuple

import numpy as np
from numba.extending import register_jitable
from numpy.typing import NDArray

from tetrabench.jit import implements
from tetrabench.tetra import interface
from tetrabench.tetra.interface import NONE, Cursor
from tetrabench.tetra.memory import array_bytes, buffers
from tetrabench.tetra.points import grown

LIVE, FIRST, LAST, SPARE, USED = 0, 1, 2, 3, 4  # places in the counters
SLOT, NEXT = 0, 1  # columns of an element
NOWHERE = -1


class SortedList(NamedTuple):
    """The holes in increasing order, and after them the end: one past the last live tetra.

    Attributes:
        elements: (capacity + 1, 2) int32: slot, and place of the next element (NOWHERE after the last).
        counters: (5,) int64: LIVE tetras; places of the FIRST and the LAST element of the list and of the first SPARE
            one (chained by NEXT); elements USED so far.
    """

    elements: NDArray[np.int32]
    counters: NDArray[np.int64]


def make_sorted_list(capacity: int) -> SortedList:
    """A list without holes, the end at slot 0."""
    elements = np.empty((capacity + 1, 2), np.int32)
    elements[0] = 0, NOWHERE
    return SortedList(elements, np.array([0, 0, 0, NOWHERE, 1], np.int64))


@implements(interface.grown_slots, SortedList)
def grown_slots(net, capacity):
    return SortedList(grown(net.slots.elements, capacity + 1), net.slots.counters.copy())


@implements(interface.number_of_tetras, SortedList)
def number_of_tetras(net):
    return net.slots.counters[LIVE]


@implements(interface.slots_used, SortedList)
def slots_used(net):
    return np.int64(net.slots.elements[net.slots.counters[LAST], SLOT])


@implements(interface.first_tetra, SortedList)
def first_tetra(net):
    hole = net.slots.counters[FIRST]
    limit = np.int64(net.slots.elements[hole, SLOT])
    return _skip_holes(net, np.int64(0), hole, limit)


@implements(interface.next_tetra, SortedList)
def next_tetra(net, cursor):
    return _skip_holes(net, cursor.tetra + 1, cursor.hole, cursor.limit)


@register_jitable(forceinline=True)
def _skip_holes(net, t, hole, limit):
    """The first live slot from t on; `limit` is the slot of the element `hole`, the next hole or the end."""
    # No array gets a name of its own here: numba would count its references, atomically, at every step of a sweep.
    while t == limit and hole != net.slots.counters[LAST]:
        hole = np.int64(net.slots.elements[hole, NEXT])
        limit = np.int64(net.slots.elements[hole, SLOT])
        t += 1
    return Cursor(t if t < limit else NONE, hole, limit)


@implements(interface.last_tetra, SortedList)
def last_tetra(net):
    return np.int64(net.slots.elements[net.slots.counters[LAST], SLOT]) - 1  # the end is never behind a hole


@implements(interface.is_live, SortedList)
def is_live(net, t):
    elements = net.slots.elements
    hole = net.slots.counters[FIRST]
    while elements[hole, SLOT] < t and elements[hole, NEXT] != NOWHERE:
        hole = np.int64(elements[hole, NEXT])
    return t >= 0 and t < elements[hole, SLOT]


@implements(interface.take_slot, SortedList)
def take_slot(net):
    elements, counters = net.slots.elements, net.slots.counters
    first = counters[FIRST]
    t = np.int64(elements[first, SLOT])
    if first == counters[LAST]:
        elements[first, SLOT] = t + 1
    else:
        counters[FIRST] = elements[first, NEXT]
        elements[first, NEXT] = counters[SPARE]
        counters[SPARE] = first
    counters[LIVE] += 1
    return t


@implements(interface.drop_slot, SortedList)
def drop_slot(net, t):
    elements, counters = net.slots.elements, net.slots.counters
    counters[LIVE] -= 1
    last = counters[LAST]
    before, place = np.int64(NOWHERE), counters[FIRST]
    run = np.int64(NOWHERE)  # the element before the run of adjoining holes that ends at `before`
    while elements[place, SLOT] < t:  # the walk that makes this policy slow: O(holes)
        if before != NOWHERE and elements[before, SLOT] + 1 != elements[place, SLOT]:
            run = before
        before, place = place, np.int64(elements[place, NEXT])
    if t + 1 < elements[last, SLOT]:  # a hole in the middle
        spare = counters[SPARE]
        if spare != NOWHERE:
            counters[SPARE] = elements[spare, NEXT]
        else:
            spare = counters[USED]
            counters[USED] = spare + 1
        elements[spare, SLOT] = t
        elements[spare, NEXT] = place
        if before == NOWHERE:
            counters[FIRST] = spare
        else:
            elements[before, NEXT] = spare
    else:  # the last tetra: the end moves down, over the run of holes that it now touches
        end = t
        if before != NOWHERE and elements[before, SLOT] == t - 1:
            first = counters[FIRST] if run == NOWHERE else np.int64(elements[run, NEXT])
            end = np.int64(elements[first, SLOT])
            elements[before, NEXT] = counters[SPARE]
            counters[SPARE] = first
            if run == NOWHERE:
                counters[FIRST] = last
            else:
                elements[run, NEXT] = last
        elements[last, SLOT] = end


@implements(interface.slot_faults, SortedList)
def slot_faults(net):
    elements, counters = net.slots.elements, net.slots.counters
    seen = np.zeros(len(elements), np.bool_)
    holes, faults, before = 0, 0, -1
    place = counters[FIRST]
    while place >= 0 and place < len(elements) and not seen[place]:
        seen[place] = True
        if elements[place, SLOT] <= before:
            faults += 1  # out of order
        before = elements[place, SLOT]
        if elements[place, NEXT] == NOWHERE:
            break
        if elements[place, SLOT] + 1 == elements[counters[LAST], SLOT]:
            faults += 1  # a hole touches the end
        holes += 1
        place = np.int64(elements[place, NEXT])
    if place != counters[LAST]:
        faults += 1
    if counters[LIVE] + holes != elements[counters[LAST], SLOT]:
        faults += 1
    spare, spares = counters[SPARE], 0
    while spare >= 0 and spare < len(elements) and not seen[spare]:
        seen[spare] = True
        spares += 1
        spare = np.int64(elements[spare, NEXT])
    if spare != NOWHERE or holes + 1 + spares != counters[USED]:
        faults += 1
    return faults


@buffers.register
def _(part: SortedList, net):
    return {"holes": (array_bytes(part.elements, int(part.counters[USED])), part.elements.nbytes)}
