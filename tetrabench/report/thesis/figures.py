"""The source's figures drawn anew: a group of bars for each task, 2011's above, today's below, all in multiples of the
source's reference.

As the source did, a bar that is far beyond all others is cut, so that these can be seen: it carries a break, and its
figure. Every bar carries its figure anyway, as a table would spell it; where none may stand there is a word.
"""

import dataclasses
import hashlib
import io
import re
import textwrap
from collections.abc import Iterable, Mapping, Sequence
from html import escape
from pathlib import Path
from typing import Any

import matplotlib
import msgspec
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator

from tetrabench.bench.record import Backend, Results
from tetrabench.errors import InputError
from tetrabench.report.bars import places, width_of, write_word
from tetrabench.report.cells import MISSING
from tetrabench.report.style import EDGE, Style, make_styles
from tetrabench.report.thesis.comparison import Comparison, Entry, Subject
from tetrabench.report.units import two_digits

CUT = 12.0
"""A bar beyond this is cut."""
SIZE = (11.0, 7.6)  # inches
LETTERS = 9.0  # of a figure on end, what it takes of the height of a panel is 1 / LETTERS
LEGEND, HANDLE = 170, 6  # letters that fit side by side into the legend, and those that a handle takes
NO_FIGURE = "no figure"


def draw_figures(comparison: Comparison, results: Results) -> dict[str, Figure]:
    """A figure for each model of the comparison, by a name that a file can have: "figure-10-nozzle-shuffled".

    Args:
        comparison: of some runs with their source.
        results: one of these runs: it knows how the family's contestants look.
    """
    styles = _styles(comparison, results)
    return {name_of(subject): draw_figure(comparison, subject, styles) for subject in comparison.subjects}


def name_of(subject: Subject) -> str:
    """The name of a model's figure, for a file."""
    return re.sub(r"\W+", "-", f"{subject.figure} {subject.name}").strip("-")


def draw_figure(comparison: Comparison, subject: Subject, styles: Mapping[str, Style]) -> Figure:
    """Two panels of one scale."""
    figure = Figure(figsize=SIZE, layout="constrained")
    panels: Any = figure.subplots(2, 1, sharey=True)
    bars = [
        [[_then(comparison, subject, task, one) for one in styles] for task in comparison.tasks],
        [[_today(subject.entry(task, one)) for one in styles] for task in comparison.tasks],
    ]
    top = _top(bar for panel in bars for group in panel for bar in group)
    titles = [
        f"{comparison.year}, {subject.figure}: {subject.then_title}",
        f"today: {subject.title}",
    ]
    for axes, title, groups in zip(panels, titles, bars, strict=True):
        _draw_panel(axes, comparison.tasks, groups, list(styles.values()), top)
        axes.set_title(textwrap.shorten(title, 120), fontsize=10, loc="left")
        axes.set_ylabel(f"time, multiple of {comparison.reference}'s")
    _add_legend(figure, styles)
    figure.supxlabel(_caption(comparison, subject), fontsize=8, color="#444444", x=0.01, ha="left")
    return figure


def save_figures(figures: Mapping[str, Figure], folder: Path, suffix: str = ".png") -> dict[str, Path]:
    """Write figures in the format of the suffix; their paths by name.

    Raises:
        InputError: the folder cannot be written to.
    """
    paths = {name: folder / f"{name}{suffix}" for name in figures}
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for name, path in paths.items():
            figures[name].savefig(path, dpi=150)
    except OSError as error:
        raise InputError(f"{error.filename or folder}: cannot write figures: {error.strerror}") from error
    return paths


def as_svg(figure: Figure, title: str) -> str:
    """A figure as an element of a page: the same for the same figure, its words as text; `title` is for those who
    cannot see it."""
    page = io.StringIO()
    with matplotlib.rc_context({"svg.fonttype": "none", "svg.hashsalt": title}):
        figure.savefig(page, format="svg", metadata={"Date": None, "Creator": None, "Format": None, "Type": None})
    element = page.getvalue()[page.getvalue().index("<svg ") :]
    element = re.sub(r' d="[^"]*"', lambda path: " ".join(re.sub(r"(\.\d)\d+", r"\1", path[0]).split("\n")), element)
    element = re.sub(r' (width|height)="[\d.]+pt"', "", element, count=2)  # as wide as its place on the page
    element = _once(element, title)
    named = set(re.findall(r'(?:url\(#|href="#)([^)"]+)', element))  # a page may hold several figures: no other names
    element = re.sub(r' id="([^"]*)"', lambda name: name[0] if name[1] in named else "", element)
    return element.replace("<svg ", f'<svg role="img" aria-label="{escape(title)}" ', 1)


