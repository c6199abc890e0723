"""Two runs compared: what may be compared at all, what differs, what only seems to."""

import msgspec
import numpy as np
import pytest

from tests.bench.runs import (
    ENVIRONMENT,
    change_samples,
    make_backend,
    make_memory,
    make_run,
    spread,
)
from tetrabench.bench.compare import compare, difference_p, holm, is_alike, least_p
from tetrabench.bench.limits import limits_of
from tetrabench.bench.record import Model, Task
from tetrabench.errors import NotComparableError


def only(comparison):
    (change,) = comparison.changes
    return change


def test_the_same_is_the_same_though_all_times_have_doubled():
    old = make_run({"alfa": {"v4": spread(1.8)}})
    comparison = compare(old, make_run({"alfa": {"v4": spread(1.8)}}, seconds=0.2))
    assert only(comparison).verdict == "same"
    assert only(comparison).ratio == pytest.approx(1.0)
    assert comparison.exit_code(strict=True) == 0


@pytest.mark.parametrize(
    ("factor", "verdict", "code"),
    [(1.3, "slower", 1), (1.08, "slower", 0), (1.02, "same", 0), (0.7, "faster", 0)],
)
def test_a_ratio_that_moved(factor, verdict, code):
    old, new = make_run({"alfa": {"v4": spread(1.8)}}), make_run({"alfa": {"v4": spread(1.8 * factor)}})
    comparison = compare(old, new)
    assert only(comparison).verdict == verdict
    assert only(comparison).ratio == pytest.approx(factor)
    assert only(comparison).is_regression == (code == 1)
    assert comparison.exit_code() == code
    assert only(compare(old, new, limits_of(0.5))).is_regression is False


def test_launches_that_overlap_decide_nothing():
    wild = [0.7, 0.8, 0.9, 1.0, 1.1, 1.2, 1.3, 1.4]
    comparison = compare(make_run({"alfa": {"v4": wild}}), make_run({"alfa": {"v4": [1.1 * one for one in wild]}}))
    assert only(comparison).verdict == "inconclusive"
    assert (comparison.exit_code(), comparison.exit_code(strict=True)) == (0, 4)


def test_too_few_launches_are_said_to_be_too_few():
    old, new = make_run({"alfa": {"v4": spread(1.0, 3)}}), make_run({"alfa": {"v4": spread(1.5, 3)}})
    assert only(compare(old, new)).verdict == "inconclusive"
    assert "too few launches" in only(compare(old, new)).reason
    one = make_run({"alfa": {"v4": [1.5]}})
    assert only(compare(one, one)).p == 1.0


def test_many_cells_need_stronger_evidence():
    """Five launches against five find a single cell different, but not one among eight."""
    alone = {"alfa": {"v4": spread(1.0, 5)}}, {"alfa": {"v4": spread(1.3, 5)}}
    assert only(compare(*map(make_run, alone))).verdict == "slower"
    several = [cells | {f"flow{k}": {"v4": spread(1.0, 5)} for k in range(7)} for cells in alone]
    changes = compare(*map(make_run, several)).changes
    assert [change.verdict for change in changes] == ["inconclusive", *["same"] * 7]


@pytest.mark.parametrize("status", ["crash", "wrong-result", "timeout"])
def test_a_cell_that_goes_wrong_in_the_new_run_is_3(status):
    old = make_run({"alfa": {"v4": spread(1.8), "v5": spread(2)}})
    new = change_samples(old, "alfa", "v4", status=status, reason="because")
    comparison = compare(old, new)
    assert [change.verdict for change in comparison.changes][1] == "same"
    assert comparison.changes[0].reason == "because"
    assert comparison.exit_code() == 3
    healed = compare(new, old)
    assert healed.changes[0].verdict == "no comparison"
    assert healed.exit_code(strict=True) == 0


def test_a_wrong_answer_that_was_expected_is_no_comparison_and_no_failure():
    backends = [make_backend("v3y"), make_backend("v4", exact=False), make_backend("v5")]
    run = make_run({"alfa": {"v4": spread(1.8), "v5": spread(2)}}, backends=backends)
    run = change_samples(run, "alfa", "v4", status="wrong-result", reason="because")
    comparison = compare(run, run)
    assert [change.verdict for change in comparison.changes] == ["no comparison", "same"]
    assert comparison.exit_code(strict=True) == 0


def test_a_cell_that_went_wrong_in_the_memory_pass_is_3():
    old = make_run({"alfa": {"v4": spread()}})
    new = msgspec.structs.replace(old, memory=[make_memory("v4", 0, status="oom", reason="no more")])
    assert compare(old, new).exit_code() == 3
    assert "no more" in compare(old, new).failures[0]


def test_cells_that_come_and_go():
    old = make_run({"alfa": {"v4": spread(1.8)}, "flow": {"v4": spread(1.8)}})
    new = make_run({"alfa": {"v4": spread(1.8)}, "write": {"v4": spread(1.8)}})
    comparison = compare(old, new)
    assert {one.task: one.verdict for one in comparison.changes} == {"alfa": "same", "flow": "gone", "write": "new"}
    assert (comparison.exit_code(), comparison.exit_code(strict=True)) == (0, 4)


