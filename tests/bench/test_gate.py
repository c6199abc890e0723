"""What the gate decides, from runs made by hand; what it runs, and what it leaves behind."""

from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import msgspec
import pytest

from tests.bench.runs import change_samples, make_gate_run, make_memory, spread
from tetrabench.bench import gate as subject
from tetrabench.bench.checkouts import Checkout
from tetrabench.bench.gate import (
    choose,
    command_of,
    confirm,
    confirming_output,
    judge,
    make_gate,
    narrow,
    run_gate,
    seat_both,
    spare_base,
    suspects_of,
)
from tetrabench.bench.limits import Limits, limits_of
from tetrabench.bench.messages import ContestantFacts, Described, ScenarioFacts
from tetrabench.bench.plan import EFFORTS, Plan, control_of
from tetrabench.bench.record import Backend, Task
from tetrabench.errors import InputError, NotComparableError
from tetrabench.protocols import Option
from tetrabench.report.verdicts import gate_as, headline, words_of

LIMITS = Limits()
BASE = Checkout(revision="main", commit="a" * 40, folder=Path("base"), requirements=["numba>=0.60", "numpy"])
HEAD = Checkout(
    revision="working tree", commit="b" * 40 + "+", folder=Path("head"), requirements=["numba>=0.60", "numpy"]
)


def gate_of(first, second=None, base=BASE, head=HEAD):
    return make_gate(base, head, LIMITS, first, second)


def only(found):
    (finding,) = found.findings if hasattr(found, "findings") else found
    return finding


SLOW = make_gate_run({"alfa": {"v3y": spread(1.31)}})
SAME = make_gate_run({"alfa": {"v3y": spread()}})


# -- decisions


def test_identical_code_passes():
    found = gate_of(SAME)
    assert (only(found).outcome, only(found).verdict, found.exit_code(strict=True)) == ("passed", "same", 0)
    assert headline(found) == "PASSED: nothing is slower than base by more than is allowed."


def test_a_regression_that_is_confirmed_fails():
    assert only(judge(SLOW, LIMITS)).outcome == "suspect"
    found = gate_of(SLOW, make_gate_run({"alfa": {"v3y": spread(1.29)}}))
    assert found.exit_code() == 1
    assert words_of(only(found)) == "1.31x slower than base, confirmed"
    assert headline(found) == "FAILED: v3y is 1.31x slower than base, confirmed in alfa."


@pytest.mark.parametrize("again", [spread(1.02), spread(1.08), [0.9, 0.95, 1.0, 1.05, 1.1, 1.2, 1.3, 1.4]])
def test_a_regression_that_is_not_confirmed_does_not(again):
    found = gate_of(SLOW, make_gate_run({"alfa": {"v3y": again}}))
    assert only(found).outcome == "inconclusive"
    assert "not confirmed" in only(found).reason
    assert (found.exit_code(), found.exit_code(strict=True)) == (0, 4)


def test_what_was_not_run_again_is_no_failure():
    found = gate_of(msgspec.structs.replace(SLOW, ended="interrupted"))
    assert (only(found).outcome, found.exit_code(strict=True)) == ("suspect", 130)
    assert gate_of(SLOW).exit_code(strict=True) == 4


@pytest.mark.parametrize(
    ("launches", "outcome", "verdict"),
    [
        (spread(1.07), "passed", "slower"),  # too small to matter, all of the interval below the limit
        (spread(1.095), "inconclusive", "slower"),  # below the limit, perhaps
        (spread(0.7), "passed", "faster"),
        ([0.95, 0.97, 0.99, 1.01, 1.03, 1.05, 1.06, 1.07], "passed", "not slower"),
        ([0.8, 0.9, 1.0, 1.1, 1.2, 1.3, 1.4, 1.5], "inconclusive", "inconclusive"),
        # the interval excludes 1 and the median is above the limit, yet three launches in eight hardly differ
        ([1.02, 1.03, 1.04, 1.11, 1.15, 1.18, 1.2, 1.25], "inconclusive", "inconclusive"),
        # one in four is allowed to
        ([1.02, 1.03, 1.12, 1.13, 1.15, 1.18, 1.2, 1.25], "suspect", "slower"),
    ],
)
def test_each_condition_for_a_failure_is_needed(launches, outcome, verdict):
    finding = only(judge(make_gate_run({"alfa": {"v3y": launches}}), LIMITS))
    assert (finding.outcome, finding.verdict) == (outcome, verdict)


