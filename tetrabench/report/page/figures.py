"""The numbers behind each chart of a page, as flat rows: what is drawn and what stands in the table beside it."""

from collections.abc import Sequence
from statistics import median
from typing import Any

from tetrabench.bench.record import Sample
from tetrabench.bench.statistics import Row, counted_of, samples_of, total_of
from tetrabench.report.cells import interval_of, ratio_of, word_of
from tetrabench.report.memory import MEMORY_ERROR, memories, memory_of
from tetrabench.report.page.subjects import ABSOLUTE, OWN, Subject
from tetrabench.report.units import duration, percent

Datum = dict[str, Any]

UNSEEN = 0.05
"""Bytes an item: a buffer with less has no place in a chart, only in the table."""
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
        own = [row for row in subject.rows() if not row.control]
        spans = _spans(subject, own) if ABSOLUTE in bases else {}
        for base in bases:
            rows = {(row.task, row.backend): row for row in subject.rows(OWN if base == ABSOLUTE else base)}
            controls = {row.task: row for row in rows.values() if row.control}
            for mine in own:
                row = rows.get((mine.task, mine.backend))
                if base == ABSOLUTE:
                    datum = _absolute(mine, spans.get((mine.task, mine.backend)))
                elif row is None:  # another run's backend
                    datum = _datum(None, None, None, text=f"no {base}", span="", sure=False)
                else:
                    datum = _compared(row, controls.get(row.task))
                facts = {"model": subject.label, "backend": subject.name_of(mine.backend), "base": base}
                said = row.verdict if row is not None and base != ABSOLUTE else ""
                tasks.setdefault(mine.task, []).append(facts | datum | {"verdict": said})
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


def _absolute(row: Row, span: tuple[float, float] | None) -> Datum:
    """Seconds of one run, and the range of the medians of the launches."""
    if row.seconds is None or span is None:
        return _datum(None, None, None, text=word_of(row), span="", sure=False)
    low, high = span
    words = f"{duration(low)} to {duration(high)}" if low < high else ""
    return _datum(row.seconds, low, high, text=duration(row.seconds), span=words, sure=True)


def _spans(subject: Subject, rows: Sequence[Row]) -> dict[tuple[str, str], tuple[float, float]]:
    """Seconds of one run in the quickest and in the slowest launch, by task and backend."""
    cells = samples_of(subject.run.results)
    spans = {}
    for row in rows:
        launches: dict[int, list[float]] = {}
        for sample in cells[subject.model.name, row.task, row.backend]:
            if sample.status == "ok":
                launches.setdefault(sample.launch, []).append(total_of(sample, row.clock) / sample.repeats)
        if launches:
            middles = [median(seconds) for seconds in launches.values()]
            spans[row.task, row.backend] = min(middles), max(middles)
    return spans


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
    copy of the reference had: so much differs where nothing does. Cells that went wrong, or are too short to say anything,
    are left out, and so are tasks with one round.
    """
    tasks: dict[str, list[Datum]] = {}
    for subject in subjects:
        cells = samples_of(subject.run.results)
        rounds = subject.run.results.effort.rounds
        for row in subject.rows():
            if row.control or row.status != "ok" or row.verdict == "too short":
                continue
            places = (subject.model.name, row.task)
            reference = cells.get((*places, row.against), [])
            second = next(
                (one for one in subject.run.results.backends if one.control and one.against == row.against), None
            )
            noise = _multiples(cells.get((*places, second.name), []) if second else [], reference, row.clock).values()
            for (launch, round), ratio in _multiples(cells[(*places, row.backend)], reference, row.clock).items():
                tasks.setdefault(row.task, []).append(
                    {
                        "model": subject.label,
                        "backend": subject.name_of(row.backend),
                        "place": launch * rounds + round + 1,
                        "ratio": ratio,
                        "quiet": min(noise, default=None),
                        "loud": max(noise, default=None),
                    }
                )
    return {task: rows for task, rows in tasks.items() if len({row["place"] for row in rows}) > 1}


def _multiples(samples: Sequence[Sample], reference: Sequence[Sample], clock: str) -> dict[tuple[int, int], float]:
    """(launch, round) -> multiple of the reference's time, counted as the ratios of the tables are."""
    theirs = {(one.launch, one.group, one.round): one for one in reference if one.status == "ok"}
    pairs = [(one, theirs.get((one.launch, one.group, one.round))) for one in samples if one.status == "ok"]
    return {
        (one.launch, one.round): counted_of(one, clock) / counted_of(other, clock)
        for one, other in pairs
        if other is not None
    }


def trade(subject: Subject) -> tuple[str, list[Datum]]:
    """Time against memory on a model: the kind of memory, and each backend in each task.

    `front`: no other is shown to be better in one of both and not worse in the other; `least`: none is so by the medians,
    whatever their intervals say: the line that a chart draws.
    """
    kind = next((one for one in ("peak", "retained", "structure") if _sizes(subject, one)), "")
    sizes = _sizes(subject, kind)
    cells = [row for row in subject.rows() if not row.control and row.seconds is not None and row.backend in sizes]
    beside = {
        (row.task, row.backend, rival): row.verdict
        for rival in sizes
        for row in subject.rows(rival)
        if row.backend in sizes
    }
    return kind, [
        {
            "model": subject.label,
            "task": row.task,
            "backend": subject.name_of(row.backend),
            "bytes": sizes[row.backend],
            "seconds": row.seconds,
            "front": not any(
                _beats(sizes[rival], sizes[row.backend], beside.get((row.task, row.backend, rival), ""))
                for rival in sizes
            ),
            "least": not any(
                _beats(sizes[other.backend], sizes[row.backend], _by_medians(row, other))
                for other in cells
                if other.task == row.task
            ),
            "text": duration(row.seconds or 0.0),
        }
        for row in cells
    ]


def _beats(rival: float, mine: float, verdict: str) -> bool:
    """Whether a rival of so many bytes, beside which one of `mine` is "slower" or "same", is better."""
    if rival * (1 + MEMORY_ERROR) < mine:
        return verdict in ("slower", "same")
    return rival <= mine * (1 + MEMORY_ERROR) and verdict == "slower"  # both are 0 where the model is tiny


def _by_medians(row: Row, other: Row) -> str:
    """What one is beside another where intervals do not count."""
    mine, theirs = row.seconds or 0.0, other.seconds or 0.0
    return "slower" if mine > theirs else "faster" if mine < theirs else "same"


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
