"""The Delaunay triangulation of points in the plane, as a Voronoi diagram needs it: exact well below a cell's size."""

import numpy as np
from numpy.typing import NDArray

from tetrabench.errors import InputError
from tetrabench.mesh.polygon.models.model import Points

Triangles = NDArray[np.int32]

ROUNDS = 20  # of flips; one or two are enough unless more than four points are on one circle to rounding


def triangulate(sites: Points) -> tuple[Triangles, Triangles]:
    """Triangulate the sites.

    Qhull rounds as the whole square does: of some million edges it turns one that is the other diagonal of its two
    triangles. Then the nodes at the ends of a short Voronoi side have changed places. Such edges are flipped (C. L.
    Lawson, Software for C1 surface interpolation, 1977).

    Args:
        sites: (n, 2) float64, all different.

    Returns:
        triangles (t, 3) int32, counter-clockwise; opposite (t, 3) int32, the triangle across the edge opposite to each
        corner, or -1.

    Raises:
        InputError: sites so near each other that Qhull takes them for one: among ten million one pair may be.
    """
    from scipy.spatial import Delaunay

    triangulation = Delaunay(sites)
    if len(triangulation.coplanar):  # left out by Qhull
        raise InputError("two random points are too near each other to be told apart; take another seed")
    triangles, opposite = triangulation.simplices, triangulation.neighbors
    flip_wrong(sites, triangles, opposite)
    return triangles, opposite


def circumcentres(sites: Points, triangles: Triangles) -> Points:
    """The point as far from each of a triangle's corners as from the others, (t, 2) float64."""
    first = sites[triangles[:, 0]]
    b, c = sites[triangles[:, 1]] - first, sites[triangles[:, 2]] - first
    bb, cc = (b * b).sum(axis=1), (c * c).sum(axis=1)
    shift = np.column_stack([c[:, 1] * bb - b[:, 1] * cc, b[:, 0] * cc - c[:, 0] * bb])
    return first + shift / (2 * cross(b, c))[:, None]


def flip_wrong(sites: Points, triangles: Triangles, opposite: Triangles) -> None:
    """Flip edges, in place, until none is the other diagonal of its two triangles."""
    for _ in range(ROUNDS):
        wrong = wrong_edges(sites, triangles, opposite)
        if not len(wrong):
            return
        changed: set[int] = set()
        for triangle, corner in wrong.tolist():
            touched = {triangle, int(opposite[triangle, corner])}
            if not touched & changed:  # else it may have another corner there by now
                flip(triangles, opposite, triangle, corner)
                changed |= touched


def wrong_edges(sites: Points, triangles: Triangles, opposite: Triangles) -> NDArray[np.int64]:
    """Edges with the fourth point inside the circle of the three of a triangle by more than rounding.

    Returns:
        (w, 2) int64: the triangle and the corner that such an edge is opposite to, from one of its two sides.
    """
    found = []
    rows = np.arange(len(triangles))
    for corner in range(3):
        beyond = opposite[:, corner]
        inside = rows < beyond  # every edge once, and none of the hull
        a, b, c = (sites[triangles[inside, (corner + turn) % 3]] for turn in range(3))
        others = triangles[beyond[inside]]
        # The fourth point: what the three of the triangle beyond have more than the two of the edge.
        fourth = others.sum(axis=1) - triangles[inside].sum(axis=1) + triangles[inside, corner]
        d = sites[fourth]
        # The angles at a and d are 180 degrees together where all four are on one circle, and less where d is outside.
        ab, ac, db, dc = b - a, c - a, b - d, c - d
        sine = cross(ab, ac) * dot(db, dc) - dot(ab, ac) * cross(db, dc)
        size = np.sqrt(dot(ab, ab) * dot(ac, ac) * dot(db, db) * dot(dc, dc))
        bad = np.flatnonzero(inside)[sine < -1e-13 * size]
        found.append(np.column_stack([bad, np.full(len(bad), corner)]))
    return np.concatenate(found)


def flip(triangles: Triangles, opposite: Triangles, triangle: int, corner: int) -> None:
    """Replace an edge by the other diagonal of its two triangles, in place; the edge is opposite to the corner."""
    other = int(opposite[triangle, corner])
    a, b, c = np.roll(triangles[triangle], -corner).tolist()
    _, beyond_ca, beyond_ab = np.roll(opposite[triangle], -corner).tolist()
    turn = next(k for k in range(3) if triangles[other, k] not in (b, c))
    d = int(triangles[other, turn])  # the other triangle is d, c, b
    _, beyond_bd, beyond_dc = np.roll(opposite[other], -turn).tolist()
    triangles[triangle], opposite[triangle] = (a, b, d), (beyond_bd, other, beyond_ab)
    triangles[other], opposite[other] = (a, d, c), (beyond_dc, beyond_ca, triangle)
    for outside, before, now in ((beyond_bd, other, triangle), (beyond_ca, triangle, other)):
        if outside >= 0:
            opposite[outside][opposite[outside] == before] = now


def cross(one: Points, other: Points) -> NDArray[np.float64]:
    """The third component of the cross products of vectors in the plane."""
    product: NDArray[np.float64] = one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0]
    return product


def dot(one: Points, other: Points) -> NDArray[np.float64]:
    """The dot products of vectors in the plane."""
    product: NDArray[np.float64] = one[:, 0] * other[:, 0] + one[:, 1] * other[:, 1]
    return product
