"""The picture of docs/measuring.md: the ratios of equal codes, and how often a slowdown is caught, tool beside tool."""

from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from tests.measuring.page import PAGE, verdicts
from tests.measuring.record import FOLDER, Comparison, Part, read

PICTURE = PAGE.with_name("measuring.svg")
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00")  # Okabe and Ito: for all eyes
MARKERS = "os^Dv"
QUIET, ALARM = "#999999", "#a00000"
WIDEST = 3.0
"""Ratios beyond this, either way, stand at the edge."""


def draw(folder: Path = FOLDER, file: Path = PICTURE) -> None:
    """Draw it from the parts of a folder."""
    paint(read(folder)).savefig(file, metadata={"Date": None} if file.suffix == ".svg" else None)


def paint(parts: list[Part]) -> Figure:
    """Equal codes on the left, slowdowns on the right."""
    tools = list(verdicts(parts))
    figure = Figure(figsize=(12.5, 4.4), layout="constrained")
    grid = figure.add_gridspec(1, len(tools) + 1, width_ratios=[1.0] * len(tools) + [3.0])
    first: Axes | None = None
    for place, (name, _, found) in enumerate(tools):
        axes = figure.add_subplot(grid[place], sharey=first)
        first = first or axes
        _ratios(axes, name.replace(" ", "\n"), [one for one in found if not one.injected])
        if place:
            axes.tick_params(labelleft=False)
        else:
            axes.set_ylabel("ratio of identical codes, in order")
    _curves(figure.add_subplot(grid[-1]), tools)
    return figure


def _ratios(axes: Axes, title: str, found: list[Comparison]) -> None:
    for place, one in enumerate(sorted(found, key=lambda one: one.ratio)):
        ranks = one.verdict in ("slower", "faster")
        colour = ALARM if ranks else QUIET
        if one.low is not None and one.high is not None:
            axes.plot([place] * 2, [_inside(one.low), _inside(one.high)], color=colour, linewidth=1, alpha=0.7)
        axes.plot([place], [_inside(one.ratio)], "x" if ranks else ".", color=ALARM if ranks else "black", markersize=5)
    axes.axhline(1, color="black", linewidth=0.6)
    wrong = sum(one.verdict in ("slower", "faster") for one in found)
    axes.set(yscale="log", ylim=(1 / WIDEST, WIDEST), xticks=[], xlabel=f"{wrong} of {len(found)}\nwrong")
    axes.set_yticks([0.5, 0.7, 0.9, 1.1, 1.4, 2.0], ["0.5", "0.7", "0.9", "1.1", "1.4", "2"])
    axes.minorticks_off()
    axes.set_title(title, fontsize=8)


def _inside(ratio: float) -> float:
    return min(max(ratio, 1 / WIDEST), WIDEST)


def _curves(axes: Axes, tools: list[tuple[str, Part, list[Comparison]]]) -> None:
    shares = (0.0, 0.1, 0.2, 0.3)
    for (name, _, found), colour, marker in zip(tools, COLOURS, MARKERS, strict=False):
        said = {share: [one.verdict == "slower" for one in found if one.injected == share] for share in shares}
        rates = [100 * sum(said[share]) / max(1, len(said[share])) for share in shares]
        axes.plot([100 * share for share in shares], rates, marker=marker, color=colour, label=name, clip_on=False)
    axes.set(xlabel="injected slowdown, %", ylabel='called "slower", %', ylim=(0, 100), xticks=[0, 10, 20, 30])
    axes.grid(alpha=0.3)
    axes.legend(fontsize=8, frameon=False, loc="center left", bbox_to_anchor=(1.0, 0.5))
    axes.set_title("at 0 a false alarm, elsewhere a catch", fontsize=9)
