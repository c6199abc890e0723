"""Edge-cell: a cell lists its edges; an edge knows its nodes and its cells; a node knows one edge. Source: section 6.

The format that carries over to polyhedra: there the faces take the place of the edges.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tetrabench.backends.polygon.edges import edges_of, list_beyond, list_nodes, put_edges
from tetrabench.backends.polygon.lists import describe_lists
from tetrabench.jit import implements, kernel
from tetrabench.polygon import interface


class EdgeCell(NamedTuple):
    """(i + 2) N + 4 K + L values.

    Attributes:
        edge: (K, 4) int32: V1, V2, C1, C2.
        lists: (N, 2) int32: where the list of a cell starts, and how long it is.
        cell_edges: (i N,) int32.
        node_edge: (L,) int32: a boundary node's right boundary edge, seen from outside.
    """

    edge: NDArray[np.int32]
    lists: NDArray[np.int32]
    cell_edges: NDArray[np.int32]
    node_edge: NDArray[np.int32]


def make_edge_cell(links):
    """The storage of a mesh."""
    cell_edges, count = edges_of(links)
    rows = np.empty((count, 4), np.int32)
    put_edges(links, cell_edges, rows)
    return EdgeCell(rows, describe_lists(np.diff(links.starts)), cell_edges, cell_edges[links.first])


@implements(interface.number_of_cells, EdgeCell)
def number_of_cells(storage):
    return len(storage.lists)


@implements(interface.number_of_nodes, EdgeCell)
def number_of_nodes(storage):
    return len(storage.node_edge)


@implements(interface.cell_nodes, EdgeCell)
def cell_nodes(storage, c, out):
    return list_nodes(storage, c, out)


@implements(interface.cell_neighbours, EdgeCell)
def cell_neighbours(storage, c, out):
    return list_beyond(storage, c, out)


@implements(interface.node_cells, EdgeCell)
def node_cells(storage, v, out):
    return turn_around(storage, v, out, out, False, True)


@implements(interface.node_neighbours, EdgeCell)
def node_neighbours(storage, v, out):
    return turn_around(storage, v, out, out, True, False)


@implements(interface.node_star, EdgeCell)
def node_star(storage, v, nodes, cells):
    return turn_around(storage, v, nodes, cells, True, True)


@kernel(allocates=False, inline=True)
def turn_around(storage, v, nodes, cells, wants_nodes, wants_cells):
    """From edge to edge around node v: in the cell beyond an edge the next one is the edge before it in the list."""
    first = np.int64(storage.node_edge[np.uint64(v)])
    e, count = first, 0
    while True:
        row = np.uint64(e)
        side = np.int64(storage.edge[row, 0] != v)
        c = np.int64(storage.edge[row, np.uint64(2 + side)])
        if wants_nodes:
            nodes[np.uint64(count)] = storage.edge[row, np.uint64(1 - side)]
        if wants_cells:
            cells[np.uint64(count)] = c
        count += 1
        if c < 0:
            return count
        start = np.int64(storage.lists[np.uint64(c), 0])
        place = start
        while storage.cell_edges[np.uint64(place)] != e:
            place += 1
        before = place - 1 if place > start else start + storage.lists[np.uint64(c), 1] - 1
        e = np.int64(storage.cell_edges[np.uint64(before)])
        if e == first:
            return count
