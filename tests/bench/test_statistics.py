"""Intervals against known distributions and against scipy, verdicts at their borders, what the launch is the unit for."""

import math
from itertools import pairwise

import msgspec
import numpy as np
import pytest
from scipy import stats

from tests.report.made import REFERENCE, make_results, slow
from tetrabench.bench import Backend, Effort, Results, Sample, Task, exit_code, summary
from tetrabench.bench.pairs import CONFIDENCE, fewest_for, interval_rank
from tetrabench.bench.plan import control_of
from tetrabench.bench.record import Launch, Memory, Model, Yardsticks
from tetrabench.bench.statistics import (
    ALIKE,
    BEYOND,
    CLEAR,
    PARALLEL,
    SHORTEST_S,
    Interval,
    confidence_of,
    fewest_launches,
    interval_over,
    launch_ratios,
    rebased,
    summary_against,
    verdict_of,
)

# ---------------------------------------------------------------------- the interval


@pytest.mark.parametrize("confidence", [0.5, 0.9, 0.95, 0.99, confidence_of(6), confidence_of(20), 0.9999])
def test_the_rank_is_that_of_the_binomial_distribution(confidence):
    """The largest one whose tails, by scipy, hold no more than is allowed."""
    for n in range(1, 120):
        allowed = (1 - confidence) / 2
        wanted = max((k for k in range(n // 2) if stats.binom.cdf(k, n, 0.5) <= allowed * (1 + 1e-9)), default=None)
        if wanted is None:
            assert n < fewest_for(confidence)
            with pytest.raises(ValueError, match=f"needs {fewest_for(confidence)} values at least, not {n}"):
                interval_rank(n, confidence)
        else:
            assert n >= fewest_for(confidence)
            assert interval_rank(n, confidence) == wanted


@pytest.mark.parametrize("n", [6, 8, 9, 12, 15, 20, 40])
def test_the_interval_is_what_the_sign_test_does_not_reject(n, rng):
    """By scipy's test of binomial counts, at every place between the samples and outside them."""
    values = np.sort(rng.normal(0.3, 1.0, n))
    interval = interval_over(values, CONFIDENCE)
    places = [values[0] - 1, *((a + b) / 2 for a, b in pairwise(values)), values[-1] + 1]
    for place in places:
        p = stats.binomtest(int((values > place).sum()), n, 0.5).pvalue
        assert (interval.low < math.exp(place) < interval.high) == (p > 1 - CONFIDENCE)


@pytest.mark.parametrize("n", [8, 12, 21])
def test_the_interval_lies_within_that_of_scipys_quantile_test_at_most_a_rank_apart(n, rng):
    values = np.sort(rng.lognormal(0.0, 0.5, n))
    theirs = stats.quantile_test(values, q=0, p=0.5).confidence_interval(confidence_level=CONFIDENCE)
    ours = interval_over(values, CONFIDENCE)
    ranks = [int(np.argmin(abs(values - value))) for value in (*np.log([ours.low, ours.high]), *theirs)]
    assert abs(ranks[0] - ranks[2]) <= 1
    assert abs(ranks[1] - ranks[3]) <= 1
    assert ours.ratio == pytest.approx(math.exp(np.median(values)))


DISTRIBUTIONS = {  # of the logarithm of a launch's ratio; each with its median
    "normal": (lambda rng, size: rng.normal(0.1, 0.04, size), 0.1),
    "skewed": (lambda rng, size: rng.exponential(0.1, size), 0.1 * math.log(2)),
    "heavy tails": (lambda rng, size: 0.02 * rng.standard_cauchy(size) - 0.3, -0.3),
    "now and then four times as slow": (
        lambda rng, size: np.where(rng.random(size) < 0.2, math.log(4), 0.0) + rng.normal(0, 0.01, size),
        0.01 * stats.norm.ppf(0.5 / 0.8),
    ),
    "two levels": (lambda rng, size: rng.choice([0.0, 0.3], size) + rng.uniform(0, 0.01, size), None),
}


@pytest.mark.parametrize("launches", [8, 12, 20])
@pytest.mark.parametrize("kind", DISTRIBUTIONS)
def test_the_interval_holds_the_median_as_often_as_it_says(kind, launches, rng):
    """Within the error of so many trials; it is a discrete test, so that it holds it rather more often."""
    draw, median = DISTRIBUTIONS[kind]
    trials = 4000
    draws = draw(rng, (trials, launches))
    confidence = confidence_of(6)
    held = 0
    for ratios in draws:
        interval = interval_over(ratios.tolist(), confidence)
        assert interval.is_whole
        if median is None:  # any place between the levels is a median
            held += interval.low < math.exp(0.3) and interval.high > math.exp(0.01)
        else:
            held += interval.low <= math.exp(median) <= interval.high
    assert held / trials >= confidence - 3 * math.sqrt(confidence * (1 - confidence) / trials)


def test_all_intervals_of_a_task_hold_together(rng):
    """Six contestants, each as fast as the reference: at most one task in twenty has one that says otherwise."""
    trials, launches, contestants = 1500, fewest_launches(6), 6
    draws = 0.05 * rng.standard_t(3, (trials, contestants, launches))
    each, together = 0, 0
    for task in draws:
        misses = [not one.low <= 1 <= one.high for one in (interval_over(row, confidence_of(6)) for row in task)]
        together += any(misses)
        each += sum(not one.low <= 1 <= one.high for one in (interval_over(row, 0.9) for row in task)) > 0
    assert together / trials <= 1 - CONFIDENCE + 3 * math.sqrt(0.05 * 0.95 / trials)
    assert each / trials > 0.2  # what intervals that each hold for themselves would do


@pytest.mark.parametrize(
    ("contestants", "launches"), [(0, 6), (1, 6), (2, 7), (3, 7), (6, 8), (7, 9), (12, 9), (13, 10)]
)
def test_launches_that_an_interval_needs(contestants, launches):
    assert fewest_launches(contestants) == launches
    whole = interval_over([0.0] * launches, confidence_of(contestants))
    assert whole == Interval(1.0, 1.0, 1.0, True)
    assert not interval_over([0.0] * (launches - 1), confidence_of(contestants)).is_whole


def test_too_few_launches_have_their_range_and_none_has_nothing():
    assert interval_over([], CONFIDENCE) is None
    interval = interval_over([math.log(2), 0.0, math.log(8)], CONFIDENCE)
    assert interval == (pytest.approx(2), pytest.approx(1), pytest.approx(8), False)


# ---------------------------------------------------------------------- verdicts

TINY = 1e-9
BORDERS = [
    ((1 / ALIKE, ALIKE, True), "same"),
    ((1.0, ALIKE + TINY, True), "inconclusive"),
    ((1 / ALIKE - TINY, 1.0, True), "inconclusive"),
    ((1.02, 1.03, True), "same"),  # differs, by less than counts
    ((BEYOND, 1.5, True), "inconclusive"),
    ((BEYOND + TINY, 1.5, True), "slower"),
    ((0.5, 1 / BEYOND, True), "inconclusive"),
    ((0.5, 1 / BEYOND - TINY, True), "faster"),
    ((0.5, 2.0, True), "inconclusive"),
    ((1.0, 1.0, False), "about"),
    ((CLEAR, 10.0, False), "about"),
    ((CLEAR + TINY, 10.0, False), "slower"),
    ((0.1, 1 / CLEAR, False), "about"),
    ((0.1, 1 / CLEAR - TINY, False), "faster"),
]


@pytest.mark.parametrize(("interval", "verdict"), BORDERS)
def test_verdicts_at_their_borders(interval, verdict):
    low, high, is_whole = interval
    assert verdict_of(Interval(math.sqrt(low * high), low, high, is_whole)) == verdict


# ---------------------------------------------------------------------- rows


def samples(backend, seconds, *, status="ok", **more):
    """Samples from an array (launches, rounds) of CPU seconds."""
    figures = {"items": 1000, "digest": "d", "unit": "tetras", **more}
    return [
        Sample(
            **{
                "model": "box",
                "task": "alfa",
                "backend": backend,
                "status": status,
                "launch": launch,
                "round": round,
                "cpu_s": float(cpu_s),
                "process_cpu_s": float(cpu_s),
                "wall_s": 2 * float(cpu_s),
                **figures,
            }
        )
        for launch, rounds in enumerate(np.atleast_2d(seconds))
        for round, cpu_s in enumerate(rounds)
    ]


def results(*groups, parallel=False, launches=(), memory=(), ended=""):
    found = [sample for group in groups for sample in group]
    names = dict.fromkeys(sample.backend for sample in found)
    backends = [Backend(name=name, contestant=name, title=name, against="v3y") for name in names if " " not in name]
    backends += [control_of(one) for one in backends if f"{one.name} control" in names]
    return Results(
        command="tetrabench run --model box",
        profile="default",
        family="tetra",
        models=[Model(name="box")],
        tasks=[Task(name="alfa", scenario="alfa", parallel=parallel)],
        backends=backends,
        reference="v3y",
        effort=Effort(launches=8, rounds=3, hopeless_rounds=3),
        seed=0,
        started="2024-01-01T00:00:00+00:00",
        environment={},
        samples=found,
        launches=list(launches),
        memory=list(memory),
        ended=ended,
    )


def row(name, *groups, **more):
    return next(row for row in summary(results(*groups, **more)) if row.backend == name)


NOISE = np.random.default_rng(7).lognormal(0, 0.5, (8, 3))  # of the machine, in each round


def test_the_noise_of_a_round_is_in_both_and_cancels():
    slow = row("v4", samples("v3y", NOISE), samples("v4", 2 * NOISE))
    assert (slow.ratio, slow.low, slow.high) == tuple(pytest.approx(2.0) for _ in range(3))
    assert (slow.verdict, slow.launches, slow.samples, slow.clock) == ("slower", 8, 24, "cpu")
    assert not slow.is_bound
    assert slow.spread == pytest.approx(0.0)
    assert slow.seconds == pytest.approx(np.median(2 * NOISE))
    assert slow.ns_per_item == pytest.approx(np.median(2 * NOISE) / 1000 * 1e9)
    reference = row("v3y", samples("v3y", NOISE), samples("v4", 2 * NOISE))
    assert (reference.verdict, reference.ratio) == ("reference", None)


def test_a_launch_counts_once_with_the_median_of_its_rounds():
    offsets = np.array([[1.1, 1.2, 9.0], [1.3, 1.3, 0.1], [1.5, 1.2, 1.4]])
    ratios = launch_ratios(samples("v4", NOISE[:3] * offsets), samples("v3y", NOISE[:3]), "cpu")
    assert [math.exp(ratio) for ratio in ratios.values()] == pytest.approx([1.2, 1.3, 1.4])


def test_pairs_are_of_the_same_round_launch_and_group():
    ours = samples("v4", [[2.0]]) + samples("v4", [[6.0]], group=1, launch=1)
    theirs = samples("v3y", [[1.0]]) + samples("v3y", [[3.0]], group=1, launch=1) + samples("v3y", [[9.0]], launch=1)
    assert row("v4", theirs, ours).high == pytest.approx(2.0)
    assert row("v4", theirs, samples("v4", [[2.0]], launch=7)).verdict == "no reference"


def test_identical_code_with_offsets_of_whole_launches_raises_no_alarm(rng):
    """What was measured: a launch puts all rounds of a process off by the same few percent. The launch is the unit for
    that reason: an interval over all rounds, as if they were independent, is wrong in every third case."""
    trials, launches, rounds = 400, 8, 10
    by_launch, pooled = 0, 0
    for _ in range(trials):
        offset = rng.normal(0, 0.12, (launches, 1)) + 0.01 * rng.standard_t(3, (launches, rounds))
        mine = row("v4", samples("v3y", np.ones((launches, rounds))), samples("v4", np.exp(offset)))
        by_launch += mine.verdict in ("faster", "slower")
        pooled += verdict_of(interval_over(offset.ravel().tolist(), CONFIDENCE)) in ("faster", "slower")
    assert by_launch / trials <= 1 - CONFIDENCE + 3 * math.sqrt(0.05 * 0.95 / trials)
    assert pooled / trials > 0.3


def test_a_control_that_differs_takes_the_belief_out_of_its_neighbours():
    reference = samples("v3y", NOISE)
    neighbours = [samples("v4", 2 * NOISE), samples("v5", NOISE), samples("v6", NOISE * 4), samples("v7", NOISE * 0.5)]
    good = {row.backend: row.verdict for row in summary(results(reference, *neighbours, samples("v3y control", NOISE)))}
    assert good == {
        "v3y": "reference",
        "v4": "slower",
        "v5": "same",
        "v6": "slower",
        "v7": "faster",
        "v3y control": "control",
    }
    odd = summary(results(reference, *neighbours, samples("v3y control", 1.2 * NOISE)))
    assert {one.verdict for one in odd} == {"reference", "inconclusive", "control"}
    assert next(one.reason for one in odd if one.backend == "v4") == (
        "the control, a second copy of v3y, took 1.20 times as long as it"
    )


def test_a_control_that_is_alike_or_uncertain_casts_no_doubt():
    for factor in (1.03, np.where(np.arange(8)[:, None] < 2, 0.8, 1.3)):
        control = samples("v3y control", NOISE * factor)
        assert row("v4", samples("v3y", NOISE), samples("v4", 2 * NOISE), control).verdict == "slower"


def test_few_launches_say_what_is_clear_and_about_how_much_the_rest():
    few = NOISE[:3]
    clear = row("v4", samples("v3y", few), samples("v4", 4 * few))
    assert (clear.verdict, clear.is_bound) == ("slower", True)
    hint = row("v4", samples("v3y", few), samples("v4", 2 * few))
    assert (hint.verdict, hint.is_bound, hint.low) == ("about", False, pytest.approx(2.0))


@pytest.mark.parametrize(
    ("reference", "other", "verdict"),
    [
        (0.4 * SHORTEST_S, 0.9 * SHORTEST_S, "too short"),
        (0.9 * SHORTEST_S, 1.005 * SHORTEST_S, "too short"),  # 1.12 times, but half a percent of what can be told
        (0.4 * SHORTEST_S, 80 * SHORTEST_S, "slower"),  # 80 times at least
        (80 * SHORTEST_S, 0.4 * SHORTEST_S, "faster"),
        (SHORTEST_S, SHORTEST_S, "same"),
        (SHORTEST_S, 0.99 * SHORTEST_S, "too short"),
    ],
)
def test_a_short_sample_ranks_only_by_what_is_certain(reference, other, verdict):
    ones = np.ones((8, 1))
    assert row("v4", samples("v3y", reference * ones), samples("v4", other * ones)).verdict == verdict


def test_a_control_too_short_casts_no_doubt():
    ones = 0.5 * SHORTEST_S * np.ones((8, 1))
    found = row("v4", samples("v3y", ones), samples("v4", 100 * ones), samples("v3y control", 1.9 * ones))
    assert found.verdict == "slower"


def test_repeats_are_divided_out_of_figures_but_not_of_the_ratio():
    short = SHORTEST_S / 4 * np.ones((8, 1))
    ours = samples("v4", 2 * 8 * short, repeats=8, items=8000, least_bytes=8 * 10**6)
    found = row("v4", samples("v3y", 8 * short, repeats=8, items=8000), ours)
    assert (found.verdict, found.ratio) == ("slower", pytest.approx(2.0))  # long enough together
    assert found.seconds == pytest.approx(SHORTEST_S / 2)
    assert found.ns_per_item == pytest.approx(SHORTEST_S / 2 / 1000 * 1e9)
    assert found.gb_per_s == pytest.approx(1e6 / (SHORTEST_S / 2) / 1e9)


def test_bandwidth_is_shown_as_a_share_of_what_the_core_could_do():
    launches = [
        Launch(
            model=model,
            launch=launch,
            core=0,
            begun="",
            yardsticks=Yardsticks(copy_gb_s=1.0, triad_gb_s=triad, latency_ns=90.0) if triad else None,
        )
        for model, launch, triad in [
            ("box", 0, 8.0),
            ("box", 1, 10.0),
            ("box", 2, 30.0),
            ("box", 3, None),
            ("ball", 0, 1.0),
        ]
    ]
    one = samples("v3y", np.ones((4, 1)), least_bytes=5 * 10**9)
    found = row("v3y", one, launches=launches)
    assert (found.gb_per_s, found.share_of_limit) == (pytest.approx(5.0), pytest.approx(0.5))
    assert row("v3y", one).share_of_limit is None
    assert row("v3y", samples("v3y", [[1.0]]), launches=launches).gb_per_s is None


def test_a_parallel_task_goes_by_wall_time():
    found = row("v4", samples("v3y", NOISE), samples("v4", NOISE, wall_s=6.0), parallel=True)
    assert (found.clock, found.seconds) == ("wall", 6.0)
    assert found.ratio != pytest.approx(1.0)


@pytest.mark.parametrize(("share", "clock"), [(PARALLEL, "cpu"), (PARALLEL + 0.01, "wall")])
def test_who_works_with_several_threads_is_noticed_and_all_go_by_wall_time(share, clock):
    threaded = samples("v4", np.ones((8, 1)), process_cpu_s=share)
    rows = summary(results(samples("v3y", np.ones((8, 1))), threaded))
    assert {one.clock for one in rows} == {clock}
    assert rows[0].seconds == (1.0 if clock == "cpu" else 2.0)


def test_threads_in_one_sample_of_many_or_in_a_short_one_are_no_parallel_task():
    one = samples("v4", np.ones((7, 1))) + samples("v4", [[1.0]], launch=7, process_cpu_s=9.0)
    assert row("v4", samples("v3y", np.ones((8, 1))), one).clock == "cpu"
    short = samples("v4", np.full((8, 1), 0.1 * SHORTEST_S), process_cpu_s=0.9 * SHORTEST_S)
    assert row("v4", samples("v3y", np.ones((8, 1))), short).clock == "cpu"


@pytest.mark.parametrize(
    ("status", "verdict"),
    [
        ("wrong-result", "wrong"),
        ("unstable", "unstable"),
        ("crash", "crashed"),
        ("oom", "out of memory"),
        ("timeout", "timed out"),
        ("error", "failed"),
        ("unsupported", "unsupported"),
        ("skipped", "skipped"),
    ],
)
def test_a_cell_that_ended_badly_has_no_figures(status, verdict):
    bad = samples("v4", NOISE[:2]) + samples("v4", [[1.0]], launch=2, status=status, reason="because")
    found = row("v4", samples("v3y", NOISE), bad)
    assert (found.verdict, found.status, found.reason) == (verdict, status, "because")
    assert (found.ratio, found.seconds, found.ns_per_item, found.samples, found.launches) == (None, None, None, 6, 2)
    orphan = row("v4", samples("v3y", [[1.0]], status=status), samples("v4", NOISE))
    assert (orphan.verdict, orphan.ratio) == ("no reference", None)
    assert orphan.seconds == pytest.approx(np.median(NOISE))


def test_a_wrong_answer_that_was_expected_is_no_failure_and_ranks_nowhere():
    wrong = samples("v4", [[1.0]], status="wrong-result", reason="v4 says 1, most say 2")
    run = results(samples("v3y", NOISE), wrong)
    assert exit_code(run) == 3
    run = msgspec.structs.replace(
        run, backends=[msgspec.structs.replace(one, exact=one.name != "v4") for one in run.backends]
    )
    (found,) = (row for row in summary(run) if row.backend == "v4")
    assert (found.verdict, found.status) == ("inexact", "wrong-result")
    assert found.reason == "known to give wrong answers; v4 says 1, most say 2"
    assert (found.ratio, found.seconds) == (None, None)
    assert exit_code(run) == 0
    crashed = [msgspec.structs.replace(one, status="crash") if one.backend == "v4" else one for one in run.samples]
    assert exit_code(msgspec.structs.replace(run, samples=crashed)) == 3


def test_of_several_bad_ends_the_worst_is_named():
    both = samples("v4", [[1.0]], status="skipped", reason="x") + samples("v4", [[1.0]], status="crash", reason="y")
    assert row("v4", samples("v3y", NOISE), both).reason == "y"


def test_rows_come_in_the_order_of_the_plan():
    groups = [samples("v3y control", NOISE), samples("v4", NOISE), samples("v3y", NOISE)]
    assert [one.backend for one in summary(results(*groups))] == ["v4", "v3y", "v3y control"]


# ---------------------------------------------------------------------- exit codes


def test_exit_codes():
    good = samples("v3y", NOISE)
    assert exit_code(results(good)) == 0
    for status in ("skipped", "unsupported"):
        assert exit_code(results(good, samples("v4", [[1.0]], status=status))) == 0
    for status in ("crash", "timeout", "oom", "error", "wrong-result", "unstable"):
        bad = samples("v4", [[1.0]], status=status)
        assert exit_code(results(good, bad)) == 3
        assert exit_code(results(good, bad, ended="interrupted")) == 130
        assert exit_code(results(good, ended="budget")) == 0


def test_memory_that_went_wrong_or_is_unaccounted_for_is_3():
    good, mebi = samples("v3y", NOISE), 2**20
    weighed = {"model": "box", "backend": "v3y", "structure": {"a": (5 * mebi, 9 * mebi)}}
    assert exit_code(results(good, memory=[Memory(**weighed, retained_bytes=4 * mebi)])) == 0
    assert exit_code(results(good, memory=[Memory(**weighed, retained_bytes=4 * mebi - 1)])) == 3
    assert exit_code(results(good, memory=[Memory(**weighed)])) == 0
    assert exit_code(results(good, memory=[Memory(model="box", backend="v3y", status="crash")])) == 3


# ---------------------------------------------------------------------- another reference


def test_another_reference_takes_the_same_rounds():
    results = make_results(wobble=0.02)
    theirs = {(row.task, row.backend): row for row in summary_against(results, "v4")}
    for row in summary(results):
        if row.backend == "v4":  # seen from the other end: a ratio and its interval turn over
            other = theirs[row.task, REFERENCE]
            assert (other.ratio, other.low, other.high) == pytest.approx((1 / row.ratio, 1 / row.high, 1 / row.low))
            assert {other.verdict, row.verdict} in ({"slower", "faster"}, {"same"}, {"inconclusive"})
    assert {row.verdict for row in theirs.values() if row.backend == "v4"} == {"reference"}
    assert not any(row.control for row in theirs.values())
    assert summary(rebased(results, REFERENCE)) == summary(results)


def test_a_control_casts_its_doubt_whoever_the_reference_is():
    results = slow(make_results(wobble=0.0), "alfa", f"{REFERENCE} control", 1.5)
    rows = {(row.task, row.backend): row for row in summary_against(results, "v4")}
    assert rows["alfa", "v3"].verdict == "inconclusive"
    assert "a second copy of v3y, took 1.50 times" in rows["alfa", "v3"].reason
    assert rows["flow", "v3"].verdict == "faster"


def test_a_control_casts_its_doubt_where_the_reference_is_so_noisy_that_nothing_ranked_anyway():
    """The reference and its control are off together by half, the control by a fifth more: v4 and v3 are quiet."""
    results = make_results({"alfa": {"v3": 1.0, "v3y": 1.0, "v4": 1.3}}, launches=12, wobble=0.0)
    swing = {launch: math.exp(0.5 * (-1) ** launch) for launch in range(12)}
    samples = []
    for one in results.samples:
        factor = {REFERENCE: 1.0, f"{REFERENCE} control": 1.2}.get(one.backend)
        seconds = one.cpu_s * (factor * swing[one.launch] if factor else 1.0)
        samples.append(msgspec.structs.replace(one, cpu_s=seconds, process_cpu_s=seconds))
    results = msgspec.structs.replace(results, samples=samples)
    assert {row.verdict for row in summary(results) if row.backend in ("v3", "v4")} == {"inconclusive"}
    rows = {row.backend: row for row in summary_against(results, "v4")}
    assert rows["v3"].ratio == pytest.approx(1 / 1.3)
    assert rows["v3"].verdict == "inconclusive"
    assert "took 1.20 times" in rows["v3"].reason


def test_a_control_says_nothing_of_those_with_another_reference():
    results = slow(make_results(wobble=0.0), "alfa", f"{REFERENCE} control", 1.5)
    apart = [
        msgspec.structs.replace(one, against="v4") if one.name in ("v4", "v5", "v5x") else one
        for one in results.backends
    ]
    rows = {row.backend: row for row in summary_against(msgspec.structs.replace(results, backends=apart), "v4")}
    verdicts = {
        row.backend: row.verdict
        for row in summary(msgspec.structs.replace(results, backends=apart))
        if row.task == "alfa"
    }
    assert verdicts["v3"] == "inconclusive"
    assert verdicts["v5"] in ("same", "faster", "slower")
    assert rows["v5"].reason == ""
