"""Two runs made at different times: the weaker way to see a regression; `gate` is the stronger one.

What is compared, cell by cell, is the ratio to the reference contestant of the same run. The times themselves are not:
on a shared machine they say more of the hour than of the code (docs/measuring.md shows it of other tools). A ratio
is paired with the same round of its own run, and so survives another hour; not another machine or another compiler,
which runs are therefore refused for. What no ratio shows is a change of the reference itself.

The launch is the unit, as in `statistics`. Whether the launches of the two runs differ is decided by a permutation
test of the difference of their medians (Good, Permutation Tests, 2000), over all cells by the method of Holm (1979);
whether they are the same by two one-sided tests against a difference of ALIKE (Schuirmann 1987).
"""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from statistics import median
from typing import Any

import msgspec

from tetrabench.bench.limits import Limits, MemoryChange, compare_memory, failures
from tetrabench.bench.pairs import CONFIDENCE
from tetrabench.bench.record import Results
from tetrabench.bench.statistics import (
    ALIKE,
    BAD,
    Cell,
    Row,
    differs,
    fewest_launches,
    launch_ratios,
    samples_of,
    summary,
)
from tetrabench.errors import NotComparableError

FACTS = ("processor", "architecture", "cores", "system", "python", "numpy", "numba", "llvmlite")
"""Of an environment: where one of them differs, so may any ratio."""
RESAMPLES = 20_000
"""Permutations that are tried where there are more; all of them up to two runs of 8 launches."""


class Change(msgspec.Struct, frozen=True, kw_only=True):
    """One cell in two runs.

    Attributes:
        verdict: "faster", "slower" (by more than ALIKE), "same" (within it), "inconclusive"; "gone" (not in the new run),
            "new" (only there), "no comparison" (the old one went wrong); or the one of `statistics.BAD` that the new
            cell ended with.
        old, new: ratios to the reference, and their intervals; old_launches, new_launches: of how many.
        ratio: new / old of these ratios.
        p: that launches alike differ so much by chance, for all cells together.
        is_regression: slower by more than the limit.
        reason: of a verdict that is none.
    """

    model: str
    task: str
    backend: str
    verdict: str
    clock: str = "cpu"
    old: tuple[float, float, float] | None = None
    new: tuple[float, float, float] | None = None
    old_launches: int = 0
    new_launches: int = 0
    ratio: float | None = None
    p: float | None = None
    is_regression: bool = False
    reason: str = ""


class Comparison(msgspec.Struct, frozen=True, kw_only=True):
    """What became of each cell; `failures` (of the new run's memory pass) and `notes` are sentences for people."""

    reference: str
    old_revision: str
    new_revision: str
    changes: list[Change]
    memory: list[MemoryChange]
    failures: list[str]
    notes: list[str]

    def exit_code(self, *, strict: bool = False) -> int:
        """3 a cell went wrong in the new run, 1 a regression, 4 (if strict) not all is known, else 0."""
        if self.failures or any(change.verdict in BAD for change in self.changes):
            return 3
        if any(change.is_regression for change in self.changes) or any(one.verdict == "larger" for one in self.memory):
            return 1
        return 4 if strict and any(one.verdict in ("inconclusive", "gone") for one in self.changes) else 0


def compare(old: Results, new: Results, limits: Limits | None = None) -> Comparison:
    """Compare two runs of the same plan.

    Raises:
        NotComparableError: they ran on different machines, models or versions, or did different things.
    """
    unlike = list(differences(old, new))
    if unlike:
        raise NotComparableError(f"not comparable, the runs differ in {'; '.join(unlike)}")
    before, after, limits = _Run(old), _Run(new), limits or Limits()
    if not before.rows.keys() & after.rows.keys():
        raise NotComparableError("not comparable: no cell is in both runs")
    changes = _changes(before, after, limits)
    weighed = {(one.model, one.backend): one for one in old.memory}
    return Comparison(
        reference=new.reference,
        old_revision=revision_of(old),
        new_revision=revision_of(new),
        changes=changes,
        memory=[
            change
            for one in new.memory
            if (was := weighed.get((one.model, one.backend)))
            for change in compare_memory(was, one, limits, one.backend)
        ],
        failures=failures(new.memory),
        notes=list(_notes(changes, old, new)),
    )


