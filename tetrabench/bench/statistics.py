"""What samples say: ratios to the reference from the same round, an interval over launches, a verdict for each cell.

The launch is the unit: within one, the placement of processes on cores and in memory puts all rounds of a contestant
off by the same few percent, so that rounds are no independent samples. A launch counts as one number, the median of
ln(contestant / reference) over its rounds; the interval over launches is that of the sign test (see `pairs`), wide
enough to hold for all contestants of a task together (Bonferroni).
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from statistics import median
from typing import Any, NamedTuple

import msgspec

from tetrabench.bench.pairs import CONFIDENCE, fewest_for, interval_rank
from tetrabench.bench.record import Backend, Launch, Results, Sample

ALIKE = 1.05
"""An interval within this, either way, means the same."""
BEYOND = 1.01
"""An interval must exclude 1 by so much: nobody asks about less, and two processes may differ by it for good."""
CLEAR = 3.0
"""Where launches are too few for an interval, only ratios that are all beyond this rank: see docs/measuring.md."""
SHORTEST_S = 0.005
"""A sample shorter than this says nothing: it counts as so long."""
PARALLEL = 1.1
"""A sample whose process took so many times the CPU time of its thread was parallel, whatever it claims."""

INEXACT = "inexact"
"""The verdict of a wrong answer by a contestant that is known to give such: it ranks nowhere, and nothing went wrong."""

_ENDS = {  # status -> verdict; the worst first
    "wrong-result": "wrong",
    "unstable": "unstable",
    "crash": "crashed",
    "oom": "out of memory",
    "timeout": "timed out",
    "error": "failed",
    "unsupported": "unsupported",
    "skipped": "skipped",
}
BAD = frozenset(verdict for status, verdict in _ENDS.items() if status not in ("unsupported", "skipped"))
"""The verdicts of cells that went wrong."""


class Row(msgspec.Struct, frozen=True, kw_only=True):
    """One cell: a contestant in a task on a model. Figures are None where it did not end well.

    Attributes:
        against: the backend that the ratio refers to.
        status: the worst of its samples' (see record.Sample); reason: of that one, or of an inconclusive verdict.
        verdict: "reference"; "control"; "faster", "slower", "same" (all of the interval within ALIKE) or "inconclusive";
            "about" (launches are too few for an interval; the ratio is no more than a hint); "too short" (to rank);
            "no reference" (which did not end well itself); "wrong", "unstable", "crashed", "out of memory",
            "timed out", "failed", "unsupported", "skipped"; "inexact" (wrong, as this contestant is known to be). Only
            faster and slower rank.
        launches, samples: how many ended well.
        clock: "cpu" or "wall": which time the figures are.
        seconds: median over samples of the time of one run of the scenario.
        ratio: median over launches; low, high: its interval, or with the verdict "about" the range of the launches.
        is_bound: the ratio is only known to be `low` at least (or, if faster, `high` at most).
        ns_per_item: time for one item of the work, nanoseconds.
        gb_per_s: least traffic with memory that the work needs, over the time, 1e9 bytes a second.
        share_of_limit: the same over what the core could do: the triad bandwidth of the same launches.
        spread: half the width of the interval as a share of the ratio.
    """

    model: str
    task: str
    backend: str
    against: str
    status: str
    verdict: str
    control: bool = False
    extension: bool = False
    launches: int = 0
    samples: int = 0
    clock: str = "cpu"
    seconds: float | None = None
    ratio: float | None = None
    low: float | None = None
    high: float | None = None
    is_bound: bool = False
    ns_per_item: float | None = None
    gb_per_s: float | None = None
    share_of_limit: float | None = None
    reason: str = ""

    @property
    def spread(self) -> float | None:
        """Half the width of the interval, as a share of the ratio."""
        if self.ratio is None or self.low is None or self.high is None:
            return None
        return (self.high - self.low) / 2 / self.ratio


class Interval(NamedTuple):
    """A ratio, and the ends of its interval; `is_whole` says that it holds with the confidence asked for."""

    ratio: float
    low: float
    high: float
    is_whole: bool


Place = tuple[int, int, int]  # launch, group, round
Cell = tuple[str, str, str]  # model, task, backend


def samples_of(results: Results) -> dict[Cell, list[Sample]]:
    """The samples of each cell, in their order."""
    cells: dict[Cell, list[Sample]] = {}
    for sample in results.samples:
        cells.setdefault((sample.model, sample.task, sample.backend), []).append(sample)
    return cells


def summary(results: Results) -> list[Row]:
    """A row for each cell: models and tasks in the order of the run, contestants in that of the plan."""
    cells: dict[tuple[str, str], dict[str, list[Sample]]] = {}
    for sample in results.samples:
        cells.setdefault((sample.model, sample.task), {}).setdefault(sample.backend, []).append(sample)
    return [
        row
        for model in results.models
        for task in results.tasks
        if (cell := cells.get((model.name, task.name)))
        for row in _rows(cell, results.backends, task.parallel, [x for x in results.launches if x.model == model.name])
    ]


def rebased(results: Results, base: str) -> Results:
    """The same run with every contestant compared with `base`, by the name of a backend, instead of its reference.

    Ratios come from the same rounds as before. The controls are left out but for base's own: see `summary_against`.
    """
    backends = [one for one in results.backends if not one.control or one.against == base]
    moved = [msgspec.structs.replace(one, against=base) for one in backends]
    return msgspec.structs.replace(results, backends=moved, reference=base)


def summary_against(results: Results, base: str) -> list[Row]:
    """The rows of `summary` with another reference.

    Where a control casts doubt on a contestant or on `base`, beside the reference that they had, it does so here too.
    """
    references = {one.name: one.against for one in results.backends}
    contestants = len(contestants_of(results.backends))
    doubts = {
        (row.model, row.task, row.against): doubt
        for row in summary(results)
        if row.control and (doubt := doubt_of(row, contestants))
    }
    return [
        _unclear(row, next((doubts[place] for place in places if place in doubts), ""))
        for row in summary(rebased(results, base))
        for places in [[(row.model, row.task, references[name]) for name in (row.backend, base)]]
    ]


def _rows(
    cells: Mapping[str, list[Sample]], backends: Sequence[Backend], parallel: bool, launches: Sequence[Launch]
) -> list[Row]:
    """The rows of one task on one model."""
    clock = "wall" if parallel or any(map(_ran_parallel, cells.values())) else "cpu"
    contestants = len(contestants_of(backends))
    confidence = confidence_of(contestants)
    rows = []
    for backend in backends:
        if samples := cells.get(backend.name):
            reference = cells.get(backend.against, [])
            rows.append(_row(samples, reference, backend, clock, confidence, launches))
    doubts = {row.against: doubt_of(row, contestants) for row in rows if row.control}
    return [_unclear(row, doubts.get(row.against, "")) for row in rows]


def contestants_of(backends: Sequence[Backend]) -> list[Backend]:
    """Those that are compared with a reference."""
    return [one for one in backends if not one.control and one.against != one.name]


def confidence_of(contestants: int) -> float:
    """What each interval must hold with, so that all those of a task hold with CONFIDENCE."""
    return 1 - (1 - CONFIDENCE) / max(1, contestants)


def fewest_launches(contestants: int) -> int:
    """Launches that an interval needs where so many are compared with the reference."""
    return fewest_for(confidence_of(contestants))


def differs(row: Row, fewest: int) -> bool:
    """Whether a control's interval excludes 1, where there are the `fewest` launches for one."""
    if row.ratio is None or row.low is None or row.high is None:
        return False
    return verdict_of(Interval(row.ratio, row.low, row.high, row.launches >= fewest)) in ("faster", "slower")


