"""The ring with workers that are scripts: turns, launches, and what becomes of bad ends."""

import dataclasses
from collections import Counter

import msgspec
import pytest

from tests.bench.scripted import BUILDING, Diary, Play, measured, of, play, scripted_plan
from tetrabench.bench import Sample, exit_code, summary
from tetrabench.bench.agenda import Agenda, Cell
from tetrabench.bench.benchmark import GAUGED
from tetrabench.bench.environment import usable_cores
from tetrabench.bench.groups import BARE_BYTES, SHARE
from tetrabench.bench.messages import Done, Failed, Skipped
from tetrabench.bench.plan import Plan, Task
from tetrabench.bench.ring import LONG_S, MOST_REPEATS, PREPARED_S, find_repeats
from tetrabench.bench.spawn import WorkerDied
from tetrabench.errors import InputError, MemoryRefusedError

NAMES = ["v0", "v1", "v2", "v3", "v0 control"]


def statuses(results, backend, task=None):
    return [one.status for one in of(results, backend, task)]


def verdicts(results, task="first"):
    return {row.backend: row.verdict for row in summary(results) if row.task == task}


# ---------------------------------------------------------------------- turns


def test_each_contestant_has_its_turn_in_each_round_of_each_launch():
    game = Play()
    results = game.run(scripted_plan(launches=2, rounds=3))
    taken = Counter((one.task, one.backend, one.launch, one.round) for one in results.samples)
    assert set(taken.values()) == {1}
    assert len(taken) == 2 * 5 * 2 * 3
    for launch, round in [(0, 0), (0, 2), (1, 1)]:
        turns = [one.turn for one in results.samples if (one.task, one.launch, one.round) == ("first", launch, round)]
        assert turns == list(range(5))
    assert len(game.workers) == 2 * 5  # fresh ones in each launch
    assert all(worker.is_dead for worker in game.workers)
    assert results.ended == ""


def test_one_latin_square_goes_through_all_launches():
    """5 launches of 2 rounds are 10 rounds of 5: each has each place twice."""
    results = play(scripted_plan(launches=5, rounds=2))
    places = Counter((one.backend, one.turn) for one in results.samples if one.task == "first")
    assert set(places.values()) == {2}
    assert len(places) == 25


def test_what_is_learned_of_backends_and_model():
    results = play(scripted_plan())
    assert [backend.name for backend in results.backends] == NAMES
    assert [backend.compile_s for backend in results.backends] == [1.0] * 5  # two tasks, half a second each
    assert results.backends[0].structure == BUILDING  # not there when loaded, but with the first sample
    assert results.models[0].size == {"letters": 3}
    assert len(results.models[0].digest) == 16


def test_serial_tasks_share_one_core_which_changes_from_launch_to_launch(monkeypatch):
    monkeypatch.setattr("tetrabench.bench.ring.usable_cores", lambda: [2, 3, 5])
    plan = scripted_plan(launches=4)
    plan = dataclasses.replace(
        plan, tasks=(Task(name="first", scenario="first"), Task(name="many", scenario="many", parallel=True))
    )
    game = Play()
    results = game.run(plan)
    assert [launch.core for launch in results.launches] == [5, 3, 2, 5]
    for launch, worker in zip(range(4), game.workers[::5], strict=True):
        assert worker.cores == [{results.launches[launch].core}, {2, 3, 5}]


def test_a_contestant_whose_kernels_were_compiled_starts_anew_without_the_compiler():
    """And its time to compile is that of the first worker."""

    def tell(asked):
        return Done(2.5, compiled=3) if (asked.backend, asked.what, asked.life) == ("v1", "warm", 0) else 0.1

    game = Play(tell)
    results = game.run(scripted_plan(launches=1))
    assert [worker.backend for worker in game.workers].count("v1") == 2
    assert results.backends[1].compile_s == 5.0


def sweep_plan(count, **more):
    """So many backends, the first seven of one contestant, the next seven of another, ...; and the control."""
    plan = scripted_plan(backends=count, **more)
    backends = tuple(
        msgspec.structs.replace(one, contestant=f"c{k % count // 7}", options={"capacity": k})
        for k, one in enumerate(plan.backends)
    )
    return dataclasses.replace(plan, backends=backends)


