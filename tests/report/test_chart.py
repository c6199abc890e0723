"""The charts: files that can be opened, ratios with their intervals, what is missing, looks that stay."""

from pathlib import Path

import pytest
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.image import imread
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle
from matplotlib.text import Text

from tests.report.made import SECONDS, change, make_backend, make_control, make_memory, make_results, make_sweep
from tetrabench.bench.record import Results, Task
from tetrabench.bench.statistics import ALIKE, CLEAR, summary
from tetrabench.errors import InputError
from tetrabench.report.chart import draw_charts, draw_growth, draw_memory, draw_times
from tetrabench.report.dots import CONTROL, FAR
from tetrabench.report.parts import make_parts
from tetrabench.report.style import EDGE, make_styles

TWO = {"flow": {"v3y": 1.0, "v4": 2.0}}


def panels_of_times(results: Results) -> list[Axes]:
    (part,) = make_parts(results)
    return draw_times(part).axes


def panels_of_memory(results: Results) -> list[Axes]:
    (part,) = make_parts(results)
    return draw_memory(part).axes


def words(axes: Axes) -> list[str]:
    return [text.get_text() for text in axes.texts]


def bars(axes: Axes) -> list[Rectangle]:
    return [bar for container in axes.containers for bar in container]


def dots(axes: Axes) -> list[Line2D]:
    return [line for line in axes.lines if line.get_marker() not in ("None", None)]


def ratios(axes: Axes) -> list[float]:
    return [float(dot.get_ydata()[0]) for dot in dots(axes)]


def whiskers(axes: Axes, colour: str = EDGE) -> list[tuple[float, float]]:
    lines = [line for line in axes.lines if line.get_gid() == "whisker" and line.get_color() == colour]
    return [tuple(map(float, line.get_ydata())) for line in lines]


def is_hollow(dot: Line2D) -> bool:
    return dot.get_markerfacecolor() == "white"


def all_words(figure: Figure) -> list[str]:
    return [text.get_text() for text in figure.findobj(Text)]


def caption(figure: Figure) -> str:
    (text,) = (text.get_text() for part in figure.subfigs for text in part.texts if "Python" in text.get_text())
    return text.replace("\n", " ")


def test_charts_are_written(tmp_path: Path):
    paths = draw_charts(make_results(), tmp_path / "new")
    assert [path.name for path in paths] == ["times.png", "memory.png"]
    for path in paths:
        height, width, _ = imread(path).shape
        assert width > height > 300
    for path in draw_charts(make_results(), tmp_path, ".svg"):
        assert "<svg" in path.read_text()


def test_each_model_and_each_reference_has_charts_of_its_own(tmp_path: Path):
    results = make_sweep(TWO, {"v3y": 1, "v4": 1}, [100, 200])
    names = [path.name for path in draw_charts(results, tmp_path)]
    assert names == [
        "times-nozzle-100.png",
        "memory-nozzle-100.png",
        "times-nozzle-200.png",
        "memory-nozzle-200.png",
        "growth.png",
    ]
    backends = [make_backend("v3y"), make_backend("v4 base", against="v4 base")]
    results = make_results({"flow": {"v3y": 1.0, "v4 base": 2.0}}, backends=backends, memory=[])
    names = [path.name for path in draw_charts(results, tmp_path)]
    assert names == ["times-v3y.png", "memory-v3y.png", "times-v4-base.png", "memory-v4-base.png"]


def test_each_ratio_is_a_dot_where_it_is_on_a_logarithmic_axis():
    (axes,) = panels_of_times(make_results({"flow": {"v3y": 1.0, "v4": 2.0, "v5": 0.5, "v3": 500.0}}, wobble=0.0))
    assert ratios(axes) == pytest.approx([1.0, 2.0, 0.5, 500.0])
    assert axes.get_yscale() == "log"
    stems = [tuple(line.get_ydata()) for line in axes.lines if len(line.get_ydata()) == 2 and line.get_alpha()]
    assert stems == [pytest.approx((1.0, ratio)) for ratio in ratios(axes)]  # as long as it is far from 1


