"""Totals of a mix, launch by launch, and what one contestant takes as a multiple of another.

A total in a launch is the sum over tasks of: how often, times the median seconds of the reference, times the
contestant's paired ratio to the reference in that launch (see `statistics`). So each launch gives one ratio of the totals of
any two contestants, free of what disturbed that launch, and the interval over launches is that of the sign test.

Not every cell has a ratio in every launch. In the middle its median stands in; at the low end of an interval its least,
at the high end its greatest, so that what was not measured makes an interval wider, never narrower. A cell of fewer
launches than others have and an interval needs may besides be off by statistics.CLEAR; not at its low end where it is
a bound (see statistics.Row), which is believed.
"""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from statistics import median

import msgspec
import numpy as np
from numpy.typing import NDArray

from tetrabench.bench.pairs import fewest_for
from tetrabench.bench.statistics import (
    BEYOND,
    CLEAR,
    SHORTEST_S,
    Interval,
    confidence_of,
    interval_over,
    launch_ratios,
    samples_of,
    total_of,
)
from tetrabench.report.parts import Part

MATTERS = 0.05
"""A task that is no larger a share of a total decides nothing there."""

Seconds = NDArray[np.float64]  # (launches,)
Weights = Mapping[str, float]
"""How often each task."""

_ENDS: dict[int, Callable[[Iterable[float]], float]] = {
    -1: min,
    0: median,
    1: max,
}  # what stands in where a launch is missing: low end, middle, high end


class Multiple(msgspec.Struct, frozen=True, kw_only=True):
    """The time of a contestant as a multiple of another's, who is meant to be no slower.

    Attributes:
        verdict: "slower"; "cannot tell", where the interval does not exclude 1 by statistics.BEYOND, or where nothing may
            be ranked; "hint", where launches are too few for an interval and not all beyond statistics.CLEAR.
        ratio: median over launches; low, high: its interval, or the range of the launches (`is_whole` is False).
        is_bound: it is only known to be `low` at least.
    """

    verdict: str
    ratio: float
    low: float
    high: float
    is_whole: bool
    is_bound: bool = False


@dataclass(frozen=True)
class Timed:
    """What is known of the time of a contestant in a task.

    Attributes:
        base: seconds that the reference takes.
        logs: launch -> ln(contestant / reference).
        is_sparse: of too few launches for an interval, where others have more; is_bound: and yet slower than the reference.
        is_short: too short to be known: counts like the reference's.
    """

    base: float
    logs: Mapping[int, float]
    is_sparse: bool
    is_bound: bool
    is_short: bool

    def seconds(self, launches: Sequence[int], end: int = 0) -> Seconds:
        """Of one run of the scenario, by launch."""
        is_open = self.is_sparse and not (self.is_bound and end < 0)
        stand_in = _ENDS[end](self.logs.values()) + (end * math.log(CLEAR) if is_open else 0.0)
        return self.base * np.exp([self.logs.get(launch, stand_in) for launch in launches])