def test_of_many_backends_of_a_contestant_the_first_compiles_and_the_others_load(monkeypatch):
    monkeypatch.setattr("tetrabench.bench.ring.usable_cores", lambda: [0])
    compiled = set()

    def tell(asked):
        if asked.what != "warm":
            return 0.1
        kernels = (plan.backends[[one.name for one in plan.backends].index(asked.backend)].contestant, asked.task)
        is_new = kernels not in compiled
        compiled.add(kernels)
        return Done(1.0 if is_new else 0.1, compiled=int(is_new))

    plan = sweep_plan(20, launches=1, rounds=1)
    game, diary = Play(tell), Diary()
    results = game.run(plan, progress=diary)
    begun = list(dict.fromkeys(asked.backend for asked in game.asked("open")))
    assert begun[:3] == ["v0", "v7", "v14"]  # one of each contestant
    assert begun[3:] == [*(f"v{k}" for k in range(20) if k % 7), "v0 control"]
    assert [one.name for one in results.backends if one.compile_s == 2.0] == begun[:3]
    steps = [step for step in diary.steps if step[0] in ("compiling", "loading what was compiled")]
    assert len(steps) == 2 * (21 + 3)  # who compiled begins anew
    assert {total for _, _, _, total, _ in steps} == {2 * 21}
    assert max(done for _, _, done, _, _ in steps) == 2 * 21
    assert [step[0] for step in steps].count("compiling") == 6


def test_options_are_told_to_every_worker():
    game = Play()
    plan = dataclasses.replace(sweep_plan(20, launches=1, rounds=1), has_memory=True)
    game.run(plan)
    told = {one.name: one.options for one in plan.backends}
    opened = [(asked.backend, request.options) for asked, request in game.log if asked.what == "open"]
    assert len(opened) == 21 + 20  # to measure, to weigh
    assert all(options == told[name] for name, options in opened)


def test_a_ring_of_many_backends_in_groups(monkeypatch):
    """20 backends of which six fit beside the reference and its control: each has all its turns, in balance."""
    available = 8 * BARE_BYTES / SHARE + 1
    monkeypatch.setattr("tetrabench.bench.benchmark.available_bytes", lambda: available)
    plan = sweep_plan(20, launches=6, rounds=1)
    diary = Diary()
    results = play(plan, progress=diary)
    compared = [one.name for one in plan.backends[1:-1]]
    taken = Counter((one.backend, one.task, one.launch) for one in results.samples)
    assert all(
        taken[name, task, launch] == 1 for name in compared for task in ("first", "second") for launch in range(6)
    )
    assert {taken[name, "first", 0] for name in ("v0", "v0 control")} == {4}  # once in each group
    assert {(one.launch, one.group) for one in results.launches} == {(k, group) for k in range(6) for group in range(4)}
    assert {row.verdict for row in summary(results) if not row.control and row.backend != "v0"} == {"about"}
    assert {one.launches for one in summary(results)} == {6}


def test_the_turns_of_many_backends_are_in_balance():
    """21 launches of one round: each of 20 backends and the control has each place once."""
    results = play(sweep_plan(20, launches=21, rounds=1, tasks=("first",)))
    places = Counter((one.backend, one.turn) for one in results.samples)
    assert set(places.values()) == {1}
    assert len(places) == 21 * 21


# ---------------------------------------------------------------------- repeats


@pytest.mark.parametrize(
    ("run_s", "prepare_s", "repeats"),
    [
        (1.0, 0.0, 1),
        (LONG_S, 0.0, 1),
        (LONG_S / 2, 0.0, 2),
        (LONG_S / 2.5, 0.0, 3),
        (0.0, 0.0, MOST_REPEATS),
        (1e-6, PREPARED_S / 7, 7),  # no more than can be prepared in the time
        (1e-6, 2 * PREPARED_S, 1),
    ],
)
def test_a_sample_repeats_its_scenario_until_it_is_long(run_s, prepare_s, repeats):
    assert find_repeats(run_s, prepare_s) == repeats