def test_what_is_far_from_1_carries_its_figure():
    (axes,) = panels_of_times(make_results(wobble=0.0))
    assert words(axes) == ["711x", "709x", "28x", "199x", "1.9x", "1.8x", "1.8x", "1.8x", "1.5x", "3.5x"]
    (axes,) = panels_of_times(make_results({"flow": {"v3y": 1.0, "v4": FAR - 0.01, "v5": 0.2}}, wobble=0.0))
    assert words(axes) == ["0.20x"]


def test_a_bound_is_labelled_as_one():
    (axes,) = panels_of_times(make_results({"flow": {"v3y": 1.0, "v4": 50.0}}, launches=2, wobble=0.1))
    assert words(axes) == [">48x"]


@pytest.mark.parametrize("extreme", [1e-4, 0.1, 3.0, 50.0, 1e5])
def test_all_figures_have_room(extreme: float):
    (part,) = make_parts(make_results({"flow": {"v3y": 1.0, "v4": extreme}}, wobble=0.1))
    figure = draw_times(part)
    figure.draw_without_rendering()
    (axes,) = figure.axes
    box, inner = axes.texts[0].get_window_extent(), axes.get_window_extent()
    assert inner.y0 <= box.y0 < box.y1 <= inner.y1
    assert 2 <= sum(inner.y0 <= axes.transData.transform((0, tick))[1] <= inner.y1 for tick in axes.get_yticks()) <= 14


def test_whiskers_are_the_intervals_and_the_grey_one_the_controls():
    results = make_results({"flow": {"v3y": 1.0, "v4": 2.0}}, wobble=0.1)
    row = next(row for row in summary(results) if row.backend == "v4")
    control = next(row for row in summary(results) if row.control)
    (axes,) = panels_of_times(results)
    assert whiskers(axes) == [pytest.approx((row.low, row.high))]
    assert whiskers(axes, CONTROL) == [pytest.approx((control.low, control.high))]
    (axes,) = panels_of_times(make_results(TWO, launches=1))  # nothing to span
    assert whiskers(axes) == []


def test_whiskers_stay_in_the_picture():
    (axes,) = panels_of_times(make_results({"flow": {"v3y": 1.0, "v4": 11.0}}, wobble=1.0))
    assert max(high for _, high in whiskers(axes)) <= axes.get_ylim()[1]


def test_what_is_not_ranked_is_hollow():
    results = make_results({"flow": {"v3y": 1.0, "v4": 2.0, "v5": 1.0, "v3": 1.06}}, wobble=0.1)
    (axes,) = panels_of_times(results)
    assert [is_hollow(dot) for dot in dots(axes)] == [False, False, True, True]  # unclear, both
    (axes,) = panels_of_times(make_results({"flow": {"v3y": 1.0, "v4": 2.0, "v5": 4.0}}, launches=2))
    assert [is_hollow(dot) for dot in dots(axes)] == [False, True, False]  # a hint


def test_the_band_is_where_nothing_is_ranked():
    def band(axes: Axes) -> tuple[float, float]:
        (patch,) = axes.patches
        return patch.get_y(), patch.get_y() + patch.get_height()

    (axes,) = panels_of_times(make_results(TWO))
    assert band(axes) == pytest.approx((1 / ALIKE, ALIKE))
    (axes,) = panels_of_times(make_results(TWO, launches=2))
    assert band(axes) == pytest.approx((1 / CLEAR, CLEAR))
    (axes,) = panels_of_times(make_results({"flow": {"v3y": 1.0}}))
    assert not axes.patches  # nobody to compare


@pytest.mark.parametrize(
    ("status", "word"),
    [("wrong-result", "wrong"), ("crash", "crashed"), ("oom", "no memory"), ("skipped", "skipped")],
)
def test_no_dot_for_a_bad_cell(status: str, word: str):
    (axes,) = panels_of_times(change(make_results(TWO), "flow", "v4", status=status))
    assert words(axes) == [word]
    assert ratios(axes) == [1.0]


