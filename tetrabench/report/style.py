"""How a contestant looks in a chart: a hue for its layout, a shade, a hatch and a marker for the rest of its title.

The same in every chart, whoever else takes part: the order of the family's table decides. Where a contestant takes part
several times, with other options, its hue goes from light to dark.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from matplotlib.colors import to_hex, to_rgb

from tetrabench.bench.record import Backend, Results
from tetrabench.report.parts import shown_name

EDGE = "#333333"
_HUES = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")  # Okabe and Ito: for all eyes
_SHADES = ((1.0, ""), (0.45, "////"), (0.7, "...."), (0.85, "xxx"), (0.3, "----"))  # share of the hue, hatch
_LINES = ("-", "--", ":", "-.")
_MARKERS = ("o", "s", "^", "D", "v")
_LIGHT, _DARK = 0.5, 0.35  # the first of several of a contestant is so much of white, the last so much of black


@dataclass(frozen=True)
class Style:
    """Of a contestant: its name as it is shown, its words, its column in the legend, what draws a bar, a line, a dot.

    Attributes:
        sweep: the contestant where several of its backends differ in their options, "" for all others.
    """

    name: str
    title: str
    layout: str
    paint: dict[str, Any]
    line: dict[str, Any]
    dot: dict[str, Any]
    sweep: str = ""


def make_styles(results: Results) -> dict[str, Style]:
    """A style for each contestant, by name; controls have none."""
    backends = [backend for backend in results.backends if not backend.control]
    known = [title.partition(", ") for title in results.titles]
    mine = [backend.title.partition(", ") for backend in backends]
    hues = _numbered([layout for layout, _, _ in (*known, *mine)])
    shades = _numbered([rest for _, _, rest in (*known, *mine)])
    styles = {}
    for backend, (layout, _, rest) in zip(backends, mine, strict=True):
        own = [one for one in backends if one.contestant == backend.contestant]
        place, sweep = (own.index(backend), backend.contestant) if _is_sweep(own) else (0, "")
        tone = place / (len(own) - 1) if sweep else None
        look = _look(hues[layout], shades[rest], place, tone)
        styles[backend.name] = Style(shown_name(backend), backend.title, layout, *look, sweep)
    return styles


def _is_sweep(backends: Sequence[Backend]) -> bool:
    """Whether backends of one contestant differ in their options."""
    return len({tuple(one.options.items()) for one in backends}) > 1


def _look(
    hue: int, shade: int, place: int, tone: float | None
) -> tuple[dict[str, Any], dict[str, Any], dict[str, Any]]:
    """What draws a bar, a line, a dot; where lines begin again, so that they tell no two layouts apart, markers move on.

    Args:
        hue, shade: places of the layout, and of the rest of the title.
        place: among the backends of the contestant; tone: 0 for the lightest of these, 1 for the darkest.
    """
    share, hatch = _SHADES[shade % len(_SHADES)]
    marker = _MARKERS[(shade + hue // len(_LINES) + place) % len(_MARKERS)]
    colour = _HUES[hue % len(_HUES)] if tone is None else _toned(_HUES[hue % len(_HUES)], tone)
    red, green, blue = (1 - share * (1 - part) for part in to_rgb(colour))
    paint = {"facecolor": (red, green, blue), "hatch": hatch, "edgecolor": EDGE, "linewidth": 0.6}
    mark = {"color": colour, "marker": marker}
    line = {"linestyle": _LINES[hue % len(_LINES)], "linewidth": 1.4, "markersize": 5, "fillstyle": "none"}
    dot = {"linestyle": "none", "markersize": 7, "markeredgewidth": 1.3}
    return paint, mark | line, mark | dot


def _toned(colour: str, tone: float) -> str:
    """A colour, lighter or darker."""
    mixed, share = (1.0, _LIGHT * (1 - 2 * tone)) if tone < 0.5 else (0.0, _DARK * (2 * tone - 1))
    red, green, blue = (part + share * (mixed - part) for part in to_rgb(colour))
    return to_hex((red, green, blue))


def _numbered(words: Iterable[str]) -> dict[str, int]:
    """Each word with its place of first appearance."""
    return {word: place for place, word in enumerate(dict.fromkeys(words))}