class Totals:
    """Of all contestants that ended well in the tasks of a mix, on one model.

    Attributes:
        part: the model; weights: the mix, in which every weight is above 0.
        names: the contestants, all of whom are compared with each other.
        launches: those in which a task of the mix was done.
        confidence: what each interval holds with, so that all comparisons with one contestant hold together.
        is_whole: whether there are launches enough for intervals.
    """

    def __init__(
        self, part: Part, weights: Weights, names: Sequence[str], launches: Sequence[int] | None = None
    ) -> None:
        self.part = part
        self.weights = dict(weights)
        self.names = list(names)
        self.confidence = confidence_of(len(names) - 1)
        self._samples = samples_of(part.results)
        done = {launch for name in names for task in weights for launch in self._logs(task, name)}
        self.launches = sorted(done if launches is None else launches)
        self.is_whole = len(self.launches) >= fewest_for(self.confidence)
        self._timed: dict[tuple[str, str], Timed | None] = {}

    @cached_property
    def doubts(self) -> dict[str, str]:
        """Tasks on which nothing may be ranked, for their control differs: the reason of each."""
        return self.part.doubts

    def timed(self, task: str, name: str) -> Timed | None:
        """What is known of a cell; None where it did not end well, or has nothing to be compared with."""
        if (task, name) not in self._timed:
            self._timed[task, name] = self._time(task, name)
        return self._timed[task, name]

    def times(self, name: str, end: int = 0) -> dict[str, Seconds]:
        """Seconds of the mix in each of its tasks, by launch."""
        return {
            task: weight * cell.seconds(self.launches, end)
            for task, weight in self.weights.items()
            if (cell := self.timed(task, name))
        }

    def seconds(self, name: str) -> float:
        """Of the whole mix, median over launches."""
        return float(np.median(_sum(self.times(name))))

    def middles(self, name: str) -> dict[str, float]:
        """Seconds of the mix in each of its tasks, median over launches."""
        return {task: float(np.median(seconds)) for task, seconds in self.times(name).items()}

    def shares(self, name: str) -> dict[str, float]:
        """The part that each task of the mix has in a contestant's total."""
        middles = self.middles(name)
        return {task: seconds / sum(middles.values()) for task, seconds in middles.items()}

    def compare(self, one: str, other: str) -> Multiple:
        """The total of one contestant as a multiple of another's."""
        interval = self._interval(one, other)
        if self._is_doubtful(one) or self._is_doubtful(other):
            return _multiple("cannot tell", interval)
        if interval.low > (BEYOND if self.is_whole else CLEAR):
            is_sparse = self._has(one, lambda task: _is_sparse(self.timed(task, one)))
            return _multiple("slower", interval, is_bound=is_sparse or not self.is_whole)
        return _multiple("cannot tell" if self.is_whole else "hint", interval)

    def in_task(self, task: str) -> "Totals":
        """The same contestants and launches in one task alone."""
        return Totals(self.part, {task: 1.0}, self.names, self.launches)

    def _interval(self, one: str, other: str) -> Interval:
        intervals = []
        for end in _ENDS:
            ours, theirs = self.times(one, end), self.times(other, -end)
            intervals.append(interval_over(np.log(_sum(ours) / _sum(theirs)).tolist(), self.confidence))
        low, middle, high = filter(None, intervals)  # none is missing: all have ended well in a launch at least
        return Interval(middle.ratio, low.low, high.high, middle.is_whole)

    def _is_doubtful(self, name: str) -> bool:
        """Whether a task on which nothing may be ranked matters to a contestant."""
        return self._has(name, lambda task: task in self.doubts)

    def _has(self, name: str, asked: Callable[[str], bool]) -> bool:
        """Whether tasks of a kind matter in a contestant's total."""
        return sum(share for task, share in self.shares(name).items() if asked(task)) > MATTERS

    def _time(self, task: str, name: str) -> Timed | None:
        row = self.part.rows.get((task, name))
        logs = self._logs(task, name)
        if row is None or row.status != "ok" or not logs:
            return None
        enough = min(fewest_for(self.confidence), len(self.launches))
        is_short = row.verdict == "too short"
        return Timed(
            base=self._base(task),
            logs=dict.fromkeys(self.launches, 0.0) if is_short else logs,
            is_sparse=not is_short and len(logs) < enough,
            is_bound=row.is_bound and row.verdict == "slower",
            is_short=is_short,
        )

    def _logs(self, task: str, name: str) -> dict[int, float]:
        model, reference = self.part.model.name, self.part.reference
        samples, base = (self._samples.get((model, task, one), []) for one in (name, reference))
        return launch_ratios(samples, base, self._clock(task))

    def _base(self, task: str) -> float:
        """Seconds of the reference: as ratios to it do, a sample counts as SHORTEST_S at least."""
        samples = self._samples[self.part.model.name, task, self.part.reference]
        clock = self._clock(task)
        return median(max(total_of(sample, clock), SHORTEST_S) / sample.repeats for sample in samples)

    def _clock(self, task: str) -> str:
        row = self.part.rows.get((task, self.part.reference))
        return row.clock if row else "cpu"


def _sum(times: Mapping[str, Seconds]) -> Seconds:
    total: Seconds = np.sum(list(times.values()), axis=0)
    return total


def _is_sparse(cell: Timed | None) -> bool:
    return cell is not None and cell.is_sparse


def _multiple(verdict: str, interval: Interval, is_bound: bool = False) -> Multiple:
    ratio, low, high, is_whole = interval
    return Multiple(verdict=verdict, ratio=ratio, low=low, high=high, is_whole=is_whole, is_bound=is_bound)
