"""What the order of memory costs: the same contestant on one mesh in another numbering, over its time in the natural one.

In a sweep over numberings each launch runs all of them, one after the other. A pair is of the same launch, so that what
disturbs a machine for longer than a launch cancels; it is not of the same round, as a contestant and its reference are
(see `statistics`): minutes lie between the two, and other processes. Only large differences may be believed: what ranks
here is beyond LARGE.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from statistics import median
from typing import Any

import msgspec

from tetrabench.bench.record import Model, Results, Sample
from tetrabench.bench.statistics import (
    CLEAR,
    SHORTEST_S,
    Interval,
    Row,
    confidence_of,
    interval_over,
    samples_of,
    summary,
    total_of,
)

NATURAL = "natural"
LARGE = 1.25
"""An interval must exclude 1 by so much, for its pairs are minutes apart: from one launch to the next, a time changes by
a tenth as often as not."""


class Renumbered(msgspec.Struct, frozen=True, kw_only=True):
    """A contestant in a task on a model in another numbering, beside itself on the model in its natural one.

    Attributes:
        model: the natural one; numbering: of the other.
        verdict: "slower", "faster" (all of the interval is beyond LARGE, or where launches are too few for one, all of
            them beyond statistics.CLEAR), "same" (within LARGE), "inconclusive", "about" (too few launches: a hint);
            "too short"; "missing"; or what either of both ended with, see statistics.Row.
        clock: "cpu" or "wall": which time was compared.
        ratio: time in the numbering over that in the natural one, median over launches; None where no figure may stand.
        low, high: its interval, which holds for all numberings of the contestant together; or the range of the launches
            where they are too few for one (`is_whole` is False).
        launches: how many gave a pair.
        reason: why one of both did not end well.
    """

    model: str
    task: str
    backend: str
    numbering: str
    verdict: str
    clock: str = "cpu"
    ratio: float | None = None
    low: float | None = None
    high: float | None = None
    is_whole: bool = False
    launches: int = 0
    reason: str = ""

    @property
    def is_bound(self) -> bool:
        """Whether the ratio is only known to be `low` at least (or, if faster, `high` at most)."""
        return self.verdict in ("slower", "faster") and not self.is_whole


class Spread(msgspec.Struct, frozen=True, kw_only=True):
    """How far contestants lie apart in one numbering, or numberings with one contestant, in a task on a model.

    Attributes:
        between: "backends" or "numberings"; within: the numbering, or the backend, that they have in common.
        fastest, slowest: of those that may be ranked; ratio: of their times, 1 where nothing may. Where launches are too
            few for intervals it is at least so much.
    """

    model: str
    task: str
    between: str
    within: str
    ratio: float
    fastest: str
    slowest: str


def numberings_of(results: Results) -> dict[str, dict[str, str]]:
    """For each model that ran in several numberings the name it ran under in each, the natural one first.

    In another numbering a model is named after the natural one: "nozzle", "nozzle hilbert" (see record.Model).
    """
    found: dict[str, dict[str, str]] = {}
    for natural in results.models:
        others = [other for other in results.models if _is_renumbered(other, natural)]
        if others:
            found[natural.name] = {NATURAL: natural.name} | {
                other.name.rpartition(" ")[2]: other.name for other in others
            }
    return found


def _is_renumbered(other: Model, natural: Model) -> bool:
    return other.name.rpartition(" ")[0] == natural.name and other.size == natural.size


def renumberings(results: Results, rows: Iterable[Row] | None = None) -> list[Renumbered]:
    """For each task, contestant and numbering but the natural one, in the order of the run; empty without a sweep.

    Controls are left out.

    Args:
        results: a run.
        rows: its summary.
    """
    known = {(row.model, row.task, row.backend): row for row in (summary(results) if rows is None else rows)}
    samples = samples_of(results)
    found = []
    for model, names in numberings_of(results).items():
        confidence = confidence_of(len(names) - 1)
        for task in results.tasks:
            for backend in results.backends:
                cells = {numbering: (name, task.name, backend.name) for numbering, name in names.items()}
                if backend.control or not any(cell in known for cell in cells.values()):
                    continue
                for numbering in list(names)[1:]:
                    pair = [cells[numbering], cells[NATURAL]]
                    facts = {"model": model, "task": task.name, "backend": backend.name, "numbering": numbering}
                    sides = [known.get(cell) for cell in pair]
                    found.append(_compared(facts, sides, [samples.get(cell, []) for cell in pair], confidence))
    return found


def spreads(results: Results, rows: Iterable[Row] | None = None) -> list[Spread]:
    """What a layout makes of a time, and what a numbering does: for each task and numbering, and each task and contestant.

    Contestants are compared with the reference of the run, from the same rounds; numberings with the natural one.

    Args:
        results: a run.
        rows: its summary.
    """
    rows = [row for row in (summary(results) if rows is None else rows) if not row.control]
    renumbered = renumberings(results, rows)
    found = []
    for model, names in numberings_of(results).items():
        for task in results.tasks:
            for numbering, name in names.items():
                mine = [row for row in rows if (row.model, row.task) == (name, task.name)]
                factors = {row.backend: factor for row in mine if (factor := _factor(row))}
                if factors:
                    found.append(_spread(factors, model=model, task=task.name, between="backends", within=numbering))
            for backend in dict.fromkeys(one.backend for one in renumbered if one.task == task.name):
                cell = (model, task.name, backend)
                others = [one for one in renumbered if (one.model, one.task, one.backend) == cell]
                factors = {NATURAL: 1.0} | {one.numbering: factor for one in others if (factor := _factor(one))}
                found.append(_spread(factors, model=model, task=task.name, between="numberings", within=backend))
    return found


def _spread(factors: Mapping[str, float], **facts: str) -> Spread:
    fastest, slowest = min(factors, key=factors.__getitem__), max(factors, key=factors.__getitem__)
    return Spread(**facts, ratio=factors[slowest] / factors[fastest], fastest=fastest, slowest=slowest)


def _factor(one: Row | Renumbered) -> float | None:
    """The ratio as far as it is known; None where it ranks nothing."""
    if one.verdict == "reference":
        return 1.0
    if one.verdict == "slower":
        return one.low if one.is_bound else one.ratio
    if one.verdict == "faster":
        return one.high if one.is_bound else one.ratio
    return None


def _compared(
    facts: dict[str, Any], rows: Sequence[Row | None], samples: Sequence[Sequence[Sample]], confidence: float
) -> Renumbered:
    """One row; `rows` and `samples` are of the numbering, then of the natural one."""
    ended = [row for row in rows if row is not None]
    if len(ended) < len(rows):
        return Renumbered(**facts, verdict="missing")
    clock = "wall" if any(row.clock == "wall" for row in ended) else "cpu"  # one for both
    bad = next((row for row in ended if row.status != "ok"), None)
    if bad is not None:
        return Renumbered(**facts, clock=clock, verdict=bad.verdict, reason=f"{bad.model}: {bad.reason}")
    if any(median(total_of(one, clock) for one in cell) < SHORTEST_S for cell in samples):
        return Renumbered(**facts, clock=clock, verdict="too short")
    ours, natural = (_launch_seconds(cell, clock) for cell in samples)
    ratios = [math.log(ours[launch] / natural[launch]) for launch in ours.keys() & natural.keys()]
    interval = interval_over(ratios, confidence)
    if interval is None:
        return Renumbered(**facts, clock=clock, verdict="missing")
    figures = interval._asdict()
    return Renumbered(**facts, clock=clock, verdict=_verdict(interval), launches=len(ratios), **figures)


def _launch_seconds(samples: Iterable[Sample], clock: str) -> dict[int, float]:
    """Of one run of the scenario in each launch, the median over its rounds."""
    seconds: dict[int, list[float]] = {}
    for sample in samples:
        seconds.setdefault(sample.launch, []).append(max(total_of(sample, clock), SHORTEST_S) / sample.repeats)
    return {launch: median(times) for launch, times in seconds.items()}


def _verdict(interval: Interval) -> str:
    """As statistics.verdict_of, with limits for pairs that are minutes apart."""
    if interval.is_whole and interval.low >= 1 / LARGE and interval.high <= LARGE:
        return "same"
    limit = LARGE if interval.is_whole else CLEAR
    if interval.low > limit:
        return "slower"
    if interval.high < 1 / limit:
        return "faster"
    return "inconclusive" if interval.is_whole else "about"
