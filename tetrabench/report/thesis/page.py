"""A source beside today's runs, set for reading: in Markdown, or as a piece of an HTML page.

Both are set from the same blocks; whatever a name in the results says, it stays text.
"""

import re
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from html import escape
from pathlib import Path
from urllib.parse import quote

from matplotlib.figure import Figure

from tetrabench import registry
from tetrabench.bench.record import Results
from tetrabench.bench.statistics import ALIKE, CLEAR, SHORTEST_S
from tetrabench.drafts import drafted
from tetrabench.errors import InputError
from tetrabench.printable import printable
from tetrabench.report.cells import MISSING
from tetrabench.report.thesis.comparison import (
    At,
    Comparison,
    Drawn,
    DrawnAnew,
    Entry,
    Held,
    Judged,
    Outcome,
    SetAnew,
    Subject,
    compare_with_source,
)
from tetrabench.report.thesis.curve_figures import draw_curves, file_of, least_of, three_digits
from tetrabench.report.thesis.curves import TENTH
from tetrabench.report.thesis.figures import as_svg, draw_figures, name_of, save_figures
from tetrabench.report.units import digits, duration, percent, times, two_digits

CLASSES = {"holds": "holds", "holds no longer": "gone", "cannot tell": "unclear", "not measured": "unmeasured"}
"""How a page marks an outcome; its words say the same."""
KINDS = {"structure": "structure today, MB", "retained": "retained today, MB", "peak": "peak today, MB"}


@dataclass(frozen=True)
class Text:
    """Words, and the class that a page gives them."""

    text: str
    look: str = ""


@dataclass(frozen=True)
class Heading:
    """Of a part of the comparison."""

    text: str


@dataclass(frozen=True)
class Items:
    """A list; `lead` stands before it."""

    items: list[Text]
    lead: list[Text] = field(default_factory=list)


@dataclass(frozen=True)
class Table:
    """The first `names` columns are words that name the row; all others are figures or outcomes."""

    caption: str
    head: list[str]
    rows: list[list[Text]]
    names: int = 1


@dataclass(frozen=True)
class Picture:
    """A figure, by its name; `text` says what it shows."""

    name: str
    text: str


Block = Heading | Text | Items | Table | Picture


def as_markdown(comparison: Comparison, figures: Mapping[str, str] | None = None) -> str:
    """The whole comparison in Markdown.

    Args:
        comparison: see comparison.compare_with_source.
        figures: the path of each figure, from where the page will lie, by its name in figures.draw_figures.
    """
    known = figures or {}
    return "\n\n".join(_markdown(block, known) for block in _drawn(comparison, known)) + "\n"


def overview_as_markdown(comparison: Comparison) -> str:
    """Which findings hold, in one table, in Markdown."""
    return _markdown(_overview(comparison), {})


def as_html(comparison: Comparison, figures: Mapping[str, str] | None = None) -> str:
    """The whole comparison as a piece of an HTML page, for a section under `title_of` it: headings from h3 on, no style.

    An outcome has the class "holds", "gone", "unclear" or "unmeasured", a claim "claim".

    Args:
        comparison: see comparison.compare_with_source.
        figures: the SVG element of each figure (see figures.as_svg), by its name; it is taken as it is.
    """
    known = figures or {}
    return "\n".join(_html(block, known) for block in _drawn(comparison, known)) + "\n"


def title_of(comparison: Comparison) -> str:
    """What stands above it."""
    return f"{comparison.author} ({comparison.year}) and today"


def make_section(runs: Sequence[Results]) -> tuple[str, str]:
    """Runs beside the source of their family, as a section of a page: its title, and a piece of HTML with the figures.

    Raises:
        InputError: as `comparison.compare_with_source`, or the family has no source.
    """
    comparison, figures = _compared(runs)
    drawn = {name: as_svg(figure, f"{name}: {title_of(comparison)}") for name, figure in figures.items()}
    return title_of(comparison), as_html(comparison, drawn)


def write_markdown(runs: Sequence[Results], path: Path) -> None:
    """The same as a page in Markdown, its figures in a folder of its name beside it.

    Raises:
        InputError: as `make_section`, or a file cannot be written.
    """
    comparison, figures = _compared(runs)
    folder = path.with_suffix("")
    saved = save_figures(figures, folder)
    links = {name: quote(f"{folder.name}/{file.name}") for name, file in saved.items()}
    with drafted(path) as draft:
        draft.write_text(f"## {_plain(title_of(comparison))}\n\n{as_markdown(comparison, links)}", encoding="utf-8")


