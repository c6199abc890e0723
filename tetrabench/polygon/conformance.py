"""What every format of polygon meshes must answer, as rules that say what is wrong in words; anybody's has to pass them.

Each rule takes a contestant and yields sentences, which name the function of the interface and the situation; none where all
is well. What a format answers is compared with `twin.Twin` on small meshes, each there for something special.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np

from tetrabench.jit import kernel
from tetrabench.jit.generic import lacks
from tetrabench.mesh.polygon import PolygonMesh
from tetrabench.mesh.polygon.connect import connect
from tetrabench.mesh.polygon.models import generate_polygons
from tetrabench.polygon import interface
from tetrabench.polygon.contestant import PolygonContestant
from tetrabench.polygon.interface import List, Storage
from tetrabench.polygon.net import list_room
from tetrabench.polygon.twin import Twin, circle, sides_of
from tetrabench.protocols import Rule

UNTOUCHED = -999
"""What lies in `out` before it is written to: no cell, no node, and no boundary condition of the meshes here."""


def polygons(cells: Sequence[Sequence[int]], *, told_apart: bool = True) -> PolygonMesh:
    """A mesh of these cells, from their nodes; boundary sides have conditions -1, -2, ..., or all -1.

    The points are any, for no format asks where they are.
    """
    sides = [side for cell in cells for side in sides_of(list(cell))]
    held = set(sides)
    conditions: list[int] = []
    for side in sides:
        last = min(conditions, default=0)
        conditions.append(0 if side[::-1] in held else last - 1 if told_apart else -1)
    count = 1 + max(map(max, cells))
    return PolygonMesh(
        points=np.column_stack([np.arange(count), np.arange(count) % 7]).astype(np.float64),
        starts=np.cumsum([0, *map(len, cells)]).astype(np.int32),
        nodes=np.array([v for cell in cells for v in cell], np.int32),
        conditions=np.array(conditions, np.int32),
    )


_CUBE = [[3, 2, 1, 0], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]
_HOLE = [
    [4 * y + x, 4 * y + x + 1, 4 * y + x + 5, 4 * y + x + 4] for y in range(3) for x in range(3) if (x, y) != (1, 1)
]
_FAN = [[0, n, n % 30 + 1] for n in range(1, 31)]
_HALF_FAN = [[0, n, n + 1] for n in range(1, 30)]

MESHES: Mapping[str, Callable[[], PolygonMesh]] = {
    "a triangle": partial(polygons, [[2, 0, 1]]),
    "a cell of 40 nodes": partial(polygons, [[*range(40)]]),
    "two cells that share two sides": partial(polygons, [[0, 1, 2, 3], [0, 3, 2, 4]]),
    "squares around a hole": partial(polygons, _HOLE),
    "squares around a hole, with one condition": partial(polygons, _HOLE, told_apart=False),
    "30 triangles around a node": partial(polygons, _FAN),
    "29 triangles around a node at the boundary": partial(polygons, _HALF_FAN),
    "a cube": partial(polygons, _CUBE),
    "an open cube": partial(polygons, _CUBE[:5]),
    "two triangles back to back": partial(polygons, [[0, 1, 2], [2, 1, 0]]),
    "a triangle beside a cube": partial(polygons, [[0, 1, 2], *([v + 3 for v in cell] for cell in _CUBE)]),
    "hexagons": partial(generate_polygons, "hexagon", 24, numbering="shuffled", seed=7),
    "Voronoi cells": partial(generate_polygons, "voronoi", 24, numbering="shuffled", seed=7),
}


@kernel
def _count(storage: Storage, counts: Any) -> None:
    counts[0] = interface.number_of_cells(storage)
    counts[1] = interface.number_of_nodes(storage)


@kernel
def _list(storage: Storage, query: int, elements: List, out: List, counts: Any) -> None:
    """The lists of some elements, in rows of `out` (n, room) int32; query number in `_QUERIES`."""
    for n in range(len(elements)):
        if query == 0:
            counts[n] = interface.cell_nodes(storage, elements[n], out[n])
        elif query == 1:
            counts[n] = interface.cell_neighbours(storage, elements[n], out[n])
        elif query == 2:
            counts[n] = interface.node_cells(storage, elements[n], out[n])
        else:
            counts[n] = interface.node_neighbours(storage, elements[n], out[n])


@kernel
def _list_stars(storage: Storage, elements: List, nodes: List, cells: List, counts: Any) -> None:
    for n in range(len(elements)):
        counts[n] = interface.node_star(storage, elements[n], nodes[n], cells[n])


_QUERIES = ("cell_nodes", "cell_neighbours", "node_cells", "node_neighbours")


def _lists(storage: Storage, query: str, count: int, room: int) -> tuple[list[list[int]], str]:
    """All lists of a query, and what was wrong with how they were written, "" where nothing was."""
    elements, counts = np.arange(count, dtype=np.int32), np.zeros(count, np.int64)
    out = np.full((count, room), UNTOUCHED, np.int32)
    _list(storage, _QUERIES.index(query), elements, out, counts)
    lists = [row[: max(number, 0)].tolist() for row, number in zip(out, counts.tolist(), strict=True)]
    for element, (items, number) in enumerate(zip(lists, counts.tolist(), strict=True)):
        if not 0 < number <= room:
            return lists, f"{query}({element}) returns {number}; there is room for {room}"
        if UNTOUCHED in items:
            return lists, f"{query}({element}) returns {number}, and stores {items.index(UNTOUCHED)}"
    return lists, ""


# ---------------------------------------------------------------------------------------------------- rules


def _complete(contestant: PolygonContestant) -> Iterator[str]:
    storage = contestant.build(connect(MESHES["a triangle"]()))
    if missing := lacks(interface, storage):
        yield f"{type(storage).__name__} does not implement {', '.join(missing)}"


def _counts(contestant: PolygonContestant) -> Iterator[str]:
    for name, make in MESHES.items():
        mesh, counts = make(), np.zeros(2, np.int64)
        _count(contestant.build(connect(mesh)), counts)
        wanted = mesh.number_of_cells, len(mesh.points)
        for word, found, right in zip(("cells", "nodes"), counts.tolist(), wanted, strict=True):
            if found != right:
                yield f"number_of_{word} of {name} is {found}, and there are {right} {word}"


def _query(query: str) -> Callable[[PolygonContestant], Iterator[str]]:
    """The rule of one of the four queries: the twin's lists, from wherever they begin."""

    def faults(contestant: PolygonContestant) -> Iterator[str]:
        for name, make in MESHES.items():
            mesh = make()
            twin, storage = Twin(mesh), contestant.build(connect(mesh))
            wanted = twin.lists(query)
            found, fault = _lists(storage, query, len(wanted), list_room(mesh))
            begins = _lists(storage, "cell_nodes", len(twin.cells), list_room(mesh))[0]
            if fault:
                yield f"{name}: {fault}"
                continue
            for element, (items, right) in enumerate(zip(found, wanted, strict=True)):
                if query == "cell_neighbours" and circle(begins[element]) == circle(twin.cells[element]):
                    turn = twin.cells[element].index(begins[element][0])
                    right = right[turn:] + right[:turn]
                if not _is_answer(query, items, right, twin.conditions(element) if query == "node_cells" else []):
                    yield f"{name}: {query}({element}) is {items}, and should be {right}"
                    break

    return faults


