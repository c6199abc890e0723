"""By node: a node lists its neighbours and the cells around it; a cell knows one of its nodes. Source: section 3.

Cell j lies between neighbours j and j + 1 ("node before cell"). A boundary node begins with its right boundary neighbour, seen
from outside, and the boundary condition is its last cell. Where its two boundary edges have different ones, it is a corner of
the domain: it lists itself as last neighbour, so that there is room for both, its left edge's before its right's.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tetrabench.backends.polygon.lists import copy_items, describe_lists, put_stars
from tetrabench.jit import implements, kernel
from tetrabench.mesh.polygon.connect import NOBODY, count_around
from tetrabench.mesh.polygon.numbering import next_nodes
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
    corners, right = find_corners(links)
    lengths = np.empty_like(links.first)
    count_around(links, lengths)
    lengths[corners] += 1
    lists, room = describe_lists(lengths), lengths.sum()
    storage = ByNode(lists, np.empty(room, np.int32), np.empty(room, np.int32), links.nodes[links.starts[:-1]])
    put_stars(links, lists, storage.neighbours, storage.cells)
    last = lists[corners].sum(axis=1) - 1
    storage.neighbours[last] = corners
    storage.cells[last] = right
    return storage


def find_corners(links):
    """The nodes whose two boundary edges have different conditions, and that of their right edges, seen from outside."""
    sides = np.flatnonzero(links.twin == NOBODY)
    right, left = np.zeros_like(links.first), np.zeros_like(links.first)
    right[links.nodes[sides]] = left[next_nodes(links.starts, links.nodes)[sides]] = links.conditions[sides]
    corners = np.flatnonzero(right != left)
    return corners, right[corners]


@implements(interface.number_of_cells, ByNode)
def number_of_cells(storage):
    return len(storage.cell_node)


@implements(interface.number_of_nodes, ByNode)
def number_of_nodes(storage):
    return len(storage.lists)


@implements(interface.cell_nodes, ByNode)
def cell_nodes(storage, c, out):
    return go_round(storage, c, out, True)


@implements(interface.cell_neighbours, ByNode)
def cell_neighbours(storage, c, out):
    return go_round(storage, c, out, False)


@kernel(allocates=False, inline=True)
def go_round(storage, c, out, wants_nodes):
    """From node to node along cell c: its nodes, or what lies beyond its sides."""
    first = np.int64(storage.cell_node[np.uint64(c)])
    v, count = first, 0
    while True:
        start = np.int64(storage.lists[np.uint64(v), 0])
        place = start
        while storage.cells[np.uint64(place)] != c:
            place += 1
        if wants_nodes:
            out[np.uint64(count)] = v
        else:
            before = place - 1 if place > start else start + storage.lists[np.uint64(v), 1] - 1
            out[np.uint64(count)] = storage.cells[np.uint64(before)]
        count += 1
        v = np.int64(storage.neighbours[np.uint64(place)])
        if v == first:
            return count


@implements(interface.node_cells, ByNode)
def node_cells(storage, v, out):
    start, count = np.int64(storage.lists[np.uint64(v), 0]), np.int64(storage.lists[np.uint64(v), 1])
    copy_items(storage.cells, start, count, out)
    return count


@implements(interface.node_neighbours, ByNode)
def node_neighbours(storage, v, out):
    start, count = np.int64(storage.lists[np.uint64(v), 0]), np.int64(storage.lists[np.uint64(v), 1])
    copy_items(storage.neighbours, start, count, out)
    return count - (out[np.uint64(count - 1)] == v)


@implements(interface.node_star, ByNode)
def node_star(storage, v, nodes, cells):
    start, count = np.int64(storage.lists[np.uint64(v), 0]), np.int64(storage.lists[np.uint64(v), 1])
    copy_items(storage.neighbours, start, count, nodes)
    copy_items(storage.cells, start, count, cells)
    return count - (nodes[np.uint64(count - 1)] == v)
