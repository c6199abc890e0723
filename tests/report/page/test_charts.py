"""The charts: which field each mark shows where, under which condition; and drawn, where each mark comes to stand."""

import math
import re
from importlib.resources import files
from typing import Any

import msgspec
import pytest

from tests.report.made import change, make_memory, make_results
from tests.report.page.pages import TASKS, sweep, two_runs
from tetrabench.bench import Results
from tetrabench.bench.statistics import ALIKE
from tetrabench.report.page import figures
from tetrabench.report.page.charts import MARKS, Charts, Spec
from tetrabench.report.page.looks import looks_of, shapes_of
from tetrabench.report.page.subjects import ABSOLUTE, make_runs, make_subjects

vl_convert = pytest.importorskip("vl_convert")

BASES = ["v3y", "v4", ABSOLUTE]
KINDS = ("times", "samples", "trade", "growth", "fields", "limits")


class Drawn:
    """A chart: its numbers, its specification, and, when asked for, its marks by layer as they are drawn."""

    def __init__(self, rows: list[figures.Datum], spec: Spec) -> None:
        self.rows, self.spec = rows, spec
        self._marks: dict[str, list[dict[str, Any]]] = {}

    @property
    def layers(self) -> list[Spec]:
        inner = self.spec.get("spec", self.spec)
        return inner.get("layer", [inner])

    def marks(self, layer: int | None = None) -> list[dict[str, Any]]:
        """All marks of a layer, of all panels, with the colours, places and words that they have in the drawing."""
        if not self._marks:
            self._gather(vl_convert.vegalite_to_scenegraph(self.spec)["scenegraph"])
        ending = "marks" if layer is None else f"layer_{layer}_marks"
        return [one for name, items in self._marks.items() if name.endswith(ending) for one in items]

    def _gather(self, part: dict[str, Any]) -> None:
        if part.get("role") == "mark" and part.get("marktype") != "group":
            self._marks.setdefault(part["name"], []).extend(part["items"])
        for inner in part.get("items", []):
            self._gather(inner)


def charts_of(runs: list[tuple[str, Results]], base: str = "v3y") -> dict[str, Drawn]:
    """Of alfa on all models, and of what is of no task."""
    subjects = make_subjects(make_runs(runs))
    charts = Charts(looks_of(subjects), shapes_of([one.label for one in subjects]), base)
    times, samples = figures.times(subjects, BASES)["alfa"], figures.samples(subjects).get("alfa", [])
    (_, trade), grown = figures.trade(subjects[0]), figures.growth(subjects)
    fields, limits = figures.fields(subjects), figures.limits(subjects)
    return {
        "times": Drawn(times, charts.times(times)),
        "samples": Drawn(samples, charts.samples(samples, "v3y")),
        "trade": Drawn(trade, charts.trade(trade, "peak", "tetra")),
        "growth": Drawn(grown, charts.growth(grown, "tetras")),
        "fields": Drawn(fields, charts.fields(fields, "tetra")),
        "limits": Drawn(limits, charts.limits(limits)),
    }


@pytest.fixture(scope="module")
def two() -> dict[str, Drawn]:
    return charts_of(two_runs())


@pytest.fixture(scope="module")
def one() -> dict[str, Drawn]:
    ((name, results), *_) = two_runs()
    return charts_of([(name, results)])


@pytest.fixture(scope="module")
def grown() -> dict[str, Drawn]:
    return charts_of(sweep())


# -- what the specifications say


def said(channel: Any) -> Any:
    """Of a channel: its field, a constant as "=6", "test ? field : constant" of a condition."""
    if isinstance(channel, list):
        return [said(one) for one in channel]
    if "condition" in channel:
        return f"{channel['condition']['test']} ? {channel['condition']['field']} : {channel['value']}"
    return channel["field"] if "field" in channel else f"={channel['value']}"


def channels(layer: Spec) -> dict[str, Any]:
    """Channel -> field, and what filters the rows of a layer."""
    told = {name: said(channel) for name, channel in layer.get("encoding", {}).items()}
    filters = [one["filter"] for one in layer.get("transform", []) if "filter" in one]
    return told | ({"filters": filters} if filters else {})


