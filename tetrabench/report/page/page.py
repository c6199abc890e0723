"""Puts the page together: numbers to charts and tables, charts to pictures, all of it into one file."""

import functools
import gzip
import re
from base64 import b64encode
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from importlib.metadata import version
from importlib.resources import files
from typing import TYPE_CHECKING, Any

from tetrabench import registry
from tetrabench.errors import InputError
from tetrabench.report.advice import overview_of
from tetrabench.report.page import figures, tables
from tetrabench.report.page.charts import Charts, Spec
from tetrabench.report.page.looks import PATHS, looks_of, shapes_of
from tetrabench.report.page.subjects import ABSOLUTE, OWN, Run, Subject, bases_of, make_subjects
from tetrabench.report.page.tables import Table
from tetrabench.report.pages import pages_of
from tetrabench.report.recommend import recommend_usual, unmeasured
from tetrabench.report.sheets import Pages

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
    svg: str
    table: Table


@dataclass(frozen=True)
class Section:
    """Figures under one heading."""

    name: str
    title: str
    words: str
    figures: list[Figure]


def make_page(
    runs: Sequence[tuple[str, Any]],
    *,
    extra: Sequence[tuple[str, str]] = (),
    told: Callable[[str], None] = lambda _: None,
) -> str:
    """The page of some runs as HTML.

    Args:
        runs: names, and the results (record.Results) that they stand for.
        extra: further sections: titles, and fragments of HTML that are safe to show.
        told: is called with what is being done.

    Raises:
        InputError: there is nothing to show, or the extra `report` is not installed.
    """
    named = [Run(name, results) for name, results in runs]
    subjects = make_subjects(named)
    bases = bases_of(subjects)
    looks = looks_of(subjects)
    shapes = shapes_of([subject.label for subject in subjects])
    sections = list(_sections(subjects, bases, Charts(looks, shapes, bases[0]), told))
    told("writing the page")
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
        memory=tables.memory_table(subjects),
        version=version("tetrabench"),
        wrong=[(one.label, row) for one in subjects for row in one.rows() if row.verdict in ("wrong", "unstable")],
        looks=looks,
        shapes=shapes,
        paths=PATHS,
        bases=[(base, _base_words(base, subjects)) for base in bases],
        figures={figure.name: _packed(figure) for section in sections for figure in section.figures},
        style=_text("style.css"),
        script=_text("script.js"),
        library=_library(),
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
    return "the reference of each" if base == OWN else base


def _sections(
    subjects: Sequence[Subject], bases: Sequence[str], charts: Charts, told: Callable[[str], None]
) -> Iterator[Section]:
    """Everything that there is something to show of."""
    times, samples = figures.times(subjects, bases), figures.samples(subjects)
    reference = bases[0] if bases[0] != OWN else "its reference"
    drawn = []
    for task, rows in times.items():
        told(f"drawing {task}")
        words = f"Time of {task} of each backend, compared with {reference}; the numbers are in the table beside it."
        table = tables.times_table(subjects, task, rows, bases[0])
        drawn.append(_figure(f"times-{task}", "times", task, words, charts.times(rows), table))
        if task in samples:
            words = f"All samples of {task} over rounds, as multiples of {reference}'s; shaded is what differs between equals."
            spec, table = charts.samples(samples[task], reference), tables.samples_table(samples[task])
            drawn.append(_figure(f"samples-{task}", "samples", f"{task}: all samples", words, spec, table))
    yield Section("scenarios", "Scenario by scenario", TIMES, drawn)
    told("drawing memory")
    kind, trade = figures.trade(subjects)
    item = subjects[0].item
    if trade:
        words = (
            "Time of one run against memory, a panel for each scenario; filled marks and the line are the Pareto front."
        )
        drawn = []
        for label in dict.fromkeys(row["model"] for row in trade):
            mine = [row for row in trade if row["model"] == label]
            spec, table = charts.trade(mine, kind, item), tables.trade_table(mine, kind, item)
            drawn.append(_figure(f"trade-{label}", "trade", label, words, spec, table))
        yield Section("trade", "Time against memory", TRADE, drawn)
    if fields := figures.fields(subjects):
        words = f"Bytes a {item} of each buffer of each backend, stacked."
        figure = _figure(
            "fields",
            "fields",
            "Memory by buffer",
            words,
            charts.fields(fields, item),
            tables.fields_table(fields, item),
        )
        yield Section("memory", "Memory", MEMORY, [figure])
    if grown := figures.growth(subjects):
        things = next(iter(subjects[0].model.size), "items")
        words = f"Time of an item over the number of {things}, both logarithmic, a panel for each scenario."
        figure = _figure(
            "growth", "growth", "Growth", words, charts.growth(grown, things), tables.growth_table(grown, things)
        )
        yield Section("growth", "Growth with size", GROWTH, [figure])
    if limits := figures.limits(subjects):
        words = "Share of the machine's bandwidth that the least traffic of each scenario takes."
        figure = _figure(
            "limits", "limits", "Share of the limit", words, charts.limits(limits), tables.limits_table(limits)
        )
        yield Section("limits", "How near to the machine's limit", LIMITS, [figure])


TIMES = (
    "Left of the line is faster. A bar is the interval, a filled mark is sure, a hollow one ranks nothing; within the grey "
    "band all are the same."
)
TRADE = (
    "Down and left is better. Filled: no other backend is better in both, by medians; what lies close to such a one may be as "
    "good."
)
MEMORY = (
    "Used bytes of each buffer of the fresh structure, exact; in the table beneath, what a process of its own holds."
)
GROWTH = "A level line is linear growth: an item takes as long whatever the size."
LIMITS = (
    "A storage near 100 % will not become faster by cleverness; one at 3 % waits for memory. Beyond 100 %: caches. Only "
    "scenarios whose least traffic is known."
)


def _figure(name: str, kind: str, title: str, words: str, spec: Spec, table: Table) -> Figure:
    return Figure(name, kind, title, words, spec, _drawn(spec), table)


def _drawn(spec: Spec) -> str:
    """The chart as SVG, without what style.css or the format itself says already: two thirds of the room."""
    svg: str = _vega().vegalite_to_svg(spec)
    svg = re.sub(
        r' (?:pointer-events="none"|opacity="1"|stroke-width="1"|aria-hidden="true"|font-family="[^"]*")', "", svg
    )
    svg = re.sub(r'<path class="(?:fore|back)ground" d="[^"]*"(?: display="none")?/>', "", svg)
    svg = re.sub(r"(\d\.\d)\d+", r"\1", svg)
    return svg.replace("<svg ", '<svg aria-hidden="true" ', 1)  # the chart has words, and the table has the numbers


@functools.cache
def _library() -> str:
    """What draws in the browser, Vega-Embed with Vega-Lite and Vega; gzip in base64, less than half of the room."""
    library: str = _vega().javascript_bundle("window.vegaEmbed = vegaEmbed;")
    return b64encode(gzip.compress(library.encode(), mtime=0)).decode()


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


def _packed(figure: Figure) -> dict[str, Any]:
    """A specification and its numbers, which are a column a name: a third of the room."""
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
