"""Lists of variable length, two values each beside their items: where it starts, and how long it is; and what fills them."""

import numpy as np
from numpy.typing import NDArray

from tetrabench.jit import kernel
from tetrabench.mesh.polygon.connect import NOBODY, Connections, after, before, beyond, count_around, turn

Lists = NDArray[np.int32]
Rows = NDArray[np.int32]


def describe_lists(lengths: Rows) -> Lists:
    """Start and length of lists that lie one behind the other: (n, 2) int32, from their lengths (n,)."""
    lists = np.empty((len(lengths), 2), np.int32)
    lists[:, 1] = lengths
    np.cumsum(lengths[:-1], out=lists[1:, 0])
    lists[0, 0] = 0
    return lists


def lists_around(links: Connections) -> Lists:
    """Start and length of one list for each node, with an item for each of its edges: (L, 2) int32."""
    lengths = np.empty_like(links.first)
    count_around(links, lengths)
    return describe_lists(lengths)


@kernel(allocates=False, inline=True)
def copy_items(items: Rows, start: int, count: int, out: Rows) -> None:
    """Copy a list. Four items at a time by hand: the compiler's own vector loop is for long lists, and delays short ones."""
    j = np.int64(0)
    while j + 4 <= count:
        a, b = items[np.uint64(start + j)], items[np.uint64(start + j + 1)]
        c, d = items[np.uint64(start + j + 2)], items[np.uint64(start + j + 3)]
        out[np.uint64(j)], out[np.uint64(j + 1)], out[np.uint64(j + 2)], out[np.uint64(j + 3)] = a, b, c, d
        j += 4
    while j < count:
        out[np.uint64(j)] = items[np.uint64(start + j)]
        j += 1


@kernel(allocates=False)
def put_sides(links: Connections, neighbours: Rows) -> None:
    """For each corner what lies beyond its side, into `neighbours` (s,) int32."""
    for x in range(len(links.nodes)):
        neighbours[np.uint64(x)] = beyond(links, x)


@kernel(allocates=False)
def put_stars(links: Connections, lists: Lists, nodes: Rows, cells: Rows) -> None:
    """For each node its neighbours and its cells, boundary condition last, into `nodes` and `cells` from its list's start."""
    for v in range(len(links.first)):
        place = np.int64(lists[np.uint64(v), 0])
        first = np.int64(links.first[np.uint64(v)])
        x = first
        while True:
            nodes[np.uint64(place)] = links.nodes[np.uint64(after(links, x))]
            cells[np.uint64(place)] = links.cell[np.uint64(x)]
            last = before(links, x)
            x, place = turn(links, x), place + 1
            if x == first:
                break
            if x == NOBODY:
                nodes[np.uint64(place)] = links.nodes[np.uint64(last)]
                cells[np.uint64(place)] = links.conditions[np.uint64(last)]
                break


@kernel(allocates=False)
def put_edge_stars(links: Connections, edge: Rows, lists: Lists, edges: Rows) -> None:
    """For each node its edges, counter-clockwise, into `edges` from its list's start; `edge` (s,) is that of each corner."""
    for v in range(len(links.first)):
        place = np.int64(lists[np.uint64(v), 0])
        first = np.int64(links.first[np.uint64(v)])
        x = first
        while True:
            edges[np.uint64(place)] = edge[np.uint64(x)]
            last = before(links, x)
            x, place = turn(links, x), place + 1
            if x == first:
                break
            if x == NOBODY:
                edges[np.uint64(place)] = edge[np.uint64(last)]
                break
