"""Shapes and numbering of polygons, against naive twins."""

import math

import numpy as np
import pytest

from tetrabench.mesh.polygon.check import settle
from tetrabench.mesh.polygon.inspection import inspect_polygons
from tetrabench.mesh.polygon.models import generate_polygons
from tetrabench.mesh.polygon.polygon_mesh import PolygonMesh
from tetrabench.mesh.polygon.quality import cell_normals, corner_angles, roundness


def mesh_of(points: list[list[float]], *cells: list[int]) -> PolygonMesh:
    starts = np.cumsum([0, *map(len, cells)])
    return settle(np.array(points, float), starts, np.concatenate([np.array(cell) for cell in cells]))


def corners_of(mesh: PolygonMesh) -> list[list[list[float]]]:
    return [
        mesh.points[mesh.nodes[begin:end]].tolist()
        for begin, end in zip(mesh.starts[:-1], mesh.starts[1:], strict=True)
    ]


@pytest.mark.parametrize("model", ["triangle", "quad", "hexagon", "voronoi"])
def test_shapes_in_the_plane_are_those_of_the_naive_twin(model: str) -> None:
    mesh = generate_polygons(model, 60, numbering="shuffled", seed=1)
    angles, rounds = [], []
    for cell in corners_of(mesh):
        area = perimeter = 0.0
        for k, (x, y) in enumerate(cell):
            (before_x, before_y), (next_x, next_y) = cell[k - 1], cell[(k + 1) % len(cell)]
            turned = math.atan2(before_y - y, before_x - x) - math.atan2(next_y - y, next_x - x)
            angles.append(math.degrees(turned) % 360)
            area += (x * next_y - next_x * y) / 2
            perimeter += math.dist((x, y), (next_x, next_y))
        n = len(cell)
        rounds.append(area / (perimeter**2 / (4 * n * math.tan(math.pi / n))))
    normals = cell_normals(mesh)
    np.testing.assert_allclose(corner_angles(mesh, normals), angles, rtol=1e-7)
    np.testing.assert_allclose(roundness(mesh, normals), rounds, rtol=1e-9)
    found = inspect_polygons(mesh).quality
    assert found.smallest_angle == pytest.approx(min(angles))
    assert found.largest_angle == pytest.approx(max(angles))
    assert found.worst_cells == tuple(sorted(range(len(rounds)), key=roundness(mesh, normals).__getitem__)[:5])
    assert found.concave == 0


def test_regular_polygons_are_as_round_as_can_be() -> None:
    for n in (3, 4, 5, 12):
        turns = 2 * np.pi * np.arange(n) / n
        points = np.column_stack([np.cos(turns), np.sin(turns), np.full(n, 3.0)])
        found = inspect_polygons(mesh_of(points.tolist(), [*range(n)])).quality
        assert found.roundness["worst"] == pytest.approx(1.0)
        assert (found.smallest_angle, found.largest_angle) == (pytest.approx(180 - 360 / n),) * 2


def test_a_cell_that_bends_inwards() -> None:
    arrow = [[0, 0], [2, -1], [1, 0], [2, 1]]
    found = inspect_polygons(mesh_of(arrow, [0, 1, 2, 3])).quality
    assert found.concave == 1
    assert found.largest_angle == pytest.approx(270)
    straight = inspect_polygons(mesh_of([[0, 0], [1, 0], [2, 0], [1, 1]], [0, 1, 2, 3])).quality
    assert (straight.concave, straight.largest_angle) == (0, pytest.approx(180))


def test_a_cell_without_area_has_no_angles() -> None:
    found = inspect_polygons(mesh_of([[0, 0], [1, 0], [2, 0]], [0, 1, 2])).quality
    assert (found.smallest_angle, found.largest_angle, found.concave) == (None, None, 0)
    assert found.roundness["best"] == 0.0


@pytest.mark.parametrize("order", ["natural", "shuffled"])
def test_distances_in_the_numbering_are_those_of_the_naive_twin(order: str) -> None:
    mesh = generate_polygons("voronoi", 40, numbering=order)
    cells = [mesh.nodes[a:b].tolist() for a, b in zip(mesh.starts[:-1], mesh.starts[1:], strict=True)]
    edges = [{frozenset((cell[k - 1], cell[k])) for k in range(len(cell))} for cell in cells]
    sides = [(j, i) for i in range(len(cells)) for j in range(i) for _ in edges[i] & edges[j]]
    found = inspect_polygons(mesh).numbering.distances
    for name, pairs in (("cells", sides), ("nodes", [tuple(edge) for edge in set().union(*edges)])):
        distances = [abs(one - other) for one, other in pairs]
        first = {row: min(min(pair) for pair in pairs if max(pair) == row) for row in {max(pair) for pair in pairs}}
        assert found[name].largest == max(distances)
        assert found[name].mean == pytest.approx(sum(distances) / len(distances))
        assert found[name].profile == sum(row - least for row, least in first.items())
