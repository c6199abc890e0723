"""inspect_mesh on meshes whose counts are known, and against naive twins."""

from collections import Counter
from itertools import combinations

import numpy as np
import pytest

from tests.meshes import apart, box, mesh_of, single, touching
from tetrabench.errors import InputError
from tetrabench.mesh import TetraMesh
from tetrabench.mesh.bandwidth import Bandwidth
from tetrabench.mesh.inspection import inspect_mesh
from tetrabench.mesh.models import generate
from tetrabench.mesh.numbering import renumber
from tetrabench.mesh.quality import radius_ratios

CUBE = generate("box", 6)  # one cube of six tetras


def two_cubes(*, turned: bool = False, lifted: float = 0.0, joined: bool = False) -> TetraMesh:
    """Two cubes side by side at x = 1; the second one may be turned around, so that the diagonals of the square
    between them cross; joined: with the points there in common."""
    other = CUBE.points * [-1, 1, 1] + [2, 0, 0] if not turned else CUBE.points * [1, -1, 1] + [1, 1, 0]
    points = np.concatenate([CUBE.points, other + [0, 0, lifted]]).round(12)
    tets = np.concatenate([CUBE.tets, CUBE.tets + len(CUBE.points)])
    if joined:
        points, rows = np.unique(points, axis=0, return_inverse=True)
        tets = rows.ravel()[tets]
    return mesh_of(points, tets)


def naive(mesh: TetraMesh) -> dict[str, int]:
    """Counts in plain Python."""
    sharers: dict[frozenset[int], list[int]] = {}
    for row, four in enumerate(mesh.tets.tolist()):
        for node in four:
            sharers.setdefault(frozenset(four) - {node}, []).append(row)
    parts = {row: {row} for row in range(len(mesh.tets))}
    for rows in sharers.values():
        whole = set().union(*(parts[row] for row in rows))
        parts.update(dict.fromkeys(whole, whole))
    surface = [side for side, rows in sharers.items() if len(rows) == 1]
    edges = Counter(frozenset(edge) for side in surface for edge in combinations(side, 2))
    places = Counter(map(tuple, (mesh.points[np.unique(mesh.tets)] + 0.0).tolist()))
    broken = 0
    for vertex in {node for side in surface for node in side}:
        around = [side for side in surface if vertex in side]
        fans = {side: {side} for side in around}
        for one, other in combinations(around, 2):
            if len(one & other) == 2 and edges[one & other] == 2:
                whole = fans[one] | fans[other]
                fans.update(dict.fromkeys(whole, whole))
        broken += len({id(fan) for fan in fans.values()}) > 1
    return {
        "components": len({id(part) for part in parts.values()}),
        "surface_sides": len(surface),
        "nonmanifold_edges": sum(count > 2 for count in edges.values()),
        "nonmanifold_vertices": broken,
        "coincident_points": sum(count for count in places.values() if count > 1),
    }


def counts(mesh: TetraMesh) -> dict[str, int]:
    found = inspect_mesh(mesh)
    return {name: getattr(found, name) for name in naive(mesh)}


def test_counts_are_those_of_the_naive_twin(small_mesh: TetraMesh) -> None:
    assert counts(small_mesh) == naive(small_mesh)


@pytest.mark.parametrize("seed", range(6))
def test_counts_of_what_is_left_of_a_mesh(seed: int) -> None:
    """A box with tetras missing touches itself in edges and points."""
    mesh = box()
    mesh.tets = mesh.tets[np.random.default_rng(seed).uniform(size=len(mesh.tets)) < 0.5]
    assert counts(mesh) == naive(mesh)
    assert naive(mesh)["nonmanifold_vertices"] > 0


def test_two_parts_that_touch_in_a_point_and_an_edge() -> None:
    found = inspect_mesh(touching())
    assert (found.components, found.nonmanifold_edges, found.nonmanifold_vertices) == (3, 1, 2)


def test_measures() -> None:
    mesh = apart()
    mesh.points[4] = np.nan  # nobody uses it
    mesh.tets[1] = mesh.tets[1][::-1]
    found = inspect_mesh(mesh)
    assert (found.points, found.tetras) == (9, 2)
    assert (found.lowest, found.highest) == ((0, 0, 0), (6, 6, 6))
    assert found.volume == pytest.approx(1 / 3)
    assert found.quality.smallest_dihedral_angle == pytest.approx(54.7356103)
    assert found.quality.largest_dihedral_angle == pytest.approx(90)
    assert sorted(found.quality.worst_tetras) == [1, 2]
    flat = inspect_mesh(mesh_of([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]], [[0, 1, 2, 3]]))
    assert (flat.quality.smallest_dihedral_angle, flat.quality.largest_dihedral_angle) == (None, None)
    assert set(flat.quality.radius_ratio.values()) == {0.0}
    assert flat.volume == 0


