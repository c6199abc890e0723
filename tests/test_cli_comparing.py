"""The verbs on two versions and on the machine: what is printed where, exit codes, and no traceback."""

import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import msgspec
import pytest
from click.testing import CliRunner, Result

from tests.bench.runs import ENVIRONMENT, make_gate_run, make_run, spread
from tetrabench.bench import save_results
from tetrabench.bench.checkouts import Checkout
from tetrabench.bench.gate import make_gate
from tetrabench.bench.limits import limits_of
from tetrabench.cli import main
from tetrabench.errors import NotComparableError

ROOT = Path(__file__).parents[1]


def say(*words: object) -> Result:
    """What the command line answers."""
    return CliRunner().invoke(main, [str(word) for word in words])


def line_of(result: Result, code: int) -> str:
    """The one line with which something ends that does not work."""
    assert (result.exit_code, result.stdout) == (code, "")
    assert result.stderr.startswith("tetrabench: ")
    assert result.stderr.count("\n") == 1
    return result.stderr


@pytest.fixture
def files(tmp_path: Path):
    """Two runs: alfa has become slower."""
    paths = tmp_path / "old.json", tmp_path / "new.json"
    for path, factor in zip(paths, (1.0, 1.3), strict=True):
        save_results(make_run({"alfa": {"v4": spread(1.8 * factor)}, "flow": {"v4": spread(1.8)}}), path)
    return paths


# -- compare


def test_compare(files):
    old, new = files
    result = say("compare", old, new)
    assert result.exit_code == 1
    assert "1.30x slower, a regression" in result.stdout
    assert "The weaker comparison" in result.stdout
    assert "\x1b" not in result.stdout
    assert say("compare", old, old).exit_code == 0
    assert say("compare", old, new, "--threshold", "50%").exit_code == 0


def test_compare_for_programs_and_workflows(files):
    facts = json.loads(say("compare", *files, "--format", "json").stdout)
    assert facts["exit_code"] == 1
    assert [one["verdict"] for one in facts["changes"]] == ["slower", "same"]
    github = say("compare", *files, "--format", "github").stdout
    assert "| alfa | v4 |" in github
    assert "::error title=tetrabench compare%3A a regression::v4, alfa, box" in github
    assert "::error" not in say("compare", *files, "--format", "md").stdout


def test_runs_that_differ_in_more_than_the_code_are_5(files, tmp_path):
    other = make_run({"alfa": {"v4": spread()}}, environment={**ENVIRONMENT, "cores": 64})
    save_results(other, tmp_path / "other.json")
    assert "cores (2, then 64)" in line_of(say("compare", files[0], tmp_path / "other.json"), 5)
    assert "cannot read" in line_of(say("compare", files[0], tmp_path / "none.json"), 2)


@pytest.mark.parametrize("threshold", ["lots", "0%", "-5%"])
def test_a_threshold_that_is_none(files, threshold):
    assert "is no share such as 10% or 0.1" in line_of(say("compare", *files, f"--threshold={threshold}"), 2)


# -- gate


@pytest.fixture
def gated(monkeypatch):
    """Let `gate` find this; how it was asked."""
    asked = []

    def let(found):
        def run_gate(repository, base, head, make, limits, *, progress, output):
            asked.append({"base": base, "head": head, "make": make, "limits": limits, "output": output})
            if isinstance(found, BaseException):
                raise found
            return found

        monkeypatch.setattr("tetrabench.bench.gate.run_gate", run_gate)
        return asked

    return let


def found(factor: float, again: float | None = None):
    sides = [Checkout(revision=name, commit=name * 40, folder=Path(name)) for name in "ab"]
    runs = [None if ratio is None else make_gate_run({"alfa": {"v3y": spread(ratio)}}) for ratio in (factor, again)]
    return make_gate(*sides, limits_of(0.1), *runs)


