"""By node: a node lists its neighbours and the cells around it; a cell knows one of its nodes. Source: section 3.

Cell j lies between neighbours j and j + 1 ("node before cell"). A boundary node begins with its right boundary neighbour, seen
from outside, and the boundary condition is its last cell. Where its two boundary edges have different ones, it is a corner of
the domain: it lists itself as last neighbour, so that there is room for both, its left edge's before its right's.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tetrabench.backends.polygon.lists import Rows, describe_lists, put_stars
from tetrabench.jit import implements, kernel
from tetrabench.mesh.polygon.connect import NOBODY, count_around
from tetrabench.polygon import interface


class ByNode(NamedTuple):
    """N + (2 k + 2) L values.

    Attributes:
        lists: (L, 2) int32: where the lists of a node start, and how long they are.
        neighbours: (k L,) int32: nodes; a corner of the domain itself, last.
        cells: (k L,) int32: cells, then one or two boundary conditions.
        cell_node: (N,) int32.
    """

    lists: NDArray[np.int32]
    neighbours: NDArray[np.int32]
    cells: NDArray[np.int32]
    cell_node: NDArray[np.int32]


def make_by_node(links):
    """The storage of a mesh."""
    edges, corner = np.empty_like(links.first), np.zeros(len(links.first), np.bool_)
    count_around(links, edges)
    at_boundary = np.flatnonzero(links.twin[links.first] == NOBODY)
    storage_of = lambda lists, room: ByNode(  # noqa: E731
        lists, np.empty(room, np.int32), np.empty(room, np.int32), links.nodes[links.starts[:-1]]
    )
    plain = describe_lists(edges)
    storage = storage_of(plain, edges.sum())
    put_stars(links, plain, storage.neighbours, storage.cells)
    return storage
