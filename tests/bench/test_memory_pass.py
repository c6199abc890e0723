"""The memory pass: real processes for what they hold, scripts for what goes wrong. And groups that fit."""

import sys

import pytest

from tests.bench.scripted import BUILDING, Play, scripted_plan
from tetrabench.bench import Backend, exit_code
from tetrabench.bench.groups import BARE_BYTES, COPIES, SHARE, make_groups
from tetrabench.bench.memory import WEIGHING, peak_bytes, private_bytes, reset_peak
from tetrabench.bench.memory_pass import weigh
from tetrabench.bench.messages import Failed, Open, Weigh, Weighed
from tetrabench.bench.plan import control_of
from tetrabench.bench.record import Memory
from tetrabench.bench.spawn import WorkerDied, WorkerProcess
from tetrabench.errors import InputError

LINUX = pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")
MEBI = 2**20


# ---------------------------------------------------------------------- real processes


def weighed(contestant, tmp_path):
    (tmp_path / "real").write_text("abc")
    backend = Backend(name=contestant, contestant=contestant, title="", against="steady")
    return weigh(lambda: WorkerProcess(1, environment=WEIGHING), "scripted", backend, "real", tmp_path / "real")


@LINUX
@pytest.mark.usefixtures("plugin")
def test_structure_retained_and_peak(tmp_path):
    heavy = weighed("heavy", tmp_path)
    assert heavy.status == "ok"
    assert heavy.structure_bytes == 16 * MEBI
    assert heavy.structure == {"block": (16 * MEBI, 16 * MEBI + 8)}
    assert 16 * MEBI <= heavy.retained_bytes < 18 * MEBI
    assert 15 * MEBI < heavy.peak_bytes < 18 * MEBI
    assert heavy.is_accounted


@LINUX
@pytest.mark.usefixtures("plugin")
def test_what_has_gone_again_is_in_the_peak_alone(tmp_path):
    wasteful = weighed("wasteful", tmp_path)
    assert 16 * MEBI <= wasteful.retained_bytes < 18 * MEBI
    assert 63 * MEBI < wasteful.peak_bytes < 67 * MEBI


@LINUX
@pytest.mark.usefixtures("plugin")
def test_a_structure_that_claims_more_than_its_process_holds(tmp_path):
    boasting = weighed("boasting", tmp_path)
    assert boasting.structure_bytes == 16 * MEBI
    assert boasting.retained_bytes < MEBI
    assert not boasting.is_accounted


@pytest.mark.usefixtures("plugin")
@pytest.mark.parametrize(
    ("contestant", "status", "reason"),
    [
        ("crashing-building", "crash", "signal 11 (Segmentation fault)"),
        ("raising-building", "error", "build: ValueError: cannot stand (scripted_plugin.py:"),
        ("greedy-building", "oom", "not enough memory: build: MemoryError"),
    ],
)
def test_what_goes_wrong_is_named(tmp_path, contestant, status, reason):
    memory = weighed(contestant, tmp_path)
    assert memory.status == status
    assert memory.reason.startswith(reason)
    assert (memory.structure, memory.retained_bytes, memory.peak_bytes) == ({}, None, None)


@LINUX
def test_private_bytes_follow_what_is_written_and_given_back():
    before = private_bytes()
    block = bytearray(b"x") * (32 * MEBI)
    during = private_bytes()
    del block
    assert 32 * MEBI <= during - before < 34 * MEBI
    assert abs(private_bytes() - before) < 2 * MEBI


def test_a_system_that_tells_nothing(monkeypatch, tmp_path):
    monkeypatch.setattr("tetrabench.bench.memory._PROCESS", tmp_path)
    assert private_bytes() is None
    assert peak_bytes() is None
    monkeypatch.setattr("tetrabench.bench.memory._PROCESS", tmp_path / "nowhere")
    assert reset_peak() is False


# ---------------------------------------------------------------------- in a run


def weighing_plan(**more):
    return scripted_plan(launches=1, rounds=1, has_memory=True, **more)


def test_each_contestant_is_weighed_alone_and_a_control_is_not():
    game = Play()
    results = game.run(weighing_plan(models=("small", "large")))
    weighed = [(one.model, one.backend) for one in results.memory]
    assert weighed == [(model, name) for model in ("small", "large") for name in ("v0", "v1", "v2", "v3")]
    assert results.memory[0] == Memory(model="small", backend="v0", structure=BUILDING, retained_bytes=5, peak_bytes=7)
    asked = {(one.backend, one.life): [] for one in game.asked("weigh")}
    for one, request in game.log:
        asked.get((one.backend, one.life), []).append(type(request))
    assert all(requests == [Open, Weigh] for requests in asked.values())


