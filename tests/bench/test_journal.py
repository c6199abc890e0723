"""The journal: runs that are broken off and resumed, full disks, foreign files, two runs at once. Workers are scripts."""

import dataclasses
import errno
import json
import random
from datetime import datetime
from pathlib import Path

import msgspec
import pytest
from filelock import FileLock
from hypothesis import given
from hypothesis import strategies as st

from tests.bench.scripted import Asked, Play, measured, places, scripted_plan
from tetrabench.bench import Backend, Sample, Task, exit_code, read_results
from tetrabench.bench import journal as journal_module
from tetrabench.bench.journal import Journal, journal_path, read_journal
from tetrabench.bench.messages import Failed, Skipped
from tetrabench.bench.record import SCHEMA, Launch, Memory, Yardsticks
from tetrabench.bench.soundness import LARGEST, LONGEST
from tetrabench.bench.spawn import WorkerDied
from tetrabench.errors import InputError


@pytest.fixture
def target(tmp_path: Path) -> Path:
    return tmp_path / "out.json"


def stop_at(number: int, tell=lambda asked: 1.0):
    """Ctrl-C at the `number`-th sample."""
    seen = 0

    def told(asked: Asked):
        nonlocal seen
        if asked.what == "measure":
            seen += 1
            if seen == number:
                raise KeyboardInterrupt
        return tell(asked)

    return told


def interrupted(target: Path, plan=None, number=20):
    """A run to `target` that was interrupted, and its plan."""
    plan = plan or scripted_plan()
    results = Play(stop_at(number)).run(plan, output=target)
    assert results.ended == "interrupted"
    return results, plan


# ---------------------------------------------------------------------- what is written when


def test_a_sample_is_on_disk_before_the_next_begins(target: Path):
    lines = []

    def tell(asked: Asked):
        if asked.what == "measure":
            lines.append(journal_path(target).read_text().count('"sample":'))
        return 1.0

    Play(tell).run(scripted_plan(launches=1, rounds=1), output=target)
    assert lines == [0, 0, 1, 2, 3, 4, 5, 5, 6, 7, 8, 9]  # each task begins with a calibration


def test_results_take_the_place_of_the_journal(target: Path):
    results = Play().run(scripted_plan(), output=target)
    assert read_results(target) == results
    assert [path.name for path in target.parent.iterdir()] == ["out.json"]


def test_an_interrupted_run_leaves_results_and_journal(target: Path):
    results, plan = interrupted(target)
    assert read_results(target) == results
    assert sorted(path.name for path in target.parent.iterdir()) == ["out.json", "out.jsonl"]
    kept = journal_path(target).read_bytes()
    with pytest.raises(InputError, match=r"out\.jsonl: a run that was broken off; go on with it by --resume, or"):
        Play().run(plan, output=target)
    assert journal_path(target).read_bytes() == kept


def test_without_a_file_nothing_is_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.chdir(tmp_path)
    Play().run(scripted_plan())
    assert not list(tmp_path.iterdir())


def test_a_run_that_ends_before_its_first_figure_leaves_nothing(target: Path):
    with pytest.raises(InputError, match="no such mesh"):
        Play(lambda asked: Failed("no such mesh", exit_code=2)).run(scripted_plan(), output=target)
    assert not list(target.parent.iterdir())


# ---------------------------------------------------------------------- resume


def test_resume_goes_on_where_it_was_broken_off(target: Path):
    uncut = Play().run(scripted_plan())
    before, plan = interrupted(target)
    game = Play()
    results = game.run(plan, output=target, resume=True)
    assert results.ended == ""
    assert places(results.samples) == places(uncut.samples)
    assert results.samples[: len(before.samples)] == before.samples
    taken = len([asked for asked in game.asked("measure") if asked.repeats == 1 and asked.task])
    assert taken == len(results.samples) - len(before.samples)  # and no calibration again
    assert [(one.launch, one.group) for one in results.launches] == [(0, 0), (1, 0)]
    assert results.started == before.started
    assert not journal_path(target).exists()


