"""Settling cells of any kind: what is refused, what is mended, which way the cells are turned."""

import itertools
from collections import Counter

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tetrabench.errors import InputError, RepairableError
from tetrabench.mesh.polygon import PolygonMesh
from tetrabench.mesh.polygon.check import settle
from tetrabench.mesh.polygon.connect import connect
from tetrabench.mesh.polygon.models import MODELS, generate_polygons
from tetrabench.mesh.polygon.polygon_mesh import CONDITION, PolygonReport

SPHERE = np.random.default_rng(5).normal(size=(12, 3))
CUBE = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)], float)
CUBE_CELLS = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]


def settled(points: object, cells: list[list[int]], conditions: object = None, **words: object) -> PolygonMesh:
    """From nested lists; whatever comes out hangs together."""
    starts = np.append(0, np.cumsum([len(cell) for cell in cells], dtype=np.int64))
    nodes = np.array([node for cell in cells for node in cell], np.int64)
    mesh = settle(points, starts, nodes, conditions, **words)
    connect(mesh)
    return mesh


def cells_of(mesh: PolygonMesh) -> list[list[int]]:
    return [part.tolist() for part in np.split(mesh.nodes, mesh.starts[1:-1])]


def turned_over(mesh: PolygonMesh, over: np.ndarray) -> tuple[list[list[int]], list[int]]:
    """Cells and conditions with some of the cells the other way round, from the same first node."""
    cells, conditions = cells_of(mesh), [c.tolist() for c in np.split(mesh.conditions, mesh.starts[1:-1])]
    cells = [[cell[0], *cell[:0:-1]] if turn else cell for cell, turn in zip(cells, over, strict=True)]
    conditions = [row[::-1] if turn else row for row, turn in zip(conditions, over, strict=True)]
    return cells, [number for row in conditions for number in row]


# ---------------------------------------------------------------------- turning


@pytest.mark.parametrize("name", MODELS)
@pytest.mark.parametrize("share", [0.0, 0.3, 1.0])
def test_a_plane_mesh_comes_back_whichever_way_its_cells_run(name: str, share: float, rng: np.random.Generator) -> None:
    mesh = generate_polygons(name, 60)
    over = rng.random(mesh.number_of_cells) < share
    cells, conditions = turned_over(mesh, over)
    for points in (mesh.points, np.column_stack([mesh.points, np.zeros(len(mesh.points))])):
        back = settled(points, cells, conditions)
        assert back.report.turned == over.sum()
        for array in ("points", "starts", "nodes", "conditions"):
            np.testing.assert_array_equal(getattr(back, array), getattr(mesh, array))
            assert getattr(back, array).dtype == getattr(mesh, array).dtype
    lifted = settled(np.column_stack([mesh.points, np.full(len(mesh.points), 7.0)]), cells)
    assert lifted.points.shape[1] == 3
    assert cells_of(lifted) == cells_of(mesh)
    assert set(lifted.conditions.tolist()) == {0, CONDITION}


def test_on_a_surface_most_cells_stay_as_they_are() -> None:
    for over in ([0], [2, 4], [0, 1, 2]):  # of six, and where it is half, the first one stays
        stays = len(over) < 3
        cells = [cell[::-1] if c in over else cell for c, cell in enumerate(CUBE_CELLS)]
        mesh = settled(CUBE, cells)
        kept = [after == before for after, before in zip(cells_of(mesh), cells, strict=True)]
        assert mesh.report.turned == kept.count(False) == len(over)
        assert [c for c in range(6) if kept[c]] == [c for c in range(6) if (c in over) != stays]
        assert not mesh.conditions.any()  # closed


def test_each_part_of_a_plane_mesh_is_turned_by_itself() -> None:
    points = [[0, 0], [1, 0], [0, 1], [5, 0], [6, 0], [5, 1], [6, 1]]
    mesh = settled(points, [[2, 1, 0], [3, 4, 5], [4, 5, 6]])
    assert cells_of(mesh) == [[2, 0, 1], [3, 4, 5], [4, 6, 5]]
    assert mesh.report.turned == 2


def test_a_cell_that_is_folded_over_is_told_and_stays_joined() -> None:
    points = [[0, 0], [9, 0], [9, 9], [0, 9], [5, 3]]
    mesh = settled(points, [[0, 1, 2, 3], [0, 1, 4]])  # the second one lies on the first
    assert mesh.report.warnings == [
        "mesh: 1 cell without a positive area, though turned as the neighbours are; the first is cell 1: "
        "the mesh is folded there, or a cell lies over others or is there twice"
    ]


