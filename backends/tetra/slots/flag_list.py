"""Flag and list (V3Y, V5Y): a negative volume for iteration, and an unsorted list of holes, last in, first out.

O(1) both ways. Source: thesis, 4.4.3 and 4.4.7. The end falls over free slots when the last tetra goes;
what the list still says of slots beyond the end is discarded when it is met.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tetrabench.jit import implements
from tetrabench.tetra import interface
from tetrabench.tetra.interface import DEAD, NONE, Cursor, set_volume, volume
from tetrabench.tetra.memory import array_bytes, buffers
from tetrabench.tetra.points import grown

LIVE, END, HOLES = 0, 1, 2  # places in the counters


class FlagList(NamedTuple):
    """The holes, in the order in which they were made.

    Attributes:
        holes: (capacity,) int32, the first `counters[HOLES]` of them in use.
        counters: (3,) int64: LIVE tetras; END, one past the last live tetra; HOLES in the list, stale ones included.
    """

    holes: NDArray[np.int32]
    counters: NDArray[np.int64]


def make_flag_list(capacity: int) -> FlagList:
    """No tetra and no hole."""
    return FlagList(np.empty(capacity, np.int32), np.zeros(3, np.int64))


@implements(interface.grown_slots, FlagList)
def grown_slots(net, capacity):
    return FlagList(grown(net.slots.holes, capacity), net.slots.counters.copy())


@implements(interface.number_of_tetras, FlagList)
def number_of_tetras(net):
    return net.slots.counters[LIVE]


@implements(interface.slots_used, FlagList)
def slots_used(net):
    return net.slots.counters[END]


@implements(interface.first_tetra, FlagList)
def first_tetra(net):
    t, limit = np.int64(0), net.slots.counters[END]
    while t < limit and volume(net, t) < 0.0:
        t += 1
    return Cursor(t if t < limit else NONE, 0, limit)


@implements(interface.next_tetra, FlagList)
def next_tetra(net, cursor):
    t, limit = cursor.tetra + 1, cursor.limit
    while t < limit and volume(net, t) < 0.0:
        t += 1
    return Cursor(t if t < limit else NONE, 0, limit)


@implements(interface.last_tetra, FlagList)
def last_tetra(net):
    return net.slots.counters[END] - 1


@implements(interface.is_live, FlagList)
def is_live(net, t):
    return t >= 0 and t < net.slots.counters[END] and volume(net, t) >= 0.0


@implements(interface.take_slot, FlagList)
def take_slot(net):
    counters = net.slots.counters
    end, left = counters[END], counters[HOLES]
    t = end
    while t == end and left > 0:
        left -= 1
        hole = np.int64(net.slots.holes[left])
        if hole < end:  # else the end has fallen over it since
            t = hole
    counters[HOLES] = left
    if t == end:
        counters[END] = end + 1
    counters[LIVE] += 1
    return t


@implements(interface.drop_slot, FlagList)
def drop_slot(net, t):
    counters = net.slots.counters
    set_volume(net, t, DEAD)
    counters[LIVE] -= 1
    if t == counters[END] - 1:
        end = t
        while end > 0 and volume(net, end - 1) < 0.0:
            end -= 1
        counters[END] = end
    else:
        net.slots.holes[counters[HOLES]] = t
        counters[HOLES] += 1


@implements(interface.slot_faults, FlagList)
def slot_faults(net):
    counters = net.slots.counters
    end, live, faults = counters[END], 0, 0
    listed = np.zeros(end, np.bool_)
    for place in range(counters[HOLES]):
        hole = net.slots.holes[place]
        if hole >= 0 and hole < end:
            if listed[hole] or volume(net, hole) >= 0.0:
                faults += 1  # listed twice, or no hole
            listed[hole] = True
        elif hole < 0 or hole >= len(net.slots.holes):
            faults += 1
    for t in range(end):
        if volume(net, t) >= 0.0:
            live += 1
        elif not listed[t]:
            faults += 1  # a hole that would never be filled
    if live != counters[LIVE] or (end > 0 and volume(net, end - 1) < 0.0):
        faults += 1
    return faults


@buffers.register
def _(part: FlagList, net):
    return {"holes": (array_bytes(part.holes, int(part.counters[HOLES])), part.holes.nbytes)}
