"""Puts the page together: numbers to charts and tables, charts to pictures, all of it into one file."""

import gzip
import re
from base64 import b64encode
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from importlib.metadata import version
from importlib.resources import files
from typing import TYPE_CHECKING, Any

import msgspec

from tetrabench import registry
from tetrabench.bench.record import Results
from tetrabench.errors import InputError
from tetrabench.printable import printable
from tetrabench.report.advice.recommend import recommend_usual, unmeasured
from tetrabench.report.advice.words import overview_of
from tetrabench.report.page import figures, line_figures, tables
from tetrabench.report.page.charts import Spec
from tetrabench.report.page.line_charts import LineCharts
from tetrabench.report.page.looks import PATHS, looks_of, shapes_of
from tetrabench.report.page.subjects import ABSOLUTE, OWN, Run, Subject, bases_of, make_runs, make_subjects
from tetrabench.report.page.tables import Table
from tetrabench.report.pages import pages_of
from tetrabench.report.plain import plain
from tetrabench.report.sheets import Pages
from tetrabench.report.units import one_of, plural

if TYPE_CHECKING:
    from jinja2 import Template

NEEDS = "the page needs jinja2 and vl-convert-python: pip install 'tetrabench[report]'"
DIGITS = 6
"""Of numbers that are drawn; those in tables are exact."""


@dataclass(frozen=True)
class Figure:
    """A chart with its table.

    Attributes:
        name: unique on the page; kind: that of `Charts` which made it.
        svg: the chart drawn beforehand: what is seen without scripts, and until a script has drawn it.
        words: what it shows, for those who do not see it.
    """

    name: str
    kind: str
    title: str
    words: str
    spec: Spec
    table: Table
    svg: str = ""


@dataclass(frozen=True)
class Section:
    """Figures under one heading, and further tables beneath."""

    name: str
    title: str
    words: str
    figures: list[Figure]
    tables: list[Table] = field(default_factory=list)


def make_page(
    runs: Sequence[tuple[str, Results]],
    *,
    extra: Sequence[tuple[str, str]] = (),
    step: Callable[[int, int], None] = lambda done, total: None,
) -> str:
    """The page of some runs as HTML.

    Args:
        runs: names, and the results that they stand for.
        extra: further sections: titles, and fragments of HTML that are safe to show.
        step: is told how many of how many charts are drawn.

    Raises:
        InputError: there is nothing to show, or the extra `report` is not installed.
    """
    named = make_runs([(printable(name), plain(results)) for name, results in runs])
    subjects = make_subjects(named)
    bases = bases_of(subjects)
    looks = looks_of(subjects)
    shapes = shapes_of([subject.label for subject in subjects])
    sections = _draw(list(_sections(subjects, bases, LineCharts(looks, shapes, bases[0]))), step)
    return _template().render(
        title=", ".join(shapes),
        runs=named,
        subjects=subjects,
        sections=sections,
        extra=[(f"extra-{place}", title, fragment) for place, (title, fragment) in enumerate(extra)],
        pages=[pages for run in named for pages in pages_of(run.results)],
        advice=[(run.name, pages) for run in named if (pages := _advice(run)) is not None],
        answers=[tables.answers_table(subject) for subject in subjects],
        sheet_table=tables.sheet_table,
        machine_table=tables.machine_table,
        version=version("tetrabench"),
        wrong=[
            (f"{one.name_of(row.backend)} in {row.task} on {one.label}", row.verdict)
            for one in subjects
            for row in one.rows()
            if row.verdict in ("wrong", "unstable")
        ],
        looks=looks,
        plural=plural,
        shapes=shapes,
        paths=PATHS,
        bases=[(base, _base_words(base, subjects)) for base in bases],
        figures=_packed(
            msgspec.json.encode({one.name: _columns(one) for section in sections for one in section.figures})
        ),
        style=_text("style.css"),
        script=_text("script.js"),
        library=_packed(_library()),
    )


def _advice(run: Run) -> Pages | None:
    """What to use for the usual mixes of work; None where the run can answer none."""
    known = registry.workloads(run.results.family).values()
    answered = [one for one in known if not unmeasured(one, run.results)]
    try:
        given = recommend_usual(run.results, answered)
    except InputError:  # a gate's run, or one without its reference: nothing can be recommended from it
        return None
    return overview_of(given) if given else None


def _base_words(base: str, subjects: Sequence[Subject]) -> str:
    if base == ABSOLUTE:
        return "nothing: seconds of one run"
    known = {one.name: subject.name_of(one.name) for subject in subjects for one in subject.backends}
    return known.get(base, "the reference of each")