OUTER = {
    "times": {"y": "backend"},
    "fields": {"y": "backend"},
    "limits": {"y": "backend"},
}
FACETS = {"samples": "model", "trade": "task", "growth": "task", "fields": "model", "limits": "panel"}
KNOWN = "isValid(datum.value)"
COMPARED = f"base != '{ABSOLUTE}'"
LAYERS: dict[str, list[dict[str, Any]]] = {
    "times": [
        {"x": "low", "x2": "high", "y": "=0", "y2": "=height", "filters": [COMPARED]},
        {"x": "one", "y": "=0", "y2": "=height", "filters": [COMPARED]},
        {
            "x": "low",
            "x2": "high",
            "color": "backend",
            "filters": [KNOWN, "isValid(datum.low) && isValid(datum.high)"],
        },
        {
            "x": "value",
            "fill": "datum.sure ? backend : transparent",
            "stroke": "backend",
            "shape": "model",
            "tooltip": ["backend", "model", "text", "span", "verdict"],
            "filters": [KNOWN],
        },
        {"x": "edge", "text": "text", "filters": [KNOWN, "datum.text != '1'"]},
        {"x": "=6", "text": "word", "filters": ["datum.word != ''"]},
    ],
    "samples": [
        {"x": "=0", "x2": "=width", "y": "quiet", "y2": "loud", "filters": ["isValid(datum.quiet)"]},
        {"x": "place", "y": "ratio", "color": "backend", "strokeDash": "backend"},
        {
            "x": "place",
            "y": "ratio",
            "color": "backend",
            "shape": "backend",
            "tooltip": ["backend", "place", "ratio"],
            "filters": ["datum.place % 2 == 1 % 2 || hovered"],
        },
    ],
    "trade": [
        {"x": "bytes", "y": "seconds", "detail": "model", "order": "bytes", "filters": ["datum.least"]},
        {
            "x": "bytes",
            "y": "seconds",
            "shape": "backend",
            "stroke": "backend",
            "fill": "datum.front ? backend : transparent",
            "tooltip": ["backend", "model", "text", "bytes"],
        },
    ],
    "growth": [
        {
            "x": "size",
            "y": "ns",
            "color": "backend",
            "strokeDash": "backend",
            "shape": "backend",
            "detail": "run",
            "tooltip": ["backend", "run", "size", "ns"],
        }
    ],
    "fields": [
        {"x": "from", "x2": "to", "color": "field", "tooltip": ["backend", "field", "bytes"]},
        {"x": "middle", "text": "field", "filters": ["datum.bytes >= 5 * length(datum.field)"]},
    ],
    "limits": [
        {"x": "share", "fill": "backend", "stroke": "backend", "tooltip": ["backend", "text", "gb_per_s"]},
        {"x": "share", "text": "text"},
    ],
}


@pytest.mark.parametrize("kind", KINDS)
def test_each_channel_shows_the_field_that_it_should(one, kind):
    assert [channels(layer) for layer in one[kind].layers] == LAYERS[kind]
    outer = one[kind].spec.get("spec", one[kind].spec)
    assert channels({"encoding": outer.get("encoding", {})} if "layer" in outer else {}) == OUTER.get(kind, {})
    facet = one[kind].spec.get("facet", {})
    assert facet.get("row", facet).get("field") == FACETS.get(kind)


@pytest.mark.parametrize("kind", ["times", "samples", "trade", "fields", "limits"])
def test_several_models_change_no_field_but_stand_apart(two, kind):
    marks = [channels(layer) for layer in two[kind].layers]
    assert [{name: told for name, told in layer.items() if name != "yOffset"} for layer in marks] == LAYERS[kind]
    assert [layer.get("yOffset") for layer in marks][:2] == (["=0"] * 2 if kind == "times" else [None] * 2)
    if kind == "times":
        assert channels({"encoding": two[kind].spec["encoding"]}) == {"y": "backend", "yOffset": "model"}


