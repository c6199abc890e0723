"""Where a choice flips: how much more or less of one task makes another contestant the better one.

In a launch the time of a contestant beyond that of the first is a line over the weight of a task, all other weights fixed:
what it loses in the rest of the mix, and its loss in the task times the weight. Where that is 0, both take as long. A
flip is told only where all launches agree that there is one, and on which side of it the first is; a loss or a gain within
statistics.BEYOND is none. And only if nobody else is better at that weight: who cannot be told from the first may be.
"""

import math
from collections.abc import Iterable, Sequence
from typing import NamedTuple

import msgspec
import numpy as np

from tetrabench.bench.statistics import BEYOND, interval_over
from tetrabench.report.advice.totals import MATTERS, Seconds, Totals

NOWHERE = (math.inf, -math.inf)
"""The weights between which nothing is known to hold."""


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
        flips: one below, one above, as far as there are any.
        holds: the weights between which, in all launches, nobody who takes longer than the first becomes faster, with None
            for no end; None where the run cannot tell.
    """

    task: str
    weight: float
    flips: list[Flip] = []
    holds: tuple[float, float | None] | None = None


FAR = 100.0
"""Nobody asks what would be with so many times as much of a task, or as little."""


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
    def range(self) -> tuple[float, float]:
        """The weights between which the first is no slower in any launch; the first is above the second where none are."""
        rest, once = BEYOND * self.other_rest - self.first_rest, BEYOND * self.other_once - self.first_once
        ends = -rest / np.where(once == 0, 1.0, once)
        never = np.any((once == 0) & (rest < 0))
        low = np.max(ends, where=once > 0, initial=np.inf if never else 0.0)
        return float(low), float(np.min(ends, where=once < 0, initial=np.inf))

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
    ranges = [(0.0, math.inf)]
    for other in others:
        theirs = totals.timed(task, other)
        if theirs is None:  # it cannot do the task: with more of it, it is out
            continue
        line = _line(totals, first, other, task)
        if not theirs.is_short and line.side:
            flips.append(_flip(totals, first, other, task, line))
        if other not in tied:
            ranges.append(NOWHERE if theirs.is_short else _line(totals, first, other, task, end=1).range)
    low, high = max(low for low, _ in ranges), min(high for _, high in ranges)
    return Outlook(
        task=task,
        weight=weight,
        flips=[flip for flip in flips if _matters(totals, first, task, flip)],
        holds=(low, None if high == math.inf else high) if low <= weight <= high else None,
    )


def _line(totals: Totals, first: str, other: str, task: str, end: int = 0) -> Line:
    """In the middle, or with `end` 1 as it is at worst for the first."""
    rests = _rest(totals, task, first, end), _rest(totals, task, other, -end)
    return Line(*rests, _once(totals, task, first, end), _once(totals, task, other, -end))


def _matters(totals: Totals, first: str, task: str, flip: Flip) -> bool:
    """Whether nobody else would be better there, and it is not FAR from the mix, or all but a trifle of it."""
    weight = totals.weights.get(task, 0.0)
    is_near = weight / FAR <= flip.weight <= weight * FAR if weight else flip.share <= 1 - MATTERS
    return is_near and flip.backend == _best_at(totals, task, flip.weight, besides=first)


def _best_at(totals: Totals, task: str, weight: float, besides: str) -> str:
    """Who takes least with that weight of a task, by the medians."""
    able = [name for name in totals.names if name != besides and totals.timed(task, name)]
    return min(able, key=lambda name: float(np.median(_rest(totals, task, name) + weight * _once(totals, task, name))))


def _rest(totals: Totals, task: str, name: str, end: int = 0) -> Seconds:
    """Seconds of all the mix but one task."""
    times = totals.times(name, end)
    return sum((seconds for of, seconds in times.items() if of != task), np.zeros(len(totals.launches)))


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


def _once(totals: Totals, task: str, name: str, end: int = 0) -> Seconds:
    cell = totals.timed(task, name)
    assert cell  # who asks has looked
    return cell.seconds(totals.launches, end)
