"""The charts of a run: time by task and memory, after the source's figures 10 and 11, and growth over sizes."""

import textwrap
from collections.abc import Callable, Mapping, Sequence
from itertools import chain
from pathlib import Path
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.textpath import TextPath

from tetrabench.bench.record import Results
from tetrabench.bench.statistics import ALIKE, CLEAR, Row, summary
from tetrabench.errors import InputError
from tetrabench.report.bars import ALARM, draw_bars
from tetrabench.report.cells import MISSING, ratio_of, word_of
from tetrabench.report.dots import CONTROL, Dot, draw_dots, find_ends
from tetrabench.report.memory import memory_of
from tetrabench.report.notes import FOREIGN, about_clock, about_end, about_machine, fewer_than_asked
from tetrabench.report.parts import Part, make_parts
from tetrabench.report.style import EDGE, Style, make_styles
from tetrabench.report.units import counted, duration

WIDTH = 11.0  # inches
PANEL = 6  # groups of dots side by side
PANEL_HEIGHT = 3.2  # inches
CURVES = 4  # panels of curves side by side
SMALL = 9  # points, of the legend
LONGEST = 64  # characters in a line of the legend
LEGEND_GAPS = 0.85  # inches of a column of the legend that are no words
LETTER = 0.09  # inches, of a name below a bar
Handle = Patch | Line2D  # a sign in the legend


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
    """A group of dots a task: time as a multiple of the reference's, which stands below it."""
    styles = _styles_of(part)
    groups = {task: {name: _dot(part, task, name) for name in styles} for task in part.tasks}
    tasks = part.tasks
    pieces = [tasks[start : start + PANEL] for start in range(0, len(tasks), PANEL)] or [[]]
    title = f"{part.model.name}: time, compared with {part.reference}"
    dots = [dot for group in groups.values() for dot in group.values()]
    is_compared = any(
        dot.ratio is not None for dots in groups.values() for name, dot in dots.items() if name != part.reference
    )
    caption = _times_caption(part, dots, is_compared=is_compared)
    figure, panels = _make_figure(part.results, title, caption, styles, len(pieces), 1, _dot_sign)
    band = ALIKE if part.has_intervals else CLEAR
    ends = find_ends(list(groups.values()))
    for axes, piece in zip(panels, pieces, strict=True):
        if is_compared:
            axes.axhspan(1 / band, band, color="#ececec", zorder=0, linewidth=0)
        axes.axhline(1.0, color=EDGE, linewidth=0.8, zorder=1)
        draw_dots(axes, [groups[task] for task in piece], styles, ends)
        axes.set_xticks(range(len(piece)), [_label(part, task) for task in piece])
        axes.set_xlim(-0.5, max(1, min(PANEL, len(tasks))) - 0.5)
        axes.set_ylabel(f"time, multiple of {part.reference}'s")
    return figure


def draw_memory(part: Part) -> Figure:
    """A panel for each kind of memory that is known, all of one scale."""
    styles = _styles_of(part)
    titles = {
        "structure": "fresh structure",
        "retained": "retained by its process, to about 1 %",
        "peak": "peak while it is built, to about 1 %",
    }
    kinds = memory_of(part)
    caption = f"{part.title}. {about_machine(part.results)}."
    figure, panels = _make_figure(part.results, f"{part.model.name}: memory", caption, styles, 1, len(kinds), _bar_sign)
    top = max(size for sizes in kinds.values() for size in sizes.values() if not isinstance(size, str))
    for axes, (kind, sizes) in zip(panels, kinds.items(), strict=True):
        draw_bars(axes, {name: sizes[name] for name in styles}, styles, top=top)
        axes.set_title(titles[kind], fontsize=10)
        if LETTER * max(len(style.name) for style in styles.values()) > 0.7 * WIDTH / len(kinds) / len(styles):
            axes.tick_params(axis="x", labelrotation=90)
    panels[0].set_ylabel(f"bytes a {part.item}")
    return figure


