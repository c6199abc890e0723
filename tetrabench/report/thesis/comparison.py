"""What a source published beside what runs measured: tables of both, and finding by finding whether it still holds.

A model of a run is the source's where its name begins with the same word: "nozzle", "nozzle shuffled", "nozzle-100000".
A finding holds where all figures that it rests on lie between its limits, interval and all. Where launches are too few
for intervals, a figure may be off by statistics.CLEAR either way.
"""

import math
from collections.abc import Callable, Container, Iterable, Mapping, Sequence
from dataclasses import replace
from itertools import chain, count
from typing import Any, Literal

import msgspec

from tetrabench.bench.record import Memory, Results
from tetrabench.bench.statistics import CLEAR, Interval, rebased, summary_against
from tetrabench.errors import InputError
from tetrabench.report.cells import MISSING, interval_of, ratio_of
from tetrabench.report.memory import memories
from tetrabench.report.notes import about_end, about_machine, fewer_than_asked
from tetrabench.report.parts import Part, make_parts
from tetrabench.report.thesis.curves import ALONG, Asked, Traced, trace
from tetrabench.report.thesis.facts import NOWHERE, Measured, Published, model_of
from tetrabench.report.units import digits, plural
from tetrabench.sources import Curve, Curves, Facts, Figure, Finding, Reading, Source

Verdict = Literal["holds", "holds no longer", "cannot tell", "not measured"]
FEW_TICKS = 4
"""A time of so few ticks of a timer says little."""
SHOWN = 3
"""So many figures stand in a sentence of evidence at most."""


class Entry(msgspec.Struct, frozen=True, kw_only=True):
    """A contestant in a task, then and today.

    Attributes:
        then_s: seconds as the source printed them; then_ratio: as a multiple of its reference's.
        is_coarse: whether one of both was FEW_TICKS of the source's timer at most.
        seconds: today's median, for one run of the scenario with today's counts.
        ratio: today's, with the ends of its interval, or of its range over the launches; None where none may be shown.
        is_whole: whether these are the ends of an interval.
        verdict: see statistics.Row; "missing" where there is no sample.
        sign: what a table says of it, see `cells`; interval: the same with its ends.
    """

    task: str
    contestant: str
    then_s: float | None = None
    then_ratio: float | None = None
    is_coarse: bool = False
    seconds: float | None = None
    ratio: float | None = None
    low: float | None = None
    high: float | None = None
    is_whole: bool = False
    verdict: str = MISSING
    sign: str = MISSING
    interval: str = MISSING


class Held(msgspec.Struct, frozen=True, kw_only=True):
    """The memory of a contestant, then and today: bytes today by kind (see `memory`), each as a multiple of the
    reference's in `ratios`."""

    contestant: str
    then_kb: int | None = None
    then_ratio: float | None = None
    bytes: dict[str, int] = {}
    ratios: dict[str, float] = {}


class Subject(msgspec.Struct, frozen=True, kw_only=True):
    """A model of a run beside the source's.

    Attributes:
        name: unique in the comparison; model: that of the source; figure: what shows it there, such as "figure 10".
        title: the model, its size, how often it was measured.
        counts: by task, what was done "today (then)", where the source has counts.
        command, machine: of the run.
        has_intervals: whether there were launches enough for intervals anywhere.
        notes: what spoils its figures, a sentence each.
    """

    name: str
    model: str
    figure: str
    title: str
    then_title: str
    counts: dict[str, str]
    command: str
    machine: str
    has_intervals: bool
    entries: list[Entry]
    memory: list[Held]
    notes: list[str] = []

    def entry(self, task: str, contestant: str) -> Entry:
        """A cell of its table."""
        return next(one for one in self.entries if (one.task, one.contestant) == (task, contestant))


class Proof(msgspec.Struct, frozen=True, kw_only=True):
    """A figure that an outcome rests on: today's with its ends (None where there is none), and the source's own.

    A share is a part of 1. `least` and `most` are the limits that it has to lie between, None where it has none.
    """

    about: str
    outcome: str
    figure: float | None = None
    low: float | None = None
    high: float | None = None
    is_whole: bool = False
    then: float | None = None
    least: float | None = None
    most: float | None = None