def _sections(subjects: Sequence[Subject], bases: Sequence[str], charts: LineCharts) -> Iterator[Section]:
    """Everything that there is something to show of; nothing is drawn yet."""
    times, samples = figures.times(subjects, bases), figures.samples(subjects)
    reference = bases[0] if bases[0] != OWN else "its reference"
    found = []
    for task, rows in times.items():
        words = f"Time of {task} of each backend; the numbers are in the table beside it"
        table = tables.times_table(subjects, task, rows, bases[0])
        found.append(Figure(f"times-{task}", "times", task, words, charts.times(rows), table))
        if task in samples:
            words = (
                f"Samples of {task} over rounds, as multiples of {reference}'s; shaded is what differs between equals"
            )
            spec, table = charts.samples(samples[task], reference), tables.samples_table(samples[task], task)
            found.append(Figure(f"samples-{task}", "samples", f"{task}: samples", words, spec, table))
    yield Section("scenarios", "Scenario by scenario", TIMES, found)
    if found := list(_options(subjects, charts)):
        yield Section("options", "What to choose", OPTIONS, found)
    if found := list(_along(subjects, charts)):
        yield Section("along", "Along the run", ALONG, found)
    item = subjects[0].item
    found = []
    for subject in subjects:
        kind, rows = figures.trade(subject)
        if rows:
            words = (
                "Time of one run against memory, a panel for each scenario; filled marks: none is shown to be better"
            )
            table = tables.trade_table(rows, subject.label, kind, item)
            spec = charts.trade(rows, kind, item)
            found.append(Figure(f"trade-{subject.label}", "trade", subject.label, words, spec, table))
    if found:
        yield Section("trade", "Time against memory", TRADE, found)
    fields, memory = figures.fields(subjects), tables.memory_table(subjects)
    if memory.lines:
        found = []
        if any(row["bytes"] >= figures.UNSEEN for row in fields):
            words = f"Bytes {one_of(item)} of each buffer of each backend, stacked"
            table = tables.fields_table(fields, item)
            found = [Figure("fields", "fields", "Memory by buffer", words, charts.fields(fields, item), table)]
        yield Section("memory", "Memory", MEMORY, found, [memory])
    if grown := figures.growth(subjects):
        things = next(iter(subjects[0].model.size), "items")
        words = f"Time of an item over the number of {things}, both logarithmic, a panel for each scenario"
        spec, table = charts.growth(grown, things), tables.growth_table(grown, things)
        yield Section("growth", "Growth with size", GROWTH, [Figure("growth", "growth", "Growth", words, spec, table)])
    if limits := figures.limits(subjects):
        words = "Share of the machine's bandwidth that the least traffic of each scenario takes"
        spec, table = charts.limits(limits), tables.limits_table(limits)
        shown = Figure("limits", "limits", "Share of the limit", words, spec, table)
        yield Section("limits", "How near to the machine's limit", LIMITS, [shown])


def _options(subjects: Sequence[Subject], charts: LineCharts) -> Iterator[Figure]:
    """Time over each option of a contestant and each count of a scenario that has several values."""
    for subject in subjects:
        where = f", {subject.label}" if len(subjects) > 1 else ""
        for kind, found in (
            ("option", line_figures.over_options(subject)),
            ("count", line_figures.over_counts(subject)),
        ):
            for curves, rows in found:
                of = f" of {curves.contestant}" if curves.contestant else ""
                words = f"Time of an item of {curves.task}{where} over {curves.option}{of}"
                yield Figure(
                    f"{kind}-{curves.option}-{curves.task}-{subject.label}",
                    "curves",
                    f"{curves.task}{where}: over {curves.option}{of}",
                    f"{words}; the numbers are in the table beside it",
                    charts.curves(rows, curves.option),
                    tables.curves_table(subject, curves),
                )


def _along(subjects: Sequence[Subject], charts: LineCharts) -> Iterator[Figure]:
    """What was timed, and what was counted, along each run that says so."""
    for subject in subjects:
        where = f", {subject.label}" if len(subjects) > 1 else ""
        for shown in line_figures.along(subject):
            what = f"time of a {shown.axis}" if shown.is_time else "counts"
            rest = f"; {plural(shown.left_out, 'backend')} with other options not drawn" if shown.left_out else ""
            yield Figure(
                f"along-{what}-{shown.task}-{subject.label}",
                "along",
                f"{shown.task}{where}: {what}{rest}",
                f"Along the run of {shown.task}{where}, {what}, a panel for each quantity, a line for each backend",
                charts.along(shown.rows, shown.axis, is_time=shown.is_time),
                tables.along_table(shown, subject.label),
            )


