"""Kinds of models, a row for each: how one is made, read, written, put in order and told of; and which a file holds.

Those of tetras and of polygons are here. A family that stores something else has a row of its own, as its attribute `kind`.
"""

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tetrabench.errors import InputError
from tetrabench.io import NASTRAN, check_field, check_target, known_suffix, read_mesh, write_mesh
from tetrabench.io.formats import BY_SUFFIX, NoCellsError
from tetrabench.io.polygons import EXACT, check_polygon_target, read_polygons, write_polygons
from tetrabench.mesh import models, numbering
from tetrabench.mesh.polygon import PolygonMesh
from tetrabench.mesh.polygon import models as polygon_models
from tetrabench.mesh.polygon import numbering as polygon_numbering
from tetrabench.mesh.tetra_mesh import TetraMesh

FilePath = str | os.PathLike[str]

SURFACES = (".stl", ".ply", ".obj", ".off", EXACT)
"""Formats that hold polygons and no tetras."""


@dataclass(frozen=True)
class Kind:
    """What there is to know of models of one kind. A `model` is of its class.

    Attributes:
        model: the class.
        models: that can be generated, by name; each has a `title`, one line about it.
        suffixes: of files that may hold one.
        holds: whether a file may: by its suffix, or by a look into it where others have that suffix, too.
        make: (name, size or None, numbering, seed) -> model.
        read: (path, unused, repair) -> model; `NoCellsError` where it is one of another kind after all.
        check_target: (path, field): refuse a file that it cannot be written to.
        write: (model, path, field) -> what the file has no room for, "" if all is there.
        renumber: (model, numbering, seed) -> model.
        count: (model) -> how many of what it consists of, in words.
        source: (model) -> where it comes from.
        describe: (model) -> all that it consists of, in words.
        inspect: (model) -> a dataclass of what there is to say about it, with `warnings` and `refusal` among that.
        tell: (model, unused) -> what became of the file that it was read from, a sentence each.
        included: (model) -> paths of other files that were read because that one includes them.
        repairs: what --repair drop does to a file that is refused.
        drawn_by: which verb draws one, "{}" its name, where `view` does not.
        family: that runs on them are of, "" where nobody can say what these need.
    """

    model: type
    models: Mapping[str, Any]
    suffixes: Sequence[str]
    holds: Callable[[FilePath], bool]
    make: Callable[[str, int | None, str, int], Any]
    read: Callable[[FilePath, str, str], Any]
    check_target: Callable[[FilePath, str | None], object]
    write: Callable[[Any, FilePath, str | None], str]
    renumber: Callable[[Any, str, int], Any]
    count: Callable[[Any], str]
    describe: Callable[[Any], str]
    source: Callable[[Any], str]
    inspect: Callable[[Any], Any]
    tell: Callable[[Any, str], list[str]]
    included: Callable[[Any], Sequence[str]] = lambda model: ()
    repairs: str = ""
    drawn_by: str = ""
    family: str = ""


def is_surface(path: FilePath) -> bool:
    """Whether a file, by its suffix, holds polygons and no tetras."""
    return Path(path).suffix.lower() in SURFACES


# ---------------------------------------------------------------------- tetras


def _make_tetras(name: str, size: int | None, order: str, seed: int) -> TetraMesh:
    return models.generate(name, size, numbering=order, seed=seed)


def _read_tetras(path: FilePath, unused: str, repair: str) -> TetraMesh:
    return read_mesh(path, unused=unused, repair=repair)


def _write_tetras(mesh: TetraMesh, path: FilePath, field: str | None) -> str:
    write_mesh(mesh, path, field=field)
    return ""


def _count_tetras(mesh: TetraMesh) -> str:
    return f"{len(mesh.tets):,} tetras"


def _inspect_tetras(mesh: TetraMesh) -> object:
    from tetrabench.mesh.inspection import inspect_mesh  # it alone needs scipy

    return inspect_mesh(mesh)


def _tell_tetras(mesh: TetraMesh, unused: str) -> list[str]:
    report, sentences = mesh.report, list(mesh.report.warnings)
    if unused == "drop" and report.unreferenced:
        sentences.append(f"left out {report.unreferenced:,} points that no tetra uses")
    if report.quadratic:
        sentences.append(f"took the corners of {report.quadratic:,} tetras with midside nodes")
    return sentences + _tell_left_out(report.skipped, report.values)


def _tell_left_out(skipped: Mapping[str, int], values: Sequence[str]) -> list[str]:
    cells = ["left out " + ", ".join(f"{name} {number:,}" for name, number in skipped.items())] if skipped else []
    return cells + ([f"left out the values {', '.join(values)}"] if values else [])


