"""Growth with size: exponents that were put in are found again, and none where the sizes do not carry one."""

import msgspec
import pytest

from tests.report.made import change, make_results, make_sweep, slow
from tetrabench.bench.growth import Growth, growth
from tetrabench.bench.pairs import FEWEST
from tetrabench.bench.record import Results

SECONDS = {"alfa": {"v3y": 0.1, "v4": 0.2}, "delete": {"v3y": 0.1, "v4": 0.1}}
EXPONENTS = {"v3y": 1.0, "v4": 1.3}
SIZES = [10_000, 30_000, 100_000, 200_000, 300_000]


def sweep(sizes: list[int] = SIZES, **choices) -> Results:
    return make_sweep(SECONDS, EXPONENTS, sizes, **choices)


def of(results: Results, backend: str, task: str = "alfa") -> Growth:
    return next(one for one in growth(results) if (one.task, one.backend) == (task, backend))


def test_exponents_that_were_put_in_are_found():
    grown = growth(sweep())
    assert [(one.task, one.backend) for one in grown] == [
        ("alfa", "v3y"),
        ("alfa", "v4"),
        ("delete", "v3y"),
        ("delete", "v4"),
    ]
    for one in grown:
        assert one.exponent == pytest.approx(EXPONENTS[one.backend], abs=1e-9)  # all sizes of a launch are off alike
        assert (one.sizes, one.smallest, one.largest, one.launches) == (5, 10_000, 300_000, 8)


def test_each_launch_is_one_exponent_and_their_spread_the_interval():
    """Of eight launches the largest size is off by a factor: the slope moves by what least squares make of it."""
    factors = [0.5, 0.7, 0.9, 1.0, 1.0, 1.1, 1.4, 2.0]
    results = sweep(wobble=0.0)
    samples = [
        msgspec.structs.replace(one, cpu_s=one.cpu_s * factors[one.launch], process_cpu_s=one.cpu_s)
        if (one.model, one.backend) == ("nozzle-300000", "v4")
        else one
        for one in results.samples
    ]
    found = of(msgspec.structs.replace(results, samples=samples), "v4")
    numpy = pytest.importorskip("numpy")
    slopes = sorted(
        numpy.polyfit(numpy.log(SIZES), [1.3 * numpy.log(n) + (n == 300_000) * numpy.log(f) for n in SIZES], 1)[0]
        for f in factors
    )
    assert found.exponent == pytest.approx((slopes[3] + slopes[4]) / 2)
    assert (found.low, found.high) == (pytest.approx(slopes[0]), pytest.approx(slopes[-1]))
    assert found.is_whole


@pytest.mark.parametrize("launches", [3, FEWEST - 1, FEWEST])
def test_too_few_launches_give_a_range_and_say_so(launches: int):
    found = of(sweep(launches=launches), "v4")
    assert found.exponent == pytest.approx(1.3)
    assert found.is_whole == (launches == FEWEST)


def test_a_launch_with_too_few_sizes_is_no_part_of_it():
    results = sweep()
    fewer = [one for one in results.samples if (one.model, one.launch) != ("nozzle-200000", 7)]
    assert of(msgspec.structs.replace(results, samples=fewer), "v4").launches == 7


@pytest.mark.parametrize(
    ("sizes", "reason"),
    [
        (SIZES[:4], "a fit needs 5 sizes over a factor of 30, there are 4 over 20"),
        ([100, 200, 300, 400, 500], "there are 5 over 5"),
        ([100, 3000], "there are 2 over 30"),
    ],
)
def test_none_where_the_sizes_do_not_carry_one(sizes: list[int], reason: str):
    found = of(sweep(sizes), "v4")
    assert (found.exponent, found.low, found.high) == (None, None, None)
    assert reason in found.reason


def test_nothing_for_one_size():
    assert growth(make_results()) == []
    assert growth(make_results(models=[])) == []


def test_a_cell_that_went_wrong_is_no_point():
    results = sweep([5_000, *SIZES])
    crashed = [
        msgspec.structs.replace(one, status="crash", cpu_s=None)
        if (one.model, one.task, one.backend, one.launch) == ("nozzle-5000", "alfa", "v4", 0)
        else one
        for one in results.samples
    ]
    found = of(msgspec.structs.replace(results, samples=crashed), "v4")
    assert (found.sizes, found.smallest) == (5, 10_000)
    assert of(change(results, "alfa", "v4", status="crash"), "v4").reason.endswith(
        "there are none (nozzle-5000 crashed, nozzle-10000 crashed, nozzle-30000 crashed, nozzle-100000 crashed, "
        "nozzle-200000 crashed, nozzle-300000 crashed)"
    )


def test_samples_that_are_too_short_are_no_points():
    results = slow(sweep(), "alfa", "v4", 0.01)
    found = of(results, "v4")
    assert found.exponent is None
    assert "nozzle-10000 too short" in found.reason


def test_repeats_are_not_growth():
    """A smaller model repeats more often in a sample: what counts is the time of one run."""
    results = sweep()
    samples = [
        msgspec.structs.replace(one, repeats=9, cpu_s=9 * one.cpu_s, process_cpu_s=9 * one.cpu_s)
        if one.model == "nozzle-10000"
        else one
        for one in results.samples
    ]
    assert of(msgspec.structs.replace(results, samples=samples), "v4").exponent == pytest.approx(1.3)


def test_a_parallel_task_is_fitted_by_wall_time():
    results = sweep()
    tasks = [msgspec.structs.replace(task, parallel=True) for task in results.tasks]
    samples = [msgspec.structs.replace(one, wall_s=1.0) for one in results.samples]
    found = of(msgspec.structs.replace(results, tasks=tasks, samples=samples), "v4")
    assert (found.clock, found.exponent) == ("wall", pytest.approx(0.0))
