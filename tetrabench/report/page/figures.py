"""The numbers behind each chart of a page, as flat rows: what is drawn and what stands in the table beside it."""

from collections.abc import Iterator, Sequence
from statistics import median
from typing import Any

from tetrabench.bench.record import Sample
from tetrabench.bench.statistics import Row, samples_of, total_of
from tetrabench.report.cells import interval_of, ratio_of, word_of
from tetrabench.report.memory import memories, memory_of
from tetrabench.report.page.subjects import ABSOLUTE, OWN, Subject
from tetrabench.report.units import duration, percent

Datum = dict[str, Any]

ALIKE = 1.01
"""Memory of the same structure in two processes differs by so much."""
_SURE = ("faster", "slower", "same", "reference")
_SHOWN = (*_SURE, "about", "inconclusive")


def times(subjects: Sequence[Subject], bases: Sequence[str]) -> dict[str, list[Datum]]:
    """By task: each backend on each model, compared with each base.

    `value`, `low` and `high` are ratios, or with the base ABSOLUTE seconds of one run and the range of the launches; None
    where no figure may stand, but `word`. `sure`: it ranks. `edge`: as far as the mark reaches. `text` and `span` say the
    figure and its interval.
    """
    tasks: dict[str, list[Datum]] = {}
    for subject in subjects:
        for base in bases:
            rows = subject.rows(OWN if base == ABSOLUTE else base)
            controls = {row.task: row for row in rows if row.control}
            for row in rows:
                if not row.control:
                    datum = _absolute(subject, row) if base == ABSOLUTE else _compared(row, controls.get(row.task))
                    facts = {"model": subject.label, "backend": subject.name_of(row.backend), "base": base}
                    tasks.setdefault(row.task, []).append(facts | datum | {"verdict": row.verdict})
    return tasks


def _compared(row: Row, control: Row | None) -> Datum:
    """A ratio; that of a reference is 1, and reaches as far as its second copy does."""
    if row.verdict == "reference":
        low, high = (control.low, control.high) if control else (None, None)
        return _datum(1.0, low, high, text="1", span="", sure=True)
    if row.ratio is None or row.verdict not in _SHOWN:
        return _datum(None, None, None, text=word_of(row), span="", sure=False)
    low, high = (None, None) if row.is_bound else (row.low, row.high)
    return _datum(row.ratio, low, high, text=ratio_of(row), span=interval_of(row), sure=row.verdict in _SURE)


def _absolute(subject: Subject, row: Row) -> Datum:
    """Seconds of one run, and the range of the medians of the launches."""
    if row.seconds is None:
        return _datum(None, None, None, text=word_of(row), span="", sure=False)
    launches: dict[int, list[float]] = {}
    for sample in subject.run.results.samples:
        if (sample.model, sample.task, sample.backend) == (row.model, row.task, row.backend) and sample.status == "ok":
            launches.setdefault(sample.launch, []).append(total_of(sample, row.clock) / sample.repeats)
    middles = [median(seconds) for seconds in launches.values()]
    low, high = min(middles), max(middles)
    span = f"{duration(low)} to {duration(high)}" if low < high else ""
    return _datum(row.seconds, low, high, text=duration(row.seconds), span=span, sure=True)


def _datum(value: float | None, low: float | None, high: float | None, *, text: str, span: str, sure: bool) -> Datum:
    return {
        "value": value,
        "low": low,
        "high": high,
        "edge": None if value is None else max(value, high or value),
        "text": text if value is not None else "",
        "word": "" if value is not None else text,
        "span": span,
        "sure": sure,
    }


def samples(subjects: Sequence[Subject]) -> dict[str, list[Datum]]:
    """By task: each sample as a multiple of the reference's of the same round, over rounds.

    `place` counts rounds through all launches; `quiet` and `loud` are the least and the largest multiple that the second
    copy of the reference had: so much differs where nothing does. Tasks with one round have none.
    """
    tasks: dict[str, list[Datum]] = {}
    for subject in subjects:
        cells = samples_of(subject.run.results)
        rounds = subject.run.results.effort.rounds
        clocks = {row.task: row.clock for row in subject.rows()}
        for task, clock in clocks.items():
            by_name = {
                name: found for (model, of, name), found in cells.items() if (model, of) == (subject.model.name, task)
            }
            ratios = {
                one.name: dict(_ratios(by_name, one.name, one.against, clock)) for one in subject.run.results.backends
            }
            controls = {one.against: ratios[one.name].values() for one in subject.run.results.backends if one.control}
            for one in subject.backends:
                noise = controls.get(one.against, ())
                for (launch, round), (ratio, seconds) in ratios[one.name].items():
                    datum = {
                        "model": subject.label,
                        "backend": subject.name_of(one.name),
                        "place": launch * rounds + round + 1,
                        "ratio": ratio,
                        "seconds": seconds,
                        "quiet": min((r for r, _ in noise), default=None),
                        "loud": max((r for r, _ in noise), default=None),
                    }
                    tasks.setdefault(task, []).append(datum)
    return {task: rows for task, rows in tasks.items() if len({row["place"] for row in rows}) > 1}