class Outcome(msgspec.Struct, frozen=True, kw_only=True):
    """What a model says of a finding.

    Attributes:
        subject: its name.
        outcome: what today's figures say; then: the same asked of the source's own tables.
        evidence: a sentence with the figures that decide.
        proofs: all figures that it rests on.
    """

    subject: str
    outcome: Verdict
    then: Verdict
    evidence: str
    proofs: list[Proof]


class Judged(msgspec.Struct, frozen=True, kw_only=True):
    """A finding (see sources.Finding) with what each model says of it."""

    name: str
    claim: str
    section: str
    asked: str
    remark: str
    outcomes: list[Outcome]


class TableRow(msgspec.Struct, frozen=True, kw_only=True):
    """A row of a table of the source: words, then by model what the source printed and what it is today."""

    words: list[str]
    then: dict[str, str]
    today: dict[str, str]


class SetAnew(msgspec.Struct, frozen=True, kw_only=True):
    """A table of the source (see sources.Table) with today's figures beside its own; `models` are its columns."""

    name: str
    caption: str
    head: list[str]
    models: list[str]
    rows: list[TableRow]
    notes: list[str]


class At(msgspec.Struct, frozen=True, kw_only=True):
    """A point of a line: its place, the time there in the unit of its figure with the ends of its interval, and the count.

    `high` is None where no difference can be believed; `is_whole` as in statistics.Interval.
    """

    place: float
    time: float
    low: float
    high: float | None
    is_whole: bool
    count: float | None = None


class Drawn(msgspec.Struct, frozen=True, kw_only=True):
    """The line of a contestant in a panel.

    Attributes:
        title: as the family's table has it, which decides how it looks; words: what it stands for, "" of none of the source's.
        is_exact: whether its answers are right.
    """

    contestant: str
    title: str
    words: str
    is_exact: bool
    points: list[At]


class Panel(msgspec.Struct, frozen=True, kw_only=True):
    """A curve of the source (see sources.Curve) with a line for each contestant that measured it.

    Attributes:
        run: its command; about: what ran, a sentence.
    """

    name: str
    title: str
    run: str
    about: str
    lines: list[Drawn]


class DrawnAnew(msgspec.Struct, frozen=True, kw_only=True):
    """A figure of the source (see sources.Figure) drawn by runs; `is_along` says that its panels go along a run."""

    name: str
    caption: str
    across: str
    up: str
    count: str
    is_log: bool
    is_along: bool
    said: tuple[float, float] | None
    said_words: str
    panels: list[Panel]
    notes: list[str]


class Comparison(msgspec.Struct, frozen=True, kw_only=True):
    """A source beside today's runs. All of it is plain data: msgspec.json.encode takes it.

    Attributes:
        title, author, place, year, then_machine: of the source.
        reference: the contestant that all ratios refer to.
        tasks, contestants: those of the source's tables, in their order; contestants with their titles.
        titles: of all contestants of the family, see record.Results.
        notes: what is to be known of the source's figures.
        tables: those that the source wants set anew; drawn: its figures with curves.
    """

    title: str
    author: str
    place: str
    year: int
    then_machine: str
    reference: str
    tasks: list[str]
    contestants: dict[str, str]
    titles: list[str]
    subjects: list[Subject]
    findings: list[Judged]
    notes: list[str]
    tables: list[SetAnew] = []
    drawn: list[DrawnAnew] = []

    @property
    def asked(self) -> list[str]:
        """Whom the findings are asked of: the models of the runs, or the contestants whose curves these are."""
        outcomes = (one.subject for judged in self.findings for one in judged.outcomes)
        return list(dict.fromkeys(chain((one.name for one in self.subjects), outcomes)))


