"""What is left to do in a run, how that stands with each cell, and how long it will take."""

from collections.abc import Iterable, Sequence
from statistics import fmean
from typing import NamedTuple

from tetrabench.bench.plan import Plan
from tetrabench.bench.record import Sample


class Cell(NamedTuple):
    """Where figures come to stand: all names are those of the plan."""

    model: str
    task: str
    backend: str


class End(NamedTuple):
    """Why a cell has no figures, or no more of them: a status of `record.Sample`, and the reason."""

    status: str
    reason: str


class Round(NamedTuple):
    """Where turns come to stand: all names and numbers are those of the plan."""

    model: str
    task: str
    launch: int
    group: int
    round: int


HOPELESS = 10.0
"""A contestant that takes so many times the reference's time in the first round gets fewer rounds."""


class Agenda:
    """The turns still to be taken, cell by cell, through all launches, and what the turns of a cell have cost so far.

    It knows no more than the samples say, so that a run that was broken off and resumed has the turns that it would
    have had.

    The remaining time is an estimate: a cell's turns cost what its earlier ones did; before its first, what
    the reference's cost in the same task, times how much slower this backend was elsewhere; before
    that, what turns have cost on the whole. Before each launch its workers have to be made ready.

    Attributes:
        ends: cells that are over before their time.
        told: those of them that a sample tells of.
        repeats: how often a scenario runs in one sample, by model and task, once that is known.
        done: turns taken.
    """

    def __init__(self, plan: Plan) -> None:
        self._plan = plan
        per_cell = plan.effort.launches * plan.effort.rounds
        self._left = {
            Cell(model, task.name, backend.name): per_cell
            for model in plan.models
            for task in plan.tasks
            for backend in plan.backends
        }
        self._costs: dict[Cell, list[float]] = {}
        self._starts: list[float] = []
        self._launches_left = len(plan.models) * plan.effort.launches
        self._sparse: set[Cell] = set()
        compared = {one.name for one in plan.backends if one.against != one.name and not one.control}
        self._compared = compared or {one.name for one in plan.backends}
        self._against = {one.name: one.against for one in plan.backends}
        self._parallel = {task.name for task in plan.tasks if task.parallel}
        self._taken: set[tuple[Cell, int, int, int]] = set()
        self._firsts: dict[Round, dict[str, float]] = {}  # seconds of the first turns of all
        self.ends: dict[Cell, End] = {}
        self.told: set[Cell] = set()
        self.repeats: dict[tuple[str, str], int] = {}
        self.done = 0

    def resume(self, samples: Iterable[Sample]) -> None:
        """Take over what an earlier run has done."""
        for sample in samples:
            self.took(sample, sample.prepare_s + (sample.wall_s or 0.0) + sample.answer_s)
            if sample.status == "ok":
                self.repeats[sample.model, sample.task] = sample.repeats
        for first in self._firsts:
            self.spare_the_hopeless(first)

    @property
    def total(self) -> int:
        """Turns of the whole run, as far as one knows by now."""
        return self.done + sum(self._left.values())

    def takers(self, place: Round, names: Sequence[str]) -> list[str]:
        """Who takes part in a round, has had a turn in it or has yet to have it, in the order of `names`.

        References do as long as somebody does whom they are compared with.
        """
        compared = {name for name in names if name in self._compared and self._takes_part(place, name)}
        return [
            name
            for name in names
            if name in compared or (compared and name not in self._compared and not self._has_ended(place, name))
        ]

    def to_come(self, place: Round, names: Sequence[str]) -> list[str]:
        """Those of the `takers` who have not had their turn."""
        return [name for name in self.takers(place, names) if not self.has_had(place, name)]

    def has_had(self, place: Round, name: str) -> bool:
        """Whether a backend has had its turn in a round."""
        return self._turn(place, name) in self._taken

    def _takes_part(self, place: Round, name: str) -> bool:
        cell = Cell(place.model, place.task, name)
        return self.has_had(place, name) or (self._left[cell] > 0 and (place.round == 0 or cell not in self._sparse))

    def _has_ended(self, place: Round, name: str) -> bool:
        return Cell(place.model, place.task, name) in self.ends

    def _turn(self, place: Round, name: str) -> tuple[Cell, int, int, int]:
        """A reference has a turn in each group, others are in one of them, whichever that is."""
        group = place.group if name not in self._compared else 0
        return Cell(place.model, place.task, name), place.launch, group, place.round

    def is_over(self, model: str, task: str) -> bool:
        """Whether nobody is left whom a task has to compare."""
        return not any(self._left[Cell(model, task, name)] for name in self._compared)

    def end(self, cell: Cell, end: End) -> None:
        """Close a cell for good."""
        self.ends[cell] = end
        self.close(cell)

    def close(self, cell: Cell) -> None:
        """Let a cell have no more turns."""
        self._left[cell] = 0
        if self.is_over(cell.model, cell.task):
            for backend in self._plan.backends:
                self._left[cell._replace(backend=backend.name)] = 0

    def spare_the_hopeless(self, first: Round) -> None:
        """After the first round of all leave those cells few turns, one a launch, that it shows to be hopeless."""
        seconds = self._firsts.get(first, {})
        for name, mine in seconds.items():
            if mine > HOPELESS * seconds.get(self._against[name], mine):
                cell = Cell(first.model, first.task, name)
                left = self._plan.effort.hopeless_rounds - len(self._costs[cell])
                self._left[cell] = max(0, min(left, self._left[cell]))
                self._sparse.add(cell)

    def took(self, sample: Sample, seconds: float) -> None:
        """Book a turn: wall time with its preparation and its answer."""
        place = Round(sample.model, sample.task, sample.launch, sample.group, sample.round)
        cell = Cell(sample.model, sample.task, sample.backend)
        self._taken.add(self._turn(place, sample.backend))
        self._costs.setdefault(cell, []).append(seconds)
        self._left[cell] = max(0, self._left[cell] - 1)
        self.done += 1
        if sample.status != "ok":
            self.told.add(cell)
            self.end(cell, End(sample.status, sample.reason))
        elif place.launch == place.round == 0:
            spent = sample.wall_s if sample.task in self._parallel else sample.cpu_s
            self._firsts.setdefault(place, {})[sample.backend] = spent or 0.0

    def launched(self, seconds: float) -> None:
        """Book the wall time that it took until all workers of a launch were ready."""
        self._starts.append(seconds)
        self._launches_left -= 1

    def seconds_remaining(self) -> float | None:
        """Wall time until all is done; None before the first turn."""
        if not self._costs:
            return None
        means = {cell: fmean(costs) for cell, costs in self._costs.items()}
        turns = sum(turns * self._expect(cell, means) for cell, turns in self._left.items() if turns)
        # the first launch may have compiled: another is a better guide
        start = fmean(self._starts[1:] or self._starts) if self._starts else 0.0
        return turns + max(0, self._launches_left) * start

    def _expect(self, cell: Cell, means: dict[Cell, float]) -> float:
        reference = cell._replace(backend=self._plan.reference)
        if cell in means:
            return means[cell]
        if reference not in means:
            return fmean(means.values())
        ratios = [
            cost / twin
            for other, cost in means.items()
            if other.backend == cell.backend and (twin := means.get(other._replace(backend=self._plan.reference)))
        ]
        return means[reference] * (fmean(ratios) if ratios else 1.0)
