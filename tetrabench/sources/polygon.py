"""The source of the polygon family: the paper of A. A. Voropinov (Sarov, about 2008), its tables and what it found in them.

Figures are in the files beside this one, as printed; sections are those of the paper.
"""

import csv
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from importlib.resources import files

from tetrabench.bench.statistics import Interval
from tetrabench.sources import Facts, Finding, Line, Reading, Source, Table

REGULAR = ("triangle", "quad", "hexagon")
BLOCKS = ("gas-node", "gas-cell")
CELL_TASKS = ("cell-nodes", "cell-neighbours", "random-cell-nodes", "random-cell-neighbours")
NODE_TASKS = ("node-cells", "node-neighbours", "random-node-cells", "random-node-neighbours")
CLOSE = 2.0
"""Up to here the source calls a time of more than 100 ms close to the least one."""
CLOSE_SHORT = 3.0
"""The same of less than 100 ms, which is some ticks of its timer."""
SLOW = 1.5
"""What takes so many times as long is slow: less is within two ticks of the source's timer."""
TICK_MS = 15.625
"""Of the source's timer."""
QUERIES = 1_000_000
VALUE_BYTES = 4
STEP_FORMAT = "edge-cell"
"""The one in which the source took steps."""


def takes(facts: Facts, task: str, one: str, other: str, *, least: float = 0.0, most: float = float("inf")) -> Reading:
    """The time of one contestant in a task beside another's."""
    words = f"{one} takes {{}} as long as {other} in {task}"
    return Reading(f"{one} / {other} in {task}", words, facts.ratio(task, one, other), least, most)


def in_all(facts: Facts, one: str, other: str) -> Reading:
    """The sum over all queries."""
    return Reading(
        f"{one} / {other} in all", f"{one} takes {{}} as long as {other} in all", facts.total(one, other), 1.0
    )


def fastest(facts: Facts) -> list[Reading]:
    """All others beside by-edge."""
    return [in_all(facts, other, "by-edge") for other in CONTESTANTS if other != "by-edge"]


def near_the_least(facts: Facts) -> list[Reading]:
    """by-edge beside each other format, query by query."""
    return [
        takes(facts, task, "by-edge", other, most=CLOSE if task.startswith("random") else CLOSE_SHORT)
        for task in (*CELL_TASKS, *NODE_TASKS)
        for other in CONTESTANTS
        if other != "by-edge"
    ]


def second(facts: Facts) -> list[Reading]:
    """All but by-edge beside edge-cell-node."""
    return [in_all(facts, other, "edge-cell-node") for other in ("by-node", "by-cell", "edge-cell")]


def main_element(facts: Facts) -> list[Reading]:
    """Lists that are searched for beside the same lists of the format in which they lie ready."""
    of_cells = [takes(facts, task, "by-node", "by-cell", least=CLOSE) for task in CELL_TASKS]
    return of_cells + [takes(facts, task, "by-cell", "by-node", least=CLOSE) for task in NODE_TASKS]


def searching(facts: Facts) -> list[Reading]:
    """edge-cell around nodes."""
    return [takes(facts, task, "edge-cell", "by-edge", least=SLOW) for task in NODE_TASKS]


def at_random(facts: Facts) -> list[Reading]:
    """The same query in order and at random."""
    return [
        Reading(
            f"random-{task} / {task}, {one}",
            f"{one} takes {{}} as long at random as in order in {task}",
            facts.between_tasks(f"random-{task}", task, one),
            SLOW,
        )
        for task in ("cell-nodes", "cell-neighbours")
        for one in CONTESTANTS
    ]


def scrambled(facts: Facts) -> list[Reading]:
    """Voronoi cells beside hexagons, both about as many, in order."""
    return [
        Reading(
            f"{one} in {task}, voronoi / hexagon",
            f"{one} takes {{}} as long on Voronoi cells as on hexagons in {task}",
            facts.between_models("hexagon", task, one),
            SLOW,
        )
        for task, one in (
            ("cell-nodes", "by-edge"),
            ("cell-nodes", "by-node"),
            ("node-cells", "by-edge"),
            ("node-cells", "by-cell"),
        )
    ]


def ratio_of(one: Interval | None, other: Interval | None) -> Interval | None:
    """Of two figures that are exact."""
    return one and other and Interval(one.ratio / other.ratio, one.low / other.high, one.high / other.low, True)


