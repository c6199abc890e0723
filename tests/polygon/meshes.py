"""Small meshes of polygons: odd ones, by what is odd about them; the models; random ones, by merging and dropping cells."""

from collections.abc import Iterable, Mapping, Sequence
from functools import partial
from itertools import pairwise
from random import Random
from typing import Any

import numpy as np
from hypothesis import strategies as st

from tests.polygon.twin import sides_of
from tetrabench.errors import InputError
from tetrabench.mesh.polygon import PolygonMesh
from tetrabench.mesh.polygon.connect import connect
from tetrabench.mesh.polygon.models import MODELS, generate_polygons
from tetrabench.mesh.polygon.numbering import NUMBERINGS
from tetrabench.mesh.polygon.polygon_mesh import CONDITION

Cells = Sequence[Sequence[int]]
Side = tuple[int, int]


def polygons(cells: Cells, conditions: Mapping[Side, int] | None = None) -> PolygonMesh:
    """A mesh of these cells, from their nodes; boundary sides have the condition given, or CONDITION.

    The points are any, for no format asks where they are.
    """
    cells = [list(cell) for cell in cells]
    sides = [side for cell in cells for side in sides_of(cell)]
    held, given = set(sides), conditions or {}
    count = 1 + max(map(max, cells))
    return PolygonMesh(
        points=np.column_stack([np.arange(count), np.arange(count) % 7]).astype(np.float64),
        starts=np.cumsum([0, *map(len, cells)]).astype(np.int32),
        nodes=np.array([v for cell in cells for v in cell], np.int32),
        conditions=np.array([0 if side[::-1] in held else given.get(side, CONDITION) for side in sides], np.int32),
    )


def used(cells: Cells) -> list[list[int]]:
    """The same cells, their nodes numbered without gaps."""
    new = {v: n for n, v in enumerate(sorted({v for cell in cells for v in cell}))}
    return [[new[v] for v in cell] for cell in cells]


def boundary(cells: Cells) -> list[Side]:
    """The sides that no second cell has."""
    held = {side for cell in cells for side in sides_of(list(cell))}
    return [side for cell in cells for side in sides_of(list(cell)) if side[::-1] not in held]


def quads(columns: int, rows: int, dropped: Iterable[int] = ()) -> list[list[int]]:
    """The cells of a rectangle, row by row, without those dropped."""
    corner = [row * (columns + 1) + column for row in range(rows) for column in range(columns)]
    gone = set(dropped)
    return used([[v, v + 1, v + columns + 2, v + columns + 1] for c, v in enumerate(corner) if c not in gone])


def ring(count: int) -> list[list[int]]:
    """Quads between two circles of `count` nodes: the outer one, then the inner one."""
    return [[j, (j + 1) % count, count + (j + 1) % count, count + j] for j in range(count)]


def fan(count: int, closed: bool) -> list[list[int]]:
    """Triangles around node 0, all the way or half of it."""
    rim = [*range(1, count + 1), 1] if closed else range(1, count + 2)
    return [[0, a, b] for a, b in pairwise(rim)]


def torus(columns: int, rows: int) -> list[list[int]]:
    """Quads all around in both directions."""

    def node(column: int, row: int) -> int:
        return row % rows * columns + column % columns

    return [
        [node(x, y), node(x + 1, y), node(x + 1, y + 1), node(x, y + 1)] for y in range(rows) for x in range(columns)
    ]


CUBE = [[3, 2, 1, 0], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]
TETRAHEDRON = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]


def shifted(cells: Cells, by: int) -> list[list[int]]:
    """The same cells with other nodes."""
    return [[v + by for v in cell] for cell in cells]


def told_apart(cells: Cells) -> PolygonMesh:
    """Every boundary side has a condition of its own: -1, -2, ..."""
    return polygons(cells, {side: -1 - n for n, side in enumerate(boundary(cells))})


