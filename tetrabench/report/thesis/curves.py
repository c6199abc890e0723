"""The curves of a source as runs draw them, and what its findings ask of them (see sources.Curves).

All points of a curve come from one run: the one that has most of them. A contestant that is known to be wrong has its
curve too, for it stands for what the source published; what it took is compared with nothing but itself.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from statistics import fmean, median

from tetrabench.bench.record import Backend, Model, Results, Sample, Task
from tetrabench.bench.statistics import (
    SHORTEST_S,
    Interval,
    confidence_of,
    interval_over,
    samples_of,
    summary,
    total_of,
)
from tetrabench.report.parts import make_parts
from tetrabench.report.thesis.facts import FEWEST_APART, NOWHERE, model_of
from tetrabench.sources import Curve, Source

ALONG = "step"
"""What a curve along the run is over: a series, which says the last step of each stretch."""
TIMES = "_s"
"""How the names of series of seconds end."""
TENTH = 10

Round = tuple[int, int, int]  # launch, group, round
Spent = Mapping[Round, float]  # seconds
Cell = tuple[Model, Task, Backend]


@dataclass(frozen=True)
class Point:
    """Where a curve was measured.

    Attributes:
        place: on the axis below.
        spent: seconds by round, of the scenario with the source's counts; along the run of a step.
        is_doubted: whether no difference in its task can be believed.
    """

    place: float
    spent: Spent
    is_doubted: bool


@dataclass(frozen=True)
class Traced:
    """A curve as one contestant drew it.

    Attributes:
        backend: whose first point it is; model: likewise.
        points: by place, ascending, two at least.
        whole: all of a run along which it goes, or else its first point.
        counts: what was counted along the run, by name, a number for each point.
        is_apart: its points are of several models, which were not measured in turn.
    """

    run: Results
    backend: Backend
    model: Model
    points: list[Point]
    whole: Point
    counts: Mapping[str, list[float]]
    is_apart: bool

    @property
    def confidence(self) -> float:
        """As in tables: wide enough for all contestants of a task together."""
        return confidence_of(sum(not one.control for one in self.run.backends) - 1)

    def time(self, point: Point) -> Interval | None:
        """Seconds at a point."""
        by_launch = _by_launch({of: math.log(spent) for of, spent in point.spent.items()})
        figure = interval_over(by_launch.values(), self.confidence)
        return figure and (figure._replace(low=NOWHERE[0], high=NOWHERE[1]) if point.is_doubted else figure)

    def ratio(self, one: Point, other: Point) -> Interval | None:
        """The time at one point as a multiple of that at another, paired in each round.

        Of several models only the range over launches is honest.
        """
        both = one.spent.keys() & other.spent.keys()
        logs = _by_launch({of: math.log(one.spent[of] / other.spent[of]) for of in both})
        if self.is_apart and logs:
            middle, low, high = map(math.exp, (median(logs.values()), min(logs.values()), max(logs.values())))
            figure: Interval | None = Interval(middle, low, high, len(logs) >= FEWEST_APART)
        else:
            figure = interval_over(logs.values(), self.confidence)
        is_doubted = one.is_doubted or other.is_doubted
        return figure and (figure._replace(low=NOWHERE[0], high=NOWHERE[1]) if is_doubted else figure)


class Asked:
    """The curves of one contestant: see sources.Curves.

    Attributes:
        traced: by the name of the curve; those that nobody measured are not there.
    """

    def __init__(self, contestant: str, traced: Mapping[str, Traced]) -> None:
        self._contestant = contestant
        self.traced = traced

    @property
    def contestant(self) -> str:
        """See sources.Curves."""
        return self._contestant

    def places(self, curve: str) -> list[float]:
        """See sources.Curves."""
        return [point.place for point in self._points(curve)]

    def least(self, curve: str, among: Sequence[float]) -> float | None:
        """See sources.Curves."""
        known = self._medians(curve, among)
        return min(known, key=lambda place: known[place], default=None)

    def most(self, curve: str, among: Sequence[float]) -> float | None:
        """See sources.Curves."""
        known = self._medians(curve, among)
        return max(known, key=lambda place: known[place], default=None)

    def between(self, curve: str, place: float | None, other: float | None) -> Interval | None:
        """See sources.Curves."""
        points = {point.place: point for point in self._points(curve)}
        if place not in points or other not in points:
            return None
        if place == other:
            return _exact(1.0, 1.0)
        return self.traced[curve].ratio(points[place], points[other])

    def grown(self, curve: str, count: str = "") -> Interval | None:
        """See sources.Curves."""
        traced = self.traced.get(curve)
        if traced is None or (count and count not in traced.counts):
            return None
        tenth = max(1, len(traced.points) // TENTH)
        if not count:
            return traced.ratio(_mean(traced.points[-tenth:]), _mean(traced.points[:tenth]))
        values = traced.counts[count]
        return _exact(fmean(values[-tenth:]), fmean(values[:tenth]))

    def beside(self, curve: str, other: str, count: str = "") -> Interval | None:
        """See sources.Curves; of two runs of tetrabench nothing is compared."""
        one, two = self.traced.get(curve), self.traced.get(other)
        if one is None or two is None or one.run is not two.run:
            return None
        if not count:
            return one.ratio(one.whole, two.whole)
        known = [of.counts[count][-1] for of in (one, two) if count in of.counts]
        return _exact(*known) if len(known) == 2 else None

    def _medians(self, curve: str, among: Sequence[float]) -> dict[float, float]:
        return {point.place: median(point.spent.values()) for point in self._points(curve) if point.place in among}

    def _points(self, curve: str) -> list[Point]:
        return self.traced[curve].points if curve in self.traced else []


def trace(curves: Sequence[Curve], contestant: str, runs: Sequence[Results], source: Source) -> Asked:
    """The curves that a contestant drew in some runs, each from the run that has most points of it."""
    traced: dict[str, Traced] = {}
    measured = [_Run(run, source) for run in runs]
    for curve in curves:
        found = [one for run in measured for one in run.trace(curve, contestant)]
        if found:
            traced[curve.name] = max(found, key=lambda one: len(one.points))
    return Asked(contestant, traced)


class _Run:
    """A run of tetrabench, looked through for curves."""

    def __init__(self, results: Results, source: Source) -> None:
        self.results, self.source = results, source
        self.samples = samples_of(results)
        self.clocks = {(row.model, row.task, row.backend): row.clock for row in summary(results)}
        self.doubts = {(part.model.name, task) for part in make_parts(results) for task in part.doubts}
        self.models = [one for one in results.models if model_of(one.name, source)]

    def trace(self, curve: Curve, contestant: str) -> Iterator[Traced]:
        """All that could be this curve: runs that differ in nothing but what it is over, and have two points at least."""
        kinds: dict[object, list[tuple[float, Cell]]] = {}
        for cell in self._cells(curve, contestant):
            if curve.over == ALONG:
                along = self._along(cell)
                if along:
                    yield along
            elif (place := _place(cell, curve.over)) is not None:
                kinds.setdefault(_rest(cell, curve.over), []).append((place, cell))
        for cells in kinds.values():
            known = {place: (self._point(place, cell), cell) for place, cell in sorted(cells, key=lambda one: one[0])}
            points = [point for point, _ in known.values() if point]
            if len(points) > 1:
                first = next(cell for point, cell in known.values() if point)
                models = {cell[0].name for point, cell in known.values() if point}
                yield Traced(self.results, first[2], first[0], points, points[0], {}, len(models) > 1)

    def _cells(self, curve: Curve, contestant: str) -> Iterator[Cell]:
        """Those of the curve's scenario and of a contestant that has its options."""
        tasks = [one for one in self.results.tasks if one.scenario == curve.scenario]
        backends = [
            one
            for one in self.results.backends
            if one.contestant == contestant
            and not one.control
            and all(one.options.get(name, value) == value for name, value in curve.options.items())
        ]
        return product(self.models, tasks, backends)

    def _good(self, cell: Cell) -> list[Sample]:
        """The samples of a cell, where all of them ended well and took long enough; of a contestant that is known to be
        wrong, where nothing worse befell it."""
        model, task, backend = cell
        allowed = {"ok"} if backend.exact else {"ok", "wrong-result"}
        samples = self.samples.get((model.name, task.name, backend.name), [])
        is_good = bool(samples) and all(one.status in allowed for one in samples)
        is_long = is_good and median(total_of(one, self._clock(cell)) for one in samples) >= SHORTEST_S
        return samples if is_long else []

    def _clock(self, cell: Cell) -> str:
        model, task, backend = cell
        return self.clocks[model.name, task.name, backend.name]

    def _is_doubted(self, cell: Cell) -> bool:
        return (cell[0].name, cell[1].name) in self.doubts

    def _point(self, place: float, cell: Cell) -> Point | None:
        """The whole of a cell."""
        task, clock = cell[1], self._clock(cell) if (samples := self._good(cell)) else ""
        counts = self.source.counts.get(task.scenario, {})
        scale = math.prod(count / task.options[name] for name, count in counts.items() if task.options.get(name))
        spent = {_round(one): scale * total_of(one, clock) / one.repeats for one in samples}
        return Point(place, spent, self._is_doubted(cell)) if spent else None

    def _along(self, cell: Cell) -> Traced | None:
        """The stretches of a cell; of samples that went through others than the first, none."""
        samples = [one for one in self._good(cell) if one.series.get(ALONG)]
        whole = self._point(0.0, cell)
        if whole is None or not samples:
            return None
        series = samples[0].series
        ends = series[ALONG]
        steps = [end - start for start, end in zip([0.0, *ends], ends, strict=False)]
        spent = {
            _round(one): [sum(parts) for parts in zip(*_seconds(one), strict=True)]
            for one in samples
            if one.series[ALONG] == ends and _seconds(one)
        }
        if len(ends) < 2 or not spent or not all(map(all, spent.values())):
            return None
        points = [
            Point(end, {of: seconds[place] / steps[place] for of, seconds in spent.items()}, whole.is_doubted)
            for place, end in enumerate(ends)
        ]
        counts = {name: values for name, values in series.items() if name != ALONG and not name.endswith(TIMES)}
        return Traced(self.results, cell[2], cell[0], points, whole, counts, False)