def differences(old: Results, new: Results) -> Iterator[str]:
    """What keeps two runs from being comparable, each in a few words."""
    for name in ("family", "reference", "profile"):
        if getattr(old, name) != getattr(new, name):
            yield _differ(name, getattr(old, name), getattr(new, name))
    for fact in FACTS:
        if old.environment.get(fact) != new.environment.get(fact):
            yield _differ(fact, old.environment.get(fact), new.environment.get(fact))
    models, tasks = {one.name: one for one in old.models}, {one.name: one for one in old.tasks}
    for model in new.models:
        was = models.get(model.name)
        if was and was.digest != model.digest:
            yield _differ(f"the file of the model {model.name}", was.digest, model.digest)
    for task in new.tasks:
        then = tasks.get(task.name)
        if then and (then.options, then.parallel) != (task.options, task.parallel):
            yield _differ(f"the counts of {task.name}", _counts(then.options), _counts(task.options))
    backends = {one.name: one.options for one in old.backends}
    for backend in new.backends:
        given = backends.get(backend.name, {})
        changed = [name for name, value in backend.options.items() if given.get(name, value) != value]
        if changed and not backend.control:
            before, after = ({name: one[name] for name in changed} for one in (given, backend.options))
            yield _differ(f"the options of {backend.name}", _counts(before), _counts(after))


def revision_of(results: Results) -> str:
    """The git revision that a run was made with, or the version where it was an installed one."""
    known = results.environment
    return str(known.get("revision") or f"version {known.get('tetrabench') or 'unknown'}")


def _differ(name: str, old: object, new: object) -> str:
    return f"{name} ({'unknown' if old is None else old}, then {'unknown' if new is None else new})"


def _counts(options: Mapping[str, int]) -> str:
    return ", ".join(f"{name} {count}" for name, count in options.items()) or "none"


class _Run:
    """A run with its rows.

    Attributes:
        rows: the cells that have a ratio to a reference, or should have.
        doubts: ratio of a control that differs, by model, task and reference: nothing next to it can be believed.
    """

    def __init__(self, results: Results) -> None:
        rows = summary(results)
        fewest = fewest_launches(sum(not one.control and one.against != one.name for one in results.backends))
        self.rows = {
            (row.model, row.task, row.backend): row for row in rows if not row.control and row.verdict != "reference"
        }
        self.doubts = {
            (row.model, row.task, row.against): row.ratio for row in rows if row.control and differs(row, fewest)
        }
        self._samples = samples_of(results)

    def launches(self, row: Row) -> list[float]:
        """ln(contestant / reference) of each launch."""
        ours, theirs = (self._samples.get((row.model, row.task, name), []) for name in (row.backend, row.against))
        return list(launch_ratios(ours, theirs, row.clock).values())


def _changes(old: _Run, new: _Run, limits: Limits) -> list[Change]:
    """All cells, in the order of the new run; what only the old one has comes last."""
    cells = list({**new.rows, **old.rows})
    changes = [_look(cell, old, new) for cell in cells]
    open_ones = [place for place, change in enumerate(changes) if not change.verdict]
    launches = {
        place: (old.launches(old.rows[cells[place]]), new.launches(new.rows[cells[place]])) for place in open_ones
    }
    adjusted = holm([difference_p(*launches[place]) for place in open_ones])
    for place, p in zip(open_ones, adjusted, strict=True):
        changes[place] = _decide(changes[place], *launches[place], p, limits, len(open_ones))
    return changes


def _look(cell: Cell, old: _Run, new: _Run) -> Change:
    """A cell with what each run says of it; a verdict only where that cannot be compared."""
    before, after = old.rows.get(cell), new.rows.get(cell)
    facts: dict[str, Any] = dict(zip(("model", "task", "backend"), cell, strict=True))
    if after is not None and after.verdict in BAD:
        return Change(**facts, verdict=after.verdict, reason=after.reason)
    if before is None:
        return Change(**facts, verdict="new", reason="not in the old run")
    if after is None or after.ratio is None:
        reason = (after.reason or after.verdict) if after else "not in the new run"
        return Change(**facts, verdict="gone" if before.ratio else "no comparison", reason=reason)
    if before.ratio is None:
        return Change(**facts, verdict="no comparison", reason=f"in the old run: {before.reason or before.verdict}")
    facts |= {
        "clock": after.clock,
        "old": (before.ratio, before.low, before.high),
        "new": (after.ratio, after.low, after.high),
        "old_launches": before.launches,
        "new_launches": after.launches,
        "ratio": after.ratio / before.ratio,
    }
    if before.clock != after.clock:
        return Change(
            **facts, verdict="inconclusive", reason="measured by CPU time in one run, by wall time in the other"
        )
    for name, run, row in (("old", old, before), ("new", new, after)):
        if row.verdict == "too short":
            return Change(**facts, verdict="inconclusive", reason=f"too short to rank in the {name} run")
        if control := run.doubts.get((row.model, row.task, row.against)):
            reason = f"in the {name} run a second copy of {row.against} took {control:.2f} times as long as it"
            return Change(**facts, verdict="inconclusive", reason=reason)
    return Change(**facts, verdict="")