def two_kinds(cells: Cells) -> PolygonMesh:
    """Conditions -1 and -7 in turn, three sides each; the second one is as far below as 32 bits go where a node is 0."""
    numbers = {side: (-1, -7)[n // 3 % 2] for n, side in enumerate(boundary(cells))}
    return polygons(
        cells, {side: -(2**31) if 0 in side and number == -7 else number for side, number in numbers.items()}
    )


ODD = {
    "one triangle": partial(polygons, [[0, 1, 2]]),
    "one cell, its sides told apart": partial(told_apart, [[3, 0, 2, 1, 4]]),
    "a cell of 100 nodes": partial(two_kinds, [[*range(100)]]),
    "a cell of 100 nodes in a ring": partial(two_kinds, [*ring(100), [*range(100, 200)]]),
    "two cells": partial(told_apart, [[0, 1, 2, 3], [2, 1, 4]]),
    "two cells that share two edges": partial(told_apart, [[0, 1, 2, 3], [0, 3, 2, 4]]),
    "two cells that share three edges": partial(two_kinds, [[0, 1, 2, 3, 4], [5, 0, 4, 3, 2]]),
    "two cells in a ring, which share two edges apart": partial(told_apart, [[4, 5, 6, 2, 1, 0], [6, 7, 4, 0, 3, 2]]),
    "a triangle in a cell": partial(told_apart, [[0, 1, 2, 5, 4, 3], [2, 0, 3, 5], [3, 4, 5]]),
    "a ring": partial(two_kinds, ring(8)),
    "a hole of one cell": partial(two_kinds, quads(3, 3, [4])),
    "two holes": partial(two_kinds, quads(5, 3, [6, 8])),
    "a hole of three cells": partial(told_apart, quads(4, 4, [5, 6, 9])),
    "a strip": partial(two_kinds, quads(9, 1)),
    "every boundary side told apart": partial(told_apart, quads(3, 3)),
    "three components": partial(two_kinds, [*quads(2, 2), *shifted([[0, 1, 2]], 9), *shifted(CUBE, 12)]),
    "degree 30 within": partial(two_kinds, fan(30, closed=True)),
    "degree 30 at the boundary": partial(two_kinds, fan(29, closed=False)),
    "cube": partial(polygons, CUBE),
    "tetrahedron": partial(polygons, TETRAHEDRON),
    "open box": partial(told_apart, CUBE[:5]),
    "pillow": partial(polygons, [[0, 1, 2], [2, 1, 0]]),
    "pillow of squares": partial(polygons, [[1, 2, 3, 0], [0, 3, 2, 1]]),
    "torus": partial(polygons, torus(4, 5)),
    "least torus": partial(polygons, torus(3, 3)),
}
"""name -> factory"""

SMALL_MODELS = {
    f"{model}, {cells} cells, {numbering}": partial(generate_polygons, model, cells, numbering=numbering, seed=7)
    for model in MODELS
    for cells, numberings in ((1, ["natural"]), (5, ["natural"]), (24, NUMBERINGS))
    for numbering in numberings
}
"""name -> factory"""

ALL = {**ODD, **SMALL_MODELS}


def merged(one: Sequence[int], other: Sequence[int]) -> list[int] | None:
    """Two cells as one, without the sides that they share; None where what is left is no single circle."""
    sides = {*sides_of(list(one)), *sides_of(list(other))}
    following = {a: b for a, b in sides if (b, a) not in sides}
    kept = sum((b, a) not in sides for a, b in sides)
    if kept != len(following) or kept < 3:  # a node comes twice
        return None
    cell = [next(iter(following))]
    while following[cell[-1]] != cell[0]:
        cell.append(following[cell[-1]])
    return cell if len(cell) == kept else None


def merge_some(cells: list[list[int]], random: Random, times: int) -> None:
    """Merge neighbouring cells."""
    for _ in range(times):
        owner = {side: c for c, cell in enumerate(cells) for side in sides_of(cell)}
        inner = sorted(side for side in owner if side[::-1] in owner)
        if not inner:
            return
        a, b = random.choice(inner)
        one, other = owner[a, b], owner[b, a]
        if cell := merged(cells[one], cells[other]):
            cells[one] = cell
            del cells[other]


def drop_some(cells: list[list[int]], random: Random, times: int) -> None:
    """Leave cells out, where what is left can be stored."""
    for _ in range(times):
        rest = list(cells)
        rest.pop(random.randrange(len(cells)))
        try:
            connect(polygons(used(rest)))
        except (InputError, ValueError):  # or nothing is left
            continue
        cells[:] = rest


@st.composite
def divisions(draw: Any) -> PolygonMesh:
    """A model whose cells are merged and dropped at random, each beginning with any of its nodes, and any conditions."""
    model, cells = draw(st.sampled_from(["quad", "hexagon", "voronoi"])), draw(st.integers(1, 30))
    mesh = generate_polygons(model, cells, numbering="shuffled", seed=draw(st.integers(0, 1000)))
    random = draw(st.randoms(use_true_random=False))
    division = [cell.tolist() for cell in np.split(mesh.nodes, mesh.starts[1:-1])]
    merge_some(division, random, draw(st.integers(0, 12)))
    drop_some(division, random, draw(st.integers(0, 8)))
    turned = [cell[j:] + cell[:j] for cell in used(division) for j in [random.randrange(len(cell))]]
    kinds = draw(st.integers(1, 4))
    return polygons(turned, {side: -random.randint(1, kinds) for side in boundary(turned)})
