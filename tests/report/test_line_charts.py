"""Charts of lines as they are drawn: files, lines, marks, words that say what is wrong; and many backends in all charts."""

import re
from itertools import pairwise
from pathlib import Path

import msgspec
import pytest
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.text import Text

from tests.report.made import make_memory
from tests.report.made_lines import CAPACITIES, make_contestants, make_run
from tetrabench.bench import summary
from tetrabench.bench.record import Results
from tetrabench.bench.statistics import summary_against
from tetrabench.report.canvas import FOLDED
from tetrabench.report.chart import DOTS, draw_charts, draw_growth, draw_memory, draw_times
from tetrabench.report.curves import curves_over_counts, curves_over_options
from tetrabench.report.line_charts import draw_curves, draw_series
from tetrabench.report.parts import make_parts
from tetrabench.report.series import courses_of
from tetrabench.report.style import make_styles
from tetrabench.report.table import as_text

EVERYBODY = make_contestants(CAPACITIES)
TWENTY = make_contestants(range(1, 21), names=["kdtree", "grid", "skin"])
AREAS = {f"concentration area={area}": factor for area, factor in ((100, 1.0), (1000, 1.7), (10_000, 2.5))}


def series_of(results: Results) -> Figure:
    (course,) = courses_of(results, summary(results))
    return draw_series(results, course)


def curves_of(results: Results) -> Figure:
    (curves,) = curves_over_options(results, summary(results), lambda base: summary_against(results, base))
    return draw_curves(results, curves)


def counts_of(results: Results) -> Figure:
    (curves,) = curves_over_counts(results, summary(results))
    return draw_curves(results, curves)


def all_words(figure: Figure) -> str:
    return " ".join(text.get_text() for text in figure.findobj(Text)).replace("\n", " ")


def panels(figure: Figure) -> list[Axes]:
    return [axes for axes in figure.axes if axes.axison]


def test_files_are_named_after_what_they_show(tmp_path: Path):
    results = make_run({"gravity": 1.0, **AREAS}, EVERYBODY, launches=1)
    samples = [msgspec.structs.replace(one, series={}) if one.task != "gravity" else one for one in results.samples]
    names = [path.name for path in draw_charts(msgspec.structs.replace(results, samples=samples), tmp_path)]
    assert names == [
        "times.png",
        "series-uniform-gravity.png",
        "option-uniform-gravity-kdtree-capacity.png",
        *(f"option-uniform-concentration-area={area}-kdtree-capacity.png" for area in (100, 1000, 10_000)),
        "option-uniform-concentration-area.png",
    ]
    assert all((tmp_path / name).stat().st_size > 5000 for name in names)


def test_runs_without_series_and_options_have_the_charts_that_they_had(tmp_path: Path):
    results = make_run({"motion": 1.0}, make_contestants(), launches=1, stretches=0)
    assert [path.name for path in draw_charts(results, tmp_path)] == ["times.png"]


def test_a_panel_for_each_quantity_and_a_line_for_each_who_has_it():
    figure = series_of(make_run({"gravity": 1.0}, make_contestants(names=["kdtree", "grid", "leaf-only"])))
    shown = {axes.get_title(): len(axes.lines) for axes in panels(figure)}
    assert shown == {
        "time of a step": 3,
        **{f"time of a step: {phase}": 3 for phase in ("update", "pairs", "respond", "move")},
        "contacts": 3,
        **dict.fromkeys(("leaves", "fill", "merges"), 2),
    }
    first = panels(figure)[0]
    assert (first.get_xlabel(), first.get_yscale(), first.get_ylim()[0]) == ("step", "linear", 0.0)
    assert "leaf-only (wrong answers)" in all_words(figure)
    assert "known to be so, and ranked nowhere" in all_words(figure)


def test_times_that_span_much_are_logarithmic_and_counts_never():
    figure = series_of(make_run({"gravity": 1.0}, make_contestants(names=["kdtree", "brute"])))
    scales = {axes.get_title(): axes.get_yscale() for axes in panels(figure)}
    assert scales["time of a step"] == "log"
    assert scales["merges"] == "linear"


def test_only_who_is_wrong_is_drawn_in_long_dashes():
    figure = series_of(make_run({"gravity": 1.0}, make_contestants()))
    styles = [line.get_linestyle() for line in panels(figure)[0].lines]
    plain, wrong = make_styles(make_run({"gravity": 1.0}, make_contestants())), panels(figure)[0].lines[-1]
    assert styles[:-1] == [plain[name].line["linestyle"] for name in list(plain)[:-1]]
    assert wrong._unscaled_dash_pattern[1] == (6, 4)
    figure = series_of(make_run({"gravity": 1.0}, make_contestants(names=["kdtree", "grid"])))
    assert "wrong" not in all_words(figure)


def test_the_least_is_in_a_ring_and_says_what_it_is():
    (axes,) = panels(curves_of(make_run({"motion": 1.0}, EVERYBODY, launches=12)))
    (ring,) = (line for line in axes.lines if line.get_gid() == "least")
    assert list(ring.get_xdata()) == [16]
    assert any(re.fullmatch(r"capacity=16: 60\d ns", text.get_text()) for text in axes.texts)
    levels = [line for line in axes.lines if line.get_gid() == "level"]
    assert [text.get_text() for text in axes.texts if "=" not in text.get_text()] == ["grid*", "skin*", "ckdtree"]
    assert len(levels) == 3
    assert [tick.get_text() for tick in axes.get_xticklabels()] == [str(capacity) for capacity in CAPACITIES]
    assert axes.get_xscale() == "log"


