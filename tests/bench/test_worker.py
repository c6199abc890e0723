"""Real worker processes with contestants that misbehave."""

import dataclasses
import subprocess
import sys
from pathlib import Path

import pytest

from tests.bench.scripted import of, wait_until
from tetrabench.bench import exit_code, make_plan, run_benchmark, spawn, summary
from tetrabench.bench.catalogue import Inquiry
from tetrabench.bench.messages import (
    PROTOCOL,
    Done,
    Failed,
    Find,
    Gauge,
    Gauged,
    Load,
    Loaded,
    Measure,
    Measured,
    Open,
    Skipped,
    Warm,
)
from tetrabench.bench.spawn import WorkerDied, WorkerProcess
from tetrabench.errors import InputError, TetrabenchError
from tetrabench.protocols import Option

pytestmark = pytest.mark.usefixtures("plugin")
GOOD = ["steady", "other", "third"]
TASKS = ["first", "second", "third"]
COUNT = {"count": 2}


def run(*backends, profile="quick", scenarios=TASKS, launches=1, rounds=2, progress=None):
    effort = {} if profile in ("thesis", "check") else {"launches": launches, "rounds": rounds}
    plan = make_plan("tiny", family="scripted", backends=backends, profile=profile, scenarios=scenarios, **effort)
    backends = tuple(backend for backend in plan.backends if not backend.control)
    plan = dataclasses.replace(plan, backends=backends, has_memory=False, has_yardsticks=False)
    return run_benchmark(plan, progress=progress)


@pytest.fixture(autouse=True)
def few_repeats(monkeypatch):
    """Scripts are short, and nobody believes their times."""
    monkeypatch.setattr("tetrabench.bench.ring.MOST_REPEATS", 2)


@pytest.fixture
def on_stage(plugin):
    """on_stage(contestant): a worker that has loaded the model, with no limit to its silence so far."""
    workers = []

    def begin(contestant):
        worker = WorkerProcess(1)
        workers.append(worker)
        assert isinstance(worker.ask(Open("scripted", contestant)), Done)
        assert isinstance(worker.ask(Load("model")), Loaded)
        return worker

    yield begin
    for worker in workers:
        worker.kill()


# ---------------------------------------------------------------------- whole runs


def test_a_sample_carries_all_its_figures():
    results = run("steady", scenarios=["first"], rounds=1)
    (sample,) = results.samples
    assert (sample.status, sample.digest, sample.unit) == ("ok", "20", "letters")
    assert sample.items == 2 * sample.repeats
    assert sample.repeats == 2  # it is a short one
    assert sample.figures == {"count": 2, "threads": 1, "sum": 0.5}
    assert (sample.structure_bytes, sample.reserved_bytes) == (13, 24)
    assert min(sample.cpu_s, sample.process_cpu_s, sample.wall_s) > 0
    (backend,) = results.backends
    assert backend.structure == {"letters": (3, 4), "words": (10, 20)}
    assert backend.compile_s > 0
    assert results.models[0].size == {"letters": 3}
    (launch,) = results.launches
    assert all(seconds >= 0 for seconds in launch.seconds.values())
    assert exit_code(results) == 0


