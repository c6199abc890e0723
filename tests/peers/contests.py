"""What is compared with which peer: the same work on the same mesh, both ways, and whether the answers agree."""

from collections.abc import Callable
from functools import cached_property, partial
from pathlib import Path
from typing import Any

import numpy as np

from tests.contest import Contest, Row
from tetrabench.backends.tetra import CONTESTANTS
from tetrabench.io import read_mesh, write_nastran
from tetrabench.mesh.incidence import vertex_tetras
from tetrabench.mesh.models import generate
from tetrabench.mesh.sides import side_neighbours
from tetrabench.scenarios.tetra.locate import points_near_sides
from tetrabench.tetra.nearest import build_tree, nearest_points
from tetrabench.tetra.net import TetraNet

V3Y = next(contestant for contestant in CONTESTANTS if contestant.name == "v3y")

ON_A_SIDE = 1e-9
"""How far outside a tetra, as a part of its volume, a point may lie that is said to be in it."""


class Case:
    """A mesh in one numbering, and what is made from it before any clock runs.

    Attributes:
        mesh: a box of jittered cubes, six tetras each.
        folder: where its files are put.
    """

    def __init__(self, tets: int, queries: int, numbering: str, folder: Path) -> None:
        self.mesh = generate("box", tets, numbering=numbering)
        self._numbering = numbering
        self._drawn = np.random.default_rng(20110501).permutation(len(self.mesh.tets))[:queries]
        self.folder = folder

    @cached_property
    def net(self) -> TetraNet:
        """The mesh on V3Y; its refs are the rows of `mesh.tets`."""
        net = TetraNet(self.mesh, V3Y)
        assert (net.refs == np.arange(len(net))).all()
        return net

    @cached_property
    def queries(self) -> Any:
        """(q, 3) float64, points of the scenario locate in random order.

        Each is in a tetra drawn at random, 0.5 % of the way from the centre of its side 0 to the vertex opposite it.
        """
        return points_near_sides(self.net.storage, self._drawn)

    def file(self, field: str) -> str:
        """Path of the mesh as Nastran bulk data, its points in "small" or "large" field.

        Tetras are in small field, as mesh generators write them (and meshio knows no other).
        """
        path = self.folder / f"{self._numbering}-{field}.bdf"  # a suffix that all readers know
        if not path.exists():
            write_nastran(self.mesh, path, field=field)
            if field == "large":
                points, _, _ = path.read_bytes().partition(b"CTETRA*")
                _, name, tets = Path(self.file("small")).read_bytes().partition(b"CTETRA")
                path.write_bytes(points + name + tets)
        return str(path)


# ---- reading Nastran


def read_beside_gmsh(field: str, case: Case, gmsh: Any) -> Contest:
    path = case.file(field)

    def theirs() -> Any:
        gmsh.merge(path)
        return gmsh.model.mesh.getNodes(), gmsh.model.mesh.getElementsByType(4)

    def differ(ours: Any, theirs: Any) -> str:
        (ids, xyz, _), (tet_ids, vertices) = theirs
        order = np.argsort(ids)
        rows = order[np.searchsorted(ids, vertices, sorter=order)].reshape(-1, 4)
        return (
            unequal(ids, ours.point_ids, "ids of the points")
            or unequal(tet_ids, ours.tet_ids, "ids of the tetras")
            or _different_meshes(ours, xyz.reshape(-1, 3), rows)
        )

    return Contest(partial(read_mesh, path), theirs, differ, gmsh.clear)


def read_beside_meshio(field: str, case: Case, meshio: Any) -> Contest:
    path = case.file(field)

    def differ(ours: Any, theirs: Any) -> str:
        return _different_meshes(ours, theirs.points, theirs.cells_dict["tetra"])

    return Contest(partial(read_mesh, path), partial(meshio.read, path), differ)


def _different_meshes(ours: Any, points: Any, tets: Any) -> str:
    return unequal(points, ours.points, "coordinates") or unequal(tets, ours.tets, "vertices of the tetras")


# ---- tables


def sides_beside_libigl(case: Case, igl: Any) -> Contest:
    tets = case.mesh.tets.astype(np.int64)  # the type that libigl takes without a copy
    opposite = [3, 2, 0, 1]  # the vertex opposite each of its faces 012, 013, 123, 203

    def differ(ours: Any, theirs: Any) -> str:
        return unequal(theirs[0], ours[:, opposite], "side neighbours")

    return Contest(partial(side_neighbours, case.mesh.tets), partial(igl.tet_tet_adjacency, tets), differ)


def vertex_tetras_beside_scipy(case: Case, scipy: Any) -> Contest:
    tets, points = case.mesh.tets, len(case.mesh.points)
    data = np.ones(tets.size, np.int8)  # scipy moves its values too: the smallest there are
    indptr = np.arange(0, tets.size + 1, 4, dtype=np.int32)
    shape = (len(tets), points)

    def theirs() -> Any:
        return scipy.sparse.csr_matrix((data, tets.ravel(), indptr), shape).tocsc()

    def differ(ours: Any, theirs: Any) -> str:
        starts, rows = ours
        vertices = np.repeat(np.arange(points), np.diff(starts))
        return unequal(theirs.indptr, starts, "numbers of tetras around the points") or unequal(
            np.sort(vertices << 32 | theirs.indices), np.sort(vertices << 32 | rows), "tetras around the points"
        )

    return Contest(partial(vertex_tetras, tets, points), theirs, differ)