@pytest.mark.parametrize("kind", KINDS)
def test_colours_shapes_and_dashes_are_looks(two, kind):
    """Of a channel by backend: each backend's own; of one by model: each model's."""
    charts = two[kind].spec["params"]
    backends = next(one["value"] for one in charts if one["name"] == "backends")
    subjects = make_subjects(make_runs(two_runs()))
    looks, shapes = looks_of(subjects), shapes_of(["nozzle", "intake"])
    part = {"color": "stroke", "stroke": "stroke", "fill": "fill", "shape": "shape", "strokeDash": "dash"}
    for layer in two[kind].layers:
        for name, channel in layer["encoding"].items():
            encoding = channel.get("condition", channel) if isinstance(channel, dict) else {}
            if name in part and encoding.get("field") == "backend":
                assert encoding["scale"]["domain"] == backends == [*looks]
                assert encoding["scale"]["range"] == [look[part[name]] for look in looks.values()]
            elif name in part and encoding.get("field") == "model":
                assert encoding["scale"] == {"domain": ["nozzle", "intake"], "range": [*shapes.values()]}


LOGARITHMIC = {  # what script.js makes linear when asked to
    "times": {"x"},
    "samples": {"y"},
    "trade": {"y"},
    "growth": {"x", "y"},
    "fields": set(),
    "limits": set(),
}


@pytest.mark.parametrize("kind", KINDS)
def test_scales_that_are_toggled_are_logarithmic_and_no_others(two, kind):
    for layer in two[kind].layers:
        for name in ("x", "y"):
            channel = layer["encoding"].get(name, {})
            if "field" in channel:
                is_log = channel.get("scale", {}).get("type") == "log"
                assert is_log == (name in LOGARITHMIC[kind]), (kind, name, channel)
    everywhere = re.findall(r"'type': 'log'", repr(two[kind].spec))
    assert bool(everywhere) == bool(LOGARITHMIC[kind])


PARAMETERS = {  # name -> what it is at first
    "times": {"backends", "models", "base"},
    "samples": {"backends", "models", "hovered"},
    "trade": {"backends", "models"},
    "growth": {"backends"},
    "fields": {"backends", "models"},
    "limits": {"backends", "models"},
}


@pytest.mark.parametrize("kind", KINDS)
def test_parameters_are_those_that_the_script_sets(two, grown, kind):
    chart = (grown if kind == "growth" else two)[kind]
    known = {one["name"]: one["value"] for one in chart.spec["params"]}
    assert known.keys() == PARAMETERS[kind]
    script = files("tetrabench.report.page").joinpath("script.js").read_text()
    asked = re.search(r"function asked\(\) \{.*?return \{(.*?)\};", script, re.DOTALL)
    assert asked
    is_set = {*re.findall(r"(\w+): data\.", asked[1]), *re.findall(r'one\.name === "(\w+)"', script)}
    assert known.keys() <= is_set
    assert set().union(*PARAMETERS.values()) == is_set - {"scale"}  # scales are no parameters
    first = {"backends": ["v3y", "v4"] if kind == "growth" else ["v3", "v3y", "v4", "v5y"], "base": "v3y"}
    first |= {"models": ["nozzle", "intake"], "hovered": False}
    assert known == {name: first[name] for name in known}
    filters = [one["filter"] for one in chart.spec["transform"]]
    expected = ["indexof(backends, datum.backend) >= 0", "indexof(models, datum.model) >= 0", "datum.base == base"]
    assert filters == [one for one, name in zip(expected, ("backends", "models", "base"), strict=True) if name in known]


# -- what is drawn


def logarithmic(marks: dict[float, float]) -> Any:
    """Place of a value, from marks at known places: least and largest tell, all others have to agree."""
    (low, x), (high, y) = min(marks.items()), max(marks.items())
    slope = (y - x) / math.log(high / low)
    place = lambda value: x + slope * math.log(value / low)  # noqa: E731
    for value, at in marks.items():
        assert at == pytest.approx(place(value), abs=0.01)
    return place


