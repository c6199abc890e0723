"""By cell: a cell lists its nodes and its neighbour cells; a node knows one of its cells. Source: section 5.

Neighbour j lies beyond nodes j and j + 1 ("node before cell"). The cell of a boundary node is the one whose boundary edge
leaves it to the right, seen from outside.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tetrabench.backends.polygon.lists import copy_items, describe_lists, put_sides
from tetrabench.jit import implements, kernel
from tetrabench.polygon import interface


class ByCell(NamedTuple):
    """(2 i + 2) N + L values.

    Attributes:
        lists: (N, 2) int32: where the lists of a cell start, and how long they are.
        nodes: (i N,) int32.
        neighbours: (i N,) int32: cells, and boundary conditions.
        node_cell: (L,) int32.
    """

    lists: NDArray[np.int32]
    nodes: NDArray[np.int32]
    neighbours: NDArray[np.int32]
    node_cell: NDArray[np.int32]


def make_by_cell(links):
    """The storage of a mesh."""
    neighbours = np.empty_like(links.nodes)
    put_sides(links, neighbours)
    return ByCell(describe_lists(np.diff(links.starts)), links.nodes.copy(), neighbours, links.cell[links.first])


@implements(interface.number_of_cells, ByCell)
def number_of_cells(storage):
    return len(storage.lists)


@implements(interface.number_of_nodes, ByCell)
def number_of_nodes(storage):
    return len(storage.node_cell)


@implements(interface.cell_nodes, ByCell)
def cell_nodes(storage, c, out):
    start, count = np.int64(storage.lists[np.uint64(c), 0]), np.int64(storage.lists[np.uint64(c), 1])
    copy_items(storage.nodes, start, count, out)
    return count


@implements(interface.cell_neighbours, ByCell)
def cell_neighbours(storage, c, out):
    start, count = np.int64(storage.lists[np.uint64(c), 0]), np.int64(storage.lists[np.uint64(c), 1])
    copy_items(storage.neighbours, start, count, out)
    return count


@implements(interface.node_cells, ByCell)
def node_cells(storage, v, out):
    return turn_around(storage, v, out, out, False, True)


@implements(interface.node_neighbours, ByCell)
def node_neighbours(storage, v, out):
    return turn_around(storage, v, out, out, True, False)


@implements(interface.node_star, ByCell)
def node_star(storage, v, nodes, cells):
    return turn_around(storage, v, nodes, cells, True, True)


@kernel(allocates=False, inline=True)
def turn_around(storage, v, nodes, cells, wants_nodes, wants_cells):
    """From cell to cell around node v, over the side that ends in it."""
    first = np.int64(storage.node_cell[np.uint64(v)])
    c, count = first, 0
    while True:
        start = np.int64(storage.lists[np.uint64(c), 0])
        last = start + storage.lists[np.uint64(c), 1] - 1
        place = start
        while storage.nodes[np.uint64(place)] != v:
            place += 1
        before = place - 1 if place > start else last
        if wants_nodes:
            nodes[np.uint64(count)] = storage.nodes[np.uint64(place + 1 if place < last else start)]
        if wants_cells:
            cells[np.uint64(count)] = c
        count += 1
        c = np.int64(storage.neighbours[np.uint64(before)])
        if c == first:
            return count
        if c < 0:
            if wants_nodes:
                nodes[np.uint64(count)] = storage.nodes[np.uint64(before)]
            if wants_cells:
                cells[np.uint64(count)] = c
            return count + 1
