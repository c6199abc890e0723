"""Chain (V4): the nodes themselves are the doubly linked list; there are no holes to find, skip or fill.

Insert links a fresh node at the tail, delete unlinks and frees one. Source: thesis, 4.4.4.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tetrabench.backends.tetra.layouts.linked_nodes import NEXT, PREVIOUS, LinkedNodes
from tetrabench.jit import heap, implements
from tetrabench.jit.heap import load, store
from tetrabench.tetra import interface
from tetrabench.tetra.interface import NONE, Cursor
from tetrabench.tetra.memory import buffers

LIVE, HEAD, TAIL = 0, 1, 2  # places in the counters

HEADER = 8
"""What the allocator (glibc) keeps beside each allocation, in bytes, beyond what it calls usable."""


class Chain(NamedTuple):
    """The ends of the list.

    Attributes:
        counters: (3,) int64: LIVE tetras; addresses of HEAD and TAIL, NONE in an empty net.
    """

    counters: NDArray[np.int64]


def make_chain(capacity: int) -> Chain:
    """An empty list; it needs no capacity."""
    return Chain(np.array([0, NONE, NONE], np.int64))


@implements(interface.grown_slots, Chain)
def grown_slots(net, capacity):
    return Chain(net.slots.counters.copy())


@implements(interface.number_of_tetras, Chain)
def number_of_tetras(net):
    return net.slots.counters[LIVE]


@implements(interface.slots_used, Chain)
def slots_used(net):
    return net.slots.counters[LIVE]


@implements(interface.first_tetra, Chain)
def first_tetra(net):
    return Cursor(net.slots.counters[HEAD], 0, 0)


@implements(interface.next_tetra, Chain)
def next_tetra(net, cursor):
    return Cursor(load(np.int64, cursor.tetra + NEXT), 0, 0)


@implements(interface.last_tetra, Chain)
def last_tetra(net):
    return net.slots.counters[TAIL]


@implements(interface.is_live, Chain)
def is_live(net, t):
    return t > 0


@implements(interface.take_slot, Chain)
def take_slot(net):
    counters = net.slots.counters
    t = heap.allocate(net.layout.node_bytes)
    if t == 0:
        raise MemoryError("no memory for another tetra")
    tail = counters[TAIL]
    store(np.int64, t + NEXT, NONE)
    store(np.int64, t + PREVIOUS, tail)
    if tail == NONE:
        counters[HEAD] = t
    else:
        store(np.int64, tail + NEXT, t)
    counters[TAIL] = t
    counters[LIVE] += 1
    return t


@implements(interface.drop_slot, Chain)
def drop_slot(net, t):
    counters = net.slots.counters
    following, previous = load(np.int64, t + NEXT), load(np.int64, t + PREVIOUS)
    if previous == NONE:
        counters[HEAD] = following
    else:
        store(np.int64, previous + NEXT, following)
    if following == NONE:
        counters[TAIL] = previous
    else:
        store(np.int64, following + PREVIOUS, previous)
    heap.release(t)
    counters[LIVE] -= 1


@implements(interface.release, Chain)
def release(net):
    counters = net.slots.counters
    t = counters[HEAD]
    while t != NONE:
        following = load(np.int64, t + NEXT)
        heap.release(t)
        t = following
    counters[LIVE], counters[HEAD], counters[TAIL] = 0, NONE, NONE


@implements(interface.slot_faults, Chain)
def slot_faults(net):
    counters = net.slots.counters
    live, faults, previous, t = 0, 0, NONE, counters[HEAD]
    while t != NONE and live <= counters[LIVE]:
        if load(np.int64, t + PREVIOUS) != previous:
            faults += 1
        live += 1
        previous, t = t, load(np.int64, t + NEXT)
    if live != counters[LIVE] or previous != counters[TAIL]:
        faults += 1
    return faults


@buffers.register
def _(part: LinkedNodes, net):
    live, head = net.slots.counters[LIVE], net.slots.counters[HEAD]
    allocated = heap.usable_size(int(head)) + HEADER if live else 0
    return {"nodes": (int(live) * part.node_bytes, int(live) * allocated)}
