"""The charts of a run: time by task and memory, after the source's figures 10 and 11, and growth over sizes."""

import re
import textwrap
from collections.abc import Sequence
from functools import cache
from pathlib import Path

from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from tetrabench.bench.record import Results
from tetrabench.bench.statistics import ALIKE, CLEAR, Row, summary, summary_against
from tetrabench.errors import InputError
from tetrabench.printable import printable
from tetrabench.report.bars import draw_bars
from tetrabench.report.canvas import SMALL, WIDTH, Sign, legend_of, make_figure
from tetrabench.report.cells import MISSING, ratio_of, word_of
from tetrabench.report.curves import curves_over_counts, curves_over_options
from tetrabench.report.dots import CONTROL, Dot, draw_dots, find_ends
from tetrabench.report.line_charts import draw_curves, draw_series
from tetrabench.report.memory import memory_of
from tetrabench.report.notes import about_clock, about_machine, fewer_than_asked
from tetrabench.report.parts import Part, make_parts
from tetrabench.report.plain import no_formula, plain
from tetrabench.report.series import courses_of
from tetrabench.report.style import EDGE, Style, make_styles
from tetrabench.report.units import counted, duration, one_of

PANEL = 6  # groups of dots side by side
DOTS = 48  # dots, or bars, side by side
CURVES = 4  # panels of curves side by side
NO_FILE = r'[\s/\\:*?"<>|]'  # signs that no file is to have in its name, wherever it lies
LETTER = 0.09  # inches, of a name below a bar


def draw_charts(results: Results, folder: Path, suffix: str = ".png") -> list[Path]:
    """Write the charts of a run in the format of the suffix; their paths.

    `times` and `memory`, for each model (and each reference) where there are several; `growth` over several sizes;
    `series` of each model and task, of what was told along the run; `option` over each option of a contestant that has
    several values, and over each count of a scenario.

    Raises:
        InputError: the folder cannot be written to.
    """
    results = plain(results, no_formula)
    rows = summary(results)
    charts: dict[str, Figure] = {}
    for part in make_parts(results, rows):
        charts["-".join(filter(None, ("times", part.name)))] = draw_times(part)
        if memory_of(part):
            charts["-".join(filter(None, ("memory", part.name)))] = draw_memory(part)
    if len({next(iter(model.size.values()), 0) for model in results.models}) > 1:
        charts["growth"] = draw_growth(results, rows)
    for course in courses_of(results, rows):
        charts[f"series-{course.model}-{course.task}"] = draw_series(results, course)
    against = cache(lambda base: summary_against(results, base))
    for curves in curves_over_options(results, rows, against) + curves_over_counts(results, rows):
        words = ("option", curves.model, curves.task, curves.contestant, curves.option)
        charts["-".join(filter(None, words))] = draw_curves(results, curves)
    paths = [folder / f"{re.sub(NO_FILE, '-', printable(name))}{suffix}" for name in charts]
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
    aside = min(PANEL, max(1, DOTS // max(1, len(styles))))
    pieces = [tasks[start : start + aside] for start in range(0, len(tasks), aside)] or [[]]
    title = f"{part.model.name}: time, compared with {part.reference}"
    dots = [dot for group in groups.values() for dot in group.values()]
    is_compared = any(
        dot.ratio is not None for dots in groups.values() for name, dot in dots.items() if name != part.reference
    )
    caption = _times_caption(part, dots, is_compared=is_compared)
    figure, panels = make_figure(part.results, title, caption, legend_of(styles, _dot_sign), len(pieces), 1)
    band = ALIKE if part.has_intervals else CLEAR
    ends = find_ends(list(groups.values()))
    for axes, piece in zip(panels, pieces, strict=True):
        if is_compared:
            axes.axhspan(1 / band, band, color="#ececec", zorder=0, linewidth=0)
        axes.axhline(1.0, color=EDGE, linewidth=0.8, zorder=1)
        draw_dots(axes, [groups[task] for task in piece], styles, ends)
        axes.set_xticks(range(len(piece)), [_label(part, task) for task in piece])
        axes.set_xlim(-0.5, max(1, min(aside, len(tasks))) - 0.5)
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
    title = f"{part.model.name}: memory"
    aside = len(kinds) if len(kinds) * len(styles) <= DOTS else 1
    legend = legend_of(styles, _bar_sign)
    figure, panels = make_figure(part.results, title, caption, legend, len(kinds) // aside, aside)
    top = max(size for sizes in kinds.values() for size in sizes.values() if not isinstance(size, str))
    for axes, (kind, sizes) in zip(panels, kinds.items(), strict=True):
        draw_bars(axes, {name: sizes[name] for name in styles}, styles, top=top)
        axes.set_title(titles[kind], fontsize=10)
        if LETTER * max(len(style.name) for style in styles.values()) > 0.7 * WIDTH / aside / len(styles):
            axes.tick_params(axis="x", labelrotation=90, labelsize=SMALL)
    for axes in panels[::aside]:
        axes.set_ylabel(f"bytes {one_of(part.item)}")
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
    columns = min(CURVES, max(1, len(tasks)))
    figure, panels = make_figure(results, title, caption, legend_of(styles, _line_sign), height, columns)
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


def _dot_sign(style: Style) -> Sign:
    return Line2D([], [], **style.dot)


def _line_sign(style: Style) -> Sign:
    return Line2D([], [], **style.line)


def _bar_sign(style: Style) -> Sign:
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
