"""Who answers the questions of a source's findings (see sources.Facts): a run, or what the source printed itself.

Both answer from the same two tables, by launch: the logarithm of one contestant's time over another's, and seconds. To
the source all was one launch, whose figures are taken as they are printed.
"""

import math
import re
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cached_property
from statistics import median

from tetrabench.bench.record import Memory, Sample
from tetrabench.bench.statistics import (
    SHORTEST_S,
    Interval,
    Row,
    confidence_of,
    interval_over,
    launch_ratios,
    samples_of,
    total_of,
)
from tetrabench.report.memory import MEMORY_ERROR, memories
from tetrabench.report.parts import Part
from tetrabench.sources import Source

FEWEST_APART = 3
"""A range over so many launches at least says how far two models are apart that were not measured in turn."""
NOWHERE = (0.0, math.inf)
"""The ends of an interval that says nothing."""
Logs = Mapping[int, float]  # launch -> ln of a ratio


def model_of(name: str, source: Source) -> str | None:
    """The source's model that a model of a run is named after; None where it is none."""
    first = re.match(r"[^\W\d_]*", name.lower())
    return first[0] if first and first[0] in source.models else None


class Known(ABC):
    """What follows from the two tables, whoever has them."""

    def __init__(self, source: Source) -> None:
        self.source = source

    @abstractmethod
    def logs(self, task: str, one: str, other: str) -> Logs:
        """ln(one / other) by launch; empty where it is not known."""

    @abstractmethod
    def seconds(self, task: str, contestant: str) -> Mapping[int, float]:
        """Seconds of a task with the source's counts, by launch; empty where they are not known."""

    @abstractmethod
    def interval(self, logs: Iterable[float]) -> Interval | None:
        """Of logarithms of ratios over launches."""

    @abstractmethod
    def is_short(self, task: str, contestant: str) -> bool:
        """Whether a time is too short to be known but for its being short."""

    def is_doubted(self, task: str) -> bool:
        """Whether no difference in a task can be believed."""
        return False

    def ratio(self, task: str, one: str, other: str) -> Interval | None:
        """See sources.Facts."""
        figure = self.interval(self.logs(task, one, other).values())
        return self._open(figure, [(task, one)], [(task, other)])

    def change(self, task: str, other_task: str, one: str, other: str) -> Interval | None:
        """See sources.Facts."""
        first, second = self.logs(task, one, other), self.logs(other_task, one, other)
        figure = self.interval(first[launch] - second[launch] for launch in first.keys() & second.keys())
        return self._open(figure, [(task, one), (other_task, other)], [(task, other), (other_task, one)])

    def total(self, one: str, other: str) -> Interval | None:
        """See sources.Facts.

        The other's seconds are the weights of the ratios in each launch. A launch that spared a hopeless contestant a
        task has no ratio there: the least of the other launches stands in at the low end, the greatest at the high one.
        """
        tasks = self._tasks_of(one, other)
        weights = {task: self.seconds(task, other) for task in tasks}
        logs = {task: self.logs(task, one, other) for task in tasks}
        if not tasks or not all(logs.values()):
            return None
        launches = set.intersection(*(set(weight) for weight in weights.values()))

        def totals(stand_in: Callable[[Iterable[float]], float]) -> list[float]:
            ratios = {task: math.exp(stand_in(logs[task].values())) for task in tasks}
            return [
                math.log(
                    sum(
                        weights[task][launch] * (math.exp(logs[task][launch]) if launch in logs[task] else ratios[task])
                        for task in tasks
                    )
                    / sum(weights[task][launch] for task in tasks)
                )
                for launch in sorted(launches)
            ]

        low, middle, high = (self.interval(totals(one)) for one in (min, median, max))
        if low is None or middle is None or high is None:
            return None
        if any(map(self.is_doubted, tasks)):
            return Interval(middle.ratio, *NOWHERE, False)
        return Interval(middle.ratio, low.low, high.high, middle.is_whole)

    def share(self, task: str, contestant: str) -> Interval | None:
        """See sources.Facts."""
        seconds = {of: self.seconds(of, contestant) for of in self._tasks_of(contestant)}
        if not seconds.get(task) or not all(seconds.values()):
            return None
        launches = set.intersection(*(set(one) for one in seconds.values()))
        totals = {launch: sum(one[launch] for one in seconds.values()) for launch in launches}
        figure = self.interval(math.log(seconds[task][launch] / totals[launch]) for launch in launches)
        return self._open(figure, [(task, contestant)], [])

    def _tasks_of(self, *contestants: str) -> list[str]:
        """The source's tasks, all of which a total needs."""
        return self.source.tasks

    def _open(
        self, figure: Interval | None, over: Sequence[tuple[str, str]], under: Sequence[tuple[str, str]]
    ) -> Interval | None:
        """An interval without the ends that a time too short takes away, or a doubt."""
        if figure is None:
            return None
        is_doubted = any(self.is_doubted(task) for task, _ in (*over, *under))
        low = 0.0 if is_doubted or any(self.is_short(*cell) for cell in over) else figure.low
        high = math.inf if is_doubted or any(self.is_short(*cell) for cell in under) else figure.high
        return figure._replace(low=low, high=high)


