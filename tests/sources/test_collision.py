"""The source of the collision family: its figures and findings hang together, and fit the family's scenarios and options."""

import re

import pytest

from tests.report.thesis.curve_runs import all_runs
from tetrabench import registry
from tetrabench.report.thesis.comparison import compare_with_source
from tetrabench.report.thesis.curves import trace
from tetrabench.sources.collision import FINDINGS, LEAVES, OPTIMUM, SOURCE, over

CURVES = [curve for figure in SOURCE.drawn for curve in figure.curves]


def test_the_registry_knows_it():
    assert registry.source("collision") is SOURCE


def test_it_draws_the_figures_that_the_paper_has():
    assert [curve.name for curve in CURVES] == [f"figure {number}" for number in (7, 8, 11, 12, 13, 14, 15)]
    recycling = {curve.name: (curve.scenario, curve.options["recycle"]) for curve in CURVES[3:]}
    assert recycling == {
        "figure 12": ("weightless", 1),
        "figure 13": ("weightless", 0),
        "figure 14": ("gravity", 0),
        "figure 15": ("gravity", 1),
    }


def test_its_scenarios_and_options_are_the_family_s():
    scenarios = {one.name: one for one in registry.scenarios("collision")}
    known = {one.name: one for one in registry.contestants("collision")}
    for curve in CURVES:
        scenario = scenarios[curve.scenario]
        assert SOURCE.counts[curve.scenario]["steps"] == scenario.thesis["steps"]
        for name in SOURCE.contestants:
            assert set(curve.options) <= set(known[name].options)
        if curve.over not in ("objects", "step"):
            assert curve.over in scenario.options or curve.over in known["kdtree"].options
    assert {name: known[name].is_exact for name in SOURCE.contestants} == {"leaf-only": False, "kdtree": True}
    limits = known["kdtree"].options["capacity"]
    assert limits.least <= OPTIMUM[0] < OPTIMUM[1] <= limits.most
    assert set(SOURCE.models) <= set(registry.family("collision").models)


def test_all_four_hypotheses_are_asked():
    assert [re.match(r"Hypothesis (\d)", one.claim)[1] for one in FINDINGS if one.claim.startswith("Hyp")] == list(
        "1234"
    )
    assert len({one.name for one in FINDINGS}) == len(FINDINGS)


@pytest.mark.parametrize("finding", FINDINGS, ids=lambda finding: finding.name)
def test_every_finding_has_its_figures_where_all_was_run_and_none_where_nothing_was(finding):
    runs = all_runs(launches=2)
    for name in SOURCE.contestants:
        readings = finding.readings(trace(CURVES, name, runs, SOURCE))
        assert all(one.figure is not None and one.about.startswith(name) for one in readings)
        nothing = finding.readings(trace(CURVES, name, [], SOURCE))
        assert [one.figure for one in nothing] == [None] * len(readings)


def test_what_a_reading_says_is_a_sentence_with_its_figure():
    for judged in compare_with_source(all_runs(), SOURCE).findings:
        for outcome in judged.outcomes:
            assert "?" not in outcome.evidence
            assert "{" not in outcome.evidence
            assert re.search(r"\d", outcome.evidence)
    assert over(None, 2.0) is None
    assert SOURCE.drawn[-1].count == LEAVES
