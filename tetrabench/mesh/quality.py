"""Volumes, dihedral angles and radius ratios of tetras given as arrays: what is stated about a mesh."""

import numpy as np
from numpy.typing import NDArray

from tetrabench.jit import kernel

Vector = tuple[float, float, float]
SIGN_BOUND = 8 * float(np.finfo(np.float64).eps)


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
        determinant, _ = determinant_and_size(points, tets, t)
        volumes[t] = determinant / 6
    return volumes


@kernel(allocates=False)
def count_signs(points: NDArray[np.float64], tets: NDArray[np.int32]) -> tuple[int, int]:
    """Count the tetras that are inside out, and those without volume.

    A tetra has no volume where rounding alone can decide the sign of its determinant: |det| <= 8 eps |u| |v|
    |w|, for edges u, v, w and eps = 2^-52. The bound is sound: each of the six products in the determinant
    carries at most 8 rounding errors of eps / 2 (3 of differences, 2 of products, 3 of sums), and the sum of their
    sizes, the permanent of the absolute values, is at most 3! / 3^(3/2) = 1.155 times |u| |v| |w| (Carlen, Lieb and
    Loss 2006), which makes 4.7 eps. Compare Shewchuk's filter of orient3d (1997), 7 eps / 2 times the permanent. A
    determinant beyond float64 counts as no volume too.

    Args:
        points: (n, 3) float64, C-contiguous.
        tets: (m, 4) int32, C-contiguous, indices into `points`.

    Returns:
        How many have a negative volume; how many have none.
    """
    inverted, degenerate = 0, 0
    for t in range(tets.shape[0]):
        determinant, size = determinant_and_size(points, tets, t)
        if not abs(determinant) > SIGN_BOUND * size:
            degenerate += 1
        elif determinant < 0:
            inverted += 1
    return inverted, degenerate


def smallest_dihedral_angle(points: NDArray[np.float64], tets: NDArray[np.int32]) -> float:
    """The first of `dihedral_angles`."""
    return float(dihedral_angles(points, tets)[0])


@kernel(allocates=False)
def dihedral_angles(points: NDArray[np.float64], tets: NDArray[np.int32]) -> tuple[float, float]:
    """Smallest and largest angle between two sides of any one tetra, in degrees (70.5 in a regular one).

    Args:
        points: (n, 3) float64, C-contiguous.
        tets: (m, 4) int32, C-contiguous, indices into `points`. Those without volume (`count_signs`) are left out.

    Returns:
        Degrees; NaN where there is no tetra with a volume.
    """
    largest_cosine, smallest_cosine = np.nan, np.nan
    for t in range(tets.shape[0]):
        determinant, size = determinant_and_size(points, tets, t)
        if abs(determinant) > SIGN_BOUND * size:
            a, b, c, d = tets[t, 0], tets[t, 1], tets[t, 2], tets[t, 3]
            # Every normal points inwards or every one outwards, so two of them enclose 180 degrees less the
            # dihedral angle.
            i, j = unit_normal(points, b, c, d), unit_normal(points, a, d, c)
            k, m = unit_normal(points, a, b, d), unit_normal(points, a, c, b)
            for cosine in (-dot(i, j), -dot(i, k), -dot(i, m), -dot(j, k), -dot(j, m), -dot(k, m)):
                if not cosine <= largest_cosine:  # also where it is still NaN
                    largest_cosine = cosine
                if not cosine >= smallest_cosine:
                    smallest_cosine = cosine
    return (
        float(np.degrees(np.arccos(min(largest_cosine, 1.0)))),
        float(np.degrees(np.arccos(max(smallest_cosine, -1.0)))),
    )


