"""Recommendations from runs whose truth is known: totals, ranks, reasons, flips, memory, and who is never ranked."""

import json
import math
from statistics import median

import msgspec
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.report.made import REFERENCE, change, make_backend, make_memory, make_results, make_sweep, slow
from tetrabench.bench.record import Backend, Results, Task
from tetrabench.bench.statistics import BEYOND, CLEAR, SHORTEST_S
from tetrabench.errors import InputError
from tetrabench.report.advice.mix import amount_words, make_mix, mix_words, read_mix
from tetrabench.report.advice.recommend import Ranked, Recommendation, parts_of, recommend
from tetrabench.report.advice.words import advice_as, advice_of, flip_of, reason_of

SECONDS = {  # v3 sweeps faster than v3y, and deletes 50 times slower; v4 sweeps twice as slowly
    "alfa": {"v3": 0.8, "v3y": 1.0, "v4": 2.0},
    "delete": {"v3": 5.0, "v3y": 0.1, "v4": 0.11},
    "explode": {"v3": 1.0, "v3y": 1.0, "v4": 1.0},
}
ODD = "nozzle <script>alert('1')</script> | *a* & \"b\""


def counted(results: Results, **options: dict[str, int]) -> Results:
    """The same with counts of its scenarios."""
    tasks = [Task(name=one.name, scenario=one.scenario, options=options.get(one.name, {})) for one in results.tasks]
    return msgspec.structs.replace(results, tasks=tasks)


def asked(results: Results, mix: str, **more) -> Recommendation:
    """What is recommended on the only model."""
    (one,) = recommend(results, read_mix(mix), **more)
    return one


def names(one: Recommendation) -> list[str]:
    return [ranked.backend for ranked in one.ranked]


def ranked(one: Recommendation, backend: str) -> Ranked:
    return next(found for found in one.ranked if found.backend == backend)


def without(results: Results, task: str, backend: str, launches: set[int]) -> Results:
    """The same where a cell was spared those launches."""
    kept = [one for one in results.samples if (one.task, one.backend) != (task, backend) or one.launch not in launches]
    return msgspec.structs.replace(results, samples=kept)


def naive_totals(results: Results, weights: dict[str, float]) -> dict[str, np.ndarray]:
    """Straight from the samples: for each launch, the medians over its rounds of ratios to the reference."""
    cells: dict[tuple[str, str], dict[int, dict[int, float]]] = {}
    for one in results.samples:
        time = max(one.cpu_s, SHORTEST_S) / one.repeats
        cells.setdefault((one.task, one.backend), {}).setdefault(one.launch, {})[one.round] = time
    backends = [one.name for one in results.backends if not one.control]
    launches = sorted({one.launch for one in results.samples})
    totals = {}
    for backend in backends:
        totals[backend] = np.zeros(len(launches))
        for task, weight in weights.items():
            base = cells[task, REFERENCE]
            unit = median(time for rounds in base.values() for time in rounds.values())
            for place, launch in enumerate(launches):
                mine = cells[task, backend][launch]
                logs = [math.log(mine[round] / base[launch][round]) for round in mine]
                totals[backend][place] += weight * unit * math.exp(median(logs))
    return totals


# -- totals


def test_totals_are_those_of_a_naive_twin(rng):
    results = make_results(SECONDS, wobble=0.0)
    noisy = [
        msgspec.structs.replace(one, cpu_s=(time := one.cpu_s * math.exp(rng.normal(0, 0.1))), process_cpu_s=time)
        for one in results.samples
    ]
    results = msgspec.structs.replace(results, samples=noisy)
    found = asked(results, "alfa=3,delete=0.2,explode=1")
    twin = naive_totals(results, {"alfa": 3.0, "delete": 0.2, "explode": 1.0})
    assert names(found) == sorted(twin, key=lambda name: median(twin[name]))
    first = twin[names(found)[0]]
    for one in found.ranked:
        assert one.seconds == pytest.approx(np.median(twin[one.backend]))
        if one.beside:
            ratios = twin[one.backend] / first
            assert one.beside.ratio == pytest.approx(math.exp(np.median(np.log(ratios))))
            assert one.beside.low == pytest.approx(ratios.min())  # of 8 launches an interval is their range
            assert one.beside.high == pytest.approx(ratios.max())
            assert one.beside.is_whole


def test_pairs_are_compared_launch_by_launch():
    """Relative to the reference both are all over the place; beside each other one takes 1.1 times as long, always."""
    seconds = {"alfa": {"v3y": 2.0, "v3": 1.0, "v4": 1.1}}
    results = make_results(seconds, wobble=0.0)
    drift = [
        msgspec.structs.replace(one, cpu_s=(time := one.cpu_s * (1 + one.launch / 10)), process_cpu_s=time)
        if one.backend in ("v3", "v4")
        else one
        for one in results.samples
    ]
    found = asked(msgspec.structs.replace(results, samples=drift), "alfa=1")
    beside = ranked(found, "v4").beside
    assert beside is not None
    assert (beside.verdict, beside.low, beside.high) == ("slower", pytest.approx(1.1), pytest.approx(1.1))


