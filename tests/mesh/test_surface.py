"""The surface of a mesh, against the definition and against what every closed surface has."""

from itertools import combinations

import numpy as np
import pytest

from tests.meshes import mesh_of
from tests.oracle import OracleNet, signed_volume
from tetrabench.mesh.models import generate
from tetrabench.mesh.surface import find_surface


def naive(mesh):
    """Side -> the tetra behind it, for the sides of one tetra alone."""
    net = OracleNet(mesh.points, mesh.tets)
    return {
        frozenset(net.side(t, i)): t for t in range(len(mesh.tets)) for i in range(4) if net.neighbour(t, i) is None
    }


def test_against_the_definition(small_mesh):
    surface = find_surface(small_mesh.points, small_mesh.tets)
    found = {frozenset(side): t for side, t in zip(surface.triangles.tolist(), surface.tetras.tolist(), strict=True)}
    assert found == naive(small_mesh)
    assert len(found) == len(surface.triangles)
    assert surface.triangles.dtype == small_mesh.tets.dtype


def test_triangles_turn_away_from_their_tetra(small_mesh):
    surface = find_surface(small_mesh.points, small_mesh.tets)
    for side, t in zip(surface.triangles.tolist(), surface.tetras.tolist(), strict=True):
        (tip,) = set(small_mesh.tets[t].tolist()) - set(side)
        volume = signed_volume(*small_mesh.points[[*side, tip]].tolist())
        flat = signed_volume(*small_mesh.points[small_mesh.tets[t]].tolist()) == 0
        assert volume < 0 or flat


@pytest.mark.parametrize("turn", [False, True], ids=["as it is", "every other tetra inside out"])
@pytest.mark.parametrize("model", ["box", "nozzle", "intake"])
def test_closed_surface(model, turn):
    mesh = generate(model, 3000, seed=4)
    tets = mesh.tets.copy()
    if turn:
        tets[::2] = tets[::2][:, [1, 0, 2, 3]]
    surface = find_surface(mesh.points, tets)
    edges = {}
    for side in surface.triangles.tolist():
        for way in zip(side, side[1:] + side[:1], strict=True):
            edges[way] = edges.get(way, 0) + 1
    assert set(edges.values()) == {1}
    assert all((b, a) in edges for a, b in edges)  # as often there as back: closed, and turned alike
    assert len(np.unique(surface.triangles)) - len(edges) // 2 + len(surface.triangles) == 2  # Euler: no hole
    a, b, c = mesh.points[surface.triangles].transpose(1, 0, 2)
    volume = sum(abs(signed_volume(*mesh.points[tet].tolist())) for tet in tets)
    assert np.einsum("kx,kx->", a, np.cross(b, c)) / 6 == pytest.approx(volume)  # the theorem of Gauss


def test_areas_of_a_box():
    mesh = generate("box", 3000, seed=4)
    a, b, c = mesh.points[find_surface(mesh.points, mesh.tets).triangles].transpose(1, 0, 2)
    normals = np.cross(b - a, c - a) / 2
    x, y, z = np.ptp(mesh.points, axis=0)
    faces = np.array([y * z, x * z, x * y])
    np.testing.assert_allclose(np.maximum(normals, 0).sum(axis=0), faces)
    np.testing.assert_allclose(np.minimum(normals, 0).sum(axis=0), -faces)
    assert np.linalg.norm(normals, axis=1).sum() == pytest.approx(2 * faces.sum())


def test_no_tetra_has_no_surface():
    surface = find_surface(np.empty((0, 3)), np.empty((0, 4), np.int32))
    assert surface.triangles.shape == (0, 3)
    assert surface.tetras.shape == (0,)


def test_one_tetra_has_all_its_sides():
    mesh = mesh_of([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[3, 2, 1, 0]])
    triangles = find_surface(mesh.points, mesh.tets).triangles
    assert {frozenset(side) for side in triangles.tolist()} == set(map(frozenset, combinations(range(4), 3)))
