"""Real worker processes with contestants that misbehave."""

import pytest

from tetrabench.bench import exit_code, make_plan, run_benchmark, summary
from tetrabench.bench.messages import Done, Failed, Load, Loaded, Measure, Measured, Open, Warm
from tetrabench.bench.spawn import WorkerDied, WorkerProcess
from tetrabench.errors import InputError

pytestmark = pytest.mark.usefixtures("plugin")
GOOD = ["steady", "other", "third"]


def run(*backends, thesis=False, scenarios=None, progress=None, spawn=None, rounds=None):
    plan = make_plan(
        "tiny",
        family="scripted",
        backends=backends,
        thesis=thesis,
        scenarios=scenarios,
        rounds=rounds,
        quick=True,
    )
    return run_benchmark(plan, progress=progress, spawn=spawn)


def cell(results, backend, scenario="second"):
    return [one for one in results.samples if (one.backend, one.scenario) == (backend, scenario)]


def test_a_sample_carries_all_its_figures():
    results = run("steady", scenarios=["first"], rounds=1)
    (sample,) = results.samples
    assert (sample.status, sample.digest, sample.items, sample.unit) == ("ok", "20", 2, "letters")
    assert sample.figures == {"count": 2, "threads": 1, "sum": 0.5}
    assert (sample.structure_bytes, sample.reserved_bytes) == (13, 24)
    assert min(sample.cpu_s, sample.process_cpu_s, sample.wall_s) >= 0
    (backend,) = results.backends
    assert backend.structure == {"letters": (3, 4), "words": (10, 20)}
    assert backend.compile_s > 0
    assert backend.first_sample_s > 0
    assert results.model_size == {"letters": 3}
    assert exit_code(results) == 0


def test_a_contestant_may_print_and_read(capfd):
    results = run(*GOOD, "chatty", rounds=1)
    assert exit_code(results) == 0
    assert len(results.samples) == 4 * 3
    output = capfd.readouterr()
    assert output.out == ""
    assert "hello" in output.err


def test_every_bad_end_is_named_and_ends_its_own_cell_alone():
    bad = {
        "lazy": "skipped",
        "wrong": "wrong",
        "raising": "failed",
        "crashing": "crashed",
        "leaving": "failed",
    }
    results = run(*GOOD, *bad, "crashing-small")
    verdicts = {(row.scenario, row.backend): row.verdict for row in summary(results)}
    for name, verdict in {**bad, "crashing-small": "crashed"}.items():
        assert verdicts["second", name] == verdict
        assert verdicts["first", name] not in {"skipped", "wrong", "failed", "crashed"}
        assert len(cell(results, name, "third")) == 3
    for name in GOOD:
        assert [sample.status for sample in cell(results, name)] == ["ok"] * 3
    assert exit_code(results) == 3

    reasons = {name: cell(results, name)[0].reason for name in [*bad, "crashing-small"]}
    assert reasons["lazy"] == "too lazy"
    assert reasons["raising"].startswith("ValueError: I would rather not (scripted_plugin.py:")
    assert reasons["crashing"] == "signal 11 (Segmentation fault)"
    assert reasons["crashing-small"] == "on the small model: signal 11 (Segmentation fault)"
    assert reasons["leaving"].startswith("on the small model: SystemExit: 4")
    assert reasons["wrong"] == ("wrong says bad0, most say 20: count 41 instead of 2, sum none instead of 0.5")
    assert all(sample.status == "wrong-result" for sample in cell(results, "wrong"))
    assert all(row.ratio is None for row in summary(results) if (row.scenario, row.backend) == ("second", "wrong"))


class Killer:
    """Progress that kills the worker of a backend between two of its samples."""

    def __init__(self, backend):
        self.backend = backend
        self.workers = []

    def spawn(self):
        self.workers.append(WorkerProcess(1))
        return self.workers[-1]

    def started(self, plan):
        pass

    def step(self, text, done, total, seconds_remaining):
        if text == f"second: {self.backend}, round 2":
            self.workers[0]._process.kill()


def test_a_worker_that_dies_between_samples():
    killer = Killer("steady")
    results = run("steady", progress=killer, spawn=killer.spawn)
    assert [sample.status for sample in cell(results, "steady")] == ["ok", "crash"]
    assert cell(results, "steady")[1].reason == "signal 9 (Killed, out of memory perhaps)"
    assert [sample.status for sample in cell(results, "steady", "third")] == ["ok"] * 3
    assert len(killer.workers) == 2


def test_the_thesis_profile_goes_on_with_one_net_until_it_is_broken():
    results = run(*GOOD, "crashing", "raising", thesis=True)
    assert results.profile == "thesis"
    assert [sample.scenario for sample in results.samples if sample.backend == "steady"] == [
        "third",
        "first",
        "second",
    ]
    assert [sample.digest for sample in results.samples if sample.backend == "steady"] == [
        "201",
        "202",
        "203",
    ]
    assert cell(results, "crashing")[0].status == "crash"
    results = run(*GOOD, "crashing-small", thesis=True)
    assert cell(results, "crashing-small")[0].status == "crash"


def test_the_protocol_step_by_step(plugin):
    worker = WorkerProcess(1)
    try:
        assert isinstance(worker.ask(Open("scripted", "raising", False)), Done)
        assert isinstance(worker.ask(Warm("first", {"count": 1})), Done)
        assert isinstance(worker.ask(Load("model")), Loaded)
        assert isinstance(worker.ask(Measure("second", {"count": 1})), Failed)
        assert isinstance(worker.ask(Measure("first", {"count": 1})), Measured)  # it goes on
        unknown = worker.ask(Open("scripted", "nobody", False))
        assert isinstance(unknown, Failed)
        assert unknown.exit_code == InputError.exit_code
    finally:
        worker.close()
    with pytest.raises(WorkerDied, match="exit code 0"):
        worker.ask(Measure("first", {"count": 1}))


def test_unknown_names_end_the_run_before_it_starts():
    with pytest.raises(InputError, match="no scenario 'frist'; did you mean 'first'"):
        run("steady", scenarios=["frist"])