def test_hollow_is_who_is_shown_to_be_slower():
    (axes,) = panels(curves_of(make_run({"motion": 1.0}, make_contestants(CAPACITIES, names=["kdtree"]), launches=12)))
    marks = {
        int(line.get_xdata()[0]): line.get_fillstyle()
        for line in axes.lines
        if line.get_linestyle() == "None" and line.get_gid() != "least"
    }
    assert marks[16] == "full"
    assert marks[1] == marks[63] == "none"


def test_who_is_far_is_named_below():
    figure = curves_of(make_run({"motion": 1.0}, EVERYBODY))
    assert re.search(r"Beyond the chart: brute [89]\d\.\d us\.", all_words(figure))
    assert all_words(figure).count("A name with a * is not from the source.") == 1  # grid*, a level
    (axes,) = panels(figure)
    assert axes.get_ylim()[1] < 9e-5


def test_whiskers_are_the_range_of_the_launches():
    results = make_run({"motion": 1.0}, EVERYBODY, launches=4)
    (axes,) = panels(curves_of(results))
    (chart,) = curves_over_options(results, summary(results), lambda base: summary_against(results, base))
    ends = [tuple(line.get_ydata()) for line in axes.lines if line.get_gid() == "whisker"]
    assert ends == [
        (point.low, point.high) for curve in chart.curves for point in curve.points if point.low < point.high
    ]
    assert len(ends) == 2 * len(CAPACITIES) - 1  # the reference is as quick in each
    assert "Whiskers" not in all_words(curves_of(make_run({"motion": 1.0}, EVERYBODY, launches=1)))


@pytest.mark.parametrize(
    "figure",
    [
        lambda: series_of(make_run({"gravity": 1.0}, make_contestants())),
        lambda: series_of(make_run({"gravity": 1.0}, TWENTY)),
        lambda: curves_of(make_run({"motion": 1.0}, EVERYBODY)),
        lambda: counts_of(make_run(AREAS, EVERYBODY)),
    ],
)
def test_all_words_stay_in_the_picture(figure):
    drawn = figure()
    drawn.draw_without_rendering()
    ticks = {id(tick) for axes in drawn.axes for tick in (*axes.get_xticklabels(), *axes.get_yticklabels())}
    for text in drawn.findobj(Text):
        if text.get_text() and id(text) not in ticks:  # those beyond the ends of an axis are not drawn
            box = text.get_window_extent()
            assert drawn.bbox.x0 <= box.x0 <= box.x1 <= drawn.bbox.x1, text
            assert drawn.bbox.y0 <= box.y0 <= box.y1 <= drawn.bbox.y1, text


# -- many backends of a contestant, in all charts


def test_backends_of_a_contestant_go_from_light_to_dark_and_others_keep_their_looks():
    styles = make_styles(make_run({"motion": 1.0}, TWENTY, launches=1))
    light = [sum(to_rgb(styles[f"kdtree capacity={capacity}"].line["color"])) for capacity in range(1, 21)]
    assert light == sorted(light, reverse=True)
    assert len(set(light)) == 20
    alone = make_styles(make_run({"motion": 1.0}, make_contestants(names=["kdtree", "grid", "skin"]), launches=1))
    assert {name: styles[name] for name in ("grid", "skin")} == {name: alone[name] for name in ("grid", "skin")}
    assert alone["kdtree"].sweep == ""


def test_versions_of_a_contestant_without_options_are_no_sweep():
    """As in a run of the gate: the same contestant twice, from two checkouts."""
    one, other = (msgspec.structs.replace(make_contestants(names=["grid"])[0], name=name) for name in ("base", "head"))
    styles = make_styles(make_run({"motion": 1.0}, [one, other], launches=1))
    assert styles["base"].line == styles["head"].line


def test_many_backends_have_one_entry_in_the_legend_and_few_have_their_own():
    (part,) = make_parts(make_run({"motion": 1.0}, TWENTY, launches=1))
    words = all_words(draw_times(part))
    assert "kdtree capacity=1, 2, 3, 4" in words
    assert "19, 20 (light to dark): bucketed k-d tree" in words
    few = make_contestants((4, 8, 16, 32), names=["kdtree"])
    assert len(few) == FOLDED
    (part,) = make_parts(make_run({"motion": 1.0}, few, launches=1))
    assert "kdtree capacity=32: bucketed k-d tree" in all_words(draw_times(part))


def test_dots_and_bars_of_many_backends_have_room():
    tasks = {"motion": 1.0, "gravity": 2.0, "windows": 3.0}
    results = make_run(tasks, TWENTY, launches=1)
    (part,) = make_parts(results)
    rows = draw_times(part).axes
    assert [len(axes.get_xticks()) * len(TWENTY) <= DOTS for axes in rows] == [True] * 2
    memory = [make_memory(one.name, model="uniform") for one in TWENTY]
    (part,) = make_parts(msgspec.structs.replace(results, memory=memory))
    figure = draw_memory(part)
    figure.draw_without_rendering()
    for axes in figure.axes:
        boxes = [text.get_window_extent() for text in axes.texts]
        assert len(boxes) == len(TWENTY)
        assert all(not one.overlaps(other) for one, other in pairwise(boxes))
    assert "kdtree capacity=1, 2" in all_words(draw_growth(results, summary(results)))


def test_tables_say_where_series_are_shown():
    results = make_run({"motion": 1.0, "gravity": 2.0}, make_contestants(), launches=1)
    assert "Along the run of motion, gravity: charts of `tetrabench report`, or --charts." in as_text(results)
    results = make_run({"motion": 1.0}, make_contestants(), launches=1, stretches=0)
    assert "Along the run" not in as_text(results)