def test_what_is_missing_is_a_word():
    results = make_results({"flow": {"v3y": 1.0, "v4": 2.0}, "alfa": {"v3y": 1.0}}, ended="interrupted")
    (part,) = make_parts(results)
    times, memory = draw_times(part), draw_memory(part)
    assert words(times.axes[0]) == ["2.0x", "missing"]
    for figure in (times, memory, draw_growth(results, summary(results))):
        assert "Interrupted: samples are missing." in all_words(figure)
    assert "interrupted" not in " ".join(all_words(draw_times(make_parts(make_results())[0]))).lower()
    half = make_results(
        TWO,
        memory=[make_memory("v3y")],
        ended="interrupted",
        backends=[make_backend("v3y"), make_backend("v4", structure={})],
    )
    assert words(panels_of_memory(half)[0]) == ["236", "missing"]


def test_many_tasks_stand_in_rows_of_one_scale():
    rows = panels_of_times(make_results({f"s{n}": {"v3y": 1.0, "v4": n / 3} for n in range(1, 13)}))
    assert len(rows) == 2
    assert rows[0].get_ylim() == rows[1].get_ylim()


def test_axes_say_what_they_show():
    results = make_results()
    (axes,) = panels_of_times(results)
    assert axes.get_ylabel() == "time, multiple of v3y's"
    assert [label.get_text().split("\n")[0] for label in axes.get_xticklabels()] == list(SECONDS)
    structure, retained, peak = panels_of_memory(results)
    assert structure.get_ylabel() == "bytes a tetra"
    assert [axes.get_title() for axes in (structure, retained, peak)] == [
        "fresh structure",
        "retained by its process, to about 1 %",
        "peak while it is built, to about 1 %",
    ]
    assert words(structure) == ["236", "236", "236", "252", "236", "236", "236"]
    assert words(peak)[3] == "277"


def test_memory_that_could_not_be_measured_is_a_word():
    memory = [make_memory("v3y"), make_memory("v4", status="crash")]
    structure, *_ = panels_of_memory(make_results(TWO, memory=memory))
    assert words(structure) == ["236", "crashed"]
    (structure,) = panels_of_memory(make_results(TWO, memory=[]))  # no memory pass: what they said themselves
    assert words(structure) == ["236", "252"]


def test_caption_names_model_machine_day_and_what_whiskers_are():
    (part,) = make_parts(make_results())
    for figure in (draw_times(part), draw_memory(part)):
        for fact in ("642,720 tetras", "Core2", "2011-05-01", "8 launches of 3 rounds"):
            assert fact in caption(figure)
    assert "intervals that hold with" in caption(draw_times(part))
    (part,) = make_parts(make_results(launches=2))
    assert "Too few launches for intervals; whiskers: their range" in caption(draw_times(part))


@pytest.mark.parametrize(
    ("note", "results"),
    [
        ("Hollow", make_results(TWO, launches=2)),
        ("Grey whiskers", make_results(TWO)),
        ("grey band", make_results(TWO)),
        ("whiskers: their range", make_results(TWO, launches=2)),
        ("One launch", make_results(TWO, launches=1)),
        ("not from the source", make_results(TWO, backends=[make_backend("v3y"), make_backend("v4", extension=True)])),
        (
            "Fewer than asked for",
            make_results(TWO, tasks=[Task(name="flow", scenario="flow", options={"tetras": 10**9})]),
        ),
    ],
)
def test_a_note_stands_only_where_it_is_true(note: str, results: Results):
    (part,) = make_parts(results)
    assert note in caption(draw_times(part))
    if "source" not in note:
        assert note not in caption(draw_memory(part))
        (alone,) = make_parts(make_results({"flow": {"v3y": 1.0}}, backends=[make_backend("v3y")]))
        assert note not in caption(draw_times(alone))


def test_an_extension_has_its_asterisk_in_each_chart():
    backends = [make_backend("v3y"), make_backend("halfface", extension=True)]
    results = make_results({"flow": {"v3y": 1.0, "halfface": 2.0}}, backends=backends)
    (part,) = make_parts(results)
    for figure in (draw_times(part), draw_memory(part), draw_growth(results, summary(results))):
        assert "halfface*: another layout, other slots" in all_words(figure)
        assert "A name with a * is not from the source." in caption(figure)
    assert [one.get_text() for one in draw_memory(part).axes[0].get_xticklabels()] == ["v3y", "halfface*"]