def compare_with_source(runs: Sequence[Results], source: Source) -> Comparison:
    """What a source published beside what these runs measured on the same models.

    Raises:
        InputError: a run measured nothing, or without the source's reference, or none of them on a model of the source,
            or nothing that its curves show.
    """
    if source.drawn:
        return _compare_curves(runs, source)
    measured: dict[str, Measured] = {}
    for run in runs:
        for part in _parts_of(run, source):
            measured[_unused(part, measured)] = Measured(part, source)
    if not measured:
        known = ", ".join(source.times)
        raise InputError(f"no model in these results is the source's: name one after {known}, and run it")
    _introduce(measured.values(), source)
    return Comparison(
        **_introduction(runs, source),
        subjects=[_subject(name, one, source) for name, one in measured.items()],
        findings=[_judge(finding, measured, source) for finding in source.findings],
        tables=_tables(runs, measured.values(), source),
    )


def _compare_curves(runs: Sequence[Results], source: Source) -> Comparison:
    """The same for a source that drew curves: each finding is asked of each contestant that stands for it."""
    for run in runs:
        if run.profile == "check":
            raise InputError(f"'{run.command}' measured no times: run it without checking alone")
    curves = [curve for figure in source.drawn for curve in figure.curves]
    others = [one.contestant for run in runs for one in run.backends if not one.control]
    asked = {one: trace(curves, one, runs, source) for one in dict.fromkeys([*source.contestants, *others])}
    if not any(one.traced for one in asked.values()):
        known = "; ".join(dict.fromkeys(f"{curve.scenario} over {curve.over}" for curve in curves))
        raise InputError(f"these results have none of the source's curves on its model: run one of {known}")
    return Comparison(
        **_introduction(runs, source),
        subjects=[],
        findings=[_judge_curves(finding, asked, source) for finding in source.curve_findings],
        drawn=[drawn for figure in source.drawn if (drawn := _draw_anew(figure, asked, source)).panels],
    )


def _introduction(runs: Sequence[Results], source: Source) -> dict[str, Any]:
    """What a comparison says of its source, whatever that published."""
    return {
        "title": source.title,
        "author": source.author,
        "place": source.place,
        "year": source.year,
        "then_machine": source.machine,
        "reference": source.reference,
        "tasks": source.tasks,
        "contestants": dict(source.contestants),
        "titles": runs[0].titles,
        "notes": list(source.notes),
    }


def _parts_of(run: Results, source: Source) -> list[Part]:
    """The source's models in a run, compared with the source's reference."""
    if not any(model_of(model.name, source) for model in run.models):
        return []
    if run.profile == "check":
        raise InputError(f"'{run.command}' measured no times: run it without checking alone")
    base = next((one.name for one in run.backends if one.contestant == source.reference and not one.control), None)
    if base is None:
        raise InputError(f"'{run.command}' ran without {source.reference}, which the source is compared by: add it")
    parts = make_parts(rebased(run, base), summary_against(run, base))
    return [part for part in parts if model_of(part.model.name, source)]


def _unused(part: Part, names: Container[str]) -> str:
    """The model's name, or where another run has it, one that says which run this is."""
    name = part.model.name
    known = chain((name, f"{name}, {part.results.profile}"), (f"{name}, run {number}" for number in count(2)))
    return next(one for one in known if one not in names)


def _introduce(measured: Iterable[Measured], source: Source) -> None:
    """Models of different shape and the same numbering know each other."""
    kinds: dict[str, dict[str, Measured]] = {}
    for one in measured:
        model = model_of(one.part.model.name, source) or ""
        rest = one.part.model.name.lower().removeprefix(model)
        one.beside = kinds.setdefault(f"{one.part.results.profile} {rest}", {})
        one.beside.setdefault(model, one)


# -- tables


