"""What `gate` and `compare` found, as tables, as annotations of a workflow, and as JSON."""

from collections.abc import Callable, Iterable, Iterator, Sequence

import msgspec

from tetrabench.bench.compare import Change, Comparison
from tetrabench.bench.gate import Finding, Gate, Measurement
from tetrabench.bench.limits import MemoryChange
from tetrabench.bench.statistics import ALIKE, BAD
from tetrabench.report.github import annotation
from tetrabench.report.sheets import Cell, Pages, Sheet
from tetrabench.report.table import markdown_of, text_of
from tetrabench.report.units import span


def gate_as(gate: Gate, form: str, *, colour: bool = False, strict: bool = False) -> str:
    """What a gate found; `form` is "table", "md", "github" or "json"."""
    facts = {**msgspec.to_builtins(gate), "exit_code": gate.exit_code(strict=strict)}
    return _as(form, colour, lambda: gate_pages(gate), facts, gate_annotations(gate))


def comparison_as(comparison: Comparison, form: str, *, colour: bool = False, strict: bool = False) -> str:
    """What a comparison found; `form` is "table", "md", "github" or "json"."""
    facts = {**msgspec.to_builtins(comparison), "exit_code": comparison.exit_code(strict=strict)}
    return _as(form, colour, lambda: comparison_pages(comparison), facts, comparison_annotations(comparison))


def _as(form: str, colour: bool, pages: Callable[[], Pages], facts: object, annotations: Iterable[str]) -> str:
    if form == "json":
        return msgspec.json.format(msgspec.json.encode(facts), indent=1).decode() + "\n"
    if form == "table":
        return text_of(pages(), colour=colour)
    comment = ["", "<!--", *annotations, "-->"] if form == "github" else []
    return markdown_of(pages()) + "".join(f"{line}\n" for line in comment if len(comment) > 3)


def words_of(finding: Finding) -> str:
    """A verdict as a person says it: "1.31x slower than base, confirmed"."""
    first = finding.first
    if finding.outcome in ("failed", "suspect") and first:
        return f"{first.ratio:.2f}x slower than base, {'confirmed' if finding.second else 'not confirmed yet'}"
    if finding.verdict in ("faster", "slower") and first:
        return ratio_words(first.ratio)
    return {"another answer": "ANOTHER ANSWER", "not slower": "not slower"}.get(finding.verdict, finding.verdict)


def ratio_words(ratio: float) -> str:
    """1.31 as "1.31x slower", 0.5 as "2.00x faster"."""
    return f"{ratio:.2f}x slower" if ratio >= 1 else f"{1 / ratio:.2f}x faster"


# -- the gate


def gate_pages(gate: Gate) -> Pages:
    """Its tables: one of times, and one of memory where something changed."""
    several = len({finding.model for finding in gate.findings}) > 1
    rows = [
        [
            Cell(f"{finding.task} on {finding.model}" if several else finding.task),
            Cell(finding.contestant),
            *_measured(finding.first),
            Cell(f"{finding.second.ratio:.2f}" if finding.second else ""),
            Cell(words_of(finding), finding.verdict),
        ]
        for finding in gate.findings
    ]
    models = "" if several or not gate.findings else f", {gate.findings[0].model}"
    head = ["scenario", "backend", "head/base", "interval", "launches", "again", "verdict"]
    sheets = [Sheet(title=f"head {gate.head} beside base {gate.base}{models}", head=head, rows=rows)]
    return Pages(sheets=sheets + _memory_sheets(gate.memory, "base", "head"), notes=list(_gate_notes(gate)))


def _measured(measured: Measurement | None) -> list[Cell]:
    if measured is None:
        return [Cell("")] * 3
    return [Cell(f"{measured.ratio:.2f}"), Cell(span(measured.low, measured.high)), Cell(str(measured.launches))]