def _is_answer(query: str, items: list[int], right: list[int], conditions: list[int]) -> bool:
    """Whether a list is the right one; conditions: of a boundary node's left and right edge."""
    if query == "cell_neighbours":
        return items == right
    if query == "node_cells" and conditions:  # it goes from the right edge to the left one, and cannot be turned
        return items in (right, [*right, conditions[1]])
    if query == "node_neighbours" and items != right:
        return len(items) == len(right) and circle(items) == circle(right)
    return circle(items) == circle(right)


def _stars(contestant: PolygonContestant) -> Iterator[str]:
    for name, make in MESHES.items():
        mesh = make()
        twin, storage, room = Twin(mesh), contestant.build(connect(mesh)), list_room(mesh)
        nodes, cells = np.full((2, twin.number_of_nodes, room), UNTOUCHED, np.int32)
        counts = np.zeros(twin.number_of_nodes, np.int64)
        _list_stars(storage, np.arange(twin.number_of_nodes, dtype=np.int32), nodes, cells, counts)
        for v, count in enumerate(counts.tolist()):
            around, between = twin.star(v)
            if count != len(around):
                yield f"{name}: node_star({v}) returns {count}, and node {v} has {len(around)} neighbours"
                break
            seen = list(zip(nodes[v, :count].tolist(), cells[v, :count].tolist(), strict=True))
            right = list(zip(around, between, strict=True))
            if seen != right and (between[-1] < 0 or circle(seen) != circle(right)):
                yield f"{name}: node_star({v}) is {seen} (neighbour, cell), and should be {right}"
                break


def _beginnings(contestant: PolygonContestant) -> Iterator[str]:
    """Sums in floating point depend on the order: gasdynamics compares them bit by bit."""
    for name, make in MESHES.items():
        mesh = make()
        twin, storage = Twin(mesh), contestant.build(connect(mesh))
        for query in _QUERIES:
            wanted = twin.lists(query)
            for element, items in enumerate(_lists(storage, query, len(wanted), list_room(mesh))[0]):
                if items[:1] != wanted[element][:1]:
                    yield f"{name}: {query}({element}) begins with {items[:1]}, that of all formats with {wanted[element][0]}"
                    return


RULES = (
    Rule("complete", "every function of the interface is there", _complete, essential=True),
    Rule("counts", "how many cells and nodes there are", _counts),
    Rule("cell-nodes", "the nodes of every cell, counter-clockwise", _query("cell_nodes")),
    Rule("cell-neighbours", "what lies beyond every side of every cell", _query("cell_neighbours")),
    Rule("node-cells", "the cells around every node, conditions behind them", _query("node_cells")),
    Rule("node-neighbours", "the neighbours of every node", _query("node_neighbours")),
    Rule("node-star", "neighbours and cells of every node at once, in step", _stars),
    Rule("beginnings", "lists begin where those of all formats do", _beginnings),
)
"""In this order: what comes first is relied upon later."""
