"""The table of a run: a scenario a row, a contestant a column, each cell a multiple of the reference's time.

Scenarios go down, as in the source's own tables: there are more of them than contestants, and who chooses a
layout reads along the line of what his program does most. A cell holds a figure only where one may stand.
"""

import io
import textwrap
from collections.abc import Iterator
from dataclasses import dataclass

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table
from rich.text import Text

from tetrabench.bench.record import Backend, Results
from tetrabench.bench.statistics import SHORTEST_S, Row, summary
from tetrabench.report.memory import bytes_per_item, peak_bytes
from tetrabench.report.units import digits, duration, singular, times

PROVISIONAL = "Provisional: medians of paired ratios without intervals; differences under 25 % are not ranked."

WIDTH = 100

WORDS = {
    "reference": "1",
    "too short to rank": "too short",
    "no reference": "no ref.",
    "inconclusive": "unclear",
}
_STYLES = {  # a second way to see what the words and signs say already
    "faster": "green",
    "slower": "bold",
    "about the same": "dim",
    "too short to rank": "dim",
    "inconclusive": "dim",
    "skipped": "dim",
    "wrong": "bold red",
    "crashed": "bold red",
    "failed": "bold red",
}


@dataclass(frozen=True)
class Cell:
    """What stands in a cell, and the verdict that it comes from ("" where there is none)."""

    text: str
    verdict: str = ""


@dataclass(frozen=True)
class Sheet:
    """The table before it is set in type: the first column is words, all others are figures."""

    title: str
    head: list[str]
    times: list[list[Cell]]
    costs: list[list[str]]
    notes: list[str]


def make_sheet(results: Results) -> Sheet:
    """Everything that a table of these results says."""
    rows = summary(results)
    reference = results.reference
    by_cell = {(row.scenario, row.backend): row for row in rows}
    return Sheet(
        title=about_model(results),
        head=[
            "scenario",
            f"{reference} takes",
            "per item",
            *(_head(one, reference) for one in results.backends),
        ],
        times=[
            [
                Cell(scenario),
                *_absolute(by_cell.get((scenario, reference))),
                *(_relative(by_cell.get((scenario, backend.name))) for backend in results.backends),
            ]
            for scenario in _scenarios(rows)
        ],
        costs=_costs(results, rows),
        notes=list(_notes(results, rows)),
    )


def as_text(results: Results, *, colour: bool = False) -> str:
    """The table for a terminal; with `colour` in its colours, unless NO_COLOR is set."""
    sheet = make_sheet(results)
    table = Table(box=SIMPLE_HEAD, show_edge=False, padding=0, header_style="bold")
    for place, name in enumerate(sheet.head):
        table.add_column(Text(name), justify="right" if place else "left", no_wrap=True, min_width=6)
    for row in (*sheet.times, []):
        table.add_row(*(Text(cell.text, _STYLES.get(cell.verdict, "")) for cell in row))
    for line in sheet.costs:
        table.add_row(*line)
    console = Console(file=io.StringIO(), width=1000, force_terminal=colour, highlight=False)
    with console.capture() as page:
        notes = (Text(_wrap(note)) for note in sheet.notes)
        console.print(Text(sheet.title, "bold"), "", table, "", *notes, sep="\n")
    return "\n".join(line.rstrip() for line in page.get().splitlines()) + "\n"


def as_markdown(results: Results) -> str:
    """The same in Markdown."""
    sheet = make_sheet(results)
    rows = [sheet.head, ["---", *["---:"] * (len(sheet.head) - 1)]]
    rows += [[cell.text for cell in row] for row in sheet.times] + sheet.costs
    lines = [f"| {' | '.join(row)} |".replace("~", "\\~").replace("* ", "\\* ") for row in rows]
    return "\n".join([f"**{sheet.title}**", "", *lines, "", *(f"- {note}" for note in sheet.notes)]) + "\n"


def _plural(number: int, thing: str) -> str:
    return f"{number} {thing}" + "s" * (number != 1)


def _wrap(note: str) -> str:
    return textwrap.fill(note, WIDTH, subsequent_indent="  ", break_long_words=False, break_on_hyphens=False)


def about_model(results: Results) -> str:
    """Model, its size, and how often it was measured."""
    rounds = 1 + max((sample.round for sample in results.samples), default=0)
    facts = [f"{number:,} {things}" for things, number in results.model_size.items()]
    facts += ["the source's counts on one net" if results.profile == "thesis" else _plural(rounds, "round")]
    return f"{results.model}: {', '.join(facts)}"


