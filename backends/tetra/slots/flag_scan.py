"""Flag and scan (V3X, V5X): a free slot has a negative volume; one variable remembers the first free slot.

Insert takes it, then scans the volumes for the next, in the worst case all of them; delete is O(1); iteration tests each
volume. Source: thesis, 4.4.2 and 4.4.6. The end falls over free slots when the last tetra goes.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tetrabench.jit import implements
from tetrabench.tetra import interface
from tetrabench.tetra.interface import DEAD, NONE, Cursor, set_volume, volume

LIVE, END, FIRST_FREE = 0, 1, 2  # places in the counters


class FlagScan(NamedTuple):
    """The first free slot.

    Attributes:
        counters: (3,) int64: LIVE tetras; END, one past the last live tetra; FIRST_FREE slot, END if there is no hole.
    """

    counters: NDArray[np.int64]


def make_flag_scan(capacity: int) -> FlagScan:
    """No tetra and no hole."""
    return FlagScan(np.zeros(3, np.int64))


@implements(interface.grown_slots, FlagScan)
def grown_slots(net, capacity):
    return FlagScan(net.slots.counters.copy())


@implements(interface.number_of_tetras, FlagScan)
def number_of_tetras(net):
    return net.slots.counters[LIVE]


@implements(interface.slots_used, FlagScan)
def slots_used(net):
    return net.slots.counters[END]


@implements(interface.first_tetra, FlagScan)
def first_tetra(net):
    t, limit = np.int64(0), net.slots.counters[END]
    while t < limit and volume(net, t) < 0.0:
        t += 1
    return Cursor(t if t < limit else NONE, 0, limit)


@implements(interface.next_tetra, FlagScan)
def next_tetra(net, cursor):
    t, limit = cursor.tetra + 1, cursor.limit
    while t < limit and volume(net, t) < 0.0:
        t += 1
    return Cursor(t if t < limit else NONE, 0, limit)


@implements(interface.last_tetra, FlagScan)
def last_tetra(net):
    return net.slots.counters[END] - 1


@implements(interface.is_live, FlagScan)
def is_live(net, t):
    return t >= 0 and t < net.slots.counters[END] and volume(net, t) >= 0.0


@implements(interface.take_slot, FlagScan)
def take_slot(net):
    counters = net.slots.counters
    t = counters[FIRST_FREE]
    if t == counters[END]:
        counters[END] = t + 1
    end = counters[END]
    following = t + 1
    while following < end and volume(net, following) >= 0.0:  # the scan that makes this policy slow
        following += 1
    counters[FIRST_FREE] = following
    counters[LIVE] += 1
    return t


@implements(interface.drop_slot, FlagScan)
def drop_slot(net, t):
    counters = net.slots.counters
    set_volume(net, t, DEAD)
    counters[LIVE] -= 1
    if t == counters[END] - 1:
        end = t
        while end > 0 and volume(net, end - 1) < 0.0:
            end -= 1
        counters[END] = end
        counters[FIRST_FREE] = min(counters[FIRST_FREE], end)
    else:
        counters[FIRST_FREE] = min(counters[FIRST_FREE], t)


@implements(interface.slot_faults, FlagScan)
def slot_faults(net):
    counters = net.slots.counters
    end, live, first_free = counters[END], 0, counters[END]
    for t in range(end):
        if volume(net, t) >= 0.0:
            live += 1
        elif first_free == end:
            first_free = t
    faults = int(live != counters[LIVE]) + int(first_free != counters[FIRST_FREE])
    if end > 0 and volume(net, end - 1) < 0.0:
        faults += 1  # the end is not behind a live tetra
    return faults
