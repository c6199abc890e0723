"""The source of the polygon family: its figures as printed, and what its own tables say of its findings."""

from statistics import median

import pytest

from tetrabench import registry
from tetrabench.report.thesis.comparison import outcome_of, worst_of
from tetrabench.report.thesis.facts import Published
from tetrabench.sources.polygon import (
    BLOCKS,
    CELL_TASKS,
    FORMULAS,
    MESHES,
    NODE_TASKS,
    REGULAR,
    SOURCE,
    VALUES,
    in_ticks,
)

SHARES = {  # tables 6 and 7, in percent
    "triangle": (17.19, 14.07),
    "quad": (20.04, 14.29),
    "hexagon": (19.76, 16.01),
    "voronoi": (37.05, 39.48),
}
OWN = {  # the findings that its own tables do not bear out, as we ask
    "by edge": {"hexagon"},
    "near the least": {"triangle", "quad", "hexagon", "voronoi"},
}


def test_the_registry_knows_it():
    assert registry.source("polygon") is SOURCE


def test_some_figures_are_as_printed():
    assert SOURCE.times["voronoi"]["cell-nodes"] == {
        "by-node": 1.578, "by-edge": 0.484, "by-cell": 0.078, "edge-cell": 0.312, "edge-cell-node": 0.281,
    }  # fmt: skip
    assert SOURCE.times["hexagon"]["random-node-cells"]["edge-cell"] == 4.248
    assert SOURCE.times["quad"]["random-node-neighbours"]["by-node"] == 0.203
    assert VALUES["triangle"]["by-edge"] == 10.5
    assert SOURCE.structures["quad"]["edge-cell-node"] == 80_000_000
    assert SOURCE.models["voronoi"] == "1,000,867 cells, 3,002,602 edges, 2,001,736 nodes"


@pytest.mark.parametrize("model", MESHES)
def test_its_meshes_obey_euler_and_its_shares_are_those_of_its_times(model):
    mesh = MESHES[model]
    assert mesh["nodes"] - mesh["edges"] + mesh["cells"] == 1
    times = SOURCE.spoken[model]
    for block, share in zip(BLOCKS, SHARES[model], strict=True):
        spent = times[f"{block}-adjacency"]["edge-cell"] / times[block]["edge-cell"]
        assert 100 * spent == pytest.approx(share, abs=0.01)


def test_every_table_is_whole():
    assert {model: list(tasks) for model, tasks in SOURCE.times.items()}.keys() == set(MESHES) == set(SOURCE.figures)
    for tasks in SOURCE.times.values():
        assert set(tasks) == {*CELL_TASKS, *NODE_TASKS}
        assert all(list(times) == list(SOURCE.contestants) for times in tasks.values())


@pytest.mark.parametrize("finding", SOURCE.findings, ids=lambda finding: finding.name)
@pytest.mark.parametrize("model", MESHES)
def test_what_its_own_tables_say(finding, model):
    """Every reading has a figure in them, where it can have one; and those that contradict the text are known."""
    if finding.models and model not in finding.models:
        return
    readings = finding.readings(Published(model, SOURCE))
    known = [one for one in readings if one.figure is not None]
    assert len(known) == len(readings) or (finding.name, model) == ("memory", "voronoi")
    if known:
        outcome = worst_of(map(outcome_of, known))
        assert outcome == ("holds no longer" if model in OWN.get(finding.name, ()) else "holds")


TABLES = {table.name: table for table in SOURCE.tables}


def test_titles_and_formulas_are_those_of_the_family():
    known = {one.name: one for one in registry.contestants("polygon") if not one.extension}
    assert dict(SOURCE.contestants) == {name: one.title for name, one in known.items()}
    assert {name: one.values for name, one in known.items()} == FORMULAS


def test_formulas_give_the_values():
    for model, (edges, nodes, of_node, of_cell) in {
        "triangle": (1.5, 0.5, 6, 3),
        "quad": (2, 1, 4, 4),
        "hexagon": (3, 2, 3, 6),
    }.items():
        names = {"N": 1, "K": edges, "L": nodes, "k": of_node, "i": of_cell}
        for one, formula in FORMULAS.items():
            spelled = formula.replace("2k", "2*k").replace("2i", "2*i").replace(") ", ")*")
            spelled = spelled.replace("6K", "6*K").replace("4K", "4*K")
            assert eval(spelled, names) == VALUES[model][one], (model, one)


def test_all_printed_times_stand_in_the_tables_set_anew():
    for number, kind in (("table 3", "in order"), ("table 4", "at random")):
        lines = TABLES[number].lines([*SOURCE.contestants, "half-edge"])
        assert len(lines) == 4 * 6
        for line in lines:
            task, one = line.words
            assert task.startswith("random") == (kind == "at random")
            assert (line.printed == {}) == (one == "half-edge")
            for model, shown in line.printed.items():
                assert float(shown.split(" ")[0]) == round(1e3 * SOURCE.times[model][task][one])
                is_scaled = kind == "at random" and task in NODE_TASKS and model in ("triangle", "hexagon")
                assert shown.endswith(("(x2)", "(/2)")) == is_scaled


def test_shares_set_anew_are_as_printed():
    for number, column in (("table 6", 0), ("table 7", 1)):
        lines = {line.words[0]: line.printed for line in TABLES[number].lines(list(SOURCE.contestants))}
        printed = {model: f"{shares[column]:.2f}" for model, shares in SHARES.items()}
        assert lines.pop("edge-cell") == printed
        assert not any(lines.values())


@pytest.mark.parametrize(
    ("milliseconds", "shown"),
    [(16, "16 (1 tick)"), (31, "31 (2 ticks)"), (63, "63 (4 ticks)"), (78, "78"), (203, "203")],
)
def test_few_ticks_are_said(milliseconds, shown):
    assert in_ticks(milliseconds) == shown


def test_medians_in_the_claim_about_random_access():
    """Milliseconds for a million random queries over those for a million in order."""

    def medians(models):
        return median(_random_over_order(model, task, one) for model in models for task in (*CELL_TASKS, *NODE_TASKS)
                      if not task.startswith("random") for one in SOURCE.contestants)  # fmt: skip

    (remark,) = [finding.remark for finding in SOURCE.findings if finding.name == "at random"]
    assert f"the median is {medians(REGULAR):.1f} times on the regular meshes" in remark
    assert f"{medians(['voronoi']):.1f} times." in remark


def _random_over_order(model, task, one):
    times = SOURCE.times[model]
    return times[f"random-{task}"][one] / times[task][one]