def of_base(rows: list[figures.Datum], base: str) -> list[figures.Datum]:
    return [row for row in rows if row["base"] == base]


@pytest.mark.parametrize("base", ["v3y", ABSOLUTE])
def test_times_are_drawn_where_they_are(base):
    """Marks, ends of intervals, words and the band of what is the same, each at its number; a hollow one is not sure."""
    results = change(make_results(TASKS, wobble=0.3), "alfa", "v4", status="crash")
    chart = charts_of([("run", results)], base)["times"]
    band, line, intervals, points, words, others = map(chart.marks, range(6))
    rows = of_base(chart.rows, base)
    known = [row for row in rows if row["value"] is not None]
    ranged = [row for row in known if row["low"] is not None]
    assert (len(points), len(intervals)) == (len(known), len(ranged))
    assert len(points) == 3
    place = logarithmic({row["value"]: mark["x"] for row, mark in zip(known, points, strict=True)})
    assert [mark["text"] for mark in others] == ["crashed"]
    for row, mark in zip(known, points, strict=True):
        assert (mark.get("fill") != "transparent") == row["sure"]
    for row, mark in zip(ranged, intervals, strict=True):
        assert sorted((mark["x"], mark["x2"])) == pytest.approx([place(row["low"]), place(row["high"])], abs=0.01)
    shown = [row for row in known if row["text"] != "1"]
    assert [mark["text"] for mark in words] == [row["text"] for row in shown]
    assert [mark["x"] for mark in words] == pytest.approx([place(row["edge"]) for row in shown], abs=0.01)
    if base == ABSOLUTE:
        assert (band, line) == ([], [])
    else:
        (same,), (alike,) = band, line
        assert sorted((same["x"], same["x2"])) == pytest.approx([place(1 / ALIKE), place(ALIKE)], abs=0.01)
        assert (same["y"], same["y2"]) == (0, chart.spec["height"])
        assert alike["x"] == pytest.approx(place(1.0), abs=0.01)


def test_nobody_is_compared_with_who_crashed():
    results = change(make_results(TASKS), "alfa", "v4", status="crash")
    chart = charts_of([("run", results)], "v4")["times"]
    assert not chart.marks(3)
    assert [mark["text"] for mark in chart.marks(5)] == ["no ref.", "no ref.", "crashed", "no ref."]


def test_a_hint_is_hollow():
    """One launch: nothing is sure but the reference itself."""
    chart = charts_of([("run", make_results({"alfa": {"v3": 1.2, "v3y": 1.0, "v4": 1.4}}, launches=1, rounds=2))])[
        "times"
    ]
    fills = {row["text"]: mark["fill"] for row, mark in zip(of_base(chart.rows, "v3y"), chart.marks(3), strict=True)}
    assert {text: fill == "transparent" for text, fill in fills.items()} == {"1.2?": True, "1": False, "1.4?": True}


def test_times_of_two_models_are_drawn_row_by_row(two):
    """Two marks a backend, in the shapes of the models; whoever crashed on one has a word there."""
    points = two["times"].marks(3)
    assert len(points) == len([row for row in of_base(two["times"].rows, "v3y") if row["value"] is not None]) == 7
    assert [mark["shape"] for mark in points] == ["circle"] * 4 + ["diamond"] * 3
    assert len({mark["y"] for mark in points} | {mark["y"] for mark in two["times"].marks(5)}) == 8


def test_samples_are_drawn_where_they_are_and_noise_from_quiet_to_loud():
    chart = charts_of([("run", make_results(TASKS, launches=4, rounds=3, wobble=0.4))])["samples"]
    (noise,), points = chart.marks(0), chart.marks(2)
    vertices = [dot for line in (chart.marks(1),) for dot in line]
    assert len(vertices) == len(chart.rows) == 4 * 12
    by_place = {(row["backend"], row["place"]): row["ratio"] for row in chart.rows}
    every = 12 // MARKS
    assert len(points) == len([row for row in chart.rows if row["place"] % every == 1 % every])
    heights = {mark["y"] for mark in vertices}
    ratios = sorted(by_place.values(), reverse=True)
    place = logarithmic(dict(zip(ratios, sorted(mark["y"] for mark in vertices), strict=True)))
    ends = [place(min(row["quiet"] for row in chart.rows)), place(max(row["loud"] for row in chart.rows))]
    assert sorted((noise["y"], noise["y2"])) == pytest.approx(sorted(ends), abs=0.01)
    assert len(heights) > 12
    assert abs(noise["y"] - noise["y2"]) > 5


