"""Meshes of polygons, read and written in the format of the file's suffix.

| suffixes | written | cells written |
|---|---|---|
| .npz, our own | exact, conditions and all | any |
| .obj .off | exact, 16 to 17 digits | any |
| .ply | exact, binary | up to 255 nodes |
| .vtk .vtu | exact, binary | any |
| .msh (Gmsh 2.2) .mesh .meshb .inp .xdmf .xmf .e .exo .ex2 .avs | as in `tetrabench.io.formats` | triangles and quads |
| the others of `tetrabench.io.formats` | not written | |

All are read, by meshio but for .npz, .obj and .off: cells that are polygons, those with midside nodes by their corners. Only
.npz has boundary conditions: from other files all sides of the boundary get the same one.
"""

import os
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tetrabench.drafts import drafted
from tetrabench.errors import InputError
from tetrabench.io import NASTRAN, is_file, known_suffix
from tetrabench.io.formats import BY_SUFFIX, NoCellsError, list_cells, meshio_at_work, raw_mesh, size_of
from tetrabench.io.obj import read_obj
from tetrabench.io.off import read_off, write_off
from tetrabench.memory import held_to_available, refuse_if_too_large
from tetrabench.mesh.polygon.check import settle
from tetrabench.mesh.polygon.polygon_mesh import CONDITION, PolygonMesh, PolygonReport
from tetrabench.mesh.polygon.store import load_polygons, save_polygons

EXACT, OBJ, OFF = ".npz", ".obj", ".off"
OBJ_ROOM, OFF_ROOM = 11, 12  # bytes of memory for each byte of a file, measured
ANY = 2**31 - 1
MOST_NODES = dict.fromkeys((EXACT, ".obj", OFF, ".vtk", ".vtu"), ANY) | {".ply": 255}
MOST_NODES |= dict.fromkeys((".msh", ".mesh", ".meshb", ".inp", ".xdmf", ".xmf", ".e", ".exo", ".ex2", ".avs"), 4)
"""The most nodes of a cell that can be written, by the suffix."""

CORNERS = {"triangle": 3, "quad": 4, "VTK_LAGRANGE_TRIANGLE": 3, "VTK_LAGRANGE_QUADRILATERAL": 4}
GMSH = "gmsh22"  # 4.1 would want to be told which cells belong to which entity of a geometry


@dataclass
class CellLists:
    """What is read from a file.

    Attributes:
        points: (n, 2) or (n, 3) float64.
        starts, nodes: (m + 1,) and (s,) int64, of the cells, as in PolygonMesh.
        report: what else there is.
    """

    points: NDArray[np.float64]
    starts: NDArray[np.int64]
    nodes: NDArray[np.int64]
    report: PolygonReport


def read_polygons(path: str | os.PathLike[str], *, repair: str = "refuse") -> PolygonMesh:
    """Read a mesh of polygons in the format of its suffix.

    Args:
        path: the file.
        repair: what becomes of faults: see `settle`. A file that `write_polygons` wrote as .npz has none.

    Raises:
        NoCellsError: it holds other cells, or none.
        InputError: an unknown suffix, a missing file, what the reader of the format refuses, or what `settle` refuses;
            `RepairableError` where repair="drop" would help.
    """
    suffix, file = check_polygon_source(path), Path(path)
    if not is_file(file):
        raise InputError(f"{path}: there is no such file")
    if suffix == EXACT:
        return load_polygons(file)
    read = {OBJ: read_obj_lists, OFF: read_off_lists}.get(suffix, read_meshio_lists)
    lists = read(file)
    return settle(lists.points, lists.starts, lists.nodes, report=lists.report, repair=repair)


def read_obj_lists(path: Path) -> CellLists:
    """All cells that an OBJ file holds.

    Raises:
        NoCellsError: there are none.
        InputError: see `read_obj`.
    """
    refuse_if_too_large(f"reading {path}", OBJ_ROOM * size_of(path))
    with held_to_available():
        points, starts, nodes, skipped = read_obj(path)
    if len(starts) == 1:
        raise NoCellsError(f"{path}: holds no polygons; it holds {list_cells(skipped)}")
    return CellLists(points, starts, nodes, PolygonReport(source=str(path), format="OBJ", skipped=dict(skipped)))


def read_off_lists(path: Path) -> CellLists:
    """All that an OFF file holds."""
    refuse_if_too_large(f"reading {path}", OFF_ROOM * size_of(path))
    with held_to_available():
        return CellLists(*read_off(path), PolygonReport(source=str(path), format="OFF"))


