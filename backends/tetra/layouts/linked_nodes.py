"""Linked nodes (V4): each tetra an allocation of its own, reached by a real pointer. Source: thesis, 4.4.4.

The record of `records.py` with 64-bit neighbours and two links, 264 bytes on the C heap; a ref is its address. Pointer
chasing is what this layout is for, so nothing here may be an index.
"""

from typing import NamedTuple

import numpy as np

from tetrabench.jit import implements
from tetrabench.jit.heap import load, store
from tetrabench.tetra import interface

NODE = np.dtype(
    [
        ("vertex", np.int32, 4),
        ("neighbour", np.int64, 4),
        ("volume", np.float64),
        ("centroid", np.float64, 3),
        ("side_area", np.float64, 4),
        ("side_normal", np.float64, (4, 3)),
        ("state", np.float64, interface.STATES),
        ("next", np.int64),
        ("previous", np.int64),
    ],
    align=True,
)
"""All fields of one tetra, as a C struct: 264 bytes."""

_OFFSETS = [offset for _, offset, *_ in (NODE.fields or {}).values()]
VERTEX, NEIGHBOUR, VOLUME, CENTROID, SIDE_AREA, SIDE_NORMAL, STATE, NEXT, PREVIOUS = _OFFSETS

UNLIMITED = 2**40
"""The capacity of a layout that allocates as it goes."""


class LinkedNodes(NamedTuple):
    """Nothing but nodes on the heap.

    Attributes:
        node_bytes: size of a node.
    """

    node_bytes: int


def make_linked_nodes(capacity: int) -> LinkedNodes:
    """A layout without nodes; it needs no capacity."""
    return LinkedNodes(NODE.itemsize)


@implements(interface.grown_layout, LinkedNodes)
def grown_layout(net, capacity):
    return net.layout


@implements(interface.capacity, LinkedNodes)
def capacity(net):
    return UNLIMITED


@implements(interface.vertex, LinkedNodes)
def vertex(net, t, i):
    return np.int64(load(np.int32, t + (VERTEX + 4 * i)))


@implements(interface.set_vertex, LinkedNodes)
def set_vertex(net, t, i, point):
    store(np.int32, t + (VERTEX + 4 * i), point)


@implements(interface.neighbour, LinkedNodes)
def neighbour(net, t, i):
    return load(np.int64, t + (NEIGHBOUR + 8 * i))


@implements(interface.set_neighbour, LinkedNodes)
def set_neighbour(net, t, i, other):
    store(np.int64, t + (NEIGHBOUR + 8 * i), other)


@implements(interface.volume, LinkedNodes)
def volume(net, t):
    return load(np.float64, t + VOLUME)


@implements(interface.set_volume, LinkedNodes)
def set_volume(net, t, value):
    store(np.float64, t + VOLUME, value)


@implements(interface.centroid, LinkedNodes)
def centroid(net, t, k):
    return load(np.float64, t + (CENTROID + 8 * k))


@implements(interface.set_centroid, LinkedNodes)
def set_centroid(net, t, k, value):
    store(np.float64, t + (CENTROID + 8 * k), value)


@implements(interface.side_area, LinkedNodes)
def side_area(net, t, i):
    return load(np.float64, t + (SIDE_AREA + 8 * i))


@implements(interface.set_side_area, LinkedNodes)
def set_side_area(net, t, i, value):
    store(np.float64, t + (SIDE_AREA + 8 * i), value)


@implements(interface.side_normal, LinkedNodes)
def side_normal(net, t, i, k):
    return load(np.float64, t + (SIDE_NORMAL + 8 * (3 * i + k)))


@implements(interface.set_side_normal, LinkedNodes)
def set_side_normal(net, t, i, k, value):
    store(np.float64, t + (SIDE_NORMAL + 8 * (3 * i + k)), value)


@implements(interface.state, LinkedNodes)
def state(net, t, k):
    return load(np.float64, t + (STATE + 8 * k))


@implements(interface.set_state, LinkedNodes)
def set_state(net, t, k, value):
    store(np.float64, t + (STATE + 8 * k), value)