def test_every_bad_end_is_named_and_ends_its_own_cell_alone(capfd):
    bad = {
        "lazy": "unsupported",
        "wrong": "wrong",
        "unstable": "unstable",
        "raising": "failed",
        "crashing": "crashed",
        "crashing-small": "crashed",
        "leaving": "failed",
        "gone": "crashed",
        "greedy": "out of memory",
    }
    well = [*GOOD, "chatty", "closing", "verbose"]
    results = run(*well, *bad)
    verdicts = {(row.task, row.backend): row.verdict for row in summary(results)}
    for name, verdict in bad.items():
        assert verdicts["second", name] == verdict, name
        for task in ("first", "third"):
            assert {one.status for one in of(results, name, task)} == {"ok"}, name
    for name in well:
        assert {(one.task, one.status) for one in of(results, name)} == {(task, "ok") for task in TASKS}, name
    assert exit_code(results) == 3
    assert not [row.ratio for row in summary(results) if row.task == "second" and row.backend in bad and row.ratio]

    reasons = {name: of(results, name, "second")[-1].reason for name in bad}
    assert reasons["lazy"] == "too lazy"
    assert reasons["raising"].startswith("misbehave: ValueError: I would rather not (scripted_plugin.py:")
    assert reasons["crashing"] == "signal 11 (Segmentation fault)"
    assert reasons["crashing-small"] == "on the small model: signal 11 (Segmentation fault)"
    assert reasons["leaving"].startswith("misbehave: SystemExit: 4")
    assert reasons["gone"] == "exit code 4"
    assert reasons["greedy"].startswith("not enough memory: misbehave: MemoryError")
    assert reasons["wrong"] == "wrong says bad0, most say 20: count 41 instead of 2, sum none instead of 0.5"
    assert all(one.status == "wrong-result" for one in of(results, "wrong", "second"))
    unstable = [one.reason for one in of(results, "unstable", "second") if one.status == "unstable"]
    assert unstable == ["not always the same answer; unstable says bad1, most say 20: the same figures, but other bits"]
    output = capfd.readouterr()
    assert output.out == ""
    assert "hello" in output.err


def test_options_reach_the_contestant_wherever_it_is_opened():
    plan = make_plan(
        "tiny",
        family="scripted",
        backends=["steady", "tuned"],
        scenarios=["first"],
        options={"capacity": [3, 9], "recycle": [0]},
        launches=1,
        rounds=1,
    )
    results = run_benchmark(dataclasses.replace(plan, has_yardsticks=False))
    for capacity in (3, 9):
        (sample,) = of(results, f"tuned capacity={capacity}")
        assert (sample.status, sample.figures["capacity"], sample.figures["recycle"]) == ("ok", capacity, 0)
        (memory,) = (one for one in results.memory if one.backend == sample.backend)
        assert memory.structure == {"leaves": (capacity, 64)}
    assert exit_code(results) == 0


def test_series_are_checked_and_kept():
    results = run("steady", "tuned", "ragged", "boundless", scenarios=["first", "second"])
    assert of(results, "tuned", "second")[0].series == {"step": [10.0, 20.0], "step_s": [0.5, 0.25]}
    assert {one.status for one in of(results, "tuned")} == {"ok"}
    assert not any(one.series for one in results.samples if one.task == "first" or one.backend != "tuned")
    assert [one.status for one in of(results, "ragged", "second")] == ["error"]
    assert of(results, "ragged", "second")[0].reason == (
        "series of one answer are all of one length, and these are not: step 2, step_s 1"
    )
    assert of(results, "boundless", "second")[0].reason == "series step_s: inf, at place 0, is no finite number"


def test_a_contestant_that_is_known_to_be_wrong_is_shown_and_is_no_failure():
    results = run("steady", "other", "careless")
    rows = {(row.task, row.backend): row for row in summary(results)}
    assert {one.status for one in of(results, "careless", "second")} == {"wrong-result"}
    assert rows["second", "careless"].verdict == "inexact"
    assert rows["second", "careless"].reason.startswith(
        "known to give wrong answers; careless says bad0, most say 20: count 41 instead of 2"
    )
    assert rows["first", "careless"].status == "ok"
    assert exit_code(results) == 0
    assert exit_code(run("steady", "other", "wrong")) == 3
    alone = run("steady", "careless", scenarios=["second"])  # one against one
    assert [row.verdict for row in summary(alone)] == ["reference", "inexact"]


class Killer:
    """Progress that kills the worker of a backend between two of its samples."""

    def __init__(self, monkeypatch):
        self.workers = []

        class Kept(WorkerProcess):
            def __init__(worker, *arguments, **more):  # noqa: N805
                super().__init__(*arguments, **more)
                self.workers.append(worker)

        monkeypatch.setattr("tetrabench.bench.benchmark.WorkerProcess", Kept)

    def started(self, plan):
        pass

    def step(self, phase, detail, done, total, seconds_remaining):
        if detail == "second, steady, round 2":
            self.workers[0]._process.kill()