def about_machine(results: Results) -> str:
    """Day, processor, system."""
    known = results.environment
    facts = [known.get("processor"), known.get("system"), f"Python {known.get('python')}"]
    return ", ".join([results.started[:10], *(str(fact) for fact in facts if fact)])


def _head(backend: Backend, reference: str) -> str:
    return backend.name + ("*" if backend.extension else "") + (" =1" if backend.name == reference else "")


def _absolute(row: Row | None) -> list[Cell]:
    if row is None or row.cpu_s is None:
        return [Cell(""), Cell("")]
    per_item = "" if row.ns_per_item is None else duration(row.ns_per_item * 1e-9)
    return [Cell(duration(row.cpu_s)), Cell(per_item)]


def _relative(row: Row | None) -> Cell:
    if row is None:
        return Cell("")
    if row.verdict in ("faster", "slower") and row.ratio is not None:
        return Cell(times(row.ratio), row.verdict)
    if row.verdict == "about the same" and row.ratio is not None:
        return Cell(f"~{row.ratio:.1f}", row.verdict)
    return Cell(WORDS.get(row.verdict, row.verdict), row.verdict)


def _costs(results: Results, rows: list[Row]) -> list[list[str]]:
    """What does not belong to one scenario: memory, and the time before the first one."""
    item = singular(next(iter(results.model_size), "items"))
    sizes, peaks = bytes_per_item(results), peak_bytes(rows)
    ready = {backend.name: backend.compile_s for backend in results.backends if backend.compile_s}
    lines = [
        ("structure", f"B/{item}", {name: f"{size:,.0f}" for name, size in sizes.items()}),
        ("peak", "MB", {name: f"{size / 1e6:,.0f}" for name, size in peaks.items()}),
        ("compiling", "s", {name: digits(seconds) for name, seconds in ready.items()}),
    ]
    return [
        [label, unit, "", *(figures.get(backend.name, "") for backend in results.backends)]
        for label, unit, figures in lines
        if figures
    ]


def _notes(results: Results, rows: list[Row]) -> Iterator[str]:
    yield _about_answers(results, rows)
    reasons: dict[tuple[str, str, str], list[str]] = {}
    for row in rows:
        if row.reason:
            reasons.setdefault((row.backend, row.verdict, row.reason), []).append(row.scenario)
    for (backend, verdict, reason), scenarios in reasons.items():
        yield f"{backend}, {verdict} in {', '.join(scenarios)}: {reason}"
    yield (
        f"Figures: CPU time, times that of {results.reference} (less is better). ~ is within 25 % of it. "
        f"too short: both under {duration(SHORTEST_S)}, says nothing. unclear: rounds contradict each other, or are too few."
    )
    if items := _items(results):
        yield f"An item is {items}."
    yield (
        "Structure: the fresh net, no slack. Peak: the whole process with Python and the compiler; equal runs "
        "differ by 100 MB."
    )
    yield (
        "Compiling: in a first run, where whoever comes first also compiles what all share; later, loading what "
        "was compiled."
    )
    if any(backend.extension for backend in results.backends):
        yield "Names with a * are not from the source."
    yield f"{about_machine(results)}: {results.command}"
    if results.interrupted:
        yield "Interrupted: samples are missing."
    if results.provisional:
        yield PROVISIONAL


def _about_answers(results: Results, rows: list[Row]) -> str:
    wrong = list(dict.fromkeys(row.scenario for row in rows if row.verdict == "wrong"))
    if wrong:
        return f"WRONG ANSWERS in {', '.join(wrong)}: contestants disagree; see below."
    compared = [scenario for scenario in _scenarios(rows) if _said(rows, scenario) > 1]
    if not compared:
        return "Answers: none compared, for that at least two contestants have to end well."
    everyone = all(row.status == "ok" for row in rows)
    who = f"All {len(results.backends)} contestants" if everyone else "All contestants that ended"
    return f"{who} gave the same answers: {_plural(len(compared), 'scenario')}, one digest each."


def _said(rows: list[Row], scenario: str) -> int:
    """How many contestants gave an answer."""
    return sum(row.scenario == scenario and row.status == "ok" for row in rows)


def _scenarios(rows: list[Row]) -> list[str]:
    return list(dict.fromkeys(row.scenario for row in rows))


def _items(results: Results) -> str:
    """What the work of the scenarios is counted in: "a tetra (init, free), a split (explode)"."""
    users: dict[str, list[str]] = {}
    for scenario, unit in dict.fromkeys((one.scenario, one.unit) for one in results.samples if one.unit):
        users.setdefault(unit, []).append(scenario)
    return ", ".join(f"a {singular(unit)} ({', '.join(names)})" for unit, names in users.items())
