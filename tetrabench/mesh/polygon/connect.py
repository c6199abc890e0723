"""How the cells of a polygon mesh hang together: for each corner the same side seen from the other cell.

All formats are made from this. Lists around a node begin at `first`: at a boundary node with the right boundary side, seen
from outside, so that a walk counter-clockwise crosses the whole domain; elsewhere with its lowest corner.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tetrabench.errors import InputError
from tetrabench.jit import kernel
from tetrabench.mesh.polygon.polygon_mesh import PolygonMesh

Rows = NDArray[np.int32]
NOBODY = -1
"""The twin of a side on the boundary."""


class Connections(NamedTuple):
    """The corners of a mesh with all that leads from one to the other.

    Attributes:
        starts, nodes, conditions: those of the mesh.
        twin: (s,) int32, the corner whose side is this one's seen from the other cell; NOBODY at the boundary.
        cell: (s,) int32, the cell of each corner.
        first: (n,) int32, the corner that each node's lists begin at.
    """

    starts: Rows
    nodes: Rows
    conditions: Rows
    twin: Rows
    cell: Rows
    first: Rows


def connect(mesh: PolygonMesh) -> Connections:
    """Find the connections of a mesh.

    Raises:
        InputError: a mesh that no format can hold: `settle` (mesh.polygon.check) says what is wrong, and can mend it.
    """
    if not belong_together(mesh):
        raise InputError("the starts and nodes of the cells do not belong together: see PolygonMesh")
    starts, nodes, conditions = (
        np.require(array, np.int32, ["C", "W"]) for array in (mesh.starts, mesh.nodes, mesh.conditions)
    )
    corners, points = len(nodes), len(mesh.points)
    found = Connections(
        starts,
        nodes,
        conditions,
        np.full(corners, NOBODY, np.int32),
        np.empty(corners, np.int32),
        np.full(points, NOBODY, np.int32),
    )
    begins, around = np.zeros(points + 2, np.int32), np.empty(corners, np.int32)
    sort_corners(found, begins, around)
    if not (pair_sides(found, begins, around) and choose_first(found, begins, around)):
        raise InputError(
            "no format can hold this mesh: at a side or around a node its cells do not follow one another; "
            "tetrabench.mesh.polygon.check.settle says where, and can mend it"
        )
    return found


def belong_together(mesh: PolygonMesh) -> bool:
    """Whether there are cells of three nodes or more, and the arrays are as long, and the nodes as low, as they must be."""
    starts, nodes = mesh.starts, mesh.nodes
    if len(starts) < 2 or starts[0] != 0 or not starts[-1] == len(nodes) == len(mesh.conditions):
        return False
    fewest = np.diff(starts.astype(np.int64)).min()  # a difference may have no room in 32 bits
    return bool(fewest >= 3 and nodes.min() >= 0 and nodes.max() < len(mesh.points))


@kernel(allocates=False, inline=True)
def after(links: Connections, x: int) -> Any:
    """The next corner of the same cell, counter-clockwise."""
    end = links.starts[np.uint64(links.cell[np.uint64(x)] + 1)]
    return x + 1 if x + 1 < end else np.int64(links.starts[np.uint64(links.cell[np.uint64(x)])])


@kernel(allocates=False, inline=True)
def before(links: Connections, x: int) -> Any:
    """The corner before, in the same cell."""
    begin = links.starts[np.uint64(links.cell[np.uint64(x)])]
    return x - 1 if x > begin else np.int64(links.starts[np.uint64(links.cell[np.uint64(x)] + 1)]) - 1


@kernel(allocates=False, inline=True)
def beyond(links: Connections, x: int) -> Any:
    """What a cell sees beyond the side of its corner x: a cell, or the number of a boundary condition."""
    twin = np.int64(links.twin[np.uint64(x)])
    return np.int64(links.cell[np.uint64(twin)]) if twin >= 0 else np.int64(links.conditions[np.uint64(x)])


@kernel(allocates=False, inline=True)
def turn(links: Connections, x: int) -> Any:
    """The corner at the same node in the next cell counter-clockwise; NOBODY beyond the left boundary side."""
    return np.int64(links.twin[np.uint64(before(links, x))])


@kernel(allocates=False)
def sort_corners(links: Connections, begins: Rows, around: Rows) -> None:
    """The corners by their nodes: around[begins[v]:begins[v + 1]] are those of node v, ascending; and the cell of each.

    Args:
        links: `cell` is written.
        begins: (n + 2,) int32, zeros.
        around: (s,) int32.
    """
    for c in range(len(links.starts) - 1):
        for x in range(links.starts[np.uint64(c)], links.starts[np.uint64(c + 1)]):
            links.cell[np.uint64(x)] = c
            begins[np.uint64(links.nodes[np.uint64(x)] + 2)] += 1
    for v in range(1, len(begins)):
        begins[np.uint64(v)] += begins[np.uint64(v - 1)]
    for x in range(len(links.nodes)):
        place = np.uint64(links.nodes[np.uint64(x)] + 1)
        around[np.uint64(begins[place])] = x
        begins[place] += 1


@kernel(allocates=False)
def pair_sides(links: Connections, begins: Rows, around: Rows) -> bool:
    """Find the twin of each corner; False where a condition is not where the boundary is.

    Of several twins it is the last one: around a node of such a side the corners are no fan then.
    """
    fine = True
    for x in range(len(links.nodes)):
        a, b = links.nodes[np.uint64(x)], links.nodes[np.uint64(after(links, x))]
        for place in range(begins[np.uint64(b)], begins[np.uint64(b + 1)]):
            y = np.int64(around[np.uint64(place)])
            if links.nodes[np.uint64(after(links, y))] == a:
                links.twin[np.uint64(x)] = y
        condition = links.conditions[np.uint64(x)]
        fine = fine and condition <= 0 and (condition < 0) == (links.twin[np.uint64(x)] == NOBODY)
    return fine


@kernel(allocates=False)
def choose_first(links: Connections, begins: Rows, around: Rows) -> bool:
    """Find the first corner of each node; False where its corners are not one fan of different cells, or it has none."""
    fine = True
    for v in range(len(links.first)):
        begin, end = begins[np.uint64(v)], begins[np.uint64(v + 1)]
        if begin == end:
            return False
        first = np.int64(around[np.uint64(begin)])
        for place in range(begin, end):
            x = np.int64(around[np.uint64(place)])
            if links.twin[np.uint64(x)] == NOBODY:
                first = x
            if place > begin:  # corners of one cell would be next to each other
                fine = fine and links.cell[np.uint64(x)] != links.cell[np.uint64(around[np.uint64(place - 1)])]
        links.first[np.uint64(v)] = first
        x, passed = first, 0
        while x != NOBODY and (passed == 0 or x != first) and passed <= end - begin:
            x, passed = turn(links, x), passed + 1
        fine = fine and passed == end - begin
    return fine


@kernel(allocates=False)
def number_edges(links: Connections, edge: Rows) -> int:
    """Number the edges in the order of their first corners, for each corner into `edge` (s,) int32; returns how many."""
    count = 0
    for x in range(len(links.nodes)):
        twin = np.int64(links.twin[np.uint64(x)])
        if twin == NOBODY or x < twin:
            edge[np.uint64(x)] = count
            count += 1
        else:
            edge[np.uint64(x)] = edge[np.uint64(twin)]
    return count


@kernel(allocates=False)
def count_around(links: Connections, lengths: Rows) -> None:
    """How many edges meet in each node, into `lengths` (n,) int32."""
    for v in range(len(links.first)):
        first = np.int64(links.first[np.uint64(v)])
        x, count = first, 0
        while True:
            x, count = turn(links, x), count + 1
            if x == first:
                break
            if x == NOBODY:
                count += 1
                break
        lengths[np.uint64(v)] = count