def test_the_clock_of_a_parallel_task_is_elapsed_time():
    results = change(make_results({"alfa": {"v3y": 1.0, "v4": 1.0}}), "alfa", "v4", wall_s=3.0)
    results = msgspec.structs.replace(results, tasks=[Task(name="alfa", scenario="alfa", parallel=True)])
    assert names(asked(results, "alfa=1"))[-1] == "v4"
    assert ranked(asked(results, "alfa=1"), "v4").beside.verdict == "slower"


@given(factor=st.floats(1e-3, 1e3), weights=st.lists(st.floats(0.01, 100.0), min_size=3, max_size=3))
def test_more_of_everything_changes_nothing(factor, weights):
    results = make_results(SECONDS, rounds=1, wobble=0.05)
    mixes = [dict(zip(SECONDS, [weight * by for weight in weights], strict=True)) for by in (1.0, factor)]
    one, other = (recommend(results, mix)[0] for mix in mixes)
    assert (names(one), one.best) == (names(other), other.best)
    for here, there in zip(one.ranked, other.ranked, strict=True):
        assert there.seconds == pytest.approx(factor * here.seconds)
        if here.beside:
            assert there.beside.low == pytest.approx(here.beside.low)
            assert there.beside.verdict == here.beside.verdict


@given(weights=st.lists(st.floats(0.01, 100.0), min_size=3, max_size=3), slower=st.floats(2.0, 20.0))
def test_who_is_slower_everywhere_is_never_first_and_changes_no_first(weights, slower):
    mix = dict(zip(SECONDS, weights, strict=True))
    more = {task: {**times, "v5": slower * min(times.values())} for task, times in SECONDS.items()}
    before, after = (recommend(make_results(one, rounds=1, launches=12), mix)[0] for one in (SECONDS, more))
    assert names(before)[0] == names(after)[0] != "v5"
    assert ranked(after, "v5").beside.verdict == "slower"


@given(weight=st.floats(0.01, 100.0), wobble=st.floats(0.0, 0.3))
def test_whoever_is_alike_cannot_be_told(weight, wobble):
    seconds = {"alfa": dict.fromkeys(("v3y", "v3", "v4"), 1.0), "delete": dict.fromkeys(("v3y", "v3", "v4"), 0.5)}
    found = recommend(make_results(seconds, rounds=1, wobble=wobble), {"alfa": 1.0, "delete": weight})[0]
    assert sorted(found.best) == ["v3", "v3y", "v4"]
    assert {one.beside.verdict for one in found.ranked if one.beside} == {"cannot tell"}
    assert "they cannot be told apart" in advice_of(found)


def test_who_is_first_by_chance_is_seldom_said_to_be_faster(rng):
    """Seven that are alike, in launches that differ by 5 %: docs/recommending.md says in how many runs it is wrong."""
    alike = make_results(
        {"alfa": dict.fromkeys(("v3", "v3x", "v3y", "v4", "v5", "v5x", "v5y"), 1.0)}, rounds=1, wobble=0.0
    )
    wrong = 0
    for _ in range(200):
        off = {(one.name, launch): math.exp(rng.normal(0, 0.05)) for one in alike.backends for launch in range(8)}
        samples = [
            msgspec.structs.replace(one, cpu_s=(time := off[one.backend, one.launch]), process_cpu_s=time)
            for one in alike.samples
        ]
        wrong += len(asked(msgspec.structs.replace(alike, samples=samples), "alfa=1").best) < 7
    assert 0 < wrong <= 18  # it happens, or noise is not what is simulated


# -- ranks


def test_the_mix_decides():
    results = make_results(SECONDS)
    assert asked(results, "alfa=1").best == ["v3"]
    assert asked(results, "delete=1").best[0] == "v3y"
    assert names(asked(results, "alfa=1,delete=1")) == ["v3y", "v4", "v3"]


def test_says_what_to_use_and_what_it_costs_not_to():
    results = make_results(SECONDS, wobble=0.01)
    assert advice_of(asked(results, "alfa=1,delete=1")) == (
        "Use v3y. The next one, v4, takes 1.92 times (1.90 to 1.94) as long as it."
    )
    alone = make_results({"alfa": {"v3y": 1.0}})
    assert advice_of(asked(alone, "alfa=1")) == "v3y alone is left: use it."


def test_a_difference_that_nobody_asks_about_is_none():
    results = make_results({"alfa": {"v3y": 1.0, "v4": 1 + (BEYOND - 1) / 2}}, wobble=0.0)
    assert asked(results, "alfa=1").best == ["v3y", "v4"]
    results = make_results({"alfa": {"v3y": 1.0, "v4": 1 + 2 * (BEYOND - 1)}}, wobble=0.0)
    assert asked(results, "alfa=1").best == ["v3y"]


@pytest.mark.parametrize(("factor", "verdict"), [(1.5, "hint"), (0.9 * CLEAR, "hint"), (1.1 * CLEAR, "slower")])
def test_of_few_launches_only_what_is_clear_is_said(factor, verdict):
    found = asked(make_results({"alfa": {"v3y": 1.0, "v4": factor}}, launches=3), "alfa=1")
    beside = ranked(found, "v4").beside
    assert (beside.verdict, beside.is_whole, beside.is_bound) == (verdict, False, verdict == "slower")
    assert found.best == (["v3y"] if verdict == "slower" else ["v3y", "v4"])
    assert advice_of(found).startswith(
        "Use v3y." if verdict == "slower" else "Perhaps v3y, but that is a hint: 3 launches"
    )