class Measured(Known):
    """A model in a run.

    Attributes:
        part: with the source's reference; rows that did not end well say nothing.
        beside: other models of the same kind of run, by the name that the source gives them.
    """

    def __init__(self, part: Part, source: Source) -> None:
        super().__init__(source)
        self.part = part
        self.beside: dict[str, Measured] = {}
        self._samples = samples_of(part.results)
        self._confidence = confidence_of(len(part.backends) - 1)

    @cached_property
    def names(self) -> dict[str, str]:
        """The backend that stands for each contestant: of several the first."""
        return {one.contestant: one.name for one in reversed(self.part.backends)}

    @cached_property
    def tasks(self) -> dict[str, str]:
        """The task that stands for each scenario: of several that with the source's counts, or else the first."""
        counts = self.source.counts
        tasks = sorted(
            self.part.results.tasks,
            key=lambda task: any(task.options.get(name) != n for name, n in counts.get(task.scenario, {}).items()),
        )
        return {task.scenario: task.name for task in reversed(tasks)}

    def row(self, scenario: str, contestant: str) -> Row | None:
        """The cell of a contestant."""
        return self.part.rows.get((self.tasks.get(scenario, ""), self.names.get(contestant, "")))

    def logs(self, task: str, one: str, other: str) -> Logs:
        """Paired in each round, see statistics.launch_ratios."""
        return launch_ratios(self._good(task, one), self._good(task, other), self._clock(task, other))

    def seconds(self, task: str, contestant: str) -> Mapping[int, float]:
        """The median over the rounds of each launch, times the source's counts over those of the run."""
        times: dict[int, list[float]] = {}
        for sample in self._good(task, contestant):
            spent = total_of(sample, self._clock(task, contestant)) / sample.repeats
            times.setdefault(sample.launch, []).append(spent * self._scale(task))
        return {launch: median(spent) for launch, spent in times.items() if any(spent)}

    def interval(self, logs: Iterable[float]) -> Interval | None:
        """Wide enough for all contestants of a task together."""
        return interval_over(logs, self._confidence)

    def is_short(self, task: str, contestant: str) -> bool:
        """Under statistics.SHORTEST_S."""
        clock = self._clock(task, contestant)
        totals = [total_of(sample, clock) for sample in self._good(task, contestant)]
        return bool(totals) and median(totals) < SHORTEST_S

    def is_doubted(self, task: str) -> bool:
        """A control differs from the reference."""
        return self.tasks.get(task) in self.part.doubts

    def between_tasks(self, task: str, other_task: str, contestant: str) -> Interval | None:
        """See sources.Facts."""
        one, other = self._good(task, contestant), self._good(other_task, contestant)
        items, other_items = _items(one), _items(other)
        if not items or not other_items:
            return None
        per_item = math.log(items / other_items)
        logs = launch_ratios(one, other, self._clock(task, contestant))
        figure = self.interval(log - per_item for log in logs.values())
        return self._open(figure, [(task, contestant)], [(other_task, contestant)])

    def between_models(self, model: str, task: str, contestant: str) -> Interval | None:
        """See sources.Facts; the two were not measured in turn, so that only their range is honest.

        Launches of one run are paired, for they followed each other; of two runs any with any.
        """
        other = self.beside.get(model)
        one, two = self._per_item(task, contestant), other._per_item(task, contestant) if other else {}
        if not one or not two:
            return None
        is_one_run = other is not None and other.part.results is self.part.results
        pairs = [one[here] / two[there] for here in one for there in two if here == there or not is_one_run]
        if not pairs:
            return None
        return Interval(median(pairs), min(pairs), max(pairs), min(len(one), len(two)) >= FEWEST_APART)

    def memory(self, one: str, other: str) -> Interval | None:
        """See sources.Facts."""
        known = [self._memory(name) for name in (one, other)]
        if any(memory is None or memory.status != "ok" for memory in known):
            return None
        peaks = [memory.peak_bytes for memory in known if memory and memory.peak_bytes]
        used = [memory.structure_bytes for memory in known if memory and memory.structure_bytes]
        if len(peaks) == 2:
            ratio, error = peaks[0] / peaks[1], 1 + MEMORY_ERROR
            return Interval(ratio, ratio / error, ratio * error, True)
        return _exact(used[0] / used[1]) if len(used) == 2 else None

    def grown(self, task: str, since: str, one: str, other: str) -> Interval | None:
        """See sources.Facts."""
        cells = [self._good(of, name) for of in (task, since) for name in (one, other)]
        items = _items(cells[0])
        used = [sample[0].structure_bytes for sample in cells if sample]
        known = [size for size in used if size is not None]
        if not items or len(known) < len(cells):
            return None
        return _exact((known[0] - known[1] - (known[2] - known[3])) / items)

    def item(self, task: str, contestant: str) -> Interval | None:
        """See sources.Facts."""
        figure = self.interval(map(math.log, self._per_item(task, contestant).values()))
        return self._open(figure, [(task, contestant)], [])

    def structure(self, contestant: str) -> Interval | None:
        """See sources.Facts."""
        memory = self._memory(contestant)
        is_known = memory is not None and memory.status == "ok" and memory.structure_bytes
        return _exact(memory.structure_bytes) if memory and is_known else None

    def size(self, things: str) -> Interval | None:
        """See sources.Facts."""
        number = self.part.model.size.get(things)
        return None if number is None else _exact(number)

    def _good(self, task: str, contestant: str) -> list[Sample]:
        """The samples of a cell that ended well."""
        row = self.row(task, contestant)
        if row is None or row.status != "ok":
            return []
        return [one for one in self._samples.get((row.model, row.task, row.backend), []) if one.status == "ok"]

    def _clock(self, task: str, contestant: str) -> str:
        row = self.row(task, contestant)
        return row.clock if row else "cpu"

    def _scale(self, scenario: str) -> float:
        """How many times as much the source did."""
        options = next((one.options for one in self.part.results.tasks if one.name == self.tasks[scenario]), {})
        counts = self.source.counts.get(scenario, {})
        return math.prod(count / options[name] for name, count in counts.items() if options.get(name))

    def _per_item(self, task: str, contestant: str) -> dict[int, float]:
        """Seconds by launch; empty where they are too short."""
        clock = self._clock(task, contestant)
        times: dict[int, list[float]] = {}
        for one in [] if self.is_short(task, contestant) else self._good(task, contestant):
            if one.items:
                times.setdefault(one.launch, []).append(total_of(one, clock) / one.items)
        return {launch: median(spent) for launch, spent in times.items()}

    def _memory(self, contestant: str) -> Memory | None:
        return memories(self.part).get(self.names.get(contestant, ""))


