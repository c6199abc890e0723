"""The surface of a mesh: its sides without neighbour, as triangles that turn outwards."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tetrabench.mesh.sides import side_neighbours

# Side i, opposite vertex i: counter-clockwise from outside, where the volume is positive.
OUTWARD = np.array([[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]])


@dataclass(frozen=True)
class Surface:
    """Triangles, and whose sides they are.

    Attributes:
        triangles: (k, 3) int32, vertices, counter-clockwise as seen from outside; any way round where the tetra is flat.
        tetras: (k,) int64, the row of the tetra behind each.
    """

    triangles: NDArray[np.int32]
    tetras: NDArray[np.int64]


def find_surface(points: NDArray[np.float64], tets: NDArray[np.int32]) -> Surface:
    """The sides that no second tetra shares, by rows of tetras.

    Args:
        points: (n, 3) float64.
        tets: (m, 4) int32, indices into `points`; the tetras may be inside out.

    Raises:
        InputError: what `side_neighbours` refuses.
    """
    tetras, opposite = np.nonzero(side_neighbours(tets) < 0)
    triangles = tets[tetras[:, None], OUTWARD[opposite]]
    inside_out = _away_from(points[tets[tetras, opposite]], points[triangles]) < 0
    triangles[inside_out] = triangles[inside_out][:, ::-1]
    return Surface(triangles, tetras)


def _away_from(tips: NDArray[np.float64], corners: NDArray[np.float64]) -> NDArray[np.float64]:
    """Six times the volume between triangles (k, 3, 3) and points (k, 3): positive where they turn away from them."""
    a, b, c = corners.transpose(1, 0, 2)
    volumes: NDArray[np.float64] = np.einsum("kx,kx->k", np.cross(b - a, c - a), a - tips)
    return volumes