def never_drawn(figure: Figure) -> set[Text]:
    """Labels of ticks beyond the ends of their axis: matplotlib has them, and leaves them out."""
    return {
        tick.label1
        for axes in figure.axes
        for axis in (axes.xaxis, axes.yaxis)
        for tick in (*axis.get_major_ticks(), *axis.get_minor_ticks())
        if not min(axis.get_view_interval()) <= tick.get_loc() <= max(axis.get_view_interval())
    }


@pytest.mark.parametrize("extra", ["half faces, flag + list", "a layout with a title " + "that goes on and on " * 9])
def test_all_words_stay_in_the_picture(extra: str):
    seconds = {
        "flow": {**SECONDS["flow"], "halfface": 1.7, "other": 2.0},
        "a-task-with-a-long-name with=100": {"v3y": 1.0},
    }
    backends = [*map(make_backend, SECONDS["flow"]), make_backend("halfface", title=extra), make_backend("other")]
    results = make_results(seconds, backends=backends, model="a model of a long name " * 6)
    (part,) = make_parts(results)
    for figure in (draw_times(part), draw_memory(part), draw_growth(results, summary(results))):
        figure.draw_without_rendering()
        for text in figure.findobj(Text):
            if text.get_text() and text not in never_drawn(figure):
                box = text.get_window_extent()
                assert figure.bbox.x0 <= box.x0 <= box.x1 <= figure.bbox.x1, text
                assert figure.bbox.y0 <= box.y0 <= box.y1 <= figure.bbox.y1, text


def test_growth_has_a_panel_a_task_and_a_line_a_contestant():
    sizes = [100, 200, 400]
    results = make_sweep({"alfa": {"v3y": 1.0, "v4": 2.0}, **TWO}, {"v3y": 1, "v4": 1.5}, sizes)
    results = change(results, "flow", "v4", status="crash")
    axes = draw_growth(results, summary(results)).axes
    assert [one.get_title() for one in axes] == ["alfa", "flow"]
    assert [len(one.lines) for one in axes] == [2, 1]
    assert list(axes[0].lines[0].get_xdata()) == sizes
    level, rising = (line.get_ydata() for line in axes[0].lines)
    assert level[-1] == pytest.approx(level[0])
    assert rising[-1] == pytest.approx(2 * rising[0])
    assert axes[0].get_xlabel() == "tetras"


def test_a_contestant_looks_the_same_whoever_takes_part():
    everybody = make_styles(make_results())
    two = make_styles(make_results({"alfa": {"v3y": 1.0, "v5": 2.0}}))
    assert two == {name: everybody[name] for name in ("v3y", "v5")}
    patches = [(style.paint["facecolor"], style.paint["hatch"]) for style in everybody.values()]
    assert len(set(patches)) == 7
    assert len({(style.dot["color"], style.dot["marker"]) for style in everybody.values()}) == 7
    lines = [(style.line["linestyle"], style.line["marker"]) for style in everybody.values()]
    assert len(set(lines)) == 7  # without colour
    hatches = [
        [style.paint["hatch"] for name, style in everybody.items() if name[:2] == layout] for layout in ("v3", "v5")
    ]
    assert hatches[0] == hatches[1]  # one hatch a slot policy


def test_without_colour_bars_can_be_told_apart():
    """In grey, contestants of one hatch differ in brightness, or have another place in the group; hatches differ anyway."""
    styles = make_styles(make_results())
    greys = {name: round(sum(to_rgb(style.paint["facecolor"])) / 3, 2) for name, style in styles.items()}
    assert len({(greys[name], style.paint["hatch"]) for name, style in styles.items()}) == 7


def test_results_of_elsewhere_can_be_drawn(tmp_path: Path):
    backends = [make_backend("v3y"), make_backend("else", title="no comma", structure={}), make_control()]
    seconds = {"alfa": {"v3y": 1.0, "else": 2.0}}
    draw_charts(make_results(seconds, backends=backends, family="unheard-of", memory=[]), tmp_path)
    draw_charts(make_results(samples=[], models=[], ended="interrupted"), tmp_path)
    draw_charts(make_results(samples=[], ended="interrupted"), tmp_path)


def test_a_folder_that_cannot_be_is_refused(tmp_path: Path):
    (tmp_path / "file").touch()
    with pytest.raises(InputError, match="cannot write charts"):
        draw_charts(make_results(), tmp_path / "file")
