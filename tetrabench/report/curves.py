"""Time of an item over what was chosen: over an option of contestants, or over a count of a scenario.

A run that sweeps over an option has a backend for each value; one that sweeps over a count has a task for each.
"""

import math
from collections.abc import Callable, Hashable, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from statistics import median
from typing import TypeVar

from tetrabench.bench.record import Results, Task
from tetrabench.bench.statistics import Row, total_of
from tetrabench.protocols import Options
from tetrabench.report.lines import Line, few_of_each, label_of, lines_of
from tetrabench.report.parts import shown_name

Key = TypeVar("Key", bound=Hashable)
Thing = TypeVar("Thing")
FEWEST = 3
"""So many values are a curve."""
WIDE = 30.0
"""An axis whose values span more than this is logarithmic."""
GAP = 0.06
"""Of the height of a chart: so far apart are two labels at least."""
FAR = 10.0
"""A level that is so many times above or below all curves would make them flat: it is named, not drawn."""


@dataclass(frozen=True)
class Point:
    """A backend in a task.

    Attributes:
        value: of what is on x; of a level nothing.
        seconds: of one item, median over samples; low, high: the range of the medians of the launches.
        is_least: none of its curve takes less; is_beaten: it is shown to be slower than that one.
    """

    line: Line
    value: int
    seconds: float
    low: float
    high: float
    is_least: bool = False
    is_beaten: bool = False


@dataclass(frozen=True)
class Curve:
    """What belongs together, under one label, in the order of the values.

    Attributes:
        key: the line that it looks like.
    """

    label: str
    points: list[Point]
    key: Line

    @property
    def is_wrong(self) -> bool:
        """Whether it is of an example of a wrong answer."""
        return any(point.line.is_wrong for point in self.points)


@dataclass(frozen=True)
class Curves:
    """A chart.

    Attributes:
        task: that all backends did; over a count of a scenario, its name with the other counts that vary.
        contestant: the first that has the option; "" over a count of a scenario.
        option: what is on x.
        levels: of each contestant that has no such choice its quickest backend, under its label; beyond: those that
            are FAR from all curves.
    """

    model: str
    task: str
    contestant: str
    option: str
    curves: list[Curve]
    levels: list[Curve]
    beyond: list[Curve]

    @property
    def points(self) -> list[Point]:
        """All that are drawn, those of the levels last."""
        return [point for curve in (*self.curves, *self.levels) for point in curve.points]

    @property
    def values(self) -> list[int]:
        """All that are on x."""
        return sorted({point.value for curve in self.curves for point in curve.points})

    @property
    def is_wide(self) -> bool:
        """Whether the values need a logarithmic axis."""
        return spans(self.values)

    @property
    def is_tall(self) -> bool:
        """Whether the times need a logarithmic axis."""
        return spans([point.seconds for point in self.points])

    @property
    def label_seconds(self) -> list[float]:
        """Where the label of each level stands: at its time, or a little above it where another label is."""
        seconds = [level.points[0].seconds for level in self.levels]
        to, back = (math.log, math.exp) if self.is_tall else (float, float)
        reach = [to(point.seconds) for point in self.points] + ([] if self.is_tall else [0.0])
        gap = GAP * (max(reach) - min(reach))
        moved, last = dict.fromkeys(range(len(seconds)), 0.0), -math.inf
        for place in sorted(moved, key=seconds.__getitem__):
            moved[place] = last = max(to(seconds[place]), last + gap)
        return [back(one) for one in moved.values()]


def spans(values: Sequence[float]) -> bool:
    """Whether an axis of these has to be logarithmic, and can be."""
    return min(values) > 0 and max(values) > WIDE * min(values)


def curves_over_options(results: Results, rows: Sequence[Row], against: Callable[[str], Iterable[Row]]) -> list[Curves]:
    """For each model, task and option, where a contestant ran with FEWEST values of it at least.

    Args:
        results: a run.
        rows: its summary; against: the same with a backend, by name, as the reference.
    """
    charts = []
    for (model, task), lines in _grouped(_lines(results, rows), lambda line: (line.row.model, line.row.task)).items():
        own = _grouped(lines, lambda line: line.backend.contestant)
        varied = {contestant: _varied([line.backend.options for line in mine]) for contestant, mine in own.items()}
        for option in dict.fromkeys(name for names in varied.values() for name in names):
            entries = [
                (_name(line, [name for name in names if name != option]), line.backend.options[option], line)
                for line in lines
                for names in [varied[line.backend.contestant]]
                if option in names
            ]
            if curves := [_judged(curve, against) for curve in _curves(entries)]:
                drawn = [point.line.backend.contestant for curve in curves for point in curve.points]
                levels = [_level(mine) for contestant, mine in own.items() if contestant not in drawn]
                near = [level for level in levels if _is_near(level, curves)]
                beyond = [level for level in levels if level not in near]
                charts.append(Curves(model, task, drawn[0], option, curves, near, beyond))
    return charts


