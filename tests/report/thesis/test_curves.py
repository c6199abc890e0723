"""Curves of a source drawn by runs: what findings say of them, which runs draw them, figures, tables, pages."""

import math
import re

import msgspec
import pytest

from tests.report.made import change, slow
from tests.report.thesis.curve_runs import (
    CAPACITIES,
    ENDS,
    SIZES,
    all_runs,
    capacity_run,
    concentration_run,
    objects_run,
    recycling_run,
)
from tetrabench.bench.statistics import SHORTEST_S
from tetrabench.errors import InputError
from tetrabench.report.thesis.comparison import Comparison, compare_with_source
from tetrabench.report.thesis.curve_figures import draw_curves
from tetrabench.report.thesis.curves import trace
from tetrabench.report.thesis.page import as_html, as_markdown, make_section, write_markdown
from tetrabench.sources.collision import SOURCE

PUBLISHED, REPAIRED = "leaf-only, as published", "kdtree, as it should have been"
ENOUGH = {"launches": 12}  # for an interval of the sixteen backends of a run over capacities
CURVES = [curve for figure in SOURCE.drawn for curve in figure.curves]


@pytest.fixture(scope="module")
def runs():
    return all_runs(**ENOUGH)


def outcomes(*runs):
    """What each contestant says of each finding."""
    judged = compare_with_source(runs, SOURCE).findings
    return {(finding.name, one.subject.split(",")[0]): one.outcome for finding in judged for one in finding.outcomes}


def asked(contestant, *runs):
    return trace(CURVES, contestant, runs, SOURCE)


# -- findings


def test_as_published_and_as_it_should_have_been(runs):
    said = outcomes(*runs)
    lost = {one for one, outcome in said.items() if outcome == "holds no longer"}
    assert lost == {
        ("optimum", "kdtree"),
        ("hypothesis 2", "leaf-only"),
        ("concentration", "kdtree"),
        ("kink", "kdtree"),
    }
    assert set(said.values()) == {"holds", "holds no longer"}


FAULTS = [  # what a run draws, and the findings that it takes away from kdtree, which has them otherwise
    (lambda: capacity_run((1, 9), **ENOUGH), {"hypothesis 1"}),
    (lambda: capacity_run((63, 9), **ENOUGH), {"hypothesis 1"}),
    (lambda: concentration_run((1.4, 1.2)), {"hypothesis 2"}),
    (lambda: recycling_run(flat=1.7), {"hypothesis 3", "flat"}),
    (lambda: recycling_run(slower=1.1), {"growing"}),
    (lambda: recycling_run(leaves=1.2), {"hypothesis 4", "growing"}),
    (lambda: objects_run(exponent=1.5), {"linear"}),
]


@pytest.mark.parametrize(("make", "names"), FAULTS)
def test_each_finding_is_lost_where_it_is_false(make, names):
    said = outcomes(make())
    lost = {name for (name, one), outcome in said.items() if one == "kdtree" and outcome == "holds no longer"}
    assert lost - {"optimum", "concentration", "kink"} == names


def test_each_finding_is_found_where_it_is_true():
    assert outcomes(capacity_run((9, 9), **ENOUGH))["optimum", "kdtree"] == "holds"
    assert outcomes(concentration_run((1.4, 1.2)))["concentration", "kdtree"] == "holds"
    assert outcomes(objects_run(exponent=1.5))["kink", "kdtree"] == "holds"


def test_recycling_that_slows_a_run_without_gravity_is_noticed():
    run = recycling_run()
    assert outcomes(slow(run, "weightless", "kdtree recycle=0", 1.3))["no effect", "kdtree"] == "holds no longer"
    assert outcomes(slow(run, "weightless", "kdtree recycle=0", 0.7))["no effect", "kdtree"] == "holds no longer"


def test_where_nobody_looked_nothing_is_said():
    said = outcomes(concentration_run())
    assert said["hypothesis 2", "kdtree"] == "holds"
    assert {outcome for (name, _), outcome in said.items() if name not in ("hypothesis 2", "concentration")} == {
        "not measured"
    }


def test_few_launches_tell_only_what_is_far_from_its_limit():
    assert outcomes(capacity_run(launches=2))["optimum", "kdtree"] == "cannot tell"
    assert outcomes(capacity_run((9, 9), launches=2))["optimum", "kdtree"] == "holds"  # the best beside itself
    assert outcomes(concentration_run((9.0, 1.2), launches=2))["hypothesis 2", "kdtree"] == "holds"