class Published(Known):
    """A model in the source's own tables."""

    def __init__(self, model: str, source: Source) -> None:
        super().__init__(source)
        self.model = model

    def logs(self, task: str, one: str, other: str) -> Logs:
        """As printed."""
        known = self.seconds(task, one), self.seconds(task, other)
        return {0: math.log(known[0][0] / known[1][0])} if all(known) else {}

    def seconds(self, task: str, contestant: str) -> Mapping[int, float]:
        """As printed."""
        for times in (self.source.times, self.source.spoken):
            if spent := times.get(self.model, {}).get(task, {}).get(contestant):
                return {0: spent}
        return {}

    def interval(self, logs: Iterable[float]) -> Interval | None:
        """A figure without one."""
        return next((_exact(math.exp(log)) for log in logs), None)

    def is_short(self, task: str, contestant: str) -> bool:
        """Nothing is: all is as printed."""
        return False

    def between_tasks(self, task: str, other_task: str, contestant: str) -> Interval | None:
        """See sources.Facts; it did as many items in both."""
        one, other = self.seconds(task, contestant), self.seconds(other_task, contestant)
        return _exact(one[0] / other[0]) if one and other else None

    def between_models(self, model: str, task: str, contestant: str) -> Interval | None:
        """See sources.Facts; its counts are the same on both."""
        one, other = self.seconds(task, contestant), Published(model, self.source).seconds(task, contestant)
        return _exact(one[0] / other[0]) if one and other else None

    def memory(self, one: str, other: str) -> Interval | None:
        """See sources.Facts."""
        known = self.source.memory.get(self.model, {})
        return _exact(known[one] / known[other]) if one in known and other in known else None

    def grown(self, task: str, since: str, one: str, other: str) -> Interval | None:
        """It measured nothing of the kind."""
        return None

    def item(self, task: str, contestant: str) -> Interval | None:
        """It did not count them."""
        return None

    def structure(self, contestant: str) -> Interval | None:
        """See sources.Facts."""
        size = self.source.structures.get(self.model, {}).get(contestant)
        return None if size is None else _exact(size)

    def size(self, things: str) -> Interval | None:
        """It is told in words, see sources.Source.models."""
        return None

    def _tasks_of(self, *contestants: str) -> list[str]:
        """Those for which it prints a figure of all of them."""
        return [task for task in self.source.tasks if all(self.seconds(task, one) for one in contestants)]


def _exact(figure: float) -> Interval:
    return Interval(figure, figure, figure, True)


def _items(samples: Sequence[Sample]) -> float | None:
    """Items of one run of the scenario."""
    return next((one.items / one.repeats for one in samples if one.items), None)
