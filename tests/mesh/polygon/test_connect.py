"""How cells hang together against a naive dictionary twin, on every small mesh; and all that no format can hold is refused."""

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given

from tests.polygon.meshes import ALL, ODD, divisions, polygons, quads, shifted
from tetrabench.errors import InputError
from tetrabench.mesh.polygon import PolygonMesh
from tetrabench.mesh.polygon.connect import (
    NOBODY,
    Connections,
    after,
    before,
    beyond,
    connect,
    count_around,
    number_edges,
    turn,
)
from tetrabench.mesh.polygon.models import generate_polygons

APART = (
    "^no format can hold this mesh: at a side or around a node its cells do not follow one another; .*settle says where"
)
ASKEW = "^the starts and nodes of the cells do not belong together: see PolygonMesh$"


class Naive:
    """The corners of a mesh by looking everywhere.

    Attributes:
        cell, following, previous: of each corner.
        sides: the two nodes of each corner's side.
        twin: the corner that has the same two nodes the other way round, or NOBODY.
        at: the corners at each node.
    """

    def __init__(self, mesh: PolygonMesh) -> None:
        nodes = mesh.nodes.tolist()
        cells = [list(range(begin, end)) for begin, end in pairwise(mesh.starts.tolist())]
        self.cell = {x: c for c, corners in enumerate(cells) for x in corners}
        self.following = {x: y for corners in cells for x, y in zip(corners, corners[1:] + corners[:1], strict=True)}
        self.previous = {y: x for x, y in self.following.items()}
        self.sides = [(nodes[x], nodes[self.following[x]]) for x in range(len(nodes))]
        self.twin = [self.sides.index(side[::-1]) if side[::-1] in self.sides else NOBODY for side in self.sides]
        self.at = [[x for x, node in enumerate(nodes) if node == v] for v in range(len(mesh.points))]

    def first(self, v: int) -> int:
        """The corner whose side leaves the node along the boundary, with the domain on its left; else the lowest."""
        along = [x for x in self.at[v] if self.twin[x] == NOBODY]
        assert len(along) <= 1
        return (along or self.at[v])[0]

    def edges_at(self, v: int) -> int:
        """How many edges meet in a node."""
        return len({frozenset(side) for side in self.sides if v in side})


def check(mesh: PolygonMesh) -> None:
    """Everything that a format may ask for."""
    before_it = [array.tobytes() for array in (mesh.points, mesh.starts, mesh.nodes, mesh.conditions)]
    links, naive = connect(mesh), Naive(mesh)
    corners, nodes = range(len(mesh.nodes)), range(len(mesh.points))
    assert [array.tobytes() for array in (mesh.points, mesh.starts, mesh.nodes, mesh.conditions)] == before_it
    assert {array.dtype for array in links} == {np.dtype(np.int32)}
    assert links.twin.tolist() == naive.twin
    assert links.cell.tolist() == [naive.cell[x] for x in corners]
    assert links.first.tolist() == [naive.first(v) for v in nodes]
    assert [after(links, x) for x in corners] == [naive.following[x] for x in corners]
    assert [before(links, x) for x in corners] == [naive.previous[x] for x in corners]
    assert [turn(links, x) for x in corners] == [naive.twin[naive.previous[x]] for x in corners]
    for x in corners:
        other = naive.twin[x]
        assert beyond(links, x) == (mesh.conditions[x] if other == NOBODY else naive.cell[other])
    check_fans(links, naive)
    check_edges(links, naive)
    around = np.zeros(len(nodes), np.int32)
    count_around(links, around)
    assert around.tolist() == [naive.edges_at(v) for v in nodes]


def check_fans(links: Connections, naive: Naive) -> None:
    """From the first corner of a node one turn after the other leads to all, and back, or over the boundary."""
    for v, held in enumerate(naive.at):
        first = int(links.first[v])
        fan = [first]
        while len(fan) <= len(held) and (x := int(turn(links, fan[-1]))) not in (NOBODY, first):
            # Counter-clockwise: the side that the next corner begins with ends the one before.
            assert naive.sides[x][::-1] == naive.sides[naive.previous[fan[-1]]]
            fan.append(x)
        assert sorted(fan) == held
        boundary = links.twin[first] == NOBODY
        assert (turn(links, fan[-1]) == NOBODY) == boundary


def check_edges(links: Connections, naive: Naive) -> None:
    """Edges are numbered without gaps in the order of their first corners, alike from both sides."""
    edge = np.full(len(naive.sides), -7, np.int32)
    count = number_edges(links, edge)
    numbers: dict[frozenset[int], int] = {}
    for x, side in enumerate(naive.sides):
        assert edge[x] == numbers.setdefault(frozenset(side), len(numbers))
    assert count == len(numbers)


@pytest.mark.parametrize("name", sorted(ALL))
def test_connections_are_those_of_the_naive_twin(name: str) -> None:
    factory: Callable[[], PolygonMesh] = ALL[name]
    check(factory())


@given(divisions())
def test_connections_of_anything(mesh: PolygonMesh) -> None:
    check(mesh)


