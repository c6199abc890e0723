"""The same tetras for all contestants, whatever the order of their iteration has become."""

import dataclasses

import numpy as np
import pytest

from tests.meshes import box, nozzle
from tetrabench import registry
from tetrabench.backends.tetra import CONTESTANTS
from tetrabench.io import write_mesh
from tetrabench.mesh.models import generate
from tetrabench.scenarios.tetra.base import first_refs, refs_in_order
from tetrabench.tetra.family import FAMILY
from tetrabench.tetra.net import TetraNet

NAMES = [contestant.name for contestant in CONTESTANTS]


@pytest.mark.parametrize("name", NAMES)
def test_refs_in_the_order_of_the_file(name, rng):
    """Tetras that went and came again stand elsewhere in the iteration, some with their vertices in another order."""
    mesh = nozzle()
    net = TetraNet(mesh, registry.contestant("tetra", name))
    np.testing.assert_array_equal(refs_in_order(net, mesh.tets), net.refs)
    rows = rng.permutation(len(net))
    gone, back = rows[: len(net) // 2], rows[: len(net) // 3]
    for t in net.refs[gone].tolist():
        net.delete(t)
    for corners in mesh.tets[back].tolist():
        net.insert(*rng.permutation(corners).tolist())
    far = [net.insert_point(9.0 + n, 8.0, n * n) for n in range(4)]
    net.insert(*far)  # of which the file knows nothing
    net.collect()
    there = np.delete(np.arange(len(mesh.tets)), gone[len(back) :])
    found = refs_in_order(net, mesh.tets)
    expected = np.sort(mesh.tets[there], axis=1)
    assert (np.sort(net.vertices[: len(there)], axis=1) != expected).any()  # the iteration has another order
    np.testing.assert_array_equal(np.sort([net.vertices_of(t) for t in found], axis=1), expected)


def test_nothing_to_find():
    net = TetraNet(box(), registry.contestant("tetra", "v3y"))
    assert refs_in_order(net, np.empty((0, 4), np.int32)).tolist() == []
    for t in net:
        net.delete(t)
    assert refs_in_order(net, box().tets).tolist() == []


def test_who_has_stable_refs_keeps_its_iteration_and_reads_no_file(tmp_path):
    path = tmp_path / "box.nas"
    write_mesh(generate("box", 100), path)
    contestant = registry.contestant("tetra", "v3y")
    stage = FAMILY.stage(contestant, path, chained=True)
    net = TetraNet(generate("box", 100), contestant)
    assert first_refs(stage, net, 5).tolist() == net.refs[:5].tolist()
    assert stage._mesh is None
    unstable = TetraNet(generate("box", 100), dataclasses.replace(contestant, stable_refs=False))
    corners = unstable.vertices_of(unstable.refs[1])
    unstable.delete(unstable.refs[1])
    again = (unstable.insert_point(50.0, 0.0, 0.0), *corners[1:])
    unstable.insert(*again)  # in the slot of the second: the file's order goes on without it
    assert unstable.vertices_of(unstable.refs[1]) == again
    assert first_refs(stage, unstable, 3).tolist() == unstable.refs[[0, 2, 3]].tolist()