def test_launches_that_disagree_are_counted():
    finding = only(judge(make_gate_run({"alfa": {"v3y": [1.02, 1.03, 1.04, 1.11, 1.15, 1.18, 1.2, 1.25]}}), LIMITS))
    assert finding.first.agreeing == 5 / 8
    assert "only 62%" in finding.reason


def test_a_threshold_of_ones_own():
    assert only(judge(SLOW, limits_of(0.5))).outcome == "passed"
    assert only(judge(make_gate_run({"alfa": {"v3y": spread(1.07)}}), limits_of(0.03))).outcome == "suspect"


def test_wall_time_may_vary_more():
    parallel = [Task(name="alfa", scenario="alfa", parallel=True)]
    finding = only(judge(make_gate_run({"alfa": {"v3y": spread(1.125)}}, tasks=parallel), LIMITS))
    assert (finding.clock, finding.limit, finding.outcome) == ("wall", 1.15, "passed")
    assert only(judge(make_gate_run({"alfa": {"v3y": spread(1.125)}}), LIMITS)).outcome == "suspect"


def test_nothing_is_believed_next_to_a_control_that_differs():
    finding = only(judge(make_gate_run({"alfa": {"v3y": spread(1.31), "v3y control": spread(1.2)}}), LIMITS))
    assert finding.outcome == "inconclusive"
    assert "the control, a second copy of v3y@base" in finding.reason


def test_the_control_of_another_contestant_says_nothing():
    run = make_gate_run({"alfa": {"v3y": spread(1.31), "v4": spread(), "v4 control": spread(1.2)}})
    assert [one.outcome for one in judge(run, LIMITS)] == ["suspect", "inconclusive"]


def test_few_launches_and_short_samples_decide_nothing():
    finding = only(judge(make_gate_run({"alfa": {"v3y": spread(2, 5)}}), LIMITS))
    assert (finding.outcome, finding.reason) == ("inconclusive", "5 launches, and an interval needs 6")
    finding = only(judge(make_gate_run({"alfa": {"v3y": spread(2)}}, seconds=0.001), LIMITS))
    assert "too short" in finding.reason
    empty = msgspec.structs.replace(SAME, samples=[])
    assert only(judge(empty, LIMITS)).reason == "no sample was taken"


# -- answers and ends


@pytest.mark.parametrize("status", ["ok", "wrong-result"])  # where two contradict each other, nobody has a majority
def test_another_answer_is_no_timing_verdict(status):
    run = change_samples(SLOW, "alfa", "v3y@head", digest="other", status=status)
    if status != "ok":
        run = change_samples(run, "alfa", "v3y@base", status=status)
    found = gate_of(run)
    assert (only(found).outcome, only(found).verdict) == ("broken", "another answer")
    assert only(found).reason == "head says other, base alfa"
    assert found.exit_code() == 3
    assert not suspects_of(found.findings)
    assert "BROKEN: v3y in alfa (another answer)" in headline(found)


@pytest.mark.parametrize(
    ("status", "verdict"), [("crash", "crashed"), ("timeout", "timed out"), ("oom", "out of memory")]
)
def test_a_head_that_ends_badly_is_3(status, verdict):
    run = change_samples(SLOW, "alfa", "v3y@head", status=status, reason="signal 11", digest="")
    found = gate_of(run)
    assert (only(found).outcome, only(found).verdict, found.exit_code()) == ("broken", verdict, 3)
    assert "signal 11" in only(found).reason


def test_a_base_that_ends_badly_is_not_heads_fault():
    flow = make_gate_run({"alfa": {"v3y": spread(1.31)}, "flow": {"v3y": spread()}})
    run = change_samples(flow, "alfa", "v3y@base", status="crash", reason="signal 11", digest="")
    found = gate_of(run)
    assert [one.outcome for one in found.findings] == ["not compared", "passed"]
    assert found.findings[0].reason == "base crashed: signal 11"
    assert found.exit_code(strict=True) == 0
    alone = change_samples(SLOW, "alfa", "v3y@base", status="crash", reason="signal 11", digest="")
    assert gate_of(alone).exit_code() == 5


