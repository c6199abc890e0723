"""The charts of lines of a page: the numbers behind them, what each mark shows, and where it is drawn."""

import re

import pytest

from tests.report.made_lines import CAPACITIES, STRETCHES, make_contestants, make_run
from tests.report.page.test_charts import Drawn, channels, logarithmic
from tests.report.page.test_page import Page, figures_of
from tetrabench.bench.record import Results
from tetrabench.report.page import line_figures, make_page
from tetrabench.report.page.line_charts import DASHED, MARKS, LineCharts
from tetrabench.report.page.looks import looks_of, shapes_of
from tetrabench.report.page.subjects import Subject, make_runs, make_subjects
from tetrabench.report.page.tables import along_table, curves_table
from tetrabench.report.series import courses_of

vl_convert = pytest.importorskip("vl_convert")

AREAS = {f"concentration area={area}": factor for area, factor in ((100, 1.0), (1000, 1.7), (10_000, 2.5))}
EVERYBODY = make_contestants(CAPACITIES)


def subject_of(results: Results) -> Subject:
    (subject,) = make_subjects(make_runs([("run", results)]))
    return subject


def charts_of(subject: Subject) -> LineCharts:
    return LineCharts(looks_of([subject]), shapes_of([subject.label]), "kdtree")


def along_of(results: Results, *, is_time: bool) -> Drawn:
    subject = subject_of(results)
    (shown,) = (one for one in line_figures.along(subject) if one.is_time == is_time)
    return Drawn(shown.rows, charts_of(subject).along(shown.rows, shown.axis, is_time=is_time))


def curves_of(results: Results) -> Drawn:
    subject = subject_of(results)
    ((curves, rows),) = line_figures.over_options(subject)
    return Drawn(rows, charts_of(subject).curves(rows, curves.option))


@pytest.fixture(scope="module")
def along() -> Drawn:
    return along_of(make_run({"gravity": 1.0}, make_contestants()), is_time=True)


@pytest.fixture(scope="module")
def curves() -> Drawn:
    return curves_of(make_run({"motion": 1.0}, EVERYBODY, launches=12))


def test_rows_along_a_run_are_its_tracks():
    results = make_run({"gravity": 1.0}, make_contestants(), launches=3)
    subject = subject_of(results)
    times, counts = line_figures.along(subject)
    assert (times.task, times.axis, times.is_time, counts.is_time) == ("gravity", "step", True, False)
    (course,) = courses_of(results, subject.rows())
    for shown in (times, counts):
        found = {(row["panel"], row["line"], row["place"]): row["value"] for row in shown.rows}
        assert found == {
            (course.heading(track.quantity), track.line.label, place): value
            for track in course.tracks
            if track.is_time == shown.is_time
            for place, value in zip(track.places, track.values, strict=True)
        }
    assert {row["line"] for row in times.rows if row["wrong"]} == {"leaf-only (wrong answers)"}
    assert {row["backend"] for row in times.rows if row["wrong"]} == {"leaf-only"}


def test_each_channel_along_a_run_shows_the_field_that_it_should(along):
    line, marks = along.layers
    assert channels(line) == {"x": "place", "y": "value", "color": "line", "strokeDash": "line"}
    every = STRETCHES // MARKS
    tooltip = ["line", "place", "value"]
    assert channels(marks) == {
        "x": "place",
        "y": "value",
        "color": "line",
        "shape": "line",
        "tooltip": tooltip,
        "filters": [f"datum.spot % {every} == 0"],
    }
    assert along.spec["facet"]["field"] == "panel"


def test_stretches_are_drawn_where_they_are(along):
    lines, marks = along.marks(0), along.marks(1)
    assert len(lines) == len(along.rows) == 5 * 6 * STRETCHES  # whole and four phases, of six
    assert len(marks) == 5 * 6 * MARKS
    whole = [row for row in along.rows if row["panel"] == "time of a step"]
    first = lines[: 6 * STRETCHES]
    logarithmic(
        dict(
            zip(sorted((row["value"] for row in whole), reverse=True), sorted(mark["y"] for mark in first), strict=True)
        )
    )
    places = sorted({row["place"] for row in along.rows})
    at = sorted({round(mark["x"], 3) for mark in lines})
    assert at == pytest.approx([at[0] + (at[-1] - at[0]) * (place - 25) / (1000 - 25) for place in places], abs=0.01)


def test_counts_begin_at_nought_whatever_they_span():
    counts = along_of(make_run({"gravity": 1.0}, make_contestants()), is_time=False)
    assert "'type': 'log'" not in repr(counts.spec)
    near = along_of(make_run({"gravity": 1.0}, make_contestants(names=["kdtree", "grid"])), is_time=True)
    assert "'type': 'log'" not in repr(near.spec)


@pytest.mark.parametrize("kind", ["along", "curves"])
def test_lines_have_the_looks_of_their_backends_and_wrong_ones_long_dashes(kind, request):
    chart = request.getfixturevalue(kind)
    results = make_run({"gravity": 1.0}, EVERYBODY if kind == "curves" else make_contestants())
    looks = looks_of([subject_of(results)])
    part = {"color": "stroke", "shape": "shape", "strokeDash": "dash"}
    seen = set()
    of = {row["line"]: row for row in chart.rows}
    for layer in chart.layers:
        for channel, name in part.items():
            encoding = layer["encoding"].get(channel, {})
            if encoding.get("field") == "line":
                seen.add(channel)
                assert encoding["scale"]["domain"] == [*of]
                for line, look in zip(of, encoding["scale"]["range"], strict=True):
                    is_long = of[line]["wrong"] and channel == "strokeDash"
                    assert look == (DASHED if is_long else looks[of[line]["look"]][name])
                assert encoding["legend"]["values"] == [line for line, row in of.items() if not row.get("level")]
    assert seen == part.keys()
    assert DASHED not in [look["dash"] for look in looks.values()]


