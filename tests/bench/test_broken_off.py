"""Real runs that are interrupted, killed, out of budget, out of disk: `--resume` goes on, and loses and doubles nothing."""

import os
import resource
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from itertools import product
from pathlib import Path

import pytest

from tests.bench.scripted import PATIENCE_S, places, wait_until
from tetrabench.bench import read_results
from tetrabench.bench.journal import journal_path, read_journal

pytestmark = [
    pytest.mark.usefixtures("plugin"),
    pytest.mark.skipif(sys.platform != "linux", reason="looks for processes in /proc"),
]

PLAN = "--family scripted --model tiny --scenario first,second --backend steady,other --launches 3 --rounds 2"
SAMPLES = sorted(
    ("tiny", *place)
    for place in product(["first", "second"], ["steady", "other", "steady control"], range(3), range(2))
)


@pytest.fixture
def target(tmp_path: Path) -> Path:
    return tmp_path / "out.json"


@pytest.fixture
def start(target: Path, tmp_path: Path) -> Iterator[Callable[..., subprocess.Popen]]:
    """start(word, ...): the run to `target`."""
    runs = []

    def start(*words: str, before: Callable[[], None] = lambda: None) -> subprocess.Popen:
        def begin() -> None:
            # a shell lets what it runs in the background ignore Ctrl-C, and so would all that this test starts
            signal.signal(signal.SIGINT, signal.SIG_DFL)
            before()

        command = [sys.executable, "-m", "tetrabench", "run", *PLAN.split(), "-o", str(target), *words]
        environment = {**os.environ, "SCRIPTED_PACE_S": "0.03", "SCRIPTED_RUN": str(tmp_path)}
        pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
        runs.append(subprocess.Popen(command, env=environment, preexec_fn=begin, **pipes))
        return runs[-1]

    yield start
    for run in runs:
        run.kill()
    for process in processes_of(tmp_path):  # workers, where a test has failed
        os.kill(process, signal.SIGKILL)
    for run in runs:
        run.communicate()


def sampled(target: Path) -> int:
    """Samples in the journal."""
    path = journal_path(target)
    return path.read_bytes().count(b'{"sample":') if path.exists() else 0


def complaint(run: subprocess.Popen) -> str:
    """The last line that a run says, where it may say nothing of a crash."""
    _, said = run.communicate(timeout=PATIENCE_S)
    assert "Traceback" not in said
    return said.splitlines()[-1]


def processes_of(folder: Path) -> list[int]:
    """Those that belong to the runs of a test."""
    mine = f"SCRIPTED_RUN={folder}".encode()

    def belongs(process: Path) -> bool:
        try:
            return mine in (process / "environ").read_bytes().split(b"\0")
        except OSError:
            return False

    return [int(process.name) for process in Path("/proc").iterdir() if process.name.isdigit() and belongs(process)]


def test_interrupted_killed_and_out_of_budget_it_comes_to_its_end(target: Path, tmp_path: Path, start):
    # a second run to the same file, and Ctrl-C
    first = start()
    wait_until(lambda: sampled(target) >= 4)
    first.send_signal(signal.SIGSTOP)
    second = start()
    assert complaint(second) == f"tetrabench: {target}: another run is writing there; give this one another file"
    assert second.returncode == 2
    first.send_signal(signal.SIGCONT)
    first.send_signal(signal.SIGINT)
    assert "--resume" in complaint(first)
    assert first.returncode == 130
    interrupted = read_results(target)
    assert interrupted.ended == "interrupted"
    assert 4 <= len(interrupted.samples) < len(SAMPLES)
    wait_until(lambda: not processes_of(tmp_path))

    # the journal is in the way of another
    kept = journal_path(target).read_bytes()
    another = start()
    assert "go on with it by --resume, or remove that file" in complaint(another)
    assert another.returncode == 2
    assert journal_path(target).read_bytes() == kept

    # killed
    killed = start("--resume")
    wanted = len(interrupted.samples) + 5
    wait_until(lambda: sampled(target) >= wanted)
    killed.kill()
    killed.communicate()
    wait_until(lambda: not processes_of(tmp_path))  # its workers have noticed
    left, _ = read_journal(journal_path(target))
    assert wanted <= len(left.samples) < len(SAMPLES)
    assert places(left.samples[: len(interrupted.samples)]) == places(interrupted.samples)

    # another plan
    other = start("--resume", "--seed", "3")
    assert "cannot go on with this run: another seed" in complaint(other)
    assert other.returncode == 2

    # with a budget for next to nothing, and with none
    short = start("--resume", "--budget", "0.1s")
    assert "out of budget" in complaint(short)
    assert short.returncode == 0
    assert read_results(target).ended == "budget"
    last = start("--resume")
    complaint(last)
    assert last.returncode == 0
    results = read_results(target)
    assert results.ended == ""
    assert places(results.samples) == SAMPLES
    assert results.samples[: len(left.samples)] == left.samples
    assert [one.backend for one in results.memory] == ["steady", "other"]
    assert sorted(path.name for path in tmp_path.iterdir() if path.is_file()) == ["out.json"]


def test_a_full_disk_is_one_line(target: Path, start):
    def fill() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (6000, 6000))

    full = start(before=fill)
    said = complaint(full)
    assert said.startswith(f"tetrabench: {journal_path(target)}: cannot write: File too large")
    assert said.endswith("what was written before stays; with room for more, --resume goes on")
    assert full.returncode == 2
    left, size = read_journal(journal_path(target))
    assert 0 < len(left.samples) < len(SAMPLES)
    assert size <= 6000
    assert not target.exists()


def test_an_interrupt_while_structures_are_weighed(target: Path, tmp_path: Path, start):
    """One of them would take for ever."""
    run = start("--backend", "steady,endless-building")
    wait_until(lambda: (tmp_path / "scripted" / "building").exists())
    run.send_signal(signal.SIGINT)
    complaint(run)
    assert run.returncode == 130
    wait_until(lambda: not processes_of(tmp_path))