def test_repeats_are_found_once_from_the_reference_and_are_the_same_for_all():
    game = Play(lambda asked: 0.004 if asked.backend == "v0" else 0.01)
    results = game.run(scripted_plan(launches=2, rounds=2))
    assert {one.repeats for one in results.samples} == {5}
    assert {one.cpu_s for one in of(results, "v0")} == {0.02}
    calibrations = [asked for asked in game.asked("measure") if asked.repeats == 1]
    assert [(asked.backend, asked.task) for asked in calibrations] == [("v0", "first"), ("v0", "second")]
    assert len(results.samples) == 2 * 5 * 2 * 2  # they are no samples


def test_a_parallel_task_is_calibrated_by_wall_time():
    plan = dataclasses.replace(scripted_plan(), tasks=(Task(name="first", scenario="first", parallel=True),))
    results = play(plan, lambda asked: measured(0.001, asked.repeats, wall_s=0.01 * asked.repeats))
    assert {one.repeats for one in results.samples} == {2}


def test_where_the_reference_cannot_be_calibrated_another_can():
    def tell(asked):
        return Failed("no") if (asked.backend, asked.task, asked.what) == ("v0", "first", "measure") else 0.01

    results = play(scripted_plan(), tell)
    assert {one.repeats for one in results.samples if one.status == "ok"} == {2}
    assert statuses(results, "v0", "first") == ["error"]
    assert set(verdicts(results).values()) == {"failed", "no reference"}
    assert verdicts(results, "second")["v1"] == "about"


# ---------------------------------------------------------------------- hopeless contestants


@pytest.mark.parametrize(("rounds_in_all", "launches"), [(3, [0, 1, 2]), (1, [0])])
def test_a_hopeless_contestant_gets_few_rounds_one_a_launch(rounds_in_all, launches):
    def tell(asked):
        return 10.01 if (asked.backend, asked.task) == ("v3", "first") else 1.0

    plan = scripted_plan(launches=5, rounds=2, hopeless_rounds=rounds_in_all)
    game = Play(tell)
    results = game.run(plan)
    assert [(one.launch, one.round) for one in of(results, "v3", "first")] == [(launch, 0) for launch in launches]
    assert len(of(results, "v3", "second")) == len(of(results, "v2", "first")) == 10
    assert len(of(results, "v0", "first")) == 10
    assert exit_code(results) == 0
    assert verdicts(results)["v3"] == "slower"
    row = next(row for row in summary(results) if (row.task, row.backend) == ("first", "v3"))
    assert row.is_bound


def test_ten_times_is_not_hopeless():
    results = play(scripted_plan(), lambda asked: 10.0 if asked.backend == "v3" else 1.0)
    assert len(of(results, "v3")) == len(of(results, "v2"))


def test_hopelessness_of_a_parallel_task_is_seen_by_wall_time():
    plan = dataclasses.replace(
        scripted_plan(hopeless_rounds=1), tasks=(Task(name="first", scenario="first", parallel=True),)
    )

    def tell(asked):
        return measured(1.0, asked.repeats, wall_s=20.0 if asked.backend == "v3" else 1.0)

    assert len(of(play(plan, tell), "v3")) == 1


# ---------------------------------------------------------------------- bad ends

ENDS = {
    "crash": WorkerDied("signal 11 (Segmentation fault)"),
    "timeout": WorkerDied("no reply within 1 s", "timeout"),
    "oom": Failed("not enough memory: no reason given", oom=True),
    "oom by the system": WorkerDied("the system ran out of memory and killed it", "oom"),
    "error": Failed("ValueError: I would rather not"),
    "unsupported": Skipped("too lazy"),
}


@pytest.mark.parametrize("end", ENDS)
def test_a_bad_end_ends_one_cell_alone_and_for_all_launches(end):
    def tell(asked):
        if (asked.backend, asked.task, asked.what, asked.visit) == ("v3", "first", "measure", 1):
            if isinstance(ENDS[end], Exception):
                raise ENDS[end]
            return ENDS[end]
        return 1.0

    game = Play(tell)
    results = game.run(scripted_plan(launches=3, rounds=3))
    status = end.split()[0]
    assert statuses(results, "v3", "first") == ["ok", status]
    assert of(results, "v3", "first")[1].reason in str(ENDS[end])
    assert statuses(results, "v3", "second") == ["ok"] * 9
    for name in ("v0", "v1", "v2", "v0 control"):
        assert statuses(results, name) == ["ok"] * 18
    assert exit_code(results) == (0 if status == "unsupported" else 3)
    died = isinstance(ENDS[end], Exception)
    assert len(game.workers) == 3 * 5 + died  # a new one for the next task


