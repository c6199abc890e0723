"""The source of the polygon family: the paper of A. A. Voropinov (Sarov, about 2008), its tables and what it found in them.

Figures are in the files beside this one, as printed; sections are those of the paper.
"""

import csv
from importlib.resources import files

from tetrabench.sources import Facts, Finding, Reading, Source

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
    """Lists that lie ready, and those that are searched for."""
    ready = [takes(facts, task, "by-node", "by-edge", most=CLOSE_SHORT) for task in NODE_TASKS]
    ready += [takes(facts, task, "by-cell", "by-edge", most=CLOSE_SHORT) for task in CELL_TASKS]
    searched = [takes(facts, task, "by-node", "by-edge", least=SLOW) for task in CELL_TASKS]
    return ready + searched + [takes(facts, task, "by-cell", "by-edge", least=SLOW) for task in NODE_TASKS]


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


def memory(facts: Facts) -> list[Reading]:
    """The dearest format beside the two that have no edges."""
    return [
        Reading(
            f"edge-cell-node / {one}, memory",
            f"edge-cell-node needs {{}} as much memory as {one}",
            facts.memory("edge-cell-node", one),
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
    return [
        Reading(one.about, one.words, one.figure, 0.3, 0.5, one.unit) for one in share(facts)
    ]  # fmt: skip


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
        f"beside by-edge lists that lie ready take at most {CLOSE_SHORT:g} times as long, the others {SLOW:g} times at least",
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
        remark="Asked of cells: the source's random times around nodes look scaled on triangles and hexagons.",
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
        remark="The source counts values; today's figure is the peak while the format is built, where it was measured.",
    ),
    Finding(
        "share",
        "Adjacency takes 14 to 20 % of a step's block on regular meshes.",
        "8, tables 6 and 7",
        "the query takes at most 21 % of either block in edge-cell",
        share,
        remark="Our cell block does more arithmetic; and a processor of today computes while it waits for lists.",
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


def _times() -> dict[str, dict[str, dict[str, float | None]]]:
    times: dict[str, dict[str, dict[str, float | None]]] = {}
    for row in _rows("query-times-ms"):
        times.setdefault(row["model"], {})[row["task"]] = {name: float(row[name]) / 1e3 for name in CONTESTANTS}
    return times


def _steps() -> dict[str, dict[str, dict[str, float | None]]]:
    times: dict[str, dict[str, dict[str, float | None]]] = {}
    for row in _rows("step-ms"):
        tasks = times.setdefault(row["model"], {})
        tasks[f"gas-{row['block']}"] = {"edge-cell": float(row["step"]) / 1e3}
        tasks[f"gas-{row['block']}-adjacency"] = {"edge-cell": float(row["adjacency"]) / 1e3}
    return times


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
    times=_times(),
    decimals=3,
    spoken=_steps(),
    memory={
        model: {name: round(4 * value * MESHES[model]["cells"] / 1000) for name, value in values.items()}
        for model, values in VALUES.items()
    },
    held="the values of table 2 as 4 bytes each, kB",
    findings=FINDINGS,
    notes=(
        "The year is about 2008: the paper names none; its latest reference is of 2007.",
        "The source's timer ticked every 15.6 ms: its times of 16 to 63 ms are one to four ticks.",
        "Its random times around nodes look scaled by nodes a cell, on triangles and hexagons: twice, and half of them, would "
        "be milliseconds for a million. All contestants alike, so ratios stand.",
        "Its meshes are lost; today's have their shape, and but for the triangles their numbers of cells, edges and nodes.",
    ),
)
