"""How a contestant looks in a chart: a hue for its layout, a shade, a hatch and a marker for the rest of its title.

The same in every chart, whoever else takes part: the order of the family's table decides.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from matplotlib.colors import to_rgb

from tetrabench.bench.record import Results
from tetrabench.report.parts import shown_name

EDGE = "#333333"
_HUES = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")  # Okabe and Ito: for all eyes
_SHADES = ((1.0, ""), (0.45, "////"), (0.7, "...."), (0.85, "xxx"), (0.3, "----"))  # share of the hue, hatch
_LINES = ("-", "--", ":", "-.")
_MARKERS = ("o", "s", "^", "D", "v")


@dataclass(frozen=True)
class Style:
    """Of a contestant: its name as it is shown, its words, its column in the legend, what draws a bar, a line, a dot."""

    name: str
    title: str
    layout: str
    paint: dict[str, Any]
    line: dict[str, Any]
    dot: dict[str, Any]


def make_styles(results: Results) -> dict[str, Style]:
    """A style for each contestant, by name; controls have none."""
    backends = [backend for backend in results.backends if not backend.control]
    known = [title.partition(", ") for title in results.titles]
    mine = [backend.title.partition(", ") for backend in backends]
    hues = _numbered([layout for layout, _, _ in (*known, *mine)])
    shades = _numbered([rest for _, _, rest in (*known, *mine)])
    return {
        backend.name: Style(shown_name(backend), backend.title, layout, *_look(hues[layout], shades[rest]))
        for backend, (layout, _, rest) in zip(backends, mine, strict=True)
    }


def _look(hue: int, shade: int) -> tuple[dict[str, Any], dict[str, Any], dict[str, Any]]:
    """What draws a bar, a line, a dot; where lines begin again, so that they tell no two layouts apart, markers move on."""
    share, hatch = _SHADES[shade % len(_SHADES)]
    colour, marker = _HUES[hue % len(_HUES)], _MARKERS[(shade + hue // len(_LINES)) % len(_MARKERS)]
    red, green, blue = (1 - share * (1 - part) for part in to_rgb(colour))
    paint = {"facecolor": (red, green, blue), "hatch": hatch, "edgecolor": EDGE, "linewidth": 0.6}
    mark = {"color": colour, "marker": marker}
    line = {"linestyle": _LINES[hue % len(_LINES)], "linewidth": 1.4, "markersize": 5, "fillstyle": "none"}
    dot = {"linestyle": "none", "markersize": 7, "markeredgewidth": 1.3}
    return paint, mark | line, mark | dot


def _numbered(words: Iterable[str]) -> dict[str, int]:
    """Each word with its place of first appearance."""
    return {word: place for place, word in enumerate(dict.fromkeys(words))}
