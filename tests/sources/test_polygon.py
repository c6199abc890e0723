"""The source of the polygon family: its figures as printed, and what its own tables say of its findings."""

import pytest

from tetrabench import registry
from tetrabench.report.thesis.comparison import outcome_of, worst_of
from tetrabench.report.thesis.facts import Published
from tetrabench.sources.polygon import BLOCKS, CELL_TASKS, MESHES, NODE_TASKS, SOURCE, VALUES

SHARES = {  # tables 6 and 7, in percent
    "triangle": (17.19, 14.07),
    "quad": (20.04, 14.29),
    "hexagon": (19.76, 16.01),
    "voronoi": (37.05, 39.48),
}
OWN = {  # the findings that its own tables do not bear out, as we ask
    "by edge": {"hexagon"},
    "near the least": {"triangle", "quad", "hexagon", "voronoi"},
    "main element": {"hexagon"},
    "at random": {"voronoi"},
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
    assert SOURCE.memory["quad"]["edge-cell-node"] == 80_000
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
