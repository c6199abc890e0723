"""A plug-in whose contestants behave as their names say. The fixture `plugin` installs it."""

import os
import signal
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

from tetrabench.protocols import Answer, Work

HERE = Path(__file__).parent


@dataclass(frozen=True)
class Contestant:
    name: str
    title: str = "scripted"
    trade_off: str = "none"
    family: str = "scripted"
    extension: bool = False


class Stage:
    def __init__(self, contestant: Contestant, model: Path, chained: bool) -> None:
        self.contestant = contestant
        self.is_small = model.name == "small"
        self.chained = chained
        self.visits = 0

    def model_size(self) -> dict[str, int]:
        return {"letters": 3}

    def structure_bytes(self) -> dict[str, tuple[int, int]]:
        return {"letters": (3, 4), "words": (10, 20)}

    def close(self) -> None:
        pass


@dataclass(frozen=True)
class Scenario:
    name: str
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
            subprocess.run([sys.executable, "-c", "print('hello from a child', input)"], check=True)
            print(repr(sys.stdin.read()))
        if self.name == "second":
            if name == "crashing" and not stage.is_small:
                os.kill(os.getpid(), signal.SIGSEGV)
            if name == "crashing-small" and stage.is_small:
                os.kill(os.getpid(), signal.SIGSEGV)
            if name == "raising" and not stage.is_small:
                raise ValueError("I would rather not\nsecond line")
            if name == "leaving":
                sys.exit(4)
        return count

    def answer(self, subject: tuple[Stage, int], outcome: int) -> Answer:
        stage, _ = subject
        threads = int(os.environ["NUMBA_NUM_THREADS"])
        if stage.contestant.name == "wrong" and self.name == "second":
            return Answer("bad0", {"count": 41, "threads": threads, "sum": float("nan")})
        visits = stage.visits if stage.chained else 0
        return Answer(f"{outcome}{visits}", {"count": outcome, "threads": threads, "sum": 0.5})

    def work(self, subject: tuple[Stage, int], outcome: int) -> Work:
        return Work(outcome, "letters")


class Family:
    name = "scripted"
    reference = "steady"
    thesis_order = ("third", "first", "second")
    models = {"tiny": "three letters"}

    def find_model(self, model: str, *, size: int | None, numbering: str, seed: int) -> Path:
        return HERE / "model"

    def small_model(self) -> Path:
        return HERE / "small"

    def stage(self, contestant: Contestant, model: Path, *, chained: bool) -> Stage:
        return Stage(contestant, model, chained)


FAMILY = Family()
NAMES = "steady other third chatty lazy wrong raising crashing crashing-small leaving"
CONTESTANTS = [Contestant(name) for name in NAMES.split()]
SCENARIOS = [Scenario("first"), Scenario("second"), Scenario("third")]
