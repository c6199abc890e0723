"""Many at once, and edits that happen as a whole or not at all: on every contestant."""

import contextlib

import numpy as np
import pytest
from numba import config

from tests.meshes import box, nozzle, pair
from tetrabench import registry
from tetrabench.backends.tetra import CONTESTANTS as OURS
from tetrabench.errors import InputError, MemoryRefusedError
from tetrabench.jit import heap, kernel
from tetrabench.tetra import edit, interface
from tetrabench.tetra.net import TetraNet


@pytest.fixture(params=[c.name for c in OURS])
def build(request):
    contestant = registry.contestant("tetra", request.param)
    return lambda mesh: TetraNet(mesh, contestant)


def everything(net):
    """All that can be asked of a net, in its own refs and order."""
    return {
        "refs": net.refs.tolist(),
        "vertices": net.vertices.tolist(),
        "neighbours": net.neighbours.tolist(),
        "static": net._static().tolist(),
        "states": net.states.tolist(),
        "points": net.points.tolist(),
        "around": [sorted(net.tetras_around(point)) for point in range(net.number_of_points)],
        "nearest": net.nearest_points(net.centroids).tolist() if len(net) else [],
        "answer": net.answer().digest,
        "check": net.check(),
    }


class StopError(Exception):
    """Something went wrong."""


@kernel
def shake(net, value):
    """A kernel of a user's: new states, and a tetra less."""
    cursor = interface.first_tetra(net)
    while cursor.tetra != interface.NONE:
        interface.set_state(net, cursor.tetra, 1, value)
        cursor = interface.next_tetra(net, cursor)
    interface.delete_tetra(net, interface.last_tetra(net))


