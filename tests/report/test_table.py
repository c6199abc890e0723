"""The tables: what a person may conclude from them, and nothing else."""

import re

import msgspec
import pytest

from tests.report.made import (
    REFERENCE,
    SECONDS,
    change,
    make_backend,
    make_control,
    make_memory,
    make_results,
    make_sample,
    make_sweep,
    slow,
)
from tetrabench.bench.record import Effort, Model, Results, Task
from tetrabench.report.sheets import Sheet, make_pages
from tetrabench.report.table import as_markdown, as_text
from tetrabench.report.units import digits, duration, percent, plural, span, times

TWO = {"alfa": {"v3y": 1.0, "v4": 2.0}}


def sheet_of(results: Results, intervals: bool = False) -> Sheet:
    """The first table."""
    return make_pages(results, intervals=intervals).sheets[0]


def notes_of(results: Results, intervals: bool = False) -> str:
    """All notes, a line each."""
    pages = make_pages(results, intervals=intervals)
    return "\n".join([note for sheet in pages.sheets for note in sheet.notes] + pages.notes)


def cell(results: Results, task: str, backend: str, intervals: bool = False) -> str:
    """What stands in a cell."""
    sheet = sheet_of(results, intervals)
    place = next(
        place for place, name in enumerate(sheet.head) if name.split(" ")[0].rstrip("*") == backend and place > 1
    )
    if sheet.head[place] == f"{REFERENCE} takes":
        place = sheet.head.index(f"{REFERENCE} =1")
    return next(row[place].text for row in sheet.rows if row[0].text == task)


@pytest.mark.parametrize(
    ("task", "backend", "text"),
    [
        ("delete", "v3", "711x"),
        ("explode", "v5x", "199x"),
        ("alfa", "v4", "1.9x"),
        ("alfa", "v3y", "1"),
        ("flow", "v3x", "0.97x"),
        ("explode", "v4", "1.05x"),  # in two digits that would be 1.0
        ("init", "v3", "~1"),
        ("init", "v5x", "unclear"),
    ],
)
def test_cells_are_multiples_of_the_reference(task: str, backend: str, text: str):
    assert cell(make_results(), task, backend) == text


def test_intervals_take_the_place_of_ratios():
    results = make_results()
    assert cell(results, "alfa", "v4", intervals=True) == "1.85-1.93"
    assert cell(results, "init", "v3", intervals=True) == "0.99-1.03"
    assert cell(results, "init", "v5x", intervals=True) == "1.01-1.05?"  # ranks nothing
    assert cell(results, "alfa", "v3y", intervals=True) == "0.99-1.01"  # the second copy of the reference
    assert "In the column of the reference: a second copy" in notes_of(results, intervals=True)
    assert "1.85-1.93" in as_text(results, intervals=True)
    assert "1.85-1.93" in as_markdown(results, intervals=True)


@pytest.mark.parametrize(
    ("factor", "text", "range_"), [(1.3, "1.3?", "1.29-1.31?"), (5.0, ">5.0x", ">5.0x"), (0.2, "<0.20x", "<0.20x")]
)
def test_too_few_launches_give_hints_and_bounds(factor: float, text: str, range_: str):
    results = make_results({"alfa": {"v3y": 1.0, "v4": factor}}, launches=2, wobble=0.01)
    assert cell(results, "alfa", "v4") == text
    assert cell(results, "alfa", "v4", intervals=True) == range_
    assert ("a hint, not ranked: too few launches" in notes_of(results)) == text.endswith("?")
    assert ("slower, at least so many times (in every launch)" in notes_of(results)) == text.startswith(">")
    assert ("faster, so many times at most (in every launch)" in notes_of(results)) == text.startswith("<")
    assert "Intervals:" not in notes_of(results)


def test_reference_has_its_time_and_that_of_an_item():
    row = next(row for row in sheet_of(make_results(launches=1, rounds=1)).rows if row[0].text == "alfa")
    assert [cell.text for cell in row[1:3]] == ["35.7 s", "55.5 us"]


