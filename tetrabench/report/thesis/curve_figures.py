"""The source's figures with curves drawn anew: a panel for each curve, a line for each contestant, today's alone.

The source's text says where something is in them; its pictures have no figures to draw. The line of a contestant whose
answers are wrong is broken.
"""

import math
import textwrap
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import msgspec
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator, StrMethodFormatter

from tetrabench.bench.record import Backend, Results
from tetrabench.report.style import Style, make_styles
from tetrabench.report.thesis.comparison import Comparison, Drawn, DrawnAnew, Panel

WIDTH, HEIGHT = 11.0, 5.2  # inches
SECOND = 2.4  # inches, of a row of counts
LETTERS = 66
"""So many fit into half of the legend's width."""
FAR = 30.0
"""Where times differ by so many times, they are far apart."""
ABOVE = 2.0
"""What is so many times as high as the source's own lines would flatten them."""
MARKS = 10
"""So many points of a line carry its marker, about."""
SAID = "#888888"
THOUSANDS = StrMethodFormatter("{x:,.0f}")


def draw_curves(comparison: Comparison, results: Results) -> dict[str, Figure]:
    """A figure for each of the source's with curves, by a name that a file can have: "figures-12-to-15".

    Args:
        comparison: of some runs with their source.
        results: one of these runs: it knows how the family's contestants look.
    """
    return {file_of(drawn): draw_curve_figure(drawn, results) for drawn in comparison.drawn}


def file_of(drawn: DrawnAnew) -> str:
    """The name of a figure, for a file."""
    return drawn.name.replace(" ", "-")


def draw_curve_figure(drawn: DrawnAnew, results: Results) -> Figure:
    """Panels of one scale side by side; below them a row of what was counted along the runs."""
    styles = _styles(drawn, results)
    rows = 1 + bool(drawn.count)
    figure = Figure(figsize=(WIDTH, HEIGHT + SECOND * (rows - 1)), layout="constrained")
    heights = [HEIGHT, SECOND][:rows]
    grid: Any = figure.subplots(
        rows, len(drawn.panels), sharex=True, sharey="row", squeeze=False, height_ratios=heights
    )
    for axes, panel in zip(grid[0], drawn.panels, strict=True):
        _draw_times(axes, drawn, panel, styles)
    for row in grid[1:]:
        for axes, panel in zip(row, drawn.panels, strict=True):
            _draw_counts(axes, panel, styles)
    grid[0][0].set_ylabel(drawn.up)
    _scale(grid[0][0], drawn)
    if drawn.count:
        grid[1][0].set_ylabel(drawn.count)
        grid[1][0].set_ylim(bottom=0.0)
    for axes in grid[-1]:
        axes.set_xlabel(drawn.across)
    _add_legend(figure, drawn, styles)
    figure.supxlabel(textwrap.fill(_caption(drawn), 175), fontsize=8, color="#444444", x=0.01, ha="left")
    return figure


def _styles(drawn: DrawnAnew, results: Results) -> dict[str, Style]:
    """The looks of all contestants in a figure."""
    backends = {
        line.contestant: Backend(name=line.contestant, contestant=line.contestant, title=line.title, against="")
        for line in _lines(drawn)
    }
    return make_styles(msgspec.structs.replace(results, backends=list(backends.values())))


def _lines(drawn: DrawnAnew) -> Iterable[Drawn]:
    return (line for panel in drawn.panels for line in panel.lines)


def _look(line: Drawn, style: Style) -> dict[str, Any]:
    """Whole where answers are right, broken where they are wrong."""
    every = max(1, len(line.points) // MARKS)
    broken = {"linestyle": "-" if line.is_exact else (0, (5, 3)), "fillstyle": "full" if line.is_exact else "none"}
    return {**style.line, **broken, "markevery": every}


def _draw_times(axes: Axes, drawn: DrawnAnew, panel: Panel, styles: Mapping[str, Style]) -> None:
    """Lines of times, each with what its intervals cover."""
    if drawn.said:
        low, high = drawn.said
        if low < high:
            axes.axvspan(low, high, color="#e8e8e8", zorder=0, linewidth=0)
        else:
            axes.axvline(low, color=SAID, linestyle=":", linewidth=1.2, zorder=0)
        words = axes.text(low, 0.98, f" {drawn.said_words}", transform=axes.get_xaxis_transform())
        words.set(fontsize=8, color="#555555", ha="left", va="top")
    for line in panel.lines:
        style = styles[line.contestant]
        places = [point.place for point in line.points]
        axes.plot(places, [point.time for point in line.points], **_look(line, style))
        known = [point for point in line.points if point.is_whole and point.high is not None]
        axes.fill_between(
            [point.place for point in known],
            [point.low for point in known],
            [point.high or 0.0 for point in known],
            color=style.line["color"],
            alpha=0.15,
            linewidth=0,
        )
    if len(drawn.panels) > 1:
        axes.set_title(f"{panel.name}\n{panel.title}", fontsize=9)
        axes.xaxis.set_major_locator(MaxNLocator(3))
    if drawn.is_log:
        axes.set_xscale("log")
    _tidy(axes)


def _draw_counts(axes: Axes, panel: Panel, styles: Mapping[str, Style]) -> None:
    for line in panel.lines:
        counted = [(point.place, point.count) for point in line.points if point.count is not None]
        if counted:
            axes.plot(*zip(*counted, strict=True), **_look(line, styles[line.contestant]))
    axes.yaxis.set_major_formatter(THOUSANDS)
    _tidy(axes)


def _tidy(axes: Axes) -> None:
    axes.grid(color="#dddddd", linewidth=0.6)
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)


