"""How a contestant looks in a chart: a hue for its layout, a shade and a hatch for the rest of its title.

The same in every chart, whoever else takes part: the order of the family's table decides.
"""

from collections.abc import Iterable
from dataclasses import dataclass

from matplotlib.colors import to_rgb

from tetrabench import registry
from tetrabench.bench.record import Results
from tetrabench.errors import InputError

_HUES = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")  # Okabe and Ito: for all eyes
_SHADES = ((1.0, ""), (0.45, "////"), (0.7, "...."), (0.85, "xxx"), (0.3, "----"))  # share of the hue, hatch


@dataclass(frozen=True)
class Style:
    """Of a contestant's bars. `layout`: contestants of one layout stand together in the legend."""

    title: str
    layout: str
    colour: tuple[float, float, float]
    hatch: str


def make_styles(results: Results) -> dict[str, Style]:
    """A style for each contestant, by name."""
    parts = {one.name: one.title.partition(", ") for one in results.backends}
    known = [title.partition(", ") for title in _known_titles(results.family)]
    layouts = _numbered([layout for layout, _, _ in (*known, *parts.values())])
    rest = _numbered([slots for _, _, slots in (*known, *parts.values())])
    return {
        name: Style(", ".join(filter(None, (layout, slots))), layout, *_paint(layouts[layout], rest[slots]))
        for name, (layout, _, slots) in parts.items()
    }


def _paint(hue: int, shade: int) -> tuple[tuple[float, float, float], str]:
    """Colour and hatch."""
    share, hatch = _SHADES[shade % len(_SHADES)]
    red, green, blue = (1 - share * (1 - part) for part in to_rgb(_HUES[hue % len(_HUES)]))
    return (red, green, blue), hatch


def _known_titles(family: str) -> list[str]:
    try:
        return [contestant.title for contestant in registry.contestants(family)]
    except InputError:  # results of a family that is not installed here
        return []


def _numbered(words: Iterable[str]) -> dict[str, int]:
    """Each word with its place of first appearance."""
    return {word: place for place, word in enumerate(dict.fromkeys(words))}
