"""Charts of lines: what was told along the run, and time over what was chosen."""

from collections.abc import Mapping, Sequence
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import EngFormatter, LogLocator, NullLocator, StrMethodFormatter

from tetrabench.bench.record import Results
from tetrabench.report.canvas import SMALL, Entry, arranged, make_figure
from tetrabench.report.curves import Curve, Curves, spans
from tetrabench.report.lines import Line
from tetrabench.report.notes import FOREIGN, about_machine
from tetrabench.report.series import Course
from tetrabench.report.style import EDGE, Style, make_styles
from tetrabench.report.units import duration, plural

ASIDE = 3  # panels side by side
MARKS = 8  # along a line, so that it is known without its colour
COLUMNS = 3  # of a legend
DASHED = (0, (6, 4))  # who is known to be wrong
LARGE = 10_000  # counts from here on are in thousands, or in millions
TICKS = 12  # values that all have a tick of their own
RING: dict[str, Any] = {"color": EDGE, "marker": "o", "markersize": 13, "fillstyle": "none", "gid": "least"}
Look = dict[str, Any]


def draw_series(results: Results, course: Course) -> Figure:
    """A panel for each quantity, a line for each backend; times are of one step."""
    styles = make_styles(results)
    looks = {line.label: _look(styles[line.backend.name], line.is_wrong) for line in course.lines}
    quantities = course.quantities
    title = f"{course.model}, {course.task}: along the run"
    rows, columns = -(-len(quantities) // ASIDE), min(ASIDE, len(quantities))
    figure, panels = make_figure(results, title, _about_series(results, course), _legend(looks), rows, columns)
    for axes, quantity in zip(panels, quantities, strict=False):
        tracks = [track for track in course.tracks if track.quantity == quantity]
        for track in tracks:
            every = max(1, len(track.places) // MARKS)
            axes.plot(track.places, track.values, markevery=every, **looks[track.line.label])
        _finish(axes, [value for track in tracks for value in track.values], is_time=quantities[quantity])
        axes.set_title(course.heading(quantity), fontsize=10)
        axes.set_xlabel(course.axis)
    for axes in panels[len(quantities) :]:
        axes.set_axis_off()
    return figure


def draw_curves(results: Results, curves: Curves) -> Figure:
    """A line for each curve; a level line for each contestant that has no such option."""
    styles = make_styles(results)
    looks = {curve.label: _look(styles[curve.key.backend.name], curve.is_wrong) for curve in curves.curves}
    of = f" of {curves.contestant}" if curves.contestant else ""
    title = f"{curves.model}, {curves.task}: time of an item over {curves.option}{of}"
    figure, (axes,) = make_figure(results, title, _about_curves(results, curves), _legend(looks), 1, 1)
    for curve in curves.curves:
        _draw_curve(axes, curves.option, curve, looks[curve.label])
    for level, at in zip(curves.levels, curves.label_seconds, strict=True):
        look = _look(styles[level.key.backend.name], level.is_wrong) | {"marker": "", "linewidth": 1.0, "gid": "level"}
        axes.axhline(level.points[0].seconds, **look)
        axes.text(1.01, at, level.label, transform=axes.get_yaxis_transform(), fontsize=SMALL, va="center")
    _finish(axes, [point.seconds for point in curves.points], is_time=True)
    axes.set_xlabel(curves.option)
    axes.set_ylabel("time of an item")
    if curves.is_wide:
        axes.set_xscale("log")
        axes.xaxis.set_minor_locator(NullLocator())
        axes.xaxis.set_major_locator(LogLocator(subs=(1, 2, 5), numticks=99))
        axes.xaxis.set_major_formatter(EngFormatter(sep=""))
    if len(curves.values) <= TICKS:
        axes.set_xticks(curves.values, [f"{value:,}" for value in curves.values])
    return figure


def _draw_curve(axes: Axes, option: str, curve: Curve, look: Look) -> None:
    """Its points, with the range of the launches; the least in a ring, hollow what is shown to be slower than that."""
    axes.plot([one.value for one in curve.points], [one.seconds for one in curve.points], **{**look, "marker": ""})
    for point in curve.points:
        fill: Look = {"linestyle": "none", "fillstyle": "none" if point.is_beaten or curve.is_wrong else "full"}
        axes.plot([point.value], [point.seconds], **{**look, **fill})
        if point.low < point.high:
            ends = [point.low, point.high]
            axes.plot([point.value] * 2, ends, color=look["color"], linewidth=1.6, alpha=0.6, gid="whisker")
        if point.is_least:
            axes.plot([point.value], [point.seconds], **RING)
            words = f"{option}={point.value}: {duration(point.seconds)}"
            above: Look = {"xytext": (0, 11), "textcoords": "offset points", "ha": "center"}
            axes.annotate(words, (point.value, point.seconds), fontsize=8, **above)


def _look(style: Style, is_wrong: bool) -> Look:
    """What draws a line."""
    return style.line | ({"linestyle": DASHED, "linewidth": 1.1} if is_wrong else {})


def _legend(looks: Mapping[str, Look]) -> list[list[Entry]]:
    """The labels, read from the top in each column."""
    entries = [Entry(label, (Line2D([], [], **look),)) for label, look in looks.items()]
    deep = -(-len(entries) // COLUMNS)
    return arranged([entries[start : start + deep] for start in range(0, len(entries), deep)])


def _finish(axes: Axes, values: Sequence[float], *, is_time: bool) -> None:
    """A scale from zero, or where times span too much for that a logarithmic one."""
    axes.grid(color="#dddddd", linewidth=0.6)
    axes.spines[["top", "right"]].set_visible(False)
    if is_time and spans(values):
        axes.set_yscale("log")
        axes.yaxis.set_major_locator(LogLocator(subs=(1, 2, 5), numticks=99))
        axes.yaxis.set_minor_locator(NullLocator())
    else:
        axes.set_ylim(0.0, 1.08 * max(values) or 1.0)
    if is_time:
        axes.yaxis.set_major_formatter(EngFormatter(unit="s"))
    else:
        axes.yaxis.set_major_formatter(EngFormatter(sep="") if max(values) >= LARGE else StrMethodFormatter("{x:,g}"))


def _about_series(results: Results, course: Course) -> str:
    samples = max(len(line.samples) for line in course.lines)
    middle = f", medians of {samples} samples" if samples > 1 else ""
    said = f"{about_machine(results)}. Times are of one {course.axis}{middle}; counts are those of the first sample."
    if course.left_out:
        said += f" {plural(course.left_out, 'backend')} with other options {'is' if course.left_out == 1 else 'are'} not drawn."
    return said + _about_wrong(course.lines)


def _about_curves(results: Results, curves: Curves) -> str:
    said = [f"{about_machine(results)}. Medians of all samples; less is better."]
    if any(point.low < point.high for point in curves.points):
        said.append("Whiskers: the range of the launches.")
    if curves.contestant:
        said.append("In a ring: the least of its line. Hollow: shown to be slower than that; all others are not.")
    if curves.levels:
        said.append("Level lines: who has no such option, with the options at which it is quickest.")
    if any("*" in level.label for level in curves.levels) and not any("*" in curve.label for curve in curves.curves):
        said.append(FOREIGN)  # else the legend has it
    if curves.beyond:
        far = [f"{level.label} {duration(level.points[0].seconds)}" for level in curves.beyond]
        said.append(f"Beyond the chart: {', '.join(far)}.")
    return " ".join(said) + _about_wrong([point.line for point in curves.points])


def _about_wrong(lines: Sequence[Line]) -> str:
    return " (wrong answers): known to be so, and ranked nowhere." if any(line.is_wrong for line in lines) else ""
