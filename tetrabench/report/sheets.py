"""What the tables of a run say, before they are set in type.

Tasks go down, as in the source's own tables: there are more of them than contestants, and who chooses a layout reads
along the line of what his program does most. A cell holds a figure only where one may stand.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field

from tetrabench.bench.growth import Growth, growth
from tetrabench.bench.record import Backend, Results
from tetrabench.bench.statistics import Row, summary
from tetrabench.report import notes
from tetrabench.report.cells import MISSING, interval_of, ratio_of, word_of
from tetrabench.report.memory import memory_of
from tetrabench.report.parts import Part, make_parts, shown_name
from tetrabench.report.units import digits, duration, percent, span


@dataclass(frozen=True)
class Cell:
    """What stands in a cell, and the verdict that it comes from ("" where there is none)."""

    text: str
    verdict: str = ""


@dataclass(frozen=True)
class Sheet:
    """A table: the first column is words, all others are figures.

    Attributes:
        costs: further rows, under the same contestants, of what belongs to no task.
    """

    title: str
    head: list[str]
    rows: list[list[Cell]]
    costs: list[list[Cell]] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)


@dataclass(frozen=True)
class Pages:
    """All tables of a run, and what is to be said of all of them."""

    sheets: list[Sheet]
    notes: list[str]


def make_pages(results: Results, *, intervals: bool = False) -> Pages:
    """Everything that the tables of these results say; with `intervals` the ends of each rather than its middle."""
    rows = summary(results)
    parts = make_parts(results, rows)
    grown = growth(results, rows)
    sheets = [sheet for part in parts for sheet in (_times(part, intervals), _bandwidth(part)) if sheet.rows]
    sheets += [_growth(results, grown, intervals)] if any(one.exponent is not None for one in grown) else []
    return Pages(sheets=sheets, notes=list(notes.about_run(results, rows, grown, intervals)))


def _times(part: Part, intervals: bool) -> Sheet:
    """A multiple of the reference's time in each cell, and what does not belong to one task below."""
    if part.results.profile == "check":
        return _answers(part)
    lead: list[Callable[[Row], str]] = [lambda row: duration(row.seconds) if row.seconds is not None else ""]
    if not intervals:  # there is no room for it beside them
        lead += [lambda row: duration(row.ns_per_item * 1e-9) if row.ns_per_item is not None else ""]
    return Sheet(
        title=part.title,
        head=["scenario", f"{part.reference} takes", "per item"][: 1 + len(lead)] + _heads(part),
        rows=[
            [
                Cell(task),
                *(Cell(figure(row) if (row := part.rows.get((task, part.reference))) else "") for figure in lead),
                *(_compared(part, task, backend, intervals) for backend in part.backends),
            ]
            for task in part.tasks
        ],
        costs=_costs(part, len(lead)),
        notes=list(notes.about_part(part)),
    )


def _answers(part: Part) -> Sheet:
    """Who gave the answer that most gave: of a run that measured nothing."""
    words = {
        key: Cell("agrees") if row.status == "ok" else Cell(word_of(row), row.verdict) for key, row in part.rows.items()
    }
    return Sheet(
        title=part.title,
        head=["scenario", *_heads(part)],
        rows=[
            [Cell(task), *(words.get((task, one.name), Cell(MISSING, MISSING)) for one in part.backends)]
            for task in part.tasks
        ],
        notes=list(notes.about_part(part)),
    )


def _bandwidth(part: Part) -> Sheet:
    """The share of the machine's bandwidth that the least traffic of each task took."""
    tasks = [task for task in part.tasks if any(_share(part, task, one) for one in part.backends)]
    reference = {task: row for task in tasks if (row := part.rows.get((task, part.reference)))}
    return Sheet(
        title=f"{part.title.partition(':')[0]}: bandwidth, as a share of the machine's",
        head=["scenario", f"{part.reference} GB/s", *_heads(part)],
        rows=[
            [
                Cell(task),
                Cell(digits(row.gb_per_s) if (row := reference.get(task)) and row.gb_per_s else ""),
                *(Cell(_share(part, task, backend)) for backend in part.backends),
            ]
            for task in tasks
        ],
    )


def _growth(results: Results, grown: Iterable[Growth], intervals: bool) -> Sheet:
    """The exponent of each contestant in each task."""
    cells = {(one.task, one.backend): one for one in grown}
    backends = [backend for backend in results.backends if not backend.control]
    fitted = [one for one in cells.values() if one.exponent is not None]
    smallest, largest = min(one.smallest for one in fitted), max(one.largest for one in fitted)
    return Sheet(
        title=f"Growth: time ~ size ** exponent, from {smallest:,} to {largest:,}",
        head=["scenario", *map(shown_name, backends)],
        rows=[
            [Cell(task), *(Cell(_exponent(cells.get((task, one.name)), intervals)) for one in backends)]
            for task in dict.fromkeys(task for task, _ in cells)
        ],
        notes=list(notes.about_growth(cells.values())),
    )


def _exponent(grown: Growth | None, intervals: bool) -> str:
    if grown is None or grown.exponent is None or grown.low is None or grown.high is None:
        return "" if grown is None else "none"
    text = span(grown.low, grown.high) if intervals else f"{grown.exponent:.2f}"
    return text if grown.is_whole else f"{text}?"


def _heads(part: Part) -> list[str]:
    return [_head(backend) for backend in part.backends]


def _head(backend: Backend) -> str:
    return shown_name(backend) + (" =1" if backend.name == backend.against else "")


def _compared(part: Part, task: str, backend: Backend, intervals: bool) -> Cell:
    row = part.rows.get((task, backend.name))
    if row is None:
        return Cell(MISSING, MISSING)
    if row.verdict == "reference" and intervals and task in part.controls:
        row = part.controls[task]  # what it differs by from itself
    return Cell(interval_of(row) if intervals else ratio_of(row), row.verdict)


def _share(part: Part, task: str, backend: Backend) -> str:
    row = part.rows.get((task, backend.name))
    return percent(row.share_of_limit) if row is not None and row.share_of_limit is not None else ""


def _costs(part: Part, columns: int) -> list[list[Cell]]:
    """Memory, and the time before the first sample; `columns` stand before the contestants."""
    lines: list[tuple[str, str, dict[str, str]]] = [
        (
            kind,
            f"B/{part.item}" if kind == "structure" else f"~B/{part.item}",
            {name: f"{size:,.0f}" if isinstance(size, float) else size for name, size in sizes.items()},
        )
        for kind, sizes in memory_of(part).items()
    ]
    if part.model == part.results.models[0]:
        compiled = {one.name: digits(one.compile_s) for one in part.backends if one.compile_s}
        lines += [("compiling", "s", compiled)] if compiled else []
    return [
        [
            Cell(kind),
            Cell(unit),
            *[Cell("")] * (columns - 1),
            *(Cell(figures.get(backend.name, "")) for backend in part.backends),
        ]
        for kind, unit, figures in lines
    ]