def test_where_the_compiler_was_in_the_way_a_second_process_is_asked():
    def tell(asked):
        if (asked.backend, asked.what, asked.life) == ("v1", "weigh", 0):
            return Weighed(structure=BUILDING, retained_bytes=10**9, peak_bytes=10**9, compiled=3)
        return 0.1

    results = Play(tell).run(weighing_plan())
    assert {one.retained_bytes for one in results.memory} == {5}


@pytest.mark.parametrize(
    ("end", "status"),
    [
        (WorkerDied("signal 11"), "crash"),
        (WorkerDied("no reply within 1 s", "timeout"), "timeout"),
        (Failed("ValueError: no"), "error"),
        (Failed("too large", exit_code=6, oom=True), "oom"),
    ],
)
@pytest.mark.parametrize("what", ["open", "weigh"])
def test_a_bad_end_takes_the_figures_of_memory_alone(end, status, what):
    def tell(asked):
        if (asked.backend, asked.what, asked.life) == ("v1", what, 0):
            if isinstance(end, Exception):
                raise end
            return end
        return 0.1

    game = Play(tell)
    results = game.run(weighing_plan())
    assert {one.backend: one.status for one in results.memory} == {"v0": "ok", "v1": status, "v2": "ok", "v3": "ok"}
    assert {one.status for one in results.samples} == {"ok"}
    assert len(results.samples) == 10
    assert exit_code(results) == 3
    assert all(worker.is_dead for worker in game.workers)


def test_a_bad_model_is_the_users_to_mend():
    game = Play(lambda asked: Failed("x.nas:3: no", exit_code=2) if asked.what == "weigh" else 0.1)
    with pytest.raises(InputError, match=r"x\.nas:3: no"):
        game.run(weighing_plan())
    assert all(worker.is_dead for worker in game.workers)


def test_an_interrupt_ends_those_that_are_being_weighed():
    def tell(asked):
        if asked.what == "weigh" and asked.backend == "v1":
            raise KeyboardInterrupt
        return 0.1

    game = Play(tell)
    results = game.run(weighing_plan())
    assert results.ended == "interrupted"
    assert results.samples == []
    assert all(worker.is_dead for worker in game.workers)


# ---------------------------------------------------------------------- groups


def backends_of(*names, against="v0"):
    seats = [Backend(name=name, contestant=name, title="", against=against) for name in names]
    return [*seats, *(control_of(one) for one in seats if one.name == against)]


def memory_of(**peaks):
    return [Memory(model="m", backend=name, peak_bytes=int(peak)) for name, peak in peaks.items()]


def grouped(backends, memory, available):
    return [[one.name for one in group] for group in make_groups(backends, memory, available)]


def test_all_together_where_they_fit_or_nobody_knows():
    backends = backends_of("v0", "v1", "v2")
    everybody = [["v0", "v1", "v2", "v0 control"]]
    memory = memory_of(v0=1e9, v1=1e9, v2=1e9)
    needed = (4 * BARE_BYTES + COPIES * 4e9) / SHARE
    assert grouped(backends, memory, needed + 1) == everybody
    assert grouped(backends, memory, None) == everybody
    assert grouped(backends, memory, needed - 1) == [["v0", "v1", "v0 control"], ["v0", "v2", "v0 control"]]


def test_one_who_fits_with_nobody_is_tried_with_the_reference():
    groups = grouped(backends_of("v0", "v1", "v2"), memory_of(v1=1e12), 1e9)
    assert groups == [["v0", "v1", "v0 control"], ["v0", "v2", "v0 control"]]


def test_each_group_has_the_references_of_its_members_and_no_others():
    backends = [*backends_of("a base", against="a base"), *backends_of("b base", against="b base")]
    backends += [Backend(name=f"{name} head", contestant=name, title="", against=f"{name} base") for name in "ab"]
    assert grouped(backends, memory_of(**{}), 1.0) == [
        ["a base", "a base control", "a head"],
        ["b base", "b base control", "b head"],
    ]


def test_who_was_not_weighed_counts_by_its_structure_or_as_bare():
    backends = backends_of("v0", "v1", "v2")
    memory = [Memory(model="m", backend="v1", structure={"a": (1, 10**10)})]
    assert grouped(backends, [], 4 * BARE_BYTES / SHARE + 1) == [["v0", "v1", "v2", "v0 control"]]
    assert grouped(backends, memory, 4 * BARE_BYTES / SHARE + 1) == [
        ["v0", "v1", "v0 control"],
        ["v0", "v2", "v0 control"],
    ]


def test_references_alone_are_one_group():
    assert grouped(backends_of("v0"), [], 1.0) == [["v0", "v0 control"]]
