"""What is left to do in a run, how that stands with each cell, and how long it will take."""

from collections.abc import Iterable
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


Begun = tuple[str, str, int, int, int]  # model, task, launch, group, round


class Agenda:
    """The turns still to be taken, cell by cell, through all launches, and what the turns of a cell have cost so far.

    The remaining time is an estimate: a cell's turns cost what its earlier ones did; before its first, what
    the reference's cost in the same task, times how much slower this backend was elsewhere; before
    that, what turns have cost on the whole. Before each launch its workers have to be made ready.

    Attributes:
        ends: cells that are over before their time.
        repeats: how often a scenario runs in one sample, by model and task, once that is known.
        begun: rounds that have had a sample.
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
        self.ends: dict[Cell, End] = {}
        self.repeats: dict[tuple[str, str], int] = {}
        self.begun: set[Begun] = set()
        self.done = 0

    def resume(self, samples: Iterable[Sample]) -> None:
        """Take over what an earlier run has done."""
        for sample in samples:
            cell = Cell(sample.model, sample.task, sample.backend)
            if sample.status != "ok":
                self.end(cell, End(sample.status, sample.reason))
                continue
            self.begun.add((sample.model, sample.task, sample.launch, sample.group, sample.round))
            self.repeats[sample.model, sample.task] = sample.repeats
            self.took(cell, sample.prepare_s + (sample.wall_s or 0.0) + sample.answer_s)

    @property
    def total(self) -> int:
        """Turns of the whole run, as far as one knows by now."""
        return self.done + sum(self._left.values())

    def has_turn(self, cell: Cell, round: int) -> bool:
        """Whether a cell takes part in this round of a launch. References do as long as somebody is left."""
        if cell.backend not in self._compared:
            return cell not in self.ends
        return self._left[cell] > 0 and (round == 0 or cell not in self._sparse)

    def is_over(self, model: str, task: str) -> bool:
        """Whether nobody is left whom a task has to compare."""
        return not any(self._left[Cell(model, task, name)] for name in self._compared)

    def is_compared(self, backend: str) -> bool:
        """Whether a reference is there for this one; or it is a reference, where nobody else takes part."""
        return backend in self._compared

    def end(self, cell: Cell, end: End) -> None:
        """Close a cell for good."""
        self.ends[cell] = end
        self.close(cell)

    def close(self, cell: Cell) -> None:
        """Let a cell have no more turns."""
        self._left[cell] = 0

    def spare(self, cell: Cell, turns: int) -> None:
        """Leave a cell `turns` more turns at most, one a launch."""
        self._left[cell] = min(turns, self._left[cell])
        self._sparse.add(cell)

    def took(self, cell: Cell, seconds: float) -> None:
        """Book a turn: wall time with its preparation and its answer."""
        self._costs.setdefault(cell, []).append(seconds)
        self._left[cell] = max(0, self._left[cell] - 1)
        self.done += 1

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
