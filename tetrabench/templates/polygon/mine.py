"""mine: a format of meshes of polygons.

It works as it is: every list that is asked for is kept, one behind the other. Begin with the class, then let the functions
follow. Each says what the rest of tetrabench relies on; `tetrabench check --contestant mine --family polygon` says where yours
do not keep to it. They are inlined into the kernels that call them: keep them small, and use what numba can compile.

Words: c is the number of a cell, v that of a node. An answer is written into `out`, which has room for the longest, and its
length is returned. Lists are counter-clockwise. Beyond the boundary there is a boundary condition: a negative number.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tetrabench.jit import implements, kernel
from tetrabench.mesh.polygon.connect import NOBODY, after, before, beyond, count_around, turn
from tetrabench.polygon import interface
from tetrabench.polygon.contestant import PolygonContestant


class Mine(NamedTuple):
    """All lists. Change this: leave out what can be found from the rest, and what that costs will be measured.

    Attributes:
        cell_starts: (cells + 1,) int32: the lists of cell c lie from cell_starts[c] up to, not with, cell_starts[c + 1].
        cell_nodes: (corners,) int32.
        cell_neighbours: (corners,) int32: cells, and boundary conditions.
        node_starts: (nodes + 1,) int32: as cell_starts, of nodes.
        node_neighbours: (2 edges,) int32.
        node_cells: (2 edges,) int32: cells; at a boundary node a boundary condition is the last.
    """

    cell_starts: NDArray[np.int32]
    cell_nodes: NDArray[np.int32]
    cell_neighbours: NDArray[np.int32]
    node_starts: NDArray[np.int32]
    node_neighbours: NDArray[np.int32]
    node_cells: NDArray[np.int32]


def make_mine(links):
    """The storage of a mesh, made from its connections (tetrabench.mesh.polygon.connect.Connections). Change it with the class.

    Make lists begin as here, a cell's with the first node of its list in the mesh, a node's with the edge of its first corner:
    the answer of gasdynamics is compared to the last bit, and sums follow the order of the lists.
    """
    lengths = np.empty(len(links.first), np.int32)
    count_around(links, lengths)
    node_starts = np.zeros(len(lengths) + 1, np.int32)
    np.cumsum(lengths, out=node_starts[1:])
    beyond_sides = np.empty(len(links.nodes), np.int32)
    neighbours, cells = np.empty((2, node_starts[-1]), np.int32)
    fill(links, beyond_sides, node_starts, neighbours, cells)
    return Mine(links.starts.copy(), links.nodes.copy(), beyond_sides, node_starts, neighbours, cells)


@kernel(allocates=False)
def fill(links, beyond_sides, node_starts, neighbours, cells):
    """Walk through the connections. A corner x is a node in a cell; `turn` leads to the next cell around the same node."""
    for x in range(len(links.nodes)):
        beyond_sides[x] = beyond(links, x)
    for v in range(len(links.first)):
        place, x = node_starts[v], np.int64(links.first[v])
        while place < node_starts[v + 1]:
            neighbours[place] = links.nodes[after(links, x)]
            cells[place] = links.cell[x]
            last = before(links, x)
            x, place = turn(links, x), place + 1
            if x == NOBODY:  # the left boundary side, seen from outside
                neighbours[place] = links.nodes[last]
                cells[place] = links.conditions[last]
                place += 1


@implements(interface.number_of_cells, Mine)
def number_of_cells(storage):
    """How many cells there are. Any one of your arrays knows it."""
    return len(storage.cell_starts) - 1


@implements(interface.number_of_nodes, Mine)
def number_of_nodes(storage):
    """How many nodes there are."""
    return len(storage.node_starts) - 1


@implements(interface.cell_nodes, Mine)
def cell_nodes(storage, c, out):
    """The nodes of cell c."""
    return copy_list(storage.cell_starts, storage.cell_nodes, c, out)


@implements(interface.cell_neighbours, Mine)
def cell_neighbours(storage, c, out):
    """What lies beyond each side of cell c, a boundary condition where no cell does: number j beyond nodes j and j + 1."""
    return copy_list(storage.cell_starts, storage.cell_neighbours, c, out)


@implements(interface.node_cells, Mine)
def node_cells(storage, v, out):
    """The cells around node v; at a boundary node one boundary condition follows, that of the left side, or both."""
    return copy_list(storage.node_starts, storage.node_cells, v, out)


@implements(interface.node_neighbours, Mine)
def node_neighbours(storage, v, out):
    """The nodes that edges join with node v; at the boundary from the right one, seen from outside, to the left one."""
    return copy_list(storage.node_starts, storage.node_neighbours, v, out)


@implements(interface.node_star, Mine)
def node_star(storage, v, nodes, cells):
    """Both of these at once: cell j lies between neighbours j and j + 1; at a boundary node the last cell is a condition."""
    copy_list(storage.node_starts, storage.node_neighbours, v, nodes)
    return copy_list(storage.node_starts, storage.node_cells, v, cells)


@kernel(allocates=False, inline=True)
def copy_list(starts, items, element, out):
    """The list of an element. No part of the interface: yours to keep or to drop."""
    start = starts[element]
    count = starts[element + 1] - start
    for j in range(count):
        out[j] = items[start + j]
    return count


CONTESTANTS = [
    PolygonContestant(
        name="mine",
        title="all lists as they are asked for",
        trade_off="say in a line what it is good at; and what it pays for that",
        build=make_mine,
        values="(2i + 1) N + (2k + 1) L + 2",
        extension=True,
    )
]
