"""A pipe: a disc that moves along a path, in layers, and changes size, shape and direction on its way."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tetrabench.mesh.models.model import Points, Regular, Tets, nearest

Reals = NDArray[np.float64]

STEPS = 2000  # of the integral along a path


@dataclass(frozen=True, kw_only=True)
class Pipe:
    """A pipe, solid, before it is divided. Lengths in metres, places as arc length along its path.

    Attributes:
        length: of the path.
        radius: (k,) places -> (k,) radii of the sections there, where a section is not round its least one.
        place: (n, 2) points of the unit disc, (k,) places -> (k, n, 3): the disc as section at each place. The
            rim goes onto the wall, and x, y and the path are right-handed.
        fewest_layers: how many the path needs to be recognised.
    """

    length: float
    radius: Callable[[Reals], Reals]
    place: Callable[[Points, Reals], Points]
    fewest_layers: int = 1


def build_pipe(pipe: Pipe, wanted: int) -> Regular:
    """Divide a pipe into about the number of tets wanted.

    A disc of m rings has 6 m^2 triangles. Moved along the path in n layers it gives 6 m^2 n prisms, each split in
    3 tets: 18 m^2 n. A layer is as thick as the pipe is narrow there, and the cells are nearest to isotropic where
    n / m is the integral of 1 / radius along the path.
    """
    fine = np.linspace(0.0, pipe.length, STEPS + 1)
    integral = np.concatenate([[0.0], np.cumsum(1 / pipe.radius((fine[1:] + fine[:-1]) / 2))])  # over equal steps
    ideal = integral[-1] * pipe.length / STEPS
    middle = round((wanted / 18 / ideal) ** (1 / 3))
    rings, layers = nearest(
        (
            (m, max(pipe.fewest_layers, round(wanted / 18 / m**2)))
            for m in range(max(1, middle * 3 // 4), middle * 5 // 4 + 2)
        ),
        count=lambda choice: 18 * choice[0] ** 2 * choice[1],
        wanted=wanted,
        distortion=lambda choice: abs(np.log(choice[1] / choice[0] / ideal)),
    )
    disc, triangles = build_disc(rings)
    places = np.interp(np.linspace(0.0, integral[-1], layers + 1), integral, fine)
    points = pipe.place(disc, places)

    thickness = np.linalg.norm(np.diff(points, axis=0), axis=2).min(axis=1)
    thickness = np.minimum(np.append(thickness[0], thickness), np.append(thickness, thickness[-1]))
    reach = np.tile(np.minimum(pipe.radius(places) / rings, thickness)[:, None] * 0.12, (1, len(disc)))
    reach[:, len(disc) - 6 * rings :] = 0  # the wall
    reach[[0, -1]] = 0  # inlet and outlet
    words = f"{rings} rings x {layers} layers"
    return Regular(points.reshape(-1, 3), cut_prisms(disc, triangles, layers), reach.ravel(), words)


def build_disc(rings: int) -> tuple[Points, NDArray[np.int64]]:
    """Triangulate the unit disc by concentric rings: the middle, then ring k = 1, 2, ... with 6 k points.

    Returns:
        points (1 + 3 m (m + 1), 2) float64, the rim last; triangles (6 m^2, 3) int64, counter-clockwise.
    """
    points, triangles = [np.zeros((1, 2))], []
    inner, outer = 0, 1  # first points of rings k - 1 and k
    for k in range(1, rings + 1):
        angle = np.arange(6 * k) * (np.pi / (3 * k))
        points.append(k / rings * np.stack([np.cos(angle), np.sin(angle)], axis=1))
        sector, j = (grid.ravel() for grid in np.indices((6, k)))
        on_outer = [outer + (sector * k + j + step) % (6 * k) for step in (0, 1)]
        on_inner = [inner + (sector * (k - 1) + j + step) % max(1, 6 * (k - 1)) for step in (0, 1)]
        triangles.append(np.stack([on_inner[0], on_outer[0], on_outer[1]], axis=1))
        triangles.append(np.stack([on_inner[0], on_outer[1], on_inner[1]], axis=1)[j < k - 1])
        inner, outer = outer, outer + 6 * k
    return np.concatenate(points), np.concatenate(triangles)


def cut_prisms(disc: Points, triangles: NDArray[np.int64], layers: int) -> Tets:
    """Cut the prisms between the layers in three tets each.

    A prism over the triangle a < b < c is cut along a b', a c', b c' (' is one layer up). The cut of a side
    depends on its two columns of points alone, so neighbours agree.

    Args:
        disc: (n, 2) float64; a layer has its points in this order, layer after layer.
        triangles: (k, 3) int64, indices into `disc`.
        layers: how many.

    Returns:
        (3 k layers, 4) int32, layer by layer.
    """
    a, b, c = np.sort(triangles, axis=1).T
    up = len(disc)
    prism = np.stack([[a, b, c, c + up], [a, b, c + up, b + up], [a, a + up, b + up, c + up]]).transpose(2, 0, 1)
    # Sorting may have turned a triangle over, and its prism inside out.
    ab, ac = disc[b] - disc[a], disc[c] - disc[a]
    turned = ab[:, 0] * ac[:, 1] < ab[:, 1] * ac[:, 0]
    prism[turned] = prism[turned][:, :, [0, 2, 1, 3]]
    return (prism.reshape(1, -1, 4) + up * np.arange(layers)[:, None, None]).reshape(-1, 4).astype(np.int32)
