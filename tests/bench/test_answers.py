"""Who is right: majorities, ties, contestants that contradict themselves, and controls, which have no vote."""

import pytest

from tetrabench.bench import Backend, Sample
from tetrabench.bench.answers import judge
from tetrabench.bench.plan import control_of


def said(backend, *digests, task="alfa", status="ok", model="box", **more):
    """A sample for each answer."""
    place = {"model": model, "task": task, "backend": backend, "launch": 0}
    return [Sample(**place, status=status, round=round, digest=digest, **more) for round, digest in enumerate(digests)]


def judged(*groups, inexact=()):
    """The status of each sample, in order."""
    samples = [sample for group in groups for sample in group]
    names = dict.fromkeys(sample.backend for sample in samples)
    backends = [
        Backend(name=name, contestant=name, title=name, against="a", exact=name not in inexact)
        for name in names
        if " " not in name
    ]
    backends += [control_of(backend) for backend in backends if f"{backend.name} control" in names]
    return judge(samples, backends)


def statuses(*groups, **more):
    return [sample.status for sample in judged(*groups, **more)]


def test_the_majority_is_right_by_contestants_and_not_by_samples():
    samples = judged(said("a", "d", "d"), said("b", "d"), said("c", "x", "x", "x", "x"))
    assert [one.status for one in samples] == ["ok"] * 3 + ["wrong-result"] * 4
    assert samples[-1].reason == "c says x, most say d: the same figures, but other bits"


def test_what_differs_is_shown():
    samples = judged(
        said("a", "d", figures={"count": 2, "sum": 0.5, "only": 1.0}),
        said("b", "d", figures={"count": 2, "sum": 0.5, "only": 1.0}),
        said("c", "x", figures={"count": 2, "sum": None, "new": 0.1}),
    )
    reason = (
        "c says x, most say d: sum none instead of 0.5, only none instead of 1, new 0.10000000000000001 instead of none"
    )
    assert samples[-1].reason == reason


@pytest.mark.parametrize("answers", [["d", "x"], ["d", "d", "x", "x"], ["d", "x", "y"], ["d", "d", "x", "y"]])
def test_without_a_majority_nobody_is_right(answers):
    samples = judged(*(said(f"b{k}", answer) for k, answer in enumerate(answers)))
    assert {one.status for one in samples} == {"wrong-result"}
    listed = ", ".join(f"b{k} {answer}" for k, answer in enumerate(answers))
    assert samples[0].reason == f"no answer has a majority: {listed}"


def test_who_contradicts_itself_is_unstable_where_it_differs():
    samples = judged(said("a", "d"), said("b", "d"), said("c", "d", "x", "d"))
    assert [one.status for one in samples] == ["ok", "ok", "ok", "unstable", "ok"]
    assert samples[3].reason == "not always the same answer; c says x, most say d: the same figures, but other bits"


def test_alone_with_two_answers():
    assert statuses(said("a", "d", "x")) == ["unstable"] * 2


def test_alone_with_one_answer():
    assert statuses(said("a", "d", "d")) == ["ok"] * 2


def test_two_against_each_other_of_whom_one_agrees_now_and_then():
    assert statuses(said("a", "d"), said("b", "d", "x")) == ["ok", "ok", "unstable"]


def test_a_control_has_no_vote():
    """Else a reference would be two."""
    assert statuses(said("a", "d"), said("b", "x"), said("a control", "d")) == ["wrong-result"] * 3
    assert statuses(said("a", "x"), said("b", "d"), said("c", "d"), said("a control", "x")) == [
        "wrong-result",
        "ok",
        "ok",
        "wrong-result",
    ]


def test_who_is_known_to_be_wrong_has_no_vote():
    groups = said("a", "d"), said("b", "x"), said("c", "x")
    assert statuses(*groups) == ["wrong-result", "ok", "ok"]
    assert statuses(*groups, inexact="bc") == ["ok", "wrong-result", "wrong-result"]
    assert statuses(said("a", "d"), said("b", "d"), said("c", "d"), inexact="c") == ["ok"] * 3  # right for once
    assert statuses(said("a", "d"), said("b", "x"), said("c", "x"), inexact="c") == ["wrong-result"] * 3


@pytest.mark.parametrize("others", [[], [said("a", "", status="crash")], [said("a control", "x")]])
def test_who_is_known_to_be_wrong_is_never_right_for_want_of_others(others):
    samples = judged(said("b", "y", "y"), said("b", "", status="oom"), *others, inexact="b")
    assert [one.status for one in samples[:3]] == ["wrong-result", "wrong-result", "oom"]
    assert samples[0].reason.startswith("no answer has a majority: b y")
    assert {one.status for one in samples[3:]} <= {"crash", "ok"}


def test_a_control_alone_is_not_judged():
    """A run that was interrupted, or whose reference crashed."""
    assert statuses(said("a control", "d")) == ["ok"]
    assert statuses(said("a control", "d"), said("a", "", status="crash")) == ["ok", "crash"]


def test_bad_ends_have_no_vote_and_stay_what_they_are():
    assert statuses(
        said("a", "d"), said("b", "x", status="crash"), said("c", "x", status="oom"), said("e", "x", status="error")
    ) == ["ok", "crash", "oom", "error"]


def test_tasks_and_models_are_judged_apart():
    assert statuses(said("a", "d"), said("a", "x", task="flow"), said("a", "y", model="ball")) == ["ok"] * 3


def test_to_judge_twice_changes_nothing():
    samples = judged(said("a", "d"), said("b", "d"), said("c", "d", "x"), said("e", "y"))
    backends = [Backend(name=name, contestant=name, title=name, against="a") for name in "abce"]
    assert judge(samples, backends) == samples