def test_noise_of_several_references_is_all_that_any_of_their_copies_showed(one):
    """As in a run of the gate, where each has a reference of its own; one without a copy says nothing of noise."""
    spans = [{"quiet": 0.9, "loud": 1.05}, {"quiet": 0.97, "loud": 1.2}, {"quiet": None, "loud": None}]
    rows = [{**row, **spans[place % 3]} for place, row in enumerate(one["samples"].rows)]
    chart = Drawn(rows, {**one["samples"].spec, "data": {"name": "rows", "values": rows}})
    (noise,) = chart.marks(0)
    ratios = sorted((row["ratio"] for row in rows), reverse=True)
    place = logarithmic(dict(zip(ratios, sorted(dot["y"] for dot in chart.marks(1)), strict=True)))
    assert sorted((noise["y"], noise["y2"])) == pytest.approx([place(1.2), place(0.9)], abs=0.01)


def test_lines_of_samples_carry_some_marks_however_many_rounds_there_are():
    chart = charts_of([("run", make_results({"alfa": {"v3y": 1.0, "v4": 2.0}}, launches=10, rounds=8))])["samples"]
    assert len(chart.marks(1)) == 2 * 80
    assert len(chart.marks(2)) == 2 * MARKS


def test_the_front_is_filled_and_joined_from_left_to_right():
    """v3y is faster and larger than v3; v4 is beaten in both; v5y, as fast as v3 and larger, by v3."""
    seconds = {"alfa": {"v3": 2.0, "v3y": 1.0, "v4": 4.0, "v5y": 2.0}, "init": {"v3": 1.0, "v3y": 1.0}}
    results = make_results(seconds, wobble=0.0)
    sizes = {"v3": 100, "v3y": 150, "v4": 400, "v5y": 130}
    memory = [make_memory(name, peak_bytes=642_720 * size) for name, size in sizes.items()]
    chart = charts_of([("run", msgspec.structs.replace(results, memory=memory))])["trade"]
    line, points = chart.marks(0), chart.marks(1)
    assert len(points) == len(chart.rows) == 6
    front = {(row["task"], row["backend"]) for row in chart.rows if row["front"]}
    assert front == {("alfa", "v3"), ("alfa", "v3y"), ("init", "v3")}
    for row, mark in zip(chart.rows, points, strict=True):
        assert (mark["fill"] != "transparent") == row["front"], row
    marks = {(row["task"], row["backend"]): mark for row, mark in zip(chart.rows, points, strict=True)}
    ends = [marks[who] for who in (("alfa", "v3"), ("alfa", "v3y"), ("init", "v3"))]
    assert [(mark["x"], mark["y"]) for mark in line] == [(mark["x"], mark["y"]) for mark in ends]
    alfa = {backend: mark for (task, backend), mark in marks.items() if task == "alfa"}
    assert alfa["v3"]["x"] < alfa["v5y"]["x"] < alfa["v3y"]["x"] < alfa["v4"]["x"]  # larger is right
    assert alfa["v3y"]["y"] > alfa["v3"]["y"] == alfa["v5y"]["y"] > alfa["v4"]["y"]  # slower is up
    logarithmic({row["seconds"]: alfa[row["backend"]]["y"] for row in chart.rows if row["task"] == "alfa"})