def _draw(sections: Sequence[Section], step: Callable[[int, int], None]) -> list[Section]:
    """The same with all charts drawn."""
    total, done, drawn = sum(len(section.figures) for section in sections), 0, []
    for section in sections:
        shown = []
        for figure in section.figures:
            step(done, total)
            shown.append(replace(figure, svg=_drawn(figure.spec)))
            done += 1
        drawn.append(replace(section, figures=shown))
    return drawn


TIMES = (
    "Left of the line is faster. A filled mark is sure, a hollow one ranks nothing: a hint (about), where launches are too "
    "few, or inconclusive. A bar is the interval, with too few launches their range; on the reference it is what a second "
    "copy of it did. Within the grey band all are the same."
)
OPTIONS = (
    "Time of an item, with the range of the launches, over what was chosen. In a ring: the least of a line. Hollow: shown to "
    "be slower than that; of those that cannot be told apart from it all are filled. A level line is who has no such choice, "
    "at its quickest; whoever is ten times off is in the table alone. (wrong answers): known to be so, ranked nowhere."
)
ALONG = (
    "The run in stretches. Times are those of one step, with all phases and phase by phase, medians over samples. Counts are "
    "those at the end of each stretch; splits, merges and the like since the run began. (wrong answers): known to be so, "
    "ranked nowhere."
)
TRADE = (
    "Down and left is better. The line is the Pareto front of the medians. Filled: no other backend is shown to be better in "
    "one of both and not worse in the other."
)
MEMORY = (
    "Used bytes of each buffer of the fresh structure, exact; in the table beneath, what a process of its own holds."
)
GROWTH = "A level line is linear growth: an item takes as long whatever the size."
LIMITS = (
    "A storage near 100 % will not become faster by cleverness; one at 3 % waits for memory. Beyond 100 %: caches. Only "
    "scenarios whose least traffic is known."
)


def _drawn(spec: Spec) -> str:
    """The chart as SVG, without what style.css or the format itself says already: two thirds of the room."""
    svg: str = _vega().vegalite_to_svg(spec)
    svg = re.sub(r"<[^>]*>", lambda tag: _slim(tag[0]), svg)  # never the words between tags
    svg = re.sub(r'<path class="(?:fore|back)ground" d="[^"]*"(?: display="none")?/>', "", svg)
    return svg.replace("<svg ", '<svg aria-hidden="true" ', 1)  # the chart has words, and the table has the numbers


NEEDLESS = re.compile(
    r' (?:pointer-events="none"|opacity="1"|stroke-width="1"|aria-hidden="true"|font-family="[^"]*"|role="graphics-[a-z]*"'
    r'|aria-roledescription="[^"]*")'
)
"""Attributes that say what is so anyway, or what the words of a chart say."""


def _slim(tag: str) -> str:
    """A tag without needless attributes, its lengths to a tenth of a pixel."""
    return re.sub(r"(\d\.\d)\d+", r"\1", NEEDLESS.sub("", tag))


def _library() -> bytes:
    """What draws in the browser: Vega-Embed with Vega-Lite and Vega."""
    library: str = _vega().javascript_bundle("window.vegaEmbed = vegaEmbed;")
    return library.encode()


def _packed(data: bytes) -> str:
    """Data for script.js, gzip in base64: less than half of the room, and no sign that a page could take for its own."""
    return b64encode(gzip.compress(data, mtime=0)).decode()


def _vega() -> Any:
    try:
        import vl_convert
    except ImportError as error:
        raise InputError(NEEDS) from error
    return vl_convert


def _template() -> "Template":
    try:
        from jinja2 import Environment, StrictUndefined
    except ImportError as error:
        raise InputError(NEEDS) from error
    environment = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    return environment.from_string(_text("page.html.jinja"))


def _text(name: str) -> str:
    return files(__package__).joinpath(name).read_text(encoding="utf-8")


def _columns(figure: Figure) -> dict[str, Any]:
    """A specification and its numbers, which are a column a name."""
    rows = figure.spec["data"]["values"]
    spec = {**figure.spec, "data": {"name": "rows"}}
    columns = list(dict.fromkeys(name for row in rows for name in row))
    return {
        "kind": figure.kind,
        "spec": spec,
        "columns": {name: [_short(row.get(name)) for row in rows] for name in columns},
    }


def _short(value: Any) -> Any:
    return float(f"{value:.{DIGITS}g}") if isinstance(value, float) else value
