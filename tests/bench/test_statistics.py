"""Ratios and verdicts on samples that are known; who is right; results written and read."""

import msgspec
import pytest

from tetrabench.bench import (
    Backend,
    Results,
    Sample,
    exit_code,
    load_results,
    read_results,
    save_results,
    summary,
)
from tetrabench.bench.answers import judge
from tetrabench.bench.record import SCHEMA
from tetrabench.errors import InputError


def samples(backend, times, *, digest="d", scenario="alfa", status="ok", **more):
    common = {"family": "tetra", "model": "box", "scenario": scenario, "backend": backend, "status": status}
    return [
        Sample(**common, round=round, cpu_s=cpu_s, wall_s=cpu_s, items=1000, digest=digest, **more)
        for round, cpu_s in enumerate(times)
    ]


def results(*groups, interrupted=False):
    backends = dict.fromkeys(sample.backend for group in groups for sample in group)
    return Results(
        command="tetrabench run --model box",
        profile="default",
        family="tetra",
        model="box",
        model_size={"tetras": 12},
        options={"alfa": {"sweeps": 50}},
        reference="v3y",
        seed=0,
        started="2024-01-01T00:00:00+00:00",
        environment={"cores": 2, "governor": None},
        backends=[Backend(name=name, title=name, extension=name == "v6") for name in backends],
        samples=judge([sample for group in groups for sample in group]),
        interrupted=interrupted,
    )


def row(name, *groups):
    return next(row for row in summary(results(*groups)) if row.backend == name)


REFERENCE = [0.1, 0.2, 0.4]


def test_the_ratio_is_the_median_of_the_paired_ratios():
    # the noise of a round is in both: 2.0, 1.9, 2.2 though the times themselves spread fourfold
    slow = row("v4", samples("v3y", REFERENCE), samples("v4", [0.2, 0.38, 0.88]))
    assert slow.ratio == pytest.approx(2.0)
    assert (slow.ratio_low, slow.ratio_high) == (pytest.approx(1.9), pytest.approx(2.2))
    assert (slow.n, slow.cpu_s, slow.wall_s) == (3, 0.38, 0.38)
    assert slow.ns_per_item == pytest.approx(0.38 / 1000 * 1e9)
    assert slow.verdict == "slower"


def test_fewer_rounds_are_paired_with_the_same_rounds():
    assert row("v5x", samples("v3y", REFERENCE), samples("v5x", [5.0])).ratio == pytest.approx(50)


@pytest.mark.parametrize(
    ("factor", "verdict"),
    [
        (1.3, "slower"),
        (1.2, "about the same"),
        (1.0, "about the same"),
        (0.85, "about the same"),
        (0.7, "faster"),
    ],
)
def test_nothing_is_ranked_under_25_percent(factor, verdict):
    other = samples("v4", [factor * cpu_s for cpu_s in REFERENCE])
    assert row("v4", samples("v3y", REFERENCE), other).verdict == verdict
    assert row("v3y", samples("v3y", REFERENCE), other).verdict == "reference"


def test_rounds_that_contradict_each_other_rank_nothing():
    other = samples("v4", [0.09, 0.4, 0.8])
    assert row("v4", samples("v3y", REFERENCE), other).verdict == "inconclusive"


@pytest.mark.parametrize(("factor", "verdict"), [(1.1, "about the same"), (2.0, "inconclusive"), (10, "slower")])
def test_a_single_round_ranks_only_what_is_clear(factor, verdict):
    assert row("v4", samples("v3y", REFERENCE), samples("v4", [factor * 0.1])).verdict == verdict


@pytest.mark.parametrize(
    ("reference", "other", "verdict"),
    [
        (0.002, 0.004, "too short to rank"),
        (0.004, 0.006, "too short to rank"),  # 1.5 times, but only 1.2 times what can be told
        (0.002, 0.4, "slower"),  # 80 times at least
        (0.4, 0.002, "faster"),
    ],
)
def test_a_short_sample_ranks_only_by_what_is_certain(reference, other, verdict):
    assert row("v4", samples("v3y", [reference] * 3), samples("v4", [other] * 3)).verdict == verdict


