"""The file of a polygon mesh to the bit, numpy's .npz: its four arrays, and its report as JSON."""

import contextlib
import json
import os
from dataclasses import asdict
from pathlib import Path
from typing import Any

import msgspec
import numpy as np

from tetrabench.archive import open_archive
from tetrabench.drafts import drafted
from tetrabench.errors import InputError, MemoryRefusedError
from tetrabench.mesh.polygon.connect import belong_together
from tetrabench.mesh.polygon.polygon_mesh import PolygonMesh, PolygonReport

ARRAYS = {"points": np.float64, "starts": np.int32, "nodes": np.int32, "conditions": np.int32}
REPORT = "report"


def save_polygons(mesh: PolygonMesh, path: str | os.PathLike[str]) -> None:
    """Write a mesh to a file that `load_polygons` reads: the whole of it, or none.

    The same mesh gives the same file, byte for byte.

    Args:
        mesh: what to write.
        path: the file, whatever its suffix.

    Raises:
        InputError: the file cannot be written.
    """
    arrays: dict[str, Any] = {name: np.ascontiguousarray(getattr(mesh, name), dtype) for name, dtype in ARRAYS.items()}
    # Python's JSON has room for a source whose name is no text, too.
    arrays[REPORT] = np.frombuffer(json.dumps(asdict(mesh.report)).encode(), np.uint8)
    with drafted(path) as draft, draft.open("wb") as file:
        np.savez(file, **arrays)


def load_polygons(path: str | os.PathLike[str]) -> PolygonMesh:
    """Read what `save_polygons` wrote.

    Sums in the file tell damage; whether its cells hang together is for `connect` to say.

    Raises:
        InputError: no such file, one of something else, or a damaged one; `MemoryRefusedError` where there is not enough
            memory to read it.
    """
    broken = InputError(f"{path}: not a polygon mesh as tetrabench writes it, or damaged; make it again")
    with contextlib.ExitStack() as stack:
        try:
            file = stack.enter_context(open(path, "rb"))
        except OSError as error:
            raise InputError(f"{path}: cannot be read: {error.strerror or error}") from error
        try:
            with open_archive(Path(path), file) as archive:
                arrays = {name: archive[name] for name in ARRAYS}
                report = msgspec.convert(json.loads(archive[REPORT].tobytes()), PolygonReport)
        except MemoryRefusedError:
            raise
        except Exception as error:  # numpy and zipfile raise anything, MemoryError where a size is damaged
            raise broken from error
    mesh = PolygonMesh(**arrays, report=report)
    if not has_shape(mesh):
        raise broken
    return mesh


def has_shape(mesh: PolygonMesh) -> bool:
    """Whether the arrays have the types and shapes that PolygonMesh says."""
    arrays: dict[str, Any] = {name: getattr(mesh, name) for name in ARRAYS}
    if any(not isinstance(array, np.ndarray) or array.dtype != ARRAYS[name] for name, array in arrays.items()):
        return False  # what does not begin as an array comes as bytes
    flat = mesh.starts.ndim == mesh.nodes.ndim == mesh.conditions.ndim == 1
    return flat and mesh.points.ndim == 2 and mesh.points.shape[1] in (2, 3) and belong_together(mesh)
