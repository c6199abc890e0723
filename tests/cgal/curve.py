"""Does the cost of a local query depend on the size of the mesh? `one_to_all`, vertex -> tetras, from 10k to 1M tetras.

As many queries on each mesh, of vertices at random, all meshes in turn in each round. Beside it, for what memory does to
anybody: the same queries of a table in plain C++.
"""

import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np

from tests.cgal.contests import NUMBERINGS, Case
from tests.cgal.library import at
from tests.contest import Progress
from tetrabench.backends.tetra.halfface import Element
from tetrabench.bench.pairs import paired_ratio

SIZES = (10_000, 30_000, 100_000, 300_000, 1_000_000)
QUERIES = 20_000


def measure(functions: Any, sizes: list[int], rounds: int, progress: Progress) -> list[dict[str, Any]]:
    """A point for each numbering, size and way, with the ratio of its cost to that of the smallest mesh."""
    ways: dict[tuple[str, str, int], Callable[[], Any]] = {}
    tetras = {}
    for numbering in NUMBERINGS:
        for size in sizes:
            progress.say(f"one_to_all: making a box of {size:,} tetras, {numbering}")
            case = Case(functions, size, numbering)
            tetras[numbering, size] = len(case.tets)
            queries = np.random.default_rng(20130522).integers(0, case.vertices, QUERIES)
            ways |= {(way, numbering, size): call for way, call in _ways(functions, case, queries).items()}
    spent: dict[tuple[str, str, int], list[float]] = {key: [] for key in ways}
    for call in ways.values():
        call()
    for n in range(rounds):
        progress.say(f"one_to_all: round {n + 1} of {rounds}")
        for key, call in list(ways.items())[:: -1 if n % 2 else 1]:
            begin = time.thread_time()
            call()
            spent[key].append(time.thread_time() - begin)
    points = []
    for (way, numbering, size), seconds in spent.items():
        ratio, low, high = paired_ratio(seconds, spent[way, numbering, sizes[0]])
        points.append(
            {
                "way": way,
                "numbering": numbering,
                "tetras": tetras[numbering, size],
                "query_s": median(seconds) / QUERIES,
                "ratio": ratio,
                "low": low,
                "high": high,
                "rounds": rounds,
            }
        )
    return points


def _ways(functions: Any, case: Case, queries: Any) -> dict[str, Callable[[], Any]]:
    """Ours and the table, each warm and with the same answer."""
    starts, rows = case.table
    ours = partial(case.mesh.one_to_all_many, Element.TETRAHEDRON, Element.VERTEX, queries)
    addresses = at(starts), at(rows), at(case.ascending), at(queries)
    total = int(case.ascending[ours()[1], 0].sum())
    table = partial(functions.plain_ask, *addresses, len(queries))
    assert table() == total, "one_to_all and the table disagree"
    return {"one_to_all": ours, "table": lambda: (table(), case)}  # the case holds the arrays


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
    names = {"one_to_all": "one_to_all, half-face", "table": "table in C++"}
    with rc_context({"font.size": 9}):
        figure = Figure(figsize=(6.4, 3.8), layout="constrained")
        axes = figure.subplots()
        for way, name in names.items():
            for numbering, (colour, marker) in looks.items():
                those = [point for point in points if (point["way"], point["numbering"]) == (way, numbering)]
                style = "-" if way == "one_to_all" else ":"
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
        axes.set_ylim(bottom=0)
        axes.set_xlabel("tetras in the mesh")
        axes.set_ylabel("CPU time of a query, ns")
        axes.set_title("Tetras around a vertex: cost of a query over the size of the mesh", fontsize=10)
        axes.grid(alpha=0.3)
        axes.legend(frameon=False)
        figure.savefig(path, dpi=150)
