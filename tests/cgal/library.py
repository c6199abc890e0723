"""The C++ side: build it, load it, and hold what it builds. One shared library, of plain loops and of calls to CGAL."""

import ctypes
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tests.contest import Progress
from tetrabench.errors import InputError

HERE = Path(__file__).parent
COMPILER = "g++"
FLAGS = [
    "-O3",
    "-march=native",
    "-std=c++17",
    "-DNDEBUG",
    "-DCGAL_NDEBUG",
]  # -std=c++17: no fused multiply-add, as ours
PACKAGES = "apt install g++ libcgal-dev libgmp-dev libmpfr-dev"

_ARRAY, _POINTER, _INTEGER = ctypes.c_void_p, ctypes.c_void_p, ctypes.c_int64
_NUMBER, _SUM, _TRUTH = ctypes.c_double, ctypes.c_uint64, ctypes.c_bool

_FUNCTIONS: dict[str, tuple[Any, ...]] = {  # what each returns, and takes
    "plain_sides": (None, _ARRAY, _INTEGER, _INTEGER, _ARRAY),
    "plain_centroid": (_NUMBER, _ARRAY, _INTEGER, _ARRAY),
    "plain_table": (None, _ARRAY, _INTEGER, _INTEGER, _ARRAY, _ARRAY),
    "plain_walk": (_SUM, _ARRAY, _ARRAY, _INTEGER, _ARRAY),
    "plain_touch": (_SUM, _ARRAY, _ARRAY, _INTEGER, _ARRAY, _ARRAY),
    "plain_ask": (_SUM, _ARRAY, _ARRAY, _ARRAY, _ARRAY, _INTEGER),
    "plain_cube": (None, _INTEGER, _ARRAY, _ARRAY),
    "cgal_version": (_INTEGER,),
    "bare_build": (_POINTER, _ARRAY, _INTEGER, _INTEGER),
    "bare_free": (None, _POINTER),
    "bare_valid": (_TRUTH, _POINTER),
    "bare_neighbours": (None, _POINTER, _INTEGER, _ARRAY),
    "bare_counts": (None, _POINTER, _ARRAY),
    "bare_choose": (None, _POINTER, _ARRAY, _INTEGER),
    "bare_replace": (_INTEGER, _POINTER),
    "numbered_build": (_POINTER, _ARRAY, _INTEGER, _ARRAY, _INTEGER),
    "numbered_free": (None, _POINTER),
    "numbered_valid": (_TRUTH, _POINTER),
    "numbered_cell_bytes": (_INTEGER,),
    "numbered_centroid": (_NUMBER, _POINTER),
    "numbered_walk": (_SUM, _POINTER, _ARRAY),
    "numbered_touch": (_SUM, _POINTER, _ARRAY),
    "delaunay_build": (_POINTER, _ARRAY, _INTEGER),
    "delaunay_free": (None, _POINTER),
    "delaunay_valid": (_TRUTH, _POINTER),
    "delaunay_vertices": (_INTEGER, _POINTER),
    "delaunay_volume": (_NUMBER, _POINTER),
    "call_there": (_TRUTH,),
    "call_build": (_POINTER, _ARRAY, _INTEGER, _ARRAY, _INTEGER),
    "call_free": (None, _POINTER),
    "call_valid": (_TRUTH, _POINTER),
    "call_neighbours": (None, _POINTER, _INTEGER, _ARRAY),
}


def compiler_version() -> str:
    """What the compiler says it is."""
    said = subprocess.run([COMPILER, "--version"], capture_output=True, text=True, check=True)
    return said.stdout.splitlines()[0]


def build(folder: Path, progress: Progress | None = None) -> Path:
    """Compile the library into a folder; half a minute.

    Raises:
        InputError: there is no compiler, no CGAL, or none that compiles.
    """
    if shutil.which(COMPILER) is None:
        raise InputError(f"there is no {COMPILER}; on Debian and Ubuntu: {PACKAGES}")
    headers = "".join(f"#include <{name}>\n" for name in ("CGAL/version.h", "gmp.h", "mpfr.h"))
    look = subprocess.run([COMPILER, "-E", "-x", "c++", "-"], input=headers, capture_output=True, text=True)
    if look.returncode:
        missing = look.stderr.partition("fatal error: ")[2].partition(":")[0]
        raise InputError(f"{COMPILER} does not find {missing or 'CGAL'}; on Debian and Ubuntu: {PACKAGES}")
    if progress is not None:
        progress.say(f"compiling with {COMPILER} {' '.join(FLAGS)}, about half a minute")
    library = folder / "yardstick.so"
    sources = [str(HERE / name) for name in ("plain.cpp", "yardstick.cpp")]
    command = [COMPILER, *FLAGS, "-shared", "-fPIC", *sources, "-o", str(library), "-lgmp", "-lmpfr"]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode:
        error = next((text for text in done.stderr.splitlines() if "error:" in text), done.stderr[-300:])
        raise InputError(f"the yardstick does not compile, CGAL 5.5 is known to work: {error}")
    return library


def load(library: Path) -> Any:
    """The functions of the library; arrays go in by `at`."""
    functions = ctypes.CDLL(str(library))
    for name, (result, *arguments) in _FUNCTIONS.items():
        function = getattr(functions, name)
        function.restype, function.argtypes = result, arguments
    return functions


def at(array: NDArray[Any]) -> int:
    """The address of a contiguous array."""
    assert array.flags.c_contiguous
    return int(array.ctypes.data)


class Held:
    """Something that the library built; given back when nobody holds it any more."""

    def __init__(self, pointer: int, free: Callable[[int], None]) -> None:
        self.pointer, self._free = pointer, free

    def __del__(self) -> None:
        self._free(self.pointer)


def neighbours(functions: Any, kind: str, held: Held, tetras: int) -> NDArray[np.int32]:
    """(tetras, 4) int32, the tetra behind each side, -1 where there is none."""
    table = np.empty((tetras, 4), np.int32)
    getattr(functions, f"{kind}_neighbours")(held.pointer, tetras, at(table))
    return table