@pytest.mark.parametrize("status", ["wrong-result", "unstable", "crash", "oom", "timeout", "error", "unsupported"])
def test_whoever_went_wrong_is_not_ranked_however_fast(status):
    results = slow(make_results(SECONDS), "alfa", "v4", 1e-3)
    assert asked(results, "alfa=1").best == ["v4"]
    results = change(results, "alfa", "v4", status=status, reason="the\nreason")
    found = asked(results, "alfa=1,delete=1")
    assert "v4" not in names(found)
    assert found.left_out[0].backend == "v4"
    assert "in alfa: the reason" in found.left_out[0].reason
    assert "v4" in names(asked(results, "delete=1"))


def test_one_wrong_sample_is_enough():
    results = make_results(SECONDS)
    spoilt = list(results.samples)
    place = next(k for k, one in enumerate(spoilt) if (one.task, one.backend) == ("delete", "v3y"))
    spoilt[place] = msgspec.structs.replace(spoilt[place], status="wrong-result", reason="other digest")
    found = asked(msgspec.structs.replace(results, samples=spoilt), "alfa=1,delete=1")
    assert names(found) == []  # all others have nothing to be compared with
    assert advice_of(found) == "Nothing can be recommended: nobody is left."
    assert {one.backend: one.reason for one in found.left_out} == {
        "v3": "v3y, which it is compared with, is wrong in delete",
        "v3y": "wrong in delete: other digest",
        "v4": "v3y, which it is compared with, is wrong in delete",
    }
    assert "Not ranked: v3y: wrong in delete" in advice_as([found], "table")
    assert "Not ranked: v3 and v4: v3y, which it is compared with, is wrong in delete." in advice_as([found], "table")


def test_whoever_has_no_sample_is_not_ranked():
    found = asked(without(make_results(SECONDS), "alfa", "v4", set(range(8))), "alfa=1,delete=1")
    assert names(found) == ["v3y", "v3"]
    assert found.left_out[0].reason == "missing in alfa"


def test_nothing_is_ranked_beside_a_control_that_differs():
    results = slow(make_results(SECONDS), "alfa", "v3y control", 1.2)
    found = asked(results, "alfa=1,delete=1")
    assert (found.is_ranked, found.best) == (False, [])
    assert {one.beside.verdict for one in found.ranked if one.beside} == {"cannot tell"}
    assert advice_of(found) == "Nothing can be recommended: nothing may be ranked in alfa."
    assert "NOTHING IS RANKED in alfa: the control" in advice_as([found], "table")
    assert asked(results, "delete=1").is_ranked
    small = asked(results, "alfa=0.0001,explode=1,delete=100")  # it decides nothing
    assert (small.is_ranked, small.best) == (True, ["v3y"])


def test_a_control_that_differs_spoils_only_those_to_whom_the_task_matters():
    seconds = {"alfa": {"v3y": 1.0, "v4": 2.0, "v5": 1.0}, "delete": {"v3y": 0.01, "v4": 0.01, "v5": 5.0}}
    results = slow(make_results(seconds), "delete", "v3y control", 1.2)
    found = asked(results, "alfa=1,delete=1")
    assert {one.backend: one.beside.verdict for one in found.ranked if one.beside} == {
        "v4": "slower",
        "v5": "cannot tell",
    }


# -- cells that are not whole


def test_a_hopeless_one_is_a_bound():
    results = without(make_results(SECONDS), "delete", "v3", set(range(3, 8)))
    found = asked(results, "delete=1")
    beside = ranked(found, "v3").beside
    assert (beside.verdict, beside.is_bound) == ("slower", True)
    twin = naive_totals(make_results(SECONDS), {"delete": 1.0})
    assert beside.low == pytest.approx(min((twin["v3"] / twin["v3y"])[:3]))  # of those that there are
    assert reason_of(found, ranked(found, "v3")) == "delete takes 100 % of its time, at least 49 times that of v3y"
    assert ">49x" in advice_as([found], "table")


def test_what_few_launches_say_may_be_off_by_as_much_as_is_clear():
    """1.5 times in all, most of it from a task of three launches: it might be no slower at all."""
    seconds = {"alfa": {"v3y": 1.0, "v4": 1.0}, "delete": {"v3y": 1.0, "v4": 2.0}}
    results = without(make_results(seconds), "delete", "v4", set(range(3, 8)))
    assert ranked(asked(results, "alfa=1,delete=1"), "v4").beside.verdict == "cannot tell"
    assert ranked(asked(make_results(seconds), "alfa=1,delete=1"), "v4").beside.verdict == "slower"
    results = slow(results, "delete", "v4", 3 * CLEAR)
    assert ranked(asked(results, "alfa=1,delete=1"), "v4").beside.verdict == "slower"


def test_a_hopeless_task_that_is_next_to_nothing_makes_no_bound():
    seconds = {"alfa": {"v3y": 1.0, "v4": 2.0}, "delete": {"v3y": 1.0, "v4": 20.0}}
    results = without(make_results(seconds), "delete", "v4", set(range(3, 8)))
    beside = ranked(asked(results, "alfa=1,delete=0.001"), "v4").beside
    assert (beside.verdict, beside.is_bound) == ("slower", False)


