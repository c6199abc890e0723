"""The table: what a person may conclude from it, and nothing else."""

import msgspec
import pytest

from tests.report.made import SECONDS, change, make_backend, make_results, make_sample
from tetrabench.report.table import PROVISIONAL, as_markdown, as_text, make_sheet
from tetrabench.report.units import digits, duration, times


def cell(results: object, scenario: str, backend: str) -> str:
    """What stands in a cell."""
    sheet = make_sheet(results)
    place = next(
        place for place, name in enumerate(sheet.head) if name.split(" ")[0].rstrip("*") == backend and place > 2
    )
    return next(row[place].text for row in sheet.times if row[0].text == scenario)


@pytest.mark.parametrize(
    ("scenario", "backend", "text"),
    [
        ("delete", "v3", "711x"),
        ("explode", "v5x", "199x"),
        ("alfa", "v4", "1.9x"),
        ("alfa", "v3y", "1"),
        ("delete", "v4", "~1.2"),  # 22 % more
        ("init", "v5x", "~1.0"),
    ],
)
def test_cells_are_multiples_of_the_reference_and_rank_from_25_percent(scenario, backend, text):
    assert cell(make_results(), scenario, backend) == text


def test_reference_has_its_time_and_that_of_an_item():
    row = next(row for row in make_sheet(make_results(rounds=1)).times if row[0].text == "alfa")
    assert [cell.text for cell in row[1:3]] == ["35.7 s", "55.5 us"]


@pytest.mark.parametrize(
    ("status", "word"),
    [("wrong-result", "wrong"), ("crash", "crashed"), ("error", "failed"), ("skipped", "skipped")],
)
def test_a_bad_cell_has_a_word_and_a_reason_but_no_figure(status, word):
    results = change(make_results(), "alfa", "v4", status=status, reason="the reason")
    assert cell(results, "alfa", "v4") == word
    assert cell(results, "flow", "v4") == "1.5x"
    assert f"v4, {word} in alfa: the reason" in as_text(results)
    assert ("WRONG ANSWERS in alfa" in as_text(results)) == (word == "wrong")


def test_without_a_sound_reference_nothing_is_compared():
    results = change(make_results(), "alfa", "v3y", status="crash", reason="signal 11")
    assert cell(results, "alfa", "v3y") == "crashed"
    assert cell(results, "alfa", "v4") == "no ref."


def test_too_short_samples_are_not_ranked():
    seconds = {"free": {"v3y": 1e-4, "v4": 3e-4, "v5": 1.0}}
    assert cell(make_results(seconds), "free", "v4") == "too short"
    assert cell(make_results(seconds), "free", "v5").endswith("x")  # slower, however short the reference is


def test_a_wrong_or_crashed_contestant_says_nothing_about_the_others_peak():
    results = change(make_results(), "init", "v4", peak_bytes=9 * 10**9)
    assert "9,000" in as_text(results)
    assert "9,000" not in as_text(change(results, "init", "v3", status="crash"))


def test_rounds_that_contradict_each_other_are_not_ranked():
    results = make_results({"alfa": {"v3y": 1.0, "v4": 2.0}}, rounds=3)
    others = [one for one in results.samples if (one.backend, one.round) != ("v4", 2)]
    results = msgspec.structs.replace(results, samples=[*others, make_sample("alfa", "v4", 2, 0.5)])
    assert cell(results, "alfa", "v4") == "unclear"


def test_memory_stands_below_the_same_contestants():
    sheet = make_sheet(make_results())
    structure = dict(zip(sheet.head, sheet.costs[0], strict=True))
    assert sheet.costs[0][:2] == ["structure", "B/tetra"]
    assert (structure["v3y =1"], structure["v4"]) == ("236", "252")
    assert sheet.costs[1][:2] == ["peak", "MB"]


def test_says_that_all_gave_the_same_answers():
    assert "All 7 contestants gave the same answers: 6 scenarios, one digest each." in as_text(make_results())


def test_says_when_there_was_nobody_to_disagree():
    alone = make_results({"alfa": {"v3y": 1.0}})
    assert "none compared" in as_text(alone)


def test_extensions_are_marked():
    backends = [make_backend("v3y"), make_backend("halfface", extension=True)]
    results = make_results({"alfa": {"v3y": 1.0, "halfface": 2.0}}, backends=backends)
    assert make_sheet(results).head[-1] == "halfface*"
    assert "not from the source" in as_text(results)
    assert "not from the source" not in as_text(make_results())


def test_says_that_it_is_provisional_or_interrupted():
    assert PROVISIONAL in as_text(make_results())
    assert PROVISIONAL not in as_text(make_results(provisional=False))
    assert "Interrupted" in as_text(make_results(interrupted=True))


def test_nothing_measured_is_still_a_table():
    empty = make_results(samples=[], model_size={}, interrupted=True)
    assert "Interrupted" in as_text(empty)
    assert as_markdown(empty)


def test_fits_into_100_columns_with_seven_contestants_at_their_widest():
    seconds = {f"scenario-{n}": dict.fromkeys(SECONDS["alfa"], 1e-4) for n in range(12)}
    seconds["sc"] = {**dict.fromkeys(SECONDS["alfa"], 1.0), "v3": 1e5}
    results = make_results(seconds, command="tetrabench run " + "--scenario abc " * 9)
    assert max(map(len, as_text(results).splitlines())) <= 100


def test_markdown_says_the_same():
    results = change(make_results(), "alfa", "v4", status="crash", reason="signal 11")
    sheet, text = make_sheet(results), as_markdown(results)
    rows = [line.strip("| ").split(" | ") for line in text.replace("\\", "").splitlines() if line.startswith("|")]
    assert rows[0] == sheet.head
    assert rows[2:8] == [[cell.text for cell in row] for row in sheet.times]
    assert all(note in text for note in sheet.notes)


def test_colour_only_where_it_is_wanted(monkeypatch):
    monkeypatch.setenv("TERM", "xterm-256color")
    monkeypatch.delenv("NO_COLOR", raising=False)
    results = change(make_results(), "alfa", "v4", status="crash")
    assert "\x1b[" not in as_text(results)
    assert "\x1b[1;31m" in as_text(results, colour=True)
    monkeypatch.setenv("NO_COLOR", "1")
    assert "31m" not in as_text(results, colour=True)


def test_order_of_the_table_is_the_order_of_the_run():
    results = make_results()
    turned = msgspec.structs.replace(results, backends=results.backends[::-1])
    assert make_sheet(turned).head[3:] == make_sheet(results).head[:2:-1]


def test_figures_for_people():
    assert [digits(value) for value in (0.619, 1.239, 9.999, 12.36, 99.96, 1240.0)] == [
        "0.62",
        "1.24",
        "10.0",
        "12.4",
        "100",
        "1,240",
    ]
    assert [times(ratio) for ratio in (0.62, 0.999, 1.25, 9.96, 1240.0)] == [
        "0.62x",
        "1.0x",
        "1.2x",
        "10x",
        "1,240x",
    ]
    assert [duration(seconds) for seconds in (1.5, 0.9999, 0.842, 3.1e-6, 8.4e-8)] == [
        "1.50 s",
        "1.00 s",
        "842 ms",
        "3.10 us",
        "84.0 ns",
    ]