@pytest.mark.parametrize(
    ("status", "word", "verdict"),
    [
        ("wrong-result", "wrong", "wrong"),
        ("unstable", "unstable", "unstable"),
        ("crash", "crashed", "crashed"),
        ("oom", "no memory", "out of memory"),
        ("timeout", "timed out", "timed out"),
        ("error", "failed", "failed"),
        ("unsupported", "cannot", "unsupported"),
        ("skipped", "skipped", "skipped"),
    ],
)
def test_a_bad_cell_has_a_word_and_a_reason_but_no_figure(status: str, word: str, verdict: str):
    results = change(make_results(), "alfa", "v4", status=status, reason="the reason")
    assert cell(results, "alfa", "v4") == cell(results, "alfa", "v4", intervals=True) == word
    assert cell(results, "flow", "v4") == "1.5x"
    assert f"v4, {verdict} in alfa: the reason" in notes_of(results)
    assert ("WRONG ANSWERS in alfa" in notes_of(results)) == (word == "wrong")


def test_without_a_sound_reference_nothing_is_compared():
    results = change(make_results(), "alfa", "v3y", status="crash", reason="signal 11")
    assert cell(results, "alfa", "v3y") == "crashed"
    assert cell(results, "alfa", "v4") == "no ref."


def test_too_short_samples_are_not_ranked():
    seconds = {"free": {"v3y": 1e-4, "v4": 3e-4, "v5": 1.0}}
    assert cell(make_results(seconds), "free", "v4") == "too short"
    assert cell(make_results(seconds), "free", "v5").endswith("x")  # slower, however short the reference is


def test_nothing_is_ranked_beside_a_control_that_differs():
    results = slow(make_results(TWO), "alfa", "v3y control", 1.2)
    assert cell(results, "alfa", "v4") == "unclear"
    assert "NOTHING IS RANKED in alfa: the control, a second copy of v3y, took 1.20 times" in notes_of(results)
    assert "NOTHING IS RANKED" not in notes_of(make_results(TWO))


def test_the_control_is_no_column_but_a_note():
    assert not any("control" in name for name in sheet_of(make_results()).head)
    assert "a second copy of v3y took 0.99 to 1.01 times as long" in notes_of(make_results())


def test_a_control_that_went_wrong_is_named_too():
    results = change(make_results(TWO), "alfa", "v3y control", status="crash", reason="signal 11")
    assert "v3y control, crashed in alfa: signal 11" in notes_of(results)
    assert "Both contestants gave the same answers: 1 scenario.\n" in notes_of(results)
    results = change(make_results(TWO), "alfa", "v3y control", status="wrong-result", reason="it says 1")
    assert "WRONG ANSWERS in alfa" in notes_of(results)


def test_says_how_wide_the_intervals_are():
    results = make_results({"alfa": {"v3y": 1.0, "v4": 2.0, "v5": 2.0}}, wobble=0.1)
    assert re.search(r"half of them within ±10 %, the widest ±10 % \(v[45] in alfa\)", notes_of(results))


def test_clock_of_a_parallel_task_is_named():
    results = change(make_results(), "flow", "v4", process_cpu_s=900.0)
    assert "Figures: CPU time, in flow wall time as a multiple" in notes_of(results)
    assert "wall" not in notes_of(make_results())


# ---------------------------------------------------------------------- memory, machine, time


def costs(results: Results) -> dict[str, dict[str, str]]:
    sheet = sheet_of(results)
    return {row[0].text: dict(zip(sheet.head, (cell.text for cell in row), strict=True)) for row in sheet.costs}


def test_memory_stands_below_the_same_contestants():
    below = costs(make_results())
    assert list(below) == ["structure", "retained", "peak", "compiling"]
    assert (below["structure"]["v3y =1"], below["structure"]["v4"]) == ("236", "252")
    assert (below["peak"]["v3y takes"], below["peak"]["v4"]) == ("~B/tetra", "277")
    assert below["structure"]["v3y takes"] == "B/tetra"  # exact
    assert below["compiling"]["v4"] == "1.50"


def test_without_a_memory_pass_there_is_the_structure():
    assert list(costs(make_results(memory=[]))) == ["structure", "compiling"]
    sweep = msgspec.structs.replace(make_sweep(TWO, EXPONENTS, SIZES[:2]), memory=[])
    first, second = (sheet for sheet in make_pages(sweep).sheets if "bandwidth" not in sheet.title)
    assert first.costs
    assert not second.costs  # what a contestant said of the first model is nobody's of the second