def _once(element: str, title: str) -> str:
    """The same with each long path spelled once: a hatch of dots is one, for each contestant that has it."""
    for path in dict.fromkeys(re.findall(r'd="([^"]{2000,})"', element)):
        if element.count(path) > 1:
            name = f"path{hashlib.sha256((title + path).encode()).hexdigest()[:12]}"
            element = element.replace(f'<path d="{path}"', f'<use href="#{name}"')
            element = element.replace("<defs>", f'<defs><path id="{name}" d="{path}"/>', 1)
    return element


def _styles(comparison: Comparison, results: Results) -> dict[str, Style]:
    """The looks of the source's contestants, whoever takes part in the run."""
    backends = [
        Backend(name=name, contestant=name, title=title, against=comparison.reference)
        for name, title in comparison.contestants.items()
    ]
    styles = make_styles(msgspec.structs.replace(results, backends=backends))
    # a page spells out each dot of a hatch: a quarter of them will do
    sparse = {
        name: {**style.paint, "hatch": style.paint["hatch"].replace("....", "..")} for name, style in styles.items()
    }
    return {name: dataclasses.replace(style, paint=sparse[name]) for name, style in styles.items()}


class Bar(msgspec.Struct, frozen=True):
    """A multiple and what is written at it; the word alone where there is none.

    Attributes:
        is_sure: whether it may be ranked; others are pale.
        ends: of its interval.
    """

    ratio: float | None
    label: str
    is_sure: bool = True
    ends: tuple[float, float] | None = None


def _then(comparison: Comparison, subject: Subject, task: str, contestant: str) -> Bar:
    entry = subject.entry(task, contestant)
    ratio = entry.then_ratio
    if ratio is None:
        return Bar(None, NO_FIGURE)
    if contestant == comparison.reference:
        return Bar(ratio, "1")
    return Bar(ratio, two_digits(ratio) + "?" * entry.is_coarse, is_sure=not entry.is_coarse)


def _today(entry: Entry) -> Bar:
    if entry.ratio is None:
        return Bar(None, entry.sign if entry.sign != MISSING else NO_FIGURE)
    is_sure = entry.verdict not in ("about", "inconclusive")
    sign = entry.sign if is_sure else f"{two_digits(entry.ratio)}?"
    ends = (entry.low, entry.high) if entry.is_whole and entry.low and entry.high else None
    return Bar(entry.ratio, "1" if entry.sign == "~1" else sign.removesuffix("x"), is_sure, ends)


def _top(bars: Iterable[Bar]) -> float:
    """Where the axis ends: above the largest bar that is not cut, and its whisker."""
    shown = [bar for bar in bars if bar.ratio is not None and bar.ratio <= CUT]
    return max((min(CUT, end) for bar in shown for end in (bar.ratio or 0.0, *(bar.ends or ()))), default=1.0)


def _draw_panel(
    axes: Axes, tasks: Sequence[str], groups: Sequence[Sequence[Bar]], styles: Sequence[Style], top: float
) -> None:
    head = top * (1 + 2.4 / LETTERS)
    width = width_of(len(styles))
    for group, bars in enumerate(groups):
        for x, bar, style in zip(places(group, len(bars)), bars, styles, strict=True):
            if bar.ratio is None:
                write_word(axes, x, bar.label)
            else:
                _draw_bar(axes, x, bar, bar.ratio, style, width, top)
    axes.axhline(1.0, color=EDGE, linewidth=0.8, zorder=3)
    axes.set_xticks(range(len(tasks)), [textwrap.fill(task, 18) for task in tasks])
    axes.set_xlim(-0.5, len(tasks) - 0.5)
    axes.set_ylim(0.0, head)
    axes.yaxis.set_major_locator(MaxNLocator(6, steps=[1, 2, 5, 10]))
    axes.tick_params(axis="x", length=0)
    axes.spines[["top", "right"]].set_visible(False)
    axes.grid(axis="y", color="#dddddd", linewidth=0.6, zorder=0)
    axes.set_axisbelow(True)