def doubt_of(control: Row, contestants: int) -> str:
    """Why nothing can be ranked beside a second copy of the reference where so many are: it differs. "" where it does not."""
    if not differs(control, fewest_launches(contestants)):
        return ""
    return f"the control, a second copy of {control.against}, took {control.ratio:.2f} times as long as it"


def _unclear(row: Row, reason: str) -> Row:
    """A row that ranks nothing, where there is a reason for that."""
    if not reason or row.verdict not in ("faster", "slower", "same"):
        return row
    return msgspec.structs.replace(row, verdict="inconclusive", is_bound=False, reason=reason)


def _row(
    samples: list[Sample],
    reference: list[Sample],
    backend: Backend,
    clock: str,
    confidence: float,
    launches: Sequence[Launch],
) -> Row:
    facts: dict[str, Any] = {
        "model": samples[0].model,
        "task": samples[0].task,
        "backend": backend.name,
        "against": backend.against,
        "control": backend.control,
        "extension": backend.extension,
        "clock": clock,
    }
    good = [sample for sample in samples if sample.status == "ok"]
    facts |= {"launches": len({sample.launch for sample in good}), "samples": len(good)}
    for status, verdict in _ENDS.items():
        bad = next((sample for sample in samples if sample.status == status), None)
        if bad is not None and status == "wrong-result" and not backend.exact:
            return Row(**facts, status=status, verdict=INEXACT, reason=f"known to give wrong answers; {bad.reason}")
        if bad is not None:
            return Row(**facts, status=status, verdict=verdict, reason=bad.reason)
    seconds = median(_seconds(sample, clock) for sample in samples)
    interval = interval_over(launch_ratios(samples, reference, clock).values(), confidence)
    verdict = _verdict(samples, reference, backend, clock, interval)
    work = [sample.items / sample.repeats for sample in samples if sample.items]
    least = [sample.least_bytes / sample.repeats for sample in samples if sample.least_bytes]
    gb_per_s = median(least) / seconds / 1e9 if least and seconds else None
    triad = [launch.yardsticks.triad_gb_s for launch in launches if launch.yardsticks]
    shown = interval if backend.name != backend.against else None
    return Row(
        **facts,
        status="ok",
        verdict=verdict,
        seconds=seconds,
        ratio=shown.ratio if shown else None,
        low=shown.low if shown else None,
        high=shown.high if shown else None,
        is_bound=verdict in ("faster", "slower") and interval is not None and not interval.is_whole,
        ns_per_item=seconds / median(work) * 1e9 if work else None,
        gb_per_s=gb_per_s,
        share_of_limit=gb_per_s / median(triad) if gb_per_s and triad else None,
    )