def test_unaccounted_and_failed_memory_is_named():
    memory = [
        make_memory("v3y"),
        make_memory("v4", retained_bytes=10**6),
        make_memory("v5", status="oom", reason="too much"),
    ]
    results = make_results(memory=memory)
    assert "UNACCOUNTED MEMORY of v4: its process holds 1 MB, its structure claims 162 MB." in notes_of(results)
    assert "Memory of v5: oom: too much" in notes_of(results)
    assert costs(results)["retained"]["v5"] == "no memory"
    assert "UNACCOUNTED" not in notes_of(make_results())


def test_bandwidth_is_a_share_of_the_machines():
    sheet = make_pages(make_results(launches=1, rounds=1)).sheets[1]
    assert sheet.head[:2] == ["scenario", "v3y GB/s"]
    assert [row[0].text for row in sheet.rows] == ["alfa", "flow"]
    assert [sheet.rows[0][1].text, sheet.rows[0][sheet.head.index("v3y =1")].text] == ["11.2", "112 %"]
    assert "triad 10.0 GB/s, a random access 90.0 ns" in notes_of(make_results())
    without = msgspec.structs.replace(make_results(), launches=[])
    assert len(make_pages(without).sheets) == 1
    assert "triad" not in notes_of(without)


def test_says_where_the_time_went():
    assert "1,000 s in all, 800 s in launches: samples 60 %, preparing 20 %" in notes_of(make_results())
    assert "8 % is overhead" in notes_of(make_results())


# ---------------------------------------------------------------------- sweeps


EXPONENTS = {"v3y": 1.0, "v4": 1.5}
SIZES = [10_000, 30_000, 100_000, 200_000, 300_000]


def test_a_sweep_over_sizes_is_a_table_a_size_and_one_of_growth():
    results = make_sweep(TWO, EXPONENTS, SIZES)
    sheets = make_pages(results).sheets
    titles = [sheet.title for sheet in sheets if "bandwidth" not in sheet.title]
    assert [title.split(":")[0] for title in titles] == [*(f"nozzle-{size}" for size in SIZES), "Growth"]
    assert sheets[-1].head == ["scenario", "v3y", "v4"]
    (row,) = sheets[-1].rows
    assert [cell.text for cell in row] == ["alfa", "1.00", "1.50"]
    (row,) = make_pages(make_sweep(TWO, EXPONENTS, SIZES, launches=3)).sheets[-1].rows
    assert [cell.text for cell in row] == ["alfa", "1.00?", "1.50?"]
    (row,) = make_pages(results, intervals=True).sheets[-1].rows
    assert [cell.text for cell in row] == ["alfa", "1.00-1.00", "1.50-1.50"]
    assert "compiling" in str(sheets[0].costs)
    assert not any("compiling" in str(sheet.costs) for sheet in sheets[1:])


def test_growth_that_cannot_be_fitted_is_said_in_words():
    few = make_sweep(TWO, EXPONENTS, SIZES[:2])
    assert "a fit needs 5 sizes over a factor of 30, there are 2 over 3" in notes_of(few)
    assert not any("Growth" in sheet.title for sheet in make_pages(few).sheets)
    part = change(make_sweep(TWO, EXPONENTS, SIZES), "alfa", "v4", status="crash")
    (row,) = make_pages(part).sheets[-1].rows
    assert [cell.text for cell in row] == ["alfa", "1.00", "none"]
    assert "v4 in alfa: a fit needs 5 sizes" in notes_of(part)
    assert "Growth" not in notes_of(make_results())


def test_a_sweep_over_options_is_a_line_a_value():
    results = make_results({f"alfa sweeps={n}": {"v3y": n / 10, "v4": n / 5} for n in (10, 20)})
    assert [row[0].text for row in sheet_of(results).rows] == ["alfa sweeps=10", "alfa sweeps=20"]
    assert "a tetra (642,720 in alfa sweeps=10, alfa sweeps=20)" in notes_of(results)


