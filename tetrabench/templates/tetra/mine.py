"""mine: a way to store a net of tetrahedra.

It works as it is: one array for each field of a tetra. Begin with the class, then let the functions follow. Each says what the
rest of tetrabench relies on; `tetrabench check --contestant mine` says where yours do not keep to it. They are inlined into
the kernels that call them: keep them small, and use what numba can compile. Refs index as unsigned numbers: with signed ones
numba looks at every access whether to count from the end.

Words: `t` is the ref of a tetra, here the index of its slot. Side i is the face opposite vertex i; i is 0 to 3. k counts
coordinates, 0 to 2, or states, 0 to 4. A slot may hold anything until its fields are set.
"""

from functools import partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tetrabench.backends.tetra.slots.flag_list import make_flag_list
from tetrabench.jit import implements
from tetrabench.tetra import interface
from tetrabench.tetra.build import build_net
from tetrabench.tetra.contestant import TetraContestant
from tetrabench.tetra.points import grown


class Mine(NamedTuple):
    """Where the fields of all tetras live. Change this: what is read together, keep together; what follows, leave out.

    Attributes:
        vertex: (capacity, 4) int32, refs of points.
        neighbour: (capacity, 4) int32, the tetra behind each side, -1 where there is none.
        volume: (capacity,) float64.
        centroid: (capacity, 3) float64.
        side_area: (capacity, 4) float64, of the sides.
        side_normal: (capacity, 4, 3) float64, of the sides.
        state: (capacity, 5) float64.
    """

    vertex: NDArray[np.int32]
    neighbour: NDArray[np.int32]
    volume: NDArray[np.float64]
    centroid: NDArray[np.float64]
    side_area: NDArray[np.float64]
    side_normal: NDArray[np.float64]
    state: NDArray[np.float64]


def make_mine(capacity):
    """Room for `capacity` tetras, none of them there yet. Change it with the class."""
    return Mine(
        vertex=np.empty((capacity, 4), np.int32),
        neighbour=np.empty((capacity, 4), np.int32),
        volume=np.empty(capacity),
        centroid=np.empty((capacity, 3)),
        side_area=np.empty((capacity, 4)),
        side_normal=np.empty((capacity, 4, 3)),
        state=np.empty((capacity, interface.STATES)),
    )


@implements(interface.grown_layout, Mine)
def grown_layout(net, capacity):
    """The same content with room for `capacity` tetras. Change it with the class: nothing may be lost."""
    return Mine(
        grown(net.layout.vertex, capacity),
        grown(net.layout.neighbour, capacity),
        grown(net.layout.volume, capacity),
        grown(net.layout.centroid, capacity),
        grown(net.layout.side_area, capacity),
        grown(net.layout.side_normal, capacity),
        grown(net.layout.state, capacity),
    )


@implements(interface.columns, Mine)
def columns(net):
    """The arrays of fields by the interface's names, for `net.by_ref`. Leave out fields that have none; or all of this."""
    return net.layout._asdict()


@implements(interface.capacity, Mine)
def capacity(net):
    """For how many tetras there is room. Any one of your arrays knows it."""
    return len(net.layout.volume)


@implements(interface.vertex, Mine)
def vertex(net, t, i):
    """The ref of vertex i, as int64, however it is stored."""
    return np.int64(net.layout.vertex[np.uint64(t), i])


@implements(interface.set_vertex, Mine)
def set_vertex(net, t, i, point):
    """Store the ref of vertex i. The order of the vertices is to be kept: sides go by it."""
    net.layout.vertex[np.uint64(t), i] = point


@implements(interface.neighbour, Mine)
def neighbour(net, t, i):
    """The tetra behind side i, as int64, -1 at the surface."""
    return np.int64(net.layout.neighbour[np.uint64(t), i])


@implements(interface.set_neighbour, Mine)
def set_neighbour(net, t, i, other):
    """Store the tetra behind side i; the other side of it is stored by another call."""
    net.layout.neighbour[np.uint64(t), i] = other


@implements(interface.volume, Mine)
def volume(net, t):
    """The volume as it was stored, to the last bit. The slot policy marks free slots by -1 here, so it has to be kept."""
    return net.layout.volume[np.uint64(t)]


@implements(interface.set_volume, Mine)
def set_volume(net, t, value):
    """Store the volume, or the mark of a free slot."""
    net.layout.volume[np.uint64(t)] = value


@implements(interface.centroid, Mine)
def centroid(net, t, k):
    """Coordinate k of the centroid as it was stored, to the last bit."""
    return net.layout.centroid[np.uint64(t), k]


@implements(interface.set_centroid, Mine)
def set_centroid(net, t, k, value):
    """Store coordinate k of the centroid."""
    net.layout.centroid[np.uint64(t), k] = value


@implements(interface.side_area, Mine)
def side_area(net, t, i):
    """The area of side i as it was stored, to the last bit."""
    return net.layout.side_area[np.uint64(t), i]


@implements(interface.set_side_area, Mine)
def set_side_area(net, t, i, value):
    """Store the area of side i. Neighbours share a side, yet each stores its own."""
    net.layout.side_area[np.uint64(t), i] = value


@implements(interface.side_normal, Mine)
def side_normal(net, t, i, k):
    """Coordinate k of the outward normal of side i as it was stored, to the last bit."""
    return net.layout.side_normal[np.uint64(t), i, k]


@implements(interface.set_side_normal, Mine)
def set_side_normal(net, t, i, k, value):
    """Store coordinate k of the normal of side i."""
    net.layout.side_normal[np.uint64(t), i, k] = value


@implements(interface.state, Mine)
def state(net, t, k):
    """Entry k of the state vector as it was stored, to the last bit. What sweeps read and write most."""
    return net.layout.state[np.uint64(t), k]


@implements(interface.set_state, Mine)
def set_state(net, t, k, value):
    """Store entry k of the state vector."""
    net.layout.state[np.uint64(t), k] = value


# How free slots are found, skipped and filled is the slot policy's: `make_slots`. It may be one of your own, too: see the
# functions under "slots" in tetrabench/tetra/interface.py, which holds the whole contract.
CONTESTANTS = [
    TetraContestant(
        name="mine",
        title="an array a field, flag + list",
        trade_off="say in a line what it is good at; and what it pays for that",
        build=partial(build_net, make_layout=make_mine, make_slots=make_flag_list),
        layout="an array a field",
        slots="flag + list",
        extension=True,
    )
]
