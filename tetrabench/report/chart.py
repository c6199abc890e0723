"""The charts of a run, after the source's figures 10 and 11: time by scenario, and memory.

Bars that would dwarf all others are cut, marked and labelled with their value.
"""

import textwrap
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch, Polygon
from matplotlib.ticker import MaxNLocator

from tetrabench.bench.record import Results
from tetrabench.bench.statistics import ALIKE, Row, summary
from tetrabench.errors import InputError
from tetrabench.report.memory import bytes_per_item, peak_bytes
from tetrabench.report.style import EDGE, Style, make_styles
from tetrabench.report.table import PROVISIONAL, WORDS, about_machine, about_model
from tetrabench.report.units import duration, singular, times

WIDTH = 11.0  # inches
PANEL = 6  # groups of bars side by side
PANEL_HEIGHT = 2.7  # inches
CUT = 12.0  # a bar more than so many times as high as the reference's dwarfs the others
QUIET, ALARM = "#777777", "#a00000"
Bars = Mapping[str, float | str]  # contestant -> height, or the word that stands where no bar may


def draw_charts(results: Results, folder: Path, suffix: str = ".png") -> list[Path]:
    """Write both charts of a run, `times` and `memory`, in the format of the suffix; their paths.

    Raises:
        InputError: the folder cannot be written to.
    """
    rows = summary(results)
    charts = {"times": draw_times(results, rows), "memory": draw_memory(results, rows)}
    paths = [folder / f"{name}{suffix}" for name in charts]
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for path, figure in zip(paths, charts.values(), strict=True):
            figure.savefig(path, dpi=150)
    except OSError as error:
        raise InputError(f"{error.filename or folder}: cannot write charts: {error.strerror}") from error
    return paths


def draw_times(results: Results, rows: Sequence[Row]) -> Figure:
    """A group of bars a scenario: CPU time as a multiple of the reference's, which stands below it."""
    styles = make_styles(results)
    groups: dict[str, dict[str, float | str]] = {}
    labels: dict[str, str] = {}
    for row in rows:
        groups.setdefault(row.scenario, {})[row.backend] = _height(row)
        if row.backend == results.reference and row.cpu_s is not None:
            labels[row.scenario] = f"{row.scenario}\n{row.backend}: {duration(row.cpu_s)}"
    scenarios = list(groups)
    parts = [scenarios[start : start + PANEL] for start in range(0, len(scenarios), PANEL)] or [[]]
    figure, panels = _make_figure(results, f"CPU time, compared with {results.reference}", len(parts), 1)
    top = find_top(list(groups.values()), 1.0)
    for axes, part in zip(panels, parts, strict=True):
        # within this band nothing is ranked
        axes.axhspan(1 / ALIKE, ALIKE, color="#e9e9e9", zorder=0, linewidth=0)
        axes.axhline(1.0, color=EDGE, linewidth=0.8, zorder=1)
        draw_bars(axes, [groups[name] for name in part], styles, top=top, label=times)
        axes.set_xticks(range(len(part)), [labels.get(name, name) for name in part])
        axes.set_xlim(-0.5, max(1, min(PANEL, len(scenarios))) - 0.5)
        axes.set_ylabel(f"CPU time, multiple of {results.reference}'s")
    return figure


def draw_memory(results: Results, rows: Sequence[Row]) -> Figure:
    """Two panels: the structure for each item of the model, and the high-water mark of the process."""
    styles = make_styles(results)
    item = singular(next(iter(results.model_size), "items"))
    peaks = {name: size / 1e6 for name, size in peak_bytes(list(rows)).items()}
    panels = {
        f"fresh structure, bytes a {item}": bytes_per_item(results),
        "peak of the whole process, MB": peaks,
    }
    figure, axes = _make_figure(results, "memory", 1, 2)
    for panel, (title, sizes) in zip(axes, panels.items(), strict=True):
        groups = [{name: sizes.get(name, "no figure")} for name in styles]
        mark = sizes.get(results.reference) or min(sizes.values(), default=1.0)
        top = find_top(groups, mark)
        draw_bars(panel, groups, styles, top=top, label=lambda size: f"{size:,.0f}", label_all=True)
        panel.set_xticks(range(len(styles)), list(styles))
        panel.set_ylabel(title)
    return figure


