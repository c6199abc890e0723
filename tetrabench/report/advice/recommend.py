"""Which contestant for which work: all that ended well, ranked by their totals of a mix, and what the choice rests on.

First is the one with the least total, by the median over launches. Every other is compared with it launch by launch
(see `totals`), not by looking whether their intervals relative to the reference overlap: what disturbed a launch has disturbed
both.
"""

from collections.abc import Iterable, Mapping, Sequence

import msgspec

from tetrabench.bench.record import Memory, Results
from tetrabench.errors import InputError
from tetrabench.protocols import Workload
from tetrabench.report.advice.flips import Outlook, look
from tetrabench.report.advice.mix import Amount, make_mix, usual_amount
from tetrabench.report.advice.totals import MATTERS, Multiple, Totals
from tetrabench.report.cells import MISSING
from tetrabench.report.memory import memories
from tetrabench.report.parts import Part, make_parts
from tetrabench.report.units import digits


class Loss(msgspec.Struct, frozen=True, kw_only=True):
    """The task of a mix in which a contestant loses most seconds against the first, and its time there beside it."""

    task: str
    beside: Multiple


class Ranked(msgspec.Struct, frozen=True, kw_only=True):
    """A contestant in its place.

    Attributes:
        beside: its total as a multiple of the first's; None of the first.
        seconds: of the mix, as this machine took them, median over launches.
        shares: of its total, by task.
        too_short: tasks that are too short to be known, and count like the reference's.
        loss: None where it loses nothing.
        structure_bytes, peak_bytes: of its structure on this model, and at most while it was built; None where it is not
            known.
        fits: how many items the largest model has that fits into the limit of memory, as far as memory grows like the
            model; None where there is no limit, or nothing is known.
    """

    backend: str
    beside: Multiple | None
    seconds: float
    shares: dict[str, float]
    too_short: list[str] = []
    loss: Loss | None = None
    structure_bytes: int | None = None
    peak_bytes: int | None = None
    fits: float | None = None

    @property
    def held_bytes(self) -> int | None:
        """What it needs at most, as far as it is known."""
        return self.peak_bytes or self.structure_bytes


class LeftOut(msgspec.Struct, frozen=True, kw_only=True):
    """A contestant that is not ranked, and why."""

    backend: str
    reason: str


class Recommendation(msgspec.Struct, frozen=True, kw_only=True):
    """Of one mix on one model.

    Attributes:
        size: of the model; item: what its size is counted in.
        workload: the name of the mix, "" where a person typed it; about: a line about that.
        reference: the backend whose ratios the totals are made of.
        launches: how many they are from; has_intervals: whether that is enough for intervals.
        best: the first, and who cannot be told from it; only hints where `has_intervals` is False. Nobody where nothing is
            known.
        ranked: by their totals; left_out: those that are not.
        outlooks: on each task of the run, those of the mix first; none where there is no choice.
        amounts: one of each task of the run, in what it is counted in here.
        doubts: tasks of the mix on which nothing may be ranked, with the reason.
        is_ranked: False where such a task matters to the first: then nothing is known.
        memory_limit: bytes, None where there is none.
        has_peaks: whether the run weighed anybody.
    """

    model: str
    size: dict[str, int]
    item: str
    workload: str
    about: str
    mix: list[Amount]
    reference: str
    launches: int
    has_intervals: bool
    best: list[str]
    ranked: list[Ranked]
    left_out: list[LeftOut]
    outlooks: list[Outlook]
    amounts: dict[str, Amount]
    doubts: dict[str, str]
    is_ranked: bool
    memory_limit: int | None
    has_peaks: bool


def recommend(
    results: Results,
    wanted: Mapping[str, float],
    *,
    workload: str = "",
    about: str = "",
    memory_limit: int | None = None,
) -> list[Recommendation]:
    """A recommendation for each model of a run.

    Args:
        results: a run.
        wanted: how much of what, by the names that `mix.make_mix` knows.
        workload: a name for that; about: a line about it.
        memory_limit: bytes that a contestant may need at most.

    Raises:
        InputError: the run measured no times, has no reference, or not what the mix asks for.
    """
    return [
        recommend_part(part, make_mix(wanted, part), workload=workload, about=about, memory_limit=memory_limit)
        for part in parts_of(results)
    ]


def recommend_usual(
    results: Results, workloads: Iterable[Workload], *, memory_limit: int | None = None
) -> list[Recommendation]:
    """A recommendation for each of these workloads, whose scenarios the run has all, on each model; see `recommend`."""
    return [
        one
        for usual in workloads
        for one in recommend(results, usual.mix, workload=usual.name, about=usual.title, memory_limit=memory_limit)
    ]


def parts_of(results: Results) -> list[Part]:
    """What there is to recommend for: the models that were measured.

    Raises:
        InputError: the run measured no times, its reference took no part, or there are several.
    """
    if results.profile == "check":
        raise InputError("these results hold answers only, no times: make some with `tetrabench run -o FILE.json`")
    references = {one.against for one in results.backends} or {results.reference}
    if len(references) > 1:
        raise InputError("these results have several references, as a gate's do: make some with `tetrabench run`")
    if references - {backend.name for backend in results.backends}:
        who = ", ".join(references)
        raise InputError(f"these results are without their reference, {who}: run again, with it among the backends")
    if not results.samples:
        raise InputError("these results hold no samples: run again with a larger --budget")
    return [part for part in make_parts(results) if part.rows]