def test_parts_that_match_and_are_not_joined() -> None:
    found = inspect_mesh(two_cubes())
    assert (found.components, found.surface_sides) == (2, 24)
    assert (found.coincident_points, found.doubled_sides, found.crossing_sides) == (8, 4, 0)
    joined = inspect_mesh(two_cubes(joined=True))
    assert (joined.components, joined.surface_sides) == (1, 20)
    assert (joined.coincident_points, joined.doubled_sides, joined.crossing_sides) == (0, 0, 0)


@pytest.mark.parametrize("joined", [False, True])
def test_diagonals_that_cross(joined: bool) -> None:
    found = inspect_mesh(two_cubes(turned=True, joined=joined))
    assert found.components == 2
    assert (found.coincident_points, found.doubled_sides, found.crossing_sides) == (0 if joined else 8, 0, 4)


@pytest.mark.parametrize("mesh", [single(), apart(), touching()])
def test_a_tetra_does_not_cross_itself(mesh: TetraMesh) -> None:
    """Two sides of a tetra without neighbours have the four places of its other two, along the other diagonal."""
    assert inspect_mesh(mesh).crossing_sides == 0


def test_parts_a_rounding_apart_are_not_said_to_touch() -> None:
    found = inspect_mesh(two_cubes(lifted=1e-12))
    assert (found.coincident_points, found.doubled_sides, found.crossing_sides) == (0, 0, 0)


def test_without_tetras_there_is_nothing_to_inspect() -> None:
    for points in ([], [[0, 0, 0]]):
        with pytest.raises(InputError, match=r"^mesh: holds no tetras"):
            inspect_mesh(mesh_of(points, []))


def test_zero_and_its_negative_are_one_place() -> None:
    mesh = two_cubes()
    mesh.points[len(CUBE.points) :] = np.where(
        mesh.points[len(CUBE.points) :] == 0, -0.0, mesh.points[len(CUBE.points) :]
    )
    assert inspect_mesh(mesh).doubled_sides == 4


def test_what_the_reader_counted_is_handed_on() -> None:
    mesh = apart()
    mesh.report.skipped, mesh.report.dropped = {"CBAR": 3}, {"duplicate": 2}
    mesh.report.quadratic, mesh.report.inverted, mesh.report.degenerate = 4, 5, 6
    found = inspect_mesh(mesh)
    assert (found.skipped, found.dropped) == ({"CBAR": 3}, {"duplicate": 2})
    assert (found.quadratic, found.inverted, found.degenerate) == (4, 5, 6)


def test_the_worst_tetras_are_those_of_the_naive_twin() -> None:
    mesh = generate("box", 150, seed=2)
    mesh.tet_ids = mesh.tet_ids[::-1] * 10
    ratios = radius_ratios(mesh.points, mesh.tets).tolist()
    order = sorted(range(len(ratios)), key=lambda row: (ratios[row], row))
    found = inspect_mesh(mesh).quality
    assert found.worst_tetras == tuple(mesh.tet_ids[row] for row in order[:5])
    ordered = sorted(ratios)
    places = {"worst": 0.0, "1 %": 0.01, "10 %": 0.1, "median": 0.5, "best": 1.0}
    assert found.radius_ratio == {name: ordered[int(share * (len(ratios) - 1))] for name, share in places.items()}


@pytest.mark.parametrize("order", ["natural", "shuffled", "hilbert"])
def test_distances_in_the_numbering_are_those_of_the_naive_twin(order: str) -> None:
    mesh = generate("box", 150, numbering=order)
    of_sides, of_edges = [], []
    tets = mesh.tets.tolist()
    for i, one in enumerate(tets):
        of_sides += [(j, i) for j in range(i) if len({*one} & {*tets[j]}) == 3]
        of_edges += list(combinations(one, 2))
    found = inspect_mesh(mesh).numbering
    for name, count, pairs in (("tetras", len(tets), of_sides), ("points", len(mesh.points), of_edges)):
        before = [min([row, *(min(pair) for pair in pairs if max(pair) == row)]) for row in range(count)]
        distances = [abs(one - other) for one, other in pairs]
        assert found.distances[name] == Bandwidth(
            max(distances), pytest.approx(sum(distances) / len(pairs)), sum(range(count)) - sum(before)
        )
    along = inspect_mesh(renumber(mesh, "hilbert")).numbering.distances
    for name in ("tetras", "points"):
        assert found.distances[f"{name} along a Hilbert curve"] == along[name]


def test_another_order_is_advised_where_it_pays(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tetrabench.mesh.bandwidth.FEWEST", 300)
    monkeypatch.setattr("tetrabench.mesh.bandwidth.WORTH", 2.0)
    mesh = generate("box", 400, numbering="shuffled")
    told = inspect_mesh(mesh).numbering
    now, then = (told.distances[name].mean for name in ("tetras", "tetras along a Hilbert curve"))
    assert f"neighbouring tetras from {now:,.0f} rows apart to {then:,.0f}" in told.advice
    assert inspect_mesh(renumber(mesh, "hilbert")).numbering.advice == ""
    monkeypatch.setattr("tetrabench.mesh.bandwidth.FEWEST", 500)
    assert inspect_mesh(mesh).numbering.advice == ""
