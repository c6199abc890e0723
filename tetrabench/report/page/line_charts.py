"""The charts of lines of a page: along the run, and over what was chosen."""

from collections.abc import Sequence
from typing import Any

from tetrabench.report.curves import spans
from tetrabench.report.page.charts import (
    LETTER,
    LINE,
    PANEL,
    QUIET,
    ROUND,
    TOGGLED,
    WIDTH,
    Charts,
    Spec,
    columns_for,
)
from tetrabench.report.page.figures import Datum

MARKS = 4  # along a line of a panel
DASHED = [10, 5]  # who is known to be wrong
HEIGHT = 280
TICKS = 12  # values that all have a tick of their own
_SECONDS = "format(datum.value, '~s') + 's'"
_COUNT = "format(datum.value, abs(datum.value) < 10000 ? ',~r' : '~s')"


class LineCharts(Charts):
    """Makes those charts whose lines are not always a backend each."""

    def along(self, rows: Sequence[Datum], axis: str, *, is_time: bool) -> Spec:
        """A panel for each quantity, each with its own scale, from zero unless times span too much for that."""
        panels: dict[str, list[float]] = {}
        for row in rows:
            panels.setdefault(row["panel"], []).append(row["value"])
        is_log = is_time and any(map(spans, panels.values())) and min(map(min, panels.values())) > 0
        x = {
            "field": "place",
            "type": "quantitative",
            "title": axis,
            "scale": {"nice": False, "zero": False},
            "axis": {"tickCount": 4, "format": ",~r"},
        }
        y = {
            "field": "value",
            "type": "quantitative",
            "title": None,
            "scale": TOGGLED if is_log else {"zero": True},
            "axis": {"tickCount": 4} | (_seconds(is_log=is_log) if is_time else {"labelExpr": _COUNT}),
        }
        colour, dash, shape = (self._line(part, rows) for part in ("stroke", "dash", "shape"))
        every = max(1, (1 + max(row["spot"] for row in rows)) // MARKS)
        panel = {
            "width": PANEL,
            "height": 150,
            "layer": [
                {
                    "mark": {"type": "line", "strokeWidth": 1.6},
                    "encoding": {"x": x, "y": y, "color": colour, "strokeDash": dash},
                },
                {
                    "transform": [{"filter": f"datum.spot % {every} == 0"}],
                    "mark": {"type": "point", "size": 34, "opacity": 1},
                    "encoding": {
                        "x": x,
                        "y": y,
                        "color": colour,
                        "shape": shape,
                        "tooltip": [
                            {"field": "line", "title": "backend"},
                            {"field": "place", "title": axis, "format": ",~r"},
                            {"field": "value", "title": "seconds" if is_time else "count", "format": ".3s"},
                        ],
                    },
                },
            ],
        }
        apart = {"scale": {"y": "independent"}}
        return self._spec(rows, facet=self._facet("panel", list(panels)), columns=3, spec=panel, resolve=apart)

    def curves(self, rows: Sequence[Datum], option: str) -> Spec:
        """Time of an item: a line for each curve, a level line, with its name beside it, for who has no such option."""
        points = [row for row in rows if not row["level"]]
        times, places = [row["value"] for row in rows], sorted({row["place"] for row in points})
        x = {
            "field": "place",
            "type": "quantitative",
            "title": option,
            "scale": TOGGLED if spans(places) else {"nice": False, "zero": False, "padding": 14},
            "axis": {"format": ",~r", "grid": False} | ({"values": places} if len(places) <= TICKS else {}),
        }
        y = {
            "field": "value",
            "type": "quantitative",
            "title": "time of an item",
            "scale": TOGGLED if spans(times) else {"zero": True},
            "axis": {"tickCount": 6} | _seconds(is_log=spans(times)),
        }
        colour, dash, shape = (self._line(part, rows) for part in ("stroke", "dash", "shape"))
        beside = max((LETTER * len(row["line"]) + 12 for row in rows if row["level"]), default=5)
        only = {"filter": "!datum.level"}
        return self._spec(
            rows,
            width=WIDTH,
            height=HEIGHT,
            padding={"left": 5, "top": 5, "bottom": 5, "right": beside},
            layer=[
                {
                    "transform": [{"filter": "datum.level"}],
                    "mark": {"type": "rule", "strokeWidth": 1},
                    "encoding": {"y": y, "color": colour, "strokeDash": dash},
                },
                {
                    "transform": [{"filter": "datum.level"}],
                    "mark": {"type": "text", "align": "left", "dx": 6, "fontSize": 11},
                    "encoding": {"x": {"value": "width"}, "y": {**y, "field": "at"}, "text": {"field": "line"}},
                },
                {
                    "transform": [only],
                    "mark": {"type": "line", "strokeWidth": 1.6},
                    "encoding": {"x": x, "y": y, "color": colour, "strokeDash": dash},
                },
                {
                    "transform": [only, {"filter": "datum.low < datum.high"}],
                    "mark": {"type": "rule", "strokeWidth": 3, "opacity": 0.5},
                    "encoding": {"x": x, "y": {**y, "field": "low"}, "y2": {"field": "high"}, "color": colour},
                },
                *(
                    {
                        "transform": [only, {"filter": f"{sign}datum.sure"}],
                        "mark": {"type": "point", "size": 50, "strokeWidth": 1.6, "opacity": 1, "filled": not sign},
                        "encoding": {
                            "x": x,
                            "y": y,
                            "color": colour,
                            "shape": shape,
                            "tooltip": [
                                {"field": "backend"},
                                {"field": "place", "title": option, "format": ",~r"},
                                {"field": "text", "title": "time of an item"},
                            ],
                        },
                    }
                    for sign in ("!", "")
                ),
                {
                    "transform": [{"filter": "datum.least"}],
                    "mark": {"type": "point", "shape": "circle", "size": 260, "color": QUIET, "opacity": 1},
                    "encoding": {"x": x, "y": y},
                },
                {
                    "transform": [
                        {"filter": "datum.least"},
                        {"calculate": f"{_quoted(option)} + '=' + datum.place + ': ' + datum.text", "as": "words"},
                    ],
                    "mark": {"type": "text", "dy": -18, "fontSize": 11},
                    "encoding": {"x": x, "y": y, "text": {"field": "words"}},
                },
            ],
        )

    def _line(self, part: str, rows: Sequence[Datum]) -> Spec:
        """The looks of the lines of a chart, with a legend of those that are no level."""
        lines = {row["line"]: row for row in rows}
        looks: dict[str, Any] = {name: self.looks[row["look"]][part] for name, row in lines.items()}
        if part == "dash":
            looks = {name: DASHED if row["wrong"] else looks[name] for name, row in lines.items()}
        named = [name for name, row in lines.items() if not row.get("level")]
        legend = {"orient": "bottom", "columns": columns_for(named), "symbolSize": LINE, "values": named}
        legend["symbolOpacity"] = 1
        return {"field": "line", "type": "nominal", "scale": self._scale(looks), "legend": legend}


def _seconds(*, is_log: bool) -> Spec:
    """Of an axis; where it is logarithmic only 1, 2, 5, 10, ... have a label and a line."""
    if not is_log:
        return {"labelExpr": _SECONDS}
    lines = {"condition": {"test": ROUND, "value": 0.4}, "value": 0}
    return {"labelExpr": f"{ROUND} ? ({_SECONDS}) : ''", "gridOpacity": lines, "tickOpacity": lines}


def _quoted(text: str) -> str:
    """A text in an expression of Vega."""
    return "'" + text.replace("\\", "\\\\").replace("'", "\\'") + "'"
