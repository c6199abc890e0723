"""The workloads as pytest-benchmark's users write them: a test a scenario. CONTESTANT in the environment says whose."""

import os
from typing import Any

import pytest

from tests.measuring.injected import NAMES, REFERENCE
from tests.measuring.workload import workload

ROUNDS = 33
"""Of explode, which needs a fresh net each time: about a second, as long as the tool spends on the others."""


@pytest.mark.parametrize("name", NAMES)
def test_workload(benchmark: Any, name: str) -> None:
    made = workload(name, os.environ.get("CONTESTANT", REFERENCE))
    if name == "explode":
        benchmark.pedantic(made.run, setup=lambda: ((made.prepare(),), {}), rounds=ROUNDS)
    else:
        benchmark(made.run, made.prepare())