def test_each_reference_has_a_table_of_its_own():
    pair = [make_backend("v4", against="v4"), make_backend("v5", against="v4")]
    backends = [make_backend("v3y"), make_backend("v3"), *pair, make_control()]
    results = make_results({"alfa": {"v3y": 1.0, "v3": 2.0, "v4": 3.0, "v5": 4.5}}, backends=backends)
    first, second = (sheet for sheet in make_pages(results).sheets if "bandwidth" not in sheet.title)
    assert (first.head[3:], second.head[3:]) == (["v3y =1", "v3"], ["v4 =1", "v5"])
    assert second.title.startswith("nozzle against v4: ")
    assert [cell.text for cell in second.rows[0][3:]] == ["1", "1.5x"]


# ---------------------------------------------------------------------- the rest of the page


def test_says_that_all_gave_the_same_answers():
    assert "All 7 contestants gave the same answers: 6 scenarios, one digest each." in as_text(make_results())


def test_says_when_there_was_nobody_to_disagree():
    assert "none compared" in as_text(make_results({"alfa": {"v3y": 1.0}}, backends=[make_backend("v3y")]))


def test_extensions_are_marked():
    backends = [make_backend("v3y"), make_backend("halfface", extension=True)]
    results = make_results({"alfa": {"v3y": 1.0, "halfface": 2.0}}, backends=backends)
    assert sheet_of(results).head[-1] == "halfface*"
    assert "not from the source" in as_text(results)
    assert "not from the source" not in as_text(make_results())


def test_says_how_often_and_why_samples_are_missing():
    assert "8 launches of 3 rounds" in as_text(make_results())
    assert "the source's counts on one net" in as_text(make_results(profile="thesis"))
    text = as_text(make_results(ended="interrupted", effort=Effort(launches=9, rounds=3, hopeless_rounds=3)))
    assert "8 of 9 launches of 3 rounds, INTERRUPTED\n" in text
    assert "Interrupted: samples are missing. Of 9 launches were begun: 8 in init, delete, explode" in text
    assert "OUT OF BUDGET" in as_text(make_results(ended="budget"))
    assert "missing" not in as_text(make_results())


def test_a_cell_without_samples_is_named_and_a_task_without_any():
    seconds = {"alfa": {"v3y": 1.0, "v4": 2.0}, "flow": {"v3y": 1.0}, "free": {}}
    results = make_results(seconds, ended="interrupted")
    assert cell(results, "flow", "v4") == cell(results, "free", "v3y") == "missing"
    assert "8 in alfa, flow; none in free" in notes_of(results)
    assert "All that ended gave the same answers: 1 scenario." in notes_of(results)
    check = msgspec.structs.replace(results, profile="check")
    assert [one.text for one in sheet_of(check).rows[1]] == ["flow", "agrees", "missing"]


def test_says_how_much_was_done_and_where_that_is_less_than_asked():
    tasks = [Task(name="delete", scenario="delete", options={"deletions": 20_000, "others": 10**9})]
    results = make_results({"delete": {"v3y": 1.0, "v4": 2.0}}, tasks=tasks)
    results = msgspec.structs.replace(
        results,
        samples=[
            msgspec.structs.replace(one, unit="deletions", items=3 * 10_044, repeats=3) for one in results.samples
        ],
    )
    assert "An item is a deletion (10,044 in delete)." in notes_of(results)
    assert "the model is too small: 10,044 of 20,000 deletions in delete." in notes_of(results)
    whole = change(change(results, "delete", "v3y", items=60_000), "delete", "v4", items=60_000)
    assert "Fewer than asked" not in notes_of(whole)


def test_what_the_reader_of_the_model_warned_of_stands_below():
    models = [Model(name="nozzle", size={"tetras": 10}, notes=["CORD2R 7 is\nundefined"])]
    assert "model: CORD2R 7 is undefined\n" in notes_of(make_results(TWO, models=models))
    assert "model: CORD2R 7 is undefined\n" in notes_of(make_results(TWO, models=models, profile="check"))
    assert "model:" not in notes_of(make_results(TWO))


def test_a_note_stands_only_where_it_is_true():
    once = notes_of(make_results({"alfa": {"v3y": 1.0, "v4": 9.0, "v5": 2.0}}, launches=1, rounds=1))
    twice = notes_of(make_results({"alfa": {"v3y": 1.0, "v4": 9.0, "v5": 2.0}}, launches=2))
    for word in ("median", "in every launch", "interval"):
        assert word not in once
        assert word in twice
    assert "(one launch, beyond 3x)" in once
    assert "Retained" not in notes_of(make_results(TWO, memory=[]))
    assert "Retained" in notes_of(make_results(TWO))