def _compared(runs: Sequence[Results]) -> tuple[Comparison, dict[str, Figure]]:
    """Runs beside their source, and the figures of both."""
    families = list(dict.fromkeys(run.family for run in runs))
    if len(families) > 1:
        raise InputError(f"results of several families, {', '.join(families)}, have no source in common: take one")
    comparison = compare_with_source(runs, registry.source(families[0]))
    return comparison, draw_figures(comparison, runs[0]) | draw_curves(comparison, runs[0])


# -- what is said


def _drawn(comparison: Comparison, figures: Collection[str]) -> Iterator[Block]:
    """All there is to say, without pictures that nobody drew."""
    return (one for one in _blocks(comparison) if not isinstance(one, Picture) or one.name in figures)


def _blocks(comparison: Comparison) -> Iterator[Block]:
    year = comparison.year
    compared = f"Ratios are what is compared: times as multiples of {comparison.reference}'s."
    if comparison.drawn:
        compared = "Its figures are curves, and their shape is what is compared."
    yield Text(
        f"{comparison.author}: {comparison.title}, {comparison.place}, {year}. {compared} "
        f"{year} on {comparison.then_machine}."
    )
    yield Items([Text(note) for note in comparison.notes])
    yield Heading("What the source found, and whether it still holds")
    yield Text(
        "A finding holds where all figures that it rests on lie between the limits that it asks for, with all of their "
        f"intervals. Where launches are too few for intervals, a figure may be off by {CLEAR:g}x either way."
    )
    yield _overview(comparison)
    yield from (_evidence(comparison, judged) for judged in comparison.findings if judged.outcomes)
    if comparison.tables:
        yield Heading("The source's tables, and the same of today")
        yield Text(
            "12?: launches are too few for an interval. <12: too short to be known. unclear: two copies of one contestant "
            "differed. missing: not measured, too short or not to be believed. *: ours, the source has no such contestant."
        )
    for table in comparison.tables:
        yield from _set_anew(comparison, table)
    for drawn in comparison.drawn:
        yield from _drawn_anew(drawn)
    for subject in comparison.subjects:
        yield Heading(f"{subject.figure.capitalize()}: {subject.name}")
        yield from _about(comparison, subject)
    if not any(held.then_kb for subject in comparison.subjects for held in subject.memory):
        return
    yield Heading("Memory")
    yield Text(
        f"{year}: the most that the whole program held, kB. Today: used bytes of all buffers of the fresh structure; "
        "retained and peak private memory of its process. In brackets: multiples of "
        f"{comparison.reference}'s."
    )
    yield from (_memory(comparison, subject) for subject in comparison.subjects)


def _overview(comparison: Comparison) -> Table:
    """Findings down, models across."""
    rows = []
    for judged in comparison.findings:
        found = {one.subject: one for one in judged.outcomes}
        cells = [
            Text(_verdict(comparison, found[one]), CLASSES[found[one].outcome]) if one in found else Text("-")
            for one in comparison.asked
        ]
        rows.append([Text(judged.claim, "claim"), Text(judged.section), *cells])
    head = ["the source says", "in its section", *comparison.asked]
    what = "contestant by contestant" if comparison.drawn else "model by model"
    return Table(f"Findings of the source, {what}", head, rows, names=2)


def _evidence(comparison: Comparison, judged: Judged) -> Items:
    """A finding with the figures of each model."""
    then = {one.then for one in judged.outcomes}
    own = [f"By the tables of {comparison.year} it does not hold."] if "holds no longer" in then else []
    lead = [Text(judged.claim, "claim")]
    lead += [Text(" ".join(filter(None, [f"Asked: {judged.asked}.", judged.remark, *own])))]
    return Items(
        [
            Text(f"{one.subject}: {_verdict(comparison, one)}. {one.evidence}.", CLASSES[one.outcome])
            for one in judged.outcomes
        ],
        lead,
    )


def _verdict(comparison: Comparison, outcome: Outcome) -> str:
    """In words; what is asked of curves has no earlier figures that it could have held for."""
    return "does not hold" if comparison.drawn and outcome.outcome == "holds no longer" else outcome.outcome


