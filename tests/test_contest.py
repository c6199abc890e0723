"""Contests: answers are compared before times, bars are met by intervals, and a wrong word is refused with what there is."""

import pytest

from tests import contest
from tests.contest import Contest, Row, line, measure, prepare, rows_of, turns_by_peer, warm_up
from tetrabench.bench.clock import Clocks

EQUAL = Contest(tuple, tuple, lambda *_: "")
ROW = {"operation": "sides", "numbering": "natural", "peer": "libigl"}
ROWS = [
    Row(operation, numbering, peer, None, lambda case, module: EQUAL._replace(ours=lambda: (case, module)))
    for operation, numbering, peer in [
        ("sides", "natural", "libigl"),
        ("sides", "shuffled", "libigl"),
        ("nearest", "natural", "scipy"),
    ]
]


def test_turns():
    turns = turns_by_peer(["9", "meshio=6"], {"meshio", "gmsh"}, "meshio=7")
    assert (turns("gmsh"), turns("meshio")) == (9, 6)
    assert turns_by_peer([], {"gmsh"}, "gmsh=7")("gmsh") == 21
    for word in ("5", "meshio=7", "gmsh=", "many"):
        with pytest.raises(ValueError, match=f"such as gmsh=7; not '{word}'"):
            turns_by_peer([word], {"gmsh"}, "gmsh=7")


def test_rows():
    assert rows_of(ROWS, {"sides", "nearest", "natural", "libigl"}) == ROWS[:1]
    assert rows_of(ROWS, set()) == ROWS
    with pytest.raises(ValueError, match="--only takes nearest, sides, natural, shuffled, libigl, scipy; not sidse"):
        rows_of(ROWS, {"sides", "sidse"})


def test_each_row_gets_its_case_and_its_peer():
    prepared = prepare(ROWS, {"libigl": "igl", "scipy": "sp"}, {"natural": 1, "shuffled": 2}, contest.Progress())
    assert [one.contest.ours() for one in prepared.values()] == [(1, "igl"), (2, "igl"), (1, "sp")]


def test_different_answers_are_not_timed(capsys):
    unequal = Contest(lambda: 1, lambda: 2, lambda ours, theirs: f"{ours} is not {theirs}")
    difference, _ = warm_up(unequal)
    assert difference == "1 is not 2"
    row = Row("sides", "natural", "libigl", 0.5, lambda *_: unequal)
    (result,) = contest.contend({row: contest.Prepared(unequal, difference, 0.0)}, lambda _: 6, contest.Progress())
    assert result == ROW | {"bar": 0.5, "difference": difference}
    assert capsys.readouterr().out.endswith("NOT TIMED, the answers differ: 1 is not 2\n")


def test_what_is_untimed(monkeypatch):
    """Ours starts fresh each time, the other's is tidied up each time, and no clock sees it."""
    done = []
    monkeypatch.setattr(contest, "read_clocks", lambda: done.append("clock") or Clocks(len(done), len(done), len(done)))
    calls = [lambda word=word: done.append(word) for word in ("ours", "theirs", "tidy", "fresh")]
    measure(Contest(calls[0], calls[1], lambda *_: "", *calls[2:]), None, 6, lambda _: None)
    ours, theirs = ["fresh", "clock", "ours", "clock"], ["clock", "theirs", "clock", "tidy"]
    assert done == 3 * (ours + theirs + theirs + ours)


def test_bars_and_threads(monkeypatch):
    """A bar is met by the upper end of the interval; time that other threads spent makes no ratio."""
    clocks = iter([0.1, 0.2, 0.2, 0.1] * 3)
    monkeypatch.setattr(contest, "sample", lambda *_, **__: Clocks(*[next(clocks)] * 3))
    row = measure(EQUAL, 0.51, 6, lambda _: None)
    assert (row["ratio"], row["met"], row["one_thread"]) == (0.5, True, True)
    clocks = iter([0.1, 0.2, 0.2, 0.1] * 3)
    row = measure(EQUAL, 0.49, 6, lambda _: None)
    assert row["met"] is False
    monkeypatch.setattr(contest, "sample", lambda *_, **__: Clocks(0.1, 0.15, 0.1))
    row = ROW | {"bar": 0.5} | measure(EQUAL, 0.5, 6, lambda _: None)
    assert not row["one_thread"]
    assert "NOT COMPARABLE" in line(row)
    assert row["pairs_s"] == [(0.15, 0.15)] * 6


def test_short_times_keep_their_digits():
    row = ROW | {"bar": None, "met": None, "one_thread": True, "ratio": 0.5, "low": 0.4, "high": 0.6, "turns": 6}
    assert line(row | {"ours_s": 0.0012345, "peer_s": 0.0123}).split()[3:5] == ["1.234", "12.3"]