def _gate_notes(gate: Gate) -> Iterator[str]:
    yield headline(gate)
    for finding in gate.findings:
        if finding.reason:
            yield f"{finding.contestant}, {finding.task}, {finding.verdict}: {finding.reason}."
    yield from gate.failures
    yield from _next_steps(gate)
    yield (
        f"Allowed: {gate.limits.cpu - 1:.0%} more CPU time (wall time {gate.limits.wall - 1:.0%}), "
        f"{gate.limits.structure - 1:.0%} more structure, {gate.limits.peak - 1:.0%} and a MiB more peak. "
        "head/base: median over launches, with its interval; again: of the confirming run."
    )
    yield from gate.notes
    yield f"{gate.command} ({gate.seconds / 60:.0f} min)"


def headline(gate: Gate) -> str:
    """The verdict in a sentence."""
    by_outcome: dict[str, list[Finding]] = {}
    for finding in gate.findings:
        by_outcome.setdefault(finding.outcome, []).append(finding)
    larger = [f"{one.backend} ({one.what})" for one in gate.memory if one.verdict == "larger"]
    if gate.ended == "interrupted":
        return "INTERRUPTED: this is what is known so far."
    if gate.failures or "broken" in by_outcome:
        named = [f"{one.contestant} in {one.task} ({one.verdict})" for one in by_outcome.get("broken", [])]
        return f"BROKEN: {', '.join(named) or 'the memory pass'}."
    if "failed" in by_outcome or larger:
        slower = [f"{one.contestant} is {words_of(one)} in {one.task}" for one in by_outcome.get("failed", [])]
        return f"FAILED: {'; '.join([*slower, *(f'{one} is larger than base' for one in larger)])}."
    if set(by_outcome) <= {"not compared"}:
        return "NOT COMPARED: there is no cell that both versions ran."
    open_ones = by_outcome.get("inconclusive", []) + by_outcome.get("suspect", [])
    if open_ones:
        named = [f"{one.contestant} in {one.task}" for one in open_ones]
        return f"PASSED, but inconclusive for {', '.join(named)}: nothing is shown to be slower."
    return "PASSED: nothing is slower than base by more than is allowed."


def _next_steps(gate: Gate) -> Iterator[str]:
    outcomes = {finding.outcome for finding in gate.findings}
    verdicts = {finding.verdict for finding in gate.findings}
    if "failed" in outcomes:
        yield (
            "What to do: see what `git diff` of the two revisions changes for that scenario, and run the gate on that "
            "backend and scenario alone; if it is meant to be so, say so where the change is reviewed."
        )
    if "another answer" in verdicts:
        yield "What to do: find out which answer is right (`tetrabench check`, the tests); times of a wrong one mean nothing."
    if outcomes & {"inconclusive", "suspect"}:
        yield "What to do about inconclusive cells: a quieter machine (`tetrabench doctor`), more --launches, a larger model."


def gate_annotations(gate: Gate) -> Iterator[str]:
    """An error for what fails the gate, a warning for what is open."""
    for finding in gate.findings:
        where = f"{finding.contestant}, {finding.task}, {finding.model}"
        if finding.outcome in ("failed", "broken"):
            said = words_of(finding) + (f": {finding.reason}" if finding.reason else "")
            yield annotation("error", f"tetrabench gate: {finding.outcome}", f"{where}: {said}")
        elif finding.outcome in ("inconclusive", "suspect"):
            yield annotation(
                "warning", "tetrabench gate: inconclusive", f"{where}: {finding.reason or words_of(finding)}"
            )
    yield from _memory_annotations(gate.memory, gate.failures)


# -- two runs


def comparison_pages(comparison: Comparison) -> Pages:
    """Its tables: one of times, and one of memory where something changed."""
    several = len({change.model for change in comparison.changes}) > 1
    rows = [
        [
            Cell(f"{change.task} on {change.model}" if several else change.task),
            Cell(change.backend),
            Cell(f"{change.old[0]:.2f}" if change.old else ""),
            Cell(f"{change.new[0]:.2f}" if change.new else ""),
            Cell(f"{change.p:.3f}" if change.p is not None else ""),
            Cell(_change_words(change), change.verdict),
        ]
        for change in comparison.changes
    ]
    old, new = (_short(one) for one in (comparison.old_revision, comparison.new_revision))
    sheet = Sheet(
        title=f"new run ({new}) beside old run ({old}): times that of {comparison.reference}",
        head=["scenario", "backend", "old", "new", "p", "verdict"],
        rows=rows,
    )
    return Pages(
        sheets=[sheet, *_memory_sheets(comparison.memory, "old", "new")], notes=list(_comparison_notes(comparison))
    )


