"""Tetrabench: the same workloads on interchangeable ways to store a mesh, compared in answers, time, memory.

The public face. Everything is imported on first use, so that `import tetrabench` costs next to nothing.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import os

    from tetrabench.bench import load_results, load_summary, run
    from tetrabench.bench.conformance import check_contestant
    from tetrabench.collision.simulation import Simulation
    from tetrabench.collision.start.files import read_objects, write_objects
    from tetrabench.collision.start.models import generate_objects
    from tetrabench.errors import InputError, PluginWarning, TetrabenchError
    from tetrabench.io import read_mesh, write_mesh
    from tetrabench.io.polygons import read_polygons, write_polygons
    from tetrabench.jit import kernel
    from tetrabench.mesh import TetraMesh
    from tetrabench.mesh.models import generate
    from tetrabench.mesh.polygon import PolygonMesh
    from tetrabench.mesh.polygon.models import generate_polygons
    from tetrabench.polygon.net import PolygonNet
    from tetrabench.registry import contestant
    from tetrabench.tetra.contestant import TetraContestant
    from tetrabench.tetra.net import TetraNet

__all__ = [
    "InputError",
    "PluginWarning",
    "PolygonMesh",
    "PolygonNet",
    "Simulation",
    "TetraMesh",
    "TetraNet",
    "TetrabenchError",
    "__version__",
    "check_contestant",
    "contestant",
    "generate",
    "generate_objects",
    "generate_polygons",
    "kernel",
    "load_results",
    "load_summary",
    "open",
    "read_mesh",
    "read_objects",
    "read_polygons",
    "run",
    "write_mesh",
    "write_objects",
    "write_polygons",
]

_HOMES = {
    "InputError": "tetrabench.errors",
    "PluginWarning": "tetrabench.errors",
    "PolygonMesh": "tetrabench.mesh.polygon",
    "PolygonNet": "tetrabench.polygon.net",
    "Simulation": "tetrabench.collision.simulation",
    "TetraMesh": "tetrabench.mesh",
    "TetraNet": "tetrabench.tetra.net",
    "TetrabenchError": "tetrabench.errors",
    "check_contestant": "tetrabench.bench.conformance",
    "contestant": "tetrabench.registry",
    "generate": "tetrabench.mesh.models",
    "generate_objects": "tetrabench.collision.start.models",
    "generate_polygons": "tetrabench.mesh.polygon.models",
    "kernel": "tetrabench.jit",
    "load_results": "tetrabench.bench",
    "load_summary": "tetrabench.bench",
    "read_mesh": "tetrabench.io",
    "read_objects": "tetrabench.collision.start.files",
    "read_polygons": "tetrabench.io.polygons",
    "run": "tetrabench.bench",
    "write_mesh": "tetrabench.io",
    "write_objects": "tetrabench.collision.start.files",
    "write_polygons": "tetrabench.io.polygons",
}

__version__: str


def open(
    path_or_mesh: "TetraMesh | str | os.PathLike[str]", backend: "TetraContestant | str" = "v3y", *, states: bool = True
) -> "TetraNet":
    """Open a file, or a mesh, as a net in the storage of a backend.

    Args:
        path_or_mesh: a file in any format, by its suffix; or points and tetras.
        backend: the contestant that stores it, or its name.
        states: whether the states are taken that the file holds, `state_0` to `state_4` as `TetraNet.write` keeps them: it
            is read once more for them. Else, and where it holds none, they are 0.

    Raises:
        InputError: no such backend or file, or a mesh that no net can hold.
        MemoryRefusedError: there is not enough memory for it.

    >>> import tetrabench
    >>> tetrabench.open(tetrabench.generate("box", 48), backend="v4")
    <TetraNet v4: 48 tetras, 27 points>
    """
    from tetrabench import registry
    from tetrabench.io import read_mesh
    from tetrabench.io.values import read_values
    from tetrabench.mesh import TetraMesh
    from tetrabench.tetra.net import TetraNet

    contestant: Any = registry.contestant("tetra", backend) if isinstance(backend, str) else backend
    if isinstance(path_or_mesh, TetraMesh):
        return TetraNet(path_or_mesh, contestant)
    net = TetraNet(read_mesh(path_or_mesh), contestant)
    if states:
        net.take_states(read_values(path_or_mesh))
    return net


def __getattr__(name: str) -> Any:
    if name == "__version__":
        from importlib.metadata import version

        return version("tetrabench")
    if name in _HOMES:
        return getattr(import_module(_HOMES[name]), name)
    raise AttributeError(f"module 'tetrabench' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