def _about(comparison: Comparison, subject: Subject) -> Iterator[Block]:
    """A model: its figure and its tables."""
    year, reference = comparison.year, comparison.reference
    yield Text(f"{subject.title}; {year}: {subject.then_title}. {subject.machine}: {subject.command}")
    if subject.counts:
        counts = "; ".join(f"{task} {counts}" for task, counts in subject.counts.items())
        yield Text(f"Counts: {counts}. All that is compared are times of the same work, as ratios.")
    if subject.notes:
        yield Items([Text(note, "gone") for note in subject.notes])
    yield Picture(
        name_of(subject), f"{subject.figure.capitalize()} of the source, and the same of today: {subject.name}"
    )
    lines: list[tuple[str, Callable[[Entry], str]]] = [
        (str(year), lambda one: _then(one, reference)),
        ("today", lambda one: _today(one, reference)),
    ]
    lines += [("interval", lambda one: _interval(one, reference))] if subject.has_intervals else []
    yield Table(
        f"{subject.name}: times as multiples of {reference}'s",
        ["scenario", "when", *comparison.contestants],
        [
            [Text(task), Text(when), *(Text(say(subject.entry(task, one))) for one in comparison.contestants)]
            for task in comparison.tasks
            for when, say in lines
        ],
        names=2,
    )
    if not comparison.tables:
        yield _seconds_of(comparison, subject)
    yield Items(
        [
            Text(
                ">43x: slower, at least so many times, in every launch. 1.3?: a hint, launches are too few to rank it, or the "
                "source's timer ticked too few times. ~1: "
                f"within {percent(ALIKE - 1)}. too short: under {1e3 * SHORTEST_S:g} ms, says nothing."
            )
        ]
    )


def _set_anew(comparison: Comparison, table: SetAnew) -> Iterator[Block]:
    """A table of the source: two columns for each model."""
    whens = [(model, when) for model in table.models for when in (str(comparison.year), "today")]
    yield Table(
        f"{table.name.capitalize()}: {table.caption}",
        [*table.head, *(f"{model}, {when}" for model, when in whens)],
        [
            [
                *map(Text, row.words),
                *(Text((row.today if when == "today" else row.then).get(model, "")) for model, when in whens),
            ]
            for row in table.rows
        ],
        names=len(table.head),
    )
    if table.notes:
        yield Items([Text(note) for note in table.notes])


def _drawn_anew(drawn: DrawnAnew) -> Iterator[Block]:
    """A figure of the source: the picture, its figures, what they come from."""
    yield Heading(f"{drawn.name.capitalize()}: {drawn.caption}")
    yield Picture(file_of(drawn), f"{drawn.name.capitalize()} of the source, drawn by today's runs: {drawn.caption}")
    yield _times_of(drawn)
    if drawn.count:
        yield _counts_of(drawn)
    broken = dict.fromkeys(line.contestant for panel in drawn.panels for line in panel.lines if not line.is_exact)
    notes = [*(f"{name}'s answers are wrong: it is compared with nothing." for name in broken), *drawn.notes]
    notes += [f"{one}." for one in least_of(drawn)]
    notes += dict.fromkeys(f"{panel.about}: {panel.run}" for panel in drawn.panels)
    yield Items([Text(note) for note in notes])


def _times_of(drawn: DrawnAnew) -> Table:
    """Places down, contestants across; along a run a line for each tenth of it."""
    return _points_of(drawn, f"{drawn.name.capitalize()}: {drawn.up}", _time)


def _counts_of(drawn: DrawnAnew) -> Table:
    return _points_of(drawn, f"{drawn.name.capitalize()}: {drawn.count}", _count)


def _points_of(drawn: DrawnAnew, caption: str, say: Callable[[At], str]) -> Table:
    lines = [(panel, line) for panel in drawn.panels for line in panel.lines]
    known = [{point.place: say(point) for point in _shown(drawn, line)} for _, line in lines]
    places = sorted({place for points in known for place in points})
    several = len(drawn.panels) > 1
    return Table(
        caption,
        [drawn.across, *(f"{panel.name}, {line.contestant}" if several else line.contestant for panel, line in lines)],
        [[Text(f"{place:,.0f}"), *(Text(points.get(place, MISSING)) for points in known)] for place in places],
    )


