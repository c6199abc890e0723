"""Point location by all three methods: inside, outside, in holes, on sides, far away."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests import oracle
from tests.meshes import MESHES, apart, flat, nozzle, single
from tetrabench import registry
from tetrabench.backends.tetra import CONTESTANTS as OURS
from tetrabench.errors import InputError
from tetrabench.mesh.models import generate
from tetrabench.tetra import locate
from tetrabench.tetra.locate import METHODS, build_grid
from tetrabench.tetra.net import TetraNet

CONTESTANTS = ["v3y", "v4"]
ALL = [contestant.name for contestant in OURS]
ROUNDING = 1e-12


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


def is_right(net, t, point):
    """The definition in exact arithmetic: no signed volume is below -INSIDE of the tetra's, rounding apart."""
    corners = [tuple(map(Fraction, corner)) for corner in net.points[list(net.vertices_of(t))].tolist()]
    point = tuple(map(Fraction, point.tolist()))
    whole = oracle.signed_volume(*corners)
    parts = [oracle.signed_volume(*corners[:i], point, *corners[i + 1 :]) for i in range(4)]
    if whole < 0:
        whole, parts = -whole, [-part for part in parts]
    return min(parts) >= -Fraction(locate.INSIDE + ROUNDING) * whole


def queries_about(net, rng):
    """Points of every kind: vertices, on edges and sides, within, around, far away, nowhere; in random order."""
    corners = net.points[net.vertices] if len(net) else np.zeros((1, 4, 3))
    shares = np.concatenate([np.eye(4), rng.dirichlet(np.ones(4), 4)])
    shares = np.concatenate([shares, (np.eye(4) + np.eye(4)[[1, 2, 3, 0]]) / 2, (1 - np.eye(4)) / 3])
    low, high = corners.min(axis=(0, 1)), corners.max(axis=(0, 1))
    around = low + (high - low) * (rng.random((50, 3)) * 1.6 - 0.3)
    nowhere = np.array([[np.nan, 0, 0], [0, np.inf, 0], [0, 0, -np.inf], [1e300] * 3, [-1e9, 0, 0], [np.nan] * 3])
    points = np.concatenate([np.einsum("qc,tck->tqk", shares, corners).reshape(-1, 3)[:600], around, nowhere])
    return rng.permutation(points)


@pytest.mark.parametrize("name", ALL)
@pytest.mark.parametrize("many", [True, False], ids=["in order", "as they come"])
@given(mesh=st.sampled_from(sorted(MESHES)), holes=st.floats(0, 1), inside_out=st.booleans(), seed=st.integers(0, 99))
def test_a_walk_says_what_every_tetra_says(name, many, mesh, holes, inside_out, seed):
    """Few queries and many, in nets with holes, of several parts, flat, inverted: as found by asking every tetra."""
    rng = np.random.default_rng(seed)
    mesh = MESHES[mesh]()
    if inside_out:
        mesh.tets[::2] = mesh.tets[::2][:, [1, 0, 2, 3]]
    net = build(name, mesh)
    for t in net.refs[rng.random(len(net)) < holes * rng.integers(0, 2)]:
        net.delete(int(t))
    points = queries_about(net, rng)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(locate, "_MANY", 0 if many else len(points) + 1)
        found = net.locate(points)
    np.testing.assert_array_equal(found == -1, net.locate(points, "brute") == -1)
    assert all(is_right(net, t, point) for t, point in zip(found.tolist(), points, strict=True) if t != -1)
    net.close()


@pytest.mark.parametrize("many", [True, False], ids=["in order", "as they come"])
def test_what_is_inside_is_walked_to(many, monkeypatch):
    """In a convex net without holes nobody asks for the grid."""
    net = build("v3y", generate("box", 1000, numbering="shuffled", seed=3))
    order = np.random.default_rng(1).permutation(len(net))
    monkeypatch.setattr(locate, "_MANY", 0 if many else len(net) + 1)
    monkeypatch.setattr(locate, "build_grid", None)
    np.testing.assert_array_equal(net.locate(net.centroids[order]), net.refs[order])


@pytest.mark.parametrize("many", [True, False], ids=["in order", "as they come"])
def test_one_grid_for_all_that_are_outside(many, monkeypatch):
    """It is built for the first point that needs it, and kept while the net stays the same."""
    net = build("v3y", generate("nozzle", 1000, seed=3))
    monkeypatch.setattr(locate, "_MANY", 0 if many else 10**6)
    built = []
    monkeypatch.setattr(locate, "build_grid", lambda net: built.append(net) or build_grid(net))
    off = net.centroids + [0.0, 0.0, 0.5 * np.ptp(net.points[:, 2])]
    found, again = net.locate(off), net.locate(off)
    assert len(built) == 1
    np.testing.assert_array_equal(found, again)
    np.testing.assert_array_equal(found == -1, net.locate(off, "brute") == -1)


def test_the_order_of_many_queries_is_one_of_neighbours(rng):
    """The way through shuffled queries is a small part of the way from one to the next as they come."""
    net = build("v3y", nozzle())
    low, high = net.points.min(axis=0), net.points.max(axis=0)
    points = low + (high - low) * rng.random((5000, 3))
    points[:10] = [1e9, np.nan, -np.inf]  # which must not spoil it for the others
    way, box = locate._way_through(net.storage, points)
    lengths = [
        np.linalg.norm(np.diff(p[np.isfinite(p).all(axis=1)], axis=0), axis=1).sum() for p in (points[way], points)
    ]
    assert lengths[0] < 0.1 * lengths[1]
    assert (box[0] <= low).all()
    assert (box[1] >= high).all()


@pytest.mark.parametrize("method", METHODS)
def test_a_flat_tetra_holds_no_more_than_its_place(method):
    """All four volumes are zero everywhere in its plane."""
    net = build("v3y", flat())
    both, flat_one = net.locate([[0.25, 0.25, 0.0], [0.9, 0.9, 0.0]], method).tolist()
    assert both in net.refs
    assert flat_one == net.refs[1]
    assert net.locate([[5.0, 5.0, 0.0], [-0.1, 0.5, 0.0], [0.9, 0.9, 1e-6]], method).tolist() == [-1, -1, -1]


@pytest.mark.parametrize("method", METHODS)
def test_parts_that_do_not_touch(method):
    net = build("v3y", apart())
    points = [[0.1, 0.1, 0.1], [5.1, 5.1, 5.1], [3.0, 3.0, 3.0], [9.0, 9.0, 9.0]]
    assert net.locate(points * 200, method).tolist() == [*net.refs.tolist(), -1, -1] * 200


def test_as_far_as_numbers_go():
    """Extents that no float holds: no crash, and who is outside is outside."""
    net = build("v3y", single())
    with np.errstate(over="ignore", invalid="ignore"):
        left, right = net.insert_point(-1.7e308, 0.0, 0.0), net.insert_point(1.7e308, 1.0, 1.0)
        net.insert(1, 2, 3, right)
        net.insert(0, 2, 3, left)
    points = np.array([[0.1, 0.1, 0.1], [-1e308, -1e308, 0.0], [0.0, -1.0, 0.0], [np.nan, 0.0, 0.0]])
    for times in (1, 500):
        assert (net.locate(np.tile(points, (times, 1))) == -1).tolist() == [False, True, True, True] * times
