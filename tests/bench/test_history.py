"""Ratios over commits: what a line keeps, what is refused, what the chart shows."""

import msgspec
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from tests.bench.runs import ENVIRONMENT, make_backend, make_gate_run, make_run, spread
from tetrabench.bench.history import add, entry_of, read_history
from tetrabench.errors import InputError
from tetrabench.report.history import ADVISORY, draw_history

CELLS = {"alfa": {"v4": spread(1.8), "v5": spread(2.1)}, "flow": {"v4": spread(1.4), "v5": spread(1.6)}}


def run(day: int = 1, revision: str = "a", **facts):
    """A run of one commit on one day."""
    environment = {**ENVIRONMENT, "revision": revision * 40, **facts}
    return make_run(CELLS, started=f"2024-01-{day:02}T00:00:00+00:00", environment=environment)


@pytest.fixture
def file(tmp_path):
    return tmp_path / "history.jsonl"


def test_a_line_a_run_with_its_ratios(file):
    assert add(run(2, "b"), file)
    assert add(run(1, "a"), file)
    assert len(file.read_text().splitlines()) == 2
    first, second = read_history(file)
    assert (first.revision, second.revision) == ("a" * 40, "b" * 40)  # by date, however they were added
    assert first.environment == second.environment
    point = first.points[0]
    assert (point.task, point.backend, point.verdict) == ("alfa", "v4", "slower")
    assert point.ratio == pytest.approx(1.8)
    assert point.low < point.ratio < point.high
    assert not any("v3y" in one.backend for one in first.points)


def test_adding_a_run_twice_is_harmless(file):
    assert add(run(), file)
    text = file.read_text()
    assert not add(run(), file)
    assert file.read_text() == text
    assert add(msgspec.structs.replace(run(), seed=1), file)  # the same commit, measured again


def test_what_ratios_depend_on_makes_another_environment():
    keys = [
        entry_of(run(**facts)).environment for facts in ({}, {"numba": "0.62"}, {"cores": 4}, {"load_1_minute": 3.0})
    ]
    assert keys[0] == keys[3]
    assert len(set(keys)) == 3


def test_an_installed_version_is_named_by_its_number():
    assert entry_of(make_run(CELLS, environment={"tetrabench": "1.2"})).revision == "version 1.2"


def test_controls_are_no_points():
    backends = [make_backend(name) for name in ("v3y", "v4", "v3y control")]
    entry = entry_of(make_run({"alfa": {"v4": spread(), "v3y control": spread()}}, backends=backends))
    assert [one.backend for one in entry.points] == ["v4"]


@pytest.mark.parametrize(
    ("results", "reason"),
    [
        (make_gate_run({"alfa": {"v3y": spread()}}), "a gate's ratios"),
        (msgspec.structs.replace(run(), profile="check"), "no ratios"),
        (msgspec.structs.replace(run(), samples=[]), "no ratios"),
    ],
)
def test_what_is_no_point_of_a_history(file, results, reason):
    with pytest.raises(InputError, match=reason):
        add(results, file)
    assert not file.exists()


def test_a_line_that_was_cut_off_is_named(file):
    add(run(1), file)
    add(run(2), file)
    file.write_bytes(file.read_bytes()[:-20])
    with pytest.raises(InputError, match=r"history\.jsonl:2: no run of a history, or cut off"):
        read_history(file)
    with pytest.raises(InputError, match=":2:"):
        add(run(3), file)


def test_a_last_line_without_an_end_is_not_joined(file):
    add(run(1), file)
    file.write_text(
        file.read_text().rstrip() + "\n\n" + file.read_text().replace(entry_of(run(1)).run, "0" * 16).rstrip()
    )
    add(run(2), file)
    assert len(read_history(file)) == 3


def test_another_versions_history_is_refused(file):
    add(run(), file)
    file.write_text(file.read_text().replace("history/1", "history/9"))
    with pytest.raises(InputError, match="schema tetrabench-history/9"):
        read_history(file)
    with pytest.raises(InputError, match="cannot read"):
        read_history(file.with_name("none"))


