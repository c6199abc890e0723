"""Models of polygons: the unit square divided without gap or overlap, in about the size asked for, same seed same bits."""

import math
from collections import Counter

import numpy as np
import pytest
from scipy.spatial import Delaunay

from tetrabench.errors import InputError, MemoryRefusedError
from tetrabench.mesh.polygon import PolygonMesh
from tetrabench.mesh.polygon.connect import NOBODY, connect
from tetrabench.mesh.polygon.models import MODELS, MOST_CELLS, generate_polygons
from tetrabench.mesh.polygon.models.delaunay import circumcentres, flip, flip_wrong, triangulate, wrong_edges
from tetrabench.mesh.polygon.models.voronoi import build_voronoi, cut_diagram, draw_centres

SIZES = [*range(1, 25), 37, 60, 150]


def cells_of(mesh: PolygonMesh) -> list[list[int]]:
    """The nodes of each cell."""
    return [cell.tolist() for cell in np.split(mesh.nodes, mesh.starts[1:-1])]


def counts(mesh: PolygonMesh) -> tuple[int, int, int]:
    """Cells, edges and nodes, the edges one by one."""
    cells = cells_of(mesh)
    edges = {frozenset(side) for cell in cells for side in zip(cell, cell[1:] + cell[:1], strict=True)}
    return len(cells), len(edges), len(mesh.points)


def turns(mesh: PolygonMesh) -> np.ndarray:
    """For each corner the sine of the angle that the boundary of its cell turns by there, times both sides' lengths."""
    sines = []
    for cell in cells_of(mesh):
        here = mesh.points[cell]
        ahead = np.roll(here, -1, axis=0) - here
        behind = np.roll(ahead, 1, axis=0)
        sines.append(behind[:, 0] * ahead[:, 1] - behind[:, 1] * ahead[:, 0])
    return np.concatenate(sines)


def areas(mesh: PolygonMesh) -> np.ndarray:
    """The area of each cell, positive where it runs counter-clockwise: Gauss's formula."""
    found = []
    for cell in cells_of(mesh):
        x, y = (mesh.points[cell] - mesh.points[cell[0]]).T
        found.append((x * np.roll(y, -1) - y * np.roll(x, -1)).sum() / 2)
    return np.array(found)


@pytest.fixture(
    params=[(name, seed) for name in MODELS for seed in ((0, 1, 2) if name == "voronoi" else (0,))], ids=str
)
def meshes(request: pytest.FixtureRequest) -> list[PolygonMesh]:
    """A model in all small sizes."""
    name, seed = request.param
    return [generate_polygons(name, cells, seed=seed) for cells in SIZES]


def test_arrays_are_those_of_a_polygon_mesh(meshes: list[PolygonMesh]) -> None:
    for mesh in meshes:
        assert mesh.points.dtype == np.float64
        assert {array.dtype for array in (mesh.starts, mesh.nodes, mesh.conditions)} == {np.dtype(np.int32)}
        assert mesh.points.shape[1:] == (2,)
        assert all(array.flags.c_contiguous for array in (mesh.points, mesh.starts, mesh.nodes, mesh.conditions))


def test_every_size_hangs_together_and_is_one_disc(meshes: list[PolygonMesh]) -> None:
    for mesh in meshes:
        links = connect(mesh)
        cells, edges, nodes = counts(mesh)
        assert nodes - edges + cells == 1
        assert (len(mesh.nodes) + (links.twin == NOBODY).sum()) == 2 * edges


def test_cells_are_convex_and_counter_clockwise(meshes: list[PolygonMesh]) -> None:
    for mesh in meshes:
        assert areas(mesh).min() > 0
        # Nodes of a Voronoi diagram may be as near as rounding; none of the small ones here are.
        assert turns(mesh).min() > 0
    assert sum(mesh.number_of_cells for mesh in meshes) > 100


def test_cells_fill_the_square(meshes: list[PolygonMesh]) -> None:
    for mesh in meshes:
        assert mesh.points.min() == 0
        assert mesh.points.max() == 1
        assert math.fsum(areas(mesh)) == pytest.approx(1, rel=1e-14, abs=0)
        assert {(0, 0), (0, 1), (1, 0), (1, 1)} <= set(map(tuple, mesh.points.tolist()))


def test_no_point_comes_twice(meshes: list[PolygonMesh]) -> None:
    for mesh in meshes:
        assert len(set(map(tuple, mesh.points.tolist()))) == len(mesh.points)