def test_a_worker_that_was_spawned_anew_is_warmed_for_what_is_left_only():
    def tell(asked):
        if (asked.backend, asked.task, asked.what) == ("v3", "first", "measure"):
            raise WorkerDied("signal 11")
        return 1.0

    game = Play(tell)
    game.run(scripted_plan(launches=1))
    lives = [(asked.life, asked.task) for asked in game.asked("warm") if asked.backend == "v3"]
    assert lives == [(0, "first"), (0, "second"), (1, "second")]


def test_what_dies_on_the_small_model_is_not_measured():
    def tell(asked):
        if (asked.backend, asked.task) == ("v3", "first"):
            raise WorkerDied("signal 11")
        return 1.0

    game = Play(tell)
    results = game.run(scripted_plan(launches=3))
    (sample,) = of(results, "v3", "first")
    assert (sample.status, sample.reason) == ("crash", "on the small model: signal 11")
    assert not [asked for asked in game.asked("measure") if (asked.backend, asked.task) == ("v3", "first")]
    assert len([asked for asked in game.asked("warm") if (asked.backend, asked.task) == ("v3", "first")]) == 1
    assert statuses(results, "v3", "second") == ["ok"] * 9


def test_what_cannot_is_asked_once_and_named_as_it_says_itself():
    game = Play(lambda asked: Skipped("too lazy") if (asked.backend, asked.task) == ("v3", "first") else 1.0)
    results = game.run(scripted_plan(launches=3))
    assert [(one.status, one.reason) for one in of(results, "v3", "first")] == [("unsupported", "too lazy")]
    assert len([asked for asked, _ in game.log if (asked.backend, asked.task) == ("v3", "first")]) == 1
    assert exit_code(results) == 0


@pytest.mark.parametrize("status", ["crash", "unsupported"])
def test_the_end_of_the_only_contestant_is_told_too(status):
    """Nobody is left whom the task compares: it has no turns, but what happened is no secret."""

    def tell(asked):
        if (asked.backend, asked.task) != ("v1", "first"):
            return 1.0
        if status == "crash":
            raise WorkerDied("signal 11")
        return Skipped("too lazy")

    results = play(scripted_plan(backends=2), tell)
    assert statuses(results, "v1", "first") == [status]
    assert statuses(results, "v1", "second") == ["ok"] * 6
    assert exit_code(results) == (3 if status == "crash" else 0)


def test_an_end_in_a_later_launch_is_told():
    """It happens before the first sample of that launch."""

    def tell(asked):
        if (asked.backend, asked.task, asked.what, asked.life) == ("v3", "first", "warm", 2):
            raise WorkerDied("signal 11")
        return 1.0

    results = play(scripted_plan(launches=4, rounds=2), tell)
    assert statuses(results, "v3", "first") == ["ok"] * 4 + ["crash"]
    assert of(results, "v3", "first")[-1].launch == 2
    assert exit_code(results) == 3


def test_a_worker_that_cannot_load_the_model_has_no_cells():
    game = Play(lambda asked: Failed("too big") if (asked.backend, asked.what) == ("v3", "load") else 1.0)
    results = game.run(scripted_plan())
    told = [(one.task, one.status, one.reason) for one in of(results, "v3")]
    assert told == [(task, "error", "before its first sample: too big") for task in ("first", "second")]
    assert len([worker for worker in game.workers if worker.backend == "v3"]) == 1  # there is nothing left for another


def test_a_contestant_with_nothing_left_to_do_is_not_started_again():
    game = Play(lambda asked: 100.0 if asked.backend == "v3" else 1.0)
    game.run(scripted_plan(launches=4, rounds=2, hopeless_rounds=2))
    assert Counter(worker.backend for worker in game.workers) == dict.fromkeys(NAMES, 4) | {"v3": 2}


def test_a_bad_model_is_the_users_to_mend():
    with pytest.raises(InputError, match=r"x.nas:3: no"):
        play(scripted_plan(), lambda asked: Failed("x.nas:3: no", exit_code=2) if asked.what == "load" else 1.0)


