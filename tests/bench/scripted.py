"""A run whose workers are scripts: no process, no clock but theirs."""

import dataclasses
import time
from collections import defaultdict
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from tetrabench.bench import Backend, Effort, Plan, Results, Sample, Task, run_benchmark
from tetrabench.bench.benchmark import Means
from tetrabench.bench.messages import (
    Done,
    Gauge,
    Gauged,
    Load,
    Loaded,
    Measure,
    Measured,
    Open,
    Reply,
    Request,
    Warm,
    Weigh,
    Weighed,
)
from tetrabench.bench.plan import control_of
from tetrabench.bench.record import Yardsticks
from tetrabench.protocols import ModelFacts

BUILDING = {"letters": (3, 4)}


class Asked(NamedTuple):
    """What a script is asked. what: "open", "warm", "load", "measure", "weigh", "gauge"; life: how many workers its
    backend had before; visit: how many samples this worker took before."""

    backend: str
    what: str
    task: str
    life: int
    visit: int
    repeats: int


Tell = Callable[[Asked], "float | Reply"]
"""CPU seconds of one run, or of what else was asked; or the reply itself, or an exception."""


def measured(seconds: float, repeats: int = 1, **other: object) -> Measured:
    figures = {
        "repeats": repeats,
        "prepare_s": 0.0,
        "cpu_s": seconds * repeats,
        "process_cpu_s": seconds * repeats,
        "wall_s": seconds * repeats,
        "answer_s": 0.0,
        "peak_bytes": None,
        "structure": BUILDING,
        "digest": "d",
        "figures": {},
        "items": repeats,
        "unit": "letter",
        "least_bytes": None,
    }
    return Measured(**{**figures, **other})


class Stopwatch:
    """A clock that a run moves on by what its scripts say."""

    def __init__(self) -> None:
        self.now = 0.0

    def __call__(self) -> float:
        return self.now


class Script:
    """A worker that says what `tell` says."""

    def __init__(self, tell: Tell, clock: Stopwatch, backend: str, life: int, log: list[tuple[Asked, Request]]) -> None:
        self.tell, self.clock, self.backend, self.life, self.log = tell, clock, backend, life, log
        self.visits = 0
        self.is_dead = False
        self.cores: list[set[int]] = []

    def ask(self, request: Request) -> Reply:
        assert not self.is_dead, "asked after its end"
        what = type(request).__name__.lower()
        task, repeats = getattr(request, "scenario", ""), getattr(request, "repeats", 1)
        asked = Asked(self.backend, what, task, self.life, self.visits, repeats)
        self.log.append((asked, request))
        self.visits += what == "measure"
        try:
            said = self.tell(asked)
        except Exception:
            self.is_dead = True
            raise
        if not isinstance(said, int | float):
            return said
        self.clock.now += said * repeats
        match request:
            case Open():
                return Done(0.25)
            case Warm():
                return Done(0.5)
            case Load():
                return Loaded({})
            case Measure():
                return measured(said, repeats)
            case Weigh():
                return Weighed(structure=BUILDING, retained_bytes=5, peak_bytes=7)
            case Gauge():
                return Gauged(Yardsticks(copy_gb_s=8.0, triad_gb_s=10.0, latency_ns=100.0))
        raise AssertionError(request)

    def pin(self, cores: set[int]) -> None:
        self.cores.append(cores)

    def close(self) -> None:
        self.is_dead = True

    kill = close


class Diary:
    """Progress that is written down."""

    def __init__(self) -> None:
        self.steps: list[tuple] = []

    def started(self, plan: Plan) -> None:
        self.plan = plan

    def step(self, *step: object) -> None:
        self.steps.append(step)


class Play:
    """A run of scripts, and what can be looked at afterwards."""

    def __init__(self, tell: Tell = lambda asked: 0.1) -> None:
        self.clock = Stopwatch()
        self.workers: list[Script] = []
        self.log: list[tuple[Asked, Request]] = []
        self._tell = tell
        self._lives: dict[str, int] = defaultdict(int)

    def spawn(self, backend: Backend) -> Script:
        self.workers.append(Script(self._tell, self.clock, backend.name, self._lives[backend.name], self.log))
        self._lives[backend.name] += 1
        return self.workers[-1]

    @property
    def means(self) -> Means:
        return Means(self.spawn, self.spawn, self.clock)

    def run(self, plan: Plan, **more: object) -> Results:
        return run_benchmark(plan, means=self.means, **more)

    def asked(self, what: str) -> list[Asked]:
        return [asked for asked, _ in self.log if asked.what == what]


def play(plan: Plan, tell: Tell = lambda asked: 0.1, **more: object) -> Results:
    """The results of a run of scripts."""
    return Play(tell).run(plan, **more)


def scripted_plan(
    *,
    backends: int = 4,
    tasks: tuple[str, ...] = ("first", "second"),
    launches: int = 2,
    rounds: int = 3,
    hopeless_rounds: int = 3,
    narrow: float = 0.0,
    has_control: bool = True,
    models: tuple[str, ...] = ("tiny",),
    **more: object,
) -> Plan:
    """v0, the reference, v1, ..., and the control of v0, "v0 control"."""
    seats = [
        Backend(name=f"v{k}", contestant=f"contestant {k}", title=f"title {k}", against="v0") for k in range(backends)
    ]
    plan = Plan(
        family="scripted",
        models=dict.fromkeys(models, Path(__file__)),  # a file that is there
        facts=dict.fromkeys(models, ModelFacts({"letters": 3})),
        tasks=tuple(Task(name=name, scenario=name) for name in tasks),
        backends=(*seats, *([control_of(seats[0])] if has_control else [])),
        reference="v0",
        effort=Effort(launches=launches, rounds=rounds, hopeless_rounds=hopeless_rounds, narrow=narrow),
        has_memory=False,
        has_yardsticks=False,
        command="tetrabench run --model tiny",
    )
    return dataclasses.replace(plan, **more)


Place = tuple[str, str, str, int, int]


def places(samples: list[Sample]) -> list[Place]:
    """Where samples stand, in order: model, task, backend, launch, round."""
    return sorted((one.model, one.task, one.backend, one.launch, one.round) for one in samples)


def of(results: Results, backend: str, task: str | None = None) -> list[Sample]:
    """The samples of a backend, in a task or in all."""
    return [one for one in results.samples if one.backend == backend and task in (None, one.task)]


PATIENCE_S = 60.0
"""Longer than whatever a test waits for takes."""


def wait_until(is_so: Callable[[], bool]) -> None:
    """Go on once that is so."""
    end = time.monotonic() + PATIENCE_S
    while not is_so():
        assert time.monotonic() < end, "it never came to that"
        time.sleep(0.005)