@kernel
def radius_ratios(points: NDArray[np.float64], tets: NDArray[np.int32]) -> NDArray[np.float64]:
    """How well shaped each tetra is: three times the radius of its inscribed sphere over that of its circumscribed one.

    A. Liu and B. Joe, Relationship between tetrahedron shape measures, 1994. With u, v, w the edges from one vertex and
    d = det(u, v, w), the inscribed radius is |d| / sum |n_i|, n_i the vector products along the four sides, twice as long as
    their areas, and the circumscribed one is | |u|^2 v x w + |v|^2 w x u + |w|^2 u x v | / (2 |d|).

    Args:
        points: (n, 3) float64, C-contiguous.
        tets: (m, 4) int32, C-contiguous, indices into `points`.

    Returns:
        (m,) float64: 1 for a regular tetra, 0 for one without volume (`count_signs`), whatever its size.
    """
    ratios = np.zeros(tets.shape[0], np.float64)
    for t in range(tets.shape[0]):
        a, b, c, d = tets[t, 0], tets[t, 1], tets[t, 2], tets[t, 3]
        u, v, w = difference(points, b, a), difference(points, c, a), difference(points, d, a)
        size = np.sqrt(max(dot(u, u), dot(v, v), dot(w, w)))
        if size > 0 and size < np.inf:
            u, v, w = shrunk(u, size), shrunk(v, size), shrunk(w, size)  # six lengths multiplied may be beyond float64
            uu, vv, ww = dot(u, u), dot(v, v), dot(w, w)
            uv, vw, wu = cross(u, v), cross(v, w), cross(w, u)
            determinant = dot(uv, w)
            if abs(determinant) > SIGN_BOUND * np.sqrt(uu) * np.sqrt(vv) * np.sqrt(ww):
                far = uv[0] + vw[0] + wu[0], uv[1] + vw[1] + wu[1], uv[2] + vw[2] + wu[2]  # along the side opposite a
                centre = (
                    uu * vw[0] + vv * wu[0] + ww * uv[0],
                    uu * vw[1] + vv * wu[1] + ww * uv[1],
                    uu * vw[2] + vv * wu[2] + ww * uv[2],
                )
                areas = np.sqrt(dot(uv, uv)) + np.sqrt(dot(vw, vw)) + np.sqrt(dot(wu, wu)) + np.sqrt(dot(far, far))
                ratios[t] = min(6 * determinant * determinant / (areas * np.sqrt(dot(centre, centre))), 1.0)
    return ratios


@kernel(allocates=False, inline=True)
def shrunk(u: Vector, size: float) -> Vector:
    """u / size."""
    return u[0] / size, u[1] / size, u[2] / size


@kernel(allocates=False, inline=True)
def determinant_and_size(points: NDArray[np.float64], tets: NDArray[np.int32], t: int) -> tuple[float, float]:
    """det(u, v, w) and |u| |v| |w| for the edges u, v, w from the first vertex of tetra `t` to the others."""
    a, b, c, d = tets[t, 0], tets[t, 1], tets[t, 2], tets[t, 3]
    u, v, w = difference(points, b, a), difference(points, c, a), difference(points, d, a)
    determinant = dot(cross(u, v), w)
    return determinant, np.sqrt(dot(u, u)) * np.sqrt(dot(v, v)) * np.sqrt(dot(w, w))


@kernel(allocates=False, inline=True)
def unit_normal(points: NDArray[np.float64], a: int, b: int, c: int) -> Vector:
    """(b - a) x (c - a), of length 1."""
    normal = cross(difference(points, b, a), difference(points, c, a))
    length = np.sqrt(dot(normal, normal))
    return normal[0] / length, normal[1] / length, normal[2] / length


@kernel(allocates=False, inline=True)
def difference(points: NDArray[np.float64], b: int, a: int) -> Vector:
    """From point `a` to point `b`."""
    return points[b, 0] - points[a, 0], points[b, 1] - points[a, 1], points[b, 2] - points[a, 2]


@kernel(allocates=False, inline=True)
def cross(u: Vector, v: Vector) -> Vector:
    """Vector product."""
    return u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]


@kernel(allocates=False, inline=True)
def dot(u: Vector, v: Vector) -> float:
    """Scalar product."""
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2]
