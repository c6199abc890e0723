"""From a mesh to a net: fill the slots, then neighbours, incidence and search tree, each for all tetras at once."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tetrabench.jit import kernel
from tetrabench.mesh import TetraMesh
from tetrabench.mesh.sides import side_neighbours
from tetrabench.tetra.geometry import set_geometry
from tetrabench.tetra.incidence import add_incidence, make_incidence
from tetrabench.tetra.interface import (
    NONE,
    STATES,
    Net,
    set_neighbour,
    set_state,
    set_vertex,
    take_slot,
)
from tetrabench.tetra.nearest import build_tree
from tetrabench.tetra.points import make_points


def build_net(
    mesh: TetraMesh,
    *,
    make_layout: Callable[[int], Any],
    make_slots: Callable[[int], Any],
    ref_dtype: type = np.int32,
) -> Net:
    """The net of a mesh, with exactly the room that it needs.

    Point refs are the rows of `mesh.points`, and tetras are inserted in the order of `mesh.tets`, with their vertex
    order; states are 0. `ref_dtype` is what a ref is stored in: np.int32 for an index, np.int64 for an address.

    Raises:
        InputError: a side is shared by more than two tetras.
    """
    tetras = len(mesh.tets)
    neighbours = side_neighbours(mesh.tets)
    net = Net(
        make_layout(tetras),
        make_slots(tetras),
        make_points(mesh.points),
        make_incidence(len(mesh.points), tetras, ref_dtype),
        build_tree(mesh.points),
    )
    _fill(net, np.require(mesh.tets, np.int32, ["C", "W", "O"]), neighbours)
    return net


@kernel
def _fill(net: Net, tets: NDArray[np.int32], neighbours: NDArray[np.int32]) -> None:
    refs = np.empty(len(tets), np.int64)
    for n in range(len(tets)):
        t = take_slot(net)
        refs[n] = t
        for i in range(4):
            set_vertex(net, t, i, tets[n, i])
        for k in range(STATES):
            set_state(net, t, k, 0.0)
        set_geometry(net, t)
    for n in range(len(tets)):
        for i in range(4):
            other = neighbours[n, i]
            set_neighbour(net, refs[n], i, refs[other] if other >= 0 else NONE)
            add_incidence(net.incidence, tets[n, i], refs[n])
