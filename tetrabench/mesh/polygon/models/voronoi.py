"""Voronoi: the cells of random centres, in the order of the centres, and their nodes in scipy's: none to speak of."""

import numpy as np
from numpy.typing import NDArray

from tetrabench.mesh.polygon.models.delaunay import circumcentres, triangulate
from tetrabench.mesh.polygon.models.model import SIDES, Division, Points, PolygonModel

NEAR = 5.0  # spacings from a side within which a centre is mirrored at first


def build_voronoi(wanted: int, seed: int, near: float = NEAR) -> Division:
    """Divide the unit square into the Voronoi cells of as many random centres as wanted.

    Only centres near a side have an image beyond it. An image is farther from any place in the square than its centre
    is, so it takes nothing away there: once all cells are within the square, they are the diagram's whole part in it.
    Until they are, more centres are mirrored.
    """
    centres = draw_centres(wanted, seed)
    spacing = 1 / np.sqrt(wanted)
    while (division := cut_diagram(centres, near * spacing, 1e-6 * spacing)) is None:
        assert near * spacing < 1, "with all centres mirrored no cell can leave the square"
        near *= 2
    return division


def draw_centres(count: int, seed: int) -> Points:
    """The centres of the cells, (count, 2) float64, evenly distributed over the unit square."""
    return np.random.default_rng([seed]).random((count, 2))


def cut_diagram(centres: Points, reach: float, tolerance: float) -> Division | None:
    """The Voronoi diagram of centres that are mirrored within `reach` of a side; None where a cell leaves the square by
    more than the tolerance.

    It is read from the Delaunay triangulation: a triangle is a node, an edge says between which cells a side lies, and
    no rounding gets in between. Only on the border two neighbouring centres and their images are on one circle; the
    two triangles of the four, whichever they are, are one node, and the edge between them is no side.
    """
    count = len(centres)
    sites, origin, behind = with_images(centres, reach)
    triangles, opposite = triangulate(sites)
    places = circumcentres(sites, triangles)
    held = triangles < count
    outside = abs(places - 0.5).max(axis=1) > 0.5 + tolerance
    # The cell of a centre on the hull has no end.
    if (outside[:, None] & held).any() or (held & (opposite[:, [1, 2, 0]] < 0)).any():
        return None

    # Around centre a of a triangle a, b, c the node is followed by the side to the cell of c, and the triangle beyond.
    cell, other, beyond = triangles[held], triangles[:, [2, 0, 1]][held], opposite[:, [1, 2, 0]][held]
    triangle = np.repeat(np.arange(len(triangles), dtype=np.int32), held.sum(axis=1))
    side = (behind[other] == 0) | (origin[other] == cell)
    node = joined(triangle[~side], beyond[~side], len(triangles))

    points = np.empty((node.max() + 1, 2))
    points[node] = places.clip(0, 1)
    for number, (axis, place) in enumerate(SIDES, 1):  # to the bit; the square's corners are on two of them
        on_side = held.any(axis=1) & (behind[triangles] == number).any(axis=1)
        points[node[on_side], axis] = place

    cell, other, corners = cell[side], other[side], node[triangle[side]]
    x, y = (sites[other] - sites[cell]).T
    corners = corners[np.lexsort([np.arctan2(y, x), cell])]
    used = np.zeros(len(points), bool)
    used[corners] = True
    starts = np.zeros(count + 1, np.int32)
    np.cumsum(np.bincount(cell, minlength=count), out=starts[1:])
    nodes = (np.cumsum(used, dtype=np.int32) - 1)[corners]
    return Division(points[used], starts, nodes, "random centres")


def with_images(centres: Points, reach: float) -> tuple[Points, NDArray[np.int64], NDArray[np.int8]]:
    """Put images of the centres within `reach` of a side of the square behind it.

    Returns:
        sites (n, 2) float64, the centres first; origin (n,) int64, which of them each site is or shows; behind (n,) int8,
        the number of the side that an image is behind, from 1, and 0 for a centre.
    """
    near = [np.flatnonzero(abs(centres[:, axis] - place) <= reach) for axis, place in SIDES]
    images = [centres[rows] for rows in near]
    for image, (axis, place) in zip(images, SIDES, strict=True):
        image[:, axis] = 2 * place - image[:, axis]
    origin = np.concatenate([np.arange(len(centres)), *near])
    behind = np.repeat(np.arange(5, dtype=np.int8), [len(centres), *map(len, near)])
    return np.concatenate([centres, *images]), origin, behind


def joined(one: NDArray[np.int32], other: NDArray[np.int32], count: int) -> NDArray[np.int32]:
    """Number from 0 what is one when the pairs of `count` things are joined: (count,) int32, in the order of the things."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    graph = coo_array((np.ones(len(one), bool), (one, other)), shape=(count, count))
    numbers: NDArray[np.int32] = connected_components(graph, directed=False)[1]
    return numbers


VORONOI = PolygonModel("voronoi", "Voronoi cells of random centres", 1_000_867, build_voronoi, 1000)
