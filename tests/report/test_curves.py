"""Curves: which there are, where their points lie, which is the least and who is shown to be slower."""

from itertools import pairwise
from statistics import median

import msgspec
import pytest

from tests.report.made_lines import CAPACITIES, make_contestants, make_run
from tetrabench.bench import summary
from tetrabench.bench.record import Backend, Results
from tetrabench.bench.statistics import summary_against
from tetrabench.report.curves import FAR, GAP, Curves, curves_over_counts, curves_over_options, spans
from tetrabench.report.lines import MOST_ALIKE

AREAS = {f"concentration area={area}": factor for area, factor in ((100, 1.0), (1000, 1.7), (10_000, 2.5))}
EVERYBODY = make_contestants(CAPACITIES)


def over_options(results: Results) -> list[Curves]:
    return curves_over_options(results, summary(results), lambda base: summary_against(results, base))


def over_counts(results: Results) -> list[Curves]:
    return curves_over_counts(results, summary(results))


def recycled(backend: Backend, recycle: int) -> Backend:
    name = f"{backend.name} recycle={recycle}"
    return msgspec.structs.replace(backend, name=name, options=backend.options | {"recycle": recycle})


def test_points_are_the_times_of_an_item_and_the_range_of_the_launches():
    results = make_run({"motion": 1.0, "gravity": 2.0}, EVERYBODY, launches=4, rounds=3)
    charts = over_options(results)
    rows = {(row.task, row.backend): row for row in summary(results)}
    assert [(one.task, one.contestant, one.option) for one in charts] == [
        ("motion", "kdtree", "capacity"),
        ("gravity", "kdtree", "capacity"),
    ]
    for chart in charts:
        tree, wrong = chart.curves
        assert (tree.label, wrong.label) == ("kdtree", "leaf-only (wrong answers)")
        assert [point.value for point in tree.points] == [point.value for point in wrong.points] == [*CAPACITIES]
        for point in (*tree.points, *(level.points[0] for level in chart.levels)):
            row = rows[chart.task, point.line.backend.name]
            assert point.seconds * 1e9 == pytest.approx(row.ns_per_item)
        for point in chart.points:
            launches: dict[int, list[float]] = {}
            for one in results.samples:
                if (one.task, one.backend) == (chart.task, point.line.backend.name):
                    launches.setdefault(one.launch, []).append(one.cpu_s / one.items)
            middles = [median(one) for one in launches.values()]
            assert (point.low, point.high) == pytest.approx((min(middles), max(middles)))
            assert point.low <= point.seconds <= point.high


def test_the_least_has_none_below_it_and_who_is_slower_is_shown_to_be():
    results = make_run({"motion": 1.0}, EVERYBODY, launches=12)
    (chart,) = over_options(results)
    tree, wrong = chart.curves
    (least,) = (point for point in tree.points if point.is_least)
    assert least.value == 16
    assert all(point.seconds >= least.seconds for point in tree.points)
    verdicts = {row.backend: row.verdict for row in summary_against(results, "kdtree capacity=16")}
    assert {point.value: point.is_beaten for point in tree.points} == {
        capacity: verdicts[f"kdtree capacity={capacity}"] == "slower" for capacity in CAPACITIES
    }
    assert any(point.is_beaten for point in tree.points)
    assert not any(point.is_least or point.is_beaten for point in wrong.points)


def test_what_one_launch_cannot_tell_is_not_beaten():
    (chart,) = over_options(make_run({"motion": 1.0}, EVERYBODY, launches=1))
    assert not any(point.is_beaten for point in chart.points)
    assert sum(point.is_least for point in chart.points) == 1


def test_everybody_else_is_a_level_unless_it_is_far():
    (chart,) = over_options(make_run({"motion": 1.0}, EVERYBODY))
    assert [level.label for level in chart.levels] == ["grid*", "skin*", "ckdtree"]
    assert [level.label for level in chart.beyond] == ["brute"]
    top = max(point.seconds for curve in chart.curves for point in curve.points)
    assert chart.beyond[0].points[0].seconds > FAR * top


def test_a_contestant_with_other_options_is_a_level_at_its_quickest():
    skins = [
        msgspec.structs.replace(one, name=f"skin skin={skin}", options={"skin": skin})
        for one in make_contestants(names=["skin"])
        for skin in (10, 20)
    ]
    backends = [*make_contestants(CAPACITIES, names=["kdtree"]), *skins]
    backends = [msgspec.structs.replace(one, against=backends[0].name) for one in backends]
    results = make_run({"motion": 1.0}, backends, launches=2)
    samples = [
        msgspec.structs.replace(one, cpu_s=one.cpu_s * 2) if one.backend == "skin skin=20" else one
        for one in results.samples
    ]
    (chart,) = over_options(msgspec.structs.replace(results, samples=samples))
    assert [level.label for level in chart.levels] == ["skin skin=10*"]


