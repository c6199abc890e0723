"""How time grows with the size of the model, over a ladder of sizes: time ~ size ** exponent.

Each launch gives one exponent, fitted by least squares to ln(time) over ln(size); over launches their median counts,
with the interval of the sign test (see `statistics`); each holds with CONFIDENCE for itself, since none is compared with
another. 1 is linear; 0 is a task that does the same work whatever the size; a little over 1 is what a sweep shows that
leaves one cache after the other.
"""

import math
from collections.abc import Iterable, Sequence
from statistics import linear_regression, median
from typing import Any

import msgspec

from tetrabench.bench.pairs import CONFIDENCE
from tetrabench.bench.record import Results, Sample
from tetrabench.bench.statistics import SHORTEST_S, Row, interval_over, summary, total_of

FEWEST_SIZES = 5
WIDEST = 30.0
"""An exponent needs so many sizes at least, the largest so many times the smallest."""


class Growth(msgspec.Struct, frozen=True, kw_only=True):
    """Of a contestant in a task.

    Attributes:
        clock: "cpu" or "wall": which time was fitted.
        sizes: how many sizes were; smallest, largest: of these, in what the model counts first.
        exponent: None where nothing could be fitted, see `reason`.
        low, high: its interval, or the range of the launches where they are too few for one (`is_whole` is False).
        launches: how many gave an exponent.
    """

    task: str
    backend: str
    clock: str = "cpu"
    sizes: int = 0
    smallest: int = 0
    largest: int = 0
    exponent: float | None = None
    low: float | None = None
    high: float | None = None
    is_whole: bool = False
    launches: int = 0
    reason: str = ""


def growth(results: Results, rows: Iterable[Row] | None = None) -> list[Growth]:
    """For each task and contestant of a sweep over sizes, in the order of the run; empty where there is one size.

    Controls are left out. A cell that did not end well, or took less than SHORTEST_S, is no part of a fit.

    Args:
        results: a run.
        rows: its summary.
    """
    sizes = {model.name: next(iter(model.size.values())) for model in results.models if any(model.size.values())}
    if len(set(sizes.values())) < 2:
        return []
    samples: dict[tuple[str, str], list[Sample]] = {}
    for sample in results.samples:
        if sample.model in sizes:
            samples.setdefault((sample.task, sample.backend), []).append(sample)
    cells: dict[tuple[str, str], list[Row]] = {}
    for row in summary(results) if rows is None else rows:
        if not row.control and row.model in sizes:
            cells.setdefault((row.task, row.backend), []).append(row)
    return [
        _grown(cells[task.name, backend.name], samples[task.name, backend.name], sizes)
        for task in results.tasks
        for backend in results.backends
        if (task.name, backend.name) in cells
    ]


def _grown(rows: Sequence[Row], samples: Iterable[Sample], sizes: dict[str, int]) -> Growth:
    clock = "wall" if any(row.clock == "wall" for row in rows) else "cpu"  # one for all sizes
    seconds: dict[str, dict[int, list[float]]] = {}  # by model, by launch
    for sample in samples:
        total = total_of(sample, clock)
        if sample.status == "ok" and total >= SHORTEST_S:
            seconds.setdefault(sample.model, {}).setdefault(sample.launch, []).append(total / sample.repeats)
    used = [row.model for row in rows if row.status == "ok" and _is_long(row, seconds.get(row.model, {}))]
    known = sorted({sizes[model] for model in used})
    facts: dict[str, Any] = {"task": rows[0].task, "backend": rows[0].backend, "clock": clock, "sizes": len(known)}
    facts |= {"smallest": known[0], "largest": known[-1]} if known else {}
    points: dict[int, list[tuple[int, float]]] = {}  # by launch: size, seconds
    for model in used:
        for launch, times in seconds[model].items():
            points.setdefault(launch, []).append((sizes[model], median(times)))
    exponents = [_slope(launch) for launch in points.values() if _is_ladder(launch)]
    # interval_over takes logarithms: the factor by which time grows with an e-fold size
    factor = interval_over(exponents, CONFIDENCE)
    if factor is None:
        return Growth(**facts, reason=_why_not(rows, used, known))
    exponent, low, high = map(math.log, factor[:3])
    return Growth(**facts, exponent=exponent, low=low, high=high, is_whole=factor.is_whole, launches=len(exponents))


def _is_long(row: Row, seconds: dict[int, list[float]]) -> bool:
    """Whether all samples of a cell were long enough."""
    return sum(map(len, seconds.values())) == row.samples


def _is_ladder(points: Sequence[tuple[int, float]]) -> bool:
    """Whether the sizes carry a fit."""
    sizes = {size for size, _ in points}
    return len(sizes) >= FEWEST_SIZES and max(sizes) >= WIDEST * min(sizes)


def _slope(points: Sequence[tuple[int, float]]) -> float:
    """Of ln(time) over ln(size)."""
    logs = ([math.log(part) for part in parts] for parts in zip(*points, strict=True))
    return linear_regression(*logs).slope


def _why_not(rows: Sequence[Row], used: Sequence[str], sizes: Sequence[int]) -> str:
    """Why there is no exponent, in words."""
    needs = f"a fit needs {FEWEST_SIZES} sizes over a factor of {WIDEST:g}"
    has = f"{len(sizes)} over {sizes[-1] / sizes[0]:.3g}" if sizes else "none"
    lost = [
        f"{row.model} {row.verdict if row.status != 'ok' else 'too short'}" for row in rows if row.model not in used
    ]
    return f"{needs}, there are {has}" + (f" ({', '.join(lost)})" if lost else "")
