"""Tetrabench: the same workloads on interchangeable ways to store a mesh, compared in answers, time, memory.

The public face. Everything is imported on first use, so that `import tetrabench` costs next to nothing.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import os

    from tetrabench.bench import load_results, load_summary, run
    from tetrabench.io import read_mesh, write_mesh
    from tetrabench.jit import kernel
    from tetrabench.mesh import TetraMesh
    from tetrabench.mesh.models import generate
    from tetrabench.tetra.net import TetraNet

__all__ = [
    "TetraMesh",
    "TetraNet",
    "__version__",
    "generate",
    "kernel",
    "load_results",
    "load_summary",
    "open",
    "read_mesh",
    "run",
    "write_mesh",
]

_HOMES = {
    "TetraMesh": "tetrabench.mesh",
    "TetraNet": "tetrabench.tetra.net",
    "generate": "tetrabench.mesh.models",
    "kernel": "tetrabench.jit",
    "load_results": "tetrabench.bench",
    "load_summary": "tetrabench.bench",
    "read_mesh": "tetrabench.io",
    "run": "tetrabench.bench",
    "write_mesh": "tetrabench.io",
}

__version__: str


def open(
    path_or_mesh: "TetraMesh | str | os.PathLike[str]", backend: str = "v3y", *, states: bool = True
) -> "TetraNet":
    """Open a file, or a mesh, as a net in the storage of a backend.

    Args:
        path_or_mesh: a file in any format, by its suffix; or points and tetras.
        backend: the contestant that stores it.
        states: whether the states are taken that the file holds, `state_0` to `state_4` as `TetraNet.write` keeps them: it
            is read once more for them. Else, and where it holds none, they are 0.

    Raises:
        InputError: no such backend or file, or a mesh that no net can hold.
        MemoryRefusedError: there is not enough memory for it.
    """
    from tetrabench import registry
    from tetrabench.io import read_mesh
    from tetrabench.io.values import read_values
    from tetrabench.mesh import TetraMesh
    from tetrabench.tetra.net import TetraNet

    contestant: Any = registry.contestant("tetra", backend)
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