def launch_ratios(samples: Iterable[Sample], reference: Iterable[Sample], clock: str) -> dict[int, float]:
    """For each launch the median of ln(contestant / reference) over its rounds; empty if the reference did not end well."""
    reference = list(reference)
    if any(sample.status != "ok" for sample in reference):
        return {}
    theirs = {_place(sample): counted_of(sample, clock) for sample in reference}
    rounds: dict[int, list[float]] = {}
    for sample in samples:
        if sample.status == "ok" and _place(sample) in theirs:
            ratio = math.log(counted_of(sample, clock) / theirs[_place(sample)])
            rounds.setdefault(sample.launch, []).append(ratio)
    return {launch: median(ratios) for launch, ratios in rounds.items()}


def interval_over(ratios: Iterable[float], confidence: float) -> Interval | None:
    """The median of logarithms of ratios, and its sign-test interval; their range where they are too few for one."""
    ordered = sorted(ratios)
    if not ordered:
        return None
    is_whole = len(ordered) >= fewest_for(confidence)
    rank = interval_rank(len(ordered), confidence) if is_whole else 0
    ratio, low, high = map(math.exp, (median(ordered), ordered[rank], ordered[-1 - rank]))
    return Interval(ratio, low, high, is_whole)


def verdict_of(interval: Interval) -> str:
    """What an interval says: "faster", "slower", "same", "inconclusive", "about"."""
    limit = BEYOND if interval.is_whole else CLEAR
    if interval.is_whole and interval.low >= 1 / ALIKE and interval.high <= ALIKE:
        return "same"
    if interval.low > limit:
        return "slower"
    if interval.high < 1 / limit:
        return "faster"
    return "inconclusive" if interval.is_whole else "about"


def _verdict(
    samples: list[Sample], reference: list[Sample], backend: Backend, clock: str, interval: Interval | None
) -> str:
    if backend.name == backend.against:
        return "reference"
    if interval is None:
        return "no reference"
    verdict = verdict_of(interval)
    if verdict not in ("faster", "slower") and not (_is_long(samples, clock) and _is_long(reference, clock)):
        return "too short"
    return "control" if backend.control else verdict


def _place(sample: Sample) -> Place:
    return sample.launch, sample.group, sample.round


def total_of(sample: Sample, clock: str) -> float:
    """All repeats of a sample, seconds."""
    return (sample.wall_s if clock == "wall" else sample.cpu_s) or 0.0


def _seconds(sample: Sample, clock: str) -> float:
    """One run of the scenario, seconds."""
    return total_of(sample, clock) / sample.repeats


def counted_of(sample: Sample, clock: str) -> float:
    """One run of the scenario, where a sample counts as SHORTEST_S at least."""
    return max(total_of(sample, clock), SHORTEST_S) / sample.repeats


def _is_long(samples: list[Sample], clock: str) -> bool:
    return median(total_of(sample, clock) for sample in samples) >= SHORTEST_S


def _ran_parallel(samples: list[Sample]) -> bool:
    """Whether several threads worked for a contestant."""
    shares = [
        sample.process_cpu_s / sample.cpu_s
        for sample in samples
        if sample.status == "ok" and sample.cpu_s and sample.process_cpu_s and sample.process_cpu_s >= SHORTEST_S
    ]
    return bool(shares) and median(shares) > PARALLEL