def test_of_a_cell_that_ended_early_the_median_stands_in_and_the_ends_at_the_ends():
    seconds = {"alfa": {"v3y": 1.0, "v4": 1.0}, "delete": {"v3y": 1.0, "v4": 2.0}}
    whole = make_results(seconds, launches=12, wobble=0.05)
    early = without(whole, "delete", "v4", set(range(8, 12)))
    found, full = (ranked(asked(one, "alfa=1,delete=1"), "v4").beside for one in (early, whole))
    twin = naive_totals(whole, {"alfa": 1.0})["v4"] / naive_totals(whole, {"alfa": 1.0})["v3y"]
    deleted = naive_totals(whole, {"delete": 1.0})["v4"][:8] / naive_totals(whole, {"delete": 1.0})["v3y"][:8]
    ratios = {
        end: sorted((twin + [*deleted, *[stand_in(deleted)] * 4]) / 2)
        for end, stand_in in {"low": np.min, "ratio": np.median, "high": np.max}.items()
    }
    assert found.is_whole
    assert not found.is_bound
    assert found.ratio == pytest.approx(math.exp(np.median(np.log(ratios["ratio"]))), rel=1e-3)
    rank = 2  # of 12 launches
    assert (found.low, found.high) == (pytest.approx(ratios["low"][rank]), pytest.approx(ratios["high"][-1 - rank]))
    assert found.low <= full.low * 1.05


def test_too_short_counts_like_the_reference():
    seconds = {"alfa": {"v3y": 1.0, "v4": 1.0}, "free": {"v3y": 0.001, "v4": 0.004}}
    results = make_results(seconds)
    found = asked(results, "alfa=0.01,free=1")
    assert ranked(found, "v4").too_short == ["free"]
    assert found.best == ["v3y", "v4"]
    assert "free is too short to be known for v4: it counts as long as v3y's" in advice_as([found], "table")
    assert "too short" not in advice_as([asked(results, "alfa=1,free=1")], "table")


def test_who_is_long_beside_a_reference_that_is_too_short_counts_in_full():
    seconds = {"alfa": {"v3y": 1.0, "v4": 0.5}, "free": {"v3y": 1e-4, "v4": 2.0}}
    found = asked(make_results(seconds, wobble=0.0), "alfa=1,free=1")
    assert ranked(found, "v4").seconds / ranked(found, "v3y").seconds == pytest.approx(2.5 / 1.0, rel=0.3)
    assert names(found)[0] == "v3y"


def test_a_first_one_of_few_launches_may_be_off_too():
    """v4 is ahead by a third, if its three launches of delete are right; by CLEAR off it would be behind."""
    seconds = {"alfa": {"v3y": 1.0, "v4": 0.5}, "delete": {"v3y": 1.0, "v4": 1.0}}
    assert asked(make_results(seconds), "alfa=1,delete=1").best == ["v4"]
    results = without(make_results(seconds), "delete", "v4", set(range(3, 8)))
    assert asked(results, "alfa=1,delete=1").best == ["v4", "v3y"]


def test_a_cell_that_is_too_short_is_so_in_every_launch():
    """The last launches of v4 are longer than SHORTEST_S; its median is not."""
    found = asked(make_results({"free": {"v3y": 0.001, "v4": 0.003}}), "free=1")
    beside = ranked(found, "v4").beside
    assert (beside.low, beside.ratio, beside.high) == (1.0, 1.0, 1.0)


def test_seconds_are_of_one_run_of_the_scenario():
    results = make_results({"alfa": {"v3y": 1.0, "v4": 2.0}}, wobble=0.0)
    often = [msgspec.structs.replace(one, repeats=4) for one in results.samples]
    found = [asked(one, "alfa=1") for one in (results, msgspec.structs.replace(results, samples=often))]
    for one, other in zip(*(each.ranked for each in found), strict=True):
        assert other.seconds == pytest.approx(one.seconds / 4)


def test_an_interval_holds_for_all_who_are_compared():
    """Of 7 contestants it needs 8 launches, of two 6."""
    two = {"alfa": {"v3y": 1.0, "v4": 2.0}}
    seven = {"alfa": {"v3y": 1.0, **dict.fromkeys(("v3", "v3x", "v4", "v5", "v5x", "v5y"), 2.0)}}
    assert [asked(make_results(two, launches=n), "alfa=1").has_intervals for n in (5, 6)] == [False, True]
    assert [asked(make_results(seven, launches=n), "alfa=1").has_intervals for n in (7, 8)] == [False, True]


# -- reasons


def test_reasons_name_what_takes_most_and_where_it_loses_most():
    found = asked(make_results(SECONDS, wobble=0.001), "alfa=1,delete=0.5")
    assert reason_of(found, ranked(found, "v3y")) == "alfa takes 95 % of its time"
    assert reason_of(found, ranked(found, "v3")) == "delete takes 76 % of its time, 50 times that of v3y"
    assert reason_of(found, ranked(found, "v4")) == "alfa takes 97 % of its time, 2.0 times that of v3y"
    found = asked(make_results(SECONDS, wobble=0.001), "explode=10,delete=0.5")
    assert reason_of(found, ranked(found, "v3")) == (
        "explode takes 80 % of its time; it loses most in delete, 50 times that of v3y"
    )


