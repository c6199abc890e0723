"""The contestant's slot policy: a deleted tetra has a flag, and keeps its slot until it is collected. No holes are filled."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tetrabench.backends.tetra.halfface.storage import FLAGGED, TETRAS, is_flagged
from tetrabench.jit import implements
from tetrabench.tetra import interface
from tetrabench.tetra.interface import NONE, Cursor

END = 0  # place in the counters


class DeleteFlags(NamedTuple):
    """What the half-face storage does not know of its flags.

    Attributes:
        counters: (1,) int64: END, one past the last tetra without a flag.
    """

    counters: NDArray[np.int64]


@implements(interface.grown_slots, DeleteFlags)
def grown_slots(net, capacity):
    return DeleteFlags(net.slots.counters.copy())


@implements(interface.number_of_tetras, DeleteFlags)
def number_of_tetras(net):
    return net.incidence.counters[TETRAS] - net.incidence.counters[FLAGGED]


@implements(interface.slots_used, DeleteFlags)
def slots_used(net):
    return net.incidence.counters[TETRAS]


@implements(interface.first_tetra, DeleteFlags)
def first_tetra(net):
    t, limit = np.int64(0), net.slots.counters[END]
    while t < limit and is_flagged(net.incidence, t):
        t += 1
    return Cursor(t if t < limit else NONE, 0, limit)


@implements(interface.next_tetra, DeleteFlags)
def next_tetra(net, cursor):
    t, limit = cursor.tetra + 1, cursor.limit
    while t < limit and is_flagged(net.incidence, t):
        t += 1
    return Cursor(t if t < limit else NONE, 0, limit)


@implements(interface.last_tetra, DeleteFlags)
def last_tetra(net):
    return net.slots.counters[END] - 1


@implements(interface.is_live, DeleteFlags)
def is_live(net, t):
    return t >= 0 and t < net.slots.counters[END] and not is_flagged(net.incidence, t)


@implements(interface.slot_faults, DeleteFlags)
def slot_faults(net):
    counters, end = net.incidence.counters, net.slots.counters[END]
    faults, flagged = 0, 0
    if (
        counters[TETRAS] < 0
        or counters[TETRAS] > min(len(net.incidence.connectivity), len(net.layout.volume))
        or end < 0
        or end > counters[TETRAS]
    ):
        faults += 1
    else:
        for t in range(counters[TETRAS]):
            flagged += np.int64(is_flagged(net.incidence, t))
            if t >= end and not is_flagged(net.incidence, t):
                faults += 1
        if flagged != counters[FLAGGED] or (end > 0 and is_flagged(net.incidence, end - 1)):
            faults += 1
    return faults
