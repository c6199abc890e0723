"""Chain (V4): the nodes themselves are the doubly linked list; there are no holes to find, skip or fill.

Insert links a fresh node at the tail, delete unlinks and frees one. Source: thesis, 4.4.4.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tetrabench.backends.tetra.layouts.linked_nodes import NEXT, PREVIOUS, LinkedNodes
from tetrabench.jit import heap, implements, kernel
from tetrabench.jit.heap import load, store
from tetrabench.tetra import interface
from tetrabench.tetra.interface import NONE, Cursor
from tetrabench.tetra.memory import buffers

LIVE, HEAD, TAIL, HELD, HELD_NODES = 0, 1, 2, 3, 4  # places in the counters

AT_ONCE = 0
"""HELD where nodes are given back as soon as their tetra is deleted; no node has that address. HELD_NODES is -1 then."""

HEADER = 8
"""What the allocator (glibc) keeps beside each allocation, in bytes, beyond what it calls usable."""


class Chain(NamedTuple):
    """The ends of the list.

    Attributes:
        counters: (5,) int64: LIVE tetras; addresses of HEAD and TAIL, NONE in an empty net; HELD: AT_ONCE, or the address of
            the node that was held back last, each linked to the one before it, NONE at the end; HELD_NODES: how many.
    """

    counters: NDArray[np.int64]


def make_chain(capacity: int) -> Chain:
    """An empty list; it needs no capacity."""
    return Chain(np.array([0, NONE, NONE, AT_ONCE, -1], np.int64))


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
    if counters[HELD] == AT_ONCE:
        heap.release(t)
    else:
        store(np.int64, t + NEXT, counters[HELD])
        counters[HELD] = t
        counters[HELD_NODES] += 1
    counters[LIVE] -= 1


@implements(interface.release, Chain)
def release(net):
    counters = net.slots.counters
    for first in (counters[HEAD], counters[HELD]):
        t = first
        while t != NONE and t != AT_ONCE:
            following = load(np.int64, t + NEXT)
            heap.release(t)
            t = following
    counters[LIVE], counters[HEAD], counters[TAIL] = 0, NONE, NONE
    counters[HELD], counters[HELD_NODES] = AT_ONCE, -1


class HeldNodes(NamedTuple):
    """The nodes of a net, as they were.

    Attributes:
        refs: (n,) int64, their addresses.
        words: (n, 33) int64, their content.
    """

    refs: NDArray[np.int64]
    words: NDArray[np.int64]


@implements(interface.hold, Chain)
def hold(net):
    refs = interface.tetra_refs(net)
    words = np.empty((len(refs), net.layout.node_bytes // 8), np.int64)
    _read_nodes(refs, words)
    net.slots.counters[HELD], net.slots.counters[HELD_NODES] = NONE, 0
    return HeldNodes(refs, words)


@implements(interface.let_go, Chain)
def let_go(net, held, undo):
    counters = net.slots.counters
    useless = _nodes_from(counters[HELD])
    if undo:
        useless = np.setdiff1d(np.concatenate([useless, _nodes_from(counters[HEAD])]), held.refs)
    _release_nodes(useless)
    if undo:
        _write_nodes(held.refs, held.words)
    counters[HELD], counters[HELD_NODES] = AT_ONCE, -1


@kernel
def _nodes_from(first):
    """Addresses of the nodes of a list, (n,) int64."""
    count, t = 0, first
    while t != NONE:
        count += 1
        t = load(np.int64, t + NEXT)
    refs = np.empty(count, np.int64)
    t = first
    for n in range(count):
        refs[n] = t
        t = load(np.int64, t + NEXT)
    return refs


@kernel
def _release_nodes(refs):
    for t in refs:
        heap.release(t)


@kernel
def _read_nodes(refs, words):
    for n in range(len(refs)):
        for k in range(words.shape[1]):
            words[n, k] = load(np.int64, refs[n] + 8 * k)


@kernel
def _write_nodes(refs, words):
    for n in range(len(refs)):
        for k in range(words.shape[1]):
            store(np.int64, refs[n] + 8 * k, words[n, k])


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
    held, nodes = counters[HELD], counters[HELD_NODES]  # the list itself is followed only where an edit ends
    if (held == AT_ONCE) != (nodes == -1) or (held == NONE) != (nodes == 0) or held < NONE or nodes < -1:
        faults += 1
    return faults


@buffers.register
def _(part: LinkedNodes, net):
    live, head = net.slots.counters[LIVE], net.slots.counters[HEAD]
    allocated = heap.usable_size(int(head)) + HEADER if live else 0
    return {"nodes": (int(live) * part.node_bytes, int(live) * allocated)}