def _draw_bar(axes: Axes, x: float, bar: Bar, ratio: float, style: Style, width: float, top: float) -> None:
    is_cut = ratio > CUT
    height = 1.06 * top if is_cut else ratio
    pale: dict[str, Any] = {} if bar.is_sure else {"alpha": 0.4}
    axes.bar(x, height, 0.92 * width, zorder=2, **style.paint, **pale)
    above = height
    if is_cut:
        _break(axes, x, 0.84 * height, width, top)
    elif bar.ends is not None:
        low, high = bar.ends
        axes.plot([x, x], [low, min(high, 1.06 * top)], color="black", linewidth=1.4, zorder=4, gid="whisker")
        above = max(above, min(high, 1.06 * top))
    weight = "bold" if is_cut else "normal"
    axes.text(
        x,
        max(above, 1.0) + 0.015 * top,
        bar.label,
        rotation=90,
        fontsize=8,
        fontweight=weight,
        ha="center",
        va="bottom",
        zorder=5,
    )


def _break(axes: Axes, x: float, y: float, width: float, top: float) -> None:
    """Two slanted lines with nothing between them: here a bar was cut."""
    half, rise, gap = 0.62 * width, 0.025 * top, 0.03 * top
    ends = [x - half, x + half]
    axes.fill_between(
        ends, [y - rise, y + rise], [y - rise + gap, y + rise + gap], color="white", zorder=3, linewidth=0
    )
    for step in (0.0, gap):
        axes.plot(ends, [y - rise + step, y + rise + step], color=EDGE, linewidth=1.0, zorder=4, gid="break")


def _add_legend(figure: Figure, styles: Mapping[str, Style]) -> None:
    """A column a layout; one column in all where these are too wide."""
    layouts: dict[str, list[Style]] = {}
    for style in styles.values():
        layouts.setdefault(style.layout, []).append(style)
    widest = max(len(f"{style.name}: {style.title}") for style in styles.values())
    if len(layouts) * (widest + HANDLE) > LEGEND:
        layouts = {"": list(styles.values())}
    longest = max(map(len, layouts.values()))
    entries = [
        (Patch(**style.paint), f"{style.name}: {style.title}") if style else (Patch(alpha=0.0), "")
        for column in layouts.values()
        for style in [*column, *[None] * (longest - len(column))]
    ]
    look: Any = {"ncols": len(layouts), "frameon": False, "fontsize": 9, "handlelength": 3}
    figure.legend(*zip(*entries, strict=True), loc="outside upper left", **look)


def _caption(comparison: Comparison, subject: Subject) -> str:
    said = [f"Less is better; {comparison.reference} is 1. A bar beyond {CUT:g} is cut, as the source cut its longest."]
    today = [entry for entry in subject.entries if entry.ratio is not None]
    if any(entry.is_whole for entry in today):
        said.append("Whiskers: intervals that hold with 95 % for all of a scenario together.")
    if any(entry.verdict in ("about", "inconclusive") for entry in today):
        said.append("Pale, with a question mark: not ranked.")
    if any(entry.is_coarse for entry in subject.entries):
        said.append(f"{comparison.year}, with a question mark: a few ticks of its timer.")
    if any(entry.sign.startswith((">", "<")) for entry in today):
        said.append(">: at least so many times, in every launch.")
    if any(entry.verdict == "too short" for entry in subject.entries):
        said.append("Too short: under 5 ms, says nothing.")
    if subject.counts:
        said.append("Counts: " + "; ".join(f"{task} {counts}" for task, counts in subject.counts.items()) + ".")
    said.append(f"{subject.machine}. {comparison.year}: {comparison.then_machine}.")
    return textwrap.fill(" ".join(said), 175)
