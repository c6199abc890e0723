"""Which kind of mesh a file holds: tetras, or polygons where there are none."""

import os
from pathlib import Path

from tetrabench.errors import InputError
from tetrabench.io import NASTRAN, check_field, check_target, read_mesh, write_mesh
from tetrabench.io.formats import NoCellsError
from tetrabench.io.polygons import EXACT, check_polygon_target, read_polygons, write_polygons
from tetrabench.mesh.polygon import PolygonMesh
from tetrabench.mesh.tetra_mesh import TetraMesh

SURFACES = (".stl", ".ply", ".obj", ".off", EXACT)
"""Formats that hold polygons and no tetras."""


def read_any(path: str | os.PathLike[str], *, unused: str = "drop", repair: str = "refuse") -> TetraMesh | PolygonMesh:
    """Read a mesh: the tetras of a file that has any, else its polygons.

    Args:
        path: the file.
        unused: what becomes of points that no tetra uses; see `read_mesh`.
        repair: see `read_mesh` and `read_polygons`.

    Raises:
        InputError: what `read_mesh` refuses, or `read_polygons` where there are no tetras.
    """
    if is_surface(path):
        return read_polygons(path, repair=repair)
    try:
        return read_mesh(path, unused=unused, repair=repair)
    except NoCellsError as no_tetras:
        try:
            return read_polygons(path, repair=repair)
        except NoCellsError:
            raise no_tetras from None


def write_any(mesh: TetraMesh | PolygonMesh, path: str | os.PathLike[str], *, field: str | None = None) -> str:
    """Write a mesh of either kind; returns what of it the file has no room for, "" if all is there.

    Raises:
        InputError: what `write_mesh` or `write_polygons` refuses.
    """
    if isinstance(mesh, PolygonMesh):
        check_field(path, field)
        return write_polygons(mesh, path)
    write_mesh(mesh, path, field=field)
    return ""


def is_surface(path: str | os.PathLike[str]) -> bool:
    """Whether a file, by its suffix, holds polygons and no tetras."""
    return Path(path).suffix.lower() in SURFACES


def check_any_target(source: str | os.PathLike[str], target: str | os.PathLike[str], field: str | None) -> None:
    """Refuse a file that cannot be written to, whatever kind of mesh `source` may hold: before the work, not after it.

    Raises:
        InputError: as `check_target` and `check_polygon_target`.
    """
    if is_surface(source):
        check_polygon_target(target)
        check_field(target, field)
        return
    try:
        check_target(target, field)
    except InputError as no_tetras:
        if Path(source).suffix.lower() in NASTRAN or field is not None:
            raise
        try:
            check_polygon_target(target)
        except InputError:
            raise no_tetras from None
