"""What a family's source published, as data: its figures, and its findings as questions that any run can answer.

A family names its `Source` under the entry point group `tetrabench.sources`. Nothing here knows a contestant; what asks
and what answers meet in `Facts`, or where the source drew curves in `Curves`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Generic, Protocol, TypeVar

if TYPE_CHECKING:  # the registry imports this module, and the statistics come with all of bench
    from tetrabench.bench.statistics import Interval

Times = Mapping[str, Mapping[str, Mapping[str, float | None]]]
"""Seconds by model, task and contestant; None where nothing was printed."""


class Facts(Protocol):
    """What is known of one model: what a run measured, or what the source printed. None is what is not known.

    Times are compared item by item, and within a launch. An interval that is too narrow to be an honest one says so
    (`is_whole`); an end of it is 0 or infinite where a time is too short to be measured.
    """

    def ratio(self, task: str, one: str, other: str) -> Interval | None:
        """The time of one contestant in a task, as a multiple of another's."""

    def change(self, task: str, other_task: str, one: str, other: str) -> Interval | None:
        """`ratio` in one task, as a multiple of `ratio` in another."""

    def between_tasks(self, task: str, other_task: str, contestant: str) -> Interval | None:
        """The time of an item in one task, as a multiple of that in another."""

    def between_models(self, model: str, task: str, contestant: str) -> Interval | None:
        """The time of an item on this model, as a multiple of that on another of the source's."""

    def total(self, one: str, other: str) -> Interval | None:
        """The time of one contestant in all tasks of the source with its counts, as a multiple of another's."""

    def share(self, task: str, contestant: str) -> Interval | None:
        """The part of a contestant's total that a task takes."""

    def memory(self, one: str, other: str) -> Interval | None:
        """The peak of a contestant's memory, as a multiple of another's; of the structures where nobody knows the peak."""

    def grown(self, task: str, since: str, one: str, other: str) -> Interval | None:
        """Bytes that one structure has more than another for each item of a task, less what it had more after `since`."""

    def item(self, task: str, contestant: str) -> Interval | None:
        """Seconds of an item of a task; of the source's, which did not count them, None."""

    def structure(self, contestant: str) -> Interval | None:
        """Bytes of a contestant's fresh structure."""

    def size(self, things: str) -> Interval | None:
        """How many of these the model has, such as "points"; of the source's, which is lost, None."""


class Curves(Protocol):
    """What runs say of the source's curves as one contestant draws them. None is what is not known.

    Curves are known by their names, points by their places on the axis below. Intervals are as those of `Facts`.
    """

    @property
    def contestant(self) -> str:
        """Whose curves these are."""

    def places(self, curve: str) -> list[float]:
        """Where it was measured, ascending; empty where nobody did."""

    def least(self, curve: str, among: Sequence[float]) -> float | None:
        """That of some places where it takes least."""

    def most(self, curve: str, among: Sequence[float]) -> float | None:
        """That of some places where it takes most."""

    def between(self, curve: str, place: float | None, other: float | None) -> Interval | None:
        """The time at one place, as a multiple of that at another."""

    def grown(self, curve: str, count: str = "") -> Interval | None:
        """The time of a step, or a count, in the last tenth of a run as a multiple of that in the first."""

    def beside(self, curve: str, other: str, count: str = "") -> Interval | None:
        """The time of a whole run, or a count at its end, as a multiple of that of another curve's run."""


Asked = TypeVar("Asked")
"""What a finding is asked of: `Facts` or `Curves`."""


@dataclass(frozen=True)
class Reading:
    """One figure that a finding rests on, and the limits that it lies between if the finding holds.

    Attributes:
        about: what the figure is, such as "v4 / v3y in alfa".
        words: a sentence with a gap for the figure, such as "v4 takes {} as long as v3y in alfa".
        figure: None where it is not known.
        unit: stands behind the figure: "x" of a multiple, "%" of a share.
        printed: what the source's text says that it is, where its tables do not.
    """

    about: str
    words: str
    figure: Interval | None
    least: float = 0.0
    most: float = math.inf
    unit: str = "x"
    printed: float | None = None


@dataclass(frozen=True)
class Finding(Generic[Asked]):
    """What the source says that it found.

    Attributes:
        name: short and lasting, to find it by.
        claim: in a sentence; section: of the source, where it says so.
        asked: when the claim is taken to hold: what `readings` asks, in words.
        readings: the figures that it rests on; it holds if all lie between their limits.
        remark: where the source's own figures say something else, or today's are no like for like.
        models: that it speaks of; all of the source's where it names none.
    """

    name: str
    claim: str
    section: str
    asked: str
    readings: Callable[[Asked], list[Reading]]
    remark: str = ""
    models: tuple[str, ...] = ()


