"""A figure with its title, its legend, its caption, and room for panels."""

import textwrap
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties
from matplotlib.legend_handler import HandlerTuple
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.textpath import TextPath

from tetrabench.bench.record import Results
from tetrabench.report.bars import ALARM
from tetrabench.report.notes import FOREIGN, about_end
from tetrabench.report.style import Style

WIDTH = 11.0  # inches
PANEL_HEIGHT = 3.2  # inches
SMALL = 9  # points, of the legend
LONGEST = 64  # characters in a line of the legend
LEGEND_GAPS = 0.85  # inches of a column of the legend that are no words
FOLDED = 4  # more backends than this of a contestant share an entry of the legend
Sign = Patch | Line2D


@dataclass(frozen=True)
class Entry:
    """Of the legend: its words, and the signs that they explain."""

    words: str
    signs: tuple[Sign, ...]


def make_figure(
    results: Results, title: str, caption: str, legend: Sequence[Sequence[Entry]], rows: int, columns: int
) -> tuple[Figure, list[Axes]]:
    """A figure, and its panels; the legend is given column by column."""
    if any("*" in entry.words.partition(":")[0] for entry in chain(*legend)):
        caption += f" {FOREIGN}"
    titles = textwrap.wrap(title, 80) + ([about_end(results)] if results.ended else [])
    filled = textwrap.fill(caption.replace(" %", "\N{NO-BREAK SPACE}%"), 180)
    heads = 0.1 + 0.22 * len(titles)  # inches
    above = heads + 0.15 + 0.19 * max(map(_lines, legend), default=0)
    height, foot = PANEL_HEIGHT * rows, 0.15 + 0.15 * (1 + filled.count("\n"))
    figure = Figure(figsize=(WIDTH, above + height + foot), layout="constrained")
    parts: Any = figure.subfigures(3, 1, height_ratios=(above, height, foot))
    heading, body, bottom = parts
    for place, line in enumerate(titles):
        colour = ALARM if results.ended and place == len(titles) - 1 else "black"
        look = {"fontsize": 13, "fontweight": "bold", "ha": "left", "va": "top"}
        heading.text(0.01, 1 - (0.08 + 0.22 * place) / above, line, color=colour, **look)
    _add_legend(heading, legend, 1 - heads / above)
    bottom.text(0.01, 0.9, filled, ha="left", va="top", fontsize=8, color="#444444")
    return figure, list(body.subplots(rows, columns, squeeze=False).flat)


def legend_of(styles: Mapping[str, Style], sign: Callable[[Style], Sign]) -> list[list[Entry]]:
    """A column a layout, or several layouts in a column where that is too wide; many of a contestant in one entry."""
    layouts: dict[str, list[Entry]] = {}
    sweeps: dict[str, list[Style]] = {}
    for style in styles.values():
        sweeps.setdefault(style.sweep or style.name, []).append(style)
    for mine in sweeps.values():
        groups = [mine] if len(mine) > FOLDED else [[one] for one in mine]
        layouts.setdefault(mine[0].layout, []).extend(_entry(group, sign) for group in groups)
    return arranged(list(layouts.values()))


def arranged(columns: Sequence[Sequence[Entry]]) -> list[list[Entry]]:
    """As many of these side by side as there is room for, the others beneath."""
    joined: list[list[Entry]] = []
    for share in range(1, len(columns) + 1):
        joined = [list(chain(*columns[start : start + share])) for start in range(0, len(columns), share)]
        if sum(LEGEND_GAPS + max(_width(entry.words) for entry in column) for column in joined) < WIDTH:
            break
    return joined


def _entry(styles: Sequence[Style], sign: Callable[[Style], Sign]) -> Entry:
    """Of one; or of many, of which the first, the middle and the last are shown."""
    first = styles[0]
    if len(styles) == 1:
        return Entry(textwrap.fill(f"{first.name}: {first.title}", LONGEST), (sign(first),))
    chosen = [style.name.removeprefix(first.sweep).strip(" *") for style in styles]
    option = chosen[0].partition("=")[0]
    if all(one.startswith(f"{option}=") and " " not in one for one in chosen):
        chosen = [chosen[0], *(one.partition("=")[2] for one in chosen[1:])]
    star = "*" * first.name.endswith("*")
    words = f"{first.sweep}{star} {', '.join(chosen)} (light to dark): {first.title}"
    shown = (first, styles[len(styles) // 2], styles[-1])
    return Entry(textwrap.fill(words, LONGEST), tuple(map(sign, shown)))


def _lines(column: Sequence[Entry]) -> int:
    return sum(1 + entry.words.count("\n") for entry in column)


def _width(words: str) -> float:
    """Of words in the legend, inches."""
    small = FontProperties(size=SMALL)
    return max(float(TextPath((0, 0), line, prop=small).get_extents().width) for line in words.split("\n")) / 72


def _add_legend(figure: Any, columns: Sequence[Sequence[Entry]], top: float) -> None:
    longest = max(map(len, columns), default=0)
    handles: list[Any] = []
    labels = []
    for column in columns:
        gap = longest - len(column)
        handles += [entry.signs if len(entry.signs) > 1 else entry.signs[0] for entry in column]
        handles += [Patch(alpha=0.0)] * gap
        labels += [entry.words for entry in column] + [""] * gap
    if handles:
        look: Any = {"ncols": len(columns), "loc": "upper left", "frameon": False, "fontsize": SMALL, "handlelength": 3}
        look |= {"handler_map": {tuple: HandlerTuple(ndivide=None, pad=0.3)}}
        figure.legend(handles, labels, bbox_to_anchor=(0.0, top), **look)
