"""Input and output of meshes: the format follows the file's suffix."""

import os
from collections.abc import Sequence
from difflib import get_close_matches
from pathlib import Path

from tetrabench.errors import InputError
from tetrabench.io.formats import BY_SUFFIX, Values, read_foreign, write_foreign
from tetrabench.io.nastran import read_nastran, write_nastran
from tetrabench.mesh.models import MODELS
from tetrabench.mesh.tetra_mesh import TetraMesh

__all__ = ["read_mesh", "read_nastran", "write_mesh", "write_nastran"]

NASTRAN = (".nas", ".bdf", ".dat", ".fem")


def read_mesh(path: str | os.PathLike[str], *, unused: str = "drop", repair: str = "refuse") -> TetraMesh:
    """Read a mesh in the format of its suffix.

    Args:
        path: the file.
        unused: "drop" leaves out the points that no tetra uses, "keep" keeps them; `report.unreferenced` counts them.
        repair: "refuse" raises where tetras repeat a node, are duplicates, or are more than two at a side; "drop"
            leaves them out, and says so in `report.dropped` and `report.warnings`.

    Raises:
        InputError: an unknown suffix, a missing file, or what the reader of the format refuses; `RepairableError`
            where repair="drop" would help, `MemoryRefusedError` where there is not enough memory to read it.
    """
    suffix = known_suffix(path)
    file = Path(path)
    if not is_file(file):
        command = f"tetrabench generate {file.stem} -o {file.name}"
        hint = f"; make it with: {command}" if file.stem in MODELS else ""
        raise InputError(f"{path}: there is no such file{hint}")
    if suffix in NASTRAN:
        return read_nastran(path, unused=unused, repair=repair)
    return read_foreign(path, unused=unused, repair=repair)


def is_file(path: Path) -> bool:
    """Whether there is a file.

    Raises:
        InputError: a folder, a name that no file can have, or a place that must not be looked into.
    """
    try:
        is_folder, is_there = path.is_dir(), path.exists()
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror or error}") from error
    if is_folder:
        raise InputError(f"{path}: a folder, not a file")
    return is_there


def write_mesh(
    mesh: TetraMesh, path: str | os.PathLike[str], *, field: str | None = None, values: Values | None = None
) -> None:
    """Write a mesh in the format of its suffix: a whole file, or none.

    Args:
        mesh: its ids are kept where the format can hold them: see `tetrabench.io.formats`.
        path: the file; one that exists is replaced.
        field: the form of Nastran's fields, "small" unless given; see `write_nastran`. Other formats have none.
        values: of the tetras, by name, (m,) float64 each, such as states: see `tetrabench.io.values`.

    Raises:
        InputError: what `check_target` refuses, or the writer of the format.
    """
    if check_target(path, field, has_values=values is not None) in NASTRAN:
        write_nastran(mesh, path, field=field or "small", comments=[mesh.report.source])
    else:
        write_foreign(mesh, path, values)


def check_target(path: str | os.PathLike[str], field: str | None = None, *, has_values: bool = False) -> str:
    """Return the suffix of a file that a mesh may be written to: to be asked before the work, not after it.

    Raises:
        InputError: an unknown suffix, a format that holds no tetras, or a form of fields, or values, where there are
            none.
    """
    suffix = known_suffix(path)
    check_field(path, field)
    if suffix not in NASTRAN and not BY_SUFFIX[suffix].writes:
        raise InputError(f"{path}: {BY_SUFFIX[suffix].title} files hold surfaces, no tetras")
    if has_values and (suffix in NASTRAN or not BY_SUFFIX[suffix].keeps_values):
        able = " ".join(suffix for suffix, form in BY_SUFFIX.items() if form.keeps_values)
        raise InputError(f"{path}: no values of tetras are kept in this format; they are in {able}")
    return suffix


def check_field(path: str | os.PathLike[str], field: str | None) -> None:
    """Refuse a form of fields where there are none."""
    if field is not None and Path(path).suffix.lower() not in NASTRAN:
        raise InputError(f"{path}: a field form ({field}) can only be chosen for Nastran, {' '.join(NASTRAN)}")


def known_suffix(path: str | os.PathLike[str], known: Sequence[str] = (*NASTRAN, *BY_SUFFIX)) -> str:
    """Return the suffix of a file in small letters, if it is a known one: of ours for meshes of tetras unless given."""
    suffix = Path(path).suffix.lower()
    if suffix not in known:
        near = get_close_matches(suffix, known, n=1)
        hint = f"did you mean {near[0]}? " if near else ""
        raise InputError(f"{path}: the suffix {suffix!r} names no known format; {hint}known are {' '.join(known)}")
    return suffix