def _subject(name: str, measured: Measured, source: Source) -> Subject:
    part = measured.part
    model = model_of(part.model.name, source) or ""
    few = fewer_than_asked(part)
    ended = dict.fromkeys(
        f"{row.backend} in {row.task}, {row.verdict}: {' '.join(row.reason.split())}."
        for row in part.rows.values()
        if row.status != "ok"
    )
    return Subject(
        name=name,
        model=model,
        figure=source.figures.get(model, ""),
        title=part.title,
        then_title=f"{model}: {source.models.get(model, '')}",
        counts=_counts(measured, source),
        command=part.results.command,
        machine=about_machine(part.results),
        has_intervals=part.has_intervals,
        entries=[_entry(measured, task, one, model) for task in source.tasks for one in source.contestants],
        memory=[_held(measured, one, model) for one in source.contestants],
        notes=[
            *filter(None, [about_end(part.results)]),
            *([f"Fewer than asked for, the model is too small: {few}."] if few else []),
            *(f"Nothing is ranked in {task}: {reason}." for task, reason in part.doubts.items()),
            *ended,
        ],
    )


def _counts(measured: Measured, source: Source) -> dict[str, str]:
    """What was done in each task, today and then."""
    options = {task.name: task.options for task in measured.part.results.tasks}
    return {
        task: ", ".join(
            f"{options[measured.tasks[task]].get(name, 0):,} {name} ({source.year}: {n:,})"
            for name, n in wanted.items()
        )
        for task, wanted in source.counts.items()
        if task in measured.tasks
    }


def _entry(measured: Measured, task: str, contestant: str, model: str) -> Entry:
    source = measured.source
    then = source.times[model].get(task, {})
    then_s, base_s = then.get(contestant), then.get(source.reference)
    facts: dict[str, Any] = {"task": task, "contestant": contestant, "then_s": then_s}
    if then_s is not None and base_s:
        is_coarse = round(min(then_s, base_s) / source.tick_s) <= FEW_TICKS if source.tick_s else False
        facts |= {"then_ratio": then_s / base_s, "is_coarse": is_coarse}
    row = measured.row(task, contestant)
    if row is None:
        return Entry(**facts)
    is_shown = row.verdict in ("faster", "slower", "same", "about", "inconclusive")
    facts |= {"seconds": row.seconds, "verdict": row.verdict, "sign": ratio_of(row), "interval": interval_of(row)}
    if row.verdict == "reference":
        facts["ratio"] = 1.0
    elif is_shown:
        is_whole = row.verdict != "about" and not row.is_bound
        facts |= {"ratio": row.ratio, "low": row.low, "high": row.high, "is_whole": is_whole}
    return Entry(**facts)


def _held(measured: Measured, contestant: str, model: str) -> Held:
    source = measured.source
    then = source.memory.get(model, {})
    then_kb, base_kb = then.get(contestant), then.get(source.reference)
    today = memories(measured.part)
    mine = _kinds(today.get(measured.names.get(contestant, "")))
    base = _kinds(today.get(measured.names[source.reference]))
    return Held(
        contestant=contestant,
        then_kb=then_kb,
        then_ratio=then_kb / base_kb if then_kb and base_kb else None,
        bytes=mine,
        ratios={kind: size / base[kind] for kind, size in mine.items() if base.get(kind)},
    )


def _kinds(memory: Memory | None) -> dict[str, int]:
    """Bytes by kind, of a structure that could be built."""
    if memory is None or memory.status != "ok":
        return {}
    sizes = {"structure": memory.structure_bytes, "retained": memory.retained_bytes, "peak": memory.peak_bytes}
    return {kind: size for kind, size in sizes.items() if size}


def _tables(runs: Sequence[Results], measured: Iterable[Measured], source: Source) -> list[SetAnew]:
    """The source's tables, a pair of columns for each of its models: of several that were measured the first.

    Contestants that the source has not stand behind its own, with an asterisk.
    """
    facts: dict[str, Measured] = {}
    for one in measured:
        facts.setdefault(model_of(one.part.model.name, source) or "", one)
    ours = {one.contestant: f"{one.contestant}*" for run in runs for one in run.backends if one.extension}
    return [
        SetAnew(
            name=table.name,
            caption=table.caption,
            head=list(table.head),
            models=list(source.models),
            rows=[
                TableRow(
                    words=[ours.get(word, word) for word in line.words],
                    then=dict(line.printed),
                    today={model: _spelled(line.today(model, one), table.spell) for model, one in facts.items()},
                )
                for line in table.lines([*source.contestants, *ours])
            ],
            notes=list(table.notes),
        )
        for table in source.tables
    ]


