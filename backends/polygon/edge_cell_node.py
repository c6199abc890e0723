"""Edge-cell-node: cells and nodes list their edges; an edge knows its nodes and its cells. Source: section 7.

The first and the last edge of a boundary node are boundary edges, the right one, seen from outside, first.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tetrabench.backends.polygon.edges import edges_of, list_beyond, list_nodes, put_edges
from tetrabench.backends.polygon.lists import describe_lists, lists_around, put_edge_stars
from tetrabench.jit import implements, kernel
from tetrabench.polygon import interface


class EdgeCellNode(NamedTuple):
    """(i + 2) N + 4 K + (k + 2) L values.

    Attributes:
        edge: (K, 4) int32: V1, V2, C1, C2.
        lists: (N, 2) int32: where the list of a cell starts, and how long it is.
        cell_edges: (i N,) int32.
        node_lists: (L, 2) int32: where the list of a node starts, and how long it is.
        node_edges: (k L,) int32.
    """

    edge: NDArray[np.int32]
    lists: NDArray[np.int32]
    cell_edges: NDArray[np.int32]
    node_lists: NDArray[np.int32]
    node_edges: NDArray[np.int32]


def make_edge_cell_node(links):
    """The storage of a mesh."""
    cell_edges, count = edges_of(links)
    rows, node_lists = np.empty((count, 4), np.int32), lists_around(links)
    node_edges = np.empty(node_lists[:, 1].sum(), np.int32)
    put_edges(links, cell_edges, rows)
    put_edge_stars(links, cell_edges, node_lists, node_edges)
    return EdgeCellNode(rows, describe_lists(np.diff(links.starts)), cell_edges, node_lists, node_edges)


@implements(interface.number_of_cells, EdgeCellNode)
def number_of_cells(storage):
    return len(storage.lists)


@implements(interface.number_of_nodes, EdgeCellNode)
def number_of_nodes(storage):
    return len(storage.node_lists)


@implements(interface.cell_nodes, EdgeCellNode)
def cell_nodes(storage, c, out):
    return list_nodes(storage, c, out)


@implements(interface.cell_neighbours, EdgeCellNode)
def cell_neighbours(storage, c, out):
    return list_beyond(storage, c, out)


@implements(interface.node_cells, EdgeCellNode)
def node_cells(storage, v, out):
    return list_star(storage, v, out, out, False, True)


@implements(interface.node_neighbours, EdgeCellNode)
def node_neighbours(storage, v, out):
    return list_star(storage, v, out, out, True, False)


@implements(interface.node_star, EdgeCellNode)
def node_star(storage, v, nodes, cells):
    return list_star(storage, v, nodes, cells, True, True)


@kernel(allocates=False, inline=True)
def list_star(storage, v, nodes, cells, wants_nodes, wants_cells):
    """What the edges of node v know: its neighbours, and the cells that follow them."""
    start, count = storage.node_lists[np.uint64(v), 0], np.int64(storage.node_lists[np.uint64(v), 1])
    for j in range(count):
        row = np.uint64(storage.node_edges[np.uint64(start + j)])
        side = np.int64(storage.edge[row, 0] != v)
        if wants_nodes:
            nodes[np.uint64(j)] = storage.edge[row, np.uint64(1 - side)]
        if wants_cells:
            cells[np.uint64(j)] = storage.edge[row, np.uint64(2 + side)]
    return count
