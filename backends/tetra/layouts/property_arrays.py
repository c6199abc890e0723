"""Property arrays (V3, V3X, V3Y): one contiguous array per field. Source: thesis, 4.4.1.

Refs index as unsigned numbers: with signed ones numba looks at every access whether to count from the end.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tetrabench.jit import implements
from tetrabench.tetra import interface
from tetrabench.tetra.points import grown


class PropertyArrays(NamedTuple):
    """The fields of all slots, each in an array of its own.

    Attributes:
        vertex: (capacity, 4) int32.
        neighbour: (capacity, 4) int32.
        volume: (capacity,) float64.
        centroid: (capacity, 3) float64.
        side_area: (capacity, 4) float64.
        side_normal: (capacity, 4, 3) float64.
        state: (capacity, 5) float64.
    """

    vertex: NDArray[np.int32]
    neighbour: NDArray[np.int32]
    volume: NDArray[np.float64]
    centroid: NDArray[np.float64]
    side_area: NDArray[np.float64]
    side_normal: NDArray[np.float64]
    state: NDArray[np.float64]


def make_property_arrays(capacity: int) -> PropertyArrays:
    """Arrays for `capacity` slots."""
    return PropertyArrays(
        np.empty((capacity, 4), np.int32),
        np.empty((capacity, 4), np.int32),
        np.empty(capacity),
        np.empty((capacity, 3)),
        np.empty((capacity, 4)),
        np.empty((capacity, 4, 3)),
        np.empty((capacity, interface.STATES)),
    )


@implements(interface.grown_layout, PropertyArrays)
def grown_layout(net, capacity):
    return PropertyArrays(
        grown(net.layout.vertex, capacity),
        grown(net.layout.neighbour, capacity),
        grown(net.layout.volume, capacity),
        grown(net.layout.centroid, capacity),
        grown(net.layout.side_area, capacity),
        grown(net.layout.side_normal, capacity),
        grown(net.layout.state, capacity),
    )


@implements(interface.columns, PropertyArrays)
def columns(net):
    return net.layout._asdict()


@implements(interface.capacity, PropertyArrays)
def capacity(net):
    return len(net.layout.volume)


@implements(interface.vertex, PropertyArrays)
def vertex(net, t, i):
    return np.int64(net.layout.vertex[np.uint64(t), i])


@implements(interface.set_vertex, PropertyArrays)
def set_vertex(net, t, i, point):
    net.layout.vertex[np.uint64(t), i] = point


@implements(interface.neighbour, PropertyArrays)
def neighbour(net, t, i):
    return np.int64(net.layout.neighbour[np.uint64(t), i])


@implements(interface.set_neighbour, PropertyArrays)
def set_neighbour(net, t, i, other):
    net.layout.neighbour[np.uint64(t), i] = other


@implements(interface.volume, PropertyArrays)
def volume(net, t):
    return net.layout.volume[np.uint64(t)]


@implements(interface.set_volume, PropertyArrays)
def set_volume(net, t, value):
    net.layout.volume[np.uint64(t)] = value


@implements(interface.centroid, PropertyArrays)
def centroid(net, t, k):
    return net.layout.centroid[np.uint64(t), k]


@implements(interface.set_centroid, PropertyArrays)
def set_centroid(net, t, k, value):
    net.layout.centroid[np.uint64(t), k] = value


@implements(interface.side_area, PropertyArrays)
def side_area(net, t, i):
    return net.layout.side_area[np.uint64(t), i]


@implements(interface.set_side_area, PropertyArrays)
def set_side_area(net, t, i, value):
    net.layout.side_area[np.uint64(t), i] = value


@implements(interface.side_normal, PropertyArrays)
def side_normal(net, t, i, k):
    return net.layout.side_normal[np.uint64(t), i, k]


@implements(interface.set_side_normal, PropertyArrays)
def set_side_normal(net, t, i, k, value):
    net.layout.side_normal[np.uint64(t), i, k] = value


@implements(interface.state, PropertyArrays)
def state(net, t, k):
    return net.layout.state[np.uint64(t), k]


@implements(interface.set_state, PropertyArrays)
def set_state(net, t, k, value):
    net.layout.state[np.uint64(t), k] = value