# -- the questions


def test_ratios_are_paired_in_each_launch():
    """Each launch is slower than the one before for all alike: in ratios that cancels, in times it does not."""
    curves = asked("kdtree", concentration_run())
    ratio = curves.between("figure 11", 100, 1_000_000)
    assert ratio.is_whole
    assert (ratio.low, ratio.high) == pytest.approx((2.5, 2.5))
    traced = curves.traced["figure 11"]
    time = traced.time(traced.points[0])
    assert time.low < 0.9 * time.high


def test_between_sizes_only_the_range_is_honest():
    run = objects_run()
    moved = [
        msgspec.structs.replace(one, cpu_s=1.3 * one.cpu_s)
        if (one.launch, one.model, one.backend) == (7, "uniform-100000", "kdtree")
        else one
        for one in run.samples
    ]
    figure = asked("kdtree", msgspec.structs.replace(run, samples=moved)).between("figure 7", 100_000, 50_000)
    assert (figure.ratio, figure.low, figure.high) == pytest.approx((2.0, 2.0, 2.6))
    assert figure.is_whole
    assert asked("kdtree", objects_run(launches=3)).between("figure 7", 100_000, 50_000).is_whole
    assert not asked("kdtree", objects_run(launches=2)).between("figure 7", 100_000, 50_000).is_whole


def test_growth_is_from_the_first_tenth_to_the_last():
    curves = asked("kdtree", recycling_run(slower=3.0, leaves=4.0))
    steps = len(ENDS) - 1
    last, first = [3 ** (place / steps) for place in (steps - 1, steps)], [3 ** (place / steps) for place in (0, 1)]
    assert curves.grown("figure 14").ratio == pytest.approx(sum(last) / sum(first))
    assert curves.grown("figure 14", "leaves").ratio == pytest.approx(4 ** (1 - 1 / steps), rel=1e-3)
    assert curves.grown("figure 14", "depth") is None
    assert curves.grown("figure 7") is None


def test_runs_beside_each_other():
    curves = asked("kdtree", recycling_run(slower=3.0, leaves=4.0, flat=1.0))
    assert curves.beside("figure 14", "figure 15", "leaves").ratio == 4.0
    shares = [3 ** (place / (len(ENDS) - 1)) for place in range(len(ENDS))]
    assert curves.beside("figure 14", "figure 15").ratio == pytest.approx(sum(shares) / len(shares), rel=0.01)
    assert curves.beside("figure 14", "figure 15", "depth") is None
    assert asked("kdtree", recycling_run(), objects_run()).beside("figure 14", "figure 7") is None


def test_stretches_may_be_of_any_length():
    """Times are those of a step."""
    run = recycling_run(flat=1.0)
    longer = [100.0 + step for step in ENDS]
    moved = [msgspec.structs.replace(one, series={**one.series, "step": longer}) for one in run.samples]
    curves = asked("kdtree", msgspec.structs.replace(run, samples=moved))
    first, second = (median_of(point) for point in curves.traced["figure 12"].points[:2])
    assert first == pytest.approx(second / 3, rel=0.01)


