"""The charts of a page as Vega-Lite specifications: what a browser draws live, and what is drawn beforehand as SVG.

Each has the parameters `backends` and `models` (those to show), and the chart of times `base` too; script.js sets them, the
kind of the scales marked TOGGLED, and the width. Colours of text and lines are left to style.css.
"""

from collections.abc import Mapping, Sequence
from typing import Any

from tetrabench.bench.statistics import ALIKE
from tetrabench.report.page import figures
from tetrabench.report.page.figures import Datum
from tetrabench.report.page.subjects import ABSOLUTE
from tetrabench.report.units import one_of

Spec = dict[str, Any]
SCHEMA = "https://vega.github.io/schema/vega-lite/v6.json"
WIDTH = 560  # pixels of a chart that is drawn beforehand; script.js takes what there is
PANEL = 170  # of a panel among several
TOGGLED = {"type": "log", "nice": False, "padding": 14}  # script.js makes it linear when asked to
_ROW, _SUBROW = 27, 17  # pixels a backend, and a backend on one of several models
ROUND = "indexof([1, 2, 5], round(datum.value / pow(10, floor(log(datum.value) / LN10 + 1e-9)))) >= 0"
LINE = 160  # size of a sign in a legend of lines
LETTER = 6.3  # pixels, in a legend
BOLD = 7.8  # pixels, a letter in front of a row
MARKS = 8  # along a line, so that it is known without its colour
QUIET = "#808080"  # of marks that are not of a backend: seen on white and on black
CONFIG: Spec = {
    "aria": False,  # a word for each mark would double the page; the table beside it says all of them
    "background": None,
    "font": "system-ui, sans-serif",
    "view": {"stroke": None},
    "axis": {
        "labelFontSize": 12,
        "titleFontSize": 12,
        "titleFontWeight": "normal",
        "grid": True,
        "labelLimit": 220,
        "labelOverlap": "greedy",
    },
    "axisQuantitative": {"gridOpacity": 0.4},
    "header": {"labelPadding": 2, "labelFontSize": 12, "labelFontWeight": "bold", "title": None, "labelLimit": 300},
    "text": {"fontSize": 12},
    "legend": {
        "labelFontSize": 12,
        "title": None,
        "labelLimit": 300,
        "symbolSize": 80,
        "symbolFillColor": "transparent",
    },
}


