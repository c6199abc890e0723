"""Point location by all three methods: inside, outside, in holes, on sides, far away."""

import numpy as np
import pytest

from tests.meshes import nozzle
from tetrabench import registry
from tetrabench.errors import InputError
from tetrabench.mesh.models import generate
from tetrabench.tetra.locate import METHODS, build_grid
from tetrabench.tetra.net import TetraNet

CONTESTANTS = ["v3y", "v4"]


def build(name, mesh):
    return TetraNet(mesh, registry.contestant("tetra", name))


def holds(net, t, point):
    corners = net.points[list(net.vertices_of(t))]
    shares = np.linalg.solve(np.vstack([corners.T, np.ones(4)]), np.append(point, 1.0))
    return shares.min() > -1e-9


@pytest.mark.parametrize("name", CONTESTANTS)
@pytest.mark.parametrize("method", METHODS)
def test_a_point_in_every_tetra(name, method):
    net = build(name, nozzle())
    np.testing.assert_array_equal(net.locate(net.centroids, method), net.refs)


@pytest.mark.parametrize("method", METHODS)
def test_holes_and_outside(method, rng):
    """Random points around a curved, non-convex net with holes: all methods agree with asking every tetra."""
    net = build("v3y", generate("nozzle", 1000, seed=3))
    for t in rng.permutation(net.refs)[:300]:
        net.delete(int(t))
    low, high = net.points.min(axis=0), net.points.max(axis=0)
    points = low + (high - low) * (rng.random((500, 3)) * 1.2 - 0.1)
    found, every = net.locate(points, method), net.locate(points, "brute")
    np.testing.assert_array_equal(found == -1, every == -1)
    assert 0 < (found == -1).sum() < len(points)
    assert all(holds(net, t, p) for t, p in zip(found.tolist(), points, strict=True) if t != -1)


@pytest.mark.parametrize("method", METHODS)
def test_vertices_and_sides_belong_to_somebody(method):
    net = build("v3y", nozzle())
    sides = net.points[net.vertices[:, 1:]].mean(axis=1)
    for points in (net.points, sides):
        found = net.locate(points, method)
        assert (found >= 0).all()
        assert all(holds(net, t, p) for t, p in zip(found.tolist(), points, strict=True))


@pytest.mark.parametrize("method", METHODS)
def test_far_away_and_no_number(method):
    net = build("v3y", nozzle())
    points = [[1e300, 0, 0], [-1e9, 1e9, 0], [np.inf, 0, 0], [np.nan, 0, 0]]
    assert net.locate(points, method).tolist() == [-1] * 4


def test_empty_net_and_no_points():
    net = build("v3y", nozzle())
    for t in net:
        net.delete(t)
    assert net.locate([[0, 0, 0]]).tolist() == [-1]
    assert net.locate(np.empty((0, 3))).tolist() == []


def test_the_grid_is_never_larger_than_the_net_deserves(rng):
    """Empty, flat, and needle-shaped nets, and such of any unit, get a grid of few cells."""
    net = build("v3y", nozzle())
    net.deform(lambda points: points * np.array([1.0, 1.0, 1e-12]))
    for scale in (1e-90, 1e50):
        net.deform(lambda points, scale=scale: points * scale)
        assert len(build_grid(net.storage).starts) < 100 * len(net)
        net.deform(lambda points, scale=scale: points / scale)
    for t in net:
        net.delete(t)
    assert len(build_grid(net.storage).starts) < 100


def test_edits_are_seen():
    """The grid that an outside point makes is not used any more once the net has changed."""
    net = build("v3y", nozzle())
    t = int(net.refs[10])
    vertices, inside = net.vertices_of(t), net.centroids[10]
    net.delete(t)
    assert net.locate([inside]).tolist() == [-1]
    again = net.insert(*vertices)
    assert net.locate([inside]).tolist() == [again]


def test_refusals():
    net = build("v3y", nozzle())
    with pytest.raises(InputError, match="walk, source, brute"):
        net.locate([[0, 0, 0]], "guess")
    with pytest.raises(InputError, match=r"\(m, 3\)"):
        net.locate([0.0, 0.0])
