"""Numberings: factors that were put in are found again, launch by launch, and nothing ranks that minutes could make."""

import math
from statistics import median
from typing import Any

import msgspec
import pytest

from tests.report.made import change, make_results, slow
from tetrabench.bench.numbering import LARGE, NATURAL, Renumbered, numberings_of, renumberings, spreads
from tetrabench.bench.pairs import fewest_for
from tetrabench.bench.record import Results
from tetrabench.bench.statistics import CLEAR, SHORTEST_S, confidence_of, summary

SECONDS = {"alfa": {"v3y": 0.1, "v4": 0.4}, "locate": {"v3y": 0.2, "v4": 0.2}}
FACTORS = {"hilbert": {"v3y": 0.7, "v4": 0.5}, "shuffled": {"v3y": 4.0, "v4": 6.0}}


def make_numbered(factors: dict[str, dict[str, float]] = FACTORS, **choices: Any) -> Results:
    """A run of a model in its natural numbering and in others, in which each contestant takes so many times as long."""
    runs = [make_results(SECONDS, **choices)]
    for numbering, of in factors.items():
        times = {task: {name: of[name] * time for name, time in cell.items()} for task, cell in SECONDS.items()}
        runs.append(make_results(times, model=f"nozzle {numbering}", **choices))
    joined = {
        part: [one for run in runs for one in getattr(run, part)]
        for part in ("models", "launches", "memory", "samples")
    }
    return msgspec.structs.replace(runs[0], **joined)


def of(results: Results, backend: str, numbering: str = "shuffled", task: str = "alfa") -> Renumbered:
    place = (task, backend, numbering)
    return next(one for one in renumberings(results) if (one.task, one.backend, one.numbering) == place)


def off(results: Results, model: str, factors: list[float]) -> Results:
    """The same where one model took so many times as long in each launch."""
    samples = [
        msgspec.structs.replace(one, cpu_s=one.cpu_s * factors[one.launch]) if one.model == model else one
        for one in results.samples
    ]
    return msgspec.structs.replace(results, samples=samples)


def test_factors_that_were_put_in_are_found():
    found = renumberings(make_numbered())
    assert [(one.task, one.backend, one.numbering) for one in found] == [
        (task, backend, numbering) for task in SECONDS for backend in ("v3y", "v4") for numbering in FACTORS
    ]
    for one in found:
        assert one.ratio == pytest.approx(FACTORS[one.numbering][one.backend])
        assert (one.model, one.launches, one.is_whole, one.clock) == ("nozzle", 8, True, "cpu")
        assert one.verdict == ("slower" if one.numbering == "shuffled" else "faster")
        assert not one.is_bound


def test_launches_are_paired_by_their_number():
    """The machine is ever slower, and the numbering a little more so in some launches: what both share cancels."""
    hours = [1.0, 3.0, 2.0, 8.0, 5.0, 9.0, 4.0, 7.0]
    more = [1.0, 1.1, 0.9, 1.2, 1.0, 1.3, 0.8, 1.05]
    results = off(make_numbered(wobble=0.0), "nozzle", hours)
    results = off(results, "nozzle shuffled", [hour * factor for hour, factor in zip(hours, more, strict=True)])
    shuffled = msgspec.structs.replace(results, samples=results.samples[::-1])  # whatever order they stand in
    for run in (results, shuffled):
        found = of(run, "v3y")
        assert found.ratio == pytest.approx(4.0 * math.exp(median(map(math.log, more))))
        assert (found.low, found.high) == (pytest.approx(4.0 * 0.8), pytest.approx(4.0 * 1.3))


def test_within_a_launch_the_median_counts():
    results = make_numbered(wobble=0.0, rounds=3)
    samples = [
        msgspec.structs.replace(one, cpu_s=100.0) if one.round == 1 and one.model != "nozzle" else one
        for one in results.samples
    ]
    found = of(msgspec.structs.replace(results, samples=samples), "v4")
    assert found.ratio == pytest.approx(6.0 * 1.02 / 1.01)  # rounds drift by a percent: the last one is the median


@pytest.mark.parametrize(
    ("factor", "verdict"),
    [
        (1.0, "same"),
        (LARGE / 1.05, "same"),
        (LARGE, "inconclusive"),
        (LARGE * 1.05, "slower"),
        (1 / LARGE, "inconclusive"),
        (1 / LARGE / 1.05, "faster"),
    ],
)
def test_only_a_large_difference_ranks(factor: float, verdict: str):
    results = make_numbered({"rcm": {"v3y": factor, "v4": 1.0}}, wobble=0.0)
    found = of(off(results, "nozzle rcm", [0.98, 1.02] * 4), "v3y", "rcm")
    assert (found.verdict, found.is_whole) == (verdict, True)


@pytest.mark.parametrize(
    ("factor", "verdict"),
    [(CLEAR * 1.05, "slower"), (CLEAR / 1.05, "about"), (1 / CLEAR / 1.05, "faster"), (1.0, "about")],
)
def test_too_few_launches_rank_what_is_clear_in_each(factor: float, verdict: str):
    found = of(make_numbered({"rcm": {"v3y": factor, "v4": 1.0}}, launches=3), "v3y", "rcm")
    assert (found.verdict, found.is_whole) == (verdict, False)
    assert found.is_bound == (verdict != "about")


@pytest.mark.parametrize("more", [1, 3])
def test_an_interval_holds_for_all_numberings_together(more: int):
    """The more numberings are compared with the natural one, the more launches it takes."""
    factors = {f"n{place}": {"v3y": 2.0, "v4": 2.0} for place in range(more)}
    fewest = fewest_for(confidence_of(more))
    assert not of(make_numbered(factors, launches=fewest - 1), "v4", "n0").is_whole
    assert of(make_numbered(factors, launches=fewest), "v4", "n0").is_whole


