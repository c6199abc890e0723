"""What a plan says: turns in balance, effort, references, tasks, sweeps, the command that repeats it."""

import shlex
from collections import Counter
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import pytest
from click.testing import CliRunner

from tests.bench.scripted import scripted_plan
from tetrabench import registry
from tetrabench.bench import EFFORTS, Backend, Effort, Task, make_plan
from tetrabench.bench.plan import (
    DEFAULT_SIZE,
    TOUR_LAUNCHES,
    combinations,
    control_of,
    model_of,
    parse_option,
    williams_row,
)
from tetrabench.bench.statistics import fewest_launches
from tetrabench.cli import main
from tetrabench.errors import InputError
from tetrabench.protocols import Tour


@pytest.mark.parametrize("count", range(1, 10))
def test_each_name_comes_once_in_each_place(count):
    names = [f"v{k}" for k in range(count)]
    rows = [williams_row(names, row) for row in range(count)]
    assert all(sorted(row) == names for row in rows)
    assert all(sorted(column) == names for column in zip(*rows, strict=True))


@pytest.mark.parametrize("count", [2, 4, 6, 8])
def test_an_even_number_of_names_follow_each_other_equally_often(count):
    names = [f"v{k}" for k in range(count)]
    rows = [williams_row(names, row) for row in range(count)]
    pairs = Counter(pair for row in rows for pair in pairwise(row))
    assert set(pairs.values()) <= {1}
    assert len(pairs) == count * (count - 1)


def test_the_order_of_turns_is_balanced_over_launches_and_drawn_from_the_seed():
    def orders(task=0, model="tiny", **more):
        plan = scripted_plan(launches=7, rounds=2, **more)
        names = [f"v{k}" for k in range(7)]
        return [order for launch in range(7) for order in plan.orders(model, plan.tasks[task], launch, names)]

    assert len(orders()) == 14
    assert all(set(Counter(column).values()) == {2} for column in zip(*orders(), strict=True))
    assert orders() == orders()
    assert orders() != orders(task=1)
    assert orders() != orders(model="large")
    assert orders() != orders(seed=1)


def test_a_group_of_one_and_of_nobody():
    plan = scripted_plan(rounds=2)
    assert list(plan.orders("tiny", plan.tasks[0], 0, ["v0"])) == [["v0"]] * 2
    assert list(plan.orders("tiny", plan.tasks[0], 0, [])) == [[]] * 2


@pytest.mark.parametrize(
    ("text", "option"),
    [
        ("sweeps=10", ("sweeps", [10])),
        ("alfa.sweeps=10,50", ("alfa.sweeps", [10, 50])),
        ("sweeps= 1..4", ("sweeps", [1, 2, 3, 4])),
        ("sweeps=3,1..3", ("sweeps", [3, 1, 2])),
    ],
)
def test_options_of_scenarios(text, option):
    assert parse_option(text) == option


def test_a_range_goes_up():
    with pytest.raises(InputError, match=r"option 'a=3\.\.1': nothing goes from 3 up to 1; did you mean 1\.\.3\?$"):
        parse_option("a=3..1")


@pytest.mark.parametrize("text", ["sweeps", "sweeps=", "=3", "sweeps=a", "sweeps=1.5", "sweeps=-1", "sweeps=1,,2"])
def test_options_that_are_none(text):
    with pytest.raises(InputError, match=r"option '.*': write NAME=1,2,3 or NAME=1\.\.3"):
        parse_option(text)


def test_combinations_are_named_by_what_is_swept():
    own = {"a": 1, "b": 2, "c": 3}

    def asked(options, owner="x"):
        return list(combinations(owner, own, options))

    assert asked({}) == [("x", own)]
    assert asked({"y.a": [5, 6], "d": [1]}) == [("x", own)]
    assert asked({"c": [7]}) == [("x", own | {"c": 7})]
    assert asked({"c": [7, 8], "x.a": [4, 5], "b": [0]}) == [
        (f"x a={a} c={c}", {"a": a, "b": 0, "c": c}) for a in (4, 5) for c in (7, 8)
    ]
    assert asked({"x.a": [4, 5], "a": [6]}) == asked({"a": [6]}) == [("x", own | {"a": 6})]  # what is said last
    assert asked({"a": [6], "x.a": [4]}) == [("x", own | {"a": 4})]