def curves_over_counts(results: Results, rows: Sequence[Row]) -> list[Curves]:
    """For each model, scenario and count, where it ran with FEWEST values of it at least: a curve for each backend."""
    tasks = {task.name: task for task in results.tasks}
    own = _grouped(results.tasks, lambda task: task.scenario)
    charts = []
    for model, everybody in _grouped(_lines(results, rows), lambda line: line.row.model).items():
        few = few_of_each({line.backend.name: line.backend for line in everybody}.values())
        lines = [line for line in everybody if line.backend in few]
        for mine in own.values():
            varied = _varied([task.options for task in mine])
            for count in varied:
                others = [name for name in varied if name != count]
                titles = _grouped(mine, partial(_title, others=others))
                for title, ladder in titles.items():
                    names = {task.name for task in ladder}
                    curves = _curves(
                        (shown_name(line.backend), tasks[line.row.task].options[count], line)
                        for line in lines
                        if line.row.task in names
                    )
                    if curves:
                        charts.append(Curves(model, title, "", count, curves, [], []))
    return charts


def _lines(results: Results, rows: Sequence[Row]) -> list[Line]:
    """Those whose work is known."""
    return [line for line in lines_of(results, rows) if any(sample.items for sample in line.samples)]


def _grouped(things: Iterable[Thing], key: Callable[[Thing], Key]) -> dict[Key, list[Thing]]:
    groups: dict[Key, list[Thing]] = {}
    for thing in things:
        groups.setdefault(key(thing), []).append(thing)
    return groups


def _varied(options: Sequence[Options]) -> list[str]:
    """Options of which there are several values."""
    names = dict.fromkeys(name for one in options for name in one)
    return [name for name in names if len({one.get(name) for one in options}) > 1]


def _name(line: Line, others: Sequence[str]) -> str:
    """Of a curve over an option: its contestant, and what else was chosen about it."""
    words = [line.backend.contestant, *(f"{name}={line.backend.options[name]}" for name in others)]
    return " ".join(words) + "*" * line.backend.extension


def _title(task: Task, others: Sequence[str]) -> str:
    return " ".join([task.scenario, *(f"{name}={task.options[name]}" for name in others)])


def _curves(entries: Iterable[tuple[str, int, Line]]) -> list[Curve]:
    """Of names, values and lines: a curve for each name that has enough values.

    It looks like one of its lines: of several curves of a contestant the first like a light one, the last like a dark one.
    """
    names = _grouped(entries, lambda entry: entry[0])
    enough = {name: mine for name, mine in names.items() if len({value for _, value, _ in mine}) >= FEWEST}
    kin = _grouped(enough, lambda name: enough[name][0][2].backend.contestant)
    curves = []
    for alike in kin.values():
        for place, name in enumerate(alike):
            points = sorted((_point(line, value) for _, value, line in enough[name]), key=lambda point: point.value)
            label = label_of(name, is_wrong=any(point.line.is_wrong for point in points))
            key = points[(2 * place + 1) * len(points) // (2 * len(alike))].line
            curves.append(Curve(label, points, key))
    return curves


def _point(line: Line, value: int = 0) -> Point:
    """Seconds of one item, and how far the launches lie apart."""
    launches: dict[int, list[float]] = {}
    for sample in line.samples:
        launches.setdefault(sample.launch, []).append(total_of(sample, line.row.clock) / sample.repeats)
    items = median(sample.items / sample.repeats for sample in line.samples if sample.items)
    middles = [median(seconds) / items for seconds in launches.values()]
    seconds = median(one for mine in launches.values() for one in mine) / items
    return Point(line, value, seconds, min(middles), max(middles))


def _level(lines: Iterable[Line]) -> Curve:
    """The quickest of some."""
    quickest = min(map(_point, lines), key=lambda point: point.seconds)
    return Curve(quickest.line.label, [quickest], quickest.line)


def _is_near(level: Curve, curves: Sequence[Curve]) -> bool:
    """Whether a level can stand in a chart of these curves."""
    seconds = [point.seconds for curve in curves for point in curve.points]
    return min(seconds) / FAR <= level.points[0].seconds <= FAR * max(seconds)


def _judged(curve: Curve, against: Callable[[str], Iterable[Row]]) -> Curve:
    """The same with the least of its points, and who is shown to be slower than that; a wrong one has no such."""
    if curve.is_wrong:
        return curve
    least = min(curve.points, key=lambda point: point.seconds)
    row = least.line.row
    slower = {
        one.backend
        for one in against(row.backend)
        if (one.model, one.task, one.verdict) == (row.model, row.task, "slower")
    }
    points = [
        replace(point, is_least=point is least, is_beaten=point.line.row.backend in slower) for point in curve.points
    ]
    return replace(curve, points=points)
