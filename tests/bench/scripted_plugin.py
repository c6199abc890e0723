"""A plug-in whose contestants behave as their names say, mostly in the scenario `second` on the real model. The fixture
`plugin` installs it."""

import os
import resource
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from tetrabench.errors import InputError
from tetrabench.protocols import Answer, ModelFacts, Option, Work

HERE = Path(__file__).parent
HEAVY_BYTES = 16 * 2**20


@dataclass(frozen=True)
class Contestant:
    name: str
    title: str = "scripted"
    trade_off: str = "none"
    family: str = "scripted"
    extension: bool = False
    options: Mapping[str, Option] = field(default_factory=dict)
    is_exact: bool = True


class Stage:
    def __init__(self, contestant: Contestant, model: Path, chained: bool) -> None:
        self.contestant = contestant
        self.is_small = model.name == "small"
        self.chained = chained
        self.visits = self.answers = 0
        self.block = b""

    def model_size(self) -> dict[str, int]:
        return {"letters": 3}

    def structure_bytes(self) -> dict[str, tuple[int, int]]:
        if self.block or self.contestant.name == "boasting":
            return {"block": (HEAVY_BYTES, HEAVY_BYTES + 8)}
        if self.contestant.options:
            return {"leaves": (self.contestant.options["capacity"].value, 64)}
        return {"letters": (3, 4), "words": (10, 20)}

    def build(self) -> None:
        name = self.contestant.name
        if name == "crashing-building" and not self.is_small:
            os.kill(os.getpid(), signal.SIGSEGV)
        if name == "endless-building" and not self.is_small:
            (HERE / "building").touch()
            time.sleep(600)
        if name == "raising-building" and not self.is_small:
            raise ValueError("cannot stand")
        if name == "greedy-building" and not self.is_small:
            raise MemoryError
        if name in ("heavy", "wasteful") and not self.is_small:
            scaffold = bytearray(b"x") * (3 * HEAVY_BYTES) if name == "wasteful" else b""
            self.block = bytearray(b"x") * HEAVY_BYTES
            del scaffold

    def close(self) -> None:
        self.block = b""


@dataclass(frozen=True)
class Scenario:
    name: str
    parallel: bool = False
    title: str = "scripted"
    family: str = "scripted"

    @property
    def options(self) -> dict[str, int]:
        return {"count": 2}

    @property
    def thesis(self) -> dict[str, int]:
        return {"count": 20}

    def skip(self, contestant: Contestant) -> str | None:
        return "too lazy" if contestant.name == "lazy" and self.name == "second" else None

    def prepare(self, stage: Stage, options: dict[str, int]) -> tuple[Stage, int]:
        stage.visits += 1
        return stage, options["count"]

    def run(self, subject: tuple[Stage, int]) -> int:
        stage, count = subject
        name = stage.contestant.name
        if name == "chatty":
            print("hello")
            os.write(1, b'{"type":"Done","wall_s":1}\n')
            subprocess.run(["echo", "hello from a child"], check=True)
            print(repr(sys.stdin.read()))
        if self.parallel or name == "threaded":
            helper = threading.Thread(target=spin)
            helper.start()
            helper.join()
        if self.name == "second" and name == "crashing-small" and stage.is_small:
            os.kill(os.getpid(), signal.SIGSEGV)
        if self.name == "second" and not stage.is_small:
            if name == "parenting":
                return subprocess.Popen(["sleep", "600"]).pid
            misbehave(name)
        return count

    def answer(self, subject: tuple[Stage, int], outcome: int) -> Answer:
        stage, _ = subject
        name = stage.contestant.name
        stage.answers += 1
        time.sleep(float(os.environ.get("SCRIPTED_PACE_S", 0)))  # somebody wants to see the run go on
        threads = int(os.environ["NUMBA_NUM_THREADS"])
        figures = {"count": outcome, "threads": threads, "sum": 0.5}
        figures |= {option: chosen.value for option, chosen in stage.contestant.options.items()}
        if self.name == "second" and name in ("wrong", "careless"):
            return Answer("bad0", {"count": 41, "threads": threads, "sum": float("nan")})
        if self.name == "second" and name == "unstable" and not stage.is_small and stage.answers % 2:
            return Answer("bad1", figures)
        if self.name == "second" and name == "verbose":
            figures |= {f"figure {k}": float(k) for k in range(200_000)}
        if self.name == "second" and name == "mumbling" and not stage.is_small:
            return Answer(object(), figures)
        visits = stage.visits if stage.chained else 0
        series = SERIES.get(name, {}) if self.name == "second" and not stage.is_small else {}
        return Answer(f"{outcome}{visits}", figures, series)

    def work(self, subject: tuple[Stage, int], outcome: int) -> Work:
        return Work(outcome, "letters")


