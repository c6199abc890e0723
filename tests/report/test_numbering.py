"""The tables of a sweep over numberings: they show what was put in, and say how far it may be believed."""

from statistics import median

import msgspec
import pytest

from tests.bench.test_numbering import make_numbered, off
from tests.report.made import TETRAS, change, make_backend, make_results
from tetrabench.bench.record import Results
from tetrabench.errors import InputError
from tetrabench.report.numbering import make_numbering_pages
from tetrabench.report.sheets import Pages
from tetrabench.report.table import as_markdown, as_text, markdown_of, text_of
from tetrabench.report.units import duration


def cell(pages: Pages, task: str, numbering: str, backend: str, sheet: int = 1) -> str:
    """What stands in a cell of the ratios, or of the times (0)."""
    shown = pages.sheets[sheet]
    place = shown.head.index(backend)
    return next(row[place].text for row in shown.rows if [row[0].text, row[1].text] == [task, numbering])


def notes_of(results: Results, *, intervals: bool = False) -> str:
    """All notes, a line each."""
    pages = make_numbering_pages(results, intervals=intervals)
    return "\n".join([note for sheet in pages.sheets for note in sheet.notes] + pages.notes)


def test_times_and_ratios_are_those_that_were_put_in():
    results = make_numbered(wobble=0.0)
    pages = make_numbering_pages(results)
    assert [sheet.title.partition(":")[0] for sheet in pages.sheets] == ["nozzle", "nozzle"]
    for numbering, model in [("natural", "nozzle"), ("shuffled", "nozzle shuffled")]:
        cells = [one for one in results.samples if (one.model, one.task, one.backend) == (model, "alfa", "v4")]
        assert cell(pages, "alfa", numbering, "v4", 0) == duration(median(one.cpu_s for one in cells) / TETRAS)
    assert cell(pages, "alfa", "shuffled", "v3y") == "4.0x"
    assert cell(pages, "alfa", "hilbert", "v4") == "0.50x"
    assert [row[1].text for row in pages.sheets[1].rows] == ["hilbert", "shuffled"] * 2  # the natural one is 1
    assert not any("control" in name for sheet in pages.sheets for name in sheet.head)


def test_intervals_take_the_place_of_ratios():
    results = make_numbered()
    assert cell(make_numbering_pages(results, intervals=True), "alfa", "shuffled", "v4") == "6.00-6.00"
    assert "1.32-1.56: ranked" in notes_of(results, intervals=True)


@pytest.mark.parametrize(
    ("factor", "launches", "text", "sign"),
    [
        (1.0, 8, "~1", "~1: all of the interval is within 1.25x"),
        (1.24, 8, "unclear", "unclear: the interval"),
        (1.3, 3, "1.3?", "1.3?: a hint"),
        (5.1, 3, ">5.0x", ">43x: slower"),
        (0.2, 3, "<0.20x", "<0.2x: faster"),
        (1e-4, 8, "too short", "too short: under 5 ms"),
    ],
)
def test_a_cell_says_what_may_be_believed(factor: float, launches: int, text: str, sign: str):
    results = make_numbered({"rcm": {"v3y": factor, "v4": factor}}, launches=launches)
    results = off(results, "nozzle rcm", [0.99, 1.02] * 4)
    assert cell(make_numbering_pages(results), "alfa", "rcm", "v3y") == text
    assert sign in notes_of(results)


def test_a_wrong_answer_has_no_figure():
    results = change(make_numbered(), "alfa", "v4", status="wrong-result", reason="another digest")
    pages = make_numbering_pages(results)
    assert [cell(pages, "alfa", "shuffled", "v4", sheet) for sheet in (0, 1)] == ["wrong", "wrong"]
    assert "v4" not in notes_of(results).partition("locate:")[0]


def test_a_cell_that_was_not_run_is_missing_and_a_task_of_nobody_is_left_out():
    results = make_numbered()
    fewer = [
        one for one in results.samples if one.task == "locate" and (one.model, one.backend) != ("nozzle shuffled", "v4")
    ]
    pages = make_numbering_pages(msgspec.structs.replace(results, samples=fewer))
    assert [cell(pages, "locate", "shuffled", "v4", sheet) for sheet in (0, 1)] == ["missing", "missing"]
    assert {row[0].text for sheet in pages.sheets for row in sheet.rows} == {"locate"}


def test_which_makes_more_is_said():
    said = notes_of(make_numbered(wobble=0.0))
    assert (
        "alfa: backends lie up to 6.0x apart (v4 over v3y, shuffled); "
        "numberings lie up to 12x apart (shuffled over hilbert, v4)."
    ) in said
    flat = {"rcm": {"v3y": 1.0, "v4": 1.0}}
    assert "locate: no two backends are shown to differ; no two numberings are shown to differ." in notes_of(
        make_numbered(flat)
    )


def test_it_says_that_pairs_are_not_of_the_same_round():
    said = notes_of(make_numbered())
    assert "of the same launch, of 8 launches, but not of the same round" in said
    assert "only large differences may be believed" in said
    assert said.endswith("tetrabench run --model nozzle")


def test_it_is_set_like_all_tables():
    results = make_numbered()
    strange = [*results.backends[:2], make_backend("v4", extension=True), results.backends[2]]
    results = msgspec.structs.replace(results, backends=[strange[0], strange[2], strange[3]])
    pages = make_numbering_pages(results)
    assert "v4*" in text_of(pages)
    assert "| alfa | shuffled | 4.0x | 6.0x |" in markdown_of(pages)


def test_a_run_of_one_numbering_has_none():
    with pytest.raises(InputError, match="has one numbering: run it with --numbering"):
        make_numbering_pages(make_results())


def test_a_run_that_swept_over_numberings_shows_their_tables_too():
    for form in (as_text, as_markdown):
        assert "by numbering" in form(make_numbered())
        assert "by numbering" not in form(make_results())
