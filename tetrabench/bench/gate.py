"""Is head slower than base? Both versions of the code in one ring, each contestant against itself.

All workers are alive together and take turns, so that whatever disturbs the machine disturbs both versions. The gate
fails only where all of this holds:

- the interval of the ratio head / base excludes 1;
- the ratio is above the limit;
- at least AGREEING of the launches say so too: each for itself shows more than half of the limit;
- a second run of the cells in question, in another order of turns, says all of this again.

A second copy of each base runs along as its control; nothing is believed next to one that differs from its base. Memory
hardly varies: its limits are strict, and nothing is run again. Where head gives another answer than base, its time
means nothing, and the answer is what is said.
"""

import math
import shlex
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import msgspec

from tetrabench.bench.benchmark import run_benchmark
from tetrabench.bench.catalogue import Guide
from tetrabench.bench.checkouts import WORKING_TREE, Checkout, check_out, find_commit, find_repository, guide_of
from tetrabench.bench.limits import Limits, MemoryChange, compare_memory, failures
from tetrabench.bench.messages import Described
from tetrabench.bench.plan import Plan, control_of
from tetrabench.bench.progress import Progress, Silence
from tetrabench.bench.record import Backend, Results, Sample
from tetrabench.bench.statistics import BAD, BEYOND, Row, fewest_launches, launch_ratios, samples_of, summary
from tetrabench.errors import InputError, NotComparableError, TetrabenchError

SCHEMA = "tetrabench-gate/1"
AGREEING = 0.75
BASE, HEAD = "base", "head"


class Measurement(msgspec.Struct, frozen=True):
    """How many times as long head took: the median over launches, its interval, the share of launches that agree."""

    ratio: float
    low: float
    high: float
    agreeing: float
    launches: int


class Finding(msgspec.Struct, frozen=True, kw_only=True):
    """One contestant in one task on one model.

    Attributes:
        contestant: its name; in a sweep over its options followed by them.
        outcome: "passed" (not slower by more than the limit), "suspect" (slower, and still to be confirmed), "failed"
            (that was confirmed), "inconclusive", "broken" (head crashed, or gives another answer), "not compared".
        verdict: "faster", "slower", "same", "not slower" (by more than the limit; no more is known), "inconclusive";
            "another answer"; or of `statistics`: how a cell went wrong.
        limit: ratio that is still allowed.
        first, second: what was measured, and what the confirming run measured.
        reason: of a verdict without figures.
    """

    model: str
    task: str
    contestant: str
    outcome: str
    verdict: str
    clock: str = "cpu"
    limit: float
    first: Measurement | None = None
    second: Measurement | None = None
    reason: str = ""

    @property
    def cell(self) -> tuple[str, str, str]:
        """Which one it is."""
        return self.model, self.task, self.contestant


class Gate(msgspec.Struct, frozen=True, kw_only=True):
    """What the gate found; `failures` of the memory pass and `notes` are sentences for people. `ended`: see `Results`."""

    schema: str = SCHEMA
    base: str
    head: str
    command: str
    limits: Limits
    findings: list[Finding]
    memory: list[MemoryChange]
    failures: list[str]
    notes: list[str]
    seconds: float
    ended: str = ""

    def exit_code(self, *, strict: bool = False) -> int:
        """130 interrupted, 3 broken, 1 a regression, 5 nothing was compared, 4 (if strict) inconclusive, else 0."""
        outcomes = {finding.outcome for finding in self.findings}
        if self.ended == "interrupted":
            return 130
        if self.failures or "broken" in outcomes:
            return 3
        if "failed" in outcomes or any(change.verdict == "larger" for change in self.memory):
            return 1
        if outcomes <= {"not compared"}:
            return 5
        return 4 if strict and outcomes & {"inconclusive", "suspect"} else 0