def median_of(point):
    return sorted(point.spent.values())[len(point.spent) // 2]


def test_times_are_of_the_counts_of_the_source():
    (drawn, *_) = compare_with_source([objects_run()], SOURCE).drawn
    line = next(line for line in drawn.panels[0].lines if line.contestant == "kdtree")
    assert [point.place for point in line.points] == list(SIZES)
    assert line.points[0].time == pytest.approx(10 * 1.0, rel=0.25)  # 100 steps take 1 s, and launches differ
    assert line.points[0].low <= line.points[0].time <= line.points[0].high


# -- what may be believed


@pytest.mark.parametrize("status", ["wrong-result", "unstable", "crash", "timeout"])
def test_an_exact_contestant_that_went_wrong_has_no_point(status):
    run = change(capacity_run(), "motion", "kdtree capacity=16", status=status, reason="why")
    assert asked("kdtree", run).places("figure 8") == [one for one in CAPACITIES if one != 16]


def test_one_known_to_be_wrong_has_its_curve_unless_worse_befell_it(runs):
    assert asked("leaf-only", *runs).places("figure 8") == list(CAPACITIES)
    run = change(capacity_run(), "motion", "leaf-only capacity=16", status="unstable")
    assert 16 not in asked("leaf-only", run).places("figure 8")


def test_a_time_too_short_is_no_point():
    run = slow(capacity_run(), "motion", "kdtree capacity=16", SHORTEST_S / 10)
    assert 16 not in asked("kdtree", run).places("figure 8")


def test_nothing_is_believed_where_the_control_differs():
    run = capacity_run(**ENOUGH)
    first = run.backends[0]
    control = msgspec.structs.replace(first, name=f"{first.name} control", control=True)
    samples = [
        msgspec.structs.replace(one, backend=control.name, cpu_s=1.5 * one.cpu_s, process_cpu_s=1.5 * one.cpu_s)
        for one in run.samples
        if one.backend == first.name
    ]
    doubted = msgspec.structs.replace(run, backends=[*run.backends, control], samples=[*run.samples, *samples])
    assert outcomes(doubted)["hypothesis 1", "kdtree"] == "cannot tell"
    assert "| 16 | unclear | unclear |" in as_markdown(compare_with_source([doubted], SOURCE))


def test_runs_that_say_nothing_are_refused():
    with pytest.raises(InputError, match="none of the source's curves on its model: run one of motion over objects; "):
        compare_with_source([msgspec.structs.replace(objects_run(), models=[])], SOURCE)
    with pytest.raises(InputError, match="measured no times"):
        compare_with_source([msgspec.structs.replace(objects_run(), profile="check")], SOURCE)
    run = capacity_run()
    single = [one for one in run.backends if one.options["capacity"] == 8]
    with pytest.raises(InputError, match="none of the source's curves"):
        compare_with_source([msgspec.structs.replace(run, backends=single)], SOURCE)


# -- which run


def test_the_run_with_most_points_draws_a_curve():
    run = capacity_run()
    few = msgspec.structs.replace(run, backends=run.backends[3:5])
    assert asked("kdtree", few, run).places("figure 8") == list(CAPACITIES)
    assert asked("kdtree", few).places("figure 8") == [8, 10]


def test_other_models_and_other_options_are_no_part_of_a_curve():
    run = capacity_run()
    named = [msgspec.structs.replace(one, name="clustered") for one in run.models]
    moved = [msgspec.structs.replace(one, model="clustered") for one in run.samples]
    assert not asked("kdtree", msgspec.structs.replace(run, models=named, samples=moved)).traced
    backends = [
        msgspec.structs.replace(one, options={**one.options, "median": place % 2})
        for place, one in enumerate(run.backends)
    ]
    assert asked("kdtree", msgspec.structs.replace(run, backends=backends)).places("figure 8") == [1, 4, 10, 32]


def test_figures_12_to_15_are_those_of_their_options():
    run = slow(recycling_run(), "gravity", "kdtree recycle=0", 2.0)
    traced = asked("kdtree", run).traced
    assert [traced[f"figure {number}"].backend.name for number in (12, 13, 14, 15)] == [
        f"kdtree recycle={on}" for on in (1, 0, 0, 1)
    ]


def test_samples_that_went_through_other_stretches_are_left_out():
    run = recycling_run()
    (cut, *rest) = [one for one in run.samples if one.backend == "kdtree recycle=1"][::-1]
    assert rest
    samples = [
        msgspec.structs.replace(one, series={name: values[:-1] for name, values in one.series.items()})
        if one is cut
        else one
        for one in run.samples
    ]
    figures = [asked("kdtree", one).grown("figure 15") for one in (run, msgspec.structs.replace(run, samples=samples))]
    assert figures[0].ratio == pytest.approx(figures[1].ratio)
    assert math.isfinite(figures[1].high)


# -- figures and pages


def test_figures_have_a_line_for_each_contestant_broken_where_it_is_wrong(runs):
    figures = draw_curves(compare_with_source(runs, SOURCE), runs[0])
    assert list(figures) == ["figure-7", "figure-8", "figure-11", "figures-12-to-15"]
    assert [len(figure.axes) for figure in figures.values()] == [1, 1, 1, 8]
    axes = figures["figure-8"].axes[0]
    lines = {line.get_linestyle(): list(line.get_xdata()) for line in axes.lines if len(line.get_xdata())}
    assert lines == {"--": list(CAPACITIES), "-": list(CAPACITIES)}
    (legend,) = figures["figure-7"].legends
    assert [text.get_text() for text in legend.get_texts()] == [
        "leaf-only: as published (wrong answers)",
        "kdtree: as it should have been",
        "grid: squares of one size, objects sorted into them in each step",
    ]
    assert [text.get_text() for text in axes.texts] == [" the source: least here"]
    assert [list(line.get_xdata()) for line in figures["figure-7"].axes[0].lines if line.get_linestyle() == ":"] == [
        [50_000, 50_000]
    ]


def test_a_line_far_above_leaves_the_panel_and_the_legend_stays_in_the_figure():
    far = objects_run()
    for model in far.models:
        far = slow_on(far, model.name, "grid", 20.0)
    title = "squares of one size, " + "objects sorted into them in each step, " * 4
    backends = [msgspec.structs.replace(one, title=title) if one.name == "grid" else one for one in far.backends]
    far = msgspec.structs.replace(far, backends=backends)
    for run, is_cut in ((objects_run(), False), (far, True)):
        (figure,) = draw_curves(compare_with_source([run], SOURCE), run).values()
        figure.canvas.draw()
        (axes,), (legend,) = figure.axes, figure.legends
        tops = {line.get_color(): max(line.get_ydata()) for line in axes.lines if len(line.get_xdata()) == len(SIZES)}
        assert len(tops) == 3
        assert sum(top > axes.get_ylim()[1] for top in tops.values()) == is_cut
        assert sorted(tops.values())[1] > 0.3 * axes.get_ylim()[1]
        assert ("above the panel" in figure.get_supxlabel()) == is_cut
        assert legend.get_window_extent().x1 < figure.bbox.width


def slow_on(run, model, backend, factor):
    samples = [
        msgspec.structs.replace(one, cpu_s=factor * one.cpu_s) if (one.model, one.backend) == (model, backend) else one
        for one in run.samples
    ]
    return msgspec.structs.replace(run, samples=samples)


def test_panels_of_a_figure_have_one_scale_and_leaves_below(runs):
    panels = draw_curves(compare_with_source(runs, SOURCE), runs[0])["figures-12-to-15"].axes
    assert len({axes.get_ylim() for axes in panels[:4]}) == len({axes.get_ylim() for axes in panels[4:]}) == 1
    assert panels[0].lines[0].get_ydata()[0] == pytest.approx(
        1.0, rel=0.4
    )  # ms: 50 steps take 0.05 s, and launches differ
    assert max(panels[6].lines[0].get_ydata()) == 4000 < panels[6].get_ylim()[1]
    assert all(axes.get_ylim()[0] == 0 for axes in panels)


def test_the_page_says_everything(runs):
    comparison = compare_with_source(runs, SOURCE)
    page = as_html(comparison, dict.fromkeys(draw_curves(comparison, runs[0]), "<svg></svg>"))
    assert comparison.asked == [PUBLISHED, REPAIRED]
    assert page.count("<svg>") == page.count("<figcaption>") == 4
    assert page.count("<table>") == page.count("<caption>") == 1 + 4 + 1
    for finding in comparison.findings:
        assert page.count(finding.claim) == 2
    assert "does not hold" in page
    assert "no longer. " not in page
    assert page.count("leaf-only&#x27;s answers are wrong: it is compared with nothing.") == 4
    assert msgspec.json.decode(msgspec.json.encode(comparison), type=Comparison) == comparison


def test_tables_in_markdown_are_whole(runs):
    page = as_markdown(compare_with_source(runs, SOURCE))
    tables = [block for block in page.split("\n\n") if block.startswith("| ")]
    assert len(tables) == 6
    for table in tables:
        assert len({len(re.findall(r"(?<!\\)\|", line)) for line in table.splitlines()}) == 1
    assert len(tables[-1].splitlines()) == len(tables[-2].splitlines()) == 2 + 10
    assert tables[-1].splitlines()[-1].startswith("| 1,000 | 1,100 | 1,100 | 1,100 | 1,100 | 4,000 |")
    assert "| 50,000 | " in tables[1]
    assert re.search(r"\| 16 \| \d[\d.]*\? \|", as_markdown(compare_with_source([capacity_run(launches=2)], SOURCE)))


def test_a_section_and_a_page_with_its_figures_beside_it(tmp_path):
    run = concentration_run()
    title, fragment = make_section([run])
    assert title == "telvivace (2025) and today"
    assert fragment.count("<svg ") == 1
    write_markdown([run], tmp_path / "page.md")
    assert "](page/figure-11.png)" in (tmp_path / "page.md").read_text()
    assert (tmp_path / "page" / "figure-11.png").stat().st_size > 10_000
