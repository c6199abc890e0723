"""The numbers behind the charts, against the samples they come from."""

import math
from itertools import pairwise
from statistics import median

import msgspec
import pytest

from tests.report.made import make_results, slow
from tests.report.page.pages import TASKS, sweep, two_runs
from tetrabench.bench import Results, summary
from tetrabench.bench.statistics import SHORTEST_S, summary_against
from tetrabench.errors import InputError
from tetrabench.report.page import figures
from tetrabench.report.page.subjects import ABSOLUTE, OWN, bases_of, make_runs, make_subjects


def subjects_of(runs: list[tuple[str, Results]]):
    return make_subjects(make_runs(runs))


@pytest.mark.parametrize("base", ["v3y", "v4", "v5y"])
def test_times_are_those_of_the_summary_against_each_base(base):
    runs = two_runs()
    subjects = subjects_of(runs)
    drawn = figures.times(subjects, [base])
    for (_, results), subject in zip(runs, subjects, strict=True):
        for row in summary_against(results, base):
            if row.control:
                continue
            datum = next(
                one
                for one in drawn[row.task]
                if (one["model"], one["backend"], one["base"]) == (subject.label, row.backend, base)
            )
            assert datum["verdict"] == row.verdict
            if row.verdict == "reference":
                assert datum["value"] == 1.0
            elif row.ratio is None or row.verdict == "too short":
                assert datum["value"] is None
                assert datum["word"]
            else:
                assert datum["value"] == row.ratio
                assert (datum["low"], datum["high"]) == ((None, None) if row.is_bound else (row.low, row.high))


def test_the_reference_reaches_as_far_as_its_second_copy():
    results = make_results(TASKS, wobble=0.1)
    control = next(row for row in summary(results) if row.control and row.task == "alfa")
    datum = next(
        one for one in figures.times(subjects_of([("run", results)]), ["v3y"])["alfa"] if one["backend"] == "v3y"
    )
    assert (datum["value"], datum["low"], datum["high"]) == (1.0, control.low, control.high)


def test_what_went_wrong_is_a_word_whatever_its_speed():
    drawn = figures.times(subjects_of(two_runs()), ["v3y", ABSOLUTE])["alfa"]
    crashed = [one for one in drawn if (one["model"], one["backend"]) == ("intake", "v5y")]
    assert {(one["base"], one["word"], one["value"], one["sure"]) for one in crashed} == {
        ("v3y", "crashed", None, False),
        (ABSOLUTE, "crashed", None, False),
    }


def test_seconds_and_the_range_of_the_launches():
    results = make_results(TASKS)
    drawn = figures.times(subjects_of([("run", results)]), [ABSOLUTE])["alfa"]
    for datum in drawn:
        times: dict[int, list[float]] = {}
        for one in results.samples:
            if (one.task, one.backend) == ("alfa", datum["backend"]):
                times.setdefault(one.launch, []).append(one.cpu_s or 0.0)
        middles = [median(all_) for all_ in times.values()]
        assert datum["value"] == median(one for all_ in times.values() for one in all_)
        assert (datum["low"], datum["high"]) == (min(middles), max(middles))


def test_samples_are_multiples_of_the_same_round_and_noise_is_that_of_the_control():
    results = make_results(TASKS, launches=4, rounds=3, wobble=0.2)
    drawn = figures.samples(subjects_of([("run", results)]))["alfa"]
    by_place = {(one.backend, one.launch, one.round): one.cpu_s for one in results.samples if one.task == "alfa"}
    control = [
        by_place["v3y control", launch, round] / by_place["v3y", launch, round]
        for launch in range(4)
        for round in range(3)
    ]
    assert len(drawn) == 4 * 12
    for datum in drawn:
        launch, round = divmod(datum["place"] - 1, 3)
        assert datum["ratio"] == pytest.approx(
            by_place[datum["backend"], launch, round] / by_place["v3y", launch, round]
        )
        assert (datum["quiet"], datum["loud"]) == pytest.approx((min(control), max(control)))


