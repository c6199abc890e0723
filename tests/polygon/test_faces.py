"""The faces-format: lists beside sets that are made by looking everywhere, volumes, Euler's formula, what is refused."""

from itertools import pairwise

import numpy as np
import pytest

from tetrabench.backends.polygon.faces import (
    cell_faces,
    cell_neighbours,
    cell_nodes,
    face_nodes,
    make_faces,
    node_cells,
    node_neighbours,
)
from tetrabench.errors import InputError
from tetrabench.mesh.polygon import PolygonMesh
from tetrabench.mesh.polygon.models import generate_polygons
from tetrabench.mesh.polyhedron import PolyhedronMesh, extrude

HEIGHTS = [0.0, 0.25, 1.0, 1.5]


def columns(model: str) -> PolyhedronMesh:
    return extrude(generate_polygons(model, 12, seed=1), HEIGHTS, below=-7, above=-8)


def one_tetra() -> PolyhedronMesh:
    faces = [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]]
    points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    return PolyhedronMesh(
        points, np.arange(0, 13, 3, np.int32), np.array(faces, np.int32).ravel(), np.array([[-1, 0]] * 4, np.int32)
    )


MESHES = {model: lambda model=model: columns(model) for model in ("triangle", "quad", "hexagon", "voronoi")}
MESHES["tetra"] = one_tetra


@pytest.fixture(params=MESHES)
def mesh(request) -> PolyhedronMesh:
    return MESHES[request.param]()


def faces_of(mesh: PolyhedronMesh) -> list[list[int]]:
    return [mesh.nodes[begin:end].tolist() for begin, end in pairwise(mesh.starts)]


def asked(query, storage, element: int) -> list[int]:
    out = np.zeros(400, np.int32)
    return out[: query(storage, element, out)].tolist()


def test_lists_are_those_of_a_naive_twin(mesh):
    storage, faces, cells = make_faces(mesh), faces_of(mesh), mesh.cells.tolist()
    bounds = [[f for f in range(len(faces)) if c in cells[f]] for c in range(mesh.number_of_cells)]
    for f, nodes in enumerate(faces):
        assert asked(face_nodes, storage, f) == nodes
    for c, around in enumerate(bounds):
        found = asked(cell_faces, storage, c)
        assert sorted(found) == around
        assert asked(cell_neighbours, storage, c) == [cells[f][1 - cells[f].index(c)] for f in found]
        nodes = asked(cell_nodes, storage, c)
        assert len(nodes) == len(set(nodes))
        assert set(nodes) == {v for f in around for v in faces[f]}
    edges = {frozenset(side) for nodes in faces for side in zip(nodes, nodes[1:] + nodes[:1], strict=True)}
    for v in range(len(mesh.points)):
        found = asked(node_cells, storage, v)
        assert len(found) == len(set(found))
        assert set(found) == {c for c, around in enumerate(bounds) if any(v in faces[f] for f in around)}
        found = asked(lambda net, node, out: node_neighbours(net, node, np.zeros(400, np.int32), out), storage, v)
        assert len(found) == len(set(found))
        assert {frozenset([v, w]) for w in found} == {edge for edge in edges if v in edge}
    assert len(mesh.points) - len(edges) + len(faces) - mesh.number_of_cells == 1  # Euler, Poincaré


def test_faces_look_into_their_first_cells_and_cells_fill_the_domain(mesh):
    volumes = np.zeros(mesh.number_of_cells)
    for nodes, (first, second) in zip(faces_of(mesh), mesh.cells, strict=True):
        a, *rest = mesh.points[nodes]
        flux = sum(np.dot(a, np.cross(b - a, c - a)) for b, c in pairwise(rest)) / 6  # Gauss: a third of x . n
        volumes[second] += flux
        if first >= 0:
            volumes[first] -= flux
    assert (volumes > 0).all()
    assert volumes.sum() == pytest.approx(1 / 6 if len(volumes) == 1 else 1.5, rel=1e-12)


def test_values_are_those_of_the_formula_and_boundary_comes_first(mesh):
    storage = make_faces(mesh)
    corners, sides = len(mesh.nodes), np.count_nonzero(mesh.cells >= 0)
    assert sum(array.size for array in storage) == (
        sides + 2 * mesh.number_of_cells + corners + 4 * len(mesh.cells) + len(mesh.points)
    )
    assert {array.dtype for array in storage} == {np.dtype(np.int32)}
    assert (storage.face[:, 1] >= 0).all()
    outside = np.unique([v for nodes, (c, _) in zip(faces_of(mesh), mesh.cells, strict=True) if c < 0 for v in nodes])
    assert (storage.face[storage.node_face[outside], 0] < 0).all()
    for v, f in enumerate(storage.node_face):
        assert v in faces_of(mesh)[f]


def test_columns_keep_the_conditions():
    plane = generate_polygons("quad", 4)
    mesh = extrude(plane, [0.0, 1.0, 2.0], below=-7, above=-8)
    conditions, counts = np.unique(mesh.cells[:, 0][mesh.cells[:, 0] < 0], return_counts=True)
    assert dict(zip(conditions.tolist(), counts.tolist(), strict=True)) == {-8: 4, -7: 4, -4: 4, -3: 4, -2: 4, -1: 4}


def broken(part: str) -> PolyhedronMesh:
    mesh = columns("quad")
    match part:
        case "a face turned over":
            mesh.nodes[mesh.starts[5] : mesh.starts[6]] = mesh.nodes[mesh.starts[5] : mesh.starts[6]][::-1].copy()
        case "a face missing":
            mesh.starts, mesh.nodes, mesh.cells = mesh.starts[:-1], mesh.nodes[: mesh.starts[-2]], mesh.cells[:-1]
        case "a face twice":
            mesh.starts = np.append(mesh.starts, mesh.starts[-1] + 4).astype(np.int32)
            mesh.nodes, mesh.cells = np.append(mesh.nodes, mesh.nodes[-4:]), np.append(mesh.cells, mesh.cells[-1:], 0)
        case "a node that is not there":
            mesh.nodes[0] = len(mesh.points)
        case "no second cell":
            mesh.cells[0] = mesh.cells[0, ::-1]
        case "a cell without faces":
            mesh.cells[mesh.cells == 3] = 1000
        case "starts of others":
            mesh.starts = mesh.starts[:-1]
    return mesh


@pytest.mark.parametrize(
    "part",
    [
        "a face turned over",
        "a face missing",
        "a face twice",
        "a node that is not there",
        "no second cell",
        "a cell without faces",
        "starts of others",
    ],
)
def test_what_is_no_mesh_of_polyhedra_is_refused(part):
    with pytest.raises(InputError):
        make_faces(broken(part))


def test_columns_stand_on_plane_meshes_and_rise():
    plane = generate_polygons("quad", 4)
    for heights in ([0.0], [0.0, 0.0], [1.0, 0.0], [[0.0, 1.0]]):
        with pytest.raises(InputError, match="rise from each of two or more heights"):
            extrude(plane, heights)
    raised = PolygonMesh(
        np.column_stack([plane.points, plane.points[:, 0]]), plane.starts, plane.nodes, plane.conditions
    )
    with pytest.raises(InputError, match="in the plane"):
        extrude(raised, [0.0, 1.0])