def draw_bars(
    axes: Axes,
    groups: Sequence[Bars],
    styles: Mapping[str, Style],
    *,
    top: float,
    label: Callable[[float], str],
    label_all: bool = False,
) -> None:
    """Groups of bars at 0, 1, 2, ...; higher ones than `top` are cut there."""
    for place, bars in enumerate(groups):
        width = min(0.86 / len(bars), 0.6)
        for step, (name, height) in enumerate(bars.items()):
            x = place + (step - (len(bars) - 1) / 2) * width
            if isinstance(height, str):
                colour = QUIET if height not in ("wrong", "crashed", "failed") else ALARM
                word = axes.text(x, 0.03 * top, height, rotation=90, fontsize=8, color=colour)
                word.set(ha="center", va="bottom", bbox={"facecolor": "white", "linewidth": 0, "pad": 1})
                continue
            shown = min(height, top)
            axes.bar(x, shown, 0.92 * width, zorder=2, **styles[name].paint)
            if height > top:
                _draw_break(axes, x, 0.9 * top, width, 0.03 * top)
            if height > top or label_all:
                turned = 0 if label_all else 90  # neighbours that are cut have no room for labels side by side
                word = axes.text(x, shown + 0.02 * top, label(height), rotation=turned, fontsize=8)
                word.set(ha="center", va="bottom")
    axes.set_ylim(0.0, (1.09 if label_all else 1.25) * top)
    axes.spines[["top", "right"]].set_visible(False)
    axes.tick_params(axis="x", length=0)
    axes.yaxis.set_major_locator(MaxNLocator(5))
    axes.grid(axis="y", color="#dddddd", linewidth=0.6, zorder=0)
    axes.set_axisbelow(True)


def find_top(groups: Sequence[Bars], mark: float) -> float:
    """Where bars are cut: a little above the highest of those that do not dwarf `mark`."""
    heights = [height for bars in groups for height in bars.values() if isinstance(height, float)]
    return 1.15 * max([mark, *(height for height in heights if height <= CUT * mark)])


def _height(row: Row) -> float | str:
    """The height of a bar, or the word that stands in its place."""
    if row.verdict in ("reference", "faster", "slower", "about the same") and row.ratio is not None:
        return row.ratio
    return WORDS.get(row.verdict, row.verdict)


def _draw_break(axes: Axes, x: float, y: float, width: float, height: float) -> None:
    """A slanted gap through a bar, with an edge above and below."""
    left, right, slant = x - 0.56 * width, x + 0.56 * width, 0.8 * height
    corners = [(left, y), (right, y + slant), (right, y + slant + height), (left, y + height)]
    axes.add_patch(Polygon(corners, facecolor="white", edgecolor="none", zorder=3))
    for low, high in (corners[:2], corners[:1:-1]):
        axes.plot(*zip(low, high, strict=True), color=EDGE, linewidth=0.9, zorder=4)


def _make_figure(results: Results, title: str, rows: int, columns: int) -> tuple[Figure, list[Axes]]:
    """A figure with its title, its legend and its caption, and room for the panels."""
    columns_of_legend = _legend_columns(make_styles(results))
    above, foot = 0.45 + 0.19 * max(map(len, columns_of_legend), default=0), 0.45  # inches
    height = PANEL_HEIGHT * rows
    figure = Figure(figsize=(WIDTH, above + height + foot), layout="constrained")
    parts: Any = figure.subfigures(3, 1, height_ratios=(above, height, foot))
    heading, body, bottom = parts
    heading.suptitle(f"{results.model}: {title}", x=0.01, ha="left", fontsize=13, fontweight="bold")
    _add_legend(heading, columns_of_legend, top=1 - 0.3 / above)
    caption = f"{about_model(results)}. {about_machine(results)}."
    caption += f" {PROVISIONAL}" if results.provisional else ""
    caption += " Bars with a gap are cut, their value above them; within the grey band nothing is ranked."
    bottom.text(0.01, 0.9, textwrap.fill(caption, 165), ha="left", va="top", fontsize=8, color="#444444")
    return figure, list(body.subplots(rows, columns, squeeze=False).flat)


def _legend_columns(styles: Mapping[str, Style]) -> list[list[tuple[str, Style]]]:
    """A column a layout."""
    layouts = dict.fromkeys(style.layout for style in styles.values())
    return [[(name, style) for name, style in styles.items() if style.layout == layout] for layout in layouts]


def _add_legend(figure: Any, columns: list[list[tuple[str, Style]]], top: float) -> None:
    longest = max(map(len, columns), default=0)
    handles, labels = [], []
    for column in columns:
        gap = longest - len(column)
        handles += [Patch(**style.paint) for _, style in column] + [Patch(alpha=0.0)] * gap
        labels += [f"{name}: {style.title}" for name, style in column] + [""] * gap
    if handles:
        look: Any = {"ncols": len(columns), "loc": "upper left", "frameon": False, "fontsize": 9}
        figure.legend(handles, labels, bbox_to_anchor=(0.0, top), **look)