def _spelled(figure: Interval | None, spell: Callable[[float], str]) -> str:
    """A figure in a cell: 12, 12? where launches are too few for an interval, <12 where it is too short to be known."""
    if figure is None:
        return MISSING
    if figure[1:3] == NOWHERE:
        return "unclear"
    if figure.low == 0.0 or figure.high == math.inf:
        return f"<{spell(figure.high)}" if figure.low == 0.0 else f">{spell(figure.low)}"
    return spell(figure.ratio) + ("" if figure.is_whole else "?")


# -- curves


def _draw_anew(figure: Figure, asked: Mapping[str, Asked], source: Source) -> DrawnAnew:
    panels = [
        (curve, {name: one.traced[curve.name] for name, one in asked.items() if curve.name in one.traced})
        for curve in figure.curves
    ]
    return DrawnAnew(
        name=figure.name,
        caption=figure.caption,
        across=figure.across,
        up=figure.up,
        count=figure.count,
        is_log=figure.is_log,
        is_along=any(curve.over == ALONG for curve in figure.curves),
        said=figure.said,
        said_words=figure.said_words,
        panels=[_panel(curve, traced, figure, source) for curve, traced in panels if traced],
        notes=list(figure.notes),
    )


def _panel(curve: Curve, traced: Mapping[str, Traced], figure: Figure, source: Source) -> Panel:
    first = next(iter(traced.values()))
    return Panel(
        name=curve.name,
        title=curve.title,
        run=first.run.command,
        about=_about_panel(curve, first, source),
        lines=[
            Drawn(
                contestant=name,
                title=one.backend.title,
                words=source.contestants.get(name, ""),
                is_exact=one.backend.exact,
                points=_points(one, figure),
            )
            for name, one in traced.items()
        ],
    )


def _about_panel(curve: Curve, traced: Traced, source: Source) -> str:
    """On what, how often, how much of it."""
    run = traced.run
    options = next(task.options for task in run.tasks if task.scenario == curve.scenario)
    counts = [
        f"{options[name]:,} {name} ({source.year}: {count:,})"
        for name, count in source.counts.get(curve.scenario, {}).items()
        if name in options
    ]
    model = "" if curve.over in traced.model.size else f" on {traced.model.name}"
    launches = len({one.launch for one in run.launches})
    facts = [f"{curve.scenario}{model}", *counts, plural(launches, "launch"), about_machine(run), about_end(run)]
    return ", ".join(filter(None, facts))


def _points(traced: Traced, figure: Figure) -> list[At]:
    counts = traced.counts.get(figure.count, [])
    points = []
    for place, point in enumerate(traced.points):
        if figure_of := traced.time(point):
            time, low, high = (value / figure.up_s for value in figure_of[:3])
            points.append(
                At(
                    place=point.place,
                    time=time,
                    low=low,
                    high=_finite(high),
                    is_whole=figure_of.is_whole,
                    count=counts[place] if counts else None,
                )
            )
    return points


# -- findings


def _judge_curves(finding: Finding[Curves], asked: Mapping[str, Asked], source: Source) -> Judged:
    """What each contestant that stands for something says of a finding; the source printed no figures to ask."""
    return _judged(
        finding,
        [
            _outcome(f"{name}, {words}", today, [replace(one, figure=None) for one in today], source)
            for name, words in source.contestants.items()
            for today in [finding.readings(asked[name])]
        ],
    )


def _judge(finding: Finding[Facts], measured: dict[str, Measured], source: Source) -> Judged:
    outcomes = []
    for name, facts in measured.items():
        model = model_of(facts.part.model.name, source) or ""
        if not finding.models or model in finding.models:
            outcomes.append(_outcome(name, finding.readings(facts), finding.readings(Published(model, source)), source))
    return _judged(finding, outcomes)


def _judged(finding: Finding[Any], outcomes: list[Outcome]) -> Judged:
    return Judged(
        name=finding.name,
        claim=finding.claim,
        section=finding.section,
        asked=finding.asked,
        remark=finding.remark,
        outcomes=outcomes,
    )


