"""The examples of the half-face thesis beside peers: the tetra in the middle of a mesh, and a cube with its adjacency.

Ours is the scenario on V3Y, which makes more of a cube than asked for (geometry, a search tree, lists); rows that end in -hf
are the same on the half-face mesh with coordinates as its attribute. Peers are used as somebody would who knows them.
"""

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from contests import V3Y, Case, six_volumes, unequal
from numpy.typing import NDArray

from tests.cgal.contests import our_neighbours, with_coordinates
from tests.cgal.kernels import nearest_to_centroid
from tests.contest import Contest, Row
from tetrabench.backends.tetra.halfface import HalfFaceMesh
from tetrabench.mesh.models.box import cut_cubes
from tetrabench.scenarios.tetra.centroid import Centroid
from tetrabench.scenarios.tetra.generate import Generate, Order, cube

CUBES = 12

# ---- construct


def construct_beside_libigl(case: Case, igl: Any) -> Contest:
    """The whole half-face mesh beside the adjacency of its tetras alone."""
    tets = case.mesh.tets.astype(np.int64)  # the type that libigl takes without a copy
    opposite = [3, 2, 0, 1]  # the vertex opposite each of its faces 012, 013, 123, 203

    def differ(ours: HalfFaceMesh, theirs: Any) -> str:
        return unequal(theirs[0], our_neighbours(ours, case.mesh.tets)[:, opposite], "side neighbours")

    construct = partial(HalfFaceMesh.construct_mesh, case.mesh.tets, len(case.mesh.points))
    return Contest(construct, partial(igl.tet_tet_adjacency, tets), differ)


# ---- centroid


def beside(theirs: Callable[[Case, Any], Callable[[], Any]], case: Case, peer: Any) -> Contest:
    """The scenario on V3Y. The volume tells who was found: in the box of a case no two are equal."""
    net, scenario = case.net, Centroid()
    return Contest(lambda: float(scenario.run(net).volume), theirs(case, peer), _other_volume)


def halffaces_beside(theirs: Callable[[Case, Any], Callable[[], Any]], case: Case, peer: Any) -> Contest:
    mesh = with_coordinates(HalfFaceMesh.construct_mesh(case.mesh.tets, len(case.mesh.points)), case.mesh.points)
    xyz = mesh.attribute("xyz").values
    return Contest(lambda: float(nearest_to_centroid(mesh.storage, xyz)), theirs(case, peer), _other_volume)


def _other_volume(ours: float, theirs: float) -> str:
    return "" if abs(ours - theirs) <= 1e-12 * ours else f"volume {theirs} beside our {ours}"


def middle_with_meshio(case: Case, meshio: Any) -> Callable[[], Any]:
    """Arrays as meshio holds them, and numpy."""
    mesh = meshio.Mesh(case.mesh.points, {"tetra": case.mesh.tets})

    def middle() -> Any:
        corners = mesh.points[mesh.cells_dict["tetra"]]
        return _volume_in_the_middle(corners.mean(axis=1), np.abs(six_volumes(corners)) / 6)

    return middle


def middle_with_scipy(case: Case, scipy: Any) -> Callable[[], Any]:
    """Centroids as a sparse matrix times the points; it has no fast way to volumes, so they are numpy's."""
    points, tets = case.mesh.points, case.mesh.tets
    starts = np.arange(0, tets.size + 1, 4, dtype=np.int32)
    mean = scipy.sparse.csr_matrix((np.full(tets.size, 0.25), tets.ravel(), starts), (len(tets), len(points)))

    def middle() -> Any:
        return _volume_in_the_middle(mean @ points, np.abs(six_volumes(points[tets])) / 6)

    return middle


def middle_with_skfem(case: Case, skfem: Any) -> Callable[[], Any]:
    """One quadrature point a tetra: it lies in the centroid, and its weight is the volume.

    The mapping is made anew, since a mesh keeps its own, and the volumes with it.
    """
    mesh = skfem.MeshTet(np.ascontiguousarray(case.mesh.points.T), np.ascontiguousarray(case.mesh.tets.T))

    def middle() -> Any:
        basis = skfem.Basis(mesh, skfem.ElementTetP0(), mapping=skfem.MappingAffine(mesh), intorder=1)
        return _volume_in_the_middle(np.asarray(basis.global_coordinates())[:, :, 0].T, basis.dx[:, 0])

    return middle


def _volume_in_the_middle(centroids: Any, volumes: Any) -> Any:
    """Of the tetra nearest to the mean of the centroids (n, 3), weighted by the volumes (n,)."""
    away = centroids - np.average(centroids, axis=0, weights=volumes)  # no BLAS: numpy's is loaded with all its threads
    return volumes[np.einsum("ij,ij->i", away, away).argmin()]


# ---- generate