def _shown(drawn: DrawnAnew, line: Drawn) -> Sequence[At]:
    """The points of a line that a table shows."""
    if not drawn.is_along:
        return line.points
    every = max(1, len(line.points) // TENTH)
    return line.points[every - 1 :: every]


def _time(point: At) -> str:
    if point.high is None:
        return "unclear"
    return three_digits(point.time) + ("" if point.is_whole else "?")


def _count(point: At) -> str:
    return MISSING if point.count is None else f"{point.count:,.0f}"


def _seconds_of(comparison: Comparison, subject: Subject) -> Table:
    """Times as they were printed, and as they were taken."""
    year = comparison.year
    return Table(
        f"{subject.name}: seconds, {year} as printed, today's with today's counts",
        ["scenario", "when", *comparison.contestants],
        [
            [Text(task), Text(when), *(Text(say(subject.entry(task, one))) for one in comparison.contestants)]
            for task in comparison.tasks
            for when, say in ((f"{year}, s", _then_seconds), ("today", _seconds))
        ],
        names=2,
    )


def _then(entry: Entry, reference: str) -> str:
    if entry.then_ratio is None:
        return ""
    if entry.contestant == reference:
        return "1"
    return f"{two_digits(entry.then_ratio)}?" if entry.is_coarse else times(entry.then_ratio)


def _today(entry: Entry, reference: str) -> str:
    return "1" if entry.contestant == reference and entry.ratio is not None else entry.sign


def _interval(entry: Entry, reference: str) -> str:
    return "" if entry.contestant == reference or not entry.is_whole else entry.interval


def _then_seconds(entry: Entry) -> str:
    return f"{entry.then_s:.2f}" if entry.then_s is not None else ""


def _seconds(entry: Entry) -> str:
    return duration(entry.seconds) if entry.seconds is not None else entry.sign


def _memory(comparison: Comparison, subject: Subject) -> Table:
    kinds = [kind for kind in KINDS if any(kind in held.bytes for held in subject.memory)]
    rows = [[Text(f"{comparison.year}, kB"), *(Text(_then_memory(held)) for held in subject.memory)]]
    rows += [
        [Text(KINDS[kind]), *(Text(_today_memory(held, kind)) for held in subject.memory)]
        for kind in kinds
    ]  # fmt: skip
    return Table(f"{subject.name}: memory", ["memory", *(held.contestant for held in subject.memory)], rows)


def _then_memory(held: Held) -> str:
    return f"{held.then_kb:,} ({held.then_ratio:.3f})" if held.then_kb and held.then_ratio else ""


def _today_memory(held: Held, kind: str) -> str:
    if kind not in held.bytes:
        return ""
    ratio = f" ({held.ratios[kind]:.3f})" if kind in held.ratios else ""
    return digits(held.bytes[kind] / 1e6) + ratio


# -- how it is set


def _markdown(block: Block, figures: Mapping[str, str]) -> str:
    match block:
        case Heading(text):
            return f"### {_plain(text)}"
        case Text(text):
            return _plain(text)
        case Items(items, lead):
            first = [f"**{_plain(one.text)}**" if one.look == "claim" else _plain(one.text) for one in lead]
            return "\n\n".join([*first, "\n".join(f"- {_plain(one.text)}" for one in items)])
        case Table(caption, head, rows, names):
            lines = [list(map(_plain, head)), ["---"] * names + ["---:"] * (len(head) - names)]
            lines += [[_plain(cell.text) for cell in row] for row in rows]
            return "\n".join([f"**{_plain(caption)}**", "", *(f"| {' | '.join(line)} |" for line in lines)])
        case Picture(name, text):
            return f"![{_plain(text)}]({figures[name]})"


def _plain(text: str) -> str:
    """On one line, and without what Markdown would take for its own."""
    return re.sub(r"([\\`*<>|~\[\]])", r"\\\1", printable(" ".join(text.split())))


def _html(block: Block, figures: Mapping[str, str]) -> str:
    match block:
        case Heading(text):
            return f"<h3>{escape(text)}</h3>"
        case Text():
            return _tag("p", block)
        case Items(items, lead):
            first = [_tag("h4" if one.look == "claim" else "p", one) for one in lead]
            return "\n".join([*first, "<ul>", *(_tag("li", one) for one in items), "</ul>"])
        case Table(caption, head, rows, names):
            top = "".join(
                _tag("th", Text(name, "words" if place < names else ""), scope="col") for place, name in enumerate(head)
            )
            lines = [
                "".join(_tag("th", cell, scope="row") for cell in row[:names])
                + "".join(_tag("td", cell) for cell in row[names:])
                for row in rows
            ]
            return "\n".join(
                [
                    f'<div class="scroll" tabindex="0" role="region" aria-label="{escape(caption)}">',
                    f"<table>\n<caption>{escape(caption)}</caption>\n<thead><tr>{top}</tr></thead>\n<tbody>",
                    *(f"<tr>{line}</tr>" for line in lines),
                    "</tbody>\n</table>\n</div>",
                ]
            )
        case Picture(name, text):
            return f"<figure>\n{figures[name]}\n<figcaption>{escape(text)}</figcaption>\n</figure>"


def _tag(name: str, text: Text, scope: str = "") -> str:
    marks = [f' {mark}="{value}"' for mark, value in (("scope", scope), ("class", text.look)) if value]
    return f"<{name}{''.join(marks)}>{escape(text.text)}</{name}>"