def test_samples_are_counted_as_the_ratios_beside_them_are():
    """A sample of the reference under 5 ms counts as 5 ms; who is too short himself, or went wrong, has no line."""
    results = make_results(TASKS, wobble=0.0)
    drawn = figures.samples(subjects_of([("run", results)]))["free"]
    assert {one["backend"] for one in drawn} == {"v3y", "v4"}
    raw = {(one.backend, one.launch, one.round): one.cpu_s for one in results.samples if one.task == "free"}
    for one in drawn:
        launch, round = divmod(one["place"] - 1, 3)
        times = (raw[name, launch, round] for name in (one["backend"], "v3y"))
        mine, theirs = (max(seconds, SHORTEST_S) for seconds in times)
        assert one["ratio"] == pytest.approx(mine / theirs)
    broken = [
        msgspec.structs.replace(one, status="wrong-result")
        if (one.task, one.backend, one.launch) == ("alfa", "v4", 0)
        else one
        for one in results.samples
    ]
    wrong = figures.samples(subjects_of([("run", msgspec.structs.replace(results, samples=broken))]))["alfa"]
    assert "v4" not in {one["backend"] for one in wrong}
    assert "v5y" in {one["backend"] for one in wrong}


def test_one_round_is_no_chart_of_samples():
    assert figures.samples(subjects_of([("run", make_results(TASKS, launches=1, rounds=1))])) == {}


def test_the_front_is_what_nobody_is_shown_to_beat():
    (name, results), *_ = two_runs()
    kind, drawn = figures.trade(subjects_of([(name, results)])[0])
    assert kind == "peak"
    for datum in drawn:
        verdicts = {
            rival.backend: next(
                row.verdict
                for row in summary_against(results, rival.backend)
                if (row.task, row.backend) == (datum["task"], datum["backend"])
            )
            for rival in results.memory
        }
        sizes = {one.backend: one.peak_bytes for one in results.memory}
        mine = sizes[datum["backend"]]
        beaten = any(
            (0.99 < sizes[rival] / mine < 1.01 and verdict == "slower")
            or (sizes[rival] / mine < 0.99 and verdict in ("slower", "same"))
            for rival, verdict in verdicts.items()
        )
        assert datum["front"] == (not beaten)
        assert datum["bytes"] == pytest.approx(mine / results.models[0].size["tetras"])
    assert {one["backend"] for one in drawn if one["front"] and one["task"] == "alfa"} == {"v3y"}


def test_the_line_is_the_front_of_the_medians():
    """Whatever the intervals say: 1.2 s is off it where 1.0 s is as large, though one launch shows no difference."""
    once = make_results({"alfa": {"v3": 1.2, "v3y": 1.0, "v4": 0.5, "v5y": 5.0}}, launches=1, rounds=1)
    _, drawn = figures.trade(subjects_of([("run", once)])[0])
    assert {one["backend"] for one in drawn if one["least"]} == {"v3y", "v4"}
    assert {one["backend"] for one in drawn if one["front"]} == {"v3", "v3y", "v4"}


def test_a_larger_and_faster_one_is_on_the_front_too():
    results = slow(make_results({"alfa": {"v3y": 1.0, "v4": 1.0}}), "alfa", "v4", 0.5)
    _, drawn = figures.trade(subjects_of([("run", results)])[0])
    assert {(one["backend"], one["front"]) for one in drawn} == {("v3y", True), ("v4", True)}


def test_memory_of_nothing_can_be_compared():
    """The process of a tiny model may not grow at all."""
    results = make_results({"alfa": {"v3": 1.0, "v3y": 1.0, "v4": 2.0}})
    memory = [
        msgspec.structs.replace(one, retained_bytes=0, peak_bytes=0 if one.backend != "v3" else 4096)
        for one in results.memory
    ]
    kind, drawn = figures.trade(subjects_of([("run", msgspec.structs.replace(results, memory=memory))])[0])
    assert kind == "peak"
    assert {one["backend"]: one["front"] for one in drawn} == {"v3": False, "v3y": True, "v4": False}


def test_what_cannot_be_told_apart_is_all_on_the_front():
    once = make_results({"alfa": {"v3": 1.2, "v3y": 1.0, "v5y": 5.0}}, launches=1, rounds=1)
    _, drawn = figures.trade(subjects_of([("run", once)])[0])
    assert {one["backend"] for one in drawn if one["front"]} == {"v3", "v3y"}