def run_gate(
    repository: Path,
    base: str,
    head: str | None,
    make: Callable[[Guide], Plan],
    limits: Limits,
    *,
    progress: Progress | None = None,
    output: Path | None = None,
) -> Gate:
    """Install both versions, run them, run once more what seems slower, and say what was found.

    Args:
        repository: the git checkout of tetrabench, or of a plug-in of it.
        base: the revision to be compared with.
        head: the revision in question; None: the working tree as it is.
        make: the plan for one version, by what head has to offer; its contestants are then taken twice.
        limits: what is allowed.
        progress: is told what happens.
        output: where to save the samples; those of the confirming run lie beside, `confirming_output`.

    Raises:
        InputError: no such repository or revision; names that head does not have; too few launches.
        NotComparableError: a version cannot be installed, is too old, or has nothing in common with the other.
        MemoryRefusedError: the model is too large for the memory that there is.
    """
    progress = progress or Silence()
    top = find_repository(repository)
    for revision in filter(None, (base, head)):
        find_commit(top, revision)
    with TemporaryDirectory(prefix="tetrabench-gate-") as folder:
        versions = []
        for place, (name, wanted) in enumerate([(BASE, base), (HEAD, head)]):
            progress.step("installing", f"{name}, {wanted or WORKING_TREE}", place, 2, None)
            versions.append(check_out(top, wanted, Path(folder)))
        old, new = versions
        with guide_of(new) as guide:
            plan = make(guide)
        described = _described(old, plan.family)
        plan, notes = choose(plan, described)
        plan, more = spare_base(seat_both(plan, old, new), described)
        plan, notes = replace(plan, command=command_of(plan, base, head)), notes + more
        first = run_benchmark(plan, progress=progress, output=output)
        suspects = suspects_of(judge(first, limits))
        second = None
        if suspects and first.ended != "interrupted":
            where = confirming_output(output) if output else None
            second = run_benchmark(narrow(plan, suspects), progress=progress, output=where)
    return make_gate(old, new, limits, first, second, notes)


def _described(base: Checkout, family: str) -> Described:
    """What base has to offer.

    Raises:
        NotComparableError: it cannot say.
    """
    try:
        with guide_of(base) as guide:
            return guide.describe(family)
    except TetrabenchError as error:
        raise NotComparableError(f"base {base.title} cannot be used: {error}") from error


def confirming_output(output: Path) -> Path:
    """Where the samples of a confirming run are saved."""
    return output.with_stem(f"{output.stem}-confirming")


def choose(plan: Plan, base: Described) -> tuple[Plan, list[str]]:
    """Head's plan without what base has not; and notes on what that is.

    Raises:
        NotComparableError: nothing is left.
    """
    contestants, scenarios = ({one.name for one in table} for table in (base.contestants, base.scenarios))
    backends = tuple(one for one in plan.backends if one.contestant in contestants)
    tasks = tuple(one for one in plan.tasks if one.scenario in scenarios)
    missing = [one.contestant for one in plan.backends if one.contestant not in contestants and not one.control]
    missing += dict.fromkeys(one.scenario for one in plan.tasks if one.scenario not in scenarios)
    if not backends or not tasks:
        raise NotComparableError(f"nothing to compare: base does not have {', '.join(missing)}")
    notes = [f"Not compared, since base does not have it: {', '.join(missing)}."] if missing else []
    return replace(plan, backends=backends, tasks=tasks), notes


def seat_both(plan: Plan, base: Checkout, head: Checkout) -> Plan:
    """A plan's contestants twice, head against base, with a control of each base.

    Raises:
        InputError: the launches are too few for an interval.
    """
    backends: list[Backend] = []
    contestants = [backend for backend in plan.backends if not backend.control]
    for one in contestants:
        ours = msgspec.structs.replace(one, name=f"{one.name}@{BASE}", against=f"{one.name}@{BASE}", checkout=BASE)
        theirs = msgspec.structs.replace(one, name=f"{one.name}@{HEAD}", against=ours.name, checkout=HEAD)
        backends += [ours, theirs, control_of(ours)]
    fewest = fewest_launches(len(contestants))
    if plan.effort.launches < fewest:
        raise InputError(
            f"{plan.effort.launches} launches are too few: {len(contestants)} backends need {fewest} at least"
        )
    return replace(
        plan,
        backends=tuple(backends),
        reference=backends[0].name,
        checkouts={BASE: base.folder, HEAD: head.folder},
    )