def _scale(axes: Axes, drawn: DrawnAnew) -> None:
    """From zero; logarithmic, beside a logarithmic axis below, where times are far apart."""
    times = [point.time for line in _lines(drawn) for point in line.points]
    if drawn.is_log and max(times) > FAR * min(times):
        axes.set_yscale("log")
    else:
        axes.set_ylim(0.0, 1.1 * _highest(drawn) if leaving(drawn) else None)
    if not drawn.is_log:
        axes.set_xlim(left=0.0)
        axes.xaxis.set_major_formatter(THOUSANDS)


def _highest(drawn: DrawnAnew) -> float:
    """The greatest time of the lines that stand for the source."""
    return max((point.time for line in _lines(drawn) if line.words for point in line.points), default=math.inf)


def leaving(drawn: DrawnAnew) -> list[str]:
    """Whose lines leave the panels, for they are far above those that the figure is about."""
    if drawn.is_log:
        return []
    above = (
        line.contestant
        for line in _lines(drawn)
        if not line.words and max(point.time for point in line.points) > ABOVE * _highest(drawn)
    )
    return list(dict.fromkeys(above))


def _add_legend(figure: Figure, drawn: DrawnAnew, styles: Mapping[str, Style]) -> None:
    """A handle for each contestant, with what it stands for."""
    lines = {line.contestant: line for line in _lines(drawn)}
    axes = figure.axes[0]
    handles = [
        axes.plot([], [], **{**_look(line, styles[name]), "markevery": None}, label=_short(words_of(line)))[0]
        for name, line in lines.items()
    ]
    title = f"{drawn.name.capitalize()} of the source, today: {drawn.caption}"
    look: Any = {"ncols": min(2, len(handles)), "frameon": False, "fontsize": 9, "handlelength": 3}
    figure.legend(handles=handles, title=title, loc="outside upper left", alignment="left", **look)


def _short(words: str) -> str:
    return textwrap.shorten(words, LETTERS, placeholder=" ...")


def words_of(line: Drawn) -> str:
    """A contestant and what it stands for: "NAME: as published (wrong answers)"."""
    words = f"{line.contestant}: {line.words or line.title}"
    return words if line.is_exact else f"{words} (wrong answers)"


def three_digits(time: float) -> str:
    """0.0842, 0.300, 12.4, 1,240."""
    return f"{time:,.0f}" if time >= 100 else f"{time:#.3g}"


def least_of(drawn: DrawnAnew) -> list[str]:
    """Where each line is least, of a figure whose source says where that is, a sentence each."""
    if not drawn.said or drawn.said[0] == drawn.said[1]:
        return []
    return [
        f"{line.contestant} takes least, {three_digits(least.time)}, at {least.place:,.0f}"
        for line in _lines(drawn)
        for least in [min(line.points, key=lambda point: point.time)]
    ]


def _caption(drawn: DrawnAnew) -> str:
    said = []
    if any(point.is_whole for line in _lines(drawn) for point in line.points):
        said.append("Shades: intervals that hold with 95 % for all of a scenario together.")
    if any(not line.is_exact for line in _lines(drawn)):
        said.append("Broken line: its answers are wrong, so it is compared with nothing.")
    if cut := leaving(drawn):
        said.append(f"{' and '.join(cut)}: above the panel, see the table.")
    if least := least_of(drawn):
        said.append(f"{'; '.join(least)}.")
    return " ".join([*said, *_once(f"{panel.about}." for panel in drawn.panels)])


def _once(sentences: Iterable[str]) -> Sequence[str]:
    return list(dict.fromkeys(sentences))
