"""How a contestant looks in a chart: a hue for its layout, a shade, a hatch and a marker for the rest of its title.

The same in every chart, whoever else takes part: the order of the family's table decides.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from matplotlib.colors import to_rgb

from tetrabench.bench.record import Results

EDGE = "#333333"
_HUES = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")  # Okabe and Ito: for all eyes
_SHADES = ((1.0, ""), (0.45, "////"), (0.7, "...."), (0.85, "xxx"), (0.3, "----"))  # share of the hue, hatch
_LINES = ("-", "--", ":", "-.")
_MARKERS = ("o", "s", "^", "D", "v")


@dataclass(frozen=True)
class Style:
    """Of a contestant: its words, its column in the legend, what a patch is drawn with, what a line."""

    title: str
    layout: str
    paint: dict[str, Any]
    line: dict[str, Any]


def make_styles(results: Results) -> dict[str, Style]:
    """A style for each contestant, by name; controls have none."""
    backends = [backend for backend in results.backends if not backend.control]
    known = [title.partition(", ") for title in results.titles]
    mine = [backend.title.partition(", ") for backend in backends]
    hues = _numbered([layout for layout, _, _ in (*known, *mine)])
    shades = _numbered([rest for _, _, rest in (*known, *mine)])
    return {
        backend.name: Style(backend.title, layout, *_look(hues[layout], shades[rest]))
        for backend, (layout, _, rest) in zip(backends, mine, strict=True)
    }


def _look(hue: int, shade: int) -> tuple[dict[str, Any], dict[str, Any]]:
    """What a patch is drawn with, and what a line."""
    share, hatch = _SHADES[shade % len(_SHADES)]
    colour = _HUES[hue % len(_HUES)]
    red, green, blue = (1 - share * (1 - part) for part in to_rgb(colour))
    paint = {"facecolor": (red, green, blue), "hatch": hatch, "edgecolor": EDGE, "linewidth": 0.6}
    marks = {"linestyle": _LINES[hue % len(_LINES)], "marker": _MARKERS[shade % len(_MARKERS)]}
    return paint, {"color": colour, **marks}


def _numbered(words: Iterable[str]) -> dict[str, int]:
    """Each word with its place of first appearance."""
    return {word: place for place, word in enumerate(dict.fromkeys(words))}