@given(weights=st.lists(st.floats(0.01, 100.0), min_size=3, max_size=3))
def test_shares_make_up_the_whole(weights):
    found = recommend(make_results(SECONDS, rounds=1), dict(zip(SECONDS, weights, strict=True)))[0]
    for one in found.ranked:
        assert sum(one.shares.values()) == pytest.approx(1)


# -- flips


@given(sweeps=st.floats(0.5, 50.0), deletes=st.floats(0.05, 5.0))
def test_on_the_far_side_of_a_flip_the_other_one_is_first(sweeps, deletes):
    results = make_results(SECONDS, rounds=1, wobble=0.01)
    mix = {"alfa": sweeps, "delete": deletes, "explode": 0.5}
    found = recommend(results, mix)[0]
    for outlook in found.outlooks:
        for flip in outlook.flips:
            assert flip.low <= flip.weight <= flip.high
            near, far = (0.97, 1.03) if flip.side == "above" else (1.03, 0.97)
            before = recommend(results, {**mix, outlook.task: near * flip.low if near < 1 else near * flip.high})[0]
            after = recommend(results, {**mix, outlook.task: far * flip.high if far > 1 else far * flip.low})[0]
            order = [names(before).index(name) < names(before).index(flip.backend) for name in names(found)[:1]]
            assert order == [True]
            assert names(after).index(flip.backend) < names(after).index(names(found)[0])


def test_a_flip_lies_where_both_take_as_long():
    found = asked(make_results(SECONDS, wobble=0.0), "alfa=10,delete=1")  # v3: 8 + 5 w, v3y: 10 + 0.1 w
    assert names(found)[0] == "v3y"
    (flip,) = next(one for one in found.outlooks if one.task == "delete").flips
    assert (flip.side, flip.backend) == ("below", "v3")
    assert flip.weight == pytest.approx(2 / 4.9)
    assert flip.share == pytest.approx(0.1 * (2 / 4.9) / (10 + 0.1 * (2 / 4.9)))
    (flip,) = next(one for one in found.outlooks if one.task == "alfa").flips
    assert (flip.side, flip.backend, flip.weight) == ("above", "v3", pytest.approx(4.9 / 0.2))
    assert flip.is_whole


def test_tasks_outside_the_mix_are_looked_at_too():
    found = asked(make_results(SECONDS, wobble=0.0), "alfa=10")
    assert names(found)[0] == "v3"
    (flip,) = next(one for one in found.outlooks if one.task == "delete").flips
    assert (flip.side, flip.backend, flip.weight) == ("above", "v3y", pytest.approx(2 / 4.9))
    assert next(one for one in found.outlooks if one.task == "alfa").holds == (0.0, None)


def test_the_nearest_flip_is_told():
    seconds = {"alfa": {"v3y": 1.0, "v3": 2.0, "v4": 3.0}, "delete": {"v3y": 1.0, "v3": 0.5, "v4": 0.1}}
    found = asked(make_results(seconds, wobble=0.0), "alfa=10")
    (flip,) = next(one for one in found.outlooks if one.task == "delete").flips
    assert (flip.backend, flip.weight) == ("v3", pytest.approx(20.0))  # v4 at 22.2


def test_what_is_far_from_the_mix_is_no_flip():
    """delete flips at 0.41 times; beside a mix with a hundred times as much of it, or where it would be all of the mix."""
    results = make_results(SECONDS, wobble=0.0)
    near, far = (asked(results, f"alfa=10,delete={deletes}") for deletes in (40, 42))
    flips = [next(one for one in found.outlooks if one.task == "delete").flips for found in (near, far)]
    assert [len(one) for one in flips] == [1, 0]
    tiny = {"alfa": {"v3y": 1.0, "v3": 9.0}, "delete": {"v3y": 1.0, "v3": 0.9}}  # flips at 80 times: 99 %
    assert not next(
        one for one in asked(make_results(tiny, wobble=0.0), "alfa=1").outlooks if one.task == "delete"
    ).flips


def test_no_flip_where_launches_disagree():
    results = make_results({"alfa": {"v3y": 1.0, "v3": 2.0}, "delete": {"v3y": 1.0, "v3": 1.0}}, wobble=0.05)
    found = asked(results, "alfa=1")
    outlook = next(one for one in found.outlooks if one.task == "delete")
    assert outlook.flips == []
    assert outlook.holds == (0.0, pytest.approx(23.4, rel=0.01))  # where one launch turns
    assert "The choice holds at least up to delete 23.5 times" in advice_as([found], "md")


@given(deletes=st.floats(0.05, 5.0), wobble=st.floats(0.0, 0.1))
def test_where_the_choice_holds_nobody_is_shown_to_be_faster(deletes, wobble):
    results = make_results(SECONDS, rounds=1, wobble=wobble)
    mix = {"alfa": 10.0, "delete": deletes, "explode": 0.5}
    found = recommend(results, mix)[0]
    first = names(found)[0]
    slower = {one.backend for one in found.ranked if one.beside and one.beside.verdict == "slower"}
    for outlook in found.outlooks:
        if outlook.holds is None:
            continue
        low, high = outlook.holds
        assert low <= outlook.weight
        for weight in (low, 0.9 * low + 0.1 * (high or 2 * outlook.weight), high or 1e6):
            if weight:
                totals = naive_totals(results, {**mix, outlook.task: weight})
                assert all((totals[first] <= 1.0101 * totals[name]).all() for name in slower)


