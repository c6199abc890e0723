"""Usual mixes: whoever reads them needs no scenario, and every name in them is one."""

import subprocess
import sys

import pytest

from tetrabench import registry
from tetrabench.report.advice.mix import LEAST, MOST
from tetrabench.scenarios.workloads import COLLISION, POLYGON, TETRA


def test_they_are_found_by_their_family():
    assert registry.workloads("tetra") == {one.name: one for one in TETRA}
    assert list(registry.workloads("tetra")) == ["simulation", "refinement", "static", "queries"]


@pytest.mark.parametrize(
    ("family", "workload"),
    [("tetra", one) for one in TETRA]
    + [("polygon", one) for one in POLYGON]
    + [("collision", one) for one in COLLISION],
    ids=lambda one: getattr(one, "name", one),
)
def test_every_name_is_a_scenario_or_a_count_of_one(family, workload):
    known = {one.name: one for one in registry.scenarios(family)}
    for name, number in workload.mix.items():
        assert LEAST <= number <= MOST
        if name not in known:
            scenario, _, count = name.rpartition(".")
            assert count in known[scenario].options
    assert workload.title
    assert "\n" not in workload.title


def test_reading_them_compiles_nothing():
    code = (
        "import sys; from tetrabench import registry; assert registry.workloads('tetra');"
        "heavy = {'numba', 'tetrabench.scenarios.tetra', 'tetrabench.backends'} & set(sys.modules);"
        "assert not heavy, heavy"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
