"""The ring with workers that are scripts: no process, no clock but theirs."""

import pytest

from tests.bench.test_plan import scripted_plan
from tetrabench.bench import exit_code, run_benchmark
from tetrabench.bench.agenda import Agenda
from tetrabench.bench.messages import Done, Failed, Load, Loaded, Measure, Measured, Open
from tetrabench.bench.spawn import WorkerDied
from tetrabench.errors import InputError


class Script:
    """A worker that says what `tell(backend, scenario, visit)` says: CPU seconds, or an exception."""

    def __init__(self, tell):
        self.tell = tell
        self.visits = 0
        self.is_dead = False

    def ask(self, request):
        assert not self.is_dead, "asked after its end"
        if isinstance(request, Open):
            self.backend = request.backend
            return Done(0.25)
        if isinstance(request, Load):
            seconds = self.tell(self.backend, "load", 0)
            return seconds if isinstance(seconds, Failed) else Loaded({"letters": 3}, {})
        if not isinstance(request, Measure):
            return Done(0.5)
        seconds = self.tell(self.backend, request.scenario, self.visits)
        self.visits += 1
        return Measured(
            prepare_s=0.0,
            cpu_s=seconds,
            process_cpu_s=seconds,
            wall_s=seconds,
            peak_bytes=None,
            structure={"letters": (3, 4)},
            digest="d",
            figures={},
            items=1,
            unit="letter",
            least_bytes=None,
        )

    def pin(self, core):
        pass

    def close(self):
        self.is_dead = True

    kill = close


class Diary:
    """Progress that is written down."""

    def __init__(self):
        self.steps = []

    def started(self, plan):
        self.plan = plan

    def step(self, *step):
        self.steps.append(step)


def play(tell, rounds=5, diary=None, chained=False):
    workers = []

    def spawn():
        workers.append(Script(tell))
        return workers[-1]

    return run_benchmark(scripted_plan(rounds, chained=chained), spawn=spawn, progress=diary), workers


def test_every_contestant_has_its_turn_in_every_round():
    results, workers = play(lambda *_: 0.1)
    assert len(results.samples) == 2 * 7 * 5
    for round in range(5):
        turns = [one.turn for one in results.samples if (one.scenario, one.round) == ("first", round)]
        assert turns == list(range(7))
    assert all(worker.is_dead for worker in workers)
    assert [backend.compile_s for backend in results.backends] == [1.0] * 7
    assert results.backends[0].structure == {"letters": (3, 4)}  # not there when loaded, but with the first sample


def test_a_hopeless_contestant_gets_fewer_rounds():
    results, _ = play(lambda name, scenario, visit: 10.01 if (name, scenario) == ("v3", "first") else 1.0)
    counts = {
        (name, scenario): sum((one.backend, one.scenario) == (name, scenario) for one in results.samples)
        for name in ("v2", "v3")
        for scenario in ("first", "second")
    }
    assert counts == {("v2", "first"): 5, ("v3", "first"): 3, ("v2", "second"): 5, ("v3", "second"): 5}


def test_a_dead_worker_is_spawned_anew_for_the_next_scenario():
    def tell(name, scenario, visit):
        if (name, scenario, visit) == ("v3", "first", 1):
            raise WorkerDied("signal 11")
        return 1.0

    results, workers = play(tell)
    mine = [one for one in results.samples if one.backend == "v3"]
    assert [one.status for one in mine] == ["ok", "crash"] + ["ok"] * 5
    assert len(workers) == 8
    assert exit_code(results) == 3


def test_a_net_that_all_scenarios_share_is_lost_with_its_worker():
    def tell(name, scenario, visit):
        if (name, scenario) == ("v3", "first"):
            raise WorkerDied("signal 11")
        return 1.0

    results, workers = play(tell, rounds=1, chained=True)
    mine = [one for one in results.samples if one.backend == "v3"]
    assert [(one.status, one.reason) for one in mine] == [
        ("crash", "signal 11"),
        ("skipped", "worker crashed in first"),
    ]
    assert len(workers) == 7


def test_a_worker_that_cannot_load_the_model_has_no_cells():
    def tell(name, scenario, visit):
        return Failed("too big") if (name, scenario) == ("v3", "load") else 1.0

    results, _ = play(tell)
    mine = [one for one in results.samples if one.backend == "v3"]
    assert [(one.status, one.reason) for one in mine] == [("error", "before its first sample: too big")] * 2


def test_a_bad_model_is_the_users_to_mend():
    with pytest.raises(InputError, match=r"x.nas:3: no"):
        play(lambda name, scenario, visit: Failed("x.nas:3: no", exit_code=2) if scenario == "load" else 1.0)


def test_an_interrupt_keeps_what_there_is():
    def tell(name, scenario, visit):
        if (name, scenario, visit) == ("v3", "second", 6):
            raise KeyboardInterrupt
        return 1.0

    results, workers = play(tell)
    assert results.interrupted
    assert exit_code(results) == 130
    assert len([one for one in results.samples if one.scenario == "first"]) == 35
    assert all(worker.is_dead for worker in workers)


def test_progress_counts_what_is_left():
    diary = Diary()
    play(lambda name, scenario, visit: 99.0 if name == "v3" else 1.0, diary=diary)
    warming, measuring = diary.steps[:14], diary.steps[14:]
    assert [step[1:3] for step in warming] == [(done, 14) for done in range(1, 15)]
    assert measuring[0][1:] == (0, 70, None)
    assert measuring[-1][1:3] == (65, 66)  # v3 loses two rounds, twice
    assert all(step[3] is not None for step in measuring[1:])


def test_remaining_time_comes_from_own_rounds_or_from_the_reference_scaled():
    agenda = Agenda(scripted_plan(rounds=2))
    assert agenda.seconds_remaining() is None
    for k in range(7):
        agenda.took("first", f"v{k}", 1.0 + k)
    assert agenda.total == 28
    # first: 1 + 2 + ... + 7 once more; second: the mean of all those, twice for each
    assert agenda.seconds_remaining() == pytest.approx(28 + 14 * 4)
    agenda.took("second", "v0", 10.0)  # so v6 will take 70
    assert agenda.seconds_remaining() == pytest.approx(28 + 10 + 2 * (20 + 30 + 40 + 50 + 60 + 70))
    agenda.limit("second", "v6", 0)
    assert agenda.seconds_remaining() == pytest.approx(28 + 10 + 2 * (20 + 30 + 40 + 50 + 60))
