"""The charts: files that can be opened, bars that are cut where they dwarf others, looks that stay."""

from pathlib import Path

import pytest
from matplotlib.figure import Figure
from matplotlib.image import imread
from matplotlib.patches import Polygon, Rectangle

from tests.report.made import change, make_backend, make_results
from tetrabench.bench import summary
from tetrabench.errors import InputError
from tetrabench.report.chart import draw_charts, draw_memory, draw_times
from tetrabench.report.style import make_styles


def panels(figure: Figure) -> list:
    return figure.axes


def cuts(axes) -> int:
    return sum(isinstance(patch, Polygon) and not isinstance(patch, Rectangle) for patch in axes.patches)


def words(axes) -> list[str]:
    return [text.get_text() for text in axes.texts]


def test_both_charts_are_written(tmp_path: Path):
    paths = draw_charts(make_results(), tmp_path / "new")
    assert [path.name for path in paths] == ["times.png", "memory.png"]
    for path in paths:
        height, width, _ = imread(path).shape
        assert width > height > 300
    for path in draw_charts(make_results(), tmp_path, ".svg"):
        assert "<svg" in path.read_text()


def test_a_dwarfing_bar_is_cut_and_labelled():
    results = make_results()
    (axes,) = panels(draw_times(results, summary(results)))
    assert words(axes) == ["711x", "709x", "28x", "199x"]
    assert cuts(axes) == 4
    assert max(patch.get_height() for patch in axes.patches if isinstance(patch, Rectangle)) < 5


def test_where_no_bar_dwarfs_none_is_cut():
    results = make_results({"flow": {"v3y": 1.0, "v4": 3.9}})
    (axes,) = panels(draw_times(results, summary(results)))
    assert words(axes) == []
    assert cuts(axes) == 0


@pytest.mark.parametrize(("status", "word"), [("wrong-result", "wrong"), ("crash", "crashed"), ("skipped", "skipped")])
def test_no_bar_for_a_bad_cell(status: str, word: str):
    results = make_results({"flow": {"v3y": 1.0, "v4": 2.0}})
    (axes,) = panels(draw_times(results, summary(results)))
    before = len(axes.containers)
    results = change(results, "flow", "v4", status=status)
    (axes,) = panels(draw_times(results, summary(results)))
    assert words(axes) == [word]
    assert len(axes.containers) == before - 1


def test_many_scenarios_stand_in_rows_of_one_scale():
    results = make_results({f"s{n}": {"v3y": 1.0, "v4": n / 3} for n in range(1, 13)})
    rows = panels(draw_times(results, summary(results)))
    assert len(rows) == 2
    assert rows[0].get_ylim() == rows[1].get_ylim()


def test_axes_say_what_they_show():
    results = make_results()
    (axes,) = panels(draw_times(results, summary(results)))
    assert axes.get_ylabel() == "CPU time, multiple of v3y's"
    assert [label.get_text().split("\n")[0] for label in axes.get_xticklabels()] == list(results.options)
    structure, peak = panels(draw_memory(results, summary(results)))
    assert "bytes a tetra" in structure.get_ylabel()
    assert "MB" in peak.get_ylabel()
    assert words(structure) == ["236", "236", "236", "252", "236", "236", "236"]


def test_caption_names_model_machine_day_and_that_it_is_provisional():
    results = make_results()
    for figure in (draw_times(results, summary(results)), draw_memory(results, summary(results))):
        (caption,) = (text.get_text() for part in figure.subfigs for text in part.texts if "tetras" in text.get_text())
        for fact in ("642,720 tetras", "Core2", "2011-05-01", "Provisional"):
            assert fact in caption


def test_a_contestant_looks_the_same_whoever_takes_part():
    everybody = make_styles(make_results())
    two = make_styles(make_results({"alfa": {"v3y": 1.0, "v5": 2.0}}))
    assert two == {name: everybody[name] for name in ("v3y", "v5")}
    looks = [(style.paint["facecolor"], style.paint["hatch"]) for style in everybody.values()]
    assert len(set(looks)) == 7
    hatches = [
        [style.paint["hatch"] for name, style in everybody.items() if name[:2] == layout] for layout in ("v3", "v5")
    ]
    assert hatches[0] == hatches[1]  # one hatch a slot policy


def test_results_of_elsewhere_can_be_drawn(tmp_path: Path):
    backends = [make_backend("v3y"), make_backend("else", title="no comma", structure={})]
    seconds = {"alfa": {"v3y": 1.0, "else": 2.0}}
    draw_charts(make_results(seconds, backends=backends, family="unheard-of", model_size={}), tmp_path)
    draw_charts(make_results(samples=[], model_size={}, interrupted=True), tmp_path)


def test_a_folder_that_cannot_be_is_refused(tmp_path: Path):
    (tmp_path / "file").touch()
    with pytest.raises(InputError, match="cannot write charts"):
        draw_charts(make_results(), tmp_path / "file")