def _outcome(subject: str, today: Sequence[Reading], then: Sequence[Reading], source: Source) -> Outcome:
    outcome = worst_of(map(outcome_of, today))
    deciding = sorted(
        ((one, old) for one, old in zip(today, then, strict=True) if outcome_of(one) == outcome),
        key=lambda pair: _margin(pair[0]),
    )
    said = [_sentence(one, old, source.year) for one, old in deciding[:SHOWN]]
    said += [f"and {len(deciding) - SHOWN} more alike"] if len(deciding) > SHOWN else []
    if outcome == "cannot tell" and any(one.figure and not one.figure.is_whole for one, _ in deciding):
        said.append("too few launches to tell")
    return Outcome(
        subject=subject,
        outcome=outcome,
        then=worst_of(map(outcome_of, then)),
        evidence="; ".join(said),
        proofs=[_proof(one, old) for one, old in zip(today, then, strict=True)],
    )


def outcome_of(reading: Reading) -> Verdict:
    """What one figure says of the limits that it should lie between."""
    figure = reading.figure
    if figure is None:
        return "not measured"
    slack = 1.0 if figure.is_whole else CLEAR
    low, high = figure.low / slack, figure.high * slack
    if low >= reading.least and high <= reading.most:
        return "holds"
    return "holds no longer" if high < reading.least or low > reading.most else "cannot tell"


def worst_of(outcomes: Iterable[Verdict]) -> Verdict:
    """What several figures say of a finding that rests on all of them."""
    known = set(outcomes)
    worst: tuple[Verdict, ...] = ("holds no longer", "not measured", "cannot tell")
    return next((outcome for outcome in worst if outcome in known), "holds")


def _margin(reading: Reading) -> float:
    """How far, as a logarithm, a figure lies within its limits; negative beyond them."""
    if reading.figure is None or not reading.figure.ratio > 0:
        return 0.0
    at = math.log(reading.figure.ratio)
    below = at - math.log(reading.least) if reading.least > 0 else math.inf
    return min(below, math.log(reading.most) - at if reading.most < math.inf else math.inf)


def _sentence(today: Reading, then: Reading, year: int) -> str:
    """A figure in words, beside the source's."""
    printed = then.printed if then.printed is not None else then.figure and then.figure.ratio
    old = f" ({year}: {_spell(printed, then.unit)})" if printed is not None else ""
    if today.figure is None:
        return f"{today.about}: no figure{old}"
    if today.figure[1:3] == NOWHERE:
        return f"{today.about}: too short, or in doubt{old}"
    return today.words.format(_figure(today.figure, today.unit)) + old


def _figure(figure: Interval, unit: str) -> str:
    """6.5x [6.1, 7.0]; 1.04x where that is exact; about 6.5x where launches are too few; at least or at most 9.8x."""
    if figure.low == 0.0:
        return f"at most {_spell(figure.high, unit)}"
    if figure.high == math.inf:
        return f"at least {_spell(figure.low, unit)}"
    if not figure.is_whole:
        return f"about {_spell(figure.ratio, unit)}"
    ends = (_spell(end, unit).removesuffix("x").removesuffix(" %") for end in figure[1:3])
    return _spell(figure.ratio, unit) + (f" [{', '.join(ends)}]" if figure.low < figure.high else "")


def _spell(value: float, unit: str) -> str:
    if unit == "x":
        return f"{digits(value)}x"
    return f"{100 * value:.2g} %" if unit == "%" else f"{value:.1f}{unit}"


def _proof(today: Reading, then: Reading) -> Proof:
    figure = today.figure
    return Proof(
        about=today.about,
        outcome=outcome_of(today),
        figure=figure.ratio if figure else None,
        low=figure.low if figure else None,
        high=_finite(figure.high) if figure else None,
        is_whole=figure.is_whole if figure else False,
        then=then.printed if then.printed is not None else then.figure and then.figure.ratio,
        least=today.least or None,
        most=_finite(today.most),
    )


def _finite(value: float) -> float | None:
    return value if value < math.inf else None
