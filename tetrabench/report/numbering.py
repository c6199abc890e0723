"""What a sweep over numberings says, as tables: the time of an item in each, and how many times the natural one's it is."""

from collections.abc import Iterable, Iterator, Mapping, Sequence

from tetrabench.bench.numbering import LARGE, Renumbered, Spread, numberings_of, renumberings, spreads
from tetrabench.bench.record import Results
from tetrabench.bench.statistics import CLEAR, SHORTEST_S, Row, summary
from tetrabench.errors import InputError
from tetrabench.report.cells import MISSING, interval_of, ratio_of, word_of
from tetrabench.report.notes import about_machine
from tetrabench.report.parts import shown_name
from tetrabench.report.sheets import Cell, Pages, Sheet
from tetrabench.report.units import duration, plural, two_digits


def make_numbering_pages(results: Results, *, intervals: bool = False) -> Pages:
    """The tables of a sweep over numberings; with `intervals` the ends of each rather than its middle.

    Raises:
        InputError: the run has no model in several numberings.
    """
    swept = numberings_of(results)
    if not swept:
        raise InputError(f"'{results.command}' has one numbering: run it with --numbering natural,shuffled")
    rows = summary(results)
    renumbered, spread = renumberings(results, rows), spreads(results, rows)
    sheets = []
    for model, names in swept.items():
        mine = [one for one in renumbered if one.model == model]
        sheets += [_times(results, rows, model, names), _ratios(results, mine, model, intervals)]
        sheets[-1].notes.extend(_about_spreads([one for one in spread if one.model == model]))
    return Pages(sheets=sheets, notes=list(_about_run(results, renumbered, intervals)))


def _times(results: Results, rows: Iterable[Row], model: str, names: Mapping[str, str]) -> Sheet:
    """The time of an item, of each contestant in each numbering."""
    known = {(row.model, row.task, row.backend): row for row in rows}
    return _sheet(
        results,
        f"{model}: time of an item, by numbering",
        {
            (task.name, numbering): {
                one.name: _time_of(known.get((name, task.name, one.name))) for one in results.backends
            }
            for task in results.tasks
            for numbering, name in names.items()
        },
    )


def _ratios(results: Results, renumbered: Iterable[Renumbered], model: str, intervals: bool) -> Sheet:
    """The time in each numbering as a multiple of that in the natural one."""
    say = interval_of if intervals else ratio_of
    lines: dict[tuple[str, str], dict[str, Cell]] = {}
    for one in renumbered:
        lines.setdefault((one.task, one.numbering), {})[one.backend] = Cell(say(_as_row(one)), one.verdict)
    return _sheet(results, f"{model}: times in each numbering as multiples of those in the natural one", lines)


def _sheet(results: Results, title: str, lines: Mapping[tuple[str, str], Mapping[str, Cell]]) -> Sheet:
    """A line for each task and numbering, a column for each contestant; lines of nobody are left out."""
    backends = [one for one in results.backends if not one.control]
    missing = Cell(MISSING, MISSING)
    return Sheet(
        title=title,
        head=["scenario", "numbering", *map(shown_name, backends)],
        rows=[
            [Cell(task), Cell(numbering), *(cells.get(one.name, missing) for one in backends)]
            for (task, numbering), cells in lines.items()
            if any(cells.get(one.name, missing) != missing for one in backends)
        ],
    )


def _time_of(row: Row | None) -> Cell:
    if row is None:
        return Cell(MISSING, MISSING)
    if row.seconds is None:
        return Cell(word_of(row), row.verdict)
    return Cell(duration(row.seconds if row.ns_per_item is None else row.ns_per_item * 1e-9))


def _as_row(one: Renumbered) -> Row:
    """What `cells` knows how to spell."""
    return Row(
        model=one.model,
        task=one.task,
        backend=one.backend,
        against=one.backend,
        status="ok" if one.ratio is not None else "",
        verdict=one.verdict,
        ratio=one.ratio,
        low=one.low,
        high=one.high,
        is_bound=one.is_bound,
    )


def _about_spreads(spread: Sequence[Spread]) -> Iterator[str]:
    """Which makes more of a time, the layout or the numbering: of each task the most of both."""
    for task in dict.fromkeys(one.task for one in spread):
        mine = [one for one in spread if one.task == task]
        widest = [
            max((one for one in mine if one.between == kind), key=lambda one: one.ratio, default=None)
            for kind in ("backends", "numberings")
        ]
        yield f"{task}: " + "; ".join(_about_spread(one) for one in widest if one is not None) + "."


def _about_spread(one: Spread) -> str:
    if one.ratio == 1:
        return f"no two {one.between} are shown to differ"
    return f"{one.between} lie up to {two_digits(one.ratio)}x apart ({one.slowest} over {one.fastest}, {one.within})"


def _about_run(results: Results, renumbered: Sequence[Renumbered], intervals: bool) -> Iterator[str]:
    launches = max((one.launches for one in renumbered), default=0)
    yield (
        f"A pair is of the same launch, of {plural(launches, 'launch')}, but not of the same round: minutes lie between two "
        f"numberings, so that only large differences may be believed, and what is not beyond {LARGE:g}x is not ranked."
    )
    verdicts = {one.verdict for one in renumbered}
    bounds = {one.verdict for one in renumbered if one.is_bound}
    signs = [
        (
            "1.32-1.56" if intervals else "1.4x",
            f"ranked, its interval is beyond {LARGE:g}x (sign test over launches, 95 % for all numberings together)",
            any(one.is_whole and one.verdict in ("slower", "faster") for one in renumbered),
        ),
        ("~1", f"all of the interval is within {LARGE:g}x", "same" in verdicts and not intervals),
        (">43x", "slower, at least so many times (in every launch)", "slower" in bounds),
        ("<0.2x", "faster, so many times at most (in every launch)", "faster" in bounds),
        ("0.97-1.42?" if intervals else "unclear", "the interval does not say which", "inconclusive" in verdicts),
        (
            "1.2-1.4?" if intervals else "1.3?",
            f"a hint, not ranked: too few launches for an interval, not beyond {CLEAR:g}x",
            "about" in verdicts,
        ),
        ("too short", f"under {1e3 * SHORTEST_S:g} ms, says nothing", "too short" in verdicts),
    ]
    if said := [f"{sign}: {meaning}" for sign, meaning, occurs in signs if occurs]:
        yield "Signs: " + ". ".join(said) + "."
    yield "Apart: backends by ratios of the same round, numberings by those of this table; only what ranks."
    yield f"{about_machine(results)}: {results.command}"
