"""The source of the tetra family: its figures as printed, every number in its claims, and what its own tables say of them."""

import re
import subprocess
import sys

import pytest

from tests.report.made import SECONDS, make_backend
from tetrabench import registry
from tetrabench.errors import InputError
from tetrabench.report.thesis.comparison import outcome_of, worst_of
from tetrabench.report.thesis.facts import Published
from tetrabench.sources.tetra import MISSED, SOURCE

TIMES = SOURCE.times
CLAIMS = {finding.name: f"{finding.claim} {finding.remark}" for finding in SOURCE.findings}


def more(model, task, one, other):
    """How many percent longer one takes than another."""
    return round(100 * (TIMES[model][task][one] / TIMES[model][task][other] - 1))


def percents(text):
    return [int(number) for number in re.findall(r"(\d+)(?= (?:and|to) \d+ %| %)", text)]


def test_the_nozzle_is_as_printed():
    printed = {task: dict(times) for task, times in SECONDS.items()}
    printed["init"]["v5y"] = None  # 0.00, a misprint
    assert TIMES["nozzle"] == printed


def test_the_intake_is_as_printed():
    assert {task: times["v3y"] for task, times in TIMES["intake"].items()} == {
        "init": 1.03, "delete": 0.08, "explode": 1.92, "alfa": 10.28, "flow": 15.27, "free": 0.26,
    }  # fmt: skip
    assert TIMES["intake"]["explode"] == {
        "v3": 1.71, "v3x": 12.38, "v3y": 1.92, "v4": 1.96, "v5": 1.81, "v5x": 115.81, "v5y": 2.02,
    }  # fmt: skip
    assert SOURCE.memory["nozzle"]["v4"] == 259_824
    assert SOURCE.memory["intake"]["v5y"] == 78_832


def test_every_contestant_stands_in_every_table():
    tables = [times for tasks in TIMES.values() for times in tasks.values()] + list(SOURCE.memory.values())
    assert len(tables) == 14
    assert all(list(table) == list(SOURCE.contestants) for table in tables)
    assert set(SOURCE.figures) == set(TIMES) == set(SOURCE.memory) == set(SOURCE.models)


def test_titles_are_those_of_the_family():
    known = {one.name: one.title for one in registry.contestants("tetra") if one.source.startswith("J. Martin")}
    assert dict(SOURCE.contestants) == known == {name: make_backend(name).title for name in SOURCE.contestants}


def test_tasks_and_counts_are_those_of_the_family():
    scenarios = {one.name: one for one in registry.scenarios("tetra")}
    assert registry.family("tetra").reference == SOURCE.reference
    assert [name for name in registry.family("tetra").thesis_order if name in SOURCE.tasks] == SOURCE.tasks
    for task, counts in SOURCE.counts.items():
        assert counts.items() <= scenarios[task].thesis.items()


def test_numbers_in_claims_about_sweeps():
    text, *table = 93, *[more(model, task, "v4", "v3y") for model in TIMES for task in ("alfa", "flow")]
    assert table == [89, 53, 80, 42]
    assert percents(CLAIMS["sweeps-fields"]) == [text, 58, *table]
    behind = [more(model, task, "v3", "v3x") for model in TIMES for task in ("alfa", "flow")]
    assert percents(CLAIMS["sweeps-holes"]) == [min(behind), max(behind)] == [12, 26]
    ahead = [more("intake", task, "v3y", "v3x") for task in ("alfa", "flow")]
    assert percents(CLAIMS["sweeps-flag"]) == ahead == [14, 20]


def test_numbers_in_claims_about_edits_and_nodes():
    scans = [TIMES[model]["explode"]["v5x"] / TIMES[model]["explode"]["v3x"] for model in TIMES]
    assert [f"{ratio:.2g} times" in CLAIMS["scanning-records"] for ratio in scans] == [True, True]
    frees = [TIMES[model]["free"]["v4"] / TIMES[model]["free"]["v3y"] for model in TIMES]
    assert [f"{ratio:.2g} times" in CLAIMS["freeing"] for ratio in frees] == [True, True]
    nodes = [SOURCE.memory[model]["v4"] / SOURCE.memory[model]["v3y"] for model in TIMES]
    assert [int(100 * (ratio - 1)) for ratio in nodes] == [4, 4] == percents(CLAIMS["memory"]) * 2


def test_numbers_in_claims_about_the_search():
    points, tree, brute = 155_325, SOURCE.spoken["intake"]["locate-source"]["v3y"], 1443
    assert f"{points:,} tetras" == SOURCE.models["intake"]
    assert f"{points:,} points are found in {tree} s" in CLAIMS["searching"]
    assert f"{SOURCE.spoken['intake']['locate-brute']['v3y']:.0f} s" == f"{brute} s"
    assert f"34 of {points:,} points ({100 * MISSED:.2f} %)" in CLAIMS["missing"]


@pytest.mark.parametrize("model", list(TIMES))
def test_what_its_own_tables_say(model):
    facts = Published(model, SOURCE)
    said = {
        one.name: worst_of(map(outcome_of, one.readings(facts)))
        for one in SOURCE.findings
        if model in (one.models or TIMES)
    }
    assert said.pop("sweeps-holes") == "holds no longer"
    assert said.pop("holes") == "not measured"
    if model == "nozzle":  # it looked for points in the intake alone
        assert (said.pop("searching"), said.pop("missing")) == ("not measured", "not measured")
    assert set(said.values()) == {"holds"}


def test_findings_have_names_sections_and_figures():
    names = [finding.name for finding in SOURCE.findings]
    assert len(set(names)) == len(names)
    for finding in SOURCE.findings:
        assert re.search(r"\d\.\d|figure \d", finding.section)
        for reading in finding.readings(Published("intake", SOURCE)):
            assert "{}" in reading.words
            assert reading.least > 0 or reading.most < float("inf")


def test_a_family_without_a_source():
    assert registry.source("tetra") is SOURCE
    with pytest.raises(InputError, match="no source of the family 'tetras'; did you mean 'tetra'"):
        registry.source("tetras")


def test_a_source_needs_no_numba():
    code = "import sys, tetrabench.sources.tetra; print('numba' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "False"