def test_points_levels_and_the_least_are_drawn_where_they_are(curves):
    levels, names, lines, whiskers, hollow, filled, ring, words = map(curves.marks, range(8))
    points = [row for row in curves.rows if not row["level"]]
    assert len(lines) == len(points) == len(hollow) + len(filled) == 2 * len(CAPACITIES)
    assert [mark["text"] for mark in names] == ["grid*", "skin*", "ckdtree"]
    assert len(levels) == 3
    assert len(whiskers) == sum(row["low"] < row["high"] for row in points)
    assert len(filled) == sum(row["sure"] for row in points) >= 1
    (least,) = (row for row in points if row["least"])
    assert [mark["text"] for mark in words] == [f"capacity=16: {least['text']}"]
    assert [(mark["x"], mark["y"]) for mark in ring] == [
        (mark["x"], mark["y"]) for row, mark in zip(points, lines, strict=True) if row["least"]
    ]
    place = {row["value"]: mark["y"] for row, mark in zip(points, lines, strict=True)}
    top = max(place)
    slope = (place[top] - place[min(place)]) / (top - min(place))
    for value, y in place.items():  # from nought, not logarithmic
        assert y == pytest.approx(place[top] + slope * (value - top), abs=0.01)
    logarithmic({row["place"]: mark["x"] for row, mark in zip(points, lines, strict=True)})
    for row, mark in zip([row for row in curves.rows if row["level"]], levels, strict=True):
        assert mark["y"] == pytest.approx(place[top] + slope * (row["value"] - top), abs=0.01)


@pytest.mark.parametrize("kind", ["along", "curves"])
def test_whoever_is_not_wanted_is_not_drawn(kind, request):
    chart = request.getfixturevalue(kind)
    one = "kdtree" if kind == "along" else "kdtree capacity=4"
    params = [{**param, "value": [one]} if param["name"] == "backends" else param for param in chart.spec["params"]]
    fewer = Drawn(chart.rows, {**chart.spec, "params": params})
    assert 0 < len(fewer.marks()) < len(chart.marks())
    params = [{**param, "value": []} if param["name"] == "models" else param for param in chart.spec["params"]]
    assert not Drawn(chart.rows, {**chart.spec, "params": params}).marks()


def test_tables_say_what_charts_say():
    subject = subject_of(make_run({"motion": 1.0}, EVERYBODY, launches=12))
    ((curves, _),) = line_figures.over_options(subject)
    table = curves_table(subject, curves)
    assert table.head == ["backend", "capacity", "per item", "launches", "verdict"]
    lines = [(line.heads[0], *(cell.value for cell in line.cells[:2]), line.cells[3].text) for line in table.lines]
    assert lines == [
        (
            curve.label,
            point.value if curve in curves.curves else None,
            point.seconds,
            "least" if point.is_least else "slower" if point.is_beaten else "",
        )
        for curve in (*curves.curves, *curves.levels, *curves.beyond)
        for point in curve.points
    ]
    assert "brute" in [line.heads[0] for line in table.lines]  # which the chart has no room for
    times, counts = line_figures.along(subject)
    for shown in (times, counts):
        for line in along_table(shown, subject.label).lines:
            panel, name = line.heads
            values = [row["value"] for row in shown.rows if (row["panel"], row["line"]) == (panel, name)]
            first, least, _, largest, last = (cell.value for cell in line.cells)
            assert (first, least, largest, last) == (values[0], min(values), max(values), values[-1])


def test_sections_are_there_where_there_is_something_to_show():
    page = make_page([("run", make_run({"gravity": 1.0, **AREAS}, EVERYBODY, launches=2))])
    assert 'id="options"' in page
    assert 'id="along"' in page
    assert {figure["kind"] for figure in figures_of(page).values()} >= {"along", "curves"}
    names = [name for name in figures_of(page) if name.startswith(("along", "option", "count"))]
    assert len(names) == 2 * 4 + 4 + 1
    assert not [caption for caption, _, _ in Page(page).lines if "None" in caption]
    plain = make_page([("run", make_run({"motion": 1.0}, make_contestants(), launches=2, stretches=0))])
    assert 'id="options"' not in plain
    assert 'id="along"' not in plain


def test_a_thousand_samples_with_series_are_a_small_page():
    """Only medians go into it: the samples themselves have three times as much."""
    tasks = {"motion": 1.0, "gravity": 2.0, "weightless": 1.0}
    backends = make_contestants(CAPACITIES)
    results = make_run(tasks, backends, launches=10, rounds=2, stretches=100)
    assert len(results.samples) > 1000
    assert len(make_page([("run", results)]).encode()) < 3e6


def test_names_are_quoted_where_they_become_expressions(curves):
    subject = subject_of(make_run({"motion": 1.0}, EVERYBODY, launches=2))
    ((_, rows),) = line_figures.over_options(subject)
    hostile = "it's' + \\ datum.value //"
    chart = Drawn(rows, charts_of(subject).curves(rows, hostile))
    assert [re.sub(r": .*", "", mark["text"]) for mark in chart.marks(7)] == [f"{hostile}=16"]