def _place(cell: Cell, over: str) -> float | None:
    """Where on a curve a cell is."""
    model, task, backend = cell
    return next((options[over] for options in (model.size, task.options, backend.options) if over in options), None)


def _rest(cell: Cell, over: str) -> object:
    """What must be alike in all cells of a curve."""
    model, task, backend = cell
    options = [sorted((name, one) for name, one in of.options.items() if name != over) for of in (task, backend)]
    return "" if over in model.size else model.name, *map(tuple, options)


def _seconds(sample: Sample) -> list[list[float]]:
    """The series of seconds of a sample."""
    return [values for name, values in sample.series.items() if name.endswith(TIMES)]


def _round(sample: Sample) -> Round:
    return sample.launch, sample.group, sample.round


def _by_launch(logs: Mapping[Round, float]) -> dict[int, float]:
    """The median over the rounds of each launch."""
    launches: dict[int, list[float]] = {}
    for (launch, _, _), log in logs.items():
        launches.setdefault(launch, []).append(log)
    return {launch: median(of) for launch, of in launches.items()}


def _mean(points: Sequence[Point]) -> Point:
    """Several stretches of a run as one."""
    spent = {of: fmean(point.spent[of] for point in points) for of in points[0].spent}
    return Point(points[-1].place, spent, points[0].is_doubted)


def _exact(one: float, other: float) -> Interval | None:
    """A ratio of counts, which are the same in each sample."""
    return Interval(one / other, one / other, one / other, True) if other > 0 else None