# -- the chart


@pytest.fixture
def drawn(monkeypatch):
    """The figures that are saved."""
    figures = []
    save = Figure.savefig

    def keep(figure, path, **more):
        figures.append(figure)
        save(figure, path, **more)

    monkeypatch.setattr(Figure, "savefig", keep)
    return figures


def panels(figure: Figure) -> list[Axes]:
    return figure.get_axes()


def lines(axes: Axes) -> dict[str, list[list[float]]]:
    """By backend the commits (0, 1, ...) of each unbroken line."""
    found: dict[str, list[list[float]]] = {}
    for one in axes.containers:
        found.setdefault(one.get_label(), []).append(list(one.lines[0].get_xdata()))
    return found


def test_a_panel_a_scenario_and_a_line_a_backend(file, tmp_path, drawn):
    entries = [entry_of(run(day, letter)) for day, letter in enumerate("abc", 1)]
    draw_history(entries, tmp_path / "h.png")
    assert (tmp_path / "h.png").read_bytes()[:4] == b"\x89PNG"
    assert [axes.get_title(loc="left") for axes in panels(drawn[0])] == ["alfa, box", "flow, box"]
    assert lines(panels(drawn[0])[0]) == {"v4": [[0, 1, 2]], "v5": [[0, 1, 2]]}
    assert panels(drawn[0])[-1].get_xticklabels()[1].get_text() == "bbbbbbb\n2024-01-02"
    assert ADVISORY in drawn[0].get_supxlabel()


def test_lines_break_where_the_environment_changes(tmp_path, drawn):
    facts = [{}, {}, {"numba": "0.62.0"}, {"numba": "0.62.0"}]
    entries = [
        entry_of(run(day, letter, **more)) for day, (letter, more) in enumerate(zip("abcd", facts, strict=True), 1)
    ]
    draw_history(entries, tmp_path / "h.svg", backends=["v4"], scenarios=["flow"])
    (axes,) = panels(drawn[0])
    assert lines(axes) == {"v4": [[0, 1], [2, 3]]}
    assert [text.get_text() for text in axes.texts] == ["other numba"]
    assert [line.get_xdata()[0] for line in axes.lines if line.get_linestyle() == "--"] == [1.5]


def test_a_run_without_a_cell_is_a_gap(tmp_path, drawn):
    entries = [entry_of(run(day, letter)) for day, letter in enumerate("abc", 1)]
    kept = [one for one in entries[1].points if one.backend != "v4"]
    entries[1] = msgspec.structs.replace(entries[1], points=kept)
    draw_history(entries, tmp_path / "h.svg", scenarios=["alfa"])
    assert lines(panels(drawn[0])[0]) == {"v4": [[0], [2]], "v5": [[0, 1, 2]]}


def test_a_long_history_labels_what_there_is_room_for(tmp_path, drawn):
    entries = [msgspec.structs.replace(entry_of(run(1)), run=str(k)) for k in range(100)]
    draw_history(entries, tmp_path / "h.svg", scenarios=["alfa"])
    assert len(panels(drawn[0])[0].get_xticks()) <= 25


@pytest.mark.parametrize(
    ("choice", "said"),
    [({"scenarios": ["alfaa"]}, "did you mean 'alfa'"), ({"backends": ["v9"]}, "no backend 'v9'")],
)
def test_unknown_names(tmp_path, choice, said):
    with pytest.raises(InputError, match=said):
        draw_history([entry_of(run())], tmp_path / "h.png", **choice)


def test_nothing_to_draw_and_nowhere_to_draw_it(tmp_path):
    with pytest.raises(InputError, match="nothing to draw"):
        draw_history([], tmp_path / "h.png")
    with pytest.raises(InputError, match="cannot write the chart"):
        draw_history([entry_of(run())], tmp_path / "h.nonsense")
