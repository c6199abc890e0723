"""What a run would need: beside what committed runs took."""

from pathlib import Path

import numpy as np
import pytest

from tetrabench import registry
from tetrabench.bench import read_results
from tetrabench.bench.needs import forecast
from tetrabench.bench.plan import EFFORTS
from tetrabench.io import read_mesh
from tetrabench.mesh.models import SMALL_NOZZLE, generate
from tetrabench.protocols import Needs

RESULTS = Path(__file__).parents[2] / "results"


def test_the_estimate_of_a_run_is_what_the_committed_one_took() -> None:
    results = read_results(RESULTS / "nozzle-120k-quick.json")
    tets = results.models[0].size["tetras"]
    mesh = read_mesh(SMALL_NOZZLE)
    mesh.tets = np.resize(mesh.tets, (tets, 4))  # as many: nothing else of a mesh counts
    needs = registry.family("tetra").needs(mesh)
    assert needs is not None
    told = forecast("tetra", needs)
    assert told.quick_s == pytest.approx(results.elapsed_s, rel=0.15)
    assert told.net_bytes == pytest.approx(max(one.peak_bytes or 0 for one in results.memory), rel=0.2)


def test_a_run_of_all_and_the_smallest_group() -> None:
    told = forecast("tetra", Needs(peak_bytes=1e9, launch_s=10.0))
    backends = sum(one.is_exact for one in registry.contestants("tetra")) + 1
    assert told.run_bytes == backends * (300e6 + 2.5e9)
    assert told.least_bytes == 3 * (300e6 + 2.5e9)
    assert told.quick_s == 10.0 * EFFORTS["quick"].launches
    assert told.run_s is not None
    assert told.run_s >= 10.0 * EFFORTS["default"].launches
    unknown = forecast("collision", Needs(peak_bytes=1e6))
    assert (unknown.quick_s, unknown.run_s) == (None, None)


def test_needs_grow_with_the_model() -> None:
    family = registry.family("tetra")
    small, large = (family.needs(generate("box", tets)) for tets in (48, 480))
    assert small is not None
    assert large is not None
    assert 5 < large.peak_bytes / small.peak_bytes < 15
