"""Steps of a simulation: the source's four experiments (chapter 5), and one with contacts as smooth discs have them.

1, over the number of objects, and 2, over the capacity of leaves, are `motion` with sweeps: --objects 10k,20k,50k and
--option kdtree.capacity=1..63. 3, over the area an object has, is `concentration`. 4, step by step over a long run, with and
without recycling (--option kdtree.recycle=0,1), is `weightless` and `gravity`.

Every run tells a series: CPU time by phase, contacts, and what the structure counts, for each stretch of its steps.
"""

from collections.abc import Mapping
from itertools import pairwise
from typing import Any, ClassVar

from tetrabench.collision.digest import state_answer
from tetrabench.collision.dynamics import PHASES
from tetrabench.collision.objects import Objects, Start
from tetrabench.collision.simulation import Simulation
from tetrabench.errors import UnsupportedError
from tetrabench.protocols import Answer, Options, Work
from tetrabench.scenarios.collision.base import CollisionScenario

OBJECT_BYTES = 40
"""Least traffic for an object in a step: to read its place, velocity and radius. (Most are written, too, and then some.)"""
STRETCHES = 50
"""Of a long run: points of a curve."""
GRAVITY, BOUNCE = 0.1, 0.9
"""Of experiment 4: change of a velocity in a step; what a wall leaves of one."""

MOST_TESTS = 5e10
"""Of pairs in a sample: two minutes or so."""

Series = dict[str, list[float]]


class Run:
    """What a sample works on: a simulation, how many steps each stretch has, and what was told of them so far."""

    def __init__(self, simulation: Simulation, steps: int, stretches: int = 1) -> None:
        self.simulation = simulation
        ends = [steps * number // min(stretches, steps) for number in range(min(stretches, steps) + 1)]
        self.stretches = [end - begin for begin, end in pairwise(ends)]
        self.series: Series = {}

    def go(self) -> None:
        """Take all steps."""
        for steps in self.stretches:
            before = self.simulation.phase_seconds
            self.simulation.step(steps)
            self._tell(before)

    def _tell(self, before: Mapping[str, float]) -> None:
        """Add a stretch to the series."""
        simulation, after = self.simulation, self.simulation.phase_seconds
        told: dict[str, float] = {"step": simulation.steps_done, "contacts": simulation.contacts}
        told |= {f"{phase}_s": after[phase] - before[phase] for phase in PHASES}
        told |= simulation.stats()
        told["structure_bytes"] = sum(used for used, _ in simulation.structure_bytes().values())
        for name, number in told.items():
            self.series.setdefault(name, []).append(number)


class Motion(CollisionScenario):
    """Experiments 1 and 2: no gravity, and walls that take nothing."""

    name = "motion"
    title = "steps without gravity, one contact an object and step, as the source has it"
    options = {"steps": 20}
    thesis = {"steps": 1000}
    rules: ClassVar[Mapping[str, Any]] = {}
    stretches = 1

    def prepare(self, stage: Any, options: Options) -> Run:
        """A simulation at its start.

        Raises:
            UnsupportedError: who tests all pairs would be at it for minutes.
        """
        refuse_if_endless(stage, options["steps"])
        return Run(stage.simulation(**self.rules), options["steps"], self.stretches)

    def run(self, run: Run) -> Series:
        """Step; what was told on the way."""
        run.go()
        return run.series

    def answer(self, run: Run, series: Series) -> Answer:
        """Where all objects are."""
        answer = state_answer(run.simulation)
        return Answer(answer.digest, answer.figures, series)

    def work(self, run: Run, series: Series) -> Work:
        """Objects, each as often as there are steps."""
        items = len(run.simulation) * run.simulation.steps_done
        return Work(items, "object steps", OBJECT_BYTES * items)


class Concentration(Motion):
    """Experiment 3: the start drawn out, or together, until each object has a given area; radii and velocities stay."""

    name = "concentration"
    title = "the same with so much area an object: option area, 100 to 1,000,000"
    options = {"steps": 20, "area": 15_000}
    thesis = {"steps": 1000, "area": 15_000}

    def prepare(self, stage: Any, options: Options) -> Run:
        """A simulation at its start, drawn out. Raises UnsupportedError as that of `motion` does."""
        refuse_if_endless(stage, options["steps"])
        simulation = Simulation(drawn_out(stage.start, options["area"]), stage.contestant, **self.rules)
        stage.adopt(simulation)
        return Run(simulation, options["steps"])


class Long(Motion):
    """Experiment 4: many steps."""

    options = {"steps": 500}
    thesis = {"steps": 5000}
    stretches = STRETCHES


class Weightless(Long):
    """Objects stay spread as they are."""

    name = "weightless"
    title = "many steps without gravity, told step by step"


class Gravity(Long):
    """Objects gather at the bottom, and the space above them empties."""

    name = "gravity"
    title = f"many steps with gravity {GRAVITY} and walls that leave {BOUNCE} of a velocity, told step by step"
    rules = {"gravity": GRAVITY, "bounce": BOUNCE}


class Impulses(Motion):
    """All pairs that approach exchange momentum along the line of centres."""

    name = "impulses"
    title = "steps of smooth discs: all contacts in each step, impulses along the line of centres"
    thesis = options = {"steps": 20}
    rules = {"mode": "full"}


def refuse_if_endless(stage: Any, steps: int) -> None:
    """Refuse, with UnsupportedError, more tests than MOST_TESTS to a structure that tests all pairs."""
    objects = len(stage.start.objects.x)
    tests = objects * objects * steps / 2
    if stage.contestant.is_quadratic and tests > MOST_TESTS:
        raise UnsupportedError(f"tests all pairs: {tests:.0e} in {steps:,} steps of {objects:,} objects are too many")


def drawn_out(start: Start, area: float) -> Start:
    """A start with so much area an object: places and box scaled, all else as it was."""
    count = len(start.objects.x)
    factor = (area * count / (start.width * start.height)) ** 0.5 if count else 1.0
    x, y, *others = start.objects
    objects = Objects(factor * x, factor * y, *others)
    return Start(objects, factor * start.width, factor * start.height, f"{start.source}, {area:,} units^2 an object")
