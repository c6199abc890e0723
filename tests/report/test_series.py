"""Series: joined, told of one step, of whom; against what the samples hold."""

from itertools import pairwise
from statistics import median

import msgspec
import pytest

from tests.report.made_lines import CAPACITIES, STEPS, STRETCHES, make_contestants, make_run
from tetrabench.bench import summary
from tetrabench.bench.record import Results
from tetrabench.report.lines import MOST_ALIKE
from tetrabench.report.series import MOST, WHOLE, Course, Track, courses_of

TREE = make_contestants(names=["kdtree", "grid"])
PHASES = ("update", "pairs", "respond", "move")


def courses(results: Results) -> list[Course]:
    return courses_of(results, summary(results))


def course_of(results: Results) -> Course:
    (course,) = courses(results)
    return course


def track_of(course: Course, backend: str, quantity: str) -> Track:
    (track,) = (one for one in course.tracks if (one.line.backend.name, one.quantity) == (backend, quantity))
    return track


def with_series(results: Results, change) -> Results:
    samples = [msgspec.structs.replace(one, series=change(one)) for one in results.samples]
    return msgspec.structs.replace(results, samples=samples)


def test_times_are_medians_of_one_step_and_counts_those_of_the_first_sample():
    results = make_run({"gravity": 2.0}, TREE, launches=3, rounds=2)
    results = with_series(
        results, lambda one: one.series | {"contacts": [x + one.launch for x in one.series["contacts"]]}
    )
    course = course_of(results)
    assert (course.model, course.task, course.axis, course.left_out) == ("uniform", "gravity", "step", 0)
    for backend in TREE:
        mine = [one.series for one in results.samples if one.backend == backend.name]
        whole = track_of(course, backend.name, WHOLE)
        assert whole.places == [STEPS * (stretch + 1) for stretch in range(STRETCHES)]
        for stretch in range(STRETCHES):
            times = [sum(one[f"{phase}_s"][stretch] for phase in PHASES) / STEPS for one in mine]
            assert whole.values[stretch] == pytest.approx(median(times))
            times = [one["pairs_s"][stretch] / STEPS for one in mine]
            assert track_of(course, backend.name, "pairs").values[stretch] == pytest.approx(median(times))
        assert track_of(course, backend.name, "contacts").values == mine[0]["contacts"]


def test_what_one_has_and_others_have_not_is_its_own():
    course = course_of(make_run({"gravity": 1.0}, TREE))
    assert [*course.quantities] == [WHOLE, *PHASES, "contacts", "leaves", "fill", "merges"]
    assert [quantity for quantity, is_time in course.quantities.items() if is_time] == [WHOLE, *PHASES]
    assert {track.line.backend.name for track in course.tracks if track.quantity == "leaves"} == {"kdtree"}
    assert course.heading(WHOLE) == "time of a step"
    assert course.heading("pairs") == "time of a step: pairs"
    assert course.heading("leaves") == "leaves"


@pytest.mark.parametrize("stretches", [MOST, MOST + 1, 250, 1000])
def test_long_runs_are_joined_and_nothing_is_lost(stretches):
    results = make_run({"gravity": 1.0}, TREE, launches=1, stretches=stretches)
    course = course_of(results)
    for backend in TREE:
        series = next(one.series for one in results.samples if one.backend == backend.name)
        whole, contacts = (track_of(course, backend.name, name) for name in (WHOLE, "contacts"))
        assert len(whole.values) == len(contacts.values) <= MOST
        assert len(whole.values) > MOST // 2
        assert whole.places[-1] == STEPS * stretches
        lengths = [after - before for before, after in pairwise([0, *whole.places])]
        seconds = sum(value * length for value, length in zip(whole.values, lengths, strict=True))
        assert seconds == pytest.approx(sum(sum(series[f"{phase}_s"]) for phase in PHASES))
        assert contacts.values == [series["contacts"][series["step"].index(place)] for place in contacts.places]


def test_stretches_of_unlike_length_are_told_of_one_step():
    """A step takes as long everywhere, whatever the stretches are."""
    ends = [1.0, 10.0, 100.0, 1000.0]
    lengths = [1.0, 9.0, 90.0, 900.0]
    results = with_series(
        make_run({"gravity": 1.0}, TREE), lambda one: {"step": ends, "move_s": [0.5 * length for length in lengths]}
    )
    course = course_of(results)
    assert [*course.quantities] == [WHOLE]  # one phase is all of it
    assert track_of(course, "kdtree", WHOLE).values == [0.5] * 4


def test_without_steps_stretches_are_counted():
    results = with_series(make_run({"gravity": 1.0}, TREE), lambda one: {"move_s": [1.0, 2.0], "leaves": [3.0, 4.0]})
    course = course_of(results)
    assert (course.axis, course.heading(WHOLE)) == ("stretch", "time of a stretch")
    track = track_of(course, "kdtree", WHOLE)
    assert (track.places, track.values) == ([1.0, 2.0], [1.0, 2.0])


@pytest.mark.parametrize("series", [{}, {"step": [25.0], "move_s": [1.0]}])
def test_one_stretch_is_no_course(series):
    assert courses(with_series(make_run({"gravity": 1.0}, TREE), lambda one: series)) == []


def test_tasks_without_series_are_left_out():
    results = make_run({"build": 1.0, "gravity": 1.0, "motion": 1.0}, TREE)
    results = with_series(results, lambda one: {} if one.task == "build" else one.series)
    assert [course.task for course in courses(results)] == ["gravity", "motion"]


@pytest.mark.parametrize("status", ["wrong-result", "crash", "unstable", "error"])
def test_who_went_wrong_is_not_drawn_unless_known_to_be_wrong(status):
    results = make_run({"gravity": 1.0}, make_contestants(names=["kdtree", "grid", "leaf-only"]))
    samples = [
        msgspec.structs.replace(one, status=status) if one.backend != "kdtree" else one for one in results.samples
    ]
    course = course_of(msgspec.structs.replace(results, samples=samples))
    labels = [line.label for line in course.lines]
    assert labels == (["kdtree", "leaf-only (wrong answers)"] if status == "wrong-result" else ["kdtree"])


def test_who_is_known_to_be_wrong_and_is_right_is_not_called_wrong():
    results = make_run({"gravity": 1.0}, make_contestants(names=["kdtree", "leaf-only"]))
    samples = [msgspec.structs.replace(one, status="ok") for one in results.samples]
    course = course_of(msgspec.structs.replace(results, samples=samples))
    assert [line.label for line in course.lines] == ["kdtree", "leaf-only"]


def test_controls_are_not_drawn():
    tree, grid = TREE
    results = make_run(
        {"gravity": 1.0}, [tree, grid, msgspec.structs.replace(tree, name="kdtree control", control=True)]
    )
    assert [line.label for line in course_of(results).lines] == ["kdtree", "grid*"]


def test_of_many_options_some_are_drawn_from_the_first_to_the_last():
    backends = make_contestants(range(1, 21), names=["kdtree", "grid"])
    course = course_of(make_run({"gravity": 1.0}, backends, launches=1))
    names = [line.backend.name for line in course.lines]
    assert len(names) == MOST_ALIKE + 1
    assert (names[0], names[-2:]) == ("kdtree capacity=1", ["kdtree capacity=20", "grid"])
    assert course.left_out == 20 - MOST_ALIKE
    backends = make_contestants(CAPACITIES, names=["kdtree", "grid"])
    assert course_of(make_run({"gravity": 1.0}, backends, launches=1)).left_out == 0
