"""The order of nodes and cells in memory: as the mesh came, at random, or so that neighbours in space, or in the graph of
the edges, are neighbours in memory."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from tetrabench.errors import find_named
from tetrabench.mesh.hilbert import hilbert_order
from tetrabench.mesh.numbering import check_seed, inverse
from tetrabench.mesh.polygon.polygon_mesh import PolygonMesh
from tetrabench.mesh.rcm import rcm_order_of_edges

Rows = NDArray[np.int64]
Nodes = NDArray[np.int32]


def renumber_polygons(mesh: PolygonMesh, numbering: str, seed: int = 0) -> PolygonMesh:
    """Return the mesh in another order of its nodes and its cells, one of NUMBERINGS.

    "natural" is the mesh as it is, "shuffled" an order at random; "hilbert" and "rcm" bring neighbours together. The
    order of the nodes within a cell stays, and so does the node that it begins with.

    Args:
        mesh: sound.
        numbering: its name.
        seed: of the shuffling, 0 or more.

    Raises:
        InputError: an unknown numbering, or a seed below 0.
    """
    order = find_named("numbering", NUMBERINGS, numbering)
    check_seed(seed)
    if order is None:
        return mesh
    points, cells = order(mesh, seed)
    sizes = np.diff(mesh.starts)[cells]
    starts = np.zeros_like(mesh.starts)
    np.cumsum(sizes, out=starts[1:])
    corners = np.repeat(mesh.starts[cells] - starts[:-1], sizes) + np.arange(len(mesh.nodes), dtype=np.int32)
    drawn = f" (seed {seed})" if order is shuffled_order else ""
    return PolygonMesh(
        points=mesh.points[points],
        starts=starts,
        nodes=inverse(points)[mesh.nodes[corners]],
        conditions=mesh.conditions[corners],
        report=replace(mesh.report, source=f"{mesh.report.source}, {numbering} numbering{drawn}"),
    )


def next_nodes(starts: Nodes, nodes: Nodes) -> Nodes:
    """The node that follows each corner's in its cell: (s,) int32."""
    following = np.roll(nodes, -1)
    following[starts[1:] - 1] = nodes[starts[:-1]]
    return following


def shuffled_order(mesh: PolygonMesh, seed: int) -> tuple[Rows, Rows]:
    """Nodes and cells at random."""
    random = np.random.default_rng([seed, 1])  # a stream of its own: generators draw from [seed]
    return random.permutation(len(mesh.points)), random.permutation(mesh.number_of_cells)


def curve_order(mesh: PolygonMesh, seed: int) -> tuple[Rows, Rows]:
    """Nodes along a Hilbert curve, and cells, by the means of their nodes, along another. Takes no seed."""
    points = np.zeros((len(mesh.points), 3))  # a plane mesh lies at z = 0
    points[:, : mesh.points.shape[1]] = mesh.points
    sums = np.add.reduceat(points[mesh.nodes], mesh.starts[:-1], axis=0)
    return hilbert_order(points), hilbert_order(sums / np.diff(mesh.starts)[:, None])


def graph_order(mesh: PolygonMesh, seed: int) -> tuple[Rows, Rows]:
    """Nodes by reverse Cuthill-McKee, cells by the three of their new nodes that come first. Takes no seed."""
    order = rcm_order_of_edges(mesh.nodes, next_nodes(mesh.starts, mesh.nodes), len(mesh.points))
    new = inverse(order)[mesh.nodes]
    cell = np.repeat(np.arange(mesh.number_of_cells), np.diff(mesh.starts))
    new = new[np.lexsort((new, cell))]
    first, second, third = (new[mesh.starts[:-1] + place] for place in range(3))
    return order, np.lexsort([third, second, first])


NUMBERINGS: dict[str, Callable[[PolygonMesh, int], tuple[Rows, Rows]] | None] = {
    "natural": None,
    "shuffled": shuffled_order,
    "hilbert": curve_order,
    "rcm": graph_order,
}
