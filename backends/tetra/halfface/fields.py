"""The contestant's layout: vertices and neighbours are the kernel's, all else are dense attributes of tetras.

Vertex i as it was given, and the side opposite it, are found through the stored permutation: side i is the half-face that
lacks vertex i. A flagged tetra is nobody's neighbour.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tetrabench.backends.tetra.halfface.permutations import place_of
from tetrabench.backends.tetra.halfface.storage import (
    FLAGGED,
    NONE,
    is_border,
    is_flagged,
    opposite_of,
    permutation_of,
    tetra_of,
    vertex_as_given,
)
from tetrabench.jit import implements
from tetrabench.tetra import interface
from tetrabench.tetra.points import grown


class TetraFields(NamedTuple):
    """What tetras have beside their vertices and neighbours.

    Attributes:
        volume: (capacity,) float64.
        centroid: (capacity, 3) float64.
        side_area: (capacity, 4) float64, of the side opposite vertex i as it was given.
        side_normal: (capacity, 4, 3) float64.
        state: (capacity, 5) float64.
    """

    volume: NDArray[np.float64]
    centroid: NDArray[np.float64]
    side_area: NDArray[np.float64]
    side_normal: NDArray[np.float64]
    state: NDArray[np.float64]


def make_tetra_fields(capacity: int) -> TetraFields:
    """Fields of `capacity` tetras."""
    return TetraFields(
        np.empty(capacity),
        np.empty((capacity, 3)),
        np.empty((capacity, 4)),
        np.empty((capacity, 4, 3)),
        np.empty((capacity, interface.STATES)),
    )


@implements(interface.grown_layout, TetraFields)
def grown_layout(net, capacity):
    slots = capacity + net.incidence.counters[FLAGGED]
    return TetraFields(
        grown(net.layout.volume, slots),
        grown(net.layout.centroid, slots),
        grown(net.layout.side_area, slots),
        grown(net.layout.side_normal, slots),
        grown(net.layout.state, slots),
    )


@implements(interface.columns, TetraFields)
def columns(net):
    return net.layout._asdict()


@implements(interface.capacity, TetraFields)
def capacity(net):
    return len(net.layout.volume) - net.incidence.counters[FLAGGED]


@implements(interface.vertex, TetraFields)
def vertex(net, t, i):
    return vertex_as_given(net.incidence, t, i)


@implements(interface.neighbour, TetraFields)
def neighbour(net, t, i):
    opposite = opposite_of(net.incidence, t, 3 - place_of(permutation_of(net.incidence, t), i))
    other = NONE
    if not is_border(net.incidence, opposite):
        other = tetra_of(net.incidence, opposite)
        if net.incidence.counters[FLAGGED] != 0 and is_flagged(net.incidence, other):
            other = NONE
    return other


@implements(interface.volume, TetraFields)
def volume(net, t):
    return net.layout.volume[np.uint64(t)]


@implements(interface.set_volume, TetraFields)
def set_volume(net, t, value):
    net.layout.volume[np.uint64(t)] = value


@implements(interface.centroid, TetraFields)
def centroid(net, t, k):
    return net.layout.centroid[np.uint64(t), k]


@implements(interface.set_centroid, TetraFields)
def set_centroid(net, t, k, value):
    net.layout.centroid[np.uint64(t), k] = value


@implements(interface.side_area, TetraFields)
def side_area(net, t, i):
    return net.layout.side_area[np.uint64(t), i]


@implements(interface.set_side_area, TetraFields)
def set_side_area(net, t, i, value):
    net.layout.side_area[np.uint64(t), i] = value


@implements(interface.side_normal, TetraFields)
def side_normal(net, t, i, k):
    return net.layout.side_normal[np.uint64(t), i, k]


@implements(interface.set_side_normal, TetraFields)
def set_side_normal(net, t, i, k, value):
    net.layout.side_normal[np.uint64(t), i, k] = value


@implements(interface.state, TetraFields)
def state(net, t, k):
    return net.layout.state[np.uint64(t), k]


@implements(interface.set_state, TetraFields)
def set_state(net, t, k, value):
    net.layout.state[np.uint64(t), k] = value