def test_conditions_tell_the_sides_of_the_square_apart(meshes: list[PolygonMesh]) -> None:
    for mesh in meshes:
        lengths: Counter[int] = Counter()
        for begin, end in zip(mesh.starts, mesh.starts[1:], strict=False):
            corners = np.arange(begin, end)
            for one, other in zip(corners, np.roll(corners, -1), strict=True):
                if condition := int(mesh.conditions[one]):
                    axis, place = {-1: (1, 0), -2: (0, 1), -3: (1, 1), -4: (0, 0)}[condition]
                    ends = mesh.points[mesh.nodes[[one, other]]]
                    assert ends[:, axis].tolist() == [place, place]
                    lengths[condition] += abs(ends[1] - ends[0]).sum()
        assert dict(lengths) == {side: pytest.approx(1, rel=1e-14) for side in (-1, -2, -3, -4)}


@pytest.mark.parametrize(
    ("name", "cells", "expected"),
    [
        ("triangle", 1, (3, 7, 5)),
        ("triangle", 10, (10, 19, 10)),
        ("quad", 1, (1, 4, 4)),
        ("quad", 100, (100, 220, 121)),
        ("quad", 7, (6, 17, 12)),
        ("hexagon", 1, (1, 4, 4)),
        ("hexagon", 10 * 10 + 5, (105, 316, 212)),
        ("voronoi", 1, (1, 4, 4)),
        ("voronoi", 100, (100, 301, 202)),
    ],
)
def test_counts(name: str, cells: int, expected: tuple[int, int, int]) -> None:
    assert counts(generate_polygons(name, cells)) == expected


