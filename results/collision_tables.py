"""The tables of docs/collision.md, from the committed runs on objects that move."""

from functools import cache
from pathlib import Path
from statistics import median

import pandas as pd

RESULTS = Path(__file__).parent
MODELS = ("uniform", "separated", "clustered", "halo", "mixed")
TASKS = ("motion", "impulses", "build", "windows")
YARDSTICK = "ckdtree"
"""The structure that the others are held against."""
BARS = {"kdtree": 0.17, "grid": 0.10, "skin": 0.035}
"""The most of its time that a step may take; of kdtree, at its best capacity."""

Lines = list[list[str]]


def run_of(name: str) -> Path:
    """One of the runs on objects."""
    return RESULTS / f"collision-{name}.json"


@cache
def rows(name: str) -> pd.DataFrame:
    """The rows of a run, without the control's."""
    from tetrabench import load_summary

    found = load_summary(run_of(name))
    return found[~found.control]


def bars() -> Lines:
    """A step of all structures beside the yardstick, with the bars, and with what the machine could do."""
    from tetrabench.bench import read_results

    run = read_results(run_of("bars"))
    copy = median(one.yardsticks.copy_gb_s for one in run.launches if one.yardsticks)
    millions = run.models[0].size["objects"] / 1e6
    steps = list(rows("bars").itertuples())
    best = {name: min(one.ns_per_item for one in steps if one.contestant == name) for name in BARS}
    lines = [
        ["structure", "ms a step", f"beside {YARDSTICK}", "95 %", "bar", "", "least traffic, GB/s", "of a copy's"],
        ["---", *["---:"] * 4, "---", "---:", "---:"],
    ]
    for step in steps:
        bar = BARS[step.contestant] if step.ns_per_item == best.get(step.contestant) else None
        lines.append(
            [
                step.backend,
                f"{step.ns_per_item * millions:.2f}",
                "1" if pd.isna(step.ratio) else f"{step.ratio:.3f}",
                "" if pd.isna(step.low) else f"{step.low:.3f} to {step.high:.3f}",
                "" if bar is None else f"{bar:g}",
                "" if bar is None else "met" if step.high <= bar else "missed",
                f"{step.gb_per_s:.2f}",
                f"{100 * step.gb_per_s / copy:.1f} %",
            ]
        )
    return lines


def models() -> Lines:
    """Nanoseconds an item of each structure on each model."""
    shown = list(dict.fromkeys(rows(MODELS[0]).backend))
    lines = [["ns an item", "model", *shown], ["---", "---", *["---:"] * len(shown)]]
    for task in TASKS:
        for model in MODELS:
            found = rows(model)
            times = found[found.task == task].set_index("backend").ns_per_item
            cells = [times.get(name) for name in shown]
            lines.append(
                [task, model, *("" if pd.isna(one) else f"{one:,.0f}" if one >= 100 else f"{one:.3g}" for one in cells)]
            )
    return lines
