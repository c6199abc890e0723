"""inspect_polygons: what a person wants to know about a mesh of polygons before working with it."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from tetrabench.mesh.bandwidth import Pairs, measure_both
from tetrabench.mesh.inspection import Numbering, find_worst, quantiles
from tetrabench.mesh.polygon.connect import NOBODY, Connections, connect
from tetrabench.mesh.polygon.numbering import next_nodes
from tetrabench.mesh.polygon.polygon_mesh import PolygonMesh
from tetrabench.mesh.polygon.quality import cell_normals, corner_angles, roundness, spatial

STRAIGHT = 180.001
"""Degrees: a corner is re-entrant beyond this, and not by rounding alone."""


@dataclass(frozen=True)
class PolygonQuality:
    """How well shaped the cells are.

    Attributes:
        roundness: area over that of the regular polygon with as many nodes and the same perimeter (`quality.roundness`):
            quantiles over the cells; "10 %" is what a tenth of them do not exceed.
        smallest_angle: inside any cell at any corner, in degrees; None where all cells are without area.
        largest_angle: likewise.
        concave: cells with a re-entrant corner.
        worst_cells: rows, from 0, of the cells that are least round, the worst first.
    """

    roundness: dict[str, float]
    smallest_angle: float | None
    largest_angle: float | None
    concave: int
    worst_cells: tuple[int, ...]


@dataclass(frozen=True)
class PolygonInspection:
    """What there is to say about a mesh of polygons. These are also the keys of `tetrabench info --format json`.

    Attributes:
        source: path of the file, or the words that describe a generated model.
        format: name of the file's format, "" for a generated model.
        cells: cells.
        edges: edges.
        nodes: nodes.
        components: parts of cells that are joined through sides.
        boundary_sides: sides with a cell on one side alone.
        boundaries: closed rows of these: one around a plane mesh, and one around each of its holes.
        conditions: boundary sides by their boundary condition.
        euler_number: nodes - edges + cells: 1 for a disc, 2 for a sphere, 0 for a torus.
        nodes_per_cell: cells by their number of nodes, as far as there are any.
        lowest: the bounding box's lowest corner, in the file's unit of length: x and y, and z on a surface.
        highest: its highest corner.
        area: sum of the cells' areas, each taken as positive, in the square of that unit; of a cell that is not plane,
            that of its projection along its mean normal.
        turned: cells whose nodes were listed the other way round, and were turned over.
        split: nodes in which parts touched that no sides joined, and that were split.
        unreferenced: nodes of no cell, which were left out.
        quadratic: cells with midside nodes, of which the corners alone are used.
        values: names of the numbers that the file holds for its points and cells; they are no part of the mesh.
        dropped: cells left out because no format can hold them, reason -> count.
        skipped: cells of the file that are no polygons, kind -> count.
        warnings: sentences of the reader.
        quality: how well shaped the cells are, see `PolygonQuality`.
        numbering: how far apart neighbouring cells, and nodes, lie in memory, see `mesh.inspection.Numbering`.
        refusal: why the file is refused unless --repair drop mends it; "" where it is not. All the rest is about the mesh
            as that mends it.
    """

    source: str
    format: str
    cells: int
    edges: int
    nodes: int
    components: int
    boundary_sides: int
    boundaries: int
    conditions: dict[str, int]
    euler_number: int
    nodes_per_cell: dict[str, int]
    lowest: tuple[float, ...]
    highest: tuple[float, ...]
    area: float
    turned: int
    split: int
    unreferenced: int
    quadratic: int
    values: list[str]
    dropped: dict[str, int]
    skipped: dict[str, int]
    warnings: list[str]
    quality: PolygonQuality
    numbering: Numbering
    refusal: str = ""


def inspect_polygons(mesh: PolygonMesh) -> PolygonInspection:
    """Inspect a mesh.

    Raises:
        InputError: a mesh that no format can hold.
    """
    links = connect(mesh)
    inner, boundary = (np.flatnonzero(where) for where in (links.twin != NOBODY, links.twin == NOBODY))
    cells, edges, nodes = mesh.number_of_cells, len(inner) // 2 + len(boundary), len(mesh.points)
    place = np.cumsum(links.twin == NOBODY) - 1  # of each corner among those of the boundary
    ends = next_nodes(mesh.starts, mesh.nodes)[boundary]
    conditions, sides = np.unique(mesh.conditions[boundary], return_counts=True)
    sizes, counts = np.unique(np.diff(mesh.starts), return_counts=True)
    report, normals = mesh.report, cell_normals(mesh)
    return PolygonInspection(
        source=report.source,
        format=report.format,
        cells=cells,
        edges=edges,
        nodes=nodes,
        components=_components(cells, links.cell[inner], links.cell[links.twin[inner]]),
        boundary_sides=len(boundary),
        boundaries=_components(len(boundary), np.arange(len(boundary)), place[links.first[ends]]),
        conditions=dict(zip(map(str, conditions[::-1]), sides[::-1].tolist(), strict=True)),
        euler_number=nodes - edges + cells,
        nodes_per_cell=dict(zip(map(str, sizes), counts.tolist(), strict=True)),
        lowest=tuple(mesh.points.min(axis=0).tolist()),
        highest=tuple(mesh.points.max(axis=0).tolist()),
        area=float(np.linalg.norm(normals, axis=1).sum()),
        turned=report.turned,
        split=report.split,
        unreferenced=report.unreferenced,
        quadratic=report.quadratic,
        values=report.values,
        dropped=report.dropped,
        skipped=report.skipped,
        warnings=report.warnings,
        quality=judge_shapes(mesh, normals),
        numbering=judge_numbering(mesh, links),
    )


def judge_shapes(mesh: PolygonMesh, normals: NDArray[np.float64]) -> PolygonQuality:
    """Judge the shapes of cells: `normals` as `cell_normals` gives them."""
    round_ = roundness(mesh, normals)
    angles, owner = corner_angles(mesh, normals), np.repeat(np.arange(mesh.number_of_cells), np.diff(mesh.starts))
    has_inside = (normals != 0).any(axis=1)[owner]
    angles, owner = angles[has_inside], owner[has_inside]
    return PolygonQuality(
        roundness=quantiles(round_),
        smallest_angle=float(angles.min()) if len(angles) else None,
        largest_angle=float(angles.max()) if len(angles) else None,
        concave=len(np.unique(owner[angles > STRAIGHT])),
        worst_cells=tuple(find_worst(round_).tolist()),
    )


def judge_numbering(mesh: PolygonMesh, links: Connections) -> Numbering:
    """Judge the numbering of cells, and of nodes through edges, each counted once."""
    corners = np.arange(len(mesh.nodes))
    inner, once = (
        np.flatnonzero(where) for where in (links.twin > corners, (links.twin > corners) | (links.twin == NOBODY))
    )
    ends = next_nodes(mesh.starts, mesh.nodes)

    def through_sides() -> Pairs:
        return [(links.cell[inner], links.cell[links.twin[inner]])]

    def through_edges() -> Pairs:
        return [(mesh.nodes[once], ends[once])]

    points, sizes = spatial(mesh), np.diff(mesh.starts)
    middles = np.add.reduceat(points[mesh.nodes], mesh.starts[:-1], axis=0) / sizes[:, None]
    of_cells, advice = measure_both("cells", middles, through_sides)
    of_nodes, _ = measure_both("nodes", points, through_edges)
    return Numbering(of_cells | of_nodes, advice)


def _components(members: int, ones: NDArray[np.integer], others: NDArray[np.integer]) -> int:
    """How many components a graph has."""
    graph = coo_array((np.ones(len(ones), np.bool_), (ones, others)), shape=(members, members))
    return int(connected_components(graph, directed=False, return_labels=False)) if members else 0
