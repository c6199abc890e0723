"""Edges: two nodes and the two cells that an edge parts, `edge[e] = V1, V2, C1, C2`, as three of the formats store them.

Seen from the first cell the nodes run counter-clockwise. A boundary edge has the boundary condition as its first cell.
"""

import numpy as np
from numpy.typing import NDArray

from tetrabench.jit import kernel
from tetrabench.mesh.polygon.connect import NOBODY, Connections, after, number_edges

Rows = NDArray[np.int32]


def edges_of(links: Connections) -> tuple[Rows, int]:
    """The edge of each corner, (s,) int32, and how many edges there are."""
    edge = np.empty_like(links.nodes)
    return edge, int(number_edges(links, edge))


@kernel(allocates=False)
def put_edges(links: Connections, edge: Rows, rows: Rows) -> None:
    """Nodes and cells of the edges into the first four columns of `rows` (K, 4 or more) int32; `edge` as `edges_of` has it."""
    for x in range(len(links.nodes)):
        row = rows[np.uint64(edge[np.uint64(x)])]
        a, b = links.nodes[np.uint64(x)], links.nodes[np.uint64(after(links, x))]
        twin = np.int64(links.twin[np.uint64(x)])
        if twin == NOBODY:
            row[0], row[1], row[2], row[3] = b, a, links.conditions[np.uint64(x)], links.cell[np.uint64(x)]
        elif x < twin:
            row[0], row[1], row[2], row[3] = a, b, links.cell[np.uint64(x)], links.cell[np.uint64(twin)]


@kernel(allocates=False, inline=True)
def list_nodes(storage, c, out):
    """The nodes of cell c, where it lists its edges."""
    start, count = storage.lists[np.uint64(c), 0], np.int64(storage.lists[np.uint64(c), 1])
    for j in range(count):
        row = np.uint64(storage.cell_edges[np.uint64(start + j)])
        out[np.uint64(j)] = storage.edge[row, np.uint64(storage.edge[row, 2] != c)]
    return count


@kernel(allocates=False, inline=True)
def list_beyond(storage, c, out):
    """What lies beyond the sides of cell c, where it lists its edges."""
    start, count = storage.lists[np.uint64(c), 0], np.int64(storage.lists[np.uint64(c), 1])
    for j in range(count):
        row = np.uint64(storage.cell_edges[np.uint64(start + j)])
        out[np.uint64(j)] = storage.edge[row, np.uint64(2 + (storage.edge[row, 2] == c))]
    return count
