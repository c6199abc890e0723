"""Where a choice flips: how much more or less of one task makes another contestant the better one.

In a launch the time of a contestant beyond that of the first is a line over the weight of a task, all other weights fixed:
what it loses in the rest of the mix, and its loss in the task times the weight. Where that is 0, both take as long. A
flip is told only where all launches agree that there is one, and on which side of it the first is; a loss or a gain within
statistics.BEYOND is none.
"""

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import msgspec
import numpy as np

from tetrabench.bench.statistics import BEYOND, interval_over
from tetrabench.report.totals import Seconds, Totals


class Flip(msgspec.Struct, frozen=True, kw_only=True):
    """A weight at which another contestant overtakes the first.

    Attributes:
        side: "above" or "below": of that weight the other one is better.
        backend: the other one.
        weight: median over launches; low, high: its interval, or the range of the launches (`is_whole` is False).
        share: of the task in the first's total at that weight.
    """

    side: str
    backend: str
    weight: float
    low: float
    high: float
    is_whole: bool
    share: float


class Outlook(msgspec.Struct, frozen=True, kw_only=True):
    """What becomes of a choice where there is more or less of one task.

    Attributes:
        weight: in the mix, 0 where the task is no part of it.
        flips: the nearest one below and the nearest one above, as far as there are any.
        holds: in all launches whoever takes longer than the first does so whatever the weight. Where it does not hold and
            nothing flips, the run cannot tell.
    """

    task: str
    weight: float
    flips: list[Flip] = []
    holds: bool = False


class Line(NamedTuple):
    """By launch: seconds of the first and of another contestant, in the rest of the mix, and in the task once."""

    first_rest: Seconds
    other_rest: Seconds
    first_once: Seconds
    other_once: Seconds

    @property
    def side(self) -> str:
        """On which side of the flip the other one is better; "" where there is none, or launches disagree."""
        if _is_less(self.first_rest, self.other_rest) and _is_less(self.other_once, self.first_once):
            return "above"
        if _is_less(self.other_rest, self.first_rest) and _is_less(self.first_once, self.other_once):
            return "below"
        return ""

    @property
    def holds(self) -> bool:
        """Whether the first is no slower in any launch, whatever the weight."""
        rest, once = self.first_rest <= BEYOND * self.other_rest, self.first_once <= BEYOND * self.other_once
        return bool(rest.all() and once.all())

    @property
    def weights(self) -> Seconds:
        """Where both take as long."""
        return (self.other_rest - self.first_rest) / (self.first_once - self.other_once)


def look(totals: Totals, first: str, others: Iterable[str], tied: Sequence[str], task: str) -> Outlook:
    """The outlook on one task.

    Args:
        totals: of the mix.
        first: the contestant that is chosen.
        others: all others that are ranked; tied: those of them that cannot be told from it, about whom nothing holds.
        task: any task of the run.
    """
    weight = totals.weights.get(task, 0.0)
    mine = totals.timed(task, first)
    if mine is None or mine.is_short or task in totals.doubts:
        return Outlook(task=task, weight=weight)
    flips: list[Flip] = []
    holds = True
    for other in others:
        theirs = totals.timed(task, other)
        if theirs is None:  # it cannot do the task: with more of it, it is out
            continue
        line = _line(totals, first, other, task)
        if not theirs.is_short and line.side:
            flips.append(_flip(totals, first, other, task, line))
        elif other not in tied:
            holds = holds and not theirs.is_short and line.holds
    above = sorted((flip for flip in flips if flip.side == "above"), key=lambda flip: flip.weight)
    below = sorted((flip for flip in flips if flip.side == "below"), key=lambda flip: -flip.weight)
    return Outlook(task=task, weight=weight, flips=[*below[:1], *above[:1]], holds=holds and not flips)


def _line(totals: Totals, first: str, other: str, task: str) -> Line:
    first_rest, other_rest = (
        sum((seconds for of, seconds in totals.times(name).items() if of != task), np.zeros(len(totals.launches)))
        for name in (first, other)
    )
    return Line(first_rest, other_rest, _once(totals, task, first), _once(totals, task, other))


def _is_less(one: Seconds, other: Seconds) -> bool:
    """In every launch, and by more than nobody asks about."""
    return bool((one * BEYOND < other).all())


def _flip(totals: Totals, first: str, other: str, task: str, line: Line) -> Flip:
    interval = interval_over(np.log(line.weights).tolist(), totals.confidence)
    assert interval  # there is a launch at least
    in_task = interval.ratio * float(np.median(line.first_once))
    cells = [totals.timed(of, name) for of in {*totals.weights, task} for name in (first, other)]
    return Flip(
        side=line.side,
        backend=other,
        weight=interval.ratio,
        low=interval.low,
        high=interval.high,
        is_whole=interval.is_whole and not any(cell and cell.is_sparse for cell in cells),
        share=in_task / (float(np.median(line.first_rest)) + in_task),
    )


def _once(totals: Totals, task: str, name: str) -> Seconds:
    cell = totals.timed(task, name)
    assert cell  # who asks has looked
    return cell.seconds(totals.launches)