@dataclass(frozen=True)
class Line:
    """A row of a table of the source.

    Attributes:
        words: what it is about, one for each word of the table's head.
        printed: what the source printed, by model, as it is to be shown.
        today: the same figure of a model, by its name; None where it is not known.
    """

    words: tuple[str, ...]
    printed: Mapping[str, str]
    today: Callable[[str, Facts], Interval | None]


@dataclass(frozen=True)
class Table:
    """A table of the source, to be set anew with today's figures beside its own, model by model.

    Attributes:
        name: what the source calls it, such as "table 3"; caption: what it shows, and in which unit.
        head: words above the columns of words.
        spell: a figure of today as it is to be shown.
        lines: its rows, for the contestants of the source and, behind them, those of ours that took part, by name.
        notes: what is to be known of its figures, a sentence each.
    """

    name: str
    caption: str
    head: tuple[str, ...]
    spell: Callable[[float], str]
    lines: Callable[[Sequence[str]], list[Line]]
    notes: Sequence[str] = ()


@dataclass(frozen=True)
class Curve:
    """A time over something that runs vary: a line for each contestant.

    Attributes:
        name: what the source calls it, such as "figure 8".
        scenario: what is timed.
        over: what is varied, as a run names it: what the size of a model counts, or an option; "step" is along the run,
            see protocols.Answer.series.
        options: of contestants that have them; who chose others is no part of it.
        title: what it has that others of its figure have not.
    """

    name: str
    scenario: str
    over: str
    options: Mapping[str, int] = field(default_factory=dict)
    title: str = ""


@dataclass(frozen=True)
class Figure:
    """A figure of the source to be drawn anew, a panel for each curve.

    Times are those of a scenario with the source's counts; along the run those of a step.

    Attributes:
        name: for all of its curves, such as "figures 12 to 15"; caption: what it shows.
        across, up: words at the axes, units included; up_s: the unit of times, seconds.
        count: what a second row of panels shows, by its name in the series; "" where there is none.
        is_log: whether the axis below is logarithmic.
        said: from where to where the source says that something is; said_words: what.
        notes: what is to be known of it, a sentence each.
    """

    name: str
    caption: str
    curves: Sequence[Curve]
    across: str
    up: str
    up_s: float = 1.0
    count: str = ""
    is_log: bool = False
    said: tuple[float, float] | None = None
    said_words: str = ""
    notes: Sequence[str] = ()


@dataclass(frozen=True)
class Source:
    """A publication whose experiment a family repeats.

    Attributes:
        machine: what its figures were measured on, with the compiler.
        reference: the contestant that its figures are compared with here.
        contestants: title by name, in the order of its tables; of a source with curves, what each of them stands for.
        figures: what shows a model's times in it, by model, such as "figure 10".
        counts: how much of each task it did, as options of our scenarios; a task that has none is not there.
        models: how large they were.
        times: of its tables; spoken: of its text alone.
        memory: kB by model and contestant: the most that a run held.
        structures: bytes of the structures, by model and contestant.
        tick_s: of the timer that took its times; 0 where it is nothing beside them.
        tables: those that are set anew, as it printed them; where it has none, its times and memory are.
        drawn: its figures that show curves; curve_findings: what it found in them, asked of each of its contestants.
        notes: what is to be known of its figures, a sentence each.
    """

    title: str
    author: str
    place: str
    year: int
    machine: str
    reference: str
    contestants: Mapping[str, str]
    figures: Mapping[str, str]
    models: Mapping[str, str]
    counts: Mapping[str, Mapping[str, int]]
    times: Times
    memory: Mapping[str, Mapping[str, int]]
    findings: Sequence[Finding[Facts]]
    spoken: Times = field(default_factory=dict)
    structures: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    tick_s: float = 0.0
    tables: Sequence[Table] = ()
    drawn: Sequence[Figure] = ()
    curve_findings: Sequence[Finding[Curves]] = ()
    notes: Sequence[str] = ()

    @property
    def tasks(self) -> list[str]:
        """The tasks of its tables, in their order."""
        return list(dict.fromkeys(task for tasks in self.times.values() for task in tasks))
