"""The peers in C and C++: each a shared library with the same loops around its own mesh, see peer.h."""

import ctypes
import shutil
import subprocess
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tests.contest import Progress
from tetrabench.bench.memory import private_bytes, trim_heap
from tetrabench.errors import InputError
from tetrabench.mesh.polygon import PolygonMesh
from tetrabench.polygon.queries import Query

HERE = Path(__file__).parent
FLAGS = ["-O3", "-DNDEBUG", "-DCGAL_NDEBUG"]  # without -march=native, with which the tables are slower
PEERS = {
    "c": (["gcc", "-std=c11", "tables.c"], "gcc"),
    "cgal": (["g++", "-std=c++17", "cgal.cpp"], "g++ libcgal-dev"),
    "openmesh": (["g++", "-std=c++17", "openmesh.cpp", "-lOpenMeshCore"], "g++ libopenmesh-dev"),
}
"""Name -> what its library is compiled with, and Debian's packages that it needs."""

Rows = NDArray[np.int32]


class Polygons(ctypes.Structure):
    """What a peer builds its mesh from, see peer.h."""

    _fields_ = [
        ("cells", ctypes.c_int32),
        ("nodes", ctypes.c_int32),
        ("edges", ctypes.c_int32),
        ("starts", ctypes.c_void_p),
        ("items", ctypes.c_void_p),
        ("conditions", ctypes.c_void_p),
        ("points", ctypes.c_void_p),
    ]


class Peer:
    """A peer's library, with the mesh that it is asked about: built when it is first needed."""

    def __init__(self, name: str, folder: Path, mesh: PolygonMesh) -> None:
        """Compile and load the library.

        Raises:
            InputError: it cannot be compiled here; says which packages may be missing.
        """
        (compiler, standard, source, *libraries), packages = PEERS[name]
        if shutil.which(compiler) is None:
            raise InputError(f"there is no {compiler}; on Debian and Ubuntu: apt install {packages}")
        target = folder / f"{name}.so"
        command = [compiler, standard, *FLAGS, "-shared", "-fPIC", str(HERE / source), "-o", str(target), *libraries]
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode:
            error = next((line for line in done.stderr.splitlines() if "error" in line), "")
            raise InputError(f"{name} does not compile: {error}; on Debian and Ubuntu: apt install {packages}")
        self.library = ctypes.CDLL(str(target))
        self.library.build.restype = ctypes.c_void_p
        self.mesh = mesh
        self._kept = points, *_ = (
            np.zeros((len(mesh.points), 3)),
            np.ascontiguousarray(mesh.starts),
            np.ascontiguousarray(mesh.nodes),
            np.ascontiguousarray(mesh.conditions),
        )
        points[:, : mesh.points.shape[1]] = mesh.points
        edges = (len(mesh.nodes) + int((mesh.conditions < 0).sum())) // 2
        addresses = [array.ctypes.data for array in (*self._kept[1:], points)]
        self._polygons = Polygons(mesh.number_of_cells, len(points), edges, *addresses)

    @property
    def version(self) -> int:
        """What the library says that it is; 0 of our own tables."""
        return int(self.library.version()) if hasattr(self.library, "version") else 0

    def build(self) -> ctypes.c_void_p:
        """Build its mesh; `drop` gives it back."""
        pointer = self.library.build(ctypes.byref(self._polygons))
        assert pointer, "the peer refused the mesh"
        return ctypes.c_void_p(pointer)

    def drop(self, pointer: ctypes.c_void_p) -> None:
        """Give a mesh back."""
        self.library.drop(pointer)

    @cached_property
    def held(self) -> ctypes.c_void_p:
        """Its mesh, which stays."""
        return self.build()

    @cached_property
    def bytes(self) -> int:
        """Private memory that the process has more of with one more mesh."""
        trim_heap()
        before = private_bytes()
        pointer = self.build()
        after = private_bytes()
        self.drop(pointer)
        return (after or 0) - (before or 0)

    def sweep(self, query: Query, out: Rows) -> int:
        """The sum of what all lists of a query hold."""
        function = self._loop("sweep", query)
        return int(function(self.held, ctypes.c_void_p(out.ctypes.data)))

    def sample(self, query: Query, picks: Rows, out: Rows) -> int:
        """The same over some elements."""
        function = self._loop("sample", query)
        addresses = [ctypes.c_void_p(array.ctypes.data) for array in (picks, out)]
        return int(function(self.held, addresses[0], ctypes.c_int64(len(picks)), addresses[1]))

    def lists(self, query: Query, elements: int, room: int) -> tuple[NDArray[np.int64], Rows]:
        """All lists of a query; `room` of one."""
        starts, items = np.empty(elements + 1, np.int32), np.empty(elements * room, np.int32)
        addresses = [ctypes.c_void_p(array.ctypes.data) for array in (starts, items)]
        self._loop("list", query)(self.held, *addresses)
        return starts.astype(np.int64), items[: starts[-1]]

    def _loop(self, kind: str, query: Query) -> "ctypes._NamedFuncPointer":
        function = getattr(self.library, f"{kind}_{query.name.replace('-', '_')}")
        function.restype = None if kind == "list" else ctypes.c_int64
        return function


def load_peers(folder: Path, mesh: PolygonMesh, progress: Progress) -> tuple[dict[str, Peer], dict[str, str]]:
    """The peers that there are, and why the others are not."""
    peers, missing = {}, {}
    for name in PEERS:
        progress.say(f"compiling {name}")
        try:
            peers[name] = Peer(name, folder, mesh)
        except InputError as error:
            missing[name] = str(error)
    return peers, missing