def _ratios(
    samples: dict[str, list[Sample]], name: str, against: str, clock: str
) -> Iterator[tuple[tuple[int, int], tuple[float, float]]]:
    """(launch, round) -> (multiple of the reference, seconds), of samples that ended well."""

    def seconds(sample: Sample) -> float:
        return total_of(sample, clock) / sample.repeats

    theirs = {(one.launch, one.group, one.round): one for one in samples.get(against, []) if one.status == "ok"}
    for one in samples.get(name, []):
        other = theirs.get((one.launch, one.group, one.round))
        if one.status == "ok" and other is not None and seconds(other) > 0 and seconds(one) > 0:
            yield (one.launch, one.round), (seconds(one) / seconds(other), seconds(one))


def trade(subjects: Sequence[Subject]) -> tuple[str, list[Datum]]:
    """Time against memory: the kind of memory, and each backend in each task, `front` where none is better in both."""
    kinds = [kind for kind in ("peak", "retained", "structure") if any(_sizes(subject, kind) for subject in subjects)]
    kind = kinds[0] if kinds else ""
    found = []
    for subject in subjects:
        sizes = _sizes(subject, kind)
        cells = [
            (row, sizes[row.backend], row.seconds)
            for row in subject.rows()
            if not row.control and row.seconds and row.backend in sizes
        ]
        for row, size, seconds in cells:
            rivals = [(other / size, time / seconds) for rival, other, time in cells if rival.task == row.task]
            better = [more for more, longer in rivals if _beats(more, longer)]
            found.append(
                {
                    "model": subject.label,
                    "task": row.task,
                    "backend": subject.name_of(row.backend),
                    "bytes": size,
                    "seconds": seconds,
                    "front": not better,
                    "text": duration(seconds),
                }
            )
    return kind, found


def _beats(size: float, time: float) -> bool:
    """Whether a rival with such ratios is better in one and not worse in the other; equal memory differs by ALIKE."""
    return (size < ALIKE and time < 1) or (size < 1 / ALIKE and time <= 1)


def _sizes(subject: Subject, kind: str) -> dict[str, float]:
    """Bytes an item by backend, of those for which there is a figure."""
    known = [memory_of(part).get(kind, {}) for part in subject.parts]
    return {name: size for sizes in known for name, size in sizes.items() if isinstance(size, float)}


def growth(subjects: Sequence[Subject]) -> list[Datum]:
    """Time of an item over the size of the model, where a run has several sizes."""
    runs = {id(subject.run): subject.run.results for subject in subjects}
    ladders = {key for key, run in runs.items() if len({next(iter(one.size.values()), 0) for one in run.models}) > 1}
    return [
        {
            "run": subject.run.name,
            "task": row.task,
            "backend": subject.name_of(row.backend),
            "size": next(iter(subject.model.size.values())),
            "ns": row.ns_per_item,
        }
        for subject in subjects
        if id(subject.run) in ladders and any(subject.model.size.values())
        for row in subject.rows()
        if not row.control and row.ns_per_item
    ]


def fields(subjects: Sequence[Subject]) -> list[Datum]:
    """Bytes an item of each buffer of the fresh structure."""
    found = []
    for subject in subjects:
        items = next(iter(subject.model.size.values()), 0)
        for part in subject.parts:
            for name, memory in memories(part).items():
                if memory.status == "ok" and items:
                    found += [
                        {
                            "model": subject.label,
                            "backend": subject.name_of(name),
                            "field": field,
                            "bytes": used / items,
                            "reserved": reserved / items,
                        }
                        for field, (used, reserved) in memory.structure.items()
                    ]
    return found


def limits(subjects: Sequence[Subject]) -> list[Datum]:
    """Share of the machine's bandwidth that the least traffic of each task took."""
    return [
        {
            "model": subject.label,
            "task": row.task,
            "backend": subject.name_of(row.backend),
            "share": row.share_of_limit,
            "gb_per_s": row.gb_per_s,
            "text": percent(row.share_of_limit),
        }
        for subject in subjects
        for row in subject.rows()
        if not row.control and row.share_of_limit is not None
    ]
