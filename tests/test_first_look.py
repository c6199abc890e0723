"""`tetrabench run` of which nothing is named: a first look at each family."""

import shlex

import pytest

from tests.test_cli import say
from tetrabench import registry

FAMILIES = ("tetra", "polygon", "collision")


@pytest.mark.parametrize("family", FAMILIES)
def test_a_first_look_says_what_it_leaves_out_and_how_to_repeat_it(family: str) -> None:
    whose = [] if family == "tetra" else ["--family", family]
    result = say("run", *whose, "--dry-run")
    assert result.exit_code == 0
    tour = registry.family(family).tour
    assert tour is not None
    told = dict(line.split(maxsplit=1) for line in result.stdout.splitlines())
    assert told["tasks"] == ", ".join(tour.scenarios)
    assert told["backends"].startswith(", ".join(tour.backends))
    backends = sum(one.is_exact for one in registry.contestants(family))
    assert f"a first look: {len(tour.backends)} of {backends} backends in {len(tour.scenarios)} of " in result.stderr
    assert result.stderr.endswith(f"tetrabench run {' '.join([*whose, '--model'])} {tour.file}\n")
    again = say(*shlex.split(told["command"])[1:], "--dry-run")
    assert (again.exit_code, again.stdout, again.stderr) == (0, result.stdout, "")


def test_no_first_look_leaves_the_reference_out() -> None:
    for family in map(registry.family, FAMILIES):
        assert family.tour is not None
        assert family.reference == family.tour.backends[0]
        assert family.tour.model in family.models
