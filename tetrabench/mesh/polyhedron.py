"""PolyhedronMesh: cells of any shape in space, as the faces between them; and columns of prisms on any mesh of polygons."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tetrabench.errors import InputError
from tetrabench.mesh.polygon import PolygonMesh
from tetrabench.mesh.polygon.connect import NOBODY, connect
from tetrabench.mesh.polygon.numbering import next_nodes

Integers = NDArray[np.int32]


@dataclass
class PolyhedronMesh:
    """A mesh of polyhedra as OpenFOAM's polyMesh keeps one: what lies on both sides of each face.

    Attributes:
        points: (n, 3) float64, coordinates of the nodes.
        starts: (f + 1,) int32: face j has the nodes from starts[j] up to, not with, starts[j + 1].
        nodes: (starts[f],) int32, indices into `points`, counter-clockwise seen from the face's first cell.
        cells: (f, 2) int32: the first cell, or the number of a boundary condition, which is negative; the second cell.
    """

    points: NDArray[np.float64]
    starts: Integers
    nodes: Integers
    cells: Integers

    @property
    def number_of_cells(self) -> int:
        """How many cells there are."""
        return int(self.cells.max()) + 1


def check_polyhedra(mesh: PolyhedronMesh) -> None:
    """Refuse what is no mesh of polyhedra.

    Raises:
        InputError: places that are not there, a face of fewer than three nodes, cells that no face bounds, or that are not
            closed: at an edge of a cell two of its faces meet, and run along it in opposite directions.
    """
    faces = len(mesh.cells)
    if not faces or len(mesh.starts) != faces + 1 or mesh.starts[0] != 0 or mesh.starts[-1] != len(mesh.nodes):
        raise InputError("the starts, nodes and cells of the faces do not belong together: see PolyhedronMesh")
    if np.diff(mesh.starts).min() < 3 or mesh.nodes.min() < 0 or mesh.nodes.max() >= len(mesh.points):
        raise InputError("a face has fewer than three nodes, or one that is not there")
    if mesh.cells[:, 1].min() < 0 or len(np.unique(mesh.cells[mesh.cells >= 0])) != mesh.number_of_cells:
        raise InputError("a face has no second cell, or a cell no faces")
    face = np.repeat(np.arange(faces), np.diff(mesh.starts))
    following = next_nodes(mesh.starts, mesh.nodes)
    along = np.column_stack([mesh.cells[face, 0], mesh.nodes, following])
    against = np.column_stack([mesh.cells[face, 1], following, mesh.nodes])
    sides = np.concatenate([along[along[:, 0] >= 0], against])
    back = sides[:, [0, 2, 1]]
    sides, back = sides[np.lexsort(sides.T)], back[np.lexsort(back.T)]
    twice = (sides[1:] == sides[:-1]).all(axis=1)
    wrong = np.append(twice, False) | (sides != back).any(axis=1)
    if wrong.any():
        raise InputError(f"cell {sides[wrong][0, 0]} is not closed, or its faces do not turn alike")


def extrude(mesh: PolygonMesh, heights: ArrayLike, below: int = -1, above: int = -1) -> PolyhedronMesh:
    """Columns of prisms on a mesh of polygons in the plane, from each height to the next.

    Args:
        mesh: sound; its boundary conditions become those of the sides.
        heights: (h,) ascending, two or more.
        below, above: boundary conditions at the lowest and at the highest.

    Raises:
        InputError: a mesh that no format can hold, one that is not plane, or heights that do not rise.
    """
    levels = np.asarray(heights, np.float64)
    if mesh.points.shape[1] != 2 or levels.ndim != 1 or len(levels) < 2 or not (np.diff(levels) > 0).all():
        raise InputError("columns stand on a mesh in the plane, and rise from each of two or more heights to the next")
    links = connect(mesh)
    cells, layers, points = mesh.number_of_cells, len(levels) - 1, len(mesh.points)
    lying = _lying_faces(mesh, layers, below, above)
    corners = np.flatnonzero((links.twin == NOBODY) | (links.twin > np.arange(len(links.twin))))
    a, b = links.nodes[corners], next_nodes(links.starts, links.nodes)[corners]
    within = links.twin[corners] != NOBODY
    beyond = np.where(within, links.cell[links.twin[corners]], links.conditions[corners])
    quads = np.column_stack([a, b, b + points, a + points])
    pair = np.column_stack([beyond, links.cell[corners]])
    steps = np.column_stack([np.where(within, cells, 0), np.full(len(corners), cells)])
    standing = np.concatenate([quads + layer * points for layer in range(layers)])
    sizes = np.concatenate([np.tile(np.diff(mesh.starts), layers + 1), np.full(len(standing), 4)])
    return PolyhedronMesh(
        points=np.column_stack([np.tile(mesh.points, (layers + 1, 1)), np.repeat(levels, points)]),
        starts=np.concatenate([[0], np.cumsum(sizes)]).astype(np.int32),
        nodes=np.concatenate([*lying[0], standing.ravel()]).astype(np.int32),
        cells=np.concatenate([*lying[1], *(pair + layer * steps for layer in range(layers))]).astype(np.int32),
    )


def _lying_faces(
    mesh: PolygonMesh, layers: int, below: int, above: int
) -> tuple[list[NDArray[Any]], list[NDArray[Any]]]:
    """Nodes and cells of the faces at each height: seen from above, their first cell, but for the lowest, which are turned."""
    cells, points = np.arange(mesh.number_of_cells), len(mesh.points)
    turned = np.repeat(mesh.starts[:-1] + mesh.starts[1:] - 1, np.diff(mesh.starts)) - np.arange(len(mesh.nodes))
    nodes = [mesh.nodes[turned], *(mesh.nodes + level * points for level in range(1, layers + 1))]
    pairs = [np.column_stack([np.full(len(cells), below), cells])]
    pairs += [
        np.column_stack([cells + level * len(cells), cells + (level - 1) * len(cells)]) for level in range(1, layers)
    ]
    pairs += [np.column_stack([np.full(len(cells), above), cells + (layers - 1) * len(cells)])]
    return nodes, pairs
