"""The tables of a page: the numbers of each chart beside it, exact in the page's source and short for the eye."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from statistics import median

from tetrabench.bench.record import Results
from tetrabench.report.curves import Curves
from tetrabench.report.memory import memory_of
from tetrabench.report.page.figures import Datum
from tetrabench.report.page.line_figures import Along
from tetrabench.report.page.subjects import Subject
from tetrabench.report.parts import shown_name
from tetrabench.report.sheets import Sheet
from tetrabench.report.units import digits, duration, one_of, percent


@dataclass(frozen=True)
class Entry:
    """A cell: what the eye reads, the exact number behind it, what it is called in style.css and script.js."""

    text: str
    value: float | str | None = None
    kind: str = ""


@dataclass(frozen=True)
class Line:
    """A row: its heads, its cells, and of whom it tells."""

    heads: list[str]
    cells: list[Entry]
    backend: str = ""
    model: str = ""


@dataclass(frozen=True)
class Table:
    """A table: the first `len(line.heads)` columns are heads of their rows, all others are figures."""

    caption: str
    head: list[str]
    lines: list[Line] = field(default_factory=list)


def times_table(subjects: Sequence[Subject], task: str, rows: Iterable[Datum], base: str) -> Table:
    """What a chart of times shows: a line for each backend on each model. script.js writes other bases into it."""
    shown = {(row["model"], row["backend"]): row for row in rows if row["base"] == base}
    cells = {
        (subject.label, subject.name_of(row.backend)): row
        for subject in subjects
        for row in subject.rows()
        if row.task == task and not row.control
    }
    return Table(
        caption=f"{task}: the numbers",
        head=["backend", "model", "one run", "per item", "figure", "interval", "verdict"],
        lines=[
            Line(
                [backend, model],
                [
                    Entry("" if row.seconds is None else duration(row.seconds), row.seconds),
                    Entry("" if row.ns_per_item is None else duration(row.ns_per_item * 1e-9), row.ns_per_item),
                    Entry(datum["text"] or datum["word"], datum["value"], "text"),
                    Entry(datum["span"], None, "span"),
                    Entry(datum["verdict"], None, "verdict"),
                ],
                backend,
                model,
            )
            for (model, backend), row in cells.items()
            if (datum := shown.get((model, backend)))
        ],
    )


def samples_table(rows: Sequence[Datum], task: str) -> Table:
    """How far the samples of each backend are apart."""
    groups: dict[tuple[str, str], list[float]] = {}
    for row in rows:
        groups.setdefault((row["backend"], row["model"]), []).append(row["ratio"])
    return Table(
        caption=f"{task}: samples, as multiples of the reference's of the same round",
        head=["backend", "model", "samples", "least", "median", "largest"],
        lines=[
            Line(
                [backend, model],
                [Entry(str(len(all_))), *(Entry(digits(x), x) for x in (min(all_), median(all_), max(all_)))],
                backend,
                model,
            )
            for (backend, model), all_ in groups.items()
        ],
    )


def trade_table(rows: Sequence[Datum], model: str, kind: str, item: str) -> Table:
    """Time and memory of each backend in each task."""
    return Table(
        caption=f"{model}: time of one run, and {kind} bytes {one_of(item)}; front: none is shown to be better",
        head=["scenario", "backend", "model", "one run", f"bytes {one_of(item)}", "front"],
        lines=[
            Line(
                [row["task"], row["backend"], row["model"]],
                [
                    Entry(row["text"], row["seconds"]),
                    Entry(f"{row['bytes']:,.0f}", row["bytes"]),
                    Entry("front" if row["front"] else ""),
                ],
                row["backend"],
                row["model"],
            )
            for row in rows
        ],
    )


def growth_table(rows: Sequence[Datum], things: str) -> Table:
    """Time of an item for each size."""
    sizes = sorted({row["size"] for row in rows})
    cells: dict[tuple[str, str, str], dict[int, float]] = {}
    for row in rows:
        cells.setdefault((row["task"], row["backend"], row["run"]), {})[row["size"]] = row["ns"]
    return Table(
        caption=f"Time of an item, by the number of {things}",
        head=["scenario", "backend", "run", *(f"{size:,}" for size in sizes)],
        lines=[
            Line([*names], [Entry(_time(known.get(size)), known.get(size)) for size in sizes], names[1])
            for names, known in cells.items()
        ],
    )


def _time(ns: float | None) -> str:
    return "" if ns is None else duration(ns * 1e-9)


def along_table(shown: Along, model: str) -> Table:
    """How each quantity went along the run, of each backend."""
    groups: dict[tuple[str, str], list[Datum]] = {}
    for row in shown.rows:
        groups.setdefault((row["panel"], row["line"]), []).append(row)
    panels = list(dict.fromkeys(row["panel"] for row in shown.rows))
    spell = duration if shown.is_time else _count
    return Table(
        caption=f"{shown.task}, {model}: along the run",
        head=["what", "backend", "first", "least", "median", "largest", "last"],
        lines=[
            Line(
                [panel, line],
                [Entry(spell(x), x) for x in (values[0], min(values), median(values), max(values), values[-1])],
                rows[0]["backend"],
                model,
            )
            for (panel, line), rows in sorted(groups.items(), key=lambda group: panels.index(group[0][0]))
            for values in [[row["value"] for row in rows]]
        ],
    )


def _count(value: float) -> str:
    return f"{value:,.0f}" if value >= 100 or value == int(value) else digits(value)


def curves_table(subject: Subject, curves: Curves) -> Table:
    """Time of an item for each value; then the levels, those that are beyond the chart too."""
    lines = [(curve, point) for curve in (*curves.curves, *curves.levels, *curves.beyond) for point in curve.points]
    return Table(
        caption=f"{curves.task}, {subject.label}: time of an item over {curves.option}",
        head=["backend", curves.option, "per item", "launches", "verdict"],
        lines=[
            Line(
                [curve.label],
                [
                    Entry(f"{point.value:,}", point.value) if curve in curves.curves else Entry(""),
                    Entry(duration(point.seconds), point.seconds),
                    Entry(f"{duration(point.low)} to {duration(point.high)}" if point.low < point.high else ""),
                    Entry("least" if point.is_least else "slower" if point.is_beaten else ""),
                ],
                shown_name(point.line.backend),
                subject.label,
            )
            for curve, point in lines
        ],
    )


def fields_table(rows: Sequence[Datum], item: str) -> Table:
    """Bytes an item of each buffer."""
    names = list(dict.fromkeys(row["field"] for row in rows))
    cells: dict[tuple[str, str], dict[str, float]] = {}
    for row in rows:
        cells.setdefault((row["backend"], row["model"]), {})[row["field"]] = row["bytes"]
    return Table(
        caption=f"Bytes {one_of(item)}, by buffer of the fresh structure",
        head=["backend", "model", *names, "all"],
        lines=[
            Line(
                [backend, model],
                [Entry(_bytes(known.get(name)), known.get(name)) for name in names]
                + [Entry(_bytes(sum(known.values())), sum(known.values()))],
                backend,
                model,
            )
            for (backend, model), known in cells.items()
        ],
    )


def _bytes(size: float | None) -> str:
    if size is None or size == 0:
        return "" if size is None else "0"
    return f"{size:,.0f}" if size >= 9.95 else f"{size:.1f}" if size >= 0.05 else "<0.1"


def memory_table(subjects: Sequence[Subject]) -> Table:
    """Structure, retained and peak bytes an item."""
    kinds = ("structure", "retained", "peak")
    return Table(
        caption="Memory: bytes an item of the fresh structure; what its process retains; the peak while it was built",
        head=["backend", "model", *kinds],
        lines=[
            Line([subject.name_of(one.name), subject.label], cells, subject.name_of(one.name), subject.label)
            for subject in subjects
            for part in subject.parts
            for known in [memory_of(part)]
            for one in part.backends
            if any(one.name in sizes for sizes in known.values())
            for cells in [[_size(known.get(kind, {}).get(one.name, "")) for kind in kinds]]
        ],
    )


def _size(size: float | str) -> Entry:
    return Entry(size) if isinstance(size, str) else Entry(f"{size:,.1f}", size)


def limits_table(rows: Sequence[Datum]) -> Table:
    """Bandwidth and its share of the limit."""
    return Table(
        caption="The least traffic that a task needs, over its time; as a share of the triad's bandwidth",
        head=["scenario", "backend", "model", "GB/s", "share"],
        lines=[
            Line(
                [row["task"], row["backend"], row["model"]],
                [Entry(digits(row["gb_per_s"]), row["gb_per_s"]), Entry(row["text"], row["share"])],
                row["backend"],
                row["model"],
            )
            for row in rows
        ],
    )


def sheet_table(sheet: Sheet) -> Table:
    """A table of `tetrabench show`."""
    return Table(
        caption=sheet.title,
        head=sheet.head,
        lines=[
            Line([row[0].text], [Entry(cell.text, None, cell.verdict.replace(" ", "-")) for cell in row[1:]])
            for row in (*sheet.rows, *sheet.costs)
        ],
    )


def answers_table(subject: Subject) -> Table:
    """Who gave which answer: its digest, from samples that ended well or wrong."""
    samples = [one for one in subject.run.results.samples if one.model == subject.model.name and one.digest]
    answers: dict[str, dict[str, set[str]]] = {}
    for one in samples:
        answers.setdefault(one.task, {}).setdefault(one.digest, set()).add(subject.name_of(one.backend))
    return Table(
        caption=f"{subject.label}: answers",
        head=["scenario", "digest", "given by"],
        lines=[
            Line([task], [Entry(digest), Entry(", ".join(sorted(backends)))])
            for task, digests in answers.items()
            for digest, backends in digests.items()
        ],
    )


def machine_table(results: Results) -> Table:
    """What ran where."""
    launches = results.launches
    facts = {name.replace("_", " "): _spell(value) for name, value in results.environment.items()}
    loads = [one.load_1_minute for one in launches if one.load_1_minute is not None]
    steal = [one.steal_share for one in launches if one.steal_share is not None]
    yards = [one.yardsticks for one in launches if one.yardsticks]
    facts |= {"load when launches began": f"{digits(min(loads))} to {digits(max(loads))}"} if loads else {}
    facts |= {"time taken by other guests": percent(max(steal)) + " at most"} if steal else {}
    facts |= {"copy": f"{digits(median(one.copy_gb_s for one in yards))} GB/s"} if yards else {}
    facts |= {"triad": f"{digits(median(one.triad_gb_s for one in yards))} GB/s"} if yards else {}
    facts |= {"a random access": f"{digits(median(one.latency_ns for one in yards))} ns"} if yards else {}
    facts |= {"begun": results.started, "took": duration(results.elapsed_s)}
    return Table(
        "The machine", ["fact", "value"], [Line([name], [Entry(text)]) for name, text in facts.items() if text]
    )


def _spell(value: object) -> str:
    if isinstance(value, dict):
        return ", ".join(f"{name} {one}" for name, one in value.items())
    return ", ".join(map(str, value)) if isinstance(value, list | tuple) else "" if value is None else str(value)
