"""Pages made by hand for the tests: what they are of, and a browser that opens them."""

import shutil
from pathlib import Path

import msgspec
import pytest

from tests.report.made import change, make_backend, make_results, make_sweep
from tests.report.made_lines import make_contestants, make_run
from tests.report.thesis.test_thesis import run_of
from tetrabench.bench import Results

TASKS = {
    "init": {"v3": 1.1, "v3y": 1.0, "v4": 1.3, "v5y": 1.2},
    "alfa": {"v3": 1.2, "v3y": 1.0, "v4": 4.0, "v5y": 2.5},
    "free": {"v3": 0.001, "v3y": 0.001, "v4": 0.2, "v5y": 0.001},
}
HOSTILE = "<script>window.hacked=1</script>"
EVIL = '"><img src=x onerror=window.hacked=1>&lt;${1}'


def two_runs() -> list[tuple[str, Results]]:
    """Two runs with a model each; a cell of the second crashed."""
    first = make_results(TASKS, launches=8, rounds=2)
    second = make_results(TASKS, launches=8, rounds=2, model="intake", tetras=155_000)
    samples = [
        msgspec.structs.replace(one, status="crash", cpu_s=None, wall_s=None, process_cpu_s=None, reason="signal 11")
        if (one.task, one.backend) == ("alfa", "v5y")
        else one
        for one in second.samples
    ]
    return [("first", first), ("second", msgspec.structs.replace(second, samples=samples))]


def sweep() -> list[tuple[str, Results]]:
    """A run over five sizes."""
    seconds = {"alfa": {"v3y": 0.1, "v4": 0.3}}
    return [
        ("sweep", make_sweep(seconds, {"v3y": 1.0, "v4": 1.2}, [100, 300, 1000, 3000, 10_000], launches=6, rounds=1))
    ]


def hostile() -> list[tuple[str, Results]]:
    """A run whose model, task, contestant and buffers are named by somebody who means harm."""
    seconds = {HOSTILE: {"v3y": 1.0, EVIL: 2.0}, "alfa": {"v3y": 1.0, EVIL: 2.0}}
    made = make_results(seconds, model=HOSTILE, launches=8, rounds=1)
    backends = [
        make_backend(EVIL, title=f"{HOSTILE}, {EVIL}", structure={EVIL: (99, 99)}) if one.name == EVIL else one
        for one in made.backends
    ]
    samples = [msgspec.structs.replace(one, model=HOSTILE) for one in made.samples]
    memory = [msgspec.structs.replace(one, structure={EVIL: (10**8, 10**8), **one.structure}) for one in made.memory]
    changes = {"backends": backends, "samples": samples, "memory": memory, "command": HOSTILE, "titles": [EVIL]}
    return [(EVIL, msgspec.structs.replace(made, **changes))]


def thesis() -> list[tuple[str, Results]]:
    """A run of the source's own times, which can stand beside the source."""
    return [("nozzle", run_of())]


def broken() -> list[tuple[str, Results]]:
    """A run in which the reference crashed in one task, another has a sample alone, and buffers are of no size."""
    made = make_results(TASKS, launches=8, rounds=2)
    made = change(made, "init", "v3y", status="crash", cpu_s=None, wall_s=None, process_cpu_s=None, reason="signal 11")
    samples = [one for one in made.samples if one.task != "alfa"]
    samples.append(next(one for one in made.samples if (one.task, one.backend) == ("alfa", "v4")))
    none = {"tetras": (0, 0), "points": (0, 16)}
    memory = [msgspec.structs.replace(one, structure=none, retained_bytes=0, peak_bytes=0) for one in made.memory]
    backends = [msgspec.structs.replace(one, structure=none) for one in made.backends]
    changes = {"samples": samples, "memory": memory, "backends": backends, "ended": "budget"}
    return [("broken", msgspec.structs.replace(made, **changes))]


def single() -> list[tuple[str, Results]]:
    """A run of a single backend: there is nobody to compare with, and no control."""
    made = make_results({task: {"v3y": times["v3y"]} for task, times in TASKS.items()}, launches=8, rounds=2)
    alone = [sample for sample in made.samples if sample.backend == "v3y"]
    backends = [backend for backend in made.backends if not backend.control]
    return [("single", msgspec.structs.replace(made, samples=alone, backends=backends))]


def lines() -> list[tuple[str, Results]]:
    """A run over an option of a contestant and a count of a scenario, whose samples tell series; one is known to be wrong."""
    tasks = {"gravity": 1.0} | {f"concentration area={area}": 1.0 for area in (100, 1000, 10_000)}
    return [("lines", make_run(tasks, make_contestants((4, 8, 16, 32)), launches=8))]


def browser_path() -> Path:
    """Where Chromium lies; skips the test, with the reason, where there is none."""
    for name in ("chromium", "chromium-browser", "google-chrome"):
        if found := shutil.which(name):
            return Path(found)
    pytest.skip("no Chromium here; on Debian: apt install chromium")