SERIES = {
    "tuned": {"step": [10, 20], "step_s": (0.5, 0.25)},
    "ragged": {"step": [10, 20], "step_s": [0.5]},
    "boundless": {"step": [10, 20], "step_s": [float("inf"), 0.5]},
}
"""By contestant."""


def spin() -> None:
    """Keep a core busy for 30 ms of its time."""
    while time.thread_time() < 0.03:
        pass


def misbehave(name: str) -> None:
    match name:
        case "crashing":
            os.kill(os.getpid(), signal.SIGSEGV)
        case "killed":
            os.kill(os.getpid(), signal.SIGKILL)
        case "raising":
            raise ValueError("I would rather not\nsecond line")
        case "leaving":
            sys.exit(4)
        case "gone":
            os._exit(4)
        case "interrupting":
            raise KeyboardInterrupt
        case "recursive":
            misbehave(name)
        case "hanging":
            time.sleep(600)
        case "greedy":
            limit, _ = resource.getrlimit(resource.RLIMIT_AS)
            if limit != resource.RLIM_INFINITY:
                bytearray(limit)  # more than is left of it
        case "closing":
            if not sys.stdout.closed:
                sys.stdout.close()
                os.close(1)
        case "deaf":
            os.closerange(3, 100)
            time.sleep(600)
        case "orphaning":  # dies, and leaves a child behind that holds its pipes
            if os.fork() == 0:
                time.sleep(600)
            os.kill(os.getpid(), signal.SIGSEGV)


class Family:
    name = "scripted"
    reference = "steady"
    default_model = "tiny"
    size_option = "tets"
    thesis_order = ("third", "first", "second")
    models = {"tiny": "three letters"}
    kind = None
    tour = None
    rules = ()

    def add_model(self, model: object) -> None:
        raise InputError("three letters are enough")

    def drop_model(self, name: str) -> None:
        raise KeyError(name)

    def find_model(self, model: str, *, size: int | None, numbering: str, seed: int) -> Path:
        if model == "missing":
            raise InputError(f"{model}: no such file")
        if model == "dying":
            os.kill(os.getpid(), signal.SIGSEGV)
        path = HERE / (f"model-{size}" if size else "model")
        path.write_text("abc")
        return path

    def needs(self, model: object) -> None:
        return None

    def describe_model(self, path: Path) -> ModelFacts:
        return ModelFacts({"letters": 3}, ("one letter is a digit",))

    def small_model(self) -> Path:
        return HERE / "small"

    def stage(self, contestant: Contestant, model: Path, *, chained: bool) -> Stage:
        return Stage(contestant, model, chained)


FAMILY = Family()
NAMES = (
    "steady other third chatty lazy wrong raising crashing crashing-small leaving gone killed interrupting recursive"
    " hanging greedy closing deaf orphaning parenting unstable verbose mumbling threaded"
    " heavy wasteful boasting crashing-building endless-building raising-building greedy-building ragged boundless"
)
OPTIONS = {
    "capacity": Option(8, 1, 63, "letters that a leaf holds"),
    "recycle": Option(1, 0, 1, "whether empty leaves are used again"),
}
CONTESTANTS = [
    *(Contestant(name) for name in NAMES.split()),
    Contestant("tuned", options=OPTIONS),
    Contestant("careless", is_exact=False),
]
SCENARIOS = [Scenario("first"), Scenario("second"), Scenario("third"), Scenario("many", parallel=True)]