@pytest.mark.parametrize(
    ("gate", "words", "code"),
    [
        (found(1.0), [], 0),
        (found(1.3, 1.3), [], 1),
        (found(1.3, 1.0), [], 0),
        (found(1.3, 1.0), ["--strict"], 4),
        (msgspec.structs.replace(found(1.3), ended="interrupted"), [], 130),
    ],
)
def test_gate_exits_as_it_found(gated, gate, words, code):
    asked = gated(gate)
    result = say("gate", "--base", "main", *words)
    assert result.exit_code == code
    assert "head b" in result.stdout
    assert (asked[0]["base"], asked[0]["head"], asked[0]["limits"].cpu) == ("main", None, 1.1)


def test_gate_plans_what_it_is_told(gated, monkeypatch):
    plans = []
    monkeypatch.setattr("tetrabench.bench.make_plan", lambda **choices: plans.append(choices))
    for words in ([], ["--tets", "5k"], ["--model", "some.nas"]):
        asked = gated(found(1.0))
        say("gate", "--base", "main", *words)
        asked[-1]["make"](None)
    assert [(plan["model"], plan["tets"]) for plan in plans] == [(None, None), (None, [5_000]), ("some.nas", None)]
    assert plans[0]["profile"] == "rigorous"


def test_gate_says_in_one_line_what_does_not_work(gated, tmp_path, monkeypatch):
    gated(NotComparableError("main is too old to be compared"))
    assert "too old" in line_of(say("gate", "--base", "main"), 5)
    assert "Missing option '--base'" in line_of(say("gate"), 2)
    monkeypatch.undo()
    monkeypatch.chdir(tmp_path)
    assert "not a git repository" in line_of(say("gate", "--base", "main"), 2)


def test_a_gate_that_is_ended_by_the_system_ends_as_by_ctrl_c(monkeypatch):
    before = signal.getsignal(signal.SIGTERM)
    monkeypatch.setattr("tetrabench.bench.gate.run_gate", lambda *_, **__: os.kill(os.getpid(), signal.SIGTERM))
    assert say("gate", "--base", "main").exit_code == 130
    assert signal.getsignal(signal.SIGTERM) is before


# -- history


def test_history(files, tmp_path):
    file, chart = tmp_path / "history.jsonl", tmp_path / "history.svg"
    assert say("history", "add", files[0], "--file", file).stderr == f"added to {file}\n"
    assert "already: nothing added" in say("history", "add", files[0], "--file", file).stderr
    say("history", "add", files[1], "--file", file)
    assert len(file.read_text().splitlines()) == 2
    result = say("history", "plot", "--file", file, "-o", chart, "--scenario", "alfa")
    assert (result.exit_code, result.stderr) == (0, f"wrote {chart}\n")
    assert chart.stat().st_size > 1000
    assert "no backend 'v9'" in line_of(say("history", "plot", "--file", file, "-o", chart, "--backend", "v9"), 2)
    assert "cannot read" in line_of(say("history", "plot", "--file", tmp_path / "none", "-o", chart), 2)


# -- doctor


def test_doctor(monkeypatch):
    from tetrabench.bench.doctor import Fact

    facts = [Fact(name="cores", value="2"), Fact(name="load", value="9 on 2 cores", state="bad", advice="close things")]
    monkeypatch.setattr("tetrabench.bench.doctor.examine", lambda: iter(facts))
    text = say("doctor").stdout
    assert "cores" in text
    assert "close things" in text
    assert json.loads(say("doctor", "--format", "json").stdout)[1]["state"] == "bad"


# -- all of them


@pytest.mark.parametrize("module", ["tetrabench.cli", "tetrabench.bench.gate", "tetrabench.bench.compare"])
def test_the_parent_stays_small(module):
    code = f"import sys, {module}; print([name for name in ('numba', 'scipy', 'pandas', 'matplotlib') if name in sys.modules])"
    done = subprocess.run([sys.executable, "-P", "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "[]\n"


def test_the_page_names_every_outcome_and_exit_code():
    page = (ROOT / "docs/comparing.md").read_text()
    for outcome in ("passed", "failed", "inconclusive", "broken", "not compared"):
        assert f"| {outcome} |" in page
    for code in (0, 1, 2, 3, 4, 5, 6, 130):
        assert f"| {code} |" in page
