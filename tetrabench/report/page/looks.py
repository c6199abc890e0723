"""How backends, models and buffers look on the page: the same in every chart, told apart without colour too."""

from collections.abc import Sequence
from typing import Any

from matplotlib.colors import to_hex

from tetrabench.report.page.subjects import Subject
from tetrabench.report.style import Style, make_styles

_SHAPES = {"o": "circle", "s": "square", "^": "triangle-up", "D": "diamond", "v": "triangle-down"}
_DASHES = {"-": [], "--": [7, 3], ":": [2, 3], "-.": [8, 3, 2, 3]}
_MODELS = ("circle", "diamond", "square", "triangle-up", "cross", "triangle-down", "triangle-left", "triangle-right")
PATHS = {
    "circle": "M6,1a5,5 0 1,0 .01,0z",
    "square": "M1.5,1.5h9v9h-9z",
    "triangle-up": "M6,1l5.5,10h-11z",
    "triangle-down": "M6,11l5.5,-10h-11z",
    "triangle-left": "M1,6l10,5.5v-11z",
    "triangle-right": "M11,6l-10,5.5v-11z",
    "diamond": "M6,0l5,6l-5,6l-5,-6z",
    "cross": "M4,0h4v4h4v4h-4v4h-4v-4h-4v-4h4z",
}
"""Each mark in a square of 12."""


def looks_of(subjects: Sequence[Subject]) -> dict[str, dict[str, Any]]:
    """By shown name of a backend: its words, and the `fill`, `stroke` and `shape` of its marks, the `dash` of its lines.

    The dash tells the layout, the shape what a layout is combined with: both are on every line.
    """
    looks: dict[str, dict[str, Any]] = {}
    for subject in subjects:
        for style in make_styles(subject.run.results).values():
            looks.setdefault(style.name, _look(style))
    return looks


def _look(style: Style) -> dict[str, Any]:
    marker = style.dot["marker"]
    return {
        "title": style.title,
        "fill": to_hex(style.paint["facecolor"]),
        "stroke": style.line["color"],
        "shape": _SHAPES[marker],
        "dash": _DASHES[style.line["linestyle"]],
    }


def shapes_of(labels: Sequence[str]) -> dict[str, str]:
    """A mark for each model."""
    return {label: _MODELS[place % len(_MODELS)] for place, label in enumerate(labels)}