def test_a_launch_without_a_partner_is_no_pair():
    results = make_numbered()
    fewer = [one for one in results.samples if (one.model, one.launch) != ("nozzle", 7)]
    assert of(msgspec.structs.replace(results, samples=fewer), "v4").launches == 7
    none = [one for one in results.samples if one.launch % 2 == (one.model == "nozzle")]
    found = of(msgspec.structs.replace(results, samples=none), "v4")
    assert (found.verdict, found.ratio, found.launches) == ("missing", None, 0)


@pytest.mark.parametrize("model", ["nozzle", "nozzle shuffled"])
@pytest.mark.parametrize(
    ("status", "verdict"), [("wrong-result", "wrong"), ("crash", "crashed"), ("skipped", "skipped")]
)
def test_nothing_is_said_of_what_did_not_end_well(model: str, status: str, verdict: str):
    results = make_numbered()
    samples = [
        msgspec.structs.replace(one, status=status, reason="why")
        if (one.model, one.task, one.backend, one.launch) == (model, "alfa", "v4", 2)
        else one
        for one in results.samples
    ]
    results = msgspec.structs.replace(results, samples=samples)
    found = of(results, "v4")
    assert (found.verdict, found.ratio, found.reason) == (verdict, None, f"{model}: why")
    assert of(results, "v4", task="locate").verdict == "slower"
    assert of(results, "v4", "hilbert").verdict == (verdict if model == "nozzle" else "faster")


def test_a_cell_that_was_not_run_is_missing():
    results = make_numbered()
    fewer = [one for one in results.samples if (one.model, one.backend) != ("nozzle shuffled", "v4")]
    found = of(msgspec.structs.replace(results, samples=fewer), "v4")
    assert (found.verdict, found.ratio) == ("missing", None)


def test_samples_that_are_too_short_say_nothing():
    results = slow(make_numbered(), "alfa", "v4", SHORTEST_S)  # of less than a second, so below it
    assert (of(results, "v4").verdict, of(results, "v4").ratio) == ("too short", None)
    assert of(results, "v3y").verdict == "slower"


def test_repeats_are_no_difference():
    results = make_numbered()
    samples = [
        msgspec.structs.replace(one, repeats=5, cpu_s=5 * one.cpu_s) if one.model == "nozzle" else one
        for one in results.samples
    ]
    assert of(msgspec.structs.replace(results, samples=samples), "v4").ratio == pytest.approx(6.0)


def test_a_parallel_task_is_compared_by_wall_time():
    results = make_numbered()
    tasks = [msgspec.structs.replace(task, parallel=True) for task in results.tasks]
    samples = [
        msgspec.structs.replace(one, wall_s=3.0 if one.model == "nozzle shuffled" else 1.0) for one in results.samples
    ]
    found = of(msgspec.structs.replace(results, tasks=tasks, samples=samples), "v4")
    assert (found.clock, found.ratio) == ("wall", pytest.approx(3.0))


def test_models_of_another_name_or_size_are_no_numberings():
    results = make_numbered()
    assert numberings_of(results) == {
        "nozzle": {"natural": "nozzle", "hilbert": "nozzle hilbert", "shuffled": "nozzle shuffled"}
    }
    names = ("nozzle", "intake shuffled", "nozzle shuffled rcm")
    strange = [msgspec.structs.replace(one, name=name) for one, name in zip(results.models, names, strict=True)]
    assert numberings_of(msgspec.structs.replace(results, models=strange)) == {}
    other = msgspec.structs.replace(results.models[2], size={"tetras": 5})
    assert (
        "shuffled" not in numberings_of(msgspec.structs.replace(results, models=[*results.models[:2], other]))["nozzle"]
    )
    assert renumberings(make_results()) == spreads(make_results()) == []


def test_spreads_say_what_a_layout_and_what_a_numbering_makes():
    results = make_numbered()
    found = {(one.task, one.between, one.within): one for one in spreads(results)}
    assert len(found) == 2 * (3 + 2)
    layout = found["alfa", "backends", NATURAL]
    assert (layout.ratio, layout.fastest, layout.slowest) == (pytest.approx(4.0), "v3y", "v4")
    assert found["alfa", "backends", "hilbert"].ratio == pytest.approx(4.0 * 0.5 / 0.7)
    numbering = found["alfa", "numberings", "v4"]
    assert (numbering.ratio, numbering.fastest, numbering.slowest) == (pytest.approx(6.0 / 0.5), "hilbert", "shuffled")
    assert found["alfa", "numberings", "v3y"].ratio == pytest.approx(4.0 / 0.7)
    assert found["locate", "backends", NATURAL].ratio == 1.0
    assert spreads(results, summary(results)) == spreads(results)


def test_what_ranks_nothing_spreads_nothing():
    wrong = change(make_numbered(), "alfa", "v4", status="wrong-result")
    found = {(one.task, one.between, one.within): one.ratio for one in spreads(wrong)}
    assert found["alfa", "backends", NATURAL] == found["alfa", "numberings", "v4"] == 1.0
    results = off(make_numbered(launches=3), "nozzle shuffled", [0.9, 1.0, 1.2])
    few = {(one.task, one.between, one.within): one for one in spreads(results)}
    widest = few["alfa", "numberings", "v3y"]
    assert widest.fastest == NATURAL  # 0.7 is a hint
    assert widest.ratio == pytest.approx(4.0 * 0.9)  # at least