class Charts:
    """Makes the charts of one page.

    Attributes:
        looks: of backends, by shown name (see `looks`); shapes: of models, by label.
        base: what is compared with at first.
    """

    def __init__(self, looks: Mapping[str, Mapping[str, Any]], shapes: Mapping[str, str], base: str) -> None:
        self.looks, self.shapes, self.base = looks, shapes, base
        self.backends, self.models = list(looks), list(shapes)

    def times(self, rows: Sequence[Datum]) -> Spec:
        """A line for each backend: a mark for each model, its interval, its figure, or the word that stands for it."""
        x = {"type": "quantitative", "scale": {**TOGGLED, "padding": 30}, "title": None, "axis": self._times_axis(rows)}
        extent = 8 + BOLD * max(map(len, self.backends), default=0)  # what a browser needs, which guesses less
        y = self._names(ticks=False, domain=False, labelFontWeight="bold", labelPadding=8, minExtent=extent)
        offset = {"field": "model", "type": "nominal", "sort": self.models, "scale": {"paddingInner": 0.2}}
        place = {"y": y, **({"yOffset": offset} if len(self.models) > 1 else {})}
        compared = {"filter": f"base != '{ABSOLUTE}'"}
        known = {"filter": "isValid(datum.value)"}
        one = [{**compared}, {"aggregate": [{"op": "count", "as": "n"}]}, {"calculate": "1", "as": "one"}]
        band = [*one, {"calculate": str(1 / ALIKE), "as": "low"}, {"calculate": str(ALIKE), "as": "high"}]
        return self._spec(
            rows,
            width=WIDTH,
            height=_ROW * len(self.backends)
            if len(self.models) == 1
            else _SUBROW * len(self.backends) * len(self.models),
            usermeta={"row": _ROW if len(self.models) == 1 else _SUBROW},  # script.js: fewer rows, a lower chart
            params=[{"name": "base", "value": self.base}],
            transform=[{"filter": "datum.base == base"}],
            encoding=place,
            layer=[
                {
                    "transform": band,
                    "mark": {"type": "rect", "color": QUIET, "opacity": 0.18},
                    "encoding": {
                        "x": {**x, "field": "low"},
                        "x2": {"field": "high"},
                        "y": {"value": 0},
                        "y2": {"value": "height"},
                    }
                    | ({"yOffset": {"value": 0}} if len(self.models) > 1 else {}),
                },
                {
                    "transform": one,
                    "mark": {"type": "rule", "color": QUIET, "strokeWidth": 1.5},
                    "encoding": {"x": {**x, "field": "one"}, "y": {"value": 0}, "y2": {"value": "height"}}
                    | ({"yOffset": {"value": 0}} if len(self.models) > 1 else {}),
                },
                {
                    "transform": [known, {"filter": "isValid(datum.low) && isValid(datum.high)"}],
                    "mark": {"type": "rule", "strokeWidth": 3, "opacity": 0.75},
                    "encoding": {"x": {**x, "field": "low"}, "x2": {"field": "high"}, "color": self._stroke()},
                },
                {
                    "transform": [known],
                    "mark": {"type": "point", "size": 90, "strokeWidth": 1.8, "opacity": 1},
                    "encoding": {
                        "x": {**x, "field": "value"},
                        "fill": {"condition": {"test": "datum.sure", **self._fill()}, "value": "transparent"},
                        "stroke": self._stroke(),
                        "shape": {
                            "field": "model",
                            "type": "nominal",
                            "scale": self._scale(self.shapes),
                            "legend": None,
                        },
                        "tooltip": [
                            {"field": "backend"},
                            {"field": "model"},
                            {"field": "text", "title": "figure"},
                            {"field": "span", "title": "interval"},
                            {"field": "verdict"},
                        ],
                    },
                },
                {
                    "transform": [known, {"filter": "datum.text != '1'"}],
                    "mark": {"type": "text", "align": "left", "dx": 9, "fontSize": 11},
                    "encoding": {"x": {**x, "field": "edge"}, "text": {"field": "text"}},
                },
                {
                    "transform": [{"filter": "datum.word != ''"}],
                    "mark": {"type": "text", "align": "left", "fontStyle": "italic", "fontSize": 11},
                    "encoding": {"x": {"value": 6}, "text": {"field": "word"}},
                },
            ],
        )

    def samples(self, rows: Sequence[Datum], reference: str) -> Spec:
        """A line for each backend over rounds; the noise is shaded."""
        ratio = {
            "type": "quantitative",
            "scale": TOGGLED,
            "title": f"multiple of {reference}'s time",
            "axis": {
                "labelExpr": _thinned("format(datum.value, ',~r') + 'x'", [row["ratio"] for row in rows]),
                "tickCount": 5,
            },
        }
        place = {
            "field": "place",
            "type": "quantitative",
            "title": "round, through all launches",
            "scale": {"zero": False, "nice": False},
            "axis": {"values": _whole([int(row["place"]) for row in rows]), "grid": False, "format": "d"},
        }
        noise = [
            {"filter": "isValid(datum.quiet)"},
            {
                "aggregate": [
                    {"op": "min", "field": "quiet", "as": "quiet"},
                    {"op": "max", "field": "loud", "as": "loud"},
                ]
            },
        ]
        every = max(1, len({row["place"] for row in rows}) // MARKS)
        lines = {
            "width": WIDTH - 130,
            "height": 130,
            "layer": [
                {
                    "transform": noise,
                    "mark": {"type": "rect", "color": QUIET, "opacity": 0.25},
                    "encoding": {
                        "y": {**ratio, "field": "quiet"},
                        "y2": {"field": "loud"},
                        "x": {"value": 0},
                        "x2": {"value": "width"},
                    },
                },
                {
                    "mark": {"type": "line", "strokeWidth": 1.6},
                    "encoding": {
                        "x": place,
                        "y": {**ratio, "field": "ratio"},
                        "color": self._key(self._stroke(), LINE),
                        "strokeDash": self._key(self._dash(), LINE),
                    },
                },
                {
                    "transform": [{"filter": f"datum.place % {every} == 1 % {every} || hovered"}],
                    "mark": {"type": "point", "size": 34, "opacity": 1},
                    "encoding": {
                        "x": place,
                        "y": {**ratio, "field": "ratio"},
                        "color": self._key(self._stroke(), LINE),
                        "shape": self._key(self._shape(), LINE),
                        "tooltip": [
                            {"field": "backend"},
                            {"field": "place", "title": "round"},
                            {"field": "ratio", "format": ".3r"},
                        ],
                    },
                },
            ],
        }
        hovered = {"name": "hovered", "value": False}  # script.js sets it: a point for the pointer to hit
        return self._spec(rows, params=[hovered], facet={"row": self._facet("model", self.models)}, spec=lines)

    def trade(self, rows: Sequence[Datum], kind: str, item: str) -> Spec:
        """Time against memory, a panel for each task; a line through those that none beats in both."""
        x = {
            "field": "bytes",
            "type": "quantitative",
            "title": f"{kind}, bytes {one_of(item)}",
            "scale": {"zero": False, "padding": 16},
            "axis": {"tickCount": 4},
        }
        y = {
            "field": "seconds",
            "type": "quantitative",
            "title": None,
            "scale": TOGGLED,
            "axis": {"labelExpr": "format(datum.value, '~s') + 's'", "tickCount": 4},
        }
        panel = {
            "width": PANEL,
            "height": 150,
            "layer": [
                {
                    "transform": [{"filter": "datum.least"}],
                    "mark": {"type": "line", "interpolate": "step-after", "color": QUIET, "strokeWidth": 1.5},
                    "encoding": {"x": x, "y": y, "detail": {"field": "model"}, "order": {"field": "bytes"}},
                },
                {
                    "mark": {"type": "point", "size": 70, "strokeWidth": 1.6, "opacity": 1},
                    "encoding": {
                        "x": x,
                        "y": y,
                        "shape": self._key(self._shape()),
                        "stroke": self._key(self._stroke()),
                        "fill": {
                            "condition": {"test": "datum.front", **self._key(self._fill())},
                            "value": "transparent",
                        },
                        "tooltip": [
                            {"field": "backend"},
                            {"field": "model"},
                            {"field": "text", "title": "time of one run"},
                            {"field": "bytes", "format": ",.0f", "title": f"bytes {one_of(item)}"},
                        ],
                    },
                },
            ],
        }
        return self._panels(rows, panel)

    def growth(self, rows: Sequence[Datum], things: str) -> Spec:
        """Time of an item over the size of the model, a panel for each task."""
        panel = {
            "width": PANEL,
            "height": 150,
            "mark": {"type": "line", "strokeWidth": 1.6, "point": {"size": 50, "filled": False}},
            "encoding": {
                "x": {
                    "field": "size",
                    "type": "quantitative",
                    "scale": TOGGLED,
                    "title": things,
                    "axis": {"format": "~s", "tickCount": 4},
                },
                "y": {
                    "field": "ns",
                    "type": "quantitative",
                    "scale": TOGGLED,
                    "title": "ns an item",
                    "axis": {"tickCount": 4, "format": "~r"},
                },
                "color": self._key(self._stroke(), LINE),
                "strokeDash": self._key(self._dash(), LINE),
                "shape": self._key(self._shape(), LINE),
                "detail": {"field": "run"},
                "tooltip": [
                    {"field": "backend"},
                    {"field": "run"},
                    {"field": "size", "format": ",", "title": things},
                    {"field": "ns", "format": ".3r", "title": "ns an item"},
                ],
            },
        }
        return self._panels(rows, panel)

    def fields(self, rows: Sequence[Datum], item: str) -> Spec:
        """Bytes an item by buffer, stacked; the larger pieces carry their names."""
        rows = [row for row in rows if row["bytes"] >= figures.UNSEEN]
        who: dict[str, set[str]] = {}
        for row in rows:
            who.setdefault(row["field"], set()).add(row["backend"])
        names = sorted(who, key=lambda field: len(who[field]))  # what all have stands last, in one line
        stacked = {
            "stack": "bytes",
            "groupby": ["model", "backend"],
            "as": ["from", "to"],
            "sort": [{"field": "place"}],
        }
        bars = {
            "width": WIDTH - 90,
            "height": {"step": 26},
            "transform": [stacked],
            "encoding": {
                "y": self._names(),
            },
            "layer": [
                {
                    "mark": {"type": "bar", "stroke": QUIET, "strokeWidth": 1},
                    "encoding": {
                        "x": {"field": "from", "type": "quantitative", "title": f"bytes {one_of(item)}"},
                        "x2": {"field": "to"},
                        "color": {
                            "field": "field",
                            "type": "nominal",
                            "scale": {"domain": names, "scheme": "set3"},
                            "legend": {"orient": "bottom", "columns": 7},
                        },
                        "tooltip": [
                            {"field": "backend"},
                            {"field": "field", "title": "buffer"},
                            {"field": "bytes", "format": ",.1f", "title": f"bytes {one_of(item)}"},
                        ],
                    },
                },
                {
                    "transform": [
                        {"filter": "datum.bytes >= 5 * length(datum.field)"},
                        {"calculate": "(datum.from + datum.to) / 2", "as": "middle"},
                    ],
                    "mark": {"type": "text", "fontSize": 10, "clip": True, "fill": "#111111"},
                    "encoding": {"x": {"field": "middle", "type": "quantitative"}, "text": {"field": "field"}},
                },
            ],
        }
        placed = [{**row, "place": names.index(row["field"])} for row in rows]
        return self._spec(placed, facet={"row": self._facet("model", self.models)}, spec=bars)

    def limits(self, rows: Sequence[Datum]) -> Spec:
        """Shares of the machine's bandwidth as bars, a panel for each task and model."""
        x = {"type": "quantitative", "title": None, "axis": {"format": ".0%", "tickCount": 4}}
        panel = {
            "width": PANEL + 60,
            "height": {"step": 22},
            "encoding": {
                "y": self._names(),
            },
            "layer": [
                {
                    "mark": {"type": "bar", "strokeWidth": 1},
                    "encoding": {
                        "x": {**x, "field": "share"},
                        "fill": self._fill(),
                        "stroke": self._stroke(),
                        "tooltip": [
                            {"field": "backend"},
                            {"field": "text", "title": "of the limit"},
                            {"field": "gb_per_s", "format": ".3r", "title": "GB/s"},
                        ],
                    },
                },
                {
                    "mark": {"type": "text", "align": "left", "dx": 4, "fontSize": 11},
                    "encoding": {"x": {**x, "field": "share"}, "text": {"field": "text"}},
                },
            ],
        }
        titled = [
            {**row, "panel": f"{row['task']}, {row['model']}" if len(self.models) > 1 else row["task"]} for row in rows
        ]
        order = list(dict.fromkeys(row["panel"] for row in titled))
        return self._spec(titled, facet=self._facet("panel", order), columns=2, spec=panel)

    # -- what they share

    def _spec(
        self, rows: Sequence[Datum], *, params: Sequence[Spec] = (), transform: Sequence[Spec] = (), **parts: Any
    ) -> Spec:
        shown = ["backends", *(["models"] if any("model" in row for row in rows) else [])]
        return {
            "$schema": SCHEMA,
            "config": CONFIG,
            "autosize": {"type": "fit-x", "contains": "padding"} if "layer" in parts else {"type": "pad"},
            "data": {"name": "rows", "values": list(rows)},
            "params": [*({"name": name, "value": getattr(self, name)} for name in shown), *params],
            "transform": [
                *({"filter": f"indexof({name}, datum.{name.removesuffix('s')}) >= 0"} for name in shown),
                *transform,
            ],
            **parts,
        }

    def _panels(self, rows: Sequence[Datum], panel: Spec) -> Spec:
        """A panel for each task, each with its own scale of time."""
        tasks = list(dict.fromkeys(row["task"] for row in rows))
        apart = {"scale": {"y": "independent"}}
        return self._spec(rows, facet=self._facet("task", tasks), columns=3, spec=panel, resolve=apart)

    def _times_axis(self, rows: Sequence[Datum]) -> Spec:
        ratio, seconds = "format(datum.value, ',~r') + 'x'", "format(datum.value, '~s') + 's'"
        known = [row["value"] for row in rows if row["base"] == self.base and row["value"]]
        label = f"base == '{ABSOLUTE}' ? {seconds} : {ratio}"
        return {"labelExpr": _thinned(label, known), "tickCount": 6, "labelOverlap": "greedy"}

    def _names(self, **axis: Any) -> Spec:
        """A line for each backend, in the order of all charts."""
        order = {"sort": self.backends, "title": None, "axis": {"grid": False, **axis}}
        return {"field": "backend", "type": "nominal", **order}

    def _facet(self, field: str, order: Sequence[str]) -> Spec:
        return {
            "field": field,
            "type": "nominal",
            "sort": list(order),
            "title": None,
            "header": {"labelAnchor": "start", "labelAngle": 0, "labelOrient": "top"},
        }

    def _scale(self, looks: Mapping[str, Any]) -> Spec:
        return {"domain": list(looks), "range": list(looks.values())}

    def _of_backends(self, part: str) -> Spec:
        looks = {name: look[part] for name, look in self.looks.items()}
        return {"field": "backend", "type": "nominal", "scale": self._scale(looks), "legend": None}

    def _fill(self) -> Spec:
        return self._of_backends("fill")

    def _key(self, encoding: Spec, size: int = 80) -> Spec:
        """The same with a legend of the backends below the chart."""
        return {**encoding, "legend": {"orient": "bottom", "columns": columns_for(self.backends), "symbolSize": size}}

    def _stroke(self) -> Spec:
        return self._of_backends("stroke")

    def _shape(self) -> Spec:
        return self._of_backends("shape")

    def _dash(self) -> Spec:
        return self._of_backends("dash")


def columns_for(names: Sequence[str]) -> int:
    """Of a legend with these names."""
    return max(1, min(7, int((WIDTH - 80) // (34 + LETTER * max(map(len, names), default=0)))))


def _whole(places: Sequence[int]) -> list[int]:
    """Ticks at ten whole numbers at most."""
    first, last = min(places, default=1), max(places, default=1)
    return list(range(first, last + 1, 1 + (last - first) // 10))


def _thinned(label: str, values: Sequence[float]) -> str:
    """A label of a logarithmic axis; where it is long only at 1, 2, 5, 10, ...: else neighbours would push out the 10."""
    is_long = bool(values) and max(values) > 8 * min(values)
    return f"{ROUND} ? ({label}) : ''" if is_long else label