# ---- searches


def nearest_beside_pynanoflann(case: Case, pynanoflann: Any) -> Contest:
    def theirs() -> Any:
        tree = pynanoflann.KDTree(n_neighbors=1, metric="L2", leaf_size=10)
        tree.fit(case.mesh.points)
        return tree.kneighbors(case.queries)[1][:, 0]

    return _nearest_beside(case, theirs)


def nearest_beside_scipy(case: Case, scipy: Any) -> Contest:
    def theirs() -> Any:
        return scipy.spatial.cKDTree(case.mesh.points).query(case.queries, workers=1)[1]

    return _nearest_beside(case, theirs)


def _nearest_beside(case: Case, theirs: Callable[[], Any]) -> Contest:
    points, queries = case.mesh.points, case.queries

    def ours() -> Any:
        return nearest_points(build_tree(points), points, queries)

    def distances(found: Any) -> Any:
        return np.linalg.norm(points[found.astype(np.int64)] - queries, axis=1)

    def differ(ours: Any, theirs: Any) -> str:
        same = np.isclose(distances(ours), distances(theirs), rtol=1e-12, atol=0)
        return "" if same.all() else f"{(~same).sum()} of {len(same)} distances differ"

    return Contest(ours, theirs, differ)


def locate_beside_vtk(case: Case, pyvista: Any) -> Contest:
    from vtkmodules.vtkCommonDataModel import vtkCellTreeLocator

    tets = {pyvista.CellType.TETRA: case.mesh.tets.astype(np.int64)}
    grid = pyvista.UnstructuredGrid(tets, case.mesh.points)
    queries = case.queries.tolist()  # what its calls take, made beforehand

    def theirs() -> Any:
        locator = vtkCellTreeLocator()
        locator.SetDataSet(grid)
        locator.BuildLocator()
        find = locator.FindCell
        return [find(query) for query in queries]

    def differ(ours: Any, theirs: Any) -> str:
        return misplaced(case, ours, "we") or misplaced(case, np.array(theirs), "VTK")

    return Contest(partial(case.net.locate, case.queries), theirs, differ)


def misplaced(case: Case, rows: Any, who: str) -> str:
    """How many query points do not lie in the tetra that they are said to be in."""
    corners = case.mesh.points[case.mesh.tets[rows]]
    whole = six_volumes(corners)
    inside = rows >= 0
    for i in range(4):
        moved = corners.copy()
        moved[:, i] = case.queries
        inside &= six_volumes(moved) * np.sign(whole) >= -ON_A_SIDE * np.abs(whole)
    return "" if inside.all() else f"{who} find {(~inside).sum()} of {len(rows)} points in a wrong tetra"


def six_volumes(corners: Any) -> Any:
    """Six times the signed volumes of tetras (n, 4, 3)."""
    edges = corners[:, 1:] - corners[:, :1]
    return np.einsum("ij,ij->i", edges[:, 0], np.cross(edges[:, 1], edges[:, 2]))


def unequal(theirs: Any, ours: Any, what: str) -> str:
    if theirs.shape != ours.shape:
        return f"{what}: {theirs.shape} beside our {ours.shape}"
    return "" if (theirs == ours).all() else f"{what} differ in {(theirs != ours).sum()} places"


ROWS = [
    Row("read-small", "natural", "gmsh", 1 / 3, partial(read_beside_gmsh, "small")),
    Row("read-small", "natural", "meshio", 1 / 20, partial(read_beside_meshio, "small")),
    Row("read-large", "natural", "gmsh", 1 / 3, partial(read_beside_gmsh, "large")),
    Row("read-large", "natural", "meshio", 1 / 20, partial(read_beside_meshio, "large")),
    Row("sides", "natural", "libigl", 0.3, sides_beside_libigl),
    Row("sides", "shuffled", "libigl", 0.4, sides_beside_libigl),
    Row("vertex-tetras", "natural", "scipy", 1.2, vertex_tetras_beside_scipy),
    Row("vertex-tetras", "shuffled", "scipy", 1.2, vertex_tetras_beside_scipy),
    Row("nearest", "natural", "pynanoflann", 1.0, nearest_beside_pynanoflann),
    Row("nearest", "shuffled", "pynanoflann", 1.0, nearest_beside_pynanoflann),
    Row("nearest", "natural", "scipy", None, nearest_beside_scipy),
    Row("nearest", "shuffled", "scipy", None, nearest_beside_scipy),
    Row("locate", "natural", "pyvista", 0.3, locate_beside_vtk),
    Row("locate", "shuffled", "pyvista", 0.3, locate_beside_vtk),
]
"""The bars of the project, each with its strongest peer."""
