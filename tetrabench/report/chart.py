"""The charts of a run: time by task and memory, after the source's figures 10 and 11, and growth over sizes."""

import textwrap
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from tetrabench.bench.record import Results
from tetrabench.bench.statistics import ALIKE, CLEAR, Row, summary
from tetrabench.errors import InputError
from tetrabench.report.bars import Bar, draw_bars, find_top
from tetrabench.report.cells import ratio_of, word_of
from tetrabench.report.memory import memory_of
from tetrabench.report.notes import about_machine
from tetrabench.report.parts import Part, make_parts
from tetrabench.report.style import EDGE, Style, make_styles
from tetrabench.report.units import duration

WIDTH = 11.0  # inches
PANEL = 6  # groups of bars side by side
PANEL_HEIGHT = 2.7  # inches
CURVES = 4  # panels of curves side by side


def draw_charts(results: Results, folder: Path, suffix: str = ".png") -> list[Path]:
    """Write the charts of a run in the format of the suffix; their paths.

    `times` and `memory`, for each model (and each reference) where there are several; `growth` over several sizes.

    Raises:
        InputError: the folder cannot be written to.
    """
    rows = summary(results)
    charts: dict[str, Figure] = {}
    for part in make_parts(results, rows):
        charts["-".join(filter(None, ("times", part.name)))] = draw_times(part)
        if memory_of(part):
            charts["-".join(filter(None, ("memory", part.name)))] = draw_memory(part)
    if len({next(iter(model.size.values()), 0) for model in results.models}) > 1:
        charts["growth"] = draw_growth(results, rows)
    paths = [folder / f"{name.replace('/', '-').replace(' ', '-')}{suffix}" for name in charts]
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for path, figure in zip(paths, charts.values(), strict=True):
            figure.savefig(path, dpi=150)
    except OSError as error:
        raise InputError(f"{error.filename or folder}: cannot write charts: {error.strerror}") from error
    return paths


def draw_times(part: Part) -> Figure:
    """A group of bars a task: time as a multiple of the reference's, which stands below it."""
    styles = _styles_of(part)
    groups = {
        task: {
            name: _time_bar(row, part.controls.get(task))
            for name in styles
            if (row := part.rows.get((task, name))) is not None
        }
        for task in part.tasks
    }
    tasks = part.tasks
    pieces = [tasks[start : start + PANEL] for start in range(0, len(tasks), PANEL)] or [[]]
    figure, panels = _make_figure(
        f"{part.model.name}: time, compared with {part.reference}", _times_caption(part), styles, len(pieces), 1
    )
    band = ALIKE if part.has_intervals else CLEAR
    top = find_top(list(groups.values()), 1.0)
    for axes, piece in zip(panels, pieces, strict=True):
        axes.axhspan(1 / band, band, color="#e8e8e8", zorder=0, linewidth=0)
        axes.axhline(1.0, color=EDGE, linewidth=0.8, zorder=1)
        draw_bars(axes, [groups[task] for task in piece], styles, top=top)
        axes.set_xticks(range(len(piece)), [_label(part, task) for task in piece])
        axes.set_xlim(-0.5, max(1, min(PANEL, len(tasks))) - 0.5)
        axes.set_ylabel(f"time, multiple of {part.reference}'s")
    return figure


def draw_memory(part: Part) -> Figure:
    """A panel for each kind of memory that is known, all of one scale."""
    styles = _styles_of(part)
    titles = {"structure": "fresh structure", "retained": "retained by its process", "peak": "peak while it is built"}
    kinds = memory_of(part)
    caption = f"{part.title}. {about_machine(part.results)}. Bars with a gap are cut, their value above them."
    figure, panels = _make_figure(f"{part.model.name}: memory", caption, styles, 1, len(kinds))
    groups = {
        kind: {name: _memory_bar(sizes.get(name, "no figure")) for name in styles} for kind, sizes in kinds.items()
    }
    known = [bar.height for bars in groups.values() for bar in bars.values() if bar.height is not None]
    mark = groups.get("structure", {}).get(part.reference, Bar(None)).height or min(known)
    top = find_top(list(groups.values()), mark)
    for axes, (kind, bars) in zip(panels, groups.items(), strict=True):
        draw_bars(axes, [bars], styles, top=top)
        width = min(0.86 / max(1, len(bars)), 0.6)
        axes.set_xticks([(step - (len(bars) - 1) / 2) * width for step in range(len(bars))], list(bars))
        axes.set_title(titles[kind], fontsize=10)
    panels[0].set_ylabel(f"bytes a {part.item}")
    return figure