def test_what_a_contestant_cannot_do_is_not_compared():
    run = make_gate_run({"alfa": {"v3y": spread()}, "flow": {"v3y": spread()}})
    for backend in ("v3y@base", "v3y@head", "v3y@base control"):
        run = change_samples(run, "alfa", backend, status="unsupported", reason="no neighbours", digest="")
    assert [one.outcome for one in judge(run, LIMITS)] == ["not compared", "passed"]


def test_a_confirming_run_that_crashes_is_broken():
    second = change_samples(SLOW, "alfa", "v3y@head", status="crash", reason="signal 11", digest="")
    assert gate_of(SLOW, second).exit_code() == 3


# -- memory


def test_memory_fails_without_another_run():
    sizes = {"v3y@base": 100_000_000, "v3y@head": 103_000_000}
    found = gate_of(msgspec.structs.replace(SAME, memory=[make_memory(*one) for one in sizes.items()]))
    assert [(one.backend, one.what, one.verdict) for one in found.memory] == [("v3y", "structure", "larger")]
    assert found.exit_code() == 1
    assert "v3y (structure) is larger than base" in headline(found)
    assert "3.0% larger" in gate_as(found, "table")


def test_a_memory_pass_that_ends_badly_is_3_if_it_is_heads():
    bad = [make_memory(name, 0, status="crash", reason="signal 9") for name in ("v3y@base", "v3y@head")]
    assert gate_of(msgspec.structs.replace(SAME, memory=bad)).exit_code() == 3
    assert gate_of(msgspec.structs.replace(SAME, memory=bad[:1])).exit_code() == 0


# -- what is said


def test_the_forms_of_a_verdict():
    run = make_gate_run({"alfa": {"v3y": spread(1.31), "v4": spread()}})
    found = gate_of(run, make_gate_run({"alfa": {"v3y": spread(1.29)}}))
    text = gate_as(found, "table")
    assert "1.31x slower than base, confirmed" in text
    assert "working tree (bbbbbbbbbb+) beside base main (aaaaaaaaaa)" in text
    assert max(map(len, text.splitlines())) <= 100
    assert "::error title=tetrabench gate%3A failed::v3y, alfa, box: 1.31x slower" in gate_as(found, "github")
    assert "<!--" not in gate_as(gate_of(SAME), "github")
    facts = msgspec.json.decode(gate_as(found, "json"))
    assert (facts["schema"], facts["exit_code"], facts["findings"][0]["outcome"]) == ("tetrabench-gate/1", 1, "failed")
    assert facts["findings"][0]["second"]["ratio"] == pytest.approx(1.29)


def test_different_requirements_are_said():
    other = msgspec.structs.replace(HEAD, requirements=["numba>=0.61", "numpy"])
    notes = " ".join(gate_of(SAME, head=other).notes)
    assert "base numba>=0.60; head numba>=0.61" in notes
    assert "requirements" not in " ".join(gate_of(SAME).notes)
    assert "the same commit" in " ".join(gate_of(SAME, head=BASE).notes)


# -- what is run


def make_plan(*contestants: str, launches: int = 12, tasks=("alfa", "flow"), budget_s=None) -> Plan:
    backends = [Backend(name=name, contestant=name, title=name, against="v3y") for name in contestants]
    return Plan(
        family="tetra",
        models={"box": Path("box")},
        tasks=tuple(Task(name=task, scenario=task) for task in tasks),
        backends=(*backends, control_of(backends[0])),
        reference="v3y",
        profile="rigorous",
        effort=msgspec.structs.replace(EFFORTS["rigorous"], launches=launches),
        command="tetrabench run --model box --backend v3y --rigorous",
    )


def offer(contestants=("v3y", "v4"), scenarios=("alfa", "flow")) -> Described:
    return Described(
        reference="v3y",
        thesis_order=[],
        contestants=[ContestantFacts(name=name, title=name) for name in contestants],
        scenarios=[ScenarioFacts(name=name, options={}, thesis={}) for name in scenarios],
    )


def test_head_runs_against_its_base_with_a_control():
    plan = seat_both(make_plan("v3y", "v4"), BASE, HEAD)
    assert [(one.name, one.against, one.checkout, one.control) for one in plan.backends[3:]] == [
        ("v4@base", "v4@base", "base", False),
        ("v4@head", "v4@base", "head", False),
        ("v4@base control", "v4@base", "base", True),
    ]
    assert plan.reference == "v3y@base"
    assert plan.checkouts == {"base": Path("base"), "head": Path("head")}
    with pytest.raises(InputError, match="6 launches are too few: 2 backends need 7"):
        seat_both(make_plan("v3y", "v4", launches=6), BASE, HEAD)