@pytest.mark.parametrize("repair", ["refuse", "drop"])
def test_a_moebius_strip_is_refused(repair: str) -> None:
    strip = [[0, 1, 2], [1, 2, 3], [2, 3, 4], [3, 4, 0], [4, 0, 1]]
    with pytest.raises(
        InputError, match=r"cell . \(. . .\) and cell . .* cannot be turned alike .* Moebius strip"
    ) as told:
        settled(SPHERE[:5], strip, repair=repair)
    assert not isinstance(told.value, RepairableError)
    strip[3:] = [[3, 4, 5], [4, 5, 6]]
    assert cells_of(settled(SPHERE[:7], strip)) == [[0, 1, 2], [1, 3, 2], [2, 3, 4], [3, 5, 4], [4, 5, 6]]


# ---------------------------------------------------------------------- faults


FAULTS = {
    "few": ([[0, 1, 2], [3, 4]], "cell 1 (3 4) has fewer than three nodes", [[0, 1, 2]]),
    "repeated": ([[0, 1, 2, 1], [0, 1, 2]], "cell 0 (0 1 2 1) names a node twice", [[0, 1, 2]]),
    "crowded": (
        [[0, 1, 2], [1, 0, 3], [4, 1, 0]],
        "cell 2 (4 1 0) is one too many at its side 0-1, which cells 0 and 1 share",
        [[0, 1, 2], [1, 0, 3]],
    ),
    "touching": (
        [[0, 1, 2], [2, 3, 4]],
        "node 2 is where parts of the mesh touch that no sides around it join",
        [[0, 1, 2], [5, 3, 4]],
    ),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_a_fault_is_refused_by_its_numbers_or_mended(fault: str) -> None:
    cells, sentence, sound = FAULTS[fault]
    report = PolygonReport(source="a.obj", warnings=["before"])
    used = len({node for cell in cells for node in cell})
    with pytest.raises(RepairableError) as told:
        settled(SPHERE[:used], cells, report=report)
    assert str(told.value).startswith(f"a.obj: {sentence} (counted from 0); tetrabench convert --repair drop ")
    mesh = settled(SPHERE[:used], cells, report=report, repair="drop")
    assert cells_of(mesh) == sound
    assert mesh.report.warnings[:2] == [
        "before",
        f"a.obj: {sentence} (counted from 0); {'split' if fault == 'touching' else 'left out'}",
    ]
    assert report.warnings == ["before"]
    assert report.dropped == {}
    counts = Counter(mesh.report.dropped)
    assert (counts.total(), mesh.report.split) == ((0, 1) if fault == "touching" else (1, 0))
    if fault == "touching":
        assert mesh.points[5].tolist() == mesh.points[2].tolist() == SPHERE[2].tolist()


def test_nodes_alone_are_refused_or_left_out() -> None:
    with pytest.raises(RepairableError, match=r"node 0 is in no cell; likewise 4, 5 and 6 more .*leaves them out"):
        settled(SPHERE, [[1, 2, 3]])
    mesh = settled(SPHERE, [[1, 2, 3]], repair="drop")
    assert (mesh.points.tolist(), mesh.report.unreferenced) == (SPHERE[1:4].tolist(), 9)


def test_three_fans_in_a_node_become_three_nodes() -> None:
    mesh = settled(SPHERE[:7], [[0, 1, 2], [0, 3, 4], [6, 0, 5]], repair="drop")
    assert (len(mesh.points), mesh.report.split) == (9, 1)
    assert len({cell[place] for cell, place in zip(cells_of(mesh), (0, 0, 1), strict=True)}) == 3
    assert cells_of(mesh)[0] == [0, 1, 2]


def test_what_nobody_can_mend() -> None:
    triangle = [[0, 1, 2]]
    bad = SPHERE[:3].copy()
    bad[1, 2] = np.nan
    for points, cells, words in (
        (bad, triangle, "node 1 has a coordinate that is NaN"),
        (SPHERE[:3], [[0, 1, 3]], "cell 0 names node 3, but nodes run from 0 to 2"),
        (SPHERE[:3], [[0, 1, 2], [0, 1, -1]], "cell 1 names node -1"),
        (SPHERE[:3], [[0, 1, 2 + 2**32]], "names node 4294967298"),
        (SPHERE[:3, :1], triangle, r"shape \(n, 2\) or \(n, 3\)"),
        (SPHERE, [], "holds no cells"),
        (SPHERE[:3], [[0, 1]], "fewer than three nodes"),
    ):
        with pytest.raises(InputError, match=words):
            settled(points, cells)
    with pytest.raises(InputError, match="no cell is left"):
        settled(SPHERE, [[0, 1]], repair="drop")
    with pytest.raises(InputError, match="'refuse' or 'drop', not 'mend'"):
        settled(SPHERE[:3], triangle, repair="mend")
    with pytest.raises(InputError, match="2 conditions for 3 nodes"):
        settled(SPHERE[:3], triangle, [-1, -1])


def test_odd_meshes_that_are_sound() -> None:
    angles = np.linspace(0, 2 * np.pi, 100, endpoint=False)
    large = settled(np.column_stack([np.cos(angles), np.sin(angles)]), [list(range(100))[::-1]])
    assert cells_of(large) == [[99, *range(99)]]
    # Two cells that share two sides.
    mesh = settled([[0, 0], [2, 0], [1, 1], [1, 2]], [[0, 1, 2], [0, 2, 1, 3]])
    assert cells_of(mesh) == [[0, 1, 2], [0, 2, 1, 3]]
    assert mesh.conditions.tolist() == [-1, 0, 0, 0, 0, -1, -1]
    assert len(settled(CUBE, CUBE_CELLS).points) == 8


def test_conditions_stay_with_their_sides() -> None:
    points = [[0, 0], [1, 0], [1, 1], [0, 1], [2, 0.5]]
    mesh = settled(points, [[0, 1, 2, 3], [1, 2, 4]], [-3, -9, 0, -5, -9, -6, -7])
    sides = {}
    for cell, numbers in zip(cells_of(mesh), np.split(mesh.conditions, mesh.starts[1:-1]), strict=True):
        for a, b, number in zip(cell, cell[1:] + cell[:1], numbers.tolist(), strict=True):
            sides[a, b] = number
    assert sides == {(0, 1): -3, (1, 2): 0, (2, 3): CONDITION, (3, 0): -5, (2, 1): 0, (4, 2): -6, (1, 4): -7}


def can_be_turned(cells: list[list[int]]) -> bool:
    """Whether some choice of directions has no side passed twice in one: all are tried."""
    for choice in itertools.product((1, -1), repeat=len(cells)):
        turned = [cell[::way] for cell, way in zip(cells, choice, strict=True)]
        sides = [side for cell in turned for side in zip(cell, cell[1:] + cell[:1], strict=True)]
        if len(sides) == len(set(sides)):
            return True
    return False


SOUP = st.lists(st.lists(st.integers(0, 7), min_size=1, max_size=6), min_size=1, max_size=10)


@given(SOUP)
def test_cells_at_random_are_mended_into_a_mesh_or_refused(cells: list[list[int]]) -> None:
    points = SPHERE[:8]
    sound: list[list[int]] = []
    for cell in cells:  # the rule of the docstring, one side at a time
        if len(cell) >= 3 and len(set(cell)) == len(cell):
            sound.append(cell)
    at_side: dict[frozenset[int], list[int]] = {}
    for c, cell in enumerate(sound):
        for side in zip(cell, cell[1:] + cell[:1], strict=True):
            at_side.setdefault(frozenset(side), []).append(c)
    crowded = {c for cells_there in at_side.values() for c in cells_there[2:]}
    kept = [cell for c, cell in enumerate(sound) if c not in crowded]
    if not kept:
        with pytest.raises(InputError, match="no cell is left"):
            settled(points, cells, repair="drop")
        return
    if not can_be_turned(kept):
        with pytest.raises(InputError, match="Moebius"):
            settled(points, cells, repair="drop")
        return
    mesh = settled(points, cells, repair="drop")
    assert mesh.number_of_cells == len(kept)
    for cell, before in zip(cells_of(mesh), kept, strict=True):  # the same places, from the same one, either way round
        places = mesh.points[cell].tolist()
        expected = points[before].tolist()
        assert places in (expected, [expected[0], *expected[:0:-1]])
    again = settle(mesh.points, mesh.starts, mesh.nodes, mesh.conditions)  # sound: nothing is left to mend
    assert again.nodes.tolist() == mesh.nodes.tolist()
    assert (again.report.turned, again.report.warnings) == (0, [])
