"""What all tests share: seeds, effort of the property tests, meshes by property, the contestants."""

import os
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import HealthCheck, settings

from tests.meshes import MESHES

_COMMON = {"deadline": None, "suppress_health_check": list(HealthCheck), "print_blob": True}
settings.register_profile("fast", max_examples=12, stateful_step_count=25, **_COMMON)
settings.register_profile("thorough", max_examples=200, stateful_step_count=50, **_COMMON)
settings.register_profile("slow-motion", max_examples=3, stateful_step_count=12, **_COMMON)  # the JIT is off
settings.load_profile(os.environ.get("TETRABENCH_TESTS", "fast"))


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--seed", type=int, default=20110501, help="seed of all random test data")


@pytest.fixture
def rng(request: pytest.FixtureRequest) -> np.random.Generator:
    """Random numbers; the same in every run with the same --seed."""
    return np.random.default_rng(request.config.getoption("--seed"))


@pytest.fixture(autouse=True)
def patient(monkeypatch: pytest.MonkeyPatch) -> None:
    """However long the machine takes over something, the verbs say nothing of it in this process."""
    monkeypatch.setattr("tetrabench.cli.speech.PATIENCE", 3600.0)


@pytest.fixture(params=sorted(MESHES))
def small_mesh(request: pytest.FixtureRequest) -> object:
    """Each of the small named meshes in turn."""
    factory: Callable[[], object] = MESHES[request.param]
    return factory()