def unmeasured(workload: Workload, results: Results) -> list[str]:
    """Scenarios of a workload that are not in a run."""
    known = {task.scenario for task in results.tasks} | {task.name for task in results.tasks}
    names = (
        name if name in known else name.rpartition(".")[0] or name for name, number in workload.mix.items() if number
    )
    return [name for name in dict.fromkeys(names) if name not in known]


def recommend_part(
    part: Part, mix: Sequence[Amount], *, workload: str = "", about: str = "", memory_limit: int | None = None
) -> Recommendation:
    """A recommendation for one model; see `recommend`."""
    reasons = {backend.name: _why_not(part, backend.name, mix, memory_limit) for backend in part.backends}
    names = [name for name, reason in reasons.items() if not reason]
    totals = Totals(part, {amount.task: amount.weight for amount in mix}, names)
    names.sort(key=totals.seconds)
    held = memories(part)
    ranked = [_rank(totals, name, names[0], held.get(name), memory_limit) for name in names]
    unclear = [one.backend for one in ranked if one.beside and one.beside.verdict != "slower"]
    tied = [one.backend for one in ranked if one.beside and one.beside.verdict == "cannot tell"]
    is_ranked = bool(names) and not _is_doubtful(ranked[0], totals)
    others = [task.name for task in part.results.tasks if task.name not in totals.weights]
    return Recommendation(
        model=part.model.name,
        size=part.model.size,
        item=part.item,
        workload=workload,
        about=about,
        mix=list(mix),
        reference=part.reference,
        launches=len(totals.launches),
        has_intervals=totals.is_whole,
        best=[*names[:1], *unclear] if is_ranked else [],
        ranked=ranked,
        left_out=[LeftOut(backend=name, reason=reason) for name, reason in reasons.items() if reason],
        outlooks=[look(totals, names[0], names[1:], tied, task) for task in [*totals.weights, *others] if names[1:]],
        amounts={task.name: usual_amount(task, part) for task in part.results.tasks} | {one.task: one for one in mix},
        doubts={task: reason for task, reason in totals.doubts.items() if task in totals.weights},
        is_ranked=is_ranked,
        memory_limit=memory_limit,
        has_peaks=any(memory.peak_bytes for memory in held.values()),
    )


def _rank(totals: Totals, name: str, first: str, memory: Memory | None, limit: int | None) -> Ranked:
    structure, peak = _held(memory)
    held = peak or structure
    items = next(iter(totals.part.model.size.values()), 0)
    return Ranked(
        backend=name,
        beside=totals.compare(name, first) if name != first else None,
        seconds=totals.seconds(name),
        shares=totals.shares(name),
        too_short=[task for task in totals.weights if (cell := totals.timed(task, name)) and cell.is_short],
        loss=_loss(totals, name, first),
        structure_bytes=structure,
        peak_bytes=peak,
        fits=limit * items / held if limit and held and items else None,
    )


def _loss(totals: Totals, name: str, first: str) -> Loss | None:
    mine, theirs = totals.middles(name), totals.middles(first)
    task = max(mine, key=lambda task: mine[task] - theirs[task])
    if mine[task] <= theirs[task]:
        return None
    return Loss(task=task, beside=totals.in_task(task).compare(name, first))


def _is_doubtful(one: Ranked, totals: Totals) -> bool:
    return sum(share for task, share in one.shares.items() if task in totals.doubts) > MATTERS


def _why_not(part: Part, name: str, mix: Iterable[Amount], limit: int | None) -> str:
    """Why a contestant cannot be ranked; "" if it can."""
    unfit = filter(None, (_why_unfit(part, name, amount.task) for amount in mix))
    return next(unfit, "") or (_why_large(part, name, limit) if limit is not None else "")


def _why_unfit(part: Part, name: str, task: str) -> str:
    """It did not end well in a task of the mix, or has nothing there to be compared with."""
    row, base = part.rows.get((task, name)), part.rows.get((task, part.reference))
    if row is None:
        return f"{MISSING} in {task}"
    if row.status != "ok":
        return f"{row.verdict} in {task}" + (f": {' '.join(row.reason.split())}" if row.reason else "")
    if base is None or base.status != "ok":
        return f"{part.reference}, which it is compared with, is {base.verdict if base else MISSING} in {task}"
    return f"no round of {task} together with {part.reference}" if row.verdict == "no reference" else ""


def _why_large(part: Part, name: str, limit: int) -> str:
    """It needs more memory than is allowed, or could not even be built in a process of its own."""
    memory = memories(part).get(name)
    if memory is not None and memory.status != "ok":
        return f"its memory is not known, for the memory pass ended with {memory.status}"
    structure, peak = _held(memory)
    held = peak or structure or 0
    what = "at its peak" if peak else "for its structure"
    return f"it needs {digits(held / 1e6)} MB {what}, the limit is {digits(limit / 1e6)} MB" if held > limit else ""


def _held(memory: Memory | None) -> tuple[int | None, int | None]:
    """Bytes of the structure, and the peak."""
    if memory is None or memory.status != "ok":
        return None, None
    return memory.structure_bytes or None, memory.peak_bytes
