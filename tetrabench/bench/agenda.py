"""What is left to do in a run, and how long that will take."""

from statistics import fmean

from tetrabench.bench.plan import Plan

_Cell = tuple[str, str]  # scenario, backend


class Agenda:
    """The turns still to be taken, cell by cell, and what the turns of a cell have cost so far.

    The remaining time is an estimate: a cell's turns cost what its earlier ones did; before its first, what
    the reference's cost in the same scenario, times how much slower this backend was elsewhere; before
    that, what turns have cost on the whole.
    """

    def __init__(self, plan: Plan) -> None:
        self._reference = plan.reference
        self._left: dict[_Cell, int] = {
            (task.scenario, backend.name): plan.effort.rounds for task in plan.tasks for backend in plan.backends
        }
        self._costs: dict[_Cell, list[float]] = {}
        self.done = 0

    @property
    def total(self) -> int:
        """Turns of the whole run, as far as one knows by now."""
        return self.done + sum(self._left.values())

    def left(self, scenario: str, backend: str) -> int:
        """Turns that a cell still has."""
        return self._left[scenario, backend]

    def limit(self, scenario: str, backend: str, turns: int) -> None:
        """Leave a cell `turns` more turns at most."""
        self._left[scenario, backend] = min(turns, self._left[scenario, backend])

    def took(self, scenario: str, backend: str, seconds: float) -> None:
        """Book a turn: wall time with its preparation and its answer."""
        self._costs.setdefault((scenario, backend), []).append(seconds)
        self._left[scenario, backend] -= 1
        self.done += 1

    def seconds_remaining(self) -> float | None:
        """Wall time until all is done; None before the first turn."""
        if not self._costs:
            return None
        means = {cell: fmean(costs) for cell, costs in self._costs.items()}
        return sum(turns * self._expect(cell, means) for cell, turns in self._left.items() if turns)

    def _expect(self, cell: _Cell, means: dict[_Cell, float]) -> float:
        scenario, backend = cell
        if cell in means:
            return means[cell]
        if (scenario, self._reference) not in means:
            return fmean(means.values())
        ratios = [
            cost / means[other, self._reference]
            for (other, name), cost in means.items()
            if name == backend and means.get((other, self._reference))
        ]
        return means[scenario, self._reference] * (fmean(ratios) if ratios else 1.0)
