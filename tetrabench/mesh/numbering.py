"""The order of points and tets in memory: as the mesh came, or at random, the worst case for any cache."""

from dataclasses import replace

import numpy as np

from tetrabench.errors import InputError
from tetrabench.mesh.tetra_mesh import TetraMesh

NUMBERINGS = ("natural", "shuffled")


def renumber(mesh: TetraMesh, numbering: str, seed: int = 0) -> TetraMesh:
    """Return the mesh in another order: "natural" as it is, "shuffled" with its points and its tets at
    random.

    The order of the vertices within a tetra stays. The ids of a shuffled mesh follow the new order, from 1.

    Raises:
        InputError: an unknown numbering.
    """
    if numbering not in NUMBERINGS:
        raise InputError(f"unknown numbering {numbering!r}; there are {', '.join(NUMBERINGS)}")
    if numbering == "natural":
        return mesh
    random = np.random.default_rng([seed, 1])  # a stream of its own: generators draw from [seed]
    points, tets = len(mesh.points), len(mesh.tets)
    old_points = random.permutation(points)
    new_points = np.empty(points, np.int32)
    new_points[old_points] = np.arange(points, dtype=np.int32)
    return TetraMesh(
        points=mesh.points[old_points],
        tets=new_points[mesh.tets[random.permutation(tets)]],
        point_ids=np.arange(1, points + 1, dtype=np.int64),
        tet_ids=np.arange(1, tets + 1, dtype=np.int64),
        report=replace(mesh.report, source=f"{mesh.report.source}, shuffled (seed {seed})"),
    )