def test_a_model_that_no_contestant_has_memory_for_is_refused():
    game = Play(lambda asked: Failed("v0 needs 9 GiB", exit_code=6, oom=True) if asked.what == "load" else 1.0)
    with pytest.raises(MemoryRefusedError, match="v0 needs 9 GiB"):
        game.run(scripted_plan())
    assert all(worker.is_dead for worker in game.workers)


def test_a_larger_model_that_nobody_has_memory_for_does_not_cost_the_smaller_ones():
    def tell(asked):
        return Failed("v0 needs 9 GiB", exit_code=6, oom=True) if (asked.what, asked.life) == ("load", 1) else 1.0

    results = play(scripted_plan(launches=1, models=("small", "large")), tell)
    assert {(one.model, one.status) for one in results.samples} == {("small", "ok"), ("large", "oom")}
    assert exit_code(results) == 3


def test_the_models_of_a_sweep_begin_a_launch_in_turn():
    results = play(scripted_plan(launches=4, models=("one", "two", "three")))
    begun = [(one.launch, one.model) for one in results.launches]
    assert [model for launch, model in begun if launch == 0] == ["one", "two", "three"]
    assert [model for launch, model in begun if launch == 1] == ["two", "three", "one"]
    assert [model for launch, model in begun if launch == 2] == ["three", "one", "two"]
    assert [model for launch, model in begun if launch == 3] == ["one", "two", "three"]


def test_a_reference_that_dies_leaves_the_others_without_a_ratio_but_with_times():
    def tell(asked):
        if (asked.backend, asked.task, asked.visit, asked.what) == ("v0", "first", 2, "measure"):
            raise WorkerDied("signal 11")
        return 1.0

    results = play(scripted_plan(), tell)
    assert verdicts(results) == {
        "v0": "crashed",
        "v1": "no reference",
        "v2": "no reference",
        "v3": "no reference",
        "v0 control": "no reference",
    }
    assert all(row.seconds == 1.0 for row in summary(results) if row.backend == "v1")
    assert verdicts(results, "second")["v1"] == "about"


def test_a_control_runs_along_as_long_as_somebody_is_compared():
    def tell(asked):
        if asked.backend not in ("v0", "v0 control") and asked.what == "measure" and asked.task == "first":
            raise WorkerDied("signal 11")
        return 1.0

    game = Play(tell)
    results = game.run(scripted_plan(launches=3))
    assert {(one.launch, one.round) for one in of(results, "v0 control", "first")} == {(0, 0)}
    assert len(of(results, "v0 control", "second")) == 9
    opened = {asked.backend: request for asked, request in game.log if asked.what == "open"}
    assert opened["v0 control"].contestant == opened["v0"].contestant == "contestant 0"


def test_a_reference_alone_is_measured():
    results = play(scripted_plan(backends=1, has_control=False))
    assert statuses(results, "v0") == ["ok"] * 12


# ---------------------------------------------------------------------- the thesis


def thesis_plan(**more):
    plan = scripted_plan(launches=1, rounds=1, hopeless_rounds=1, has_control=False, tasks=("first", "second", "third"))
    return dataclasses.replace(plan, profile="thesis", **more)


@pytest.mark.parametrize(
    ("end", "reason"), [("crash", "worker was lost in second"), ("error", "worker failed in second")]
)
def test_a_net_that_all_scenarios_share_is_lost_with_its_worker(end, reason):
    def tell(asked):
        if (asked.backend, asked.task, asked.what) == ("v3", "second", "measure"):
            if end == "crash":
                raise WorkerDied("signal 11")
            return Failed("ValueError")
        return 1.0

    game = Play(tell)
    results = game.run(thesis_plan())
    assert [(one.task, one.status) for one in of(results, "v3")] == [
        ("first", "ok"),
        ("second", end),
        ("third", "skipped"),
    ]
    assert of(results, "v3")[2].reason == reason
    assert len(game.workers) == 4
    assert statuses(results, "v2") == ["ok"] * 3


def test_the_thesis_takes_no_other_sample_of_the_net_that_changes():
    """No calibration, no repeats; and the workers are told."""
    game = Play(lambda asked: 0.001)
    results = game.run(thesis_plan())
    assert len(game.asked("measure")) == len(results.samples) == 12
    assert {one.repeats for one in results.samples} == {1}
    assert all(request.chained for asked, request in game.log if asked.what == "open")