def test_what_base_does_not_have_is_left_out():
    plan, notes = choose(make_plan("v3y", "v4"), offer(contestants=["v3y"], scenarios=["flow"]))
    assert [one.name for one in plan.backends] == ["v3y", "v3y control"]
    assert [one.name for one in plan.tasks] == ["flow"]
    assert notes == ["Not compared, since base does not have it: v4, alfa."]
    assert choose(make_plan("v3y"), offer())[1] == []
    with pytest.raises(NotComparableError, match="base does not have v3y"):
        choose(make_plan("v3y"), offer(contestants=["v5"]))


def sweep_plan():
    """Of a contestant with two capacities."""
    plan = make_plan("v3y", "v4")
    swept = [
        msgspec.structs.replace(plan.backends[1], name=f"v4 capacity={k}", options={"capacity": k, "recycle": 1})
        for k in (8, 16)
    ]
    return replace(plan, backends=(plan.backends[0], *swept))


def test_backends_of_one_contestant_are_told_apart():
    plan = seat_both(sweep_plan(), BASE, HEAD)
    assert [one.name for one in plan.backends if one.contestant == "v4" and not one.control] == [
        *("v4 capacity=8@base", "v4 capacity=8@head", "v4 capacity=16@base", "v4 capacity=16@head"),
    ]
    run = make_gate_run({"alfa": {"v3y": spread(), "v4": spread(1.31), "v5": spread()}})
    names = {"v4@": "v4 capacity=8@", "v5@": "v4 capacity=16@"}

    def renamed(text):
        return next((text.replace(old, new) for old, new in names.items() if old in text), text)

    run = msgspec.structs.replace(
        run,
        backends=list(plan.backends),
        samples=[msgspec.structs.replace(one, backend=renamed(one.backend)) for one in run.samples],
        memory=[make_memory(f"v4 capacity={k}@{side}", size) for k in (8, 16) for side, size in SIZES[k].items()],
    )
    found = judge(run, LIMITS)
    assert [(one.contestant, one.outcome) for one in found] == [
        ("v3y", "passed"),
        ("v4 capacity=8", "suspect"),
        ("v4 capacity=16", "passed"),
    ]
    again = narrow(plan, suspects_of(found))
    assert [one.name for one in again.backends] == [
        *("v4 capacity=8@base", "v4 capacity=8@head", "v4 capacity=8@base control"),
    ]
    memory = make_gate(BASE, HEAD, LIMITS, run, run).memory
    assert [(one.backend, one.verdict) for one in memory] == [("v4 capacity=8", "same"), ("v4 capacity=16", "larger")]


SIZES = {8: {"base": 10**8, "head": 10**8}, 16: {"base": 10**8, "head": 2 * 10**8}}


def test_base_is_told_of_no_options_that_it_does_not_know():
    known = offer()
    known.contestants[1] = msgspec.structs.replace(
        known.contestants[1], options={"capacity": Option(8, 1, 63, "how many")}
    )
    plan = seat_both(sweep_plan(), BASE, HEAD)
    spared, notes = spare_base(plan, known)
    assert notes == ["Base does not know, and ran without: v4.recycle."]
    assert {one.name: one.options for one in spared.backends if one.contestant == "v4"} == {
        f"v4 capacity={k}@{side}": {"capacity": k} | ({"recycle": 1} if side == "head" else {})
        for k in (8, 16)
        for side in ("base", "head", "base control")
    }
    assert spare_base(seat_both(make_plan("v3y"), BASE, HEAD), offer())[1] == []


def test_an_expected_wrong_answer_is_not_compared_and_not_broken():
    run = make_gate_run({"alfa": {"v3y": spread(), "v4": spread(1.31)}})
    wrong = {"digest": "bad0", "status": "wrong-result", "reason": "because"}
    for name in ("v4@base", "v4@head", "v4@base control"):
        run = change_samples(run, "alfa", name, **wrong)
    assert [one.outcome for one in judge(run, LIMITS)] == ["passed", "broken"]
    known = [msgspec.structs.replace(one, exact=one.contestant != "v4") for one in run.backends]
    run = msgspec.structs.replace(run, backends=known)
    assert [one.outcome for one in judge(run, LIMITS)] == ["passed", "not compared"]
    assert gate_of(run).exit_code(strict=True) == 0


