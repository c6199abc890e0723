"""The verb recommend: what a person asks and reads, exit codes, and no traceback."""

import json
from functools import partial

import click
import msgspec
import pytest

import tests.test_cli
from tests.report.made import make_results
from tetrabench import registry
from tetrabench.bench import save_results
from tetrabench.bench.record import Task
from tetrabench.cli.advising import read_bytes
from tetrabench.protocols import Workload

COUNTS = {
    "alfa": {"sweeps": 200},
    "flow": {"sweeps": 200},
    "delete": {"deletions": 20_000},
    "explode": {"splits": 50_000},
}


say = partial(tests.test_cli.say, "recommend")
refusal = partial(tests.test_cli.refusal, "recommend")


@pytest.fixture
def run(tmp_path):
    """The source's own times, as a file; without locate and select."""
    results = make_results(rounds=1)
    tasks = [Task(name=one.name, scenario=one.name, options=COUNTS.get(one.name, {})) for one in results.tasks]
    path = tmp_path / "run.json"
    save_results(msgspec.structs.replace(results, tasks=tasks), path)
    return path


def test_a_mix_of_ones_own(run):
    result = say(run, "--mix", "alfa=20,delete=1,explode=0.1")
    assert (result.exit_code, result.stderr) == (0, "")
    lines = result.stdout.splitlines()
    assert lines[0] == "nozzle: use v3y"
    assert "Use v3y. The next one, v5y, takes 1.7" in result.stdout
    assert "20 sweeps of alfa, delete once" in result.stdout
    assert "v3: delete takes 94 % of its time" in result.stdout
    assert [line.split()[0] for line in lines[4:11]] == ["v3y", "v5y", "v4", "v3x", "v5x", "v3", "v5"]


def test_all_usual_mixes_in_short(run):
    result = say(run)
    assert result.exit_code == 0
    assert [line.split()[0] for line in result.stdout.splitlines()[4:7]] == ["simulation", "refinement", "static"]
    assert "refinement use v3y" in " ".join(result.stdout.split())
    assert "queries is left out: the run is without locate, select." in result.stdout
    assert "--workload NAME" in result.stdout
    assert "interval" not in result.stdout


def test_one_workload(run):
    result = say(run, "--workload", "refinement", "--format", "md")
    assert result.exit_code == 0
    assert result.stdout.startswith("**nozzle, refinement: use v3y**\n\n| backend | takes | interval |")
    assert "a net that is refined and coarsened" in result.stdout


def test_an_unknown_workload_lists_them_with_their_mixes(run):
    said = refusal(run, "--workload", "?")
    assert "no workload '?'; there are: simulation (" in said
    assert "refinement (init=1,explode=2" in said
    assert "did you mean 'static'" in refusal(run, "--workload", "statik")


def test_a_workload_whose_scenarios_were_not_run(run):
    said = refusal(run, "--workload", "queries")
    assert "this run is without locate, select: say with --mix NAME=N what you do, of init, delete, explode" in said


def test_a_family_without_workloads(run, monkeypatch):
    monkeypatch.setattr(registry, "workloads", lambda family: {})
    assert "no workloads are known of tetra: say with --mix" in refusal(run)
    assert "no workload 'static'; there are: none" in refusal(run, "--workload", "static")


def test_a_workload_of_a_plug_in(run, monkeypatch):
    odd = Workload(name="my <work>", title="[bold]odd[/bold] | *work*", mix={"alfa": 1, "delete.deletions": 10})
    monkeypatch.setattr(registry, "workloads", lambda family: {odd.name: odd})
    result = say(run)
    assert "my <work>" in result.stdout
    assert "[bold]odd[/bold] | *work*: 1 sweep of alfa, 10 deletions of delete." in result.stdout


def test_json_has_the_sentence_and_the_figures(run):
    facts = json.loads(say(run, "--mix", "alfa=20", "--format", "json").stdout)
    (one,) = facts["recommendations"]
    assert one["model"] == "nozzle"
    assert one["advice"].startswith("Use v3x or v3y")
    assert one["ranked"][0]["beside"] is None
    assert one["ranked"][1]["beside"]["low"] < one["ranked"][1]["beside"]["high"]
    facts = json.loads(say(run, "--format", "json").stdout)
    assert [one["workload"] for one in facts["recommendations"]] == ["simulation", "refinement", "static"]
    assert facts["notes"][0].startswith("queries is left out")


def test_a_limit_of_memory(run):
    result = say(run, "--mix", "alfa=20", "--memory-limit", "170MB")
    assert result.exit_code == 0
    assert "Not ranked: v4: it needs 178 MB at its peak, the limit is 170 MB." in result.stdout
    assert "~tetras fit" in result.stdout


@pytest.mark.parametrize(
    ("text", "size"),
    [
        ("500M", 500_000_000),
        ("2G", 2_000_000_000),
        ("2GB", 2_000_000_000),
        ("1.5GiB", 1_610_612_736),
        ("1.5 Gi", 1_610_612_736),
        ("64k", 64_000),
        ("123", 123),
        ("123B", 123),
    ],
)
def test_amounts_of_memory(text, size):
    assert read_bytes(None, None, text) == size


@pytest.mark.parametrize("text", ["", "G", "0", "0.1", "-1G", "2X", "2 giga", "1,5G", "nan", "2GiBB"])
def test_what_is_no_amount_of_memory(text):
    with pytest.raises(click.BadParameter, match="no amount of memory such as"):
        read_bytes(None, None, text)


def test_what_does_not_work_is_said_in_a_line(run, tmp_path):
    assert "did you mean 'alfa'" in refusal(run, "--mix", "alfaa=1")
    assert "two ways to say the same" in refusal(run, "--mix", "alfa=1", "--workload", "static")
    assert "no amount of memory" in refusal(run, "--memory-limit", "lots")
    assert "cannot read results" in refusal(tmp_path / "none.json")
    assert "no results of tetrabench" in refusal(__file__)
    save_results(make_results({"alfa": {"v3y": 1.0}}, profile="check"), tmp_path / "check.json")
    assert "answers only" in refusal(tmp_path / "check.json", "--mix", "alfa=1")