def spare_base(plan: Plan, base: Described) -> tuple[Plan, list[str]]:
    """The plan whose base is told of no options that it does not know; and a note on what these are."""
    known = {one.name: set(one.options) for one in base.contestants}
    foreign = {
        one.name: sorted(set(one.options) - known[one.contestant]) for one in plan.backends if one.checkout == BASE
    }
    backends = tuple(
        msgspec.structs.replace(
            one, options={name: value for name, value in one.options.items() if name not in foreign.get(one.name, ())}
        )
        for one in plan.backends
    )
    missing = dict.fromkeys(f"{one.contestant}.{name}" for one in plan.backends for name in foreign.get(one.name, ()))
    notes = [f"Base does not know, and ran without: {', '.join(missing)}."] if missing else []
    return replace(plan, backends=backends), notes


def judge(results: Results, limits: Limits) -> list[Finding]:
    """What a run of both versions says of each cell, before it is confirmed."""
    samples = samples_of(results)
    rows = {(row.model, row.task, row.backend): row for row in summary(results)}
    heads = [one for one in results.backends if one.checkout == HEAD]
    fewest = fewest_launches(len(heads))
    return [
        _find(
            {"model": model.name, "task": task.name, "contestant": _name_of(head)},
            rows.get((model.name, task.name, head.name)),
            rows.get((model.name, task.name, head.against)),
            samples.get((model.name, task.name, head.name), []),
            samples.get((model.name, task.name, head.against), []),
            limits,
            fewest,
        )
        for model in results.models
        for task in results.tasks
        for head in heads
    ]


def _find(
    facts: dict[str, Any],
    head: Row | None,
    base: Row | None,
    ours: Sequence[Sample],
    theirs: Sequence[Sample],
    limits: Limits,
    fewest: int,
) -> Finding:
    """One cell. `ours` are head's samples."""
    clock = head.clock if head else "cpu"
    facts |= {"clock": clock, "limit": limits.of(clock)}
    if head is None:
        return Finding(**facts, outcome="inconclusive", verdict="inconclusive", reason="no sample was taken")
    answers = [{one.digest for one in side if one.digest} for side in (ours, theirs)]
    if all(answers) and answers[0] != answers[1] and all(len(said) == 1 for said in answers):
        reason = f"head says {answers[0].pop()}, base {answers[1].pop()}"
        return Finding(**facts, outcome="broken", verdict="another answer", reason=reason)
    if head.verdict in BAD:
        reason = f"{head.reason}; so is base" if base and base.verdict == head.verdict else head.reason
        return Finding(**facts, outcome="broken", verdict=head.verdict, reason=reason)
    if base is None or base.verdict in BAD or head.ratio is None:
        reason = f"base {base.verdict}: {base.reason}" if base and base.verdict in BAD else head.reason or head.verdict
        return Finding(**facts, outcome="not compared", verdict="not compared", reason=reason)
    measured = _measure(head, launch_ratios(ours, theirs, clock).values(), facts["limit"])
    outcome, verdict, reason = _weigh(head, measured, facts["limit"], fewest)
    return Finding(**facts, outcome=outcome, verdict=verdict, first=measured, reason=reason)


def _measure(row: Row, ratios: Iterable[float], limit: float) -> Measurement:
    assert row.ratio is not None
    assert row.low is not None
    assert row.high is not None
    launches = list(ratios)
    agreeing = sum(one > math.log(limit) / 2 for one in launches) / len(launches)
    return Measurement(row.ratio, row.low, row.high, agreeing, len(launches))


def _weigh(row: Row, measured: Measurement, limit: float, fewest: int) -> tuple[str, str, str]:
    """Outcome, verdict and reason of a cell that was measured."""
    if row.verdict == "too short":
        return "inconclusive", "inconclusive", "its samples are too short: take a larger model or greater counts"
    if measured.launches < fewest:
        return "inconclusive", "inconclusive", f"{measured.launches} launches, and an interval needs {fewest}"
    if row.verdict == "inconclusive" and row.reason:  # of the control
        return "inconclusive", "inconclusive", row.reason
    verdict = "not slower" if row.verdict == "inconclusive" else row.verdict
    if measured.high <= limit:
        return "passed", verdict, ""
    if measured.low <= BEYOND:
        return "inconclusive", "inconclusive", "slower or not: its launches contradict each other"
    if measured.ratio <= limit:
        return "inconclusive", "slower", "by more than the limit or less, that is open"
    if measured.agreeing < AGREEING:
        share = f"only {measured.agreeing:.0%} of its launches show more than half of the limit"
        return "inconclusive", "inconclusive", share
    return "suspect", "slower", ""


