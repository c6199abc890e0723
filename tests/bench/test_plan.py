"""What a plan says: turns in balance, effort, references, the command that repeats it."""

from collections import Counter
from itertools import pairwise
from pathlib import Path

import pytest

from tetrabench.bench import Backend, Effort, Plan, Task, make_plan
from tetrabench.bench.plan import williams_row
from tetrabench.errors import InputError


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


def scripted_plan(rounds=14, seed=0, chained=False):
    return Plan(
        family="scripted",
        model="tiny",
        path=Path("tiny"),
        tasks=(Task("first", {}), Task("second", {})),
        backends=tuple(Backend(name=f"v{k}", title="") for k in range(7)),
        reference="v0",
        effort=Effort(rounds, 3),
        seed=seed,
        chained=chained,
    )


def test_the_order_of_turns_is_balanced_and_drawn_from_the_seed():
    plan = scripted_plan()
    orders = list(plan.orders(plan.tasks[0]))
    assert all(set(Counter(column).values()) == {2} for column in zip(*orders, strict=True))
    assert orders == list(plan.orders(plan.tasks[0]))
    assert orders != list(plan.orders(plan.tasks[1]))
    assert orders != list(scripted_plan(seed=1).orders(plan.tasks[0]))


@pytest.mark.usefixtures("plugin")
class TestMakePlan:
    def test_defaults(self):
        plan = make_plan("tiny", family="scripted")
        assert plan.effort == Effort(5, 3)
        assert plan.reference == "steady"
        assert [task.scenario for task in plan.tasks] == ["first", "second", "third"]
        assert plan.tasks[0].options == {"count": 2}
        assert plan.command == "tetrabench run --model tiny --family scripted"

    def test_quick_thesis_and_rounds(self):
        assert make_plan("tiny", family="scripted", quick=True).effort == Effort(3, 1)
        assert make_plan("tiny", family="scripted", rounds=2).effort == Effort(2, 2)
        thesis = make_plan("tiny", family="scripted", thesis=True, scenarios=["second", "third"])
        assert thesis.chained
        assert thesis.effort.rounds == 1
        assert [task.scenario for task in thesis.tasks] == ["third", "second"]
        assert thesis.tasks[0].options == {"count": 20}
        with pytest.raises(InputError, match="one round"):
            make_plan("tiny", family="scripted", thesis=True, rounds=2)
        with pytest.raises(InputError, match="at least one"):
            make_plan("tiny", family="scripted", rounds=0)

    def test_the_first_backend_is_the_reference_where_the_familys_is_not_there(self):
        assert make_plan("tiny", family="scripted", backends=["third", "other"]).reference == "third"
        assert make_plan("tiny", family="scripted", backends=["third", "steady"]).reference == "steady"
        with pytest.raises(InputError, match="'steady' is not among"):
            make_plan("tiny", family="scripted", backends=["third"], reference="steady")

    def test_the_command_repeats_the_run_and_names_no_folder(self):
        plan = make_plan("/home/somebody/my file", family="scripted", backends=["third", "other"], quick=True, seed=7)
        assert plan.model == "my file"
        assert plan.command == (
            "tetrabench run --model 'my file' --family scripted --backend third,other"
            " --reference third --quick --seed 7"
        )