def test_growth_is_drawn_where_it_is(grown):
    chart = grown["growth"]
    marks = chart.marks()
    dots = [mark for mark in marks if "shape" in mark]
    assert len(dots) == len(chart.rows) == 10
    assert len(marks) == 2 * len(dots)  # and each is a corner of a line
    sizes = sorted(row["size"] for row in chart.rows)
    logarithmic(dict(zip(sizes, sorted(mark["x"] for mark in dots), strict=True)))
    ns = sorted((row["ns"] for row in chart.rows), reverse=True)
    logarithmic(dict(zip(ns, sorted(mark["y"] for mark in dots), strict=True)))


def test_buffers_are_as_long_as_they_are_large():
    """Stacked without a gap, what all have last; what nobody could see is left out, and only what is wide is named."""
    tetras = 642_720
    results = make_results({"alfa": {"v3y": 1.0, "v4": 1.0}})
    memory = [
        make_memory(
            "v3y", structure={"tetras": (200 * tetras, 999 * tetras), "holes": (1, 1), "tree": (9 * tetras, 9)}
        ),
        make_memory("v4", structure={"tetras": (264 * tetras, 999 * tetras), "node": (66 * tetras, 66 * tetras)}),
    ]
    chart = charts_of([("run", msgspec.structs.replace(results, memory=memory))])["fields"]
    bars, names = chart.marks(0), chart.marks(1)
    assert {(row["backend"], row["field"]): row["bytes"] for row in chart.rows if row["bytes"] > 1} == {
        ("v3y", "tetras"): 200,
        ("v3y", "tree"): 9,
        ("v4", "tetras"): 264,
        ("v4", "node"): 66,
    }
    longest = max(mark["width"] for mark in bars)
    assert sorted(mark["width"] / longest * 264 for mark in bars) == pytest.approx([9, 66, 200, 264], rel=1e-3)
    assert {mark["text"] for mark in names} == {"tetras", "node"}
    for y in {mark["y"] for mark in bars}:
        first, last = sorted((mark["x"], mark["width"]) for mark in bars if mark["y"] == y)
        assert first[0] == pytest.approx(0)
        assert last[0] == pytest.approx(first[1])
        assert first[1] < last[1]  # that of one backend alone, then the tetras


@pytest.mark.parametrize("kind", ["one", "two"])
def test_shares_of_the_limit_are_as_long_as_they_are(kind, request):
    chart = request.getfixturevalue(kind)["limits"]
    bars, words = chart.marks(0), chart.marks(1)
    assert len(bars) == len(words) == len(chart.rows) == (4 if kind == "one" else 7)
    full = max(row["share"] for row in chart.rows)
    longest = max(mark["width"] for mark in bars)
    assert [mark["width"] / longest for mark in bars] == pytest.approx([row["share"] / full for row in chart.rows])
    assert [mark["text"] for mark in words] == [row["text"] for row in chart.rows]


@pytest.mark.parametrize(("kind", "marks"), [("times", 7), ("samples", 7 * 8), ("trade", 12), ("limits", 0)])
def test_a_picture_has_as_many_symbols_as_there_are_rows(two, kind, marks):
    svg = vl_convert.vegalite_to_svg(two[kind].spec)
    groups = re.findall(r'<g class="mark-symbol role-mark [^"]*"[^>]*>(.*?)</g>', svg, re.DOTALL)
    assert sum(group.count("<path") for group in groups) == marks


@pytest.mark.parametrize("kind", KINDS)
def test_whoever_is_not_wanted_is_not_drawn(two, grown, kind):
    """The parameters do what script.js expects of them."""
    chart = (grown if kind == "growth" else two)[kind]
    params = [{**one, "value": ["v3y"]} if one["name"] == "backends" else one for one in chart.spec["params"]]
    fewer = Drawn(chart.rows, {**chart.spec, "params": params})
    assert 0 < len(fewer.marks()) < len(chart.marks())
    if kind == "growth":
        return
    params = [{**one, "value": ["intake"]} if one["name"] == "models" else one for one in chart.spec["params"]]
    none = Drawn(chart.rows, {**chart.spec, "params": params})
    assert (len(none.marks()) == 0) == (kind == "trade")  # which is of the other model alone
    assert len(none.marks()) < len(chart.marks())
