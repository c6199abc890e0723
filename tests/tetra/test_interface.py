"""What is around a point, on every contestant, beside the oracle: in fresh nets, and after edits of every kind."""

import numpy as np
import pytest

from tests.meshes import MESHES, mesh_of, nozzle
from tests.oracle import OracleNet
from tetrabench import registry
from tetrabench.backends.tetra import CONTESTANTS
from tetrabench.jit import kernel
from tetrabench.tetra import edit, interface
from tetrabench.tetra.interface import NONE
from tetrabench.tetra.net import TetraNet

NAMES = [contestant.name for contestant in CONTESTANTS]


@kernel
def a_tetra_around(net, point):
    return interface.a_tetra_around(net, point)


@kernel
def fill_around(net, point, buffer):
    return interface.fill_around(net, point, buffer)


def build(name, mesh):
    return TetraNet(mesh, registry.contestant("tetra", name)), OracleNet(mesh.points, mesh.tets)


def assert_the_same_around(net, oracle):
    refs = net.refs.tolist()
    known = {net.vertices_of(ref): ref for ref in refs}
    for point in range(net.number_of_points):
        expected = {known[oracle.tetras[t]] for t in oracle.around(point)}
        one = a_tetra_around(net.storage, point)
        assert one in expected if expected else one == NONE
        assert sorted(interface.tetras_around(net.storage, point).tolist()) == sorted(expected)
        for size in {0, 1, len(expected) - 1, len(expected), len(expected) + 3} - {-1}:
            buffer = np.full(size + 2, -7)
            count = fill_around(net.storage, point, buffer[:size])
            assert count == len(expected) if size >= len(expected) else count > size
            stored = buffer[: min(size, len(expected))].tolist()
            assert set(stored) <= expected
            assert len(set(stored)) == len(stored)
            assert (buffer[len(stored) :] == -7).all()  # nothing beyond what there is, nor beyond the buffer


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("mesh", sorted(MESHES))
def test_around_the_points_of_a_fresh_net(name, mesh):
    net, oracle = build(name, MESHES[mesh]())
    assert_the_same_around(net, oracle)


@pytest.mark.parametrize("name", NAMES)
def test_around_points_after_edits(name, rng):
    net, oracle = build(name, nozzle())
    known = dict(zip(oracle.tetras, net.refs.tolist(), strict=True))
    gone = rng.permutation(list(oracle.tetras))[: len(net) // 3].tolist()
    for t in gone:
        interface.delete_tetra(net.storage, known[t])  # where a deletion waits, nothing of it must be seen
    vertices = [oracle.tetras[t] for t in gone]
    for t in gone:
        oracle.delete(t)
    assert_the_same_around(net, oracle)
    for corners in vertices[::2]:
        net.insert(*corners)
        oracle.insert(corners)
    assert net.insert_point(9.0, 9.0, 9.0) == oracle.insert_point((9.0, 9.0, 9.0))
    assert_the_same_around(net, oracle)
    for t in list(oracle.tetras)[:5]:
        ref = next(ref for ref in net if net.vertices_of(ref) == oracle.tetras[t])
        assert net.split([ref]) == (0 if oracle.split(t) else 1)
    assert_the_same_around(net, oracle)
    net.collect()
    assert_the_same_around(net, oracle)
    assert net.check() == []


@pytest.mark.parametrize("name", NAMES)
def test_around_a_point_of_many_tetras(name):
    """More than `tetras_around` expects: a fan of 200 around an axis, between points on a circle."""
    angles = np.linspace(0.0, 2 * np.pi, 200, endpoint=False)
    circle = np.column_stack([np.cos(angles), np.sin(angles), np.zeros(200)])
    tets = [[0, 1, 2 + n, 2 + (n + 1) % 200] for n in range(200)]
    net, oracle = build(name, mesh_of([[0, 0, -1], [0, 0, 1], *circle.tolist()], tets))
    assert sorted(net.tetras_around(0)) == sorted(net.refs.tolist())
    assert len(oracle.around(0)) == 200
    np.testing.assert_array_equal(net.locate(net.centroids, "source"), net.refs)
    assert net.check() == []


@pytest.mark.parametrize("name", NAMES)
def test_room_is_what_reserve_has_made(name):
    net, _ = build(name, nozzle())
    tetras, points = len(net), net.number_of_points
    net.storage = edit.reserve(net.storage, 500, 300)
    for room in (interface.incidence_room(net.storage), interface.capacity(net.storage)):
        assert room >= tetras + 500
    assert len(net.storage.points.xyz) >= points + 300
    storage = net.storage
    for n in range(300):
        net.insert_point(10.0 + n, 0.0, 0.0)
    for n in range(297):
        net.insert(*range(points + n, points + n + 4))
    assert net.storage is storage  # there was room for all of them
    assert net.check() == []


@pytest.mark.parametrize("name", NAMES)
def test_collect_counts_as_an_edit_where_something_waited(name):
    net, _ = build(name, nozzle())
    assert not net.collect()
    digest = net.answer().digest
    gone = net.vertices_of(net.last)
    net.delete(net.last)
    storage, edits = net.storage, int(net.storage.points.counters[2])
    changed = net.collect()
    assert changed <= (not net.contestant.stable_refs)
    assert changed or net.storage is storage
    assert (int(net.storage.points.counters[2]) > edits) == changed
    assert gone not in {net.vertices_of(t) for t in net}
    net.insert(*gone)
    assert net.answer().digest == digest
