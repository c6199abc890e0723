"""The plane through a mesh: the polygon in which it cuts each tetra."""

import re
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tetrabench.errors import InputError

AXES = "xyz"
PLANE = re.compile(rf"\s*([{AXES}])\s*=\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?)\s*(%?)\s*", re.IGNORECASE)

# The corners of a polygon in order, as edges between the vertices of a tetra, by the number of vertices below the plane,
# which come first. A triangle has its last corner twice.
CROSSED = np.array(
    [
        [[0, 1], [0, 2], [0, 3], [0, 3]],
        [[0, 2], [0, 3], [1, 3], [1, 2]],
        [[0, 3], [1, 3], [2, 3], [2, 3]],
    ]
)
CROSSED_OF_TRIANGLE = np.array([[[0, 1], [0, 2]], [[0, 2], [1, 2]]])


@dataclass(frozen=True)
class Cut:
    """Polygons, and whose they are.

    Attributes:
        corners: (k, 4, 3) float64, convex quadrangles, corners in order; in a triangle two that follow each other, the
            last and the first among them, are one.
        tetras: (k,) int64, the row of the tetra that each lies in.
    """

    corners: NDArray[np.float64]
    tetras: NDArray[np.int64]

    @property
    def areas(self) -> NDArray[np.float64]:
        """Areas, (k,) float64: half the vector product of the diagonals."""
        a, b, c, d = self.corners.transpose(1, 0, 2)
        areas: NDArray[np.float64] = np.linalg.norm(np.cross(c - a, d - b), axis=1) / 2
        return areas


@dataclass(frozen=True)
class Plane:
    """A plane across an axis of the coordinates.

    Attributes:
        axis: 0, 1 or 2.
        value: its coordinate, in the points' unit.
    """

    axis: int
    value: float

    def __str__(self) -> str:
        return f"{AXES[self.axis]} = {self.value:.6g}"

    @property
    def normal(self) -> NDArray[np.float64]:
        """Along the axis, (3,) float64."""
        return np.array([float(axis == self.axis) for axis in range(3)])


def find_plane(text: str, points: NDArray[np.float64]) -> Plane:
    """The plane that a person means by `x=0.3`, a coordinate, or `x=30%`, a share of the extent of the points (n, 3).

    Raises:
        InputError: something else, or a plane beyond the points.
    """
    match = check_plane(text)
    axis, amount = AXES.index(match[1].lower()), float(match[2])
    low, high = float(points[:, axis].min()), float(points[:, axis].max())
    value = low + amount / 100 * (high - low) if match[3] else amount
    if not low <= value <= high:
        name = AXES[axis]
        raise InputError(f"the plane {text.strip()} lies outside: {name} goes from {low:.6g} to {high:.6g}, 0% to 100%")
    return Plane(axis, value)


def check_plane(text: str) -> re.Match[str]:
    """Its axis, its number, and whether that is a share: to be asked before there are points.

    Raises:
        InputError: it is none.
    """
    match = PLANE.fullmatch(text)
    if not match:
        raise InputError(f"{text!r} is no plane such as x=0.3, a coordinate, or y=50%, a share of the model's extent")
    return match


def cut_mesh(points: NDArray[np.float64], tets: NDArray[np.int32], normal: ArrayLike, offset: float) -> Cut:
    """Cut the tetras with the plane of all x where normal . x = offset.

    On which side a vertex lies is asked once, so that the tetras around it agree, and a vertex on the plane (to the last
    bit, where the normal is an axis) is a corner itself. No area is cut twice: a side in the plane belongs to the
    tetra above it, or to that below where no other is. A tetra that only touches the plane has no polygon, nor has a
    flat one that lies in it; where that lies between two others, both have the polygon that they share with it.

    Args:
        points: (n, 3) float64.
        tets: (m, 4) int32, indices into `points`; the tetras may be inside out.
        normal: (3,), of any length but 0; it points upwards.
        offset: as said.
    """
    height = points @ np.asarray(normal, np.float64) - offset
    sides = np.sign(height).astype(np.int8)[tets]
    below, above = (sides < 0).sum(axis=1), (sides > 0).sum(axis=1)
    standing = np.flatnonzero((below == 0) & (above == 1))
    hanging = np.flatnonzero((below == 1) & (above == 0))
    sides[standing] *= -1  # a plane in a side looks the same from both
    crossed = np.flatnonzero((below > 0) & (above > 0))
    rows = np.concatenate([crossed, _one_a_side(tets, sides, np.concatenate([standing, hanging]))])
    edges = _crossed_edges(tets[rows], sides[rows], CROSSED)
    return Cut(_crossings(points, height, edges), rows)


def cut_triangles(
    points: NDArray[np.float64], triangles: NDArray[np.int32], normal: ArrayLike, offset: float
) -> NDArray[np.float64]:
    """Cut triangles (k, 3) with the plane of all x where normal . x = offset: segments (j, 2, 3) float64.

    A triangle that lies in the plane, or is above it but for an edge, has none.
    """
    height = points @ np.asarray(normal, np.float64) - offset
    sides = np.sign(height).astype(np.int8)[triangles]
    below = (sides < 0).sum(axis=1)
    rows = np.flatnonzero((below > 0) & (below < 3))
    return _crossings(points, height, _crossed_edges(triangles[rows], sides[rows], CROSSED_OF_TRIANGLE))


def _one_a_side(tets: NDArray[np.int32], sides: NDArray[np.int8], rows: NDArray[np.int64]) -> NDArray[np.int64]:
    """Of the tetras in `rows`, which have a side in the plane, the first at each such side."""
    order = np.argsort(sides[rows], axis=1, kind="stable")  # the vertex off the plane comes first
    in_plane = np.sort(np.take_along_axis(tets[rows], order, axis=1)[:, 1:], axis=1)
    _, first = np.unique(in_plane, axis=0, return_index=True)
    chosen: NDArray[np.int64] = rows[np.sort(first)]
    return chosen


def _crossed_edges(
    simplices: NDArray[np.int32], sides: NDArray[np.int8], crossed: NDArray[np.int64]
) -> NDArray[np.int32]:
    """The edges (k, corners, 2) of tetras or triangles, their lower end first, that the plane crosses.

    Args:
        simplices: (k, 4) or (k, 3) vertices.
        sides: likewise, negative for a vertex below; some are, not all.
        crossed: which edges, by the number of vertices below, less 1.
    """
    order = np.argsort(sides, axis=1, kind="stable")
    vertices = np.take_along_axis(simplices, order, axis=1)
    places = crossed[(sides < 0).sum(axis=1) - 1]
    edges: NDArray[np.int32] = vertices[np.arange(len(vertices))[:, None, None], places]
    return edges


def _crossings(
    points: NDArray[np.float64], height: NDArray[np.float64], edges: NDArray[np.int32]
) -> NDArray[np.float64]:
    """Where edges (..., 2) cross the plane, from below to not below: (..., 3), equal bits for equal edges.

    Reckoned from the upper end, which may lie on the plane: then it is the crossing, bit by bit.
    """
    low, high = edges[..., 0], edges[..., 1]
    share = height[high] / (height[high] - height[low])
    return points[high] + share[..., None] * (points[low] - points[high])
