"""Half-edges: each side of each cell knows its end, the sides before and after, and its cell. Ours: the usual choice today.

Half-edges 2 e and 2 e + 1 are the two sides of edge e (as in S. Campagna, L. Kobbelt, H.-P. Seidel, Directed edges, 1998).
Those outside have the boundary condition as their cell, and follow one another along the boundary.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tetrabench.backends.polygon.edges import edges_of
from tetrabench.jit import implements, kernel
from tetrabench.mesh.polygon.connect import NOBODY, after, before
from tetrabench.polygon import interface

TARGET, NEXT, PREVIOUS, CELL = range(4)


class HalfEdge(NamedTuple):
    """N + 8 K + L values.

    Attributes:
        half: (2 K, 4) int32: the node that it ends in, the half-edges after and before it in its cell, the cell.
        cell_half: (N,) int32: the side from the last of its nodes to the first.
        node_half: (L,) int32: a half-edge that begins there; a boundary node's right boundary edge, seen from outside.
    """

    half: NDArray[np.int32]
    cell_half: NDArray[np.int32]
    node_half: NDArray[np.int32]


def make_half_edge(links):
    """The storage of a mesh."""
    edge, count = edges_of(links)
    half = 2 * edge + ((links.twin != NOBODY) & (links.twin < np.arange(len(edge))))
    rows = np.empty((2 * count, 4), np.int32)
    put_half_edges(links, half, rows)
    return HalfEdge(rows, half[links.starts[1:] - 1], half[links.first])


@kernel(allocates=False)
def put_half_edges(links, half, rows):
    """Fill the half-edges; `half` (s,) int32 is that of each corner."""
    for x in range(len(links.nodes)):
        a, b = np.uint64(links.nodes[np.uint64(x)]), np.uint64(links.nodes[np.uint64(after(links, x))])
        h = np.int64(half[np.uint64(x)])
        row = rows[np.uint64(h)]
        row[TARGET], row[CELL] = b, links.cell[np.uint64(x)]
        row[NEXT], row[PREVIOUS] = half[np.uint64(after(links, x))], half[np.uint64(before(links, x))]
        if (
            links.twin[np.uint64(x)] == NOBODY
        ):  # outside they run the other way; the one before begins where this one ends
            ahead = half[np.uint64(links.first[b])] ^ 1
            row = rows[np.uint64(h ^ 1)]
            row[TARGET], row[CELL], row[PREVIOUS] = a, links.conditions[np.uint64(x)], ahead
            rows[np.uint64(ahead), NEXT] = h ^ 1


@implements(interface.number_of_cells, HalfEdge)
def number_of_cells(storage):
    return len(storage.cell_half)


@implements(interface.number_of_nodes, HalfEdge)
def number_of_nodes(storage):
    return len(storage.node_half)


@implements(interface.cell_nodes, HalfEdge)
def cell_nodes(storage, c, out):
    first = np.int64(storage.cell_half[np.uint64(c)])
    h, count = first, 0
    while True:
        out[np.uint64(count)] = storage.half[np.uint64(h), TARGET]
        count += 1
        h = np.int64(storage.half[np.uint64(h), NEXT])
        if h == first:
            return count


@implements(interface.cell_neighbours, HalfEdge)
def cell_neighbours(storage, c, out):
    first = np.int64(storage.cell_half[np.uint64(c)])
    h, count = first, 0
    while True:
        h = np.int64(storage.half[np.uint64(h), NEXT])
        out[np.uint64(count)] = storage.half[np.uint64(h ^ 1), CELL]
        count += 1
        if h == first:
            return count


@implements(interface.node_cells, HalfEdge)
def node_cells(storage, v, out):
    return turn_around(storage, v, out, out, False, True)


@implements(interface.node_neighbours, HalfEdge)
def node_neighbours(storage, v, out):
    return turn_around(storage, v, out, out, True, False)


@implements(interface.node_star, HalfEdge)
def node_star(storage, v, nodes, cells):
    return turn_around(storage, v, nodes, cells, True, True)


@kernel(allocates=False, inline=True)
def turn_around(storage, v, nodes, cells, wants_nodes, wants_cells):
    """From half-edge to half-edge that begins at node v: the other side of the one before."""
    first = np.int64(storage.node_half[np.uint64(v)])
    h, count = first, 0
    while True:
        row = np.uint64(h)
        if wants_nodes:
            nodes[np.uint64(count)] = storage.half[row, TARGET]
        if wants_cells:
            cells[np.uint64(count)] = storage.half[row, CELL]
        count += 1
        h = np.int64(storage.half[row, PREVIOUS]) ^ 1
        if h == first:
            return count
