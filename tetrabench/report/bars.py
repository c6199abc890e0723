"""Bars in groups: with their intervals, cut where they would dwarf all others, hollow where they rank nothing."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from matplotlib.axes import Axes
from matplotlib.patches import Polygon
from matplotlib.ticker import MaxNLocator

from tetrabench.report.style import EDGE, Style

CUT = 12.0  # a bar more than so many times as high as the reference's dwarfs the others
QUIET, ALARM = "#777777", "#a00000"
CONTROL = "#9a9a9a"
QUIET_WORDS = ("too short", "skipped", "cannot", "no ref.", "no figure")
Ends = tuple[float, float]


@dataclass(frozen=True)
class Bar:
    """What stands at a contestant's place.

    Attributes:
        height: None where no bar may stand, but the label.
        interval: its ends; control: those of the second copy, on the bar of the reference.
        label: stands above a bar that is cut, and in place of one that is not there.
        is_solid: whether it ranks; others are hollow.
        is_labelled: whether the label stands there in any case.
    """

    height: float | None
    interval: Ends | None = None
    control: Ends | None = None
    label: str = ""
    is_solid: bool = True
    is_labelled: bool = False


Bars = Mapping[str, Bar]  # by contestant


def draw_bars(axes: Axes, groups: Sequence[Bars], styles: Mapping[str, Style], *, top: float) -> None:
    """Groups of bars at 0, 1, 2, ...; higher ones than `top` are cut there."""
    for place, bars in enumerate(groups):
        width = min(0.86 / max(1, len(bars)), 0.6)
        for step, (name, bar) in enumerate(bars.items()):
            x = place + (step - (len(bars) - 1) / 2) * width
            if bar.height is None:
                _write_word(axes, x, bar.label, top)
            else:
                _draw_bar(axes, x, bar, bar.height, width, styles[name], top)
    is_labelled = any(bar.is_labelled for bars in groups for bar in bars.values())
    axes.set_ylim(0.0, (1.09 if is_labelled else 1.25) * top)
    axes.spines[["top", "right"]].set_visible(False)
    axes.tick_params(axis="x", length=0)
    axes.yaxis.set_major_locator(MaxNLocator(5))
    axes.grid(axis="y", color="#dddddd", linewidth=0.6, zorder=0)
    axes.set_axisbelow(True)


def find_top(groups: Sequence[Bars], mark: float) -> float:
    """Where bars are cut: a little above the highest of those that do not dwarf `mark`."""
    heights = [bar.height for bars in groups for bar in bars.values() if bar.height is not None]
    return 1.15 * max([mark, *(height for height in heights if height <= CUT * mark)])


def _draw_bar(axes: Axes, x: float, bar: Bar, height: float, width: float, style: Style, top: float) -> None:
    shown = min(height, top)
    hollow: dict[str, Any] = (
        {} if bar.is_solid else {"facecolor": "white", "edgecolor": style.line["color"], "linewidth": 1.2}
    )
    axes.bar(x, shown, 0.92 * width, zorder=2, **style.paint | hollow)
    if height > top:
        _draw_break(axes, x, 0.9 * top, width, 0.03 * top)
    elif bar.interval is not None:
        _draw_whisker(axes, x, bar.interval[0], min(bar.interval[1], top), EDGE)
    if bar.control is not None:
        _draw_whisker(axes, x, bar.control[0], min(bar.control[1], top), CONTROL)
    if height > top or bar.is_labelled:
        turned = 0 if bar.is_labelled else 90  # neighbours that are cut have no room for labels side by side
        word = axes.text(x, shown + 0.02 * top, bar.label, rotation=turned, fontsize=8)
        word.set(ha="center", va="bottom")


def _draw_whisker(axes: Axes, x: float, low: float, high: float, colour: str) -> None:
    """An interval; none where it has no width."""
    if high > low:
        axes.plot([x, x], [low, high], color="white", linewidth=2.8, zorder=5, solid_capstyle="butt")  # over hatches
        axes.plot([x, x], [low, high], color=colour, linewidth=1.4, marker="_", markersize=6, zorder=6)


def _write_word(axes: Axes, x: float, text: str, top: float) -> None:
    colour = QUIET if text in QUIET_WORDS else ALARM
    word = axes.text(x, 0.03 * top, text, rotation=90, fontsize=8, color=colour)
    word.set(ha="center", va="bottom", bbox={"facecolor": "white", "linewidth": 0, "pad": 1})


def _draw_break(axes: Axes, x: float, y: float, width: float, height: float) -> None:
    """A slanted gap through a bar, with an edge above and below."""
    left, right, slant = x - 0.56 * width, x + 0.56 * width, 0.8 * height
    corners = [(left, y), (right, y + slant), (right, y + slant + height), (left, y + height)]
    axes.add_patch(Polygon(corners, facecolor="white", edgecolor="none", zorder=3))
    for low, high in (corners[:2], corners[:1:-1]):
        axes.plot(*zip(low, high, strict=True), color=EDGE, linewidth=0.9, zorder=4)
