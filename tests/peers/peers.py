"""The peers: packages from PyPI that do one thing each that we do, told to use one thread."""

import importlib
import os
from importlib.metadata import version
from typing import Any

ONE_THREAD = {
    "OMP_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
    "MKL_NUM_THREADS": "1",
    "NUMBA_NUM_THREADS": "1",
    "IGL_NUM_THREADS": "1",
    "VTK_SMP_BACKEND_IN_USE": "Sequential",
    "VTK_SMP_MAX_THREADS": "1",
}
"""For the environment, before a peer is loaded. (That it helped is measured: see `bench_peers.measure`.)"""

MODULES = {
    "gmsh": "gmsh",
    "meshio": "meshio",
    "libigl": "igl",
    "scipy": "scipy",
    "pynanoflann": "pynanoflann",
    "pyvista": "pyvista",
    "scikit-fem": "skfem",
    "numpy": "numpy",
}
"""The distribution of each peer and its module."""

_LIBRARIES = "gmsh needs some libraries of the system; on Debian and Ubuntu: apt install {}"
_OF_GMSH = "libglu1-mesa libxrender1 libxcursor1 libxft2 libxinerama1"


class MissingPeerError(Exception):
    """A peer cannot be loaded, and why."""


def load_peer(name: str) -> Any:
    """The module of a peer, ready for one thread.

    Raises:
        MissingPeerError: it is not installed, or a library that it needs is not.
    """
    os.environ.update(ONE_THREAD)
    try:
        module = importlib.import_module(MODULES[name])
    except (ImportError, OSError) as error:  # OSError: a shared library is missing
        if isinstance(error, ModuleNotFoundError):
            hint = "pip install 'tetrabench[peers]'"
        else:
            hint = _LIBRARIES.format(_OF_GMSH) if name == "gmsh" else f"pip install --force-reinstall {name}"
        raise MissingPeerError(f"{error} ({hint})") from error
    if name == "gmsh" and not module.isInitialized():
        module.initialize(["gmsh", "-nt", "1", "-v", "0"], readConfigFiles=False, interruptible=False)
    return module


def peer_version(name: str) -> str:
    """The version of an installed peer; with pyvista that of VTK, which does the work."""
    return f"{version(name)} (vtk {version('vtk')})" if name == "pyvista" else version(name)
