"""What every format must answer: four queries and one that joins two of them. All lists are complete and counter-clockwise.

`storage` is the format's NamedTuple of arrays. An answer is written into `out`, (room,) int32 (see `polygon.net.list_room`),
and its length returned. Where there is no cell, the number of the boundary condition stands instead: it is negative.

Lists may begin anywhere; those of formats that are made from the same `mesh.polygon.connect` begin alike: a cell's with the
first node of its list in the mesh, a node's with the edge of its `first` corner. Then sums over them agree to the last bit,
as the scenario gasdynamics asks.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from tetrabench.jit import generic

Storage = Any
List = NDArray[np.int32]


@generic()
def number_of_cells(storage: Storage) -> int:
    """How many cells there are."""


@generic()
def number_of_nodes(storage: Storage) -> int:
    """How many nodes there are."""


@generic()
def cell_nodes(storage: Storage, c: int, out: List) -> int:
    """The nodes of cell c."""


@generic()
def cell_neighbours(storage: Storage, c: int, out: List) -> int:
    """What lies beyond each side of cell c, a boundary condition where no cell does: number j beyond nodes j and j + 1."""


@generic()
def node_cells(storage: Storage, v: int, out: List) -> int:
    """The cells around node v; at the boundary one boundary condition follows, or, where formats keep both, two."""


@generic()
def node_neighbours(storage: Storage, v: int, out: List) -> int:
    """The nodes that edges join with node v; at the boundary from the right neighbour, seen from outside, to the left one."""


@generic()
def node_star(storage: Storage, v: int, nodes: List, cells: List) -> int:
    """Neighbours and cells of node v at once: cell j lies between neighbours j and j + 1, in the circle.

    Returns:
        How many neighbours; at a boundary node the last cell, cells[n - 1], is the left edge's boundary condition.
    """
