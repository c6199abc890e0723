"""Around a point of very many tetras, on every contestant; what else the interface asks is in `tetra.conformance`."""

import numpy as np
import pytest

from tests.meshes import mesh_of
from tests.oracle import OracleNet
from tetrabench.backends.tetra import CONTESTANTS
from tetrabench.tetra.net import TetraNet


@pytest.mark.parametrize("contestant", CONTESTANTS, ids=lambda contestant: contestant.name)
def test_around_a_point_of_many_tetras(contestant):
    """More than `tetras_around` expects: a fan of 200 around an axis, between points on a circle."""
    angles = np.linspace(0.0, 2 * np.pi, 200, endpoint=False)
    circle = np.column_stack([np.cos(angles), np.sin(angles), np.zeros(200)])
    tets = [[0, 1, 2 + n, 2 + (n + 1) % 200] for n in range(200)]
    mesh = mesh_of([[0, 0, -1], [0, 0, 1], *circle.tolist()], tets)
    net, oracle = TetraNet(mesh, contestant), OracleNet(mesh.points, mesh.tets)
    assert sorted(net.tetras_around(0)) == sorted(net.refs.tolist())
    assert len(oracle.around(0)) == 200
    np.testing.assert_array_equal(net.locate(net.centroids, "source"), net.refs)
    assert net.check() == []