def test_who_cannot_be_told_from_the_first_and_is_better_later_hides_a_flip():
    """v3 would overtake v3y with 12.5 deletes; v4, now as fast as v3y, has overtaken it long before."""
    seconds = {"alfa": {"v3y": 1.0, "v4": 1.0, "v3": 1.5}, "delete": {"v3y": 1.0, "v4": 0.5, "v3": 0.6}}
    found = asked(make_results(seconds, wobble=0.01), "alfa=10")
    assert found.best == ["v3y", "v4"]
    assert next(one for one in found.outlooks if one.task == "delete").flips == []
    alone = {task: {name: time for name, time in times.items() if name != "v4"} for task, times in seconds.items()}
    (flip,) = next(
        one for one in asked(make_results(alone, wobble=0.01), "alfa=10").outlooks if one.task == "delete"
    ).flips
    assert (flip.backend, flip.weight) == ("v3", pytest.approx(12.5, rel=0.05))


def test_whoever_cannot_do_a_task_is_no_danger_with_more_of_it():
    seconds = {"alfa": {"v3y": 1.0, "v3": 2.0}, "delete": {"v3y": 1.0, "v3": 0.1}}
    results = make_results(seconds, wobble=0.0)
    assert next(one for one in asked(results, "alfa=1").outlooks if one.task == "delete").flips
    results = change(results, "delete", "v3", status="crash", reason="signal 11")
    outlook = next(one for one in asked(results, "alfa=1").outlooks if one.task == "delete")
    assert (outlook.flips, outlook.holds) == ([], (0.0, None))
    results = change(make_results(seconds, wobble=0.0), "delete", "v3y", status="crash", reason="signal 11")
    outlook = next(one for one in asked(results, "alfa=1").outlooks if one.task == "delete")
    assert (outlook.flips, outlook.holds) == ([], None)


def test_nothing_is_said_of_tasks_that_are_doubted_or_too_short():
    seconds = {"alfa": {"v3y": 1.0, "v3": 2.0}, "delete": {"v3y": 1.0, "v3": 0.5}, "free": {"v3y": 1e-3, "v3": 1e-3}}
    results = make_results(seconds, wobble=0.0)
    outlooks = {one.task: one for one in asked(results, "alfa=1").outlooks}
    assert outlooks["delete"].flips
    assert (outlooks["free"].flips, outlooks["free"].holds) == ([], None)
    outlooks = {one.task: one for one in asked(slow(results, "delete", "v3y control", 1.5), "alfa=1").outlooks}
    assert (outlooks["delete"].flips, outlooks["delete"].holds) == ([], None)
    seconds["free"]["v4"] = seconds["alfa"]["v4"] = seconds["delete"]["v4"] = 0.1  # now the first is too short in free
    results = change(make_results(seconds, wobble=0.0), "free", "v4", cpu_s=1e-3, process_cpu_s=1e-3)
    results = change(results, "free", "v3", cpu_s=1.0, process_cpu_s=1.0)
    found = asked(results, "alfa=1")
    assert names(found)[0] == "v4"
    assert next(one for one in found.outlooks if one.task == "free").holds is None


def test_a_flip_that_rests_on_few_launches_is_a_hint():
    results = without(make_results(SECONDS), "delete", "v3", set(range(3, 8)))
    found = asked(results, "alfa=10,delete=1")
    flips = [flip for one in found.outlooks for flip in one.flips]
    assert {flip.backend for flip in flips} == {"v3"}
    assert not any(flip.is_whole for flip in flips)


def test_where_a_choice_holds_what_was_not_measured_is_at_its_worst():
    results = make_results(SECONDS, wobble=0.1)
    kept = [1, 3, 4]  # not the first, in which v3 is fastest
    few = without(results, "delete", "v3", set(range(8)) - set(kept))
    alfa, delete = (naive_totals(results, {task: 1.0}) for task in ("alfa", "delete"))
    deleted = delete["v3"] / delete["v3y"]
    least = min(deleted[kept])
    deleted = np.array([ratio if launch in kept else least for launch, ratio in enumerate(deleted)]) * delete["v3y"]
    rest, once = BEYOND * deleted - delete["v3y"], BEYOND * alfa["v3"] - alfa["v3y"]
    found = asked(few, "alfa=10,delete=1")
    assert next(one for one in found.outlooks if one.task == "alfa").holds[1] == pytest.approx(min(-rest / once))


def test_nothing_holds_where_a_launch_says_otherwise_already():
    results = make_results({"alfa": {"v3y": 1.0, "v4": 1.5}}, launches=12)
    other = [
        msgspec.structs.replace(one, cpu_s=one.cpu_s / 2) if (one.backend, one.launch) == ("v4", 11) else one
        for one in results.samples
    ]
    found = asked(msgspec.structs.replace(results, samples=other), "alfa=1")
    assert found.best == ["v3y"]
    assert found.outlooks[0].holds is None
    assert asked(results, "alfa=1").outlooks[0].holds == (0.0, None)


def test_whoever_cannot_be_told_from_the_first_does_not_spoil_what_holds():
    seconds = {"alfa": {"v3y": 1.0, "v4": 1.0, "v3": 2.0}}
    found = asked(make_results(seconds, wobble=0.03), "alfa=1")
    assert sorted(found.best) == ["v3y", "v4"]
    assert found.outlooks[0].holds == (0.0, None)


