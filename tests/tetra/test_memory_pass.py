"""What a net says that it keeps in memory is what the system sees that its process holds."""

from pathlib import Path

import numba
import pytest

from tetrabench import registry
from tetrabench.bench.memory import WEIGHING, private_bytes
from tetrabench.bench.memory_pass import weigh
from tetrabench.bench.record import Backend
from tetrabench.bench.spawn import WorkerProcess
from tetrabench.io import write_mesh
from tetrabench.mesh.models import generate

NODE_BYTES = {"v4": 8}  # that the allocator adds to each

pytestmark = [
    pytest.mark.skipif(private_bytes() is None, reason="the system does not tell what a process holds"),
    pytest.mark.skipif(numba.config.DISABLE_JIT, reason="a net of this size takes minutes without the JIT"),
]


@pytest.fixture(scope="module")
def model(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("model") / "nozzle.nas"
    write_mesh(generate("nozzle", 60_000), path)
    return path


@pytest.mark.parametrize("name", ["v3y", "v4", "v5y"])
def test_structure_is_what_the_process_holds(model: Path, name: str) -> None:
    title = registry.contestant("tetra", name).title
    backend = Backend(name=name, contestant=name, title=title, against="v3y")
    memory = weigh(lambda: WorkerProcess(environment=WEIGHING), "tetra", backend, "nozzle", model)
    assert memory.status == "ok", memory.reason
    assert memory.is_accounted
    assert {"incidence", "tree", "points"} <= set(memory.structure)
    tetras = 59_976
    expected = memory.structure_bytes + NODE_BYTES.get(name, 0) * tetras
    assert memory.retained_bytes == pytest.approx(expected, rel=0.05)
    assert memory.peak_bytes is None or memory.peak_bytes > 0.95 * memory.retained_bytes
