"""Progress of a run, for whoever wants to show it."""

from typing import Protocol

from tetrabench.bench.plan import Plan


class Progress(Protocol):
    """Is told what happens. Calls come one at a time, though not always from the same thread."""

    def started(self, plan: Plan) -> None:
        """The run begins."""

    def step(self, text: str, done: int, total: int, seconds_remaining: float | None) -> None:
        """`text` happens now; so much of the total is done. Warming and measuring each count from 0."""


class Silence:
    """Shows nothing."""

    def started(self, plan: Plan) -> None:
        """Say nothing."""

    def step(self, text: str, done: int, total: int, seconds_remaining: float | None) -> None:
        """Say nothing."""
