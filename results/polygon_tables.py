"""The tables of docs/polygon.md, from the committed runs on polygon meshes and from the bench beside other libraries."""

import json
from functools import cache
from pathlib import Path
from statistics import median

import pandas as pd

RESULTS = Path(__file__).parent
MODELS = ("triangle", "quad", "hexagon", "voronoi")
QUERIES = ("cell-nodes", "cell-neighbours", "node-cells", "node-neighbours")
OPERATIONS = [way + query for way in ("", "random-") for query in QUERIES]
TASKS = [*OPERATIONS, *(block + part for block in ("gas-node", "gas-cell") for part in ("", "-adjacency"))]
"""What the source measured."""

Lines = list[list[str]]


@cache
def summary(model: str) -> pd.DataFrame:
    """Nanoseconds an item, by task and contestant, of the committed run on a model."""
    from tetrabench import load_summary

    rows = load_summary(RESULTS / f"polygon-{model}.json")
    return rows[~rows.control].pivot_table(index="task", columns="backend", values="ns_per_item", aggfunc="first")


@cache
def structures(model: str) -> tuple[int, dict[str, int]]:
    """Cells of a model, and bytes of each contestant's arrays."""
    from tetrabench.bench import read_results

    run = read_results(RESULTS / f"polygon-{model}.json")
    sizes = {one.name: sum(used for used, _ in one.structure.values()) for one in run.backends if not one.control}
    return run.models[0].size["cells"], sizes


def contestants() -> dict[str, str]:
    """Names as they stand in tables, those that are ours marked, by the names themselves."""
    from tetrabench.backends.polygon import CONTESTANTS

    return {one.name: f"{one.name}{' *' * one.extension}" for one in CONTESTANTS}


def values() -> Lines:
    """int32 values a cell, counted from the arrays."""
    lines = _head(["values a cell"], MODELS)
    for name, shown in contestants().items():
        counts = [structures(model)[1][name] / 4 / structures(model)[0] for model in MODELS]
        lines.append([shown, *(f"{count:.3f}" for count in counts)])
    return lines


def queries() -> Lines:
    """Nanoseconds a list, all in order and a million at random."""
    shown = contestants()
    lines = _head(["ns a list", "mesh"], shown.values())
    for task in OPERATIONS:
        for model in MODELS:
            times = summary(model).loc[task]
            lines.append([task.replace("random-", "random "), model, *(_figure(times.get(name)) for name in shown)])
    return lines


def shares() -> Lines:
    """The query of a block, as a share of the block."""
    shown = contestants()
    lines = _head(["block", "mesh"], shown.values())
    for block in ("gas-node", "gas-cell"):
        for model in MODELS:
            times = summary(model)
            parts = times.loc[f"{block}-adjacency"] / times.loc[block]
            cells = ["" if pd.isna(parts.get(name)) else f"{100 * parts[name]:.0f} %" for name in shown]
            lines.append([block.removeprefix("gas-"), model, *cells])
    return lines


def peers() -> list[Lines]:
    """Queries beside plain tables in C, the best beside CGAL and OpenMesh; building; bytes a cell."""
    found = json.loads((RESULTS / "polygon-peers.json").read_text())
    rows = {(row["operation"], row["numbering"], row["peer"]): row for row in found["rows"]}
    shown = contestants()
    asked = _head(["query", "C, ns"], [*shown.values(), "bar", "best beside CGAL", "beside OpenMesh"])
    for operation in (task.replace("random-", "random ") for task in OPERATIONS):
        beside_c = [rows[operation, name, "c"] for name in shown]
        ours = [_ratio(row) for row in beside_c]
        best = min(shown, key=lambda name: rows[operation, name, "c"]["ratio"])
        others = [_ratio(rows[operation, best, peer]) for peer in ("cgal", "openmesh")]
        nanoseconds = median(1e9 * row["peer_s"] / row["elements"] for row in beside_c)
        bar = rows[operation, "tables", "c"]["bar"]
        asked.append([operation, f"{nanoseconds:.1f}", *ours, f"{bar:g}", *others])
    built = _head(["building", "ms", "beside CGAL", "95 %"], ["bar"])
    for name, title in shown.items():
        row = rows["build", name, "cgal"]
        interval = f"{row['low']:.2f} to {row['high']:.2f}"
        built.append([title, f"{1e3 * row['ours_s']:.0f}", _ratio(row), interval, f"{row['bar']:g}"])
    weights = found["bytes_a_cell"]
    names = {"c": "plain tables in C", "cgal": "CGAL", "openmesh": "OpenMesh", **shown}
    weighed = [["bytes a cell", *(names[name] for name in weights)], ["---"] + ["---:"] * len(weights)]
    weighed.append(["", *(f"{weight:.1f}" for weight in weights.values())])
    return [asked, built, weighed]


def _head(words: list[str], figures: object) -> Lines:
    columns = list(figures)  # type: ignore[call-overload]
    return [[*words, *columns], ["---"] * len(words) + ["---:"] * len(columns)]


def _figure(value: float | None) -> str:
    return "" if value is None or pd.isna(value) else f"{value:.3g}" if value < 1000 else f"{value:,.0f}"


def _ratio(row: dict[str, float]) -> str:
    """A multiple; fat where its interval ends beyond its bar."""
    text = f"{row['ratio']:.2f}"
    return f"**{text}**" if row.get("met") is False else text