def test_arrays_of_other_kinds_are_taken() -> None:
    mesh = generate_polygons("hexagon", 20)
    wanted = connect(mesh)
    for change in (lambda array: array.astype(np.int64), lambda array: np.repeat(array, 2)[::2]):
        changed = replace(mesh, **{name: change(getattr(mesh, name)) for name in ("starts", "nodes", "conditions")})
        found = connect(changed)
        assert all(np.array_equal(one, other) for one, other in zip(found, wanted, strict=True))
        assert {array.dtype for array in found} == {np.dtype(np.int32)}
    mesh.nodes.flags.writeable = False
    assert np.array_equal(connect(mesh).twin, wanted.twin)


BAD_CELLS = {
    "a side used twice in the same direction": [[0, 1, 2], [0, 1, 3]],
    "a cell twice": [[0, 1, 2], [0, 1, 2]],
    "a cell turned over beside another": [[0, 1, 4, 3], [1, 4, 5, 2]],
    "three cells at an edge": [[0, 1, 2], [1, 0, 3], [1, 0, 4]],
    "four cells at an edge": [[0, 1, 2], [1, 0, 3], [1, 0, 4], [0, 1, 5]],
    "two fans at a node": [[0, 1, 2], [0, 3, 4]],
    "two closed fans at a node": [
        [0, 1, 2],
        [0, 2, 3],
        [0, 3, 1],
        [1, 3, 2],
        [0, 4, 5],
        [0, 5, 6],
        [0, 6, 4],
        [4, 6, 5],
    ],
    "a closed fan and an open one at a node": [[0, 1, 2], [0, 2, 3], [0, 3, 1], [0, 4, 5]],
    "two corners of a domain in one node": quads(3, 3, [0, 4, 8]),
    "a cell with a node twice": [[0, 1, 2, 0, 3, 4]],
    "a cell with a node twice running": [[0, 1, 1, 2]],
    "a cell of one node": [[0, 0, 0]],
    "a cell there and back": [[0, 1, 2, 1]],
    "a cell that is its own neighbour": [[0, 1, 2, 3, 1, 0, 4, 5]],
    "a ring of one cell, cut": [[0, 1, 2, 3, 0, 3, 5, 4]],
    "a Moebius strip": [[0, 1, 3, 2], [2, 3, 5, 4], [4, 5, 0, 1]],
    "an isolated node": [[0, 1, 3]],
}


@pytest.mark.parametrize("name", BAD_CELLS)
def test_cells_that_do_not_follow_one_another(name: str) -> None:
    cells, sound = BAD_CELLS[name], quads(2, 2)
    count = 1 + max(map(max, cells))
    for bad in (cells, [*cells, *shifted(sound, count)], [*sound, *shifted(cells, 9)]):
        with pytest.raises(InputError, match=APART):
            connect(polygons(bad))


def test_isolated_nodes_anywhere() -> None:
    mesh = generate_polygons("quad", 4)
    for place in (0, 4, 9):
        moved = replace(
            mesh, points=np.insert(mesh.points, place, 0.5, axis=0), nodes=mesh.nodes + (mesh.nodes >= place)
        )
        with pytest.raises(InputError, match=APART):
            connect(moved)


@pytest.mark.parametrize("name", sorted(ODD))
def test_conditions_where_they_are_not(name: str) -> None:
    """On any one side: none at the boundary, one within, or a positive one anywhere."""
    factory: Callable[[], PolygonMesh] = ODD[name]
    mesh = factory()
    for x in range(0, len(mesh.nodes), 1 + len(mesh.nodes) // 20):
        for condition in (0 if mesh.conditions[x] < 0 else -1, 1):
            conditions = mesh.conditions.copy()
            conditions[x] = condition
            with pytest.raises(InputError, match=APART):
                connect(replace(mesh, conditions=conditions))


@pytest.mark.parametrize(
    "changed",
    [
        {"starts": [0, 4, 6]},
        {"starts": [0, 5, 7]},  # a cell of two nodes
        {"starts": [1, 4, 7]},
        {"starts": [0, 4, 8]},
        {"starts": [0, 4]},
        {"starts": [0, 7, 4, 7]},
        {"starts": [0, 2**31 - 1, -2, 7]},  # differences that wrap in 32 bits are all positive
        {"starts": [0]},
        {"starts": []},
        {"nodes": [0, 1, 2, 3, 2, 1, 5]},
        {"nodes": [0, 1, 2, 3, 2, 1, -1]},
        {"nodes": [0, 1, 2, 3, 2, 1]},
        {"conditions": [-1, 0, -1, -1, 0, -1]},
        {"starts": [0], "nodes": [], "conditions": []},
        {"starts": [0, 0], "nodes": [], "conditions": []},
    ],
)
def test_arrays_that_do_not_belong_together(changed: dict[str, list[int]]) -> None:
    sound = {"starts": [0, 4, 7], "nodes": [0, 1, 2, 3, 2, 1, 4], "conditions": [-1, 0, -1, -1, 0, -1, -1]}

    def made(lists: dict[str, list[int]]) -> PolygonMesh:
        return PolygonMesh(np.zeros((5, 2)), **{name: np.array(items, np.int32) for name, items in lists.items()})

    check(made(sound))
    with pytest.raises(InputError, match=ASKEW):
        connect(made({**sound, **changed}))