def test_nothing_next_to_a_control_that_differs():
    backends = [make_backend(name) for name in ("v3y", "v4", "v3y control")]
    good = {"alfa": {"v4": spread(1.8), "v3y control": spread()}}
    bad = {"alfa": {"v4": spread(2.8), "v3y control": spread(1.2)}}
    comparison = compare(make_run(good, backends=backends), make_run(bad, backends=backends))
    assert only(comparison).verdict == "inconclusive"
    assert "second copy of v3y took 1.20 times" in only(comparison).reason


def test_too_short_to_rank():
    old = make_run({"alfa": {"v4": spread()}}, seconds=0.001)
    assert (only(compare(old, old)).verdict, only(compare(old, old)).reason[:9]) == ("inconclusive", "too short")


@pytest.mark.parametrize(
    ("was", "now", "verdicts", "code"),
    [
        ((100_000_000, 200_000_000), (101_000_000, 205_000_000), ["same", "same"], 0),
        ((100_000_000, 200_000_000), (103_000_000, 205_000_000), ["larger", "same"], 1),
        ((100_000_000, 200_000_000), (100_000_000, 207_500_000), ["same", "larger"], 1),
        ((1_000, 100_000), (1_000, 1_100_000), ["same", "same"], 0),  # a MiB is nothing
        ((100_000_000, 200_000_000), (90_000_000, 150_000_000), ["smaller", "smaller"], 0),
        ((100_000_000, None), (103_000_000, None), ["larger"], 1),
    ],
)
def test_memory_is_strict(was, now, verdicts, code):
    run = make_run({"alfa": {"v4": spread()}})
    old, new = (msgspec.structs.replace(run, memory=[make_memory("v4", *sizes)]) for sizes in (was, now))
    assert [one.verdict for one in compare(old, new).memory] == verdicts
    assert compare(old, new).exit_code() == code


def test_a_change_of_the_reference_is_suspected():
    old = make_run({"alfa": {"v4": spread(1.8), "v5": spread(2)}})
    comparison = compare(old, make_run({"alfa": {"v4": spread(1.2), "v5": spread(1.4)}}))
    assert any("as if the reference v3y had become slower" in note for note in comparison.notes)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"environment": {**ENVIRONMENT, "processor": "Other CPU"}}, "processor (Some CPU @ 2 GHz, then Other CPU)"),
        ({"environment": {**ENVIRONMENT, "cores": 4}}, "cores (2, then 4)"),
        ({"environment": {**ENVIRONMENT, "numba": None}}, "numba (0.61.0, then unknown)"),
        ({"environment": {**ENVIRONMENT, "python": "3.12.0"}}, "python"),
        ({"environment": {**ENVIRONMENT, "numpy": "2.2.0"}}, "numpy"),
        ({"models": [Model(name="box", digest="ffff")]}, "the file of the model box (0123456789abcdef, then ffff)"),
        ({"tasks": [Task(name="alfa", scenario="alfa", options={"sweeps": 50})]}, "alfa (sweeps 10, then sweeps 50)"),
        ({"family": "polygon"}, "family"),
        ({"reference": "v4"}, "reference (v3y, then v4)"),
        ({"profile": "quick"}, "profile (default, then quick)"),
        (
            {"backends": [make_backend("v3y"), make_backend("v4", options={"capacity": 9})]},
            "the options of v4 (capacity 8, ",
        ),
    ],
)
def test_unlike_runs_are_refused(changes, said):
    backends = [make_backend("v3y"), make_backend("v4", options={"capacity": 8, "recycle": 1})]
    old = make_run({"alfa": {"v4": spread()}}, backends=backends)
    assert compare(old, msgspec.structs.replace(old, backends=[make_backend("v3y"), make_backend("v4")]))
    with pytest.raises(NotComparableError) as refused:
        compare(old, msgspec.structs.replace(old, **changes))
    assert said in str(refused.value)
    assert refused.value.exit_code == 5


def test_runs_without_a_cell_in_common_are_refused():
    with pytest.raises(NotComparableError, match="no cell is in both"):
        compare(make_run({"alfa": {"v4": spread()}}), make_run({"flow": {"v4": spread()}}))


def test_another_revision_may_be_compared():
    old = make_run({"alfa": {"v4": spread()}})
    new = msgspec.structs.replace(old, environment={**ENVIRONMENT, "revision": "b" * 40})
    comparison = compare(old, new)
    assert (comparison.old_revision[0], comparison.new_revision[0]) == ("a", "b")


def test_p_values_are_those_of_counting():
    a, b = [1.0, 2.0, 3.0], [11.0, 12.0, 13.0]
    # of the 20 ways to split the six, 4 have medians 10 apart or more: {1,2,3}, {1,2,3} with 11 for 3, and their reverses
    assert difference_p(a, b) == difference_p(b, a) == pytest.approx(4 / 20)
    assert difference_p(a, b) >= least_p(3, 3) == pytest.approx(2 / 20)
    assert difference_p(a, a) == 1.0
    assert holm([0.01, 0.04, 0.03]) == pytest.approx([0.03, 0.06, 0.06])
    assert holm([0.5, 0.9]) == [1.0, 1.0]


def test_identical_code_is_seldom_taken_for_different(rng: np.random.Generator):
    draws = rng.normal(0, 0.04, (100, 10))
    assert sum(difference_p(draw[:5], draw[5:]) <= 0.05 for draw in draws) <= 12
    assert not any(is_alike(draw[:5] + 0.2, draw[5:]) for draw in draws)
    assert any(is_alike(draw[:5], draw[5:]) for draw in draws / 4)