def memory(facts: Facts) -> list[Reading]:
    """The dearest format beside the two that have no edges."""
    return [
        Reading(
            f"edge-cell-node / {one}, memory",
            f"edge-cell-node needs {{}} as much memory as {one}",
            ratio_of(facts.structure("edge-cell-node"), facts.structure(one)),
            most=2.0,
        )
        for one in ("by-node", "by-cell")
    ]


def share(facts: Facts) -> list[Reading]:
    """The query of a block beside the block."""
    return [
        Reading(
            f"{block}-adjacency / {block}, edge-cell",
            f"the query takes {{}} of the time of {block}",
            facts.between_tasks(f"{block}-adjacency", block, "edge-cell"),
            most=0.21,
            unit="%",
        )
        for block in BLOCKS
    ]


def share_scrambled(facts: Facts) -> list[Reading]:
    """The same on Voronoi cells."""
    return [replace(one, least=0.3, most=0.5) for one in share(facts)]


FINDINGS = (
    Finding(
        "by edge",
        "The format by edge is the fastest.",
        "8",
        "every other format takes longer for all eight tasks together",
        fastest,
        remark="The sum is mostly what the million random ones take.",
    ),
    Finding(
        "near the least",
        "The algorithms by edge have least or nearly least times on every mesh.",
        "8",
        f"by-edge takes at most {CLOSE:g} times as long as any other at random, {CLOSE_SHORT:g} times in order",
        near_the_least,
        remark="In order most of the source's times are one to four ticks of its timer, of 15.6 ms.",
    ),
    Finding(
        "edge-cell-node",
        "Edge-cell-node comes second.",
        "8",
        "by-node, by-cell and edge-cell take longer for all eight tasks together",
        second,
    ),
    Finding(
        "main element",
        "By node and by cell answer fast for their main element, and slowly for the other one.",
        "8",
        f"by-node takes {CLOSE:g} times as long as by-cell at least in lists of cells, by-cell as by-node in those of nodes",
        main_element,
    ),
    Finding(
        "searching",
        "Edge-cell is slow around nodes.",
        "8",
        f"edge-cell takes {SLOW:g} times as long as by-edge at least",
        searching,
    ),
    Finding(
        "at random",
        "At random the queries take much longer than in order.",
        "8",
        f"a list takes {SLOW:g} times as long at least",
        at_random,
        remark="Asked of cells: the source's random times around nodes look scaled on triangles and hexagons. In all its "
        "tables the median is 8.5 times on the regular meshes; on Voronoi cells, which are scrambled anyway, 1.8 times.",
        models=REGULAR,
    ),
    Finding(
        "scrambled",
        "Where the numbering is scrambled, even queries in order are slow.",
        "8",
        f"a list takes {SLOW:g} times as long on Voronoi cells as on hexagons at least",
        scrambled,
        models=("voronoi",),
    ),
    Finding(
        "memory",
        "Memory does not decide: even the dearest format takes little.",
        "8",
        "edge-cell-node needs at most twice as much as the formats without edges",
        memory,
        remark="Its own reason is the tens of values that a simulation has in each cell anyway, where 30 is the most here.",
    ),
    Finding(
        "share",
        "Adjacency takes 14 to 20 % of a step's block on regular meshes.",
        "8, tables 6 and 7",
        "the query takes at most 21 % of either block in edge-cell",
        share,
        remark="The blocks are ours, not those of TIM-2D; and a processor of today computes while it waits for lists.",
        models=REGULAR,
    ),
    Finding(
        "share, scrambled",
        "On Voronoi cells it takes 37 % of the node block and 39 % of the cell block.",
        "8, tables 6 and 7",
        "the query takes 30 to 50 % of either block in edge-cell",
        share_scrambled,
        models=("voronoi",),
    ),
)


def _rows(name: str) -> list[dict[str, str]]:
    """The lines of a file beside this one, by the names of the columns."""
    text = files("tetrabench.sources").joinpath(f"polygon-{name}.csv").read_text(encoding="utf-8")
    return list(csv.DictReader(text.splitlines()))


CONTESTANTS = {
    "by-node": "a node lists its neighbours and its cells",
    "by-edge": "an edge knows two nodes, two cells and two edges",
    "by-cell": "a cell lists its nodes and its neighbours",
    "edge-cell": "a cell lists its edges, an edge knows two nodes and two cells",
    "edge-cell-node": "cells and nodes list their edges, an edge knows two nodes and two cells",
}
"""Titles as in the family's table, which decides how they look."""

