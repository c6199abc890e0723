"""Does the cost of a local query depend on the size of the mesh? `one_to_all`, vertex -> tetras, from 10k to 1M tetras.

As many queries on each mesh, of vertices at random, all meshes in turn in each round: one call from Python each
("one_to_all"), and all by one call of the kernel behind it ("walks"). (`one_to_all_many` would not do: it sorts a whole mesh
where it is asked of a good part of it.) Beside them, for what memory does to anybody: a table in plain C++ ("table").
"""

import time
from collections.abc import Callable
from pathlib import Path
from statistics import median
from typing import Any, NamedTuple

import numpy as np

from tests.cgal.contests import NUMBERINGS, Case
from tests.cgal.library import at
from tests.contest import Progress
from tetrabench.backends.tetra.halfface import Element, queries
from tetrabench.bench.pairs import paired_ratio

SIZES = (10_000, 30_000, 100_000, 300_000, 1_000_000)
QUERIES = 20_000
CALLS = 2_000
"""As many of them from Python."""


class Way(NamedTuple):
    """Something that asks for the tetras around so many vertices."""

    queries: int
    ask: Callable[[], Any]


def measure(functions: Any, sizes: list[int], rounds: int, progress: Progress) -> list[dict[str, Any]]:
    """A point for each numbering, size and way, with the ratio of its cost to that of the smallest mesh."""
    ways: dict[tuple[str, str, int], Way] = {}
    tetras = {}
    for numbering in NUMBERINGS:
        for size in sizes:
            progress.say(f"one_to_all: making a box of {size:,} tetras, {numbering}")
            case = Case(functions, size, numbering)
            tetras[numbering, size] = len(case.tets)
            ways |= {(name, numbering, size): way for name, way in ways_of(functions, case).items()}
    spent: dict[tuple[str, str, int], list[float]] = {key: [] for key in ways}
    for n in range(rounds):
        progress.say(f"one_to_all: round {n + 1} of {rounds}")
        for key, way in list(ways.items())[:: -1 if n % 2 else 1]:
            begin = time.thread_time()
            way.ask()
            spent[key].append((time.thread_time() - begin) / way.queries)
    points = []
    for (name, numbering, size), seconds in spent.items():
        ratio, low, high = paired_ratio(seconds, spent[name, numbering, sizes[0]])
        figures = {"query_s": median(seconds), "ratio": ratio, "low": low, "high": high, "rounds": rounds}
        points.append({"way": name, "numbering": numbering, "tetras": tetras[numbering, size]} | figures)
    return points


def ways_of(functions: Any, case: Case) -> dict[str, Way]:
    """All ways, warm and with the same answers."""
    vertices = np.random.default_rng(20130522).integers(0, case.vertices, QUERIES)
    few = vertices[:CALLS].tolist()
    smallest, (table, rows) = case.ascending[:, 0], case.table
    starts, found, own = np.zeros(QUERIES + 1, np.int64), np.empty(64 * QUERIES, np.int64), np.empty(4, np.int64)
    target, source = queries.TETRAHEDRON, queries.VERTEX

    def call() -> list[Any]:
        return [case.mesh.one_to_all(Element.TETRAHEDRON, Element.VERTEX, v) for v in few]

    def walk() -> int:
        return int(queries.list_many(case.mesh.storage, target, source, vertices, 0, starts, found, own))

    def look_up() -> int:
        return int(functions.plain_ask(at(table), at(rows), at(case.ascending), at(vertices), QUERIES))

    assert walk() == QUERIES, "there is no room for what the walks find"
    answer = int(smallest[found[: starts[-1]]].sum())
    assert look_up() == answer, "the walks and the table disagree"
    for n, one in enumerate(call()):
        assert list(one) == found[starts[n] : starts[n + 1]].tolist(), "one_to_all and the walks disagree"
    return {"one_to_all": Way(CALLS, call), "walks": Way(QUERIES, walk), "table": Way(QUERIES, look_up)}


HEADING = "way         numbering     tetras  ns a query   beside the smallest mesh"


def line(point: dict[str, Any]) -> str:
    """The line of a point."""
    return (
        f"{point['way']:<12}{point['numbering']:<10}{point['tetras']:10,}{1e9 * point['query_s']:12.0f}"
        f"{point['ratio']:8.3f}  [{point['low']:.3f}, {point['high']:.3f}]"
    )


def draw(points: list[dict[str, Any]], path: Path) -> None:
    """The picture, in the format that the name of the file asks for."""
    from matplotlib import rc_context
    from matplotlib.figure import Figure

    looks = {"natural": ("#0072B2", "o"), "shuffled": ("#D55E00", "s")}
    names = {
        "one_to_all": ("one_to_all from Python", "-"),
        "walks": ("its kernel", "--"),
        "table": ("table in C++", ":"),
    }
    with rc_context({"font.size": 9}):
        figure = Figure(figsize=(6.4, 4.4), layout="constrained")
        axes = figure.subplots()
        for way, (name, style) in names.items():
            for numbering, (colour, marker) in looks.items():
                those = [point for point in points if (point["way"], point["numbering"]) == (way, numbering)]
                axes.plot(
                    [point["tetras"] for point in those],
                    [1e9 * point["query_s"] for point in those],
                    style,
                    color=colour,
                    marker=marker,
                    markersize=5,
                    label=f"{name}, {numbering}",
                )
        axes.set_xscale("log")
        axes.set_yscale("log")
        axes.set_xlabel("tetras in the mesh")
        axes.set_ylabel("CPU time of a query, ns")
        axes.set_title("Tetras around a vertex: cost of a query over the size of the mesh", fontsize=10)
        axes.grid(alpha=0.3)
        figure.legend(loc="outside lower center", ncols=3, frameon=False)
        figure.savefig(path, dpi=150)