def test_each_value_of_another_option_has_a_curve():
    both = [recycled(one, recycle) for one in make_contestants(CAPACITIES, names=["kdtree"]) for recycle in (0, 1)]
    both = [msgspec.structs.replace(one, against=both[0].name) for one in both]
    (chart,) = over_options(make_run({"motion": 1.0}, both))
    assert [curve.label for curve in chart.curves] == ["kdtree recycle=0", "kdtree recycle=1"]
    assert [sum(point.is_least for point in curve.points) for curve in chart.curves] == [1, 1]
    assert chart.curves[0].key != chart.curves[1].key  # they do not look alike


@pytest.mark.parametrize("capacities", [(), (4,), (4, 8)])
def test_two_values_are_no_curve(capacities):
    assert over_options(make_run({"motion": 1.0}, make_contestants(capacities))) == []


def test_whoever_went_wrong_has_no_point():
    results = make_run({"motion": 1.0}, EVERYBODY)
    samples = [
        msgspec.structs.replace(one, status="wrong-result") if one.backend in ("kdtree capacity=16", "grid") else one
        for one in results.samples
    ]
    (chart,) = over_options(msgspec.structs.replace(results, samples=samples))
    assert [point.value for point in chart.curves[0].points] == [one for one in CAPACITIES if one != 16]
    assert "grid*" not in [level.label for level in chart.levels]


def test_a_curve_that_is_wrong_at_one_value_ranks_at_none():
    """As where objects lie so far apart that an inexact contestant happens to find all."""
    results = make_run({"motion": 1.0}, EVERYBODY)
    samples = [
        msgspec.structs.replace(one, status="ok")
        if one.backend in ("leaf-only capacity=32", "leaf-only capacity=63")
        else one
        for one in results.samples
    ]
    (chart,) = over_options(msgspec.structs.replace(results, samples=samples))
    assert chart.curves[1].label == "leaf-only (wrong answers)"
    assert [point.value for point in chart.curves[1].points] == [*CAPACITIES]
    assert not any(point.is_least for point in chart.curves[1].points)


def test_a_count_of_a_scenario_has_a_curve_for_each_backend():
    results = make_run({"build": 1.0, **AREAS}, make_contestants())
    (chart,) = over_counts(results)
    assert (chart.task, chart.contestant, chart.option, chart.levels) == ("concentration", "", "area", [])
    assert [curve.label for curve in chart.curves][:2] == ["kdtree", "grid*"]
    assert chart.curves[-1].label == "leaf-only (wrong answers)"
    rows = {(row.task, row.backend): row.ns_per_item for row in summary(results)}
    for point in chart.curves[0].points:
        assert point.seconds * 1e9 == pytest.approx(rows[f"concentration area={point.value}", "kdtree"])
    assert [point.value for point in chart.curves[0].points] == [100, 1000, 10_000]
    assert not any(point.is_least or point.is_beaten for point in chart.points)


def test_another_count_has_a_chart_for_each_of_its_values():
    tasks = {f"concentration area={area} steps={steps}": 1.0 for area in (1, 2, 3) for steps in (10, 20)}
    charts = over_counts(make_run(tasks, make_contestants(names=["kdtree", "grid"])))
    assert [(one.task, one.option) for one in charts] == [
        ("concentration steps=10", "area"),
        ("concentration steps=20", "area"),
    ]


def test_of_many_options_some_have_a_curve_over_a_count():
    (chart,) = over_counts(make_run(AREAS, make_contestants(range(1, 21), names=["kdtree"]), launches=1))
    assert len(chart.curves) == MOST_ALIKE


def test_axes_are_logarithmic_where_values_span_much():
    assert spans([1, 31])
    assert not spans([1, 30])
    assert not spans([0, 1000])  # a logarithm has no nought
    (chart,) = over_options(make_run({"motion": 1.0}, EVERYBODY))
    assert (chart.is_wide, chart.is_tall) == (True, False)
    (chart,) = over_options(make_run({"motion": 1.0}, make_contestants((4, 8, 16))))
    assert not chart.is_wide


def test_labels_of_levels_do_not_lie_on_each_other():
    results = make_run({"motion": 1.0}, EVERYBODY)
    samples = [
        msgspec.structs.replace(one, cpu_s=4.0, process_cpu_s=4.0)
        if one.backend in ("grid", "skin", "ckdtree")
        else one
        for one in results.samples
    ]
    (chart,) = over_options(msgspec.structs.replace(results, samples=samples))
    places = sorted(chart.label_seconds)
    top = max(point.seconds for point in chart.points)
    assert places[0] == pytest.approx(4.0 / 1e7)
    assert [(after - before) / top for before, after in pairwise(places)] == pytest.approx([GAP] * 2)