def test_a_flip_is_read_aloud():
    results = counted(make_results(SECONDS, wobble=0.01), alfa={"sweeps": 50}, delete={"deletions": 20_000})
    results = change(results, "delete", "v3y", items=20_000, unit="deletions")
    found = asked(results, "alfa=500,delete=1")
    said = {one.task: flip_of(found, one, flip) for one in found.outlooks for flip in one.flips}
    assert said["alfa"].startswith("v3 instead of v3y above 1,2")
    assert " sweeps of alfa (1," in said["alfa"]
    assert said["delete"].startswith("v3 instead of v3y below delete 0.4")
    assert "delete then takes 0.4 % of v3y's time" in said["delete"]
    few = asked(counted(make_results(SECONDS, launches=2), alfa={"sweeps": 50}), "alfa=500,delete=1")
    assert all(
        flip_of(few, one, flip).startswith("perhaps v3 instead of v3y") for one in few.outlooks for flip in one.flips
    )


# -- memory


def test_a_limit_of_memory_leaves_out_who_needs_more():
    results = make_results(SECONDS)
    held = {one.backend: one.peak_bytes for one in results.memory}
    assert held["v4"] > held["v3y"]
    found = asked(results, "alfa=1", memory_limit=held["v3y"])
    assert names(found) == ["v3", "v3y"]
    assert found.left_out[0].backend == "v4"
    assert found.left_out[0].reason.startswith("it needs 178 MB at its peak, the limit is 167 MB")
    size = next(iter(results.models[0].size.values()))
    assert ranked(found, "v3y").fits == pytest.approx(size)
    assert ranked(asked(results, "alfa=1", memory_limit=2 * held["v4"]), "v4").fits == pytest.approx(2 * size)
    assert "~tetras fit" in advice_as([found], "table")
    assert "640k" in advice_as([found], "table")
    assert names(asked(results, "alfa=1", memory_limit=1)) == []


def test_without_a_memory_pass_the_structure_counts():
    results = make_results(SECONDS, memory=[])
    used = make_memory("v3y").structure_bytes
    assert names(asked(results, "alfa=1", memory_limit=used)) == ["v3", "v3y"]
    assert "the structure alone counts as memory" in advice_as([asked(results, "alfa=1")], "table")
    nothing = [msgspec.structs.replace(one, structure={}) for one in results.backends]
    results = msgspec.structs.replace(results, backends=nothing)
    found = asked(results, "alfa=1", memory_limit=1)
    assert len(names(found)) == 3
    assert "Nothing is known of memory" in advice_as([found], "table")


def test_whoever_could_not_be_weighed_is_left_out_of_a_limit():
    memory = [make_memory("v3y"), make_memory("v3"), make_memory("v4", status="oom", reason="none left")]
    results = make_results(SECONDS, memory=memory)
    assert "v4" in names(asked(results, "alfa=1"))
    assert "v4" not in names(asked(results, "alfa=1", memory_limit=10**12))


def test_of_those_that_cannot_be_told_apart_the_smallest_is_named():
    seconds = {"alfa": {"v3y": 1.0, "v3": 1.0, "v4": 9.0}}
    small = {"peak_bytes": 160_000_000, "structure": {"tetras": (140_000_000, 140_000_000)}}
    memory = [make_memory("v3y"), make_memory("v3", **small), make_memory("v4", peak_bytes=1)]
    said = advice_of(asked(make_results(seconds, memory=memory), "alfa=1"))
    assert "Of these v3 needs least memory, 249 bytes a tetra." in said
    noisy = [make_memory("v3y"), make_memory("v3", peak_bytes=160_000_000), make_memory("v4", peak_bytes=1)]
    assert "least memory" not in advice_of(asked(make_results(seconds, memory=noisy), "alfa=1"))  # equal structures
    assert "least memory" not in advice_of(asked(make_results(seconds), "alfa=1"))  # the same


# -- mixes


def mixed(results: Results, text: str) -> str:
    return mix_words(make_mix(read_mix(text), parts_of(results)[0]))


def test_a_mix_is_spelled_out():
    results = counted(
        make_results(SECONDS),
        alfa={"sweeps": 50},
        delete={"deletions": 20_000},
        explode={"splits": 50_000, "deletions": 9},
    )
    for task, items, unit in (("delete", 20_000, "deletions"), ("explode", 49_976, "splits")):
        for backend in ("v3", "v3y", "v4"):
            results = change(results, task, backend, items=items, unit=unit)
    assert mixed(results, "alfa=200,delete=1,explode=0.1") == (
        "200 sweeps of alfa, delete once (20,000 deletions), explode 0.1 times (4,998 splits)"
    )
    assert mixed(results, "alfa=1, delete.deletions=5000") == "1 sweep of alfa, 5,000 deletions of delete"
    weights = [
        one.weight
        for one in make_mix(read_mix("alfa=200,delete.deletions=5000,explode.splits=49976"), parts_of(results)[0])
    ]
    assert weights == [4.0, 0.25, 1.0]  # explode did fewer splits than its option says
    assert amount_words(make_mix(read_mix("alfa=200"), parts_of(results)[0])[0], 1.0) == "50 sweeps of alfa"