@pytest.mark.parametrize(
    ("status", "verdict"),
    [("crash", "crashed"), ("error", "failed"), ("skipped", "skipped"), ("wrong-result", "wrong")],
)
def test_a_cell_that_ended_badly_is_not_ranked(status, verdict):
    bad = samples("v4", [0.1]) + samples("v4", [None], status=status, reason="because")
    found = row("v4", samples("v3y", REFERENCE), bad)
    assert (found.verdict, found.ratio, found.cpu_s, found.reason, found.n) == (
        verdict,
        None,
        None,
        "because",
        1,
    )
    found = row("v4", samples("v3y", [None], status=status), samples("v4", REFERENCE))
    assert (found.verdict, found.ratio) == ("no reference", None)
    assert found.cpu_s == 0.2


def statuses(judged):
    return {sample.backend: sample.status for sample in judged}


def test_the_majority_is_right():
    judged = judge(samples("a", [1, 1]) + samples("b", [1]) + samples("c", [1, 1, 1, 1], digest="x"))
    assert statuses(judged) == {"a": "ok", "b": "ok", "c": "wrong-result"}  # by contestants, not by samples
    assert judged[-1].reason == "c says x, most say d: the same figures, but other bits"


def test_without_a_majority_nobody_is_right():
    judged = judge(samples("a", [1]) + samples("b", [1], digest="x"))
    assert statuses(judged) == {"a": "wrong-result", "b": "wrong-result"}
    assert judged[0].reason == "no answer has a majority: a d, b x"


def test_who_contradicts_itself_is_wrong_where_it_differs():
    judged = judge(samples("a", [1]) + samples("a", [1], digest="x"))
    assert [sample.status for sample in judged] == ["wrong-result"] * 2
    judged = judge(samples("a", [1]) + samples("b", [1]) + samples("b", [1], digest="x"))
    assert [sample.status for sample in judged] == ["ok", "ok", "wrong-result"]


def test_scenarios_are_judged_apart():
    judged = judge(samples("a", [1]) + samples("a", [1], digest="x", scenario="flow"))
    assert [sample.status for sample in judged] == ["ok", "ok"]


def test_exit_codes():
    good, bad = samples("v3y", REFERENCE), samples("v4", [None], status="crash")
    assert exit_code(results(good)) == 0
    assert exit_code(results(good, samples("v4", [None], status="skipped"))) == 0
    assert exit_code(results(good, bad)) == 3
    assert exit_code(results(good, bad, interrupted=True)) == 130


def test_two_results_round_trip(tmp_path):
    figures = {"sum": None, "count": 12.0}
    both = [
        results(samples("v3y", REFERENCE, figures=figures), samples("v6", [1e-9, 0.1 + 0.2, 3.0], digest="x")),
        results(samples("v3y", [None], status="crash", reason="signal 11"), interrupted=True),
    ]
    for number, one in enumerate(both):
        save_results(one, tmp_path / f"{number}.json")
    assert [read_results(tmp_path / f"{number}.json") for number in range(2)] == both


def test_results_as_a_frame(tmp_path):
    save_results(results(samples("v3y", REFERENCE), samples("v4", [None], status="crash")), tmp_path / "r.json")
    frame = load_results(tmp_path / "r.json")
    wanted = "family model scenario backend status round cpu_s wall_s items digest structure_bytes peak_bytes"
    assert set(wanted.split()) <= set(frame.columns)
    assert list(frame.cpu_s[:3]) == REFERENCE
    assert frame.cpu_s.isna().sum() == 1
    assert len(frame) == 4
    save_results(results(), tmp_path / "empty.json")
    assert list(load_results(tmp_path / "empty.json").columns) == list(frame.columns)


@pytest.mark.parametrize("text", ["", "{}", '{"benchmarks": []}', "[1, 2]", "\x00\xff"])
def test_foreign_json_is_refused(tmp_path, text):
    (tmp_path / "foreign.json").write_text(text)
    with pytest.raises(InputError, match=r"foreign\.json: no results of tetrabench"):
        load_results(tmp_path / "foreign.json")


def test_another_versions_schema_is_refused(tmp_path):
    old = msgspec.structs.replace(results(samples("v3y", REFERENCE)), schema="tetrabench-results/99")
    save_results(old, tmp_path / "old.json")
    with pytest.raises(InputError, match=f"schema tetrabench-results/99, this version reads {SCHEMA}"):
        read_results(tmp_path / "old.json")
    with pytest.raises(InputError, match="cannot read results"):
        read_results(tmp_path / "none.json")
