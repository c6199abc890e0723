"""By edge: an edge knows its nodes, its cells and the next edges; a cell and a node know one edge each. Source: section 4.

The next edges turn counter-clockwise: E1 around V1, in the first cell, and E2 around V2, in the second. At a boundary edge,
whose first cell is the boundary condition, E1 is the next boundary edge, so that a walk around a boundary node closes, too.

So the edges of a cell follow one another clockwise: a cell knows the last of its edges, and its lists are turned round.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tetrabench.backends.polygon.edges import edges_of, put_edges
from tetrabench.jit import implements, kernel
from tetrabench.mesh.polygon.connect import NOBODY, before
from tetrabench.polygon import interface


class ByEdge(NamedTuple):
    """N + 6 K + L values.

    Attributes:
        edge: (K, 6) int32: V1, V2, C1, C2, E1, E2.
        cell_edge: (N,) int32: the side from the last of its nodes to the first.
        node_edge: (L,) int32: a boundary node's right boundary edge, seen from outside.
    """

    edge: NDArray[np.int32]
    cell_edge: NDArray[np.int32]
    node_edge: NDArray[np.int32]


def make_by_edge(links):
    """The storage of a mesh."""
    edge, count = edges_of(links)
    rows = np.empty((count, 6), np.int32)
    put_edges(links, edge, rows)
    put_next_edges(links, edge, rows)
    return ByEdge(rows, edge[links.starts[1:] - 1], edge[links.first])


@kernel(allocates=False)
def put_next_edges(links, edge, rows):
    """The next edges into the last two columns; `edge` as `edges_of` has it."""
    for x in range(len(links.nodes)):
        row = rows[np.uint64(edge[np.uint64(x)])]
        twin = np.int64(links.twin[np.uint64(x)])
        previous = edge[np.uint64(before(links, x))]
        if twin == NOBODY:
            row[4], row[5] = edge[np.uint64(links.first[np.uint64(row[0])])], previous
        else:
            row[4 if x < twin else 5] = previous


@implements(interface.number_of_cells, ByEdge)
def number_of_cells(storage):
    return len(storage.cell_edge)


@implements(interface.number_of_nodes, ByEdge)
def number_of_nodes(storage):
    return len(storage.node_edge)


@implements(interface.cell_nodes, ByEdge)
def cell_nodes(storage, c, out):
    return go_round(storage, c, out, True)


@implements(interface.cell_neighbours, ByEdge)
def cell_neighbours(storage, c, out):
    return go_round(storage, c, out, False)


@kernel(allocates=False, inline=True)
def go_round(storage, c, out, wants_nodes):
    """From edge to edge along cell c, clockwise, and the list turned round: its nodes, or what lies beyond its sides."""
    first = np.int64(storage.cell_edge[np.uint64(c)])
    e, count = first, 0
    while True:
        row = np.uint64(e)
        side = np.int64(storage.edge[row, 2] != c)
        out[np.uint64(count)] = storage.edge[row, np.uint64(side if wants_nodes else 3 - side)]
        count += 1
        e = np.int64(storage.edge[row, np.uint64(4 + side)])
        if e == first:
            break
    for j in range(count // 2):
        near, far = np.uint64(j), np.uint64(count - 1 - j)
        out[near], out[far] = out[far], out[near]
    return count


@implements(interface.node_cells, ByEdge)
def node_cells(storage, v, out):
    return turn_around(storage, v, out, out, False, True)


@implements(interface.node_neighbours, ByEdge)
def node_neighbours(storage, v, out):
    return turn_around(storage, v, out, out, True, False)


@implements(interface.node_star, ByEdge)
def node_star(storage, v, nodes, cells):
    return turn_around(storage, v, nodes, cells, True, True)


@kernel(allocates=False, inline=True)
def turn_around(storage, v, nodes, cells, wants_nodes, wants_cells):
    """From edge to edge around node v."""
    first = np.int64(storage.node_edge[np.uint64(v)])
    e, count = first, 0
    while True:
        row = np.uint64(e)
        side = np.int64(storage.edge[row, 0] != v)
        if wants_nodes:
            nodes[np.uint64(count)] = storage.edge[row, np.uint64(1 - side)]
        if wants_cells:
            cells[np.uint64(count)] = storage.edge[row, np.uint64(2 + side)]
        count += 1
        e = np.int64(storage.edge[row, np.uint64(4 + side)])
        if e == first:
            return count