def test_out_of_budget_and_then_resumed(target: Path):
    plan = scripted_plan(launches=6, budget_s=70.0)
    seconds = {"measure": 1.0}
    ends = []
    for resume in (False, True, True):
        game = Play(lambda asked: seconds.get(asked.what, 0.0))
        results = game.run(plan, output=target, resume=resume)
        ends.append((results.ended, len(results.launches)))
        assert exit_code(results) == 0
    assert ends == [("budget", 2), ("budget", 4), ("", 6)]
    assert places(results.samples) == places(Play().run(dataclasses.replace(plan, budget_s=None)).samples)


def test_an_end_is_told_once(target: Path):
    def tell(asked: Asked):
        if asked.backend == "v2" and asked.task == "first" and asked.what == "measure":
            raise WorkerDied("signal 11")
        return 1.0

    plan = scripted_plan()
    Play(stop_at(14, tell)).run(plan, output=target)
    results = Play(tell).run(plan, output=target, resume=True)
    assert [one.status for one in results.samples if (one.backend, one.task) == ("v2", "first")] == ["crash"]


def test_a_group_that_had_not_begun_is_not_lost(target: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("tetrabench.bench.benchmark.available_bytes", lambda: 6e9)
    monkeypatch.setattr("tetrabench.bench.groups.BARE_BYTES", 1e9)
    plan = scripted_plan(backends=6, launches=2, rounds=2)
    uncut = Play().run(plan)
    assert max(one.group for one in uncut.samples) == 2
    interrupted(target, plan, number=19)  # the first of the second group
    results = Play().run(plan, output=target, resume=True)
    assert places(results.samples) == places(uncut.samples)


def test_a_thesis_goes_on_from_a_whole_launch_only(target: Path):
    """What a scenario finds on the one net is what those before it left; that net has gone with its worker."""
    plan = scripted_plan(launches=1, rounds=1, models=("small", "large"), tasks=("first", "second", "third"))
    plan = dataclasses.replace(plan, profile="thesis")

    def tell(asked: Asked):
        return measured(1.0, digest=f"after {asked.visit}") if asked.what == "measure" else 0.0

    uncut = Play(tell).run(plan)
    Play(stop_at(15 + 8, tell)).run(plan, output=target)
    results = Play(tell).run(plan, output=target, resume=True)
    assert places(results.samples) == places(uncut.samples)
    assert {one.status for one in results.samples} == {"ok"}
    assert not journal_path(target).exists()


STORIES = {
    "plain": (scripted_plan(backends=3, launches=2, rounds=2), lambda asked: 1.0),
    "hopeless, a crash, one that cannot": (
        scripted_plan(backends=5, launches=4, rounds=2),
        lambda asked: (
            100.0
            if asked.backend == "v1"
            else Failed("no")
            if (asked.backend, asked.task, asked.what) == ("v2", "first", "measure")
            else Skipped("cannot")
            if (asked.backend, asked.task) == ("v3", "second")
            else 1.0
        ),
    ),
    "narrow": (
        scripted_plan(backends=3, launches=10, rounds=2, narrow=0.03, tasks=("first",)),
        lambda asked: 1.0 if asked.backend != "v2" else random.Random(f"{asked}").uniform(1.0, 1.3),
    ),
    "memory, yardsticks, two models": (
        scripted_plan(backends=2, launches=2, rounds=1, models=("a", "b"), has_memory=True, has_yardsticks=True),
        lambda asked: 0.005,
    ),
    "nobody left": (
        scripted_plan(backends=2, launches=3, rounds=2),
        lambda asked: Failed("no") if (asked.backend, asked.what) == ("v1", "measure") else 1.0,
    ),
    "reference alone": (scripted_plan(backends=1, launches=2, rounds=2, has_control=False), lambda asked: 1.0),
}


@pytest.mark.parametrize("story", STORIES)
@given(data=st.data())
def test_a_run_cut_anywhere_and_resumed_has_the_samples_of_an_uncut_one(
    story: str, data: st.DataObject, tmp_path_factory: pytest.TempPathFactory
):
    """Cut after any byte of the journal, resumed, and cut again."""
    plan, tell = STORIES[story]
    target = tmp_path_factory.mktemp("cut") / "out.json"
    uncut = Play(tell).run(plan)
    number = data.draw(st.integers(1, 2 * len(uncut.samples)), label="interrupted at sample")
    Play(stop_at(number, tell)).run(plan, output=target)
    for _ in range(2):
        if not journal_path(target).exists():
            break
        written = journal_path(target).read_bytes()
        first = written.index(b"\n") + 1
        share = data.draw(st.integers(0, 1000), label="thousandths left")  # its length is not always the same
        journal_path(target).write_bytes(written[: first + share * (len(written) - first) // 1000])
        kept = read_journal(journal_path(target))[0].samples
        number = data.draw(st.integers(1, 2 * len(uncut.samples)), label="interrupted at sample")
        results = Play(stop_at(number, tell)).run(plan, output=target, resume=True)
        assert places(results.samples[: len(kept)]) == places(kept)
    if journal_path(target).exists():
        results = Play(tell).run(plan, output=target, resume=True)
        assert places(results.samples) == places(uncut.samples)
        told = {(one.task, one.backend, one.status) for one in results.samples}
        assert told == {(one.task, one.backend, one.status) for one in uncut.samples}
        assert [(one.model, one.backend) for one in results.memory] == [
            (one.model, one.backend) for one in uncut.memory
        ]


@pytest.mark.parametrize("story", STORIES)
def test_a_run_interrupted_here_and_there_has_the_samples_of_an_uncut_one(story: str, tmp_path: Path):
    plan, tell = STORIES[story]
    uncut = Play(tell).run(plan)
    for number in range(1, len(uncut.samples) + 1, 7):
        target = tmp_path / f"{number}.json"
        if Play(stop_at(number, tell)).run(plan, output=target).ended:
            results = Play(tell).run(plan, output=target, resume=True)
            assert places(results.samples) == places(uncut.samples)
            made = [(one.model, one.launch, one.group) for one in results.launches]
            assert sorted(set(made)) == sorted(made)  # none of them twice


def test_cells_close_by_whole_launches(target: Path):
    """Nine launches, of which one is odd, make an interval that is narrow. The first round of the ninth is none yet."""
    plan = scripted_plan(backends=2, tasks=("first",), launches=12, rounds=2, narrow=0.03)

    def tell(asked: Asked):
        return 1.5 if (asked.backend, asked.life) == ("v1", 2) else 1.0

    uncut = Play(tell).run(plan)
    assert max(one.launch for one in uncut.samples) == 8
    Play(stop_at(1 + 8 * 6 + 4, tell)).run(plan, output=target)
    assert [one.round for one in read_results(target).samples if one.launch == 8] == [0] * 3
    results = Play(tell).run(plan, output=target, resume=True)
    assert places(results.samples) == places(uncut.samples)


# ---------------------------------------------------------------------- round trip

NAMES = st.text(st.characters(codec="utf-8"), max_size=6)
FIGURES = st.floats(-1e300, 1e300)
TIMES = st.floats(0, LONGEST)
BYTES = st.integers(0, LARGEST)
BACKENDS = st.sampled_from(["v0", "v1"])
PARTS = st.one_of(
    st.builds(
        Sample,
        model=st.just("tiny"),
        task=st.sampled_from(["first", "second"]),
        backend=BACKENDS,
        status=st.sampled_from(["ok", "crash", "oom"]),
        launch=st.integers(0, 99),
        round=st.integers(0, 99),
        cpu_s=st.none() | TIMES,
        wall_s=st.none() | TIMES,
        digest=NAMES,
        figures=st.dictionaries(NAMES, st.none() | FIGURES, max_size=3),
        peak_bytes=st.none() | BYTES,
        reason=NAMES,
    ),
    st.builds(
        Launch,
        model=st.just("tiny"),
        launch=st.integers(0, 99),
        core=st.integers(0, 99),
        begun=st.just("") | st.datetimes().map(datetime.isoformat),
        yardsticks=st.none() | st.builds(Yardsticks, copy_gb_s=TIMES, triad_gb_s=TIMES, latency_ns=TIMES),
        seconds=st.dictionaries(NAMES, TIMES, max_size=3),
    ),
    st.builds(
        Memory,
        model=st.just("tiny"),
        backend=BACKENDS,
        structure=st.dictionaries(NAMES, st.tuples(BYTES, BYTES), max_size=3),
        retained_bytes=st.none() | st.integers(-LARGEST, LARGEST),
    ),
    st.builds(Backend, name=BACKENDS, contestant=NAMES, title=NAMES, against=st.just("v0"), compile_s=TIMES),
)


def blank():
    """A run of which nothing is known yet."""
    plan = scripted_plan(backends=2, has_control=False)
    run = Play(stop_at(1)).run(plan)
    return msgspec.structs.replace(run, samples=[], launches=[], memory=[], ended="", elapsed_s=0.0)


BLANK = blank()


@given(parts=st.lists(PARTS, max_size=12))
def test_what_a_journal_holds_is_what_was_written(parts: list, tmp_path_factory: pytest.TempPathFactory):
    path = tmp_path_factory.mktemp("journal") / "out.jsonl"
    run = msgspec.json.decode(msgspec.json.encode(BLANK), type=type(BLANK))
    with path.open("wb") as file:
        journal = Journal(run, file)
        journal.begin()
        for part in parts:
            journal.write(part)
    found, size = read_journal(path)
    assert found == journal.run
    assert size == path.stat().st_size


# ---------------------------------------------------------------------- refusals


def test_nothing_to_resume(target: Path):
    with pytest.raises(InputError, match=r"out\.jsonl: nothing to resume: No such file"):
        Play().run(scripted_plan(), output=target, resume=True)


@pytest.mark.parametrize("text", ["", '{"run": {', "\0" * 100])
def test_a_journal_without_a_whole_line(target: Path, text: str):
    journal_path(target).write_text(text)
    with pytest.raises(InputError, match="nothing to resume: no line is whole"):
        Play().run(scripted_plan(), output=target, resume=True)
    assert journal_path(target).read_text() == text


@pytest.mark.parametrize(
    "text", ["hello\n", "[1]\n", '{"a": 1}\n', '{"run": 5}\n', '{"run": {"schema": "x"\n', "\0\xff\n", "\n\n"]
)
def test_a_foreign_journal_is_refused_and_left_alone(target: Path, text: str):
    journal_path(target).write_text(text)
    with pytest.raises(InputError, match=r"out\.jsonl:?1?: (no journal of tetrabench|nothing to resume)"):
        Play().run(scripted_plan(), output=target, resume=True)
    assert journal_path(target).read_text() == text


def test_a_line_in_the_middle_that_is_damaged_is_named(target: Path):
    _, plan = interrupted(target)
    lines = journal_path(target).read_bytes().splitlines(keepends=True)
    journal_path(target).write_bytes(b"".join([*lines[:5], b'{"sample": {"mod\n', *lines[5:]]))
    with pytest.raises(InputError, match=r"out\.jsonl:6: no journal of tetrabench"):
        Play().run(plan, output=target, resume=True)


@pytest.mark.parametrize("more", [{}, {"samples": "not a list in that version"}])
def test_a_journal_of_another_version_is_refused(target: Path, more: dict):
    _, plan = interrupted(target)
    first, *rest = journal_path(target).read_text().splitlines(keepends=True)
    facts = json.loads(first)
    facts["run"] |= {"schema": "tetrabench-results/99", **more}
    journal_path(target).write_text("".join([json.dumps(facts) + "\n", *rest]))
    with pytest.raises(InputError, match=f"schema tetrabench-results/99, this version goes on with {SCHEMA}"):
        Play().run(plan, output=target, resume=True)


def other_model(plan, target):
    file = target.with_name("other.mesh")
    file.write_text("other")
    return {"models": {"tiny": file}}


CHANGES = {
    "seed": lambda plan, target: {"seed": 7},
    "effort": lambda plan, target: {"effort": msgspec.structs.replace(plan.effort, rounds=9)},
    "tasks": lambda plan, target: {"tasks": (Task(name="first", scenario="first", options={"count": 3}),)},
    "model": other_model,
    "backends": lambda plan, target: {"backends": plan.backends[:-1]},
    "profile": lambda plan, target: {"profile": "rigorous"},
    "family": lambda plan, target: {"family": "polygon"},
}


def test_other_options_of_a_contestant_are_refused(target: Path):
    """In no name are those that are not swept."""
    _, plan = interrupted(target)
    backends = tuple(msgspec.structs.replace(one, options={"capacity": 9}) for one in plan.backends)
    with pytest.raises(InputError, match="cannot go on with this run: another backends; give another file"):
        Play().run(dataclasses.replace(plan, backends=backends), output=target, resume=True)


@pytest.mark.parametrize("what", CHANGES)
def test_another_plan_is_refused_by_what_differs(target: Path, what: str):
    _, plan = interrupted(target)
    kept = journal_path(target).read_bytes()
    other = dataclasses.replace(plan, **CHANGES[what](plan, target))
    with pytest.raises(InputError, match=f"cannot go on with this run: another {what}; give another file"):
        Play().run(other, output=target, resume=True)
    assert journal_path(target).read_bytes() == kept
    assert Play().run(plan, output=target, resume=True).ended == ""


def test_another_environment_is_refused(target: Path, monkeypatch: pytest.MonkeyPatch):
    _, plan = interrupted(target)
    facts = {"processor": "another", "load_1_minute": 99.0}
    describe = "tetrabench.bench.benchmark.describe_environment"
    true = __import__("tetrabench.bench.environment", fromlist=["x"]).describe_environment()
    monkeypatch.setattr(describe, lambda: {**true, **facts})
    with pytest.raises(InputError, match="another processor; give another file"):
        Play().run(plan, output=target, resume=True)
    monkeypatch.setattr(describe, lambda: {**true, "load_1_minute": 99.0})
    assert Play().run(plan, output=target, resume=True).ended == ""


def test_two_runs_to_one_file(target: Path):
    """The second one is refused, whether it begins or resumes, and the first one does not notice."""
    refusals = []

    def tell(asked: Asked):
        if asked.what == "measure" and len(refusals) < 2:
            with pytest.raises(InputError) as refusal:
                Play().run(scripted_plan(), output=target, resume=bool(refusals))
            refusals.append(str(refusal.value))
        return 1.0

    results = Play(tell).run(scripted_plan(), output=target)
    assert refusals == [f"{target}: another run is writing there; give this one another file"] * 2
    assert read_results(target) == results
    assert [path.name for path in target.parent.iterdir()] == ["out.json"]


def test_two_results_files_with_one_journal(target: Path):
    with FileLock(target.with_name(".out.jsonl.lock")), pytest.raises(InputError, match="another run is writing"):
        Play().run(scripted_plan(), output=target.with_suffix(".txt"))


def test_results_do_not_go_where_the_journal_is(target: Path):
    with pytest.raises(InputError, match=r"out\.jsonl: .*save the results to another file"):
        Play().run(scripted_plan(), output=journal_path(target))
    assert not list(target.parent.iterdir())


# ---------------------------------------------------------------------- full disks


class FullDisk:
    """A file on a disk that has room for so many bytes more."""

    def __init__(self, file, room: int) -> None:
        self.file, self.room = file, room
        self.name = file.name

    def write(self, data: bytes) -> int:
        self.file.write(data[: self.room])
        self.room -= len(data)
        self.flush()
        return len(data)

    def flush(self) -> None:
        self.file.flush()
        self._complain()

    def close(self) -> None:
        self.file.close()
        self._complain()

    def _complain(self) -> None:
        if self.room < 0:
            raise OSError(errno.ENOSPC, "No space left on device")

    def fileno(self) -> int:
        return self.file.fileno()


@pytest.mark.parametrize("lines", [0, 1, 7, 30])
def test_a_full_disk_ends_the_run_with_one_line_and_loses_nothing(
    target: Path, monkeypatch: pytest.MonkeyPatch, lines: int
):
    plan = scripted_plan()
    uncut = Play().run(plan)
    real = Path.open
    interrupted(target, plan, number=55)
    sizes = [len(line) for line in journal_path(target).read_bytes().splitlines(keepends=True)]
    journal_path(target).unlink()
    room = sum(sizes[:lines]) + 20

    def full(path, mode="r", *more, **other):
        file = real(path, mode, *more, **other)
        return FullDisk(file, room) if mode == "xb" else file

    with monkeypatch.context() as patch:
        patch.setattr(Path, "open", full)
        game = Play()
        with pytest.raises(InputError) as refusal:
            game.run(plan, output=target)
    assert all(worker.is_dead for worker in game.workers)
    assert str(refusal.value).startswith(f"{journal_path(target)}: cannot write: No space left on device")
    if lines > 3:
        assert str(refusal.value).endswith("what was written before stays; with room for more, --resume goes on")
        results = Play().run(plan, output=target, resume=True)
        assert places(results.samples) == places(uncut.samples)
    else:
        assert not journal_path(target).exists()


def test_results_that_find_no_room_can_be_saved_later(target: Path, monkeypatch: pytest.MonkeyPatch):
    plan = scripted_plan(has_memory=True)

    def full(path, data):
        with open(path, "wb") as file:
            file.write(data[:100])
        raise OSError(errno.ENOSPC, "No space left on device")

    with monkeypatch.context() as patch:
        patch.setattr(Path, "write_bytes", full)
        with pytest.raises(InputError, match=r"out\.json: cannot be written: No space left on device"):
            Play().run(plan, output=target)
    assert [path.name for path in target.parent.iterdir()] == ["out.jsonl"]
    game = Play()
    results = game.run(plan, output=target, resume=True)
    assert game.workers == []  # all was there
    assert read_results(target) == results
    assert places(results.samples) == places(Play().run(plan).samples)


def test_what_fails_in_a_run_is_not_blamed_on_the_journal(target: Path):
    def tell(asked: Asked):
        raise OSError(errno.EAGAIN, "Resource temporarily unavailable")

    with pytest.raises(OSError, match="Resource temporarily"):
        Play(tell).run(scripted_plan(), output=target)


def test_a_folder_that_cannot_be_written_to(tmp_path: Path):
    (tmp_path / "file").touch()
    with pytest.raises(InputError, match="cannot write: "):
        Play().run(scripted_plan(), output=tmp_path / "file" / "out.json")


def test_an_interrupt_while_results_are_saved_leaves_no_half_file(target: Path, monkeypatch: pytest.MonkeyPatch):
    def pressed(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("os.replace", pressed)
    with pytest.raises(KeyboardInterrupt):
        Play().run(scripted_plan(), output=target)
    assert [path.name for path in target.parent.iterdir()] == ["out.jsonl"]


def test_a_launch_reaches_the_disk_itself(target: Path, monkeypatch: pytest.MonkeyPatch):
    synced = []
    monkeypatch.setattr(journal_module.os, "fsync", lambda number: synced.append(number))
    Play().run(scripted_plan(launches=3), output=target)
    assert len(synced) == 3