TETRAS = Kind(
    model=TetraMesh,
    models=models.MODELS,
    suffixes=(*NASTRAN, *BY_SUFFIX),
    holds=lambda path: Path(path).suffix.lower() in (*NASTRAN, *BY_SUFFIX) and not is_surface(path),
    make=_make_tetras,
    read=_read_tetras,
    check_target=check_target,
    write=_write_tetras,
    renumber=numbering.renumber,
    count=_count_tetras,
    describe=lambda mesh: f"{_count_tetras(mesh)}, {len(mesh.points):,} points",
    source=lambda mesh: mesh.report.source,
    inspect=_inspect_tetras,
    tell=_tell_tetras,
    included=lambda mesh: mesh.report.included,
    repairs="leaves these tetras out",
    family="tetra",
)


# ---------------------------------------------------------------------- polygons


def _make_polygons(name: str, size: int | None, order: str, seed: int) -> PolygonMesh:
    return polygon_models.generate_polygons(name, size, numbering=order, seed=seed)


def _check_polygon_target(path: FilePath, field: str | None) -> None:
    check_polygon_target(path)
    check_field(path, field)


def _write_polygons(mesh: PolygonMesh, path: FilePath, field: str | None) -> str:
    check_field(path, field)
    return write_polygons(mesh, path)


def _count_polygons(mesh: PolygonMesh) -> str:
    return f"{mesh.number_of_cells:,} cells"


def _inspect_polygons(mesh: PolygonMesh) -> object:
    from tetrabench.mesh.polygon.inspection import inspect_polygons

    return inspect_polygons(mesh)


def _tell_polygons(mesh: PolygonMesh, unused: str) -> list[str]:
    report, sentences = mesh.report, list(mesh.report.warnings)
    if report.turned:
        sentences.append(f"turned over {report.turned:,} of {mesh.number_of_cells:,} cells")
    if report.quadratic:
        sentences.append(f"took the corners of {report.quadratic:,} cells with midside nodes")
    return sentences + _tell_left_out(report.skipped, report.values)


POLYGONS = Kind(
    model=PolygonMesh,
    models=polygon_models.MODELS,
    suffixes=(EXACT, *BY_SUFFIX),
    holds=lambda path: Path(path).suffix.lower() in (EXACT, *BY_SUFFIX),
    make=_make_polygons,
    read=lambda path, unused, repair: read_polygons(path, repair=repair),
    check_target=_check_polygon_target,
    write=_write_polygons,
    renumber=polygon_numbering.renumber_polygons,
    count=_count_polygons,
    describe=lambda mesh: f"{_count_polygons(mesh)}, {len(mesh.points):,} points",
    source=lambda mesh: mesh.report.source,
    inspect=_inspect_polygons,
    tell=_tell_polygons,
    repairs="mends it",
    family="polygon",
)

MESHES = (TETRAS, POLYGONS)
"""Of a file that may hold both, the tetras are taken; and a .npz file that nobody else knows is one of polygons."""


# ---------------------------------------------------------------------- any


def kind_of(model: object, kinds: Sequence[Kind] = MESHES) -> Kind:
    """The kind that a model is of."""
    return next(kind for kind in kinds if isinstance(model, kind.model))


def read_any(path: FilePath, *, unused: str = "drop", repair: str = "refuse", kinds: Sequence[Kind] = MESHES) -> Any:
    """Read a model of the first kind that a file holds.

    Args:
        path: the file.
        unused: what becomes of points that no tetra uses; see `read_mesh`.
        repair: see `read_mesh` and `read_polygons`.
        kinds: in the order in which they are tried.

    Raises:
        InputError: an unknown suffix; or what the reader of the first kind refuses that the file may hold.
    """
    first: NoCellsError | None = None
    for kind in _holders(path, kinds):
        try:
            return kind.read(path, unused, repair)
        except NoCellsError as error:
            first = first or error
    assert first is not None
    raise first


def check_any_target(source: FilePath, target: FilePath, field: str | None, kinds: Sequence[Kind] = MESHES) -> None:
    """Refuse a file that cannot be written to, whatever kind of model `source` may hold: before the work, not after it.

    Raises:
        InputError: an unknown suffix; or what the first of these kinds refuses, if all refuse it.
    """
    first: InputError | None = None
    for kind in _holders(source, kinds):
        try:
            kind.check_target(target, field)
            return
        except InputError as error:
            first = first or error
    assert first is not None
    raise first


def _holders(path: FilePath, kinds: Sequence[Kind]) -> list[Kind]:
    holders = [kind for kind in kinds if kind.holds(path)]
    if not holders:
        known_suffix(path, [*dict.fromkeys(suffix for kind in kinds for suffix in kind.suffixes)])
    return holders