def read_meshio_lists(path: Path) -> CellLists:
    """The polygons of a file, in its order, and its points without the midside nodes that no corner is."""
    with raw_mesh(path) as raw:
        held = [(block.type, np.array(block.data, np.int64)) for block in raw.mesh.cells if len(block.data)]
        values = raw.values
        polygons = [
            np.split(rows, [corners_of(kind, rows.shape[1])], axis=1) for kind, rows in held if is_polygon(kind)
        ]
    if not polygons:
        raise NoCellsError(f"{path}: holds no polygons; it holds {list_cells(raw.cells)}")
    sizes = np.concatenate([np.full(len(corners), corners.shape[1]) for corners, _ in polygons])
    nodes, midside = (np.concatenate([part.ravel() for part in parts]) for parts in zip(*polygons, strict=True))
    points = raw.points
    unneeded = np.setdiff1d(midside, nodes)
    unneeded = unneeded[(unneeded >= 0) & (unneeded < len(points))]
    if len(unneeded) and nodes.min() >= 0 and nodes.max() < len(points):  # else `settle` says what is wrong
        kept = np.ones(len(points), np.bool_)
        kept[unneeded] = False
        points, nodes = points[kept], (np.cumsum(kept) - 1)[nodes]
    report = PolygonReport(
        source=str(path),
        format=raw.form.title,
        skipped={kind: count for kind, count in raw.cells.most_common() if count and not is_polygon(kind)},
        quadratic=sum(len(corners) for corners, rest in polygons if rest.shape[1]),
        values=values,
        warnings=[f"{path}: {sentence}" for sentence in raw.said],
    )
    return CellLists(points, np.append(0, np.cumsum(sizes)), nodes, report)


def is_polygon(kind: str) -> bool:
    """Whether meshio's cells of this kind are polygons, with midside nodes or without."""
    return kind in CORNERS or kind.rstrip("0123456789") in ("triangle", "quad", "polygon")


def corners_of(kind: str, nodes: int) -> int:
    """How many of a polygon's nodes are its corners; they come first."""
    return CORNERS.get(kind) or CORNERS.get(kind.rstrip("0123456789"), nodes)


def write_polygons(mesh: PolygonMesh, path: str | os.PathLike[str]) -> str:
    """Write a mesh of polygons in the format of the suffix: a whole file, or none.

    Args:
        mesh: what to write; where a format has three coordinates, z is 0 in the plane.
        path: the file; one that exists is replaced.

    Returns:
        What the format has no room for, in a sentence; "" where nothing is lost.

    Raises:
        InputError: what `check_polygon_target` refuses, a cell with more nodes than the format can hold, or what the
            writer refuses.
    """
    suffix = check_polygon_target(path)
    if suffix == EXACT:
        save_polygons(mesh, path)
        return ""
    most = int(np.diff(mesh.starts).max())
    if most > MOST_NODES[suffix]:
        able = " ".join(name for name, nodes in MOST_NODES.items() if nodes >= most)
        raise InputError(f"{path}: this format holds no cell of {most} nodes, and the mesh does; write {able}")
    points = np.zeros((len(mesh.points), 3))
    points[:, : mesh.points.shape[1]] = mesh.points
    with drafted(path) as draft:
        if suffix == OFF:
            write_off(points, mesh.starts, mesh.nodes, draft)
        else:
            write_meshio(mesh, points, draft, f"{path}: cannot be written as {BY_SUFFIX[suffix].title}")
    given = np.unique(mesh.conditions[mesh.conditions < 0])
    if (given == CONDITION).all():
        return ""
    listed = ", ".join(map(str, given[::-1]))
    return f"{path}: the boundary conditions {listed} are not in it; only {EXACT} files hold them"


def write_meshio(mesh: PolygonMesh, points: NDArray[np.float64], file: Path, failure: str) -> None:
    """Write points (n, 3) and the cells of a mesh: a block for each run of cells with the same number of nodes."""
    form, sizes = BY_SUFFIX[file.suffix.lower()], np.diff(mesh.starts)
    bounds = [0, *(np.flatnonzero(np.diff(sizes)) + 1).tolist(), len(sizes)]
    blocks: list[tuple[str, NDArray[Any]]] = []
    for begin, end in pairwise(bounds):
        size = int(sizes[begin])
        block = mesh.nodes[mesh.starts[begin] : mesh.starts[end]].reshape(-1, size)
        blocks.append(({3: "triangle", 4: "quad"}.get(size, "polygon"), block))
    with meshio_at_work(failure):
        import meshio

        name = GMSH if form.name == "gmsh" else form.name
        meshio.write(file, meshio.Mesh(points, blocks), file_format=name, **form.options)


def check_polygon_source(path: str | os.PathLike[str]) -> str:
    """Return the suffix of a file in small letters, if polygons may be read from it.

    Raises:
        InputError: an unknown suffix.
    """
    return known_suffix(path, (EXACT, *BY_SUFFIX))


def check_polygon_target(path: str | os.PathLike[str]) -> str:
    """Return the suffix of a file that polygons may be written to: to be asked before the work, not after it.

    Raises:
        InputError: an unknown suffix, or a format that polygons are not written in.
    """
    suffix = Path(path).suffix.lower()
    if suffix not in MOST_NODES:
        title = "Nastran" if suffix in NASTRAN else BY_SUFFIX[check_polygon_source(path)].title
        raise InputError(f"{path}: polygons are not written as {title}; write {' '.join(MOST_NODES)}")
    return suffix