def _change_words(change: Change) -> str:
    if change.verdict in ("faster", "slower") and change.ratio is not None:
        return ratio_words(change.ratio) + (", a regression" if change.is_regression else "")
    return change.verdict


def _comparison_notes(comparison: Comparison) -> Iterator[str]:
    bad = [f"{one.backend} in {one.task} ({one.verdict})" for one in comparison.changes if one.verdict in BAD]
    worse = [f"{one.backend} in {one.task}" for one in comparison.changes if one.is_regression]
    worse += [f"{one.backend} ({one.what})" for one in comparison.memory if one.verdict == "larger"]
    if bad or comparison.failures:
        yield f"BROKEN in the new run: {', '.join(bad) or 'the memory pass'}."
    if worse:
        yield f"REGRESSION: {', '.join(worse)}. Let `tetrabench gate` confirm it."
    reasons: dict[tuple[str, str], list[str]] = {}
    for change in comparison.changes:
        if change.reason:
            reasons.setdefault((change.verdict, change.reason), []).append(f"{change.backend} in {change.task}")
    for (verdict, reason), cells in reasons.items():
        yield f"{', '.join(cells)}, {verdict}: {reason}."
    yield from comparison.failures
    yield (
        f"old, new: times that of {comparison.reference} in the same run. p: that launches alike differ so much, for all "
        f"cells together. same: surely within {ALIKE - 1:.0%}."
    )
    yield from comparison.notes


def comparison_annotations(comparison: Comparison) -> Iterator[str]:
    """An error for a cell that went wrong, a warning for a regression, which only the gate can confirm."""
    for change in comparison.changes:
        where = f"{change.backend}, {change.task}, {change.model}"
        if change.verdict in BAD:
            yield annotation("error", f"tetrabench compare: {change.verdict}", f"{where}: {change.reason}")
        elif change.is_regression:
            yield annotation("error", "tetrabench compare: a regression", f"{where}: {_change_words(change)}")
    yield from _memory_annotations(comparison.memory, comparison.failures)


# -- of both


def _memory_sheets(changes: Sequence[MemoryChange], old: str, new: str) -> list[Sheet]:
    """What became larger or smaller; no table where nothing did."""
    rows = [
        [
            Cell(f"{one.what}, {one.model}"),
            Cell(one.backend),
            Cell(f"{one.old_bytes / 1e6:,.2f}"),
            Cell(f"{one.new_bytes / 1e6:,.2f}"),
            Cell(f"{_percent(one)} {one.verdict}", {"larger": "slower", "smaller": "faster"}[one.verdict]),
        ]
        for one in changes
        if one.verdict != "same"
    ]
    return [Sheet(title="Memory, MB", head=["what", "backend", old, new, "verdict"], rows=rows)] if rows else []


def _percent(change: MemoryChange) -> str:
    return f"{abs(change.new_bytes / change.old_bytes - 1):.1%}" if change.old_bytes else ""


def _memory_annotations(changes: Sequence[MemoryChange], broken: Sequence[str]) -> Iterator[str]:
    for sentence in broken:
        yield annotation("error", "tetrabench: the memory pass", sentence)
    for one in changes:
        if one.verdict == "larger":
            said = f"{one.backend}, {one.model}: {one.what} {_percent(one)} larger, {one.new_bytes:,} bytes"
            yield annotation("error", "tetrabench: memory", said)


def _short(revision: str) -> str:
    return revision[:10] + "+" * revision.endswith("+") if len(revision) >= 40 else revision
