"""The order of points and tets in memory: as the mesh came, at random (the worst case for any cache), or so that
neighbours in space, or in the graph of the edges, are neighbours in memory."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from tetrabench.errors import InputError, find_named
from tetrabench.mesh.hilbert import hilbert_order
from tetrabench.mesh.rcm import rcm_order
from tetrabench.mesh.tetra_mesh import TetraMesh

Rows = NDArray[np.int64]


def renumber(mesh: TetraMesh, numbering: str, seed: int = 0) -> TetraMesh:
    """Return the mesh in another order of its points and its tets, one of NUMBERINGS.

    "natural" is the mesh as it is, "shuffled" an order at random; "hilbert" and "rcm" bring neighbours together.

    Ids stay with their points and tets, so that a file keeps its own; the order of the vertices within a tetra
    stays too.

    Args:
        mesh: sound, as `check_mesh` has it.
        numbering: its name.
        seed: of the shuffling, 0 or more.

    Raises:
        InputError: an unknown numbering, or a seed below 0.
    """
    order = find_named("numbering", NUMBERINGS, numbering)
    check_seed(seed)
    if order is None:
        return mesh
    points, tets = order(mesh, seed)
    drawn = f" (seed {seed})" if order is shuffled_order else ""
    return TetraMesh(
        points=mesh.points[points],
        tets=inverse(points)[mesh.tets[tets]],
        point_ids=mesh.point_ids[points],
        tet_ids=mesh.tet_ids[tets],
        report=replace(mesh.report, source=f"{mesh.report.source}, {numbering} numbering{drawn}"),
    )


def check_seed(seed: int) -> None:
    """Refuse, with InputError, a seed that no random numbers can begin with."""
    if seed < 0:
        raise InputError(f"a seed is 0 or more, not {seed}")


def shuffled_order(mesh: TetraMesh, seed: int) -> tuple[Rows, Rows]:
    """Points and tets at random."""
    random = np.random.default_rng([seed, 1])  # a stream of its own: generators draw from [seed]
    return random.permutation(len(mesh.points)), random.permutation(len(mesh.tets))


def curve_order(mesh: TetraMesh, seed: int) -> tuple[Rows, Rows]:
    """Points along a Hilbert curve, and tets, by their centroids, along another. Takes no seed."""
    return hilbert_order(mesh.points), hilbert_order(mesh.points[mesh.tets].mean(axis=1))


def graph_order(mesh: TetraMesh, seed: int) -> tuple[Rows, Rows]:
    """Points by reverse Cuthill-McKee, tets by their new vertices. Takes no seed."""
    order = rcm_order(mesh.tets, len(mesh.points))
    first, second, third, fourth = np.sort(inverse(order)[mesh.tets], axis=1).T
    return order, np.lexsort([fourth, third, second, first])


def inverse(order: Rows) -> NDArray[np.int32]:
    """The new row of each old row: (n,) int32."""
    new = np.empty(len(order), np.int32)
    new[order] = np.arange(len(order), dtype=np.int32)
    return new


NUMBERINGS: dict[str, Callable[[TetraMesh, int], tuple[Rows, Rows]] | None] = {
    "natural": None,
    "shuffled": shuffled_order,
    "hilbert": curve_order,
    "rcm": graph_order,
}
