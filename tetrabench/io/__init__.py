"""Input and output of meshes: the format follows the file's suffix."""

import os
from collections.abc import Callable
from pathlib import Path

from tetrabench.errors import InputError
from tetrabench.io.nastran import read_nastran, write_nastran
from tetrabench.mesh.models import MODELS
from tetrabench.mesh.tetra_mesh import TetraMesh

__all__ = ["read_mesh", "read_nastran", "write_mesh", "write_nastran"]

NASTRAN = (".nas", ".bdf", ".dat", ".fem")
READERS: dict[str, Callable[[str | os.PathLike[str]], TetraMesh]] = dict.fromkeys(NASTRAN, read_nastran)
WRITERS: dict[str, Callable[..., None]] = dict.fromkeys(NASTRAN, write_nastran)


def read_mesh(path: str | os.PathLike[str]) -> TetraMesh:
    """Read a mesh in the format of its suffix.

    Raises:
        InputError: an unknown suffix, a missing file, or what the reader of the format refuses.
    """
    reader = READERS[known_suffix(path)]
    file = Path(path)
    if not file.exists():
        command = f"tetrabench generate {file.stem} -o {file.name}"
        hint = f"; make it with: {command}" if file.stem in MODELS else ""
        raise InputError(f"{path}: there is no such file{hint}")
    return reader(path)


def write_mesh(mesh: TetraMesh, path: str | os.PathLike[str]) -> None:
    """Write a mesh in the format of its suffix, with the words about its source at the top.

    Raises:
        InputError: an unknown suffix, or what the writer of the format refuses.
    """
    WRITERS[known_suffix(path)](mesh, path, comments=[mesh.report.source])


def known_suffix(path: str | os.PathLike[str]) -> str:
    """Return the suffix of a file in small letters, if it is one of ours."""
    suffix = Path(path).suffix.lower()
    if suffix not in READERS:
        known = " ".join(READERS)
        raise InputError(f"{path}: the suffix {suffix!r} names no known format; known are {known}")
    return suffix