MESHES = {row["model"]: {name: int(row[name]) for name in ("cells", "edges", "nodes")} for row in _rows("meshes")}
VALUES = {row["model"]: {name: float(row[name]) for name in CONTESTANTS} for row in _rows("values-a-cell")}
"""int32 values a cell, by model and contestant."""
FORMULAS = {
    "by-node": "N + (2k + 2) L",
    "by-edge": "N + 6K + L",
    "by-cell": "(2i + 2) N + L",
    "edge-cell": "(i + 2) N + 4K + L",
    "edge-cell-node": "(i + 2) N + 4K + (k + 2) L",
}


def _times() -> dict[str, dict[str, dict[str, float | None]]]:
    times: dict[str, dict[str, dict[str, float | None]]] = {}
    for row in _rows("query-times-ms"):
        times.setdefault(row["model"], {})[row["task"]] = {name: float(row[name]) / 1e3 for name in CONTESTANTS}
    return times


TIMES = _times()


def _steps() -> dict[str, dict[str, dict[str, float | None]]]:
    times: dict[str, dict[str, dict[str, float | None]]] = {}
    for row in _rows("step-ms"):
        tasks = times.setdefault(row["model"], {})
        tasks[f"gas-{row['block']}"] = {STEP_FORMAT: float(row["step"]) / 1e3}
        tasks[f"gas-{row['block']}-adjacency"] = {STEP_FORMAT: float(row["adjacency"]) / 1e3}
    return times


STEPS = _steps()


# -- its tables, set anew


def _digits(figure: float) -> str:
    """Three digits."""
    return f"{figure:,.0f}" if figure >= 100 else f"{figure:.3g}"


def printed(task: str, contestant: str, scaled: Mapping[str, str] = {}) -> dict[str, str]:
    """Milliseconds by model, with the ticks of the timer where they are few, and with what they look scaled by."""
    return {
        model: in_ticks(1e3 * (tasks[task][contestant] or 0.0)) + scaled.get(model, "")
        for model, tasks in TIMES.items()
    }


def in_ticks(milliseconds: float) -> str:
    """A time of the source: 31 (2 ticks)."""
    ticks = round(milliseconds / TICK_MS)
    return f"{milliseconds:.0f}" + (f" ({ticks} tick{'s' * (ticks > 1)})" if ticks <= 4 else "")


def times_as(number: float, figure: Interval | None) -> Interval | None:
    """So many times a figure, ends and all."""
    return figure and Interval(number * figure.ratio, number * figure.low, number * figure.high, figure.is_whole)


def in_order(task: str, contestant: str) -> Line:
    """A query of all elements; today's of as many as the source's mesh has."""
    things = "cells" if task in CELL_TASKS else "nodes"
    return Line(
        (task, contestant),
        printed(task, contestant) if contestant in CONTESTANTS else {},
        lambda model, facts: times_as(1e3 * MESHES[model][things], facts.item(task, contestant)),
    )


def some_at_random(task: str, contestant: str) -> Line:
    """A query of a million elements."""
    scaled = {"triangle": " (x2)", "hexagon": " (/2)"} if task in NODE_TASKS else {}
    return Line(
        (task, contestant),
        printed(task, contestant, scaled) if contestant in CONTESTANTS else {},
        lambda model, facts: times_as(1e3 * QUERIES, facts.item(task, contestant)),
    )


def query_lines(is_random: bool, contestants: Sequence[str]) -> list[Line]:
    """All queries of one kind, format by format."""
    line = some_at_random if is_random else in_order
    tasks = [task for task in TIMES["quad"] if task.startswith("random") == is_random]
    return [line(task, contestant) for task in tasks for contestant in contestants]


def mesh_lines(contestants: Sequence[str]) -> list[Line]:
    """Cells, edges and nodes."""
    return [_mesh_line(things) for things in ("cells", "edges", "nodes")]


def _mesh_line(things: str) -> Line:
    known = {model: f"{size[things]:,}" for model, size in MESHES.items()}
    return Line((things,), known, lambda model, facts: facts.size(things))


def value_lines(contestants: Sequence[str]) -> list[Line]:
    """Values a cell, with the source's formula; today's counted from the arrays."""
    return list(map(_value_line, contestants))