def test_a_worker_that_dies_between_samples(monkeypatch):
    killer = Killer(monkeypatch)
    results = run("steady", progress=killer)
    assert [one.status for one in of(results, "steady", "second")] == ["ok", "crash"]
    assert of(results, "steady", "second")[1].reason == "signal 9 (Killed)"
    assert [one.status for one in of(results, "steady", "third")] == ["ok"] * 2
    assert len(killer.workers) == 2


def test_the_thesis_profile_goes_on_with_one_net_until_it_is_broken():
    results = run("steady", "crashing", "raising", profile="thesis")
    assert [(one.task, one.digest) for one in of(results, "steady")] == [
        ("third", "201"),
        ("first", "202"),
        ("second", "203"),
    ]
    assert [one.status for one in of(results, "crashing")] == ["ok", "ok", "crash"]
    assert [one.status for one in of(results, "raising")] == ["ok", "ok", "error"]


def test_a_parallel_task_is_measured_by_wall_time_and_a_hidden_one_is_noticed():
    results = run("steady", "threaded", scenarios=["first", "many"], rounds=2)
    rows = {(row.task, row.backend): row for row in summary(results)}
    assert results.tasks[1].parallel
    assert rows["many", "steady"].clock == "wall"
    assert rows["first", "threaded"].clock == rows["first", "steady"].clock == "wall"  # though it says it is serial
    hidden = of(results, "threaded", "first")
    assert all(one.process_cpu_s >= 0.03 * one.repeats > 1.1 * one.cpu_s for one in hidden)
    assert {row.clock for row in summary(run("steady", scenarios=["first"], rounds=1))} == {"cpu"}


def test_unknown_names_end_the_run_before_it_starts():
    with pytest.raises(InputError, match="no scenario 'frist' in the family scripted; did you mean 'first'"):
        run("steady", scenarios=["frist"])


# ---------------------------------------------------------------------- one worker, step by step


def test_the_protocol_step_by_step():
    worker = WorkerProcess(1)
    try:
        stranger = worker.ask(Open("scripted", "raising", protocol=PROTOCOL + 1))
        assert stranger == Failed(f"messages of version {PROTOCOL + 1}; this tetrabench knows {PROTOCOL}", exit_code=2)
        unknown = worker.ask(Open("scripted", "nobody"))
        assert isinstance(unknown, Failed)
        assert unknown.exit_code == InputError.exit_code
        assert isinstance(worker.ask(Open("scripted", "raising")), Done)
        assert isinstance(worker.ask(Warm("first", COUNT)), Done)
        assert isinstance(worker.ask(Load("model")), Loaded)
        assert isinstance(worker.ask(Measure("second", COUNT)), Failed)
        repeated = worker.ask(Measure("first", COUNT, 3))  # it goes on
        assert isinstance(repeated, Measured)
        assert (repeated.repeats, repeated.items) == (3, 6)
    finally:
        worker.close()
    with pytest.raises(WorkerDied):
        worker.ask(Measure("first", COUNT))


def test_what_it_cannot_is_skipped_before_it_is_tried(on_stage):
    assert on_stage("lazy").ask(Measure("second", COUNT)) == Skipped("too lazy")


@pytest.mark.parametrize(
    ("contestant", "status", "reason"),
    [
        ("interrupting", "crash", "exit code 1|signal 2 "),
        ("orphaning", "crash", r"signal 11 \(Segmentation fault\)"),
        ("deaf", "crash", "it broke off the conversation"),
    ],
)
def test_a_death_is_noticed_whatever_it_looks_like(on_stage, monkeypatch, contestant, status, reason):
    monkeypatch.setattr(spawn, "_PATIENCE_S", 0.3)
    worker = on_stage(contestant)
    with pytest.raises(WorkerDied, match=reason) as death:
        worker.ask(Measure("second", COUNT))
    assert death.value.status == status
    with pytest.raises(WorkerDied):
        worker.ask(Measure("first", COUNT))