def test_one_of_a_thing_is_no_plural():
    models = [Model(name="nozzle", size={"tetras": 1, "points": 4})]
    assert (
        sheet_of(make_results(TWO, models=models, launches=1, rounds=1)).title
        == "nozzle: 1 tetra, 4 points, 1 launch of 1 round"
    )


def test_no_note_stands_twice():
    notes = notes_of(make_results(ended="interrupted")).splitlines()
    assert len(set(notes)) == len(notes)
    assert sum("samples are missing" in note for note in notes) == 1


def test_a_check_shows_answers_and_no_times():
    results = make_results(TWO, launches=1, rounds=1, profile="check", memory=[])
    sheet = sheet_of(change(results, "alfa", "v4", status="wrong-result", reason="v4 says 1, most say 2"))
    assert sheet.head == ["scenario", "v3y =1", "v4"]
    assert [cell.text for cell in sheet.rows[0]] == ["alfa", "agrees", "wrong"]
    assert not sheet.costs
    assert not any(word in as_text(results) for word in ("Figures", "Control", "Time"))


def test_nothing_measured_is_still_a_table():
    empty = make_results(launches=0, models=[], memory=[], ended="interrupted")
    assert "Interrupted" in as_text(empty)
    assert as_markdown(empty)
    assert "Interrupted" in as_text(make_results(samples=[], ended="interrupted"))


@pytest.mark.parametrize(("intervals", "highest"), [(False, 1e5), (True, 1e3)])
def test_fits_into_100_columns_with_seven_contestants_at_their_widest(intervals: bool, highest: float):
    seconds = {f"scenario-{n}": dict.fromkeys(SECONDS["alfa"], 1e-4) for n in range(12)}
    seconds["sc"] = {**dict.fromkeys(SECONDS["alfa"], 1.0), "v3": highest}
    seconds["unclear"] = dict.fromkeys(SECONDS["alfa"], 1.0)
    results = make_results(seconds, command="tetrabench run " + "--scenario abc " * 9, wobble=0.08)
    assert max(map(len, as_text(results, intervals=intervals).splitlines())) <= 100


def test_markdown_says_the_same():
    results = change(make_results(), "alfa", "v4", status="crash", reason="signal 11")
    pages, text = make_pages(results), as_markdown(results).replace("\\", "")
    rows = [line.strip("| ").split(" | ") for line in text.splitlines() if line.startswith("|")]
    assert rows[0] == pages.sheets[0].head
    assert rows[2:8] == [[cell.text for cell in row] for row in pages.sheets[0].rows]
    assert all(f"- {note}" in text for note in [*pages.sheets[0].notes, *pages.notes])


def test_what_markdown_would_take_for_its_own_is_escaped():
    text = as_markdown(make_results())
    assert "\\~1" in text
    assert not re.search(r"(?<!\\)~", text)


def test_colour_only_where_it_is_wanted(monkeypatch: pytest.MonkeyPatch):
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
    assert sheet_of(turned).head[3:] == sheet_of(results).head[:2:-1]


def test_samples_of_unknown_tasks_are_left_out():
    results = make_results(TWO)
    more = msgspec.structs.replace(results, samples=[*results.samples, make_sample("other", "v4")])
    assert as_text(more) == as_text(results)


def test_figures_for_people():
    assert [digits(value) for value in (0.619, 1.239, 9.999, 12.36, 99.96, 1240.0)] == [
        "0.62",
        "1.24",
        "10.0",
        "12.4",
        "100",
        "1,240",
    ]
    assert [times(ratio) for ratio in (0.62, 0.999, 1.03, 1.26, 9.96, 1240.0)] == [
        "0.62x",
        "1.00x",
        "1.03x",
        "1.3x",
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
    assert span(0.98, 12.36) == "0.98-12.4"
    assert [percent(share) for share in (0.0, 1e-4, 0.004, 0.43, 1.12)] == ["0 %", "<0.1 %", "0.4 %", "43 %", "112 %"]
    assert [plural(1, "launch"), plural(8, "launch"), plural(2, "round")] == ["1 launch", "8 launches", "2 rounds"]