def test_each_model_has_the_kind_of_memory_that_is_known_of_it():
    (_, first), (_, second) = two_runs()
    bare = [msgspec.structs.replace(one, peak_bytes=None) for one in second.memory]
    subjects = subjects_of([("a", first), ("b", msgspec.structs.replace(second, memory=bare))])
    assert [figures.trade(subject)[0] for subject in subjects] == ["peak", "retained"]
    assert all(figures.trade(subject)[1] for subject in subjects)


def test_a_base_of_another_run_leaves_a_word():
    (_, first), (_, second) = two_runs()
    samples = [one for one in second.samples if one.backend != "v4"]
    backends = [one for one in second.backends if one.name != "v4"]
    subjects = subjects_of([("a", first), ("b", msgspec.structs.replace(second, samples=samples, backends=backends))])
    drawn = figures.times(subjects, ["v4"])["init"]
    assert {one["word"] for one in drawn if one["model"] == "intake"} == {"no v4"}
    assert not [one for one in drawn if one["model"] == "intake" and one["value"] is not None]


def test_growth_takes_every_size():
    drawn = figures.growth(subjects_of(sweep()))
    assert sorted({one["size"] for one in drawn}) == [100, 300, 1000, 3000, 10_000]
    v4 = sorted((one["size"], one["ns"]) for one in drawn if one["backend"] == "v4")
    slopes = [math.log(b[1] * b[0] / a[1] / a[0]) / math.log(b[0] / a[0]) for a, b in pairwise(v4)]
    assert slopes == pytest.approx([1.2] * 4, abs=0.02)
    assert figures.growth(subjects_of(two_runs())) == []  # two runs of one size each are no ladder


def test_buffers_add_up_to_the_structure():
    (name, results), *_ = two_runs()
    drawn = figures.fields(subjects_of([(name, results)]))
    for memory in results.memory:
        mine = sum(one["bytes"] for one in drawn if one["backend"] == memory.backend)
        assert mine * results.models[0].size["tetras"] == pytest.approx(memory.structure_bytes)


def test_shares_of_the_limit_are_those_of_the_summary():
    (name, results), *_ = two_runs()
    shares = {(one["task"], one["backend"]): one["share"] for one in figures.limits(subjects_of([(name, results)]))}
    rows = {(row.task, row.backend): row.share_of_limit for row in summary(results) if not row.control}
    assert shares == {key: share for key, share in rows.items() if share is not None}
    assert shares


def test_labels_and_runs_are_unique():
    (_, first), (_, second) = two_runs()
    assert [one.label for one in subjects_of([("a", first), ("b", second)])] == ["nozzle", "intake"]
    assert [one.label for one in subjects_of([("a", first), ("b", first)])] == ["nozzle (a)", "nozzle (b)"]
    assert [one.label for one in subjects_of([("a", first), ("a", first)])] == ["nozzle (a)", "nozzle (a 2)"]
    (_, one), (_, other) = sweep() * 2
    assert {row["run"] for row in figures.growth(subjects_of([("s", one), ("s", other)]))} == {"s", "s 2"}


def test_the_usual_base_comes_first():
    subjects = subjects_of(two_runs())
    assert bases_of(subjects) == ["v3y", "v3", "v4", "v5y", ABSOLUTE]
    other = make_results({"alfa": {"v3y": 1.0, "v4": 2.0}}, reference="v4")
    other.backends[:] = [one for one in other.backends if not one.control]
    other.backends[:] = [msgspec.structs.replace(one, against="v4") for one in other.backends]
    assert bases_of(subjects_of([*two_runs(), ("other", other)]))[0] == OWN


def test_runs_that_cannot_stand_on_a_page_are_refused():
    results = make_results(TASKS)
    for changed, words in [
        ({"profile": "check"}, "run: holds answers only"),
        ({"samples": []}, "run: holds no samples"),
    ]:
        with pytest.raises(InputError, match=words):
            subjects_of([("run", make_results(TASKS, **changed))])
    with pytest.raises(InputError, match="several families"):
        subjects_of([("a", results), ("b", make_results(TASKS, family="polygon"))])