def draw_growth(results: Results, rows: Sequence[Row]) -> Figure:
    """A panel for each task: time of an item over the size of the model, both logarithmic, a line a contestant."""
    styles = make_styles(results)
    sizes = {model.name: next(iter(model.size.values()), 0) for model in results.models}
    things = next((name for model in results.models for name in model.size), "items")
    tasks = [task.name for task in results.tasks if any(row.task == task.name for row in rows)]
    height = max(1, -(-len(tasks) // CURVES))
    models = ", ".join(f"{name}: {size:,}" for name, size in sizes.items())
    caption = (
        f"{models} {things}. {about_machine(results)}. A level line is linear growth: each item takes the same time whatever "
        "the size. Medians of all samples; no figure where a cell went wrong."
    )
    title = "Time of an item over the size of the model"
    figure, panels = _make_figure(title, caption, styles, height, min(CURVES, max(1, len(tasks))), lines=True)
    for axes, task in zip(panels, tasks, strict=False):
        for name, style in styles.items():
            points = sorted(
                (sizes[row.model], row.ns_per_item)
                for row in rows
                if (row.task, row.backend) == (task, name) and row.ns_per_item and sizes[row.model]
            )
            if points:
                axes.plot(*zip(*points, strict=True), **style.line, markersize=5, linewidth=1.4, fillstyle="none")
        axes.set(title=task, xscale="log", yscale="log", xlabel=things, ylabel="ns an item")
        axes.grid(color="#dddddd", linewidth=0.6)
        axes.spines[["top", "right"]].set_visible(False)
    for axes in panels[len(tasks) :]:
        axes.set_axis_off()
    return figure


def _styles_of(part: Part) -> dict[str, Style]:
    names = {backend.name for backend in part.backends}
    return {name: style for name, style in make_styles(part.results).items() if name in names}


def _time_bar(row: Row, control: Row | None) -> Bar:
    if row.verdict == "reference":
        return Bar(1.0, control=_ends(control))
    if row.ratio is None or row.verdict not in ("faster", "slower", "same", "about", "inconclusive"):
        return Bar(None, label=word_of(row))
    is_solid = row.verdict not in ("about", "inconclusive")
    return Bar(row.ratio, _ends(row), label=ratio_of(row), is_solid=is_solid)


def _ends(row: Row | None) -> tuple[float, float] | None:
    if row is None or row.low is None or row.high is None:
        return None
    return row.low, row.high


def _memory_bar(size: float | str) -> Bar:
    if isinstance(size, str):
        return Bar(None, label=size)
    return Bar(size, label=f"{size:,.0f}", is_labelled=True)


def _label(part: Part, task: str) -> str:
    """A task, and what the reference takes for it."""
    row = part.rows.get((task, part.reference))
    seconds = f"\n{part.reference}: {duration(row.seconds)}" if row is not None and row.seconds is not None else ""
    return task.replace(" ", "\n") + seconds


def _times_caption(part: Part) -> str:
    wall = list(dict.fromkeys(row.task for row in part.rows.values() if row.clock == "wall"))
    clock = f"CPU time, in {', '.join(wall)} wall time" if wall else "CPU time"
    if part.has_intervals:
        ranks = (
            "Whiskers: intervals that hold with 95 % for all of a scenario together; the grey one is a second copy of "
            f"{part.reference}. An interval within the grey band means the same, one that holds 1 ranks nothing: a hollow bar."
        )
    else:
        spans = any(row.low != row.high for row in part.rows.values())
        ranks = (
            "Launches are too few for intervals"
            + ("; whiskers show their range. " if spans else ". ")
            + "Within the grey band nothing is ranked: hollow bars are a hint."
        )
    return f"{part.title}. {about_machine(part.results)}. {clock}. {ranks} Bars with a gap are cut, their value above them."


def _make_figure(
    title: str, caption: str, styles: Mapping[str, Style], rows: int, columns: int, *, lines: bool = False
) -> tuple[Figure, list[Axes]]:
    """A figure with its title, its legend and its caption, and room for the panels."""
    columns_of_legend = _legend_columns(styles)
    filled = textwrap.fill(caption.replace(" %", "\N{NO-BREAK SPACE}%"), 165)
    above = 0.45 + 0.19 * max(map(len, columns_of_legend), default=0)  # inches
    height, foot = PANEL_HEIGHT * rows, 0.15 + 0.15 * (1 + filled.count("\n"))
    figure = Figure(figsize=(WIDTH, above + height + foot), layout="constrained")
    parts: Any = figure.subfigures(3, 1, height_ratios=(above, height, foot))
    heading, body, bottom = parts
    heading.suptitle(title, x=0.01, ha="left", fontsize=13, fontweight="bold")
    _add_legend(heading, columns_of_legend, top=1 - 0.3 / above, lines=lines)
    bottom.text(0.01, 0.9, filled, ha="left", va="top", fontsize=8, color="#444444")
    return figure, list(body.subplots(rows, columns, squeeze=False).flat)


def _legend_columns(styles: Mapping[str, Style]) -> list[list[tuple[str, Style]]]:
    """A column a layout."""
    layouts = dict.fromkeys(style.layout for style in styles.values())
    return [[(name, style) for name, style in styles.items() if style.layout == layout] for layout in layouts]


def _add_legend(figure: Any, columns: list[list[tuple[str, Style]]], top: float, *, lines: bool) -> None:
    longest = max(map(len, columns), default=0)
    handles: list[Patch | Line2D] = []
    labels = []
    for column in columns:
        gap = longest - len(column)
        handles += [Line2D([], [], fillstyle="none", **one.line) if lines else Patch(**one.paint) for _, one in column]
        handles += [Patch(alpha=0.0)] * gap
        labels += [f"{name}: {style.title}" for name, style in column] + [""] * gap
    if handles:
        look: Any = {"ncols": len(columns), "loc": "upper left", "frameon": False, "fontsize": 9}
        figure.legend(handles, labels, bbox_to_anchor=(0.0, top), **({"handlelength": 3} if lines else {}), **look)