def test_repeats_are_taken_out_of_the_work():
    results = change(make_results(SECONDS), "delete", "v3y", repeats=4, items=80_000, unit="deletions")
    results = change(results, "delete", "v3", repeats=4, items=80_000, unit="deletions")
    (amount,) = make_mix(read_mix("delete.deletions=20000"), parts_of(results)[0])
    assert amount.weight == 1.0


def test_tasks_of_a_sweep_over_options_have_their_own_names():
    seconds = {"alfa sweeps=10": {"v3y": 1.0, "v4": 2.0}, "alfa sweeps=50": {"v3y": 5.0, "v4": 10.0}}
    results = make_results(seconds)
    assert mixed(results, "alfa sweeps=10=200") == "200 sweeps of alfa sweeps=10"
    assert [one.weight for one in make_mix(read_mix("alfa sweeps=50=200"), parts_of(results)[0])] == [4.0]
    assert [one.weight for one in make_mix(read_mix("alfa sweeps=50.sweeps=25"), parts_of(results)[0])] == [0.5]
    with pytest.raises(InputError, match="several counts: name one of 'alfa sweeps=10', 'alfa sweeps=50'"):
        mixed(results, "alfa=3")
    with pytest.raises(InputError, match="several counts"):
        mixed(results, "alfa.sweeps=3")


def test_names_with_odd_characters():
    seconds = {"a.b&<c>": {"v3y": 1.0, "v4|*x*": 2.0}}
    found = asked(make_results(seconds, model=ODD), "a.b&<c>=3")
    assert found.best == ["v3y"]
    assert ODD in advice_as([found], "table")
    assert "v4\\|\\*x\\*" in advice_as([found], "md")
    assert json.loads(advice_as([found], "json"))["recommendations"][0]["ranked"][1]["backend"] == "v4|*x*"


def test_nothing_of_a_task_is_no_part_of_the_mix():
    found = asked(make_results(SECONDS), "alfa=1,delete=0")
    assert [one.task for one in found.mix] == ["alfa"]
    results = change(make_results(SECONDS), "delete", "v3", status="crash", reason="signal 11")
    assert names(asked(results, "alfa=1,delete=0"))[0] == "v3"


@pytest.mark.parametrize(
    ("mix", "says"),
    [
        ("alf=1", "no scenario in this run 'alf'; did you mean 'alfa'"),
        ("alf=0,delete=1", "no scenario in this run 'alf'"),
        ("delete.deletion=1", "no count of delete 'deletion'; did you mean 'deletions'"),
        ("nothing.deletions=1", "no scenario in this run 'nothing.deletions'"),
        ("alfa=-1", "'-1' of 'alfa' in the mix is no amount"),
        ("alfa=nan", "no amount"),
        ("alfa=inf", "no amount"),
        ("alfa=1e300", "no amount"),
        ("alfa=1e-300", "no amount"),
        ("alfa=many", "no amount"),
        ("alfa", "'alfa' in the mix says not how much"),
        ("=3", "'=3' in the mix says not how much"),
        ("alfa=0,delete=0", "the mix is empty"),
        ("", "the mix is empty"),
        ("alfa=1,alfa=2", "'alfa' is twice in the mix"),
        ("alfa=1,alfa.sweeps=2", "the task 'alfa' is twice in the mix"),
        ("alfa.nothing=2", "no count of alfa 'nothing'"),
    ],
)
def test_what_is_no_mix_is_refused(mix, says):
    results = counted(make_results(SECONDS), alfa={"sweeps": 50, "nothing": 0}, delete={"deletions": 20_000})
    with pytest.raises(InputError, match=says):
        asked(results, mix)


# -- runs


def test_each_model_has_its_own():
    run = make_sweep(
        {"alfa": {"v3y": 1.0, "v4": 0.5}}, {"v3y": 1.0, "v4": 2.0}, sizes=(1000, 10_000), rounds=1, wobble=0.0
    )
    small, large = recommend(run, {"alfa": 1.0})
    assert [small.best, large.best] == [["v4"], ["v3y"]]
    assert advice_as([small, large], "table").count("Use v") == 2


def test_a_run_that_says_nothing_is_refused():
    results = make_results(SECONDS)
    with pytest.raises(InputError, match="answers only"):
        asked(msgspec.structs.replace(results, profile="check"), "alfa=1")
    others = [one for one in results.backends if one.name != REFERENCE]
    with pytest.raises(InputError, match="without their reference, v3y"):
        asked(msgspec.structs.replace(results, backends=others), "alfa=1")
    with pytest.raises(InputError, match="no samples"):
        asked(msgspec.structs.replace(results, samples=[]), "alfa=1")
    versions: list[Backend] = [make_backend("v3y"), make_backend("v4", against="v4")]
    with pytest.raises(InputError, match="several references"):
        asked(msgspec.structs.replace(results, backends=versions), "alfa=1")


def test_json_holds_everything_unrounded():
    found = asked(make_results(SECONDS), "alfa=1,delete=0.1")
    (facts,) = json.loads(advice_as([found], "json"))["recommendations"]
    assert facts["advice"] == advice_of(found)
    assert set(facts["reasons"]) == {"v3", "v3y", "v4"}
    assert facts["ranked"][1]["beside"]["low"] == found.ranked[1].beside.low
    assert facts["outlooks"][0]["flips"] == [msgspec.to_builtins(flip) for flip in found.outlooks[0].flips]
    assert facts["mix"][1]["number"] == 0.1
