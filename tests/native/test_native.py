"""Ours and C leave the same bits behind, on every contestant. (How fast each is: bench_native.py.)"""

import ctypes
import shutil

import numpy as np
import pytest
from replace import replace
from yardstick import BY_NAME, EDITABLE, build, c_net, content, copy_arrays, is_linked

from tetrabench.mesh.models import generate
from tetrabench.scenarios.tetra.alfa import average
from tetrabench.scenarios.tetra.delete import delete_from_end
from tetrabench.scenarios.tetra.flow import diffuse
from tetrabench.scenarios.tetra.locate import points_near_sides
from tetrabench.tetra.edit import reserve
from tetrabench.tetra.interface import delete_tetra, split_many, tetra_refs
from tetrabench.tetra.locate import locate
from tetrabench.tetra.net import TetraNet

pytestmark = pytest.mark.skipif(shutil.which("gcc") is None, reason="the C yardsticks need gcc")

MESH = generate("nozzle", 600)
DELETED, SPLIT = 100, 150


@pytest.fixture(scope="module", params=list(BY_NAME))
def contestant(request, tmp_path_factory):
    """A name and its yardstick."""
    return request.param, build(request.param, tmp_path_factory.mktemp("native"))


def fresh(name):
    """A net with states, every seventh tetra a hole, and room for the splits."""
    net = TetraNet(MESH, BY_NAME[name])
    net.states = np.linspace(0.0, 1.0, 5 * len(net)).reshape(-1, 5)
    for t in net.refs[::7]:
        delete_tetra(net.storage, t)
    net.storage = reserve(net.storage, 3 * SPLIT + 1, SPLIT)
    return net


@pytest.fixture
def twins(contestant):
    """Two nets that are the same, one for us and one for C."""
    ours, c = fresh(contestant[0]), fresh(contestant[0])
    if not is_linked(ours.storage):
        copy_arrays(ours.storage, c.storage)
    yield ours.storage, c.storage
    ours.close()
    c.close()


def test_sweeps(contestant, twins):
    ours, c = twins
    average(ours, 3)
    diffuse(ours, 3, 1e-3)
    contestant[1].alfa(ctypes.byref(c_net(c)), 3)
    contestant[1].flow(ctypes.byref(c_net(c)), 3, 1e-3)
    assert content(ours) == content(c)


def test_edits(contestant, twins):
    name, yardstick = contestant
    if name not in EDITABLE:
        pytest.skip("its delete and explode have no yardstick")
    ours, c = twins
    delete_from_end(ours, DELETED)
    assert yardstick.delete_from_end(ctypes.byref(c_net(c)), DELETED) == DELETED
    assert content(ours) == content(c)
    refs = tetra_refs(c)[:SPLIT]
    _, skipped = split_many(ours, tetra_refs(ours)[:SPLIT])
    assert yardstick.explode(ctypes.byref(c_net(c)), refs.ctypes.data, SPLIT) == skipped
    assert content(ours) == content(c)


def test_replace(contestant, twins, rng):
    name, yardstick = contestant
    if name not in EDITABLE:
        pytest.skip("its edits have no yardstick")
    ours, c = twins
    rows = rng.permutation(len(tetra_refs(ours)))
    refs, twin_refs = tetra_refs(ours)[rows], tetra_refs(c)[rows]
    before = content(ours)
    assert replace(ours, refs) == len(rows)
    assert yardstick.replace(ctypes.byref(c_net(c)), twin_refs.ctypes.data, len(rows)) == len(rows)
    assert content(ours) == content(c) != before


def test_locate(contestant, twins, rng):
    """Points in all tetras, and one that no tetra holds."""
    ours, _ = twins
    refs = rng.permutation(tetra_refs(ours))
    points = np.concatenate([points_near_sides(ours, refs), [ours.points.xyz[0] + [0.0, 0.0, -1.0]]])
    found = np.empty(len(points), np.int64)
    lost = contestant[1].locate(ctypes.byref(c_net(ours)), points.ctypes.data, len(points), found.ctypes.data)
    walked = found != -1
    assert lost == (~walked).sum() < 0.5 * len(points)  # a walk cannot pass a hole
    assert not walked[-1]
    np.testing.assert_array_equal(found[walked], locate(ours, points)[0][walked])
    np.testing.assert_array_equal(locate(ours, points)[0], [*refs, -1])