def test_who_says_nothing_for_too_long_is_ended(on_stage):
    worker = on_stage("hanging")
    worker._timeout_s = 0.5
    with pytest.raises(WorkerDied, match=r"no reply within 0\.5 s") as death:
        worker.ask(Measure("second", COUNT))
    assert death.value.status == "timeout"
    assert worker._process.poll() is not None


@pytest.mark.parametrize(("kills", "status"), [([7, 8], "oom"), ([7, 7], "crash")])
def test_whom_the_system_killed_for_want_of_memory(plugin, monkeypatch, on_stage, kills, status):
    counts = iter(kills)
    monkeypatch.setattr(spawn, "_oom_kills", lambda: next(counts))
    with pytest.raises(WorkerDied) as death:
        on_stage("killed").ask(Measure("second", COUNT))
    assert death.value.status == status
    reason = "the system ran out of memory and killed it" if status == "oom" else "signal 9 (Killed)"
    assert str(death.value) == reason


@pytest.mark.parametrize("contestant", ["recursive", "mumbling", "greedy"])
def test_an_exception_is_the_reply_and_the_worker_goes_on(on_stage, contestant):
    worker = on_stage(contestant)
    failed = worker.ask(Measure("second", COUNT))
    assert isinstance(failed, Failed)
    assert failed.oom == (contestant == "greedy")
    assert failed.exit_code == 0
    assert "\n" not in failed.reason
    assert isinstance(worker.ask(Measure("first", COUNT)), Measured)


def test_a_very_long_reply_arrives_whole_with_and_without_a_limit_of_time(on_stage):
    worker = on_stage("verbose")
    for timeout_s in (None, 60.0):
        worker._timeout_s = timeout_s
        assert len(worker.ask(Measure("second", COUNT)).figures) == 200_003


@pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")
def test_what_a_worker_started_ends_with_it(on_stage):
    worker = on_stage("parenting")
    child = Path(f"/proc/{worker.ask(Measure('second', COUNT)).items}/stat")
    wait_until(lambda: "(sleep) S" in child.read_text())  # it has begun
    worker.kill()
    wait_until(lambda: not child.exists() or "(sleep) Z" in child.read_text())  # or nobody has taken note yet


# ---------------------------------------------------------------------- a worker that is asked for facts


def test_a_guide_in_another_process():
    with Inquiry() as guide:
        facts = guide.describe("scripted")
        assert facts.reference == "steady"
        tuned, careless = facts.contestants[-2:]
        assert (tuned.name, tuned.exact) == ("tuned", True)
        assert tuned.options["capacity"] == Option(8, 1, 63, "letters that a leaf holds")
        assert (careless.name, careless.exact, careless.options) == ("careless", False, {})
        assert [one.name for one in facts.scenarios] == ["first", "second", "third", "many"]
        assert [one.parallel for one in facts.scenarios] == [False, False, False, True]
        found = guide.find_model(Find("scripted", "tiny"))
        assert Path(found.path).name == "model"
        assert (found.size, found.notes) == ({"letters": 3}, ["one letter is a digit"])
        with pytest.raises(InputError, match="no family 'script'; did you mean 'scripted'"):
            guide.describe("script")
        with pytest.raises(InputError, match="missing: no such file"):
            guide.find_model(Find("scripted", "missing"))
        assert isinstance(guide._worker.ask(Gauge()), Gauged)
        with pytest.raises(TetrabenchError, match=r"ended: signal 11 \(Segmentation fault\)"):
            guide.find_model(Find("scripted", "dying"))


def test_the_parent_of_a_run_stays_small():
    heavy = "numba numpy scipy pandas matplotlib llvmlite"
    code = f"import sys, tetrabench.cli, tetrabench.bench; print([m for m in {heavy.split()} if m in sys.modules])"
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert found.stdout.strip() == "[]"