def test_what_a_contestant_cannot_leaves_its_net_as_it_is():
    results = play(
        thesis_plan(),
        lambda asked: Skipped("lazy") if (asked.backend, asked.task, asked.what) == ("v3", "first", "measure") else 1.0,
    )
    assert statuses(results, "v3") == ["unsupported", "ok", "ok"]


# ---------------------------------------------------------------------- when to stop


def test_a_cell_whose_interval_is_narrow_ends_early_and_the_others_go_on():
    noise = iter(range(10**6))

    def tell(asked):
        return 1.0 + 0.2 * (next(noise) % 7) / 7 if asked.backend == "v1" else 1.3 if asked.backend == "v2" else 1.0

    results = play(scripted_plan(backends=3, launches=12, rounds=2, narrow=0.03, tasks=("first",)), tell)
    launches = {name: max(one.launch for one in of(results, name)) + 1 for name in NAMES if of(results, name)}
    assert launches["v2"] == 7  # an interval for two contestants needs so many
    assert launches["v1"] == launches["v0"] == launches["v0 control"] == 12
    assert results.ended == ""


def test_a_run_whose_cells_are_all_narrow_is_complete():
    clock_stops_at = 1 + 6 * 3 * 2 + 3.0
    results = play(
        scripted_plan(backends=2, launches=12, rounds=2, narrow=0.03, tasks=("first",), budget_s=clock_stops_at),
        lambda asked: 1.0 if asked.what == "measure" else 0.0,
    )
    assert results.ended == ""  # there was no time left, but nothing left to do either
    assert {one.launch for one in results.samples} == set(range(6))


def test_no_launch_begins_that_would_end_beyond_the_budget():
    """4 of 30 s fit into 130 s; calibration is 2 s more."""
    plan = scripted_plan(launches=10, rounds=3, budget_s=130.0)
    results = play(plan, lambda asked: 1.0 if asked.what == "measure" else 0.0)
    assert {one.launch for one in results.samples} == {0, 1, 2, 3}
    assert len(results.samples) == 4 * 30  # whole launches
    assert results.ended == "budget"
    assert results.elapsed_s == 122.0
    assert exit_code(results) == 0


def test_the_first_launch_is_always_made():
    results = play(scripted_plan(launches=3, budget_s=0.5), lambda asked: 1.0)
    assert {one.launch for one in results.samples} == {0}
    assert results.ended == "budget"


def test_an_interrupt_keeps_what_there_is():
    def tell(asked):
        if (asked.backend, asked.task, asked.life, asked.visit) == ("v3", "second", 1, 4):
            raise KeyboardInterrupt
        return 1.0

    game = Play(tell)
    results = game.run(scripted_plan(launches=3))
    assert results.ended == "interrupted"
    assert exit_code(results) == 130
    assert {one.launch for one in results.samples} == {0, 1}
    assert len([one for one in results.samples if one.task == "first"]) == 30
    assert len(results.launches) == 1
    assert all(worker.is_dead for worker in game.workers)


def test_an_interrupt_while_workers_are_made_ready():
    def tell(asked):
        if (asked.backend, asked.what) == ("v2", "warm"):
            raise KeyboardInterrupt
        return 1.0

    game = Play(tell)
    results = game.run(scripted_plan())
    assert (results.ended, results.samples) == ("interrupted", [])
    assert all(worker.is_dead for worker in game.workers)


# ---------------------------------------------------------------------- groups


@pytest.fixture
def short_of_memory(monkeypatch):
    """Two contestants and the reference with its control fit at once."""
    monkeypatch.setattr("tetrabench.bench.benchmark.available_bytes", lambda: 6e9)
    monkeypatch.setattr("tetrabench.bench.groups.BARE_BYTES", 1e9)


