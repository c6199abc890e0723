"""Ratios in groups: a dot each on a logarithmic axis, half and twice at the same distance from 1; hollow where it ranks
nothing.

A stem joins a dot to 1. It is as long as the ratio is far from 1, while the length of a bar on such an axis would depend
on where the axis happens to begin.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from matplotlib.axes import Axes
from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator

from tetrabench.report.bars import places, write_word
from tetrabench.report.style import EDGE, Style

CONTROL = "#9a9a9a"
FAR = 1.5  # beyond this, either way, a dot carries its figure
LETTER, MARGIN = 0.045, 0.06  # shares of the span of all dots that a letter of such a figure takes, and half a dot
NEAR = 2.0  # the axis reaches so far at least, either way
Ends = tuple[float, float]


@dataclass(frozen=True)
class Dot:
    """What stands at a contestant's place.

    Attributes:
        ratio: None where no dot may stand, but the label.
        interval: its ends; control: those of the second copy, on the dot of the reference.
        label: stands at a dot that is far from 1, and in place of one that is not there.
        is_solid: whether it ranks; others are hollow.
    """

    ratio: float | None
    interval: Ends | None = None
    control: Ends | None = None
    label: str = ""
    is_solid: bool = True

    @property
    def whiskers(self) -> Iterator[tuple[Ends, str]]:
        """Intervals that have a width, with their colours."""
        for ends, colour in ((self.interval, EDGE), (self.control, CONTROL)):
            if ends is not None and ends[1] > ends[0]:
                yield ends, colour

    @property
    def extent(self) -> Ends:
        """From where to where it reaches with its whiskers, but for its figure."""
        shown = [self.ratio or 1.0, *(end for ends, _ in self.whiskers for end in ends)]
        return min(shown), max(shown)

    @property
    def is_far(self) -> bool:
        """Whether it carries its figure."""
        return self.ratio is not None and not 1 / FAR <= self.ratio <= FAR


Dots = Mapping[str, Dot]  # by contestant


def draw_dots(axes: Axes, groups: Sequence[Dots], styles: Mapping[str, Style], ends: Ends) -> None:
    """Groups of dots at 0, 1, 2, ... on an axis with these ends."""
    axes.set_yscale("log")
    axes.set_ylim(ends)
    for place, dots in enumerate(groups):
        for x, (name, dot) in zip(places(place, len(dots)), dots.items(), strict=True):
            if dot.ratio is None:
                write_word(axes, x, dot.label)
            else:
                _draw_dot(axes, x, dot, dot.ratio, styles[name])
    axes.spines[["top", "right"]].set_visible(False)
    axes.tick_params(axis="x", length=0)
    axes.yaxis.set_major_locator(LogLocator(subs=_ticks(ends), numticks=99))
    axes.yaxis.set_minor_locator(NullLocator())
    axes.yaxis.set_major_formatter(FuncFormatter(lambda ratio, _: f"{ratio:,.6g}x"))
    axes.grid(axis="y", color="#dddddd", linewidth=0.6, zorder=0)
    axes.set_axisbelow(True)


def find_ends(groups: Sequence[Dots]) -> Ends:
    """The ends of an axis that has room for all dots, their whiskers and their figures."""
    dots = [dot for group in groups for dot in group.values()]
    lows, highs = zip((1 / NEAR, NEAR), *(dot.extent for dot in dots), strict=True)
    span = math.log(max(highs) / min(lows))
    for dot in dots:
        low, high = dot.extent
        figure = LETTER * len(dot.label) * dot.is_far
        is_above = dot.ratio is not None and dot.ratio > 1
        lows += (low * math.exp(-span * (MARGIN + (0 if is_above else figure))),)
        highs += (high * math.exp(span * (MARGIN + (figure if is_above else 0))),)
    return min(lows), max(highs)


def _ticks(ends: Ends) -> tuple[float, ...]:
    """The figures of a decade that stand at the axis: the fewer, the more decades there are."""
    decades = math.log10(ends[1] / ends[0])
    return (1, 1.5, 2, 3, 5, 7) if decades < 1.5 else (1, 2, 5) if decades < 5 else (1,)


def _draw_dot(axes: Axes, x: float, dot: Dot, ratio: float, style: Style) -> None:
    axes.plot([x, x], [1.0, ratio], color=style.dot["color"], linewidth=3, alpha=0.35, zorder=2, solid_capstyle="butt")
    inside: dict[str, Any] = {} if dot.is_solid else {"markerfacecolor": "white"}
    axes.plot([x], [ratio], zorder=5, **style.dot, **inside)
    for (low, high), colour in dot.whiskers:
        axes.plot([x, x], [low, high], color=colour, linewidth=1.6, zorder=4, gid="whisker")
    if dot.is_far:  # neighbours have no room for figures side by side
        (low, high) = dot.extent
        at, gap, side = (high, 6, "bottom") if ratio > 1 else (low, -6, "top")
        axes.annotate(
            dot.label, (x, at), (0, gap), textcoords="offset points", rotation=90, fontsize=8, ha="center", va=side
        )
