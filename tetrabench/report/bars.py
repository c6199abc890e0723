"""A group of bars from zero, each with its figure above it, or a word where there is none."""

from collections.abc import Iterator, Mapping

from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from tetrabench.report.style import Style

QUIET, ALARM = "#777777", "#a00000"
MOST = 12  # figures that stand upright side by side
QUIET_WORDS = ("too short", "skipped", "cannot", "no ref.", "no figure", "missing")


def draw_bars(axes: Axes, sizes: Mapping[str, float | str], styles: Mapping[str, Style], *, top: float) -> None:
    """A bar for each contestant, under its name; all fit below `top`."""
    spots = list(places(0, len(sizes)))
    for x, (name, size) in zip(spots, sizes.items(), strict=True):
        if isinstance(size, str):
            write_word(axes, x, size)
        else:
            axes.bar(x, size, 0.92 * width_of(len(sizes)), zorder=2, **styles[name].paint)
            turned = 90 if len(sizes) > MOST else 0
            axes.text(x, size + 0.02 * top, f"{size:,.0f}", fontsize=8, ha="center", va="bottom", rotation=turned)
    axes.set_xticks(spots, [styles[name].name for name in sizes])
    axes.set_xlim(-0.5, 0.5)
    axes.set_ylim(0.0, (1.3 if len(sizes) > MOST else 1.12) * top)
    axes.spines[["top", "right"]].set_visible(False)
    axes.tick_params(axis="x", length=0)
    axes.yaxis.set_major_locator(MaxNLocator(5))
    axes.grid(axis="y", color="#dddddd", linewidth=0.6, zorder=0)
    axes.set_axisbelow(True)


def width_of(number: int) -> float:
    """The width of one of so many in a group; groups are 1 apart."""
    return min(0.86 / max(1, number), 0.6)


def places(group: float, number: int) -> Iterator[float]:
    """Where those of a group stand."""
    return (group + (step - (number - 1) / 2) * width_of(number) for step in range(number))


def write_word(axes: Axes, x: float, text: str) -> None:
    """What stands at a place where no figure may."""
    colour = QUIET if text in QUIET_WORDS else ALARM
    word = axes.text(x, 0.03, text, rotation=90, fontsize=8, color=colour, transform=axes.get_xaxis_transform())
    word.set(ha="center", va="bottom", bbox={"facecolor": "white", "linewidth": 0, "pad": 1}, zorder=3)