@pytest.mark.usefixtures("short_of_memory")
def test_groups_where_not_all_fit_each_with_the_reference_and_its_control():
    game = Play()
    results = game.run(scripted_plan(backends=6, launches=2, rounds=2))
    groups = {(one.group, one.backend) for one in results.samples}
    assert groups == {
        *((0, name) for name in ("v0", "v1", "v2", "v0 control")),
        *((1, name) for name in ("v0", "v3", "v4", "v0 control")),
        *((2, name) for name in ("v0", "v5", "v0 control")),
    }
    assert [(one.launch, one.group) for one in results.launches] == [(k, group) for k in range(2) for group in range(3)]
    assert len(of(results, "v3", "first")) == len(of(results, "v1", "first")) == 4
    assert len(of(results, "v0", "first")) == 12
    assert all(worker.is_dead for worker in game.workers)


@pytest.mark.usefixtures("short_of_memory")
def test_pairs_are_those_of_a_group():
    """The machine is three times as slow in the second group; ratios know nothing of it."""

    def tell(asked):
        slow = 3.0 if asked.backend in ("v3", "v4") or (asked.backend.startswith("v0") and asked.life % 2) else 1.0
        return slow * (2.0 if asked.backend == "v4" else 1.0)

    results = play(scripted_plan(backends=5, launches=2, rounds=2), tell)
    ratios = {row.backend: row.ratio for row in summary(results) if row.task == "first"}
    assert ratios == {"v0": None, "v1": 1.0, "v2": 1.0, "v3": 1.0, "v4": pytest.approx(2.0), "v0 control": 1.0}


# ---------------------------------------------------------------------- yardsticks, progress


def test_the_first_launches_begin_with_measuring_their_core():
    game = Play()
    results = game.run(scripted_plan(launches=5, has_yardsticks=True))
    assert [launch.yardsticks is not None for launch in results.launches] == [True] * GAUGED + [False] * (5 - GAUGED)
    gaugers = [worker for worker in game.workers if len(worker.cores) == 1 and worker.visits == 0]
    assert [worker.cores for worker in gaugers] == [[{launch.core}] for launch in results.launches[:GAUGED]]


def test_a_machine_that_cannot_be_measured_is_no_reason_to_end():
    def tell(asked):
        if asked.what == "gauge":
            raise WorkerDied("signal 4")
        return 1.0

    results = play(scripted_plan(has_yardsticks=True), tell)
    assert [launch.yardsticks for launch in results.launches] == [None, None]
    assert len(results.samples) == 60


def test_progress_counts_what_is_left():
    diary = Diary()
    plan = scripted_plan(launches=2, rounds=2, hopeless_rounds=1)
    play(plan, lambda asked: 99.0 if asked.backend == "v3" else 1.0, progress=diary)
    assert diary.plan is plan
    warming = [step for step in diary.steps if step[0] == "loading what was compiled"]
    assert [step[2:4] for step in warming] == [(done, 10) for done in range(1, 11)] + [(k, 8) for k in range(1, 9)]
    measuring = [step for step in diary.steps if step[0].startswith("launch")]
    assert measuring[0][2:] == (0, 40, None)
    assert measuring[-1][0] == "launch 2 of 2"
    assert measuring[-1][2:4] == (33, 34)  # v3 loses three turns, twice
    assert all(step[4] is not None for step in measuring[2:])


def test_remaining_time_comes_from_own_rounds_or_from_the_reference_scaled():
    plan: Plan = scripted_plan(launches=1, rounds=2, has_control=False)
    agenda = Agenda(plan)
    assert agenda.seconds_remaining() is None
    agenda.launched(5.0)
    for k in range(4):
        agenda.took(sample(f"v{k}"), 1.0 + k)
    assert agenda.total == 16
    # first: 1 + 2 + 3 + 4 once more; second: the mean of all those, twice for each
    assert agenda.seconds_remaining() == pytest.approx(10 + 8 * 2.5)
    agenda.took(sample("v0", "second"), 10.0)  # so v3 will take 40
    assert agenda.seconds_remaining() == pytest.approx(10 + 10 + 2 * (20 + 30 + 40))
    agenda.close(Cell("tiny", "second", "v3"))
    assert agenda.seconds_remaining() == pytest.approx(10 + 10 + 2 * (20 + 30))


def sample(backend, task="first"):
    return Sample(model="tiny", task=task, backend=backend, status="ok", launch=0, round=0)


def test_the_core_is_one_that_may_be_used():
    assert play(scripted_plan(launches=1)).launches[0].core in usable_cores()