def test_counts_are_as_near_as_a_grid_comes() -> None:
    assert [generate_polygons("voronoi", wanted).number_of_cells for wanted in SIZES] == SIZES
    for name in ("triangle", "quad", "hexagon"):
        for wanted in (300, 1000, 2000):
            assert generate_polygons(name, wanted).number_of_cells == pytest.approx(wanted, rel=0.02)


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        # The source's mesh has 1643 boundary sides, fewer than any with six edges at each inner node.
        ("triangle", (1_005_537, 1_509_728, 504_192)),  # the source's: 1005519, 1509100, 503582
        ("quad", (1_000_000, 2_002_000, 1_002_001)),  # the source's
        ("hexagon", (1_000_500, 3_001_501, 2_001_002)),  # the source's
    ],
)
def test_counts_of_the_defaults(name: str, expected: tuple[int, int, int]) -> None:
    mesh = generate_polygons(name)
    sides = len(mesh.nodes) + np.count_nonzero(mesh.conditions)
    assert (mesh.number_of_cells, sides // 2, len(mesh.points)) == expected
    assert mesh.report.source.startswith("{}: {} cells, {} edges, {} nodes, ".format(name, *expected))


def test_counts_of_voronoi_are_the_sources_at_any_size() -> None:
    """Three edges meet in every node but the square's corners."""

    def expected(cells: int) -> tuple[int, int, int]:
        return cells, 3 * cells + 1, 2 * cells + 2

    assert expected(MODELS["voronoi"].cells) == (1_000_867, 3_002_602, 2_001_736)  # the source's
    for seed in range(5):
        assert [counts(generate_polygons("voronoi", cells, seed=seed)) for cells in SIZES] == list(map(expected, SIZES))


def test_edges_at_inner_nodes() -> None:
    for name, around in (("triangle", 6), ("quad", 4), ("hexagon", 3), ("voronoi", 3)):
        mesh = generate_polygons(name, 100)
        border = set(mesh.nodes[mesh.conditions < 0].tolist())  # a boundary node begins a boundary side
        cells = Counter(mesh.nodes.tolist())
        assert {cells[node] for node in range(len(mesh.points)) if node not in border} == {around}


def test_shapes_are_the_best_that_a_square_leaves() -> None:
    for name, sizes in (("triangle", {3}), ("quad", {4}), ("hexagon", {4, 5, 6})):
        mesh = generate_polygons(name, 2000)
        assert set(np.diff(mesh.starts)) == sizes
        found = areas(mesh)
        whole = np.median(found)
        assert np.isclose(found, whole, rtol=1e-9).mean() > 0.9
        # Of most cells; hexagons of a square grid are as wide as it, and a third taller.
        tall, wide = (np.median([np.ptp(mesh.points[cell, axis]) for cell in cells_of(mesh)]) for axis in (1, 0))
        best = {"triangle": math.sqrt(3) / 2, "quad": 1, "hexagon": 4 / 3}[name]
        assert tall / wide == pytest.approx(best, rel=0.1), name
    assert np.ptp(areas(generate_polygons("quad", 600))) < 1e-15


def test_cells_of_hexagons_are_alike_but_for_the_halves() -> None:
    mesh = generate_polygons("hexagon", 105)
    found = areas(mesh)
    halves = np.diff(mesh.starts) == 4
    assert halves.sum() == 10
    assert found[~halves] == pytest.approx(np.full(95, 0.01), rel=1e-12)
    assert found[halves] == pytest.approx(np.full(10, 0.005), rel=1e-12)
    heights = {np.ptp(mesh.points[cell, 1]).round(12) for cell in cells_of(mesh) if len(cell) == 6}
    assert heights == {round(4 / 3 / 10, 12)}  # as of regular ones, in rows of 1 / 10


@pytest.mark.parametrize("seed", range(4))
def test_a_voronoi_cell_holds_what_is_nearest_to_its_centre(seed: int, rng: np.random.Generator) -> None:
    """From the definition: every place belongs to the cell of the centre that it is nearest to."""
    mesh, centres = generate_polygons("voronoi", 60, seed=seed), draw_centres(60, seed)
    places = np.concatenate([centres, rng.random((2000, 2))])
    nearest = np.hypot(*(places[:, None] - centres).T).argmin(axis=0)
    assert nearest[:60].tolist() == list(range(60))
    for c, cell in enumerate(cells_of(mesh)):
        here, ahead = mesh.points[cell], np.roll(mesh.points[cell], -1, axis=0)
        x, y = (places[:, None] - here).transpose(2, 0, 1)
        left = (ahead - here)[:, 0] * y - (ahead - here)[:, 1] * x > 0
        assert np.flatnonzero(left.all(axis=1)).tolist() == np.flatnonzero(nearest == c).tolist()


def test_voronoi_is_the_same_however_many_centres_are_mirrored() -> None:
    for seed in range(5):
        few, all_of_them = build_voronoi(200, seed), build_voronoi(200, seed, near=15.0)
        assert counts_of_sizes(few.starts) == counts_of_sizes(all_of_them.starts)
        one, other = (np.array(sorted(division.points.round(9).tolist())) for division in (few, all_of_them))
        assert np.abs(one - other).max() < 1e-8


def counts_of_sizes(starts: np.ndarray) -> list[int]:
    """How many nodes each cell has."""
    sizes: list[int] = np.diff(starts).tolist()
    return sizes


def test_too_few_mirrored_centres_are_noticed() -> None:
    centres = draw_centres(200, 0)
    assert cut_diagram(centres, 0.0, 1e-9) is None
    assert cut_diagram(centres, 0.05, 1e-9) is None
    division = build_voronoi(200, 0, near=0.01)
    assert counts_of_sizes(division.starts) == counts_of_sizes(build_voronoi(200, 0).starts)


def test_centres_in_a_heap_away_from_the_sides() -> None:
    """Most of the square is then in cells whose centres lie far from it."""
    centres = 0.5 + 0.01 * draw_centres(40, 3)
    assert cut_diagram(centres, 0.4, 1e-9) is None
    division = cut_diagram(centres, 1.0, 1e-9)
    assert division is not None
    mesh = PolygonMesh(division.points, division.starts, division.nodes, np.zeros(len(division.nodes), np.int32))
    assert math.fsum(areas(mesh)) == pytest.approx(1, rel=1e-12)
    assert counts(mesh) == (40, 121, 82)


def test_wrong_diagonals_are_flipped_back(rng: np.random.Generator) -> None:
    """In few points too, where a triangle has several wrong edges, and others of the hull."""
    wrong = 0
    for count in [6, 8, 10, 12] * 20 + [300]:
        sites = rng.random((count, 2))
        triangles, opposite = triangulate(sites)
        assert len(wrong_edges(sites, triangles, opposite)) == 0
        before = {frozenset(three) for three in triangles.tolist()}
        for triangle in range(len(triangles)):
            a, b, c = triangles[triangle]
            beyond = opposite[triangle, 0]
            if beyond >= 0:
                fourth = next(v for v in triangles[beyond] if v not in (b, c))
                if all(area(sites[[a, *pair]]) > 1e-6 for pair in ((b, fourth), (fourth, c))):  # convex together
                    flip(triangles, opposite, triangle, 0)
        check_neighbours(triangles, opposite)
        wrong += len({frozenset(three) for three in triangles.tolist()} - before)
        flip_wrong(sites, triangles, opposite)
        check_neighbours(triangles, opposite)
        assert {frozenset(three) for three in triangles.tolist()} == before
        assert all(area(sites[three]) > 0 for three in triangles)
    assert wrong > 500


def test_wrong_diagonals_of_qhull_are_flipped() -> None:
    """In a heap of points far smaller than all of them Qhull's rounding shows."""
    wrong = 0
    for seed in range(6):
        sites = heap(2e-5, seed)
        qhull = Delaunay(sites)
        wrong += len(wrong_edges(sites, qhull.simplices, qhull.neighbors))
        triangles, opposite = triangulate(sites)
        assert len(wrong_edges(sites, triangles, opposite)) == 0
        check_neighbours(triangles, opposite)
        assert all(area(sites[three]) > 0 for three in triangles)
    assert wrong > 0


def test_points_that_qhull_leaves_out_are_refused() -> None:
    with pytest.raises(
        InputError, match=r"^two random points are too near each other to be told apart; take another seed$"
    ):
        triangulate(heap(1e-7, 0))


def heap(size: float, seed: int) -> np.ndarray:
    """Points all over the square, and most of them in a small one in its middle."""
    random = np.random.default_rng(seed)
    return np.concatenate([random.random((40, 2)), 0.5 + size * random.random((300, 2))])


def area(three: np.ndarray) -> float:
    """Twice the area of a triangle."""
    (x, y), (u, v) = three[1:] - three[0]
    return float(x * v - y * u)


def check_neighbours(triangles: np.ndarray, opposite: np.ndarray) -> None:
    """Opposite to each corner lies the one triangle that has the other two."""
    for triangle, (three, others) in enumerate(zip(triangles.tolist(), opposite.tolist(), strict=True)):
        for corner, other in enumerate(others):
            if other >= 0:
                edge = {*three} - {three[corner]}
                assert edge <= {*triangles[other].tolist()}
                assert triangle in opposite[other]


def test_circumcentres_are_as_far_from_all_three(rng: np.random.Generator) -> None:
    sites = rng.random((90, 2)) + 1e6  # far away from the origin nothing may get lost
    triangles = np.arange(90, dtype=np.int32).reshape(30, 3)
    far = np.linalg.norm(sites[triangles] - circumcentres(sites, triangles)[:, None], axis=2)
    assert far.max(axis=1) == pytest.approx(far.min(axis=1), rel=1e-6)


@pytest.mark.parametrize("name", MODELS)
def test_same_seed_same_bits(name: str) -> None:
    def bits(seed: int) -> tuple[bytes, ...]:
        mesh = generate_polygons(name, 50, numbering="shuffled", seed=seed)
        return mesh.points.tobytes(), mesh.starts.tobytes(), mesh.nodes.tobytes(), mesh.conditions.tobytes()

    assert bits(3) == bits(3)
    assert bits(3) != bits(4)
    same = len({generate_polygons(name, 50, seed=seed).points.tobytes() for seed in (3, 4)})
    assert same == (2 if name == "voronoi" else 1)


def test_source_states_what_was_made() -> None:
    source = generate_polygons("hexagon", 10, numbering="shuffled", seed=7).report.source
    assert source == "hexagon: 10 cells, 31 edges, 22 nodes, 3 x 3 hexagons, shuffled numbering (seed 7)"


def test_refusals(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(
        InputError, match=r"^no model 'hexagn'; did you mean 'hexagon'\? there are: triangle, quad, hex"
    ):
        generate_polygons("hexagn")
    for cells in (0, -5, MOST_CELLS + 1):
        with pytest.raises(InputError, match=f"^a model of {cells:,} cells cannot be made; ask for 1 to 357,913,941$"):
            generate_polygons("quad", cells)
    with pytest.raises(InputError, match=r"^no numbering 'random'; there are: natural, shuffled, hilbert, rcm$"):
        generate_polygons("quad", 10, numbering="random")
    with pytest.raises(InputError, match=r"^a seed is 0 or more, not -1$"):
        generate_polygons("voronoi", 10, seed=-1)
    monkeypatch.setattr("tetrabench.memory.available_bytes", lambda: 10**6)
    with pytest.raises(MemoryRefusedError, match=r"^a model of 10,000 cells needs about 9.5 MiB of memory, "):
        generate_polygons("voronoi", 10_000)