def test_the_digest_of_a_model_is_that_of_its_file(tmp_path: Path):
    (tmp_path / "a").write_bytes(b"abc" * 10**6)
    (tmp_path / "b").write_bytes(b"abc" * 10**6)
    (tmp_path / "c").write_bytes(b"abc" * 10**6 + b"d")
    a, b, c = (model_of("m", tmp_path / name).digest for name in "abc")
    assert a == b != c


def plan_of(**asked):
    return make_plan(asked.pop("model", "tiny"), family="scripted", **asked)


FEW = ["steady", "other", "third"]


@pytest.mark.usefixtures("plugin")
class TestMakePlan:
    def test_defaults(self):
        plan = plan_of()
        assert plan.reference == "steady"
        assert [task.scenario for task in plan.tasks] == ["first", "second", "third", "many"]
        assert [task.parallel for task in plan.tasks] == [False, False, False, True]
        assert plan.tasks[0].options == {"count": 2}
        assert plan.backends[-1] == control_of(plan.backends[0])
        assert [backend.against for backend in plan.backends] == ["steady"] * len(plan.backends)
        assert plan.has_memory
        assert plan.has_yardsticks
        assert plan.command == "tetrabench run --model tiny --family scripted"

    def test_the_default_has_launches_enough_for_an_interval_whoever_takes_part(self):
        assert plan_of(backends=FEW).effort == EFFORTS["default"]
        assert plan_of().effort.launches == 11 > EFFORTS["default"].launches
        assert plan_of(profile="rigorous").effort.launches == 12
        assert plan_of(launches=2).effort.launches == 2

    def test_profiles(self):
        quick = plan_of(profile="quick")
        assert quick.effort == Effort(launches=3, rounds=3, hopeless_rounds=1)
        assert plan_of(profile="quick", launches=4, rounds=2).effort == Effort(launches=4, rounds=2, hopeless_rounds=1)
        thesis = plan_of(profile="thesis", scenarios=["second", "third"])
        assert thesis.chained
        assert (thesis.effort.launches, thesis.effort.rounds) == (1, 1)
        assert [task.scenario for task in thesis.tasks] == ["third", "second"]
        assert thesis.tasks[0].options == {"count": 20}
        check = plan_of(profile="check")
        assert not check.has_memory
        assert not check.has_yardsticks
        for plan in (thesis, check):
            assert not [backend for backend in plan.backends if backend.control]
        with pytest.raises(InputError, match="not in the thesis: many"):
            plan_of(profile="thesis", scenarios=["many"])

    @pytest.mark.parametrize("what", ["launches", "rounds"])
    def test_effort_that_makes_no_sense(self, what):
        with pytest.raises(InputError, match=f"{what}: the thesis profile has one"):
            plan_of(profile="thesis", **{what: 2})
        with pytest.raises(InputError, match=f"{what}: 0; at least one is needed"):
            plan_of(**{what: 0})

    def test_the_first_backend_is_the_reference_where_the_familys_is_not_there(self):
        assert plan_of(backends=["third", "other"]).reference == "third"
        assert plan_of(backends=["third", "steady"]).reference == "steady"
        plan = plan_of(backends=["third", "steady"], reference="third")
        assert [(one.name, one.against, one.contestant) for one in plan.backends] == [
            ("third", "third", "third"),
            ("steady", "third", "steady"),
            ("third control", "third", "third"),
        ]
        with pytest.raises(InputError, match="'steady' is not among the backends: third"):
            plan_of(backends=["third"], reference="steady")
        with pytest.raises(InputError, match="no scenario to run"):
            plan_of(scenarios=[])

    def test_a_backend_named_twice_takes_part_once(self):
        assert [one.name for one in plan_of(backends=["steady", "steady"]).backends] == ["steady", "steady control"]

    def test_sweeps_over_sizes(self):
        plan = plan_of(tets=[100, 300, 100])
        assert {name: path.name for name, path in plan.models.items()} == {
            "tiny-100": "model-100",
            "tiny-300": "model-300",
        }
        assert {name: path.name for name, path in plan_of(tets=[100]).models.items()} == {"tiny": "model-100"}

    def test_without_a_model_it_is_the_familys_and_a_small_one(self):
        plan = make_plan(family="scripted")
        assert {name: path.name for name, path in plan.models.items()} == {"tiny": f"model-{DEFAULT_SIZE}"}
        assert plan.command == f"tetrabench run --model tiny --family scripted --tets {DEFAULT_SIZE}"
        assert [path.name for path in make_plan(family="scripted", tets=[7]).models.values()] == ["model-7"]

    def test_where_nothing_is_named_it_is_the_tour_of_the_family(self, monkeypatch):
        tour = Tour("tiny", 5, ("other", "third"), ("second",), "part.txt")
        monkeypatch.setattr(type(registry.family("scripted")), "tour", tour)
        plan = make_plan(family="scripted")
        assert (list(plan.models), [one.name for one in plan.backends]) == (
            ["tiny"],
            ["other", "third", "other control"],
        )
        assert [task.name for task in plan.tasks] == ["second"]
        assert (plan.profile, plan.effort.launches) == ("quick", TOUR_LAUNCHES)
        exact = sum(one.is_exact for one in registry.contestants("scripted"))
        assert plan.left_out == (
            f"a first look: 2 of {exact} backends in 1 of 4 scenarios, on a small model; all of them on one of yours: "
            "tetrabench run --family scripted --model part.txt"
        )
        # The command repeats the run, by names alone.
        words = shlex.split(plan.command)
        asked = {word.removeprefix("--"): words[n + 1] for n, word in enumerate(words[:-1]) if word.startswith("--")}
        again = make_plan(
            asked["model"],
            family=asked["family"],
            backends=asked["backend"].split(","),
            scenarios=asked["scenario"].split(","),
            profile="quick" if "--quick" in words else "default",
            launches=int(asked["launches"]),
            tets=[int(asked["tets"])],
        )
        assert replace(again, left_out=plan.left_out, command=plan.command) == plan
        assert (again.left_out, shlex.split(again.command)) == ("", words)
        assert make_plan(family="scripted", launches=5).effort.launches == 5

    @pytest.mark.parametrize(
        "named",
        [
            {"model": "tiny"},
            {"backends": ["steady"]},
            {"scenarios": ["first"]},
            {"tets": [7]},
            {"options": {"count": [3]}},
            {"reference": "steady"},
            {"numberings": ["hilbert"]},
            {"profile": "check"},
            {"profile": "rigorous"},
            {"profile": "thesis"},
        ],
    )
    def test_whoever_names_something_gets_all_the_rest(self, monkeypatch, named):
        monkeypatch.setattr(
            type(registry.family("scripted")), "tour", Tour("tiny", 5, ("other",), ("second",), "part.txt")
        )
        plan = make_plan(family="scripted", **named)
        assert plan.left_out == ""
        assert len(plan.tasks) > 1 or len(plan.backends) > 2

    def test_sweeps_over_numberings(self):
        plan = plan_of(numberings=["natural", "shuffled", "natural"])
        assert list(plan.models) == ["tiny", "tiny shuffled"]
        assert plan.command.endswith(" --numbering natural,shuffled")
        assert "numbering" not in plan_of().command
        with pytest.raises(InputError, match="several sizes and several numberings: sweep over one"):
            plan_of(numberings=["natural", "shuffled"], tets=[100, 300])
        with pytest.raises(InputError, match="compared with the natural one: add it"):
            plan_of(numberings=["hilbert", "shuffled"])
        assert list(plan_of(numberings=["hilbert"]).models) == ["tiny hilbert"]

    def test_sweeps_over_options(self):
        plan = plan_of(scenarios=["first", "second"], options={"first.count": [3, 5], "count": [7]})
        assert [(task.name, task.options) for task in plan.tasks] == [
            ("first", {"count": 7}),  # what is said last
            ("second", {"count": 7}),
        ]
        plan = plan_of(scenarios=["first", "second"], options={"first.count": [3, 5]})
        assert plan.tasks == (
            Task(name="first count=3", scenario="first", options={"count": 3}),
            Task(name="first count=5", scenario="first", options={"count": 5}),
            Task(name="second", scenario="second", options={"count": 2}),
        )
        with pytest.raises(
            InputError, match=r"no option 'third\.count'; did .* there are: first\.count, second\.count$"
        ):
            plan_of(backends=FEW, scenarios=["first", "second"], options={"third.count": [3]})
        with pytest.raises(InputError, match="first: counts are 1 at least"):
            plan_of(options={"count": [0]})

    def test_sweeps_over_options_of_contestants(self):
        plan = plan_of(
            backends=["steady", "tuned"],
            scenarios=["first"],
            options={"recycle": [1, 0], "tuned.capacity": [8, 16]},
            reference="tuned",
        )
        tuned = [one for one in plan.backends if one.contestant == "tuned" and not one.control]
        assert [(one.name, one.options) for one in tuned] == [
            ("tuned capacity=8 recycle=1", {"capacity": 8, "recycle": 1}),
            ("tuned capacity=8 recycle=0", {"capacity": 8, "recycle": 0}),
            ("tuned capacity=16 recycle=1", {"capacity": 16, "recycle": 1}),
            ("tuned capacity=16 recycle=0", {"capacity": 16, "recycle": 0}),
        ]
        assert plan.backends[0].options == {}
        assert plan.reference == "tuned capacity=8 recycle=1"
        assert {one.against for one in plan.backends} == {plan.reference}
        assert plan.backends[-1] == control_of(tuned[0])
        assert plan.backends[-1].options == {"capacity": 8, "recycle": 1}
        assert [task.name for task in plan.tasks] == ["first"]
        assert plan.command.endswith(" --reference tuned --option recycle=1,0 --option tuned.capacity=8,16")

    def test_one_value_changes_no_name(self):
        plan = plan_of(backends=["tuned", "steady"], options={"capacity": [63], "recycle": [0]})
        assert [(one.name, one.options) for one in plan.backends] == [
            ("tuned", {"capacity": 63, "recycle": 0}),
            ("steady", {}),
            ("steady control", {}),
        ]
        assert plan_of(backends=["tuned"]).backends[0].options == {"capacity": 8, "recycle": 1}

    def test_each_backend_of_a_sweep_may_be_the_reference(self):
        asked = {"backends": ["tuned", "steady"], "options": {"capacity": list(range(1, 64))}}
        plan = plan_of(**asked, reference="tuned capacity=9")
        assert plan.backends[-1].name == "tuned capacity=9 control"
        assert plan.backends[-1].options == {"capacity": 9, "recycle": 1}
        assert "--reference 'tuned capacity=9'" in plan.command
        usual = plan_of(
            **asked, reference="tuned"
        )  # the one that stands for all is as it is where nobody says otherwise
        assert usual.reference == "tuned capacity=8"
        assert "--reference tuned " in usual.command
        assert plan_of(backends=["tuned"], options={"capacity": [3, 9]}).reference == "tuned capacity=3"
        assert plan_of(**asked).reference == "steady"
        assert len(plan.backends) == 65
        assert plan.effort.launches == fewest_launches(63)  # the intervals of all of them hold together
        with pytest.raises(
            InputError, match="'tuned capacity=64' is not among the backends: tuned capacity=1, tuned ca"
        ):
            plan_of(**asked, reference="tuned capacity=64")

    @pytest.mark.parametrize(
        ("options", "reason"),
        [
            ({"capacity": [8, 64]}, r"tuned: capacity=64 cannot be; it takes 1 to 63: letters that a leaf holds$"),
            ({"tuned.capacity": [0]}, r"tuned: capacity=0 cannot be; it takes 1 to 63"),
            ({"tuned.recycle": [2]}, r"tuned: recycle=2 cannot be; it takes 0 to 1"),
            (
                {"tuned.capasity": [8]},
                r"no option 'tuned.capasity'; did you mean 'tuned.capacity'\? "
                r"there are: tuned.capacity, tuned.recycle, first.count$",
            ),
            ({"steady.capacity": [8]}, r"no option 'steady.capacity'; .* there are: tuned.capacity, "),
            ({"speed": [8]}, r"no option 'speed'; there are: tuned.capacity, "),
        ],
    )
    def test_options_that_cannot_be_chosen(self, options, reason):
        with pytest.raises(InputError, match=reason):
            plan_of(backends=["steady", "tuned"], scenarios=["first"], options=options)

    def test_who_is_known_to_be_wrong_takes_part_where_named_and_is_no_reference(self):
        plan = plan_of()
        assert "careless" not in [one.name for one in plan.backends]
        assert all(one.exact for one in plan.backends)
        plan = plan_of(backends=["careless", "third"])
        assert [(one.name, one.exact) for one in plan.backends] == [
            ("careless", False),
            ("third", True),
            ("third control", True),
        ]
        assert plan.reference == "third"
        for asked in ({"backends": ["careless"]}, {"backends": ["careless", "third"], "reference": "careless"}):
            with pytest.raises(InputError, match="careless is known to give wrong answers, and is no reference: add"):
                plan_of(**asked)

    @pytest.mark.parametrize(
        "words",
        [
            "--backend tuned,steady --reference 'tuned capacity=3' --option tuned.capacity=1..5 --option count=2,4",
            "--backend tuned,careless --option recycle=0 --quick",
            "--backend steady,tuned --option recycle=0,1 --reference tuned --launches 2",
        ],
    )
    def test_the_command_asks_for_the_same_plan(self, words):
        def plan(text):
            said = CliRunner().invoke(main, [*shlex.split(text)[1:], "--dry-run"])
            assert said.exit_code == 0, said.output
            return said.stdout

        first = plan(f"tetrabench run --model tiny --family scripted {words}")
        assert plan(first.splitlines()[-1].removeprefix("command").strip()) == first

    def test_the_command_repeats_the_run_and_names_no_folder(self):
        plan = plan_of(model="/home/somebody/my file", backends=["third", "other"], profile="quick", seed=7)
        assert list(plan.models) == ["my file"]
        assert plan.command == (
            "tetrabench run --model 'my file' --family scripted --backend third,other"
            " --reference third --quick --seed 7"
        )
        plan = plan_of(
            tets=[10, 20], options={"count": [1, 2], "first.count": [3]}, launches=2, budget_s=600.0, timeout_s=1.5
        )
        assert plan.command == (
            "tetrabench run --model tiny --family scripted --launches 2 --tets 10,20"
            " --option count=1,2 --option first.count=3 --budget 600 --timeout 1.5"
        )
        assert (plan.budget_s, plan.timeout_s) == (600.0, 1.5)


def test_a_control_is_a_second_copy():
    backend = Backend(name="v3y", contestant="v3y", title="t", against="v3y", extension=True)
    control = control_of(backend)
    assert (control.name, control.against, control.control) == ("v3y control", "v3y", True)
    assert (control.contestant, control.title) == ("v3y", "t")