def cube_beside(
    theirs: Callable[[Any], Any], differ: Callable[[Any, Any], str], halffaces: bool, case: Case, peer: Any
) -> Contest:
    """A cube of CUBES^3 subcubes. `differ` takes the table of our side neighbours (n, 4), -1 on the surface, and theirs."""
    _, tets = cube(CUBES)

    def our_halffaces() -> HalfFaceMesh:
        points, tets = cube(CUBES)
        return with_coordinates(HalfFaceMesh.construct_mesh(tets, len(points)), points)

    def judge(ours: Any, theirs: Any) -> str:
        return differ(our_neighbours(ours, tets) if halffaces else ours.neighbours, theirs)

    ours = our_halffaces if halffaces else partial(Generate().run, Order(V3Y, CUBES))
    return Contest(ours, partial(theirs, peer), judge)


def cube_with_numpy(numpy: Any) -> Any:
    """The same formula; all sides sorted, each as one number, and equal ones are neighbours."""
    grid, tets = cut_cubes(CUBES, CUBES, CUBES)
    a, b, c = numpy.sort(tets[:, [[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]]].reshape(-1, 3), axis=1).T.astype(int)
    sides = (a * len(grid) + b) * len(grid) + c
    order = sides.argsort()
    met = numpy.flatnonzero(sides[order[1:]] == sides[order[:-1]])
    one, other = order[met], order[met + 1]
    neighbours = numpy.full(tets.size, -1)
    neighbours[one], neighbours[other] = other // 4, one // 4
    return neighbours.reshape(-1, 4)


def not_that_table(ours: NDArray[np.int64], theirs: NDArray[np.int64]) -> str:
    return unequal(theirs, ours, "side neighbours")


def cube_with_skfem(skfem: Any) -> Any:
    """Cut along the same diagonals as ours; `f2t` are the tetras on both sides of each face."""
    line = np.linspace(0.0, 1.0, CUBES + 1)
    mesh = skfem.MeshTet.init_tensor(line, line, line)
    return mesh.p, mesh.t, mesh.f2t


def not_those_pairs(ours: NDArray[np.int64], theirs: Any) -> str:
    """Tetras are told by their points, and points by their coordinates: ids and order are another's there."""
    points, tets, pairs = theirs
    ids = np.rint(points * CUBES).astype(np.int64).T @ (CUBES + 1) ** np.arange(3)
    own = cube(CUBES)[1]
    rows = np.arange(ours.size) // 4
    kept = ours.ravel() < rows  # each pair once, and the surface
    our_pairs = _pairs(np.sort(own, axis=1), np.stack([rows, ours.ravel()])[:, kept])
    return unequal(_pairs(np.sort(ids[tets.T], axis=1), pairs), our_pairs, "pairs of tetras")


def _pairs(tets: Any, pairs: Any) -> Any:
    """Pairs (2, m) of tetras, the second -1 for none, as points (m, 2, 4) in one order."""
    points = np.concatenate([tets, np.full((1, 4), -1)])[pairs.T]
    within = np.lexsort(points.transpose(2, 0, 1)[::-1])
    both = np.take_along_axis(points, within[:, :, None], axis=1).reshape(-1, 8)
    return both[np.lexsort(both.T[::-1])]


def cube_with_scipy(scipy: Any) -> Any:
    """Delaunay of the same points, which is all that it has. Any triangulation of a subcube is Delaunay."""
    points, _ = cube(CUBES)
    mesh = scipy.spatial.Delaunay(points)
    return mesh.points, mesh.simplices, mesh.neighbors


def not_a_cube(ours: NDArray[np.int64], theirs: Any) -> str:
    """It may be cut in other tetras than ours, flat ones among them, but fills the cube, with as many sides around it."""
    points, tets, neighbours = theirs
    volume = np.abs(six_volumes(points[tets])).sum() / 6
    if abs(volume - 1) > 1e-9:
        return f"a volume of {volume}"
    surface, its_surface = (int((table < 0).sum()) for table in (ours, neighbours))
    return "" if surface == its_surface else f"{its_surface} sides on the surface beside our {surface}"


MIDDLES = {"meshio": middle_with_meshio, "scikit-fem": middle_with_skfem, "scipy": middle_with_scipy}

GENERATED = {
    "numpy": (cube_with_numpy, not_that_table),
    "scikit-fem": (cube_with_skfem, not_those_pairs),
    "scipy": (cube_with_scipy, not_a_cube),
}

EXAMPLES = (
    [Row("construct-hf", numbering, "libigl", 1.0, construct_beside_libigl) for numbering in ("natural", "shuffled")]
    + [
        Row(operation, numbering, peer, None, partial(contest, theirs))
        for operation, contest in (("centroid", beside), ("centroid-hf", halffaces_beside))
        for numbering in ("natural", "shuffled")
        for peer, theirs in MIDDLES.items()
    ]
    + [
        Row(operation, "natural", peer, None, partial(cube_beside, theirs, differ, halffaces))
        for operation, halffaces in (("generate", False), ("generate-hf", True))
        for peer, (theirs, differ) in GENERATED.items()
    ]
)
"""For orientation, but for the first: the bars of these examples are beside CGAL (tests/cgal)."""