def _value_line(contestant: str) -> Line:
    known = {model: f"{values[contestant]:g}" for model, values in VALUES.items() if contestant in values}
    return Line(
        (contestant, FORMULAS.get(contestant, "")),
        known,
        lambda model, facts: times_as(1 / VALUE_BYTES, ratio_of(facts.structure(contestant), facts.size("cells"))),
    )


def share_lines(block: str, contestants: Sequence[str]) -> list[Line]:
    """The query of a block as a share of it, in percent."""
    return [_share_line(block, one) for one in contestants]


def _share_line(block: str, contestant: str) -> Line:
    steps = {(row["model"], f"gas-{row['block']}"): row for row in _rows("step-ms")}
    known = {model: row["percent"] for (model, of), row in steps.items() if of == block and contestant == STEP_FORMAT}
    return Line(
        (contestant,),
        known,
        lambda model, facts: times_as(100, facts.between_tasks(f"{block}-adjacency", block, contestant)),
    )


OF_TICKS = f"The source's timer ticked every {TICK_MS:.1f} ms: its times of 16 to 63 ms are one to four ticks."
TABLES = (
    Table("table 1", "the meshes", ("number of",), "{:,.0f}".format, mesh_lines),
    Table(
        "table 2",
        "int32 values a cell that a format stores",
        ("format", "formula"),
        "{:.3f}".format,
        value_lines,
        notes=(
            "The formulas leave the boundary out; today's are counted from the arrays, all of them. N cells, K edges, L nodes; "
            "i nodes a cell, k edges a node. The source has no figures for Voronoi cells.",
        ),
    ),
    Table(
        "table 3",
        "time of a query of all cells or nodes in order, ms",
        ("query", "format"),
        _digits,
        partial(query_lines, False),
        notes=(OF_TICKS, "Today's is CPU time, of as many cells or nodes as the source's mesh has."),
    ),
    Table(
        "table 4",
        "time of a query of cells or nodes at random, ms for a million",
        ("query", "format"),
        _digits,
        partial(query_lines, True),
        notes=(
            "(x2), (/2): as printed; it looks scaled by nodes a cell, and twice or half of it is ms for a million.",
            OF_TICKS,
        ),
    ),
    Table(
        "table 6",
        "share of adjacency in the node block of a step, %",
        ("format",),
        _digits,
        partial(share_lines, "gas-node"),
        notes=(
            "The query of the block alone over the block. The source's step is that of TIM-2D, today's is gas-node.",
        ),
    ),
    Table(
        "table 7",
        "share of adjacency in the cell block of a step, %",
        ("format",),
        _digits,
        partial(share_lines, "gas-cell"),
        notes=("The same of gas-cell.",),
    ),
)

SOURCE = Source(
    title="Некоторые форматы данных для представления двумерных неструктурированных сеток произвольного вида",
    author="A. A. Voropinov",
    place="RFNC-VNIIEF, Sarov",
    year=2008,
    machine="a machine that the paper does not name",
    reference="by-edge",
    contestants=CONTESTANTS,
    figures=dict.fromkeys(MESHES, "tables 3 and 4"),
    models={name: ", ".join(f"{count:,} {what}" for what, count in counts.items()) for name, counts in MESHES.items()},
    counts={task: {"queries": 1_000_000} for task in (*CELL_TASKS, *NODE_TASKS) if task.startswith("random")},
    times=TIMES,
    spoken=STEPS,
    memory={},
    structures={
        model: {name: VALUE_BYTES * value * MESHES[model]["cells"] for name, value in values.items()}
        for model, values in VALUES.items()
    },
    tables=TABLES,
    tick_s=TICK_MS / 1e3,
    findings=FINDINGS,
    notes=(
        "The year is about 2008: its latest references are of 2007, and the journal received it on 26 February 2010.",
        "The source's timer ticked every 15.6 ms: its times of 16 to 63 ms are one to four ticks.",
        "Its random times around nodes look scaled by nodes a cell, on triangles and hexagons: twice, and half of them, would "
        "be milliseconds for a million. All contestants alike, so ratios stand.",
        "Its meshes are lost; today's have their shape, and but for the triangles their numbers of cells, edges and nodes.",
        "It recommends edge-cell all the same: memory and times of all formats will do, and edge-cell alone carries over to "
        "three dimensions. That is no question of figures, and not asked here.",
    ),
)
