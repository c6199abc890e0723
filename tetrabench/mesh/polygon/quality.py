"""Shapes of polygons: the angles at their corners, and how round they are."""

import numpy as np
from numpy.typing import NDArray

from tetrabench.mesh.polygon.numbering import next_nodes
from tetrabench.mesh.polygon.polygon_mesh import PolygonMesh

Reals = NDArray[np.float64]


def spatial(mesh: PolygonMesh) -> Reals:
    """The nodes, (n, 3): a plane mesh lies at z = 0."""
    points = np.zeros((len(mesh.points), 3))
    points[:, : mesh.points.shape[1]] = mesh.points
    return points


def cell_normals(mesh: PolygonMesh) -> Reals:
    """Of the cells, (m, 3): the direction of the side that they are seen counter-clockwise from, as long as their area."""
    points = spatial(mesh)
    origin = np.repeat(points[mesh.nodes[mesh.starts[:-1]]], np.diff(mesh.starts), axis=0)  # for the sake of the digits
    one, other = points[mesh.nodes] - origin, points[next_nodes(mesh.starts, mesh.nodes)] - origin
    normals: Reals = np.add.reduceat(np.cross(one, other), mesh.starts[:-1], axis=0) / 2
    return normals


def corner_angles(mesh: PolygonMesh, normals: Reals) -> Reals:
    """The angle inside the cell at each corner, (s,), in degrees: above 180 where it is re-entrant.

    Args:
        normals: `cell_normals`; a cell without an area has no inside, and 180 degrees everywhere or 0.
    """
    points, sizes = spatial(mesh), np.diff(mesh.starts)
    leaving = points[next_nodes(mesh.starts, mesh.nodes)] - points[mesh.nodes]
    arriving = np.roll(leaving, 1, axis=0)
    arriving[mesh.starts[:-1]] = leaving[mesh.starts[1:] - 1]
    lengths = np.linalg.norm(normals, axis=1)
    up = np.repeat(normals / np.where(lengths > 0, lengths, 1.0)[:, None], sizes, axis=0)
    sine, cosine = (np.cross(arriving, leaving) * up).sum(axis=1), (arriving * leaving).sum(axis=1)
    angles: Reals = 180.0 - np.degrees(np.arctan2(sine, cosine))
    return angles


def roundness(mesh: PolygonMesh, normals: Reals) -> Reals:
    """How round each cell is, (m,): 1 for a regular polygon, towards 0 for a flat one.

    The isoperimetric quotient 4 pi A / P^2 (Polya and Szego 1951) over that of the regular polygon with as many nodes, which
    makes it 4 n tan(pi / n) A / P^2.
    """
    points, sizes = spatial(mesh), np.diff(mesh.starts)
    sides = np.linalg.norm(points[next_nodes(mesh.starts, mesh.nodes)] - points[mesh.nodes], axis=1)
    perimeters = np.add.reduceat(sides, mesh.starts[:-1])
    areas = np.linalg.norm(normals, axis=1)
    wide = np.where(perimeters > 0, perimeters, 1.0)
    quotients: Reals = 4 * sizes * np.tan(np.pi / sizes) * (areas / wide) / wide
    return np.minimum(quotients, 1.0)