def change(net, rng):
    """Every kind of change, so many that the net has to grow, with slots that are freed and filled again."""
    net.split(rng.permutation(net.refs)[: len(net) // 2])
    shake(net.storage, 7.5)
    rows = net.vertices[:9]
    net.delete_many(net.refs[:9])
    net.insert_many(rows[::-1])
    net.insert_points(rng.random((5, 3)) + 4.0)
    net.delete(net.last)
    net.states = rng.random((len(net), 5))
    net.deform(lambda points: 2.0 * points)
    net.locate(net.centroids[:3])


@pytest.mark.parametrize("mesh", [box] if config.DISABLE_JIT else [box, nozzle])
@pytest.mark.parametrize("error", [StopError] if config.DISABLE_JIT else [StopError, KeyboardInterrupt])
def test_what_fails_has_not_happened(build, rng, mesh, error):
    with build(mesh()) as net:
        net.states = rng.random((len(net), 5))
        net.delete_many(net.refs[3:40:7])  # holes
        net.split(net.refs[5:9])
        for _ in range(2):
            before = everything(net)
            with pytest.raises(error), net.edit() as same:  # noqa: PT012
                assert same is net
                change(net, rng)
                assert everything(net) != before
                raise error
            assert everything(net) == before
            assert net.locate(net.centroids).tolist() == before["refs"]
            assert all(ref in net for ref in before["refs"])
        change(net, rng)  # and it goes on
        assert net.check() == []


def test_what_succeeds_has_happened(build, rng):
    one, other = build(box()), build(box())
    with one.edit():
        change(one, np.random.default_rng(3))
    change(other, np.random.default_rng(3))
    assert one.answer() == other.answer()
    assert one.check() == []
    one.delete(one.last)
    one.close()
    with pytest.raises(InputError, match="closed"), one.edit():
        pass


@pytest.mark.skipif(not config.DISABLE_JIT, reason="compiled code calls malloc and free by itself")
@pytest.mark.parametrize("fails", [True, False])
def test_nodes_on_the_heap_are_all_given_back(monkeypatch, rng, fails):
    alive = set()
    allocate, release = heap.allocate, heap.release
    monkeypatch.setattr(heap, "allocate", lambda size: alive.add(t := allocate(size)) or t)
    monkeypatch.setattr(heap, "release", lambda t: alive.remove(int(t)) or release(t))
    net = TetraNet(box(), registry.contestant("tetra", "v4"))
    with contextlib.suppress(StopError), net.edit():
        change(net, rng)
        if fails:
            raise StopError
    assert alive == set(net.refs.tolist())
    net.close()
    assert not alive


def test_a_storage_that_was_given_up_is_not_edited(build):
    net = build(box())
    with pytest.raises(StopError), net.edit():  # noqa: PT012
        abandoned = net.storage
        raise StopError
    with pytest.raises(ValueError, match="outgrown"):
        edit.check_editable(abandoned)
    assert net.check() == []


def test_an_edit_stands_alone(build):
    with build(pair()) as net, net.edit():
        with pytest.raises(InputError, match="an edit inside of another"), net.edit():
            pass
        with pytest.raises(InputError, match="closed inside of an edit"):
            net.close()
        net.delete(net.last)
    assert not net.is_open


def test_no_room_for_a_copy(build, monkeypatch):
    net = build(box())
    before = everything(net)
    monkeypatch.setattr("tetrabench.memory.available_bytes", lambda: 1000)
    with pytest.raises(MemoryRefusedError, match="a copy of the net to go back to needs about"), net.edit():
        net.delete(net.last)
    monkeypatch.undo()
    assert everything(net) == before
    with net.edit():
        net.delete(net.last)


def test_many_are_one_after_another(build, rng):
    many, single = build(nozzle()), build(nozzle())
    chosen = rng.permutation(len(many))[: len(many) // 3]
    tets = many.vertices[chosen]
    many.delete_many(many.refs[chosen])
    for ref in single.refs[chosen].tolist():
        single.delete(ref)
    many.collect()
    single.collect()
    assert many.answer() == single.answer()
    refs = many.insert_many(tets)
    assert [many.vertices_of(ref) for ref in refs.tolist()] == [tuple(row) for row in tets.tolist()]
    for row in tets.tolist():
        single.insert(*row)
    assert many.answer() == single.answer()
    assert many.check() == []
    assert many.insert_many([]).tolist() == []
    many.delete_many([])
    assert many.answer() == single.answer()


def test_points_many_at_once(build, rng):
    net = build(box())
    there = net.number_of_points
    rows = np.concatenate([net.points[[3, 1]], rng.random((4, 3)) + 2.0, net.points[:1]])
    rows[4] = rows[3]
    assert net.insert_points(rows).tolist() == [3, 1, there, there + 1, there + 1, there + 2, 0]
    assert net.insert_points(np.empty((0, 3))).tolist() == []
    for bad in ([1.0, 2.0, 3.0], [[1.0, 2.0]], [[np.nan, 0.0, 0.0]]):
        with pytest.raises(InputError, match=r"shape \(m, 3\)"):
            net.insert_points(bad)
    assert net.number_of_points == there + 3


@pytest.mark.parametrize(
    ("rows", "reason"),
    [
        ([[5, 6, 7, 7]], r"tetra \(5, 6, 7, 7\)"),
        ([[5, 6, 7, 10**6]], "there is no such point"),
        ([[0, 1, 2]], r"shape \(n, 4\)"),
        ([0, 1, 2, 3], r"shape \(n, 4\)"),
        ([[0.0, 1.0, 2.0, 3.5]], r"shape \(n, 4\), not float64"),
        ([[0, 1], [2]], r"shape \(n, 4\)"),
    ],
)
def test_none_of_many_is_inserted_where_one_is_refused(build, rows, reason):
    net = build(box())
    taken = net.vertices[:4]
    net.delete_many(net.refs[:4])
    before = everything(net)
    with pytest.raises(InputError, match=reason):
        net.insert_many([*taken.tolist(), *rows])
    after = everything(net)
    if not net.contestant.stable_refs:  # it may have collected
        for one in (before, after):
            one["vertices"].sort()
    for name in ("vertices", "states", "points", "check", "answer"):
        assert after[name] == before[name]
    assert net.insert_many(taken).shape == (4,)


def test_many_that_are_no_tetras_are_not_deleted(build):
    net = build(box())
    before = everything(net)
    for bad, reason in (
        ([*net.refs[:3].tolist(), -1], "there is no tetra -1"),
        (net.refs[[0, 1, 0]], "only once: a ref comes twice"),
        ([[1, 2]], r"shape \(n,\)"),
        ([1.5], r"shape \(n,\)"),
    ):
        with pytest.raises(InputError, match=reason):
            net.delete_many(bad)
    assert everything(net) == before
