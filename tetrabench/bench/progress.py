"""Progress of a run, for whoever wants to show it."""

from typing import Protocol

from tetrabench.bench.plan import Plan


class Progress(Protocol):
    """Is told what happens. Calls come one at a time, though not always from the same thread."""

    def started(self, plan: Plan) -> None:
        """The run begins."""

    def step(self, phase: str, detail: str, done: int, total: int, seconds_remaining: float | None) -> None:
        """`detail` of a phase happens now; so much of the total is done. Weighing and warming count for themselves,
        samples through all launches."""


class Silence:
    """Shows nothing."""

    def started(self, plan: Plan) -> None:
        """Say nothing."""

    def step(self, phase: str, detail: str, done: int, total: int, seconds_remaining: float | None) -> None:
        """Say nothing."""
