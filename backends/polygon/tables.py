"""Tables: every list as it is asked for, one behind the other. Ours: the speed limit, and what it costs in memory."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tetrabench.backends.polygon.lists import copy_items, lists_around, put_sides, put_stars
from tetrabench.jit import implements, kernel
from tetrabench.polygon import interface


class Tables(NamedTuple):
    """(2 i + 1) N + (2 k + 1) L + 2 values: compressed rows.

    Attributes:
        cell_starts: (N + 1,) int32: the lists of cell c go from cell_starts[c] up to, not with, cell_starts[c + 1].
        cell_nodes: (i N,) int32.
        cell_neighbours: (i N,) int32: cells, and boundary conditions.
        node_starts: (L + 1,) int32.
        node_neighbours: (k L,) int32.
        node_cells: (k L,) int32: the boundary condition of a boundary node's left boundary edge, seen from outside, last.
    """

    cell_starts: NDArray[np.int32]
    cell_nodes: NDArray[np.int32]
    cell_neighbours: NDArray[np.int32]
    node_starts: NDArray[np.int32]
    node_neighbours: NDArray[np.int32]
    node_cells: NDArray[np.int32]


def make_tables(links):
    """The storage of a mesh."""
    lists = lists_around(links)
    node_starts = np.append(lists[:, 0], lists[-1].sum(dtype=np.int32))
    beyond, around, cells = (np.empty(room, np.int32) for room in (len(links.nodes), node_starts[-1], node_starts[-1]))
    put_sides(links, beyond)
    put_stars(links, lists, around, cells)
    return Tables(links.starts.copy(), links.nodes.copy(), beyond, node_starts, around, cells)


@implements(interface.number_of_cells, Tables)
def number_of_cells(storage):
    return len(storage.cell_starts) - 1


@implements(interface.number_of_nodes, Tables)
def number_of_nodes(storage):
    return len(storage.node_starts) - 1


@implements(interface.cell_nodes, Tables)
def cell_nodes(storage, c, out):
    return copy_list(storage.cell_starts, storage.cell_nodes, c, out)


@implements(interface.cell_neighbours, Tables)
def cell_neighbours(storage, c, out):
    return copy_list(storage.cell_starts, storage.cell_neighbours, c, out)


@implements(interface.node_cells, Tables)
def node_cells(storage, v, out):
    return copy_list(storage.node_starts, storage.node_cells, v, out)


@implements(interface.node_neighbours, Tables)
def node_neighbours(storage, v, out):
    return copy_list(storage.node_starts, storage.node_neighbours, v, out)


@implements(interface.node_star, Tables)
def node_star(storage, v, nodes, cells):
    copy_list(storage.node_starts, storage.node_neighbours, v, nodes)
    return copy_list(storage.node_starts, storage.node_cells, v, cells)


@kernel(allocates=False, inline=True)
def copy_list(starts, items, element, out):
    """The list of an element."""
    start = np.int64(starts[np.uint64(element)])
    count = np.int64(starts[np.uint64(element + 1)]) - start
    copy_items(items, start, count, out)
    return count
