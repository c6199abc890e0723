"""Volumes and dihedral angles of tetras given as arrays: what readers and generators state about a mesh."""

import numpy as np
from numpy.typing import NDArray

from tetrabench.jit import kernel


@kernel
def signed_volumes(points: NDArray[np.float64], tets: NDArray[np.int32]) -> NDArray[np.float64]:
    """Volume of each tetra, det(b - a, c - a, d - a) / 6: positive where d lies on the side abc turns
    towards.

    Args:
        points: (n, 3) float64, C-contiguous.
        tets: (m, 4) int32, C-contiguous, indices into `points`.

    Returns:
        (m,) float64, in the cube of the points' unit.
    """
    volumes = np.empty(tets.shape[0], np.float64)
    for t in range(tets.shape[0]):
        a, b, c, d = tets[t, 0], tets[t, 1], tets[t, 2], tets[t, 3]
        ux, uy, uz = points[b, 0] - points[a, 0], points[b, 1] - points[a, 1], points[b, 2] - points[a, 2]
        vx, vy, vz = points[c, 0] - points[a, 0], points[c, 1] - points[a, 1], points[c, 2] - points[a, 2]
        wx, wy, wz = points[d, 0] - points[a, 0], points[d, 1] - points[a, 1], points[d, 2] - points[a, 2]
        determinant = (uy * vz - uz * vy) * wx + (uz * vx - ux * vz) * wy + (ux * vy - uy * vx) * wz
        volumes[t] = determinant / 6
    return volumes


def smallest_dihedral_angle(points: NDArray[np.float64], tets: NDArray[np.int32]) -> float:
    """Smallest angle between two sides of any one tetra, in degrees (70.5 in a regular one).

    Args:
        points: (n, 3) float64.
        tets: (m, 4) int32, none of them flat.
    """
    a, b, c, d = (points[tets[:, k]] for k in range(4))
    # Every normal points inwards or every one outwards, so two of them enclose 180 degrees less the dihedral
    # angle.
    normals = [np.cross(c - b, d - b), np.cross(d - a, c - a), np.cross(b - a, d - a), np.cross(c - a, b - a)]
    units = [normal / np.linalg.norm(normal, axis=1)[:, None] for normal in normals]
    cosine = max(-np.einsum("ij,ij->i", units[i], units[j]).min() for i in range(4) for j in range(i))
    return float(np.degrees(np.arccos(cosine)))