def _name_of(backend: Backend) -> str:
    """What a backend was called before there were two of it, base and head."""
    return backend.against.removesuffix(f"@{BASE}")


def suspects_of(findings: Sequence[Finding]) -> list[Finding]:
    """Those that a second run has to confirm."""
    return [finding for finding in findings if finding.outcome == "suspect"]


def narrow(plan: Plan, suspects: Sequence[Finding]) -> Plan:
    """The plan of the confirming run: the models, tasks and contestants in question, with other turns."""
    models, tasks, contestants = ({getattr(one, name) for one in suspects} for name in ("model", "task", "contestant"))
    backends = tuple(one for one in plan.backends if _name_of(one) in contestants)
    return replace(
        plan,
        models={name: path for name, path in plan.models.items() if name in models},
        tasks=tuple(task for task in plan.tasks if task.name in tasks),
        backends=backends,
        reference=backends[0].name,
        seed=plan.seed + 1,
        has_memory=False,
        has_yardsticks=False,
    )


def confirm(findings: Sequence[Finding], second: Sequence[Finding]) -> list[Finding]:
    """The findings, those of the second run beside them: what it says too has failed."""
    again = {finding.cell: finding for finding in second}
    return [
        _confirm(finding, again[finding.cell]) if finding.outcome == "suspect" and finding.cell in again else finding
        for finding in findings
    ]


def _confirm(first: Finding, second: Finding) -> Finding:
    if second.outcome == "broken":
        return second
    if second.outcome == "suspect":
        return msgspec.structs.replace(first, outcome="failed", second=second.first)
    return msgspec.structs.replace(
        first,
        outcome="inconclusive",
        verdict="inconclusive",
        second=second.first,
        reason="not confirmed by a second run",
    )


def memory_of(results: Results, limits: Limits) -> list[MemoryChange]:
    """What head's structures take beside base's."""
    weighed = {(one.model, one.backend): one for one in results.memory}
    return [
        change
        for model in results.models
        for head in results.backends
        if head.checkout == HEAD
        and (new := weighed.get((model.name, head.name)))
        and (old := weighed.get((model.name, head.against)))
        for change in compare_memory(old, new, limits, _name_of(head))
    ]


def make_gate(
    base: Checkout, head: Checkout, limits: Limits, first: Results, second: Results | None, notes: Sequence[str] = ()
) -> Gate:
    """All that was found in the first run, and in the confirming one if there was need of it."""
    findings = judge(first, limits)
    if second is not None:
        findings = confirm(findings, judge(second, limits))
    runs = [run for run in (first, second) if run is not None]
    heads = {one.name for one in first.backends if one.checkout == HEAD}
    return Gate(
        base=base.title,
        head=head.title,
        command=first.command,
        limits=limits,
        findings=findings,
        memory=memory_of(first, limits),
        failures=failures(one for one in first.memory if one.backend in heads),
        notes=[*_about(base, head, first), *notes, *_about_ends(runs)],
        seconds=sum(run.elapsed_s for run in runs),
        ended=next((run.ended for run in runs if run.ended), ""),
    )


def _about(base: Checkout, head: Checkout, results: Results) -> Iterator[str]:
    known = results.environment
    shared = ", ".join(f"{name} {known[name]}" for name in ("python", "numba", "numpy") if known.get(name))
    yield f"Both versions ran with the same {shared}: only their own code differs."
    if base.commit == head.commit:
        yield "Base and head are the same commit."
    if base.requirements != head.requirements:
        less, more = (
            ", ".join(sorted(set(one) - set(other))) or "nothing else"
            for one, other in ((base.requirements, head.requirements), (head.requirements, base.requirements))
        )
        yield f"They declare different requirements, which is not measured here: base {less}; head {more}."


def _about_ends(runs: Sequence[Results]) -> Iterator[str]:
    for run in runs:
        if run.ended:
            yield f"Ended early ({run.ended}): launches are missing."


def command_of(plan: Plan, base: str, head: str | None) -> str:
    """The command line that asks for the same, from that of the plan."""
    words = shlex.split(plan.command)
    rest = [word for word in words[2:] if word != "--rigorous"]
    return shlex.join([words[0], "gate", "--base", base, *(["--head", head] if head else []), *rest])