def draw_growth(results: Results, rows: Sequence[Row]) -> Figure:
    """A panel for each task: time of an item over the size of the model, both logarithmic, a line a contestant."""
    styles = make_styles(results)
    sizes = {model.name: next(iter(model.size.values()), 0) for model in results.models}
    things = next((name for model in results.models for name in model.size), "items")
    tasks = [task.name for task in results.tasks if any(row.task == task.name for row in rows)]
    height = max(1, -(-len(tasks) // CURVES))
    models = ", ".join(f"{name}: {counted(size, things)}" for name, size in sizes.items())
    middle = " Medians of all samples." if any(row.samples > 1 for row in rows) else ""
    caption = (
        f"{models}. {about_machine(results)}. A level line is linear growth: each item takes the same time whatever "
        f"the size.{middle} No figure where a cell went wrong."
    )
    title = "Time of an item over the size of the model"
    figure, panels = _make_figure(results, title, caption, styles, height, min(CURVES, max(1, len(tasks))), _line_sign)
    for axes, task in zip(panels, tasks, strict=False):
        for name, style in styles.items():
            points = sorted(
                (sizes[row.model], row.ns_per_item)
                for row in rows
                if (row.task, row.backend) == (task, name) and row.ns_per_item and sizes[row.model]
            )
            if points:
                axes.plot(*zip(*points, strict=True), **style.line)
        axes.set(title=task, xscale="log", yscale="log", xlabel=things, ylabel="ns an item")
        axes.grid(color="#dddddd", linewidth=0.6)
        axes.spines[["top", "right"]].set_visible(False)
    for axes in panels[len(tasks) :]:
        axes.set_axis_off()
    return figure


def _styles_of(part: Part) -> dict[str, Style]:
    names = {backend.name for backend in part.backends}
    return {name: style for name, style in make_styles(part.results).items() if name in names}


def _dot_sign(style: Style) -> Handle:
    return Line2D([], [], **style.dot)


def _line_sign(style: Style) -> Handle:
    return Line2D([], [], **style.line)


def _bar_sign(style: Style) -> Handle:
    return Patch(**style.paint)


def _dot(part: Part, task: str, name: str) -> Dot:
    row = part.rows.get((task, name))
    if row is None:
        return Dot(None, label=MISSING)
    if row.verdict == "reference":
        return Dot(1.0, control=_ends(part.controls.get(task)))
    if row.ratio is None or row.verdict not in ("faster", "slower", "same", "about", "inconclusive"):
        return Dot(None, label=word_of(row))
    return Dot(row.ratio, _ends(row), label=ratio_of(row), is_solid=row.verdict not in ("about", "inconclusive"))


def _ends(row: Row | None) -> tuple[float, float] | None:
    if row is None or row.low is None or row.high is None:
        return None
    return row.low, row.high


def _label(part: Part, task: str) -> str:
    """A task, and what the reference takes for it."""
    row = part.rows.get((task, part.reference))
    seconds = f"\n{part.reference}: {duration(row.seconds)}" if row is not None and row.seconds is not None else ""
    return textwrap.fill(task, 20) + seconds


def _times_caption(part: Part, dots: Sequence[Dot], *, is_compared: bool) -> str:
    """What the chart shows; each sign is explained where it occurs."""
    said = [f"{part.title}. {about_machine(part.results)}. {about_clock(part.rows.values())}, less is better."]
    if few := fewer_than_asked(part):
        said.append(f"Fewer than asked for, the model is too small: {few}.")
    if is_compared and part.has_intervals:
        said.append("Whiskers, where longer than a dot: intervals that hold with 95 % for all of a scenario together.")
        said.append("An interval within the grey band means the same, one that holds 1 ranks nothing.")
    elif is_compared:
        few = "One launch: no intervals" if max(part.launches.values()) == 1 else "Too few launches for intervals"
        spans = any(colour == EDGE for dot in dots for _, colour in dot.whiskers)
        said.append(f"{few}{'; whiskers: their range' if spans else ''}. Within the grey band nothing is ranked.")
    if any(colour == CONTROL for dot in dots for _, colour in dot.whiskers):
        said.append(f"Grey whiskers: a second copy of {part.reference}.")
    if any(not dot.is_solid for dot in dots):
        said.append("Hollow: not ranked.")
    return " ".join(said)


def _make_figure(
    results: Results,
    title: str,
    caption: str,
    styles: Mapping[str, Style],
    rows: int,
    columns: int,
    sign: Callable[[Style], Handle],
) -> tuple[Figure, list[Axes]]:
    """A figure with its title, its legend and its caption, and room for the panels."""
    if any(style.name.endswith("*") for style in styles.values()):
        caption += f" {FOREIGN}"
    titles = textwrap.wrap(title, 80) + ([about_end(results)] if results.ended else [])
    entries = _legend_columns(styles)
    filled = textwrap.fill(caption.replace(" %", "\N{NO-BREAK SPACE}%"), 180)
    heads = 0.1 + 0.22 * len(titles)  # inches
    above = heads + 0.15 + 0.19 * max(map(_lines, entries), default=0)
    height, foot = PANEL_HEIGHT * rows, 0.15 + 0.15 * (1 + filled.count("\n"))
    figure = Figure(figsize=(WIDTH, above + height + foot), layout="constrained")
    parts: Any = figure.subfigures(3, 1, height_ratios=(above, height, foot))
    heading, body, bottom = parts
    for place, line in enumerate(titles):
        colour = ALARM if results.ended and place == len(titles) - 1 else "black"
        look = {"fontsize": 13, "fontweight": "bold", "ha": "left", "va": "top"}
        heading.text(0.01, 1 - (0.08 + 0.22 * place) / above, line, color=colour, **look)
    _add_legend(heading, entries, 1 - heads / above, sign)
    bottom.text(0.01, 0.9, filled, ha="left", va="top", fontsize=8, color="#444444")
    return figure, list(body.subplots(rows, columns, squeeze=False).flat)


Entries = list[tuple[str, Style]]  # words in the legend, and how they look


def _legend_columns(styles: Mapping[str, Style]) -> list[Entries]:
    """A column a layout, or several layouts in a column where that is too wide."""
    layouts: dict[str, Entries] = {}
    for style in styles.values():
        layouts.setdefault(style.layout, []).append((textwrap.fill(f"{style.name}: {style.title}", LONGEST), style))
    each = list(layouts.values())
    columns: list[Entries] = []
    for share in range(1, len(each) + 1):
        columns = [list(chain(*each[start : start + share])) for start in range(0, len(each), share)]
        if sum(LEGEND_GAPS + max(_width(words) for words, _ in column) for column in columns) < WIDTH:
            break
    return columns


def _lines(column: Entries) -> int:
    return sum(1 + words.count("\n") for words, _ in column)


def _width(words: str) -> float:
    """Of words in the legend, inches."""
    small = FontProperties(size=SMALL)
    return max(float(TextPath((0, 0), line, prop=small).get_extents().width) for line in words.split("\n")) / 72


def _add_legend(figure: Any, columns: list[Entries], top: float, sign: Callable[[Style], Handle]) -> None:
    longest = max(map(len, columns), default=0)
    handles: list[Handle] = []
    labels = []
    for column in columns:
        gap = longest - len(column)
        handles += [sign(style) for _, style in column]
        handles += [Patch(alpha=0.0)] * gap
        labels += [words for words, _ in column] + [""] * gap
    if handles:
        look: Any = {"ncols": len(columns), "loc": "upper left", "frameon": False, "fontsize": SMALL, "handlelength": 3}
        figure.legend(handles, labels, bbox_to_anchor=(0.0, top), **look)
