"""What of ours is compared with what of CGAL's or of plain C++: the same work on the same arrays, and whether answers agree."""

from collections.abc import Callable
from functools import cached_property, partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tests.cgal.kernels import cube, nearest_to_centroid, touch_all, walk_all
from tests.cgal.library import Held, at, neighbours
from tests.contest import Contest, Row
from tetrabench.backends.tetra.halfface import Element, HalfFaceMesh
from tetrabench.backends.tetra.halfface.compound import base_mask
from tetrabench.backends.tetra.halfface.storage import HalfFaces
from tetrabench.mesh.models import generate

EDITED = 20_000
"""Tetras that are deleted, and added again; half of all where there are fewer."""

JITTER = 0.15
"""How far a point inside a jittered cube is moved along each axis, at most, in widths of a subcube."""


class Case:
    """A box of jittered cubes, six tetras each, in one numbering, and what is made from it before any clock runs.

    Attributes:
        functions: of the library.
        tets: (n, 4) int32. xyz: (vertices, 3) float64.
        edited: (k,) int64, tetras drawn at random.
    """

    def __init__(self, functions: Any, tets: int, numbering: str) -> None:
        mesh = generate("box", tets, numbering=numbering)
        self.functions = functions
        self.tets, self.xyz = np.ascontiguousarray(mesh.tets, np.int32), np.ascontiguousarray(mesh.points)
        self.edited = np.random.default_rng(20130522).permutation(len(self.tets))[: min(EDITED, len(self.tets) // 2)]

    @property
    def vertices(self) -> int:
        """How many there are."""
        return len(self.xyz)

    def construct(self) -> HalfFaceMesh:
        """Our mesh, without coordinates."""
        return HalfFaceMesh.construct_mesh(self.tets, self.vertices)

    @cached_property
    def mesh(self) -> HalfFaceMesh:
        """Our mesh, with its coordinates as an attribute; nobody changes it."""
        return with_coordinates(self.construct(), self.xyz)

    @cached_property
    def numbered(self) -> Held:
        """CGAL's triangulation, whose vertices and cells know their numbers."""
        build, free = self.functions.numbered_build, self.functions.numbered_free
        held = Held(build(at(self.tets), len(self.tets), at(self.xyz), self.vertices), free)
        assert self.functions.numbered_valid(held.pointer)
        return held

    @cached_property
    def table(self) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
        """The tetras around each vertex, as plain C++ lists them: starts (vertices + 1,), rows (4 n,)."""
        starts, rows = np.empty(self.vertices + 1, np.int32), np.empty(self.tets.size, np.int32)
        self.functions.plain_table(at(self.tets), len(self.tets), self.vertices, at(starts), at(rows))
        return starts, rows

    @cached_property
    def ascending(self) -> NDArray[np.int32]:
        """(n, 4) int32, the vertices of each tetra in order."""
        return np.sort(self.tets, axis=1)


class Cube:
    """A unit cube of subcubes, six tetras each, and its points, made by plain C++.

    Attributes:
        jitter: how far points inside are moved along each axis, at most, in widths of a subcube.
    """

    def __init__(self, functions: Any, jitter: float) -> None:
        self._functions, self._jitter = functions, jitter

    def make(self, side: int) -> tuple[NDArray[np.int32], NDArray[np.float64]]:
        """tets (6 side^3, 4) int32, xyz ((side + 1)^3, 3) float64."""
        tets, xyz = room_for_cube(side)
        self._functions.plain_cube(side, at(tets), at(xyz))
        return tets, xyz

    def points(self, side: int) -> NDArray[np.float64]:
        """((side + 1)^3, 3) float64, moved as they shall be."""
        xyz = self.make(side)[1]
        inside = (np.abs(xyz - 0.5) < 0.5).all(axis=1, keepdims=True)
        moved = np.random.default_rng(20130522).uniform(-1, 1, xyz.shape) * self._jitter / side
        return xyz + moved * inside


def room_for_cube(side: int) -> tuple[NDArray[np.int32], NDArray[np.float64]]:
    """What a cube is written into."""
    return np.empty((6 * side**3, 4), np.int32), np.empty(((side + 1) ** 3, 3))


def with_coordinates(mesh: HalfFaceMesh, xyz: NDArray[np.float64]) -> HalfFaceMesh:
    """The mesh, with the attribute "xyz"."""
    mesh.add_attribute(Element.VERTEX, "xyz", shape=(3,)).values[:] = xyz
    return mesh


def our_neighbours(mesh: HalfFaceMesh, tets: NDArray[np.int32]) -> NDArray[np.int64]:
    """(n, 4) int64, the tetra behind the side opposite each vertex, -1 where there is none."""
    words, largest = mesh.storage.adjacency.astype(np.int64), int(base_mask(mesh.storage.adjacency))
    behind = np.where(words <= largest, -1, words & largest)  # on the border the extension is 0
    return np.take_along_axis(behind, 3 - tets.argsort(axis=1).argsort(axis=1), axis=1)


# ---- construct


def construct_beside(kind: str, case: Case, functions: Any) -> Contest:
    """Beside CGAL's structure, filled by hand ("bare") or by its own call ("call")."""
    arguments = {"bare": (case.vertices,), "call": (at(case.xyz), case.vertices)}[kind]
    build, free = getattr(functions, f"{kind}_build"), getattr(functions, f"{kind}_free")

    def theirs() -> Held:
        return Held(build(at(case.tets), len(case.tets), *arguments), free)

    def differ(ours: HalfFaceMesh, theirs: Held) -> str:
        if not getattr(functions, f"{kind}_valid")(theirs.pointer):
            return "CGAL's structure is not valid"
        table = neighbours(functions, kind, theirs, len(case.tets))
        return unequal(our_neighbours(ours, case.tets), table, "side neighbours") or unsound(ours)

    return Contest(case.construct, theirs, differ)


def construct_beside_c(case: Case, functions: Any) -> Contest:
    def theirs() -> NDArray[np.int32]:
        opposite = np.empty_like(case.tets)
        functions.plain_sides(at(case.tets), len(case.tets), case.vertices, at(opposite))
        return opposite

    def differ(ours: HalfFaceMesh, theirs: NDArray[np.int32]) -> str:
        return unequal(our_neighbours(ours, case.tets), theirs >> 2, "side neighbours")

    return Contest(case.construct, theirs, differ)


# ---- generate


def generate_ours(points: NDArray[np.float64], side: int) -> HalfFaceMesh:
    """Connectivity and coordinates by formula, and construct; then moved to where the points are."""
    tets, xyz = room_for_cube(side)
    cube(side, tets, xyz)
    return with_coordinates(HalfFaceMesh.construct_mesh(tets, len(xyz)), points)


def generate_beside_delaunay(side: int, case: Cube, functions: Any) -> Contest:
    points = case.points(side)

    def theirs() -> Held:
        return Held(functions.delaunay_build(at(points), len(points)), functions.delaunay_free)

    def differ(ours: HalfFaceMesh, theirs: Held) -> str:
        if not functions.delaunay_valid(theirs.pointer):
            return "CGAL's triangulation is not valid"
        volumes = whole_volume(ours), functions.delaunay_volume(theirs.pointer)
        vertices = ours.n_vertices, functions.delaunay_vertices(theirs.pointer)
        if vertices[0] != vertices[1] or not np.allclose(volumes, 1.0, rtol=1e-9):
            return f"{vertices} vertices, volumes {volumes}"
        return unsound(ours)

    return Contest(partial(generate_ours, points, side), theirs, differ)


def generate_beside(kind: str, side: int, case: Cube, functions: Any) -> Contest:
    points = case.points(side)
    build, free = getattr(functions, f"{kind}_build"), getattr(functions, f"{kind}_free")

    def theirs() -> Held:
        tets, xyz = case.make(side)
        coordinates = {"bare": (), "call": (at(xyz),)}[kind]
        return Held(build(at(tets), len(tets), *coordinates, len(xyz)), free)

    def differ(ours: HalfFaceMesh, theirs: Held) -> str:
        tets, _ = case.make(side)
        table = neighbours(functions, kind, theirs, len(tets))
        return unequal(our_neighbours(ours, tets), table, "side neighbours") or unsound(ours)

    return Contest(partial(generate_ours, points, side), theirs, differ)


def whole_volume(mesh: HalfFaceMesh) -> float:
    """Of all tetras, as they were given."""
    corners = mesh.attribute("xyz")[mesh.connectivity]
    edges = corners[:, 1:] - corners[:, :1]
    return float(np.linalg.det(edges).sum() / 6)


# ---- example 1


def centroid_beside(case: Case, functions: Any, theirs: Callable[[], float]) -> Contest:
    xyz = case.mesh.attribute("xyz").values

    def ours() -> float:
        return float(nearest_to_centroid(case.mesh.storage, xyz))

    def differ(ours: float, theirs: float) -> str:
        return "" if abs(ours - theirs) <= 1e-12 * theirs else f"volume {ours} beside {theirs}"

    return Contest(ours, theirs, differ)


def centroid_beside_cgal(case: Case, functions: Any) -> Contest:
    held = case.numbered
    return centroid_beside(case, functions, lambda: functions.numbered_centroid(held.pointer))


def centroid_beside_c(case: Case, functions: Any) -> Contest:
    arguments = at(case.tets), len(case.tets), at(case.xyz)
    return centroid_beside(case, functions, partial(functions.plain_centroid, *arguments))


# ---- the tetras around all vertices


def walk_beside(kernel: Callable[..., Any], theirs: Callable[[int], int], case: Case) -> Contest:
    """`theirs` takes the address of a counter of visits."""

    def ours() -> tuple[int, int]:
        total, visits = kernel(case.mesh.storage, case.vertices)
        return int(total), int(visits)

    def counted() -> tuple[int, int]:
        visits = np.zeros(1, np.int64)
        return theirs(at(visits)), int(visits[0])

    def differ(ours: tuple[int, int], theirs: tuple[int, int]) -> str:
        return "" if ours == theirs and ours[1] == case.tets.size else f"sum and visits {ours} beside {theirs}"

    return Contest(ours, counted, differ)


def walk_beside_table(kernel: Callable[..., Any], build: bool, case: Case, functions: Any) -> Contest:
    """Beside a table in C++, `build`: made each time."""
    starts, rows = (array.copy() for array in case.table)
    ascending = case.ascending

    def theirs(visits: int) -> int:
        if build:
            functions.plain_table(at(case.tets), len(case.tets), case.vertices, at(starts), at(rows))
        if kernel is touch_all:
            return int(functions.plain_touch(at(starts), at(rows), case.vertices, at(ascending), visits))
        return int(functions.plain_walk(at(starts), at(rows), case.vertices, visits))

    return walk_beside(kernel, theirs, case)


def walk_beside_cgal(kernel: Callable[..., Any], case: Case, functions: Any) -> Contest:
    held, function = case.numbered, functions.numbered_touch if kernel is touch_all else functions.numbered_walk
    return walk_beside(kernel, lambda visits: int(function(held.pointer, visits)), case)


def list_beside_table(case: Case, functions: Any) -> Contest:
    """All tetras around all vertices as a table, beside the same in C++."""
    vertices, starts, rows = np.arange(case.vertices), *(np.empty_like(array) for array in case.table)

    def ours() -> Any:
        return case.mesh.one_to_all_many(Element.TETRAHEDRON, Element.VERTEX, vertices)

    def theirs() -> tuple[NDArray[np.int32], NDArray[np.int32]]:
        functions.plain_table(at(case.tets), len(case.tets), case.vertices, at(starts), at(rows))
        return starts, rows

    def differ(ours: tuple[NDArray[Any], ...], theirs: tuple[NDArray[Any], ...]) -> str:
        return unequal(ours[0], theirs[0], "numbers of tetras") or unequal(ours[1], theirs[1], "tetras around vertices")

    return Contest(ours, theirs, differ)


# ---- edits


def edit_beside_cgal(add: bool, case: Case, functions: Any) -> Contest:
    """Flag some tetras and collect, or add them again, beside as many pairs of delete_cell and create_cell.

    Ours begins each time with a copy of the same arrays. CGAL's structure is as it was after each pair, but goes on with
    other cells each time, drawn after a look at all of them: neither finds in the cache what it did the last time.
    """
    bare = Held(functions.bare_build(at(case.tets), len(case.tets), case.vertices), functions.bare_free)
    rng = np.random.default_rng(20130522)

    def choose() -> None:
        others = rng.permutation(len(case.tets))[: len(case.edited)]
        functions.bare_choose(bare.pointer, at(others), len(others))

    choose()
    mesh = case.construct()
    if add:
        mesh.set_delete_flags(case.edited)
        mesh.garbage_collect()
    pristine, rows = copied(mesh.storage), case.tets[case.edited]

    def fresh() -> None:
        mesh._faces = copied(pristine)  # what no user can: to go back

    def ours() -> HalfFaceMesh:
        if add:
            mesh.add_tetrahedra(rows)
        else:
            mesh.set_delete_flags(case.edited)
            mesh.garbage_collect()
        return mesh

    def differ(ours: HalfFaceMesh, replaced: int) -> str:
        if not functions.bare_valid(bare.pointer) or replaced != len(rows):
            return "CGAL's structure is not valid"
        wanted = case.tets if add else np.delete(case.tets, case.edited, axis=0)
        return unequal(in_order(ours.connectivity), in_order(wanted), "tetras") or unsound(ours)

    return Contest(ours, lambda: functions.bare_replace(bare.pointer), differ, tidy=choose, fresh=fresh)


def copied(faces: HalfFaces) -> HalfFaces:
    """The same storage in arrays of its own."""
    return HalfFaces(*(array.copy() for array in faces))


def in_order(tets: NDArray[Any]) -> NDArray[Any]:
    """The rows (n, 4), whatever their order."""
    return tets[np.lexsort(tets.T)]


# ---- judges


def unequal(ours: NDArray[Any], theirs: NDArray[Any], what: str) -> str:
    if ours.shape != theirs.shape:
        return f"{what}: {theirs.shape} beside our {ours.shape}"
    return "" if (ours == theirs).all() else f"{what} differ in {(ours != theirs).sum()} places"


def unsound(ours: HalfFaceMesh) -> str:
    return "; ".join(ours.check())


NUMBERINGS = ("natural", "shuffled")
CUBES = {"grid": 0.0, "jittered": JITTER}
"""What stands in the column of numberings for cubes."""


def _rows() -> list[Row]:
    rows = []
    for numbering in NUMBERINGS:
        bar = 3.0 if numbering == "shuffled" else None
        rows.append(Row("construct", numbering, "c", bar, construct_beside_c))
        rows.append(Row("construct", numbering, "cgal", None, partial(construct_beside, "bare")))
        rows.append(Row("construct", numbering, "cgal-call", None, partial(construct_beside, "call")))
    for side in (12, 10):
        name = f"generate-{side}"
        rows += [Row(name, cube, "delaunay", 0.5, partial(generate_beside_delaunay, side)) for cube in CUBES]
        rows.append(Row(name, "grid", "cgal", None, partial(generate_beside, "bare", side)))
        rows.append(Row(name, "grid", "cgal-call", None, partial(generate_beside, "call", side)))
    for numbering in NUMBERINGS:
        rows.append(Row("centroid", numbering, "cgal", 0.8, centroid_beside_cgal))
        rows.append(Row("centroid", numbering, "c", None, centroid_beside_c))
    for name, kernel, bar in (("around", touch_all, 2.0), ("around-ids", walk_all, None)):
        for numbering in NUMBERINGS:
            rows.append(Row(name, numbering, "table", bar, partial(walk_beside_table, kernel, False)))
            rows.append(Row(name, numbering, "table-made", None, partial(walk_beside_table, kernel, True)))
            rows.append(Row(name, numbering, "cgal", None, partial(walk_beside_cgal, kernel)))
    rows += [Row("list-around", numbering, "table-made", None, list_beside_table) for numbering in NUMBERINGS]
    rows.append(Row("collect", "shuffled", "cgal", 2.0, partial(edit_beside_cgal, False)))
    rows.append(Row("add", "shuffled", "cgal", 6.0, partial(edit_beside_cgal, True)))
    return rows


ROWS = _rows()
"""The bars of the half-face kernel beside CGAL, and what is there for orientation."""


def peers_of(functions: Any) -> tuple[dict[str, Any], dict[str, str]]:
    """The peers that there are, by name, and why the others are missing."""
    peers = dict.fromkeys(dict.fromkeys(row.peer for row in ROWS), functions)
    missing = {}
    if not functions.call_there():
        del peers["cgal-call"]
        missing["cgal-call"] = "this CGAL has no Mesh_3/tet_soup_to_c3t3.h, as 5.5 has"
    return peers, missing