def _decide(change: Change, old: Sequence[float], new: Sequence[float], p: float, limits: Limits, cells: int) -> Change:
    ratio = math.exp(median(new) - median(old))
    verdict, reason = "inconclusive", ""
    if p <= 1 - CONFIDENCE and not 1 / ALIKE <= ratio <= ALIKE:
        verdict = "slower" if ratio > 1 else "faster"
    elif is_alike(old, new):
        verdict = "same"
    elif least_p(len(old), len(new)) * cells > 1 - CONFIDENCE:
        reason = f"too few launches to tell anything in {cells} cells: {len(old)} in the old run, {len(new)} in the new"
    return msgspec.structs.replace(
        change,
        verdict=verdict,
        ratio=ratio,
        p=p,
        is_regression=verdict == "slower" and ratio > limits.of(change.clock),
        reason=reason,
    )


def difference_p(old: Sequence[float], new: Sequence[float]) -> float:
    """How likely medians differ so much, either way, where the two lists are alike: of the permutation test."""
    return _permutation_p(old, new, "two-sided")


def is_alike(old: Sequence[float], new: Sequence[float]) -> bool:
    """Whether the medians of these logarithms surely differ by less than that of ALIKE: two one-sided tests."""
    margin = math.log(ALIKE)
    if abs(median(new) - median(old)) >= margin:
        return False
    below = _permutation_p([one + margin for one in old], new, "less")
    return max(below, _permutation_p([one - margin for one in old], new, "greater")) <= 1 - CONFIDENCE


def least_p(old: int, new: int) -> float:
    """The smallest that the two-sided test can give for so many launches."""
    return 2 / math.comb(old + new, old)


def _permutation_p(old: Sequence[float], new: Sequence[float], alternative: str) -> float:
    import numpy as np
    from scipy.stats import permutation_test

    if min(len(old), len(new)) < 2:  # one launch says nothing about how launches differ
        return 1.0
    done = permutation_test(
        (np.asarray(new), np.asarray(old)),
        lambda x, y, axis: np.median(x, axis=axis) - np.median(y, axis=axis),
        alternative=alternative,
        n_resamples=RESAMPLES,
        vectorized=True,
        random_state=0,  # the same two files always compare alike
    )
    return float(done.pvalue)


def holm(values: Sequence[float]) -> list[float]:
    """p values as they count among so many tests: error rates then hold for all of them together (Holm 1979)."""
    adjusted, least = [0.0] * len(values), 0.0
    for rank, place in enumerate(sorted(range(len(values)), key=values.__getitem__)):
        least = max(least, min(1.0, (len(values) - rank) * values[place]))
        adjusted[place] = least
    return adjusted


def _notes(changes: Iterable[Change], old: Results, new: Results) -> Iterator[str]:
    yield (
        "The weaker comparison: ratios to the reference of two runs made at different times. It cannot see a change of "
        "the reference itself. `tetrabench gate` runs both versions in turns, and is to be believed where they disagree."
    )
    moved: dict[tuple[str, str], list[str]] = {}
    for change in changes:
        moved.setdefault((change.model, change.task), []).append(change.verdict)
    for (model, task), verdicts in moved.items():
        if len(verdicts) > 1 and set(verdicts) in ({"faster"}, {"slower"}):
            other = "slower" if verdicts[0] == "faster" else "faster"
            yield f"{task} on {model}: all became {verdicts[0]}, as if the reference {new.reference} had become {other}."
    for name, results in (("old", old), ("new", new)):
        if results.ended:
            yield f"The {name} run ended early ({results.ended}): launches are missing."
