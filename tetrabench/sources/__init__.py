"""What a family's source published, as data: its figures, and its findings as questions that any run can answer.

A family names its `Source` under the entry point group `tetrabench.sources`. Nothing here knows a contestant; what asks
and what answers meet in `Facts`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Protocol

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
class Finding:
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
    readings: Callable[[Facts], list[Reading]]
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
class Source:
    """A publication whose experiment a family repeats.

    Attributes:
        machine: what its figures were measured on, with the compiler.
        reference: the contestant that its figures are compared with here.
        contestants: title by name, in the order of its tables.
        figures: what shows a model's times in it, by model, such as "figure 10".
        counts: how much of each task it did, as options of our scenarios; a task that has none is not there.
        models: how large they were.
        times: of its tables; spoken: of its text alone.
        memory: kB by model and contestant: the most that a run held.
        structures: bytes of the structures, by model and contestant.
        tick_s: of the timer that took its times; 0 where it is nothing beside them.
        tables: those that are set anew, as it printed them; where it has none, its times and memory are.
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
    findings: Sequence[Finding]
    spoken: Times = field(default_factory=dict)
    structures: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    tick_s: float = 0.0
    tables: Sequence[Table] = ()
    notes: Sequence[str] = ()

    @property
    def tasks(self) -> list[str]:
        """The tasks of its tables, in their order."""
        return list(dict.fromkeys(task for tasks in self.times.values() for task in tasks))