def test_only_cells_in_question_run_again():
    plan = seat_both(make_plan("v3y", "v4"), BASE, HEAD)
    run = make_gate_run({"alfa": {"v3y": spread(), "v4": spread(1.31)}, "flow": {"v3y": spread(), "v4": spread()}})
    again = narrow(plan, suspects_of(judge(run, LIMITS)))
    assert [one.name for one in again.tasks] == ["alfa"]
    assert [one.name for one in again.backends] == ["v4@base", "v4@head", "v4@base control"]
    assert again.reference == "v4@base"
    assert again.seed != plan.seed
    assert not again.has_memory


def test_a_cell_that_only_came_along_stays_as_it_was():
    first = make_gate_run(
        {"alfa": {"v3y": spread(), "v4": spread(1.31)}, "flow": {"v3y": spread(1.31), "v4": spread()}}
    )
    second = make_gate_run({task: {"v3y": spread(1.31), "v4": spread(1.31)} for task in ("alfa", "flow")})
    outcomes = [one.outcome for one in confirm(judge(first, LIMITS), judge(second, LIMITS))]
    assert outcomes == ["passed", "failed", "failed", "passed"]


def test_the_command_repeats_the_gate():
    plan = make_plan("v3y")
    assert command_of(plan, "main", None) == "tetrabench gate --base main --model box --backend v3y"
    assert "--head 'a b'" in command_of(plan, "main", "a b")
    assert confirming_output(Path("out/gate.json")) == Path("out/gate-confirming.json")


class Ran:
    """What a gate did, where installing and running are played."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, *results: object) -> None:
        self.plans, self.outputs, self.scratch = [], [], None
        self.results = list(results)
        monkeypatch.setattr(subject, "find_repository", lambda folder: folder)
        monkeypatch.setattr(subject, "find_commit", lambda *_: "")
        monkeypatch.setattr(subject, "check_out", self.check_out)
        monkeypatch.setattr(subject, "guide_of", self.guide_of)
        monkeypatch.setattr(subject, "run_benchmark", self.run)

    def check_out(self, repository, revision, scratch):
        self.scratch = scratch
        (scratch / "something").write_text("")
        return HEAD if revision is None else BASE

    @contextmanager
    def guide_of(self, checkout):
        yield self

    def describe(self, family):
        return offer()

    def run(self, plan, *, progress, output):
        self.plans.append(plan)
        self.outputs.append(output)
        result = self.results.pop(0)
        if isinstance(result, BaseException):
            raise result
        return result

    def gate(self, **more):
        return run_gate(Path(), "main", None, lambda guide: make_plan("v3y"), LIMITS, **more)


def test_a_gate_from_beginning_to_end(monkeypatch):
    ran = Ran(monkeypatch, SLOW, SLOW)
    assert ran.gate(output=Path("gate.json")).exit_code() == 1
    assert [len(plan.tasks) for plan in ran.plans] == [2, 1]
    assert ran.outputs == [Path("gate.json"), Path("gate-confirming.json")]
    assert not ran.scratch.exists()
    ran = Ran(monkeypatch, SAME)
    assert ran.gate().exit_code() == 0
    assert len(ran.plans) == 1


@pytest.mark.parametrize("end", [KeyboardInterrupt(), InputError("no model")])
def test_nothing_is_left_behind_whatever_happens(monkeypatch, end):
    ran = Ran(monkeypatch, end)
    with pytest.raises(type(end)):
        ran.gate()
    assert not ran.scratch.exists()


def test_an_interrupted_run_is_not_confirmed(monkeypatch):
    ran = Ran(monkeypatch, msgspec.structs.replace(SLOW, ended="interrupted"))
    found = ran.gate()
    assert (len(ran.plans), found.exit_code()) == (1, 130)


def test_a_base_that_cannot_say_what_it_has_is_5(monkeypatch):
    ran = Ran(monkeypatch, SAME)
    monkeypatch.setattr(ran, "describe", lambda family: (_ for _ in ()).throw(InputError("no family 'tetra'")))
    with pytest.raises(NotComparableError, match=r"base main .* cannot be used: no family"):
        ran.gate()
