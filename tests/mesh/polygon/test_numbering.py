"""Renumbering a mesh of polygons changes the order and nothing else; an order that follows the mesh brings
neighbours together."""

from collections.abc import Callable

import numpy as np
import pytest

from tests.polygon.meshes import ALL
from tetrabench.errors import InputError
from tetrabench.mesh.hilbert import hilbert_keys
from tetrabench.mesh.polygon import PolygonMesh
from tetrabench.mesh.polygon.connect import connect
from tetrabench.mesh.polygon.models import MODELS, generate_polygons
from tetrabench.mesh.polygon.numbering import NUMBERINGS, next_nodes, renumber_polygons

OTHERS = [name for name in NUMBERINGS if name != "natural"]
Sides = tuple[tuple[tuple[float, ...], int], ...]


def contents(mesh: PolygonMesh) -> tuple[list[tuple[float, ...]], list[Sides]]:
    """The points, and the cells as their nodes' coordinates, each with its side's condition: both in no order of numbers."""
    points = [tuple(point) for point in mesh.points.tolist()]
    corners = list(zip([points[v] for v in mesh.nodes], mesh.conditions.tolist(), strict=True))
    return sorted(points), sorted(tuple(corners[a:b]) for a, b in zip(mesh.starts, mesh.starts[1:], strict=False))


def gaps(mesh: PolygonMesh) -> np.ndarray:
    """How far the ends of each side lie apart in the order of the nodes."""
    found: np.ndarray = abs(next_nodes(mesh.starts, mesh.nodes) - mesh.nodes)
    return found


def middles(mesh: PolygonMesh) -> np.ndarray:
    """The mean of each cell's nodes, (m, 3)."""
    cells = [mesh.points[cell].mean(axis=0) for cell in np.split(mesh.nodes, mesh.starts[1:-1])]
    return np.pad(cells, [(0, 0), (0, 3 - mesh.points.shape[1])])


@pytest.fixture(params=sorted(ALL))
def mesh(request: pytest.FixtureRequest) -> PolygonMesh:
    """Each of the small named meshes in turn."""
    factory: Callable[[], PolygonMesh] = ALL[request.param]
    return factory()


def test_natural_is_the_mesh_as_it_is(mesh: PolygonMesh) -> None:
    assert renumber_polygons(mesh, "natural") is mesh


@pytest.mark.parametrize("numbering", OTHERS)
def test_points_and_cells_are_the_same_with_their_order_of_nodes(numbering: str, mesh: PolygonMesh) -> None:
    before = contents(mesh)
    renumbered = renumber_polygons(mesh, numbering, seed=5)
    assert contents(renumbered) == before == contents(mesh)
    assert renumbered.points.dtype == np.float64
    for array in (renumbered.starts, renumbered.nodes, renumbered.conditions):
        assert array.dtype == np.int32
        assert array.flags.c_contiguous
    connect(renumbered)


@pytest.mark.parametrize("numbering", OTHERS)
def test_source_says_so_and_the_rest_of_the_report_stays(numbering: str) -> None:
    mesh = generate_polygons("quad", 9)
    mesh.report.turned = 7
    report = renumber_polygons(mesh, numbering, seed=5).report
    end = "shuffled numbering (seed 5)" if numbering == "shuffled" else f"{numbering} numbering"
    assert report.source == f"{mesh.report.source}, {end}"
    assert report.turned == 7
    assert mesh.report.source.endswith("3 x 3 quads")


def test_seed_decides_where_chance_does() -> None:
    mesh = generate_polygons("hexagon", 40)
    one, same, other = (renumber_polygons(mesh, "shuffled", seed) for seed in (1, 1, 2))
    assert one.points.tolist() == same.points.tolist()
    assert one.nodes.tolist() == same.nodes.tolist()
    assert one.points.tolist() != other.points.tolist()
    assert np.diff(one.starts).tolist() != np.diff(mesh.starts).tolist()
    for numbering in ("hilbert", "rcm"):
        assert (
            renumber_polygons(mesh, numbering, 1).nodes.tolist() == renumber_polygons(mesh, numbering, 2).nodes.tolist()
        )


@pytest.mark.parametrize("name", MODELS)
@pytest.mark.parametrize("numbering", ["hilbert", "rcm"])
def test_neighbours_come_together(numbering: str, name: str) -> None:
    shuffled = generate_polygons(name, 1000, numbering="shuffled")
    ordered = renumber_polygons(shuffled, numbering)
    assert gaps(ordered).mean() < gaps(shuffled).mean() / 4
    steps = [np.linalg.norm(np.diff(middles(mesh), axis=0), axis=1).mean() for mesh in (shuffled, ordered)]
    assert steps[1] < steps[0] / 2


@pytest.mark.parametrize("surface", [False, True])
def test_hilbert_goes_along_the_curve_with_nodes_and_with_cells(surface: bool) -> None:
    mesh = generate_polygons("voronoi", 300)
    if surface:
        x, y = mesh.points.T
        mesh.points = np.column_stack([x, y, np.sin(9 * x)])
    mesh = renumber_polygons(mesh, "hilbert")
    nodes = np.pad(mesh.points, [(0, 0), (0, 3 - mesh.points.shape[1])])
    for places in (nodes, middles(mesh)):
        keys = hilbert_keys(places).astype(np.int64)
        assert (np.diff(keys) >= 0).all()
        assert len(set(keys.tolist())) > 0.9 * len(keys)


def test_rcm_lessens_the_bandwidth() -> None:
    for name in MODELS:
        shuffled = generate_polygons(name, 1000, numbering="shuffled")
        assert gaps(renumber_polygons(shuffled, "rcm")).max() < gaps(shuffled).max() / 8


def test_rcm_numbers_cells_by_their_lowest_nodes() -> None:
    mesh = generate_polygons("voronoi", 200, numbering="rcm")
    lowest = [sorted(cell.tolist())[:3] for cell in np.split(mesh.nodes, mesh.starts[1:-1])]
    assert lowest == sorted(lowest)
    assert lowest[0][0] == 0


def test_next_nodes() -> None:
    starts, nodes = np.array([0, 3, 7, 10], np.int32), np.array([5, 1, 2, 1, 5, 9, 8, 0, 3, 4], np.int32)
    assert next_nodes(starts, nodes).tolist() == [1, 2, 5, 5, 9, 8, 1, 3, 4, 0]
    assert next_nodes(starts, nodes).dtype == np.int32


def test_refusals() -> None:
    mesh = generate_polygons("quad", 4)
    with pytest.raises(
        InputError, match=r"^no numbering 'Hilbrt'; did you mean 'hilbert'\? there are: natural, shuffled, "
    ):
        renumber_polygons(mesh, "Hilbrt")
    for numbering in NUMBERINGS:
        with pytest.raises(InputError, match=r"^a seed is 0 or more, not -1$"):
            renumber_polygons(mesh, numbering, -1)
