"""Every operation of a half-face mesh, on every small mesh, against the naive twin."""

from itertools import combinations, permutations, product

import numpy as np
import pytest

from tests.halfface.comparing import (
    COUNTED,
    B,
    E,
    F,
    H,
    T,
    V,
    assert_untouched,
    compare,
    words_of,
)
from tests.halfface.meshes import MESHES, ring, two_components_at_a_vertex
from tests.halfface.naive import KINDS, NaiveMesh, Names
from tetrabench.backends.tetra.halfface import INVALID, Element, HalfFaceMesh, edit
from tetrabench.backends.tetra.halfface.sets import ElementSet
from tetrabench.errors import InputError

BITS = (32, 64)


@pytest.fixture(params=sorted(MESHES))
def given(request):
    """Each small connectivity in turn."""
    return MESHES[request.param]()


@pytest.fixture(params=BITS)
def bits(request):
    return request.param


@pytest.fixture
def naive(given):
    return NaiveMesh.of(given.tets, given.vertices)


@pytest.fixture
def mesh(given, bits):
    return HalfFaceMesh.construct_mesh(given.tets, given.vertices, bits=bits)


@pytest.fixture
def names(mesh):
    return Names(mesh)


# ------------------------------------------------------------------ questions


def test_constructed(mesh, naive):
    compare(mesh, naive)


def test_added_one_by_one(given, naive, bits):
    mesh = HalfFaceMesh(given.vertices, bits=bits)
    for n, tet in enumerate(given.tets.tolist()):
        assert mesh.add_tetrahedron(*tet) == n
        assert mesh.check() == []
    compare(mesh, naive)


def test_added_many(given, naive, bits):
    mesh = HalfFaceMesh(given.vertices, bits=bits)
    assert mesh.add_tetrahedra(given.tets).tolist() == list(range(len(given.tets)))
    compare(mesh, naive)


def test_conjoined(given, naive, bits):
    """In two halves, each by way of an eventual mesh."""
    mesh = HalfFaceMesh(given.vertices, bits=bits)
    for half in np.array_split(given.tets, 2):
        eventual = mesh.eventual_mesh()
        eventual.add_tetrahedra(half)
        before = mesh.n_tetrahedra
        assert mesh.conjoin_mesh(eventual).tolist() == list(range(before, before + len(half)))
    compare(mesh, naive)


def test_promise_of_a_manifold(given, naive, bits):
    if naive.is_manifold():
        compare(HalfFaceMesh.construct_mesh(given.tets, given.vertices, bits=bits, manifold=True), naive)


def test_a_half_collected(given, naive, bits):
    """Each other tetra goes, by flags."""
    mesh = HalfFaceMesh.construct_mesh(given.tets, given.vertices, bits=bits)
    for t in range(0, len(given.tets), 2):
        mesh.set_delete_flag(t)
        naive.tetras[frozenset(given.tets[t].tolist())].flagged = True
    compare(mesh, naive)
    assert mesh.garbage_collect() == naive.garbage_collect()
    compare(mesh, naive)


def test_taken_apart_and_put_together(given, naive, bits, rng):
    """Everything goes, one by one in any order, and comes back in another; so all chains of free entries are in use."""
    mesh = HalfFaceMesh.construct_mesh(given.tets, given.vertices, bits=bits)
    tets = rng.permutation(given.tets)[:12].tolist()
    for tet in tets:
        mesh.set_delete_flag(mesh.find_tetrahedron(*tet))
        naive.tetras[frozenset(tet)].flagged = True
        assert mesh.garbage_collect() == naive.garbage_collect() == 1
        assert mesh.check() == []
    compare(mesh, naive)
    for tet in rng.permutation(np.array(tets, np.int32).reshape(-1, 4)).tolist():
        mesh.add_tetrahedron(*tet)
        naive.add_tetrahedron(tuple(tet))
        assert mesh.check() == []
    compare(mesh, naive)


def test_all_flagged(mesh, naive):
    """Flagged tetras are as they were for all questions but iteration, until they are collected."""
    mesh.set_delete_flags(np.arange(mesh.n_tetrahedra))
    for tetra in naive.tetras.values():
        tetra.flagged = True
    compare(mesh, naive)
    mesh.garbage_collect()
    naive.garbage_collect()
    compare(mesh, naive)
    assert len(mesh.tetrahedra) == mesh.n_border_halffaces == 0


def test_one_by_one_as_many_at_once(mesh, names):
    for target, source in product(KINDS, KINDS):
        starts, found = mesh.one_to_all_many(target, source, list(names.of[source]))
        for n, handle in enumerate(names.of[source]):
            alone = mesh.one_to_all(target, source, handle)
            assert isinstance(alone, ElementSet)
            assert alone.is_committed()
            assert list(alone) == found[starts[n] : starts[n + 1]].tolist()


def test_many_in_any_order(mesh, names, rng):
    """Some of them, some twice: each has its own answer in its own place."""
    for target, source in product(KINDS, KINDS):
        given = rng.choice(list(names.of[source]) or [0], (7 if names.of[source] else 0,))
        for some in (given, given[:1], given[:0]):
            starts, found = mesh.one_to_all_many(target, source, some)
            assert (starts.dtype, found.dtype, len(starts)) == (np.int64, np.int64, len(some) + 1)
            for n, handle in enumerate(some.tolist()):
                assert found[starts[n] : starts[n + 1]].tolist() == list(mesh.one_to_all(target, source, handle))


def test_whether_incident(mesh, naive, names, rng):
    for target, source in product(KINDS, KINDS):
        pairs = list(product(names.of[target].items(), names.of[source].items()))
        for n in rng.permutation(len(pairs))[:1500].tolist():
            (x, one), (y, other) = pairs[n]
            assert mesh.is_incident(target, x, source, y) is naive.is_incident(target, one, source, other)


def test_order_as_given(bits):
    """All orders in which the vertices of a tetra can be given."""
    orders = [tuple(4 * n + v for v in order) for n, order in enumerate(permutations(range(4)))]
    constructed = HalfFaceMesh.construct_mesh(orders, bits=bits)
    added = HalfFaceMesh(96, bits=bits)
    added.add_tetrahedra(orders)
    for mesh in (constructed, added):
        assert [tuple(row) for row in mesh.connectivity.tolist()] == orders
        assert [mesh.tetrahedron_to_vertices_ordered(t) for t in mesh.tetrahedra] == orders
        mesh.set_delete_flags(range(0, 24, 3))
        mesh.set_tetrahedron_flag(23, 5)
        mesh.garbage_collect()
        left = {order for n, order in enumerate(orders) if n % 3}
        assert {tuple(row) for row in mesh.connectivity.tolist()} == left
        assert mesh.check() == []


# ------------------------------------------------------------------ flags


def test_user_flags(mesh, naive, names, rng):
    """Set, reset and flip at random; nothing else changes, and they survive collection with their tetra."""
    tetras = list(naive.tetras)
    for t, k, what in rng.integers(0, (max(len(tetras), 1), 6, 3), (5 * len(tetras), 3)).tolist():
        flags = naive.tetras[names.of[T][t]].flags
        if what == 0:
            mesh.set_tetrahedron_flag(t, k)
            flags.add(k)
        elif what == 1:
            mesh.reset_tetrahedron_flag(t, k)
            flags.discard(k)
        else:
            mesh.flip_tetrahedron_flag(t, k)
            flags ^= {k}
    compare(mesh, naive)
    for name in tetras[::3]:
        mesh.set_delete_flag(names.handles[T][name])
        naive.tetras[name].flagged = True
    mesh.garbage_collect()
    naive.garbage_collect()
    compare(mesh, naive)


def test_delete_flag_can_be_taken_away(mesh, naive):
    before = words_of(mesh)
    for t in range(mesh.n_tetrahedra):
        mesh.set_delete_flag(t)
        mesh.set_delete_flag(t)  # twice is once
        assert mesh.get_delete_flag(t)
        mesh.set_delete_flag(t, False)
        mesh.set_delete_flag(t, False)
    assert_untouched(mesh, before)
    assert mesh.garbage_collect() == 0
    assert_untouched(mesh, before)


def test_flagged_block(bits):
    """Until it is collected, a flagged tetra is as much in the way as any other."""
    mesh = HalfFaceMesh.construct_mesh([[0, 1, 2, 3], [1, 2, 3, 4]], 6, bits=bits)
    mesh.set_delete_flag(0)
    with pytest.raises(InputError, match="already"):
        mesh.add_tetrahedron(3, 2, 1, 0)
    with pytest.raises(InputError, match="two tetras share that face"):
        mesh.add_tetrahedron(1, 2, 3, 5)
    mesh.garbage_collect()
    assert mesh.add_tetrahedron(3, 2, 1, 0) == 1
    assert mesh.tetrahedron_to_vertices_ordered(1) == (3, 2, 1, 0)


# ------------------------------------------------------------------ what collection does to handles


def test_only_the_last_ones_move(mesh, naive, names, rng):
    """The rightmost that stay fill the gaps that the others leave: who is below the new count and stays, stays where it is."""
    gone = rng.random(mesh.n_tetrahedra) < 0.4
    mesh.set_delete_flags(np.flatnonzero(gone))
    left = mesh.n_tetrahedra - int(gone.sum())
    assert mesh.garbage_collect() == gone.sum()
    after = Names(mesh).of[T]
    assert sorted(after) == list(range(left))
    assert set(after.values()) == {names.of[T][t] for t in np.flatnonzero(~gone).tolist()}
    for t in np.flatnonzero(~gone[:left]).tolist():
        assert after[t] == names.of[T][t]


# ------------------------------------------------------------------ vertices


def test_the_last_removed_is_the_first_reused(bits):
    mesh = HalfFaceMesh(6, bits=bits)
    for v in (4, 0, 3):
        mesh.remove_vertex(v)
        assert mesh.vertex_deleted(v)
    assert list(mesh.vertices) == [1, 2, 5]
    assert mesh.check() == []
    assert mesh.add_vertices(5).tolist() == [3, 0, 4, 6, 7]
    assert mesh.add_vertex() == 8
    assert list(mesh.vertices) == list(range(9))
    assert mesh.check() == []


def test_nobody_is_reused(bits):
    mesh = HalfFaceMesh(4, bits=bits, reuse_vertices=False)
    mesh.remove_vertex(1)
    mesh.remove_vertex(2)
    assert mesh.add_vertices(2).tolist() == [4, 5]
    assert mesh.vertex_deleted(1)
    assert mesh.vertex_deleted(2)
    assert mesh.n_vertices == 4
    assert mesh.check() == []


def test_only_isolated_ones_go(mesh, naive):
    before = words_of(mesh)
    used = set().union(*naive.tetras)
    for v in used:
        with pytest.raises(InputError, match="cannot be removed"):
            mesh.remove_vertex(v)
    assert_untouched(mesh, before)
    for v in naive.elements(V) - used:
        mesh.remove_vertex(v)
        naive.remove_vertex(v)
        with pytest.raises(InputError):
            mesh.remove_vertex(v)
    compare(mesh, naive)


def test_eventual_mesh_holds_its_vertices(bits):
    mesh = HalfFaceMesh(5, bits=bits)
    eventual = mesh.eventual_mesh()
    eventual.add_tetrahedron(0, 1, 2, 3)
    with pytest.raises(InputError, match="eventual"):
        mesh.remove_vertex(2)
    mesh.remove_vertex(4)
    with pytest.raises(InputError, match="deleted"):
        eventual.add_tetrahedron(0, 1, 2, 4)
    eventual.set_delete_flag(0)
    with pytest.raises(InputError, match="eventual"):  # it is still there
        mesh.remove_vertex(2)
    eventual.garbage_collect()
    mesh.remove_vertex(2)
    assert mesh.check() == eventual.check() == []


def test_eventual_mesh_knows_later_vertices(bits):
    mesh = HalfFaceMesh(3, bits=bits)
    eventual = mesh.eventual_mesh()
    mesh.add_vertices(2)
    assert eventual.find_halfface(0, 1, 4) == INVALID
    assert mesh.n_vertices == eventual.n_vertices == 5
    mesh.remove_vertex(1)
    assert not eventual.is_valid(V, 1)
    assert not mesh.eventual_mesh().is_valid(V, 1)
    with pytest.raises(InputError, match="deleted"):
        eventual.add_tetrahedron(0, 1, 2, 3)
    assert eventual.check() == mesh.eventual_mesh().check() == []
    assert eventual.add_tetrahedron(4, 3, 0, 2) == 0
    mesh.conjoin_mesh(eventual)
    assert mesh.tetrahedron_to_vertices(0) == (0, 2, 3, 4)


def test_eventual_mesh_begins_anew_with_its_main_mesh(bits):
    mesh = HalfFaceMesh(9, bits=bits)
    eventual = mesh.eventual_mesh()
    eventual.add_tetrahedron(5, 6, 7, 8)
    eventual.clear_mesh()
    mesh.clear_mesh()
    mesh.add_vertices(5)
    with pytest.raises(InputError):
        eventual.add_tetrahedron(5, 6, 7, 8)
    eventual.add_tetrahedron(1, 2, 3, 4)
    mesh.conjoin_mesh(eventual)
    assert mesh.find_tetrahedron(1, 2, 3, 4) == 0
    assert mesh.check() == eventual.check() == []


@pytest.mark.parametrize("tetrahedra_only", [False, True])
def test_cleared(mesh, naive, tetrahedra_only):
    mesh.clear_mesh(tetrahedra_only)
    naive.clear_mesh(tetrahedra_only)
    compare(mesh, naive)
    mesh.add_vertices(4)
    for _ in range(4):
        naive.add_vertex()
    mesh.add_tetrahedron(0, 1, 2, 3)
    naive.add_tetrahedron((0, 1, 2, 3))
    compare(mesh, naive)


def test_not_cleared_under_an_eventual_mesh(bits):
    mesh = HalfFaceMesh.construct_mesh([[0, 1, 2, 3]], 5, bits=bits)
    eventual = mesh.eventual_mesh()
    eventual.add_tetrahedron(1, 2, 3, 4)
    before = words_of(mesh)
    with pytest.raises(InputError, match="eventual"):
        mesh.clear_mesh()
    assert_untouched(mesh, before)
    mesh.clear_mesh(tetrahedra_only=True)
    assert mesh.n_tetrahedra == 0
    assert mesh.n_vertices == 5
    mesh.conjoin_mesh(eventual)
    assert mesh.n_tetrahedra == 1


# ------------------------------------------------------------------ refusals


def test_refused_tetra_changes_nothing(mesh, naive):
    """Any four vertices, unknown ones too, where they cannot be."""
    vertices = [-1, *range(min(len(naive.deleted), 8) + 1), len(naive.deleted)]
    before = words_of(mesh)
    for four in [*combinations(vertices, 4), (0, 0, 1, 2), (2, 1, 0, 1)]:
        if not naive.can_add(four):
            with pytest.raises(InputError):
                mesh.add_tetrahedron(*four)
            assert_untouched(mesh, before)


def test_refused_tetra_does_not_even_change_a_bound(bits):
    """However full the workspace of walks is, whose need is known by a bound that a refused tetra could make better."""
    mesh = HalfFaceMesh(160, bits=bits)
    for v in range(0, 160, 4):
        mesh.add_tetrahedron(v, v + 1, v + 2, v + 3)
        before = words_of(mesh)
        with pytest.raises(InputError):
            mesh.add_tetrahedron(0, 1, 2, 3)
        assert_untouched(mesh, before)
    assert mesh.check() == []


def test_refused_with_its_reason(bits):
    mesh = HalfFaceMesh.construct_mesh([[0, 1, 2, 3], [0, 1, 2, 4]], 7, bits=bits)
    mesh.remove_vertex(6)
    for four, reason in {
        (0, 1, 1, 2): "must differ",
        (0, 1, 2, 7): "no such vertex",
        (0, 1, 2, 6): "deleted",
        (3, 2, 1, 0): "such a tetra already",
        (0, 5, 2, 1): "two tetras share that face already",
    }.items():
        with pytest.raises(InputError, match=reason):
            mesh.add_tetrahedron(*four)


def test_those_before_the_refused_one_stay(bits):
    mesh = HalfFaceMesh(6, bits=bits)
    with pytest.raises(InputError, match="row 2"):
        mesh.add_tetrahedra([[0, 1, 2, 3], [1, 2, 3, 4], [1, 2, 3, 5], [0, 1, 2, 5]])
    compare(mesh, NaiveMesh.of([[0, 1, 2, 3], [1, 2, 3, 4]], 6))


@pytest.mark.parametrize(
    ("tets", "reason"),
    [
        ([[0, 1, 2, 2]], "repeats a vertex"),
        ([[0, 1, 2, 3], [3, 2, 1, 0]], "same four vertices"),
        ([[0, 1, 2, 3], [5, 6, 7, 8], [8, 6, 7, 5]], "same four vertices"),
        ([[0, 1, 2, 3], [0, 1, 2, 4], [0, 1, 2, 5]], "0.*1.*2"),
        ([[0, 1, 2, -1]], "-1"),
        ([[0, 1, 2]], "shape"),
        ([[0.0, 1.0, 2.0, 3.0]], "whole"),
        (5, "shape"),
        ([], "shape"),
    ],
)
def test_connectivity_that_is_none(tets, reason, bits):
    with pytest.raises(InputError, match=reason):
        HalfFaceMesh.construct_mesh(tets, bits=bits)


def test_connectivity_beyond_its_vertices(bits):
    with pytest.raises(InputError, match="4"):
        HalfFaceMesh.construct_mesh([[0, 1, 2, 4]], 4, bits=bits)


@pytest.mark.parametrize(
    "eventual_tets",
    [
        [[3, 2, 1, 0]],  # there is that tetra
        [[5, 6, 7, 8], [1, 2, 3, 0]],  # the same, behind a sound one
        [[1, 2, 3, 5]],  # two share (1, 2, 3)
        [[5, 6, 7, 8], [1, 2, 3, 8]],
        [[0, 1, 2, 5], [0, 1, 2, 6]],  # an inner face there, a border face here
        [[1, 2, 3, 5], [1, 2, 3, 6]],  # an inner face in both
    ],
)
def test_refused_conjoin_changes_nothing(eventual_tets, bits):
    mesh = HalfFaceMesh.construct_mesh([[0, 1, 2, 3], [1, 2, 3, 4]], 9, bits=bits)
    eventual = mesh.eventual_mesh()
    eventual.add_tetrahedra(eventual_tets)
    before, there = words_of(mesh), words_of(eventual)
    with pytest.raises(InputError, match="conjoin"):
        mesh.conjoin_mesh(eventual)
    assert_untouched(mesh, before)
    assert_untouched(eventual, there)


def test_conjoin_leaves_the_eventual_mesh_as_it_was(given, naive, bits):
    mesh = HalfFaceMesh(given.vertices, bits=bits)
    eventual = mesh.eventual_mesh()
    eventual.add_tetrahedra(given.tets)
    if len(given.tets):
        eventual.set_delete_flag(len(given.tets) - 1)
        eventual.set_tetrahedron_flag(0, 3)
        naive.tetras[frozenset(given.tets[-1].tolist())].flagged = True
        naive.tetras[frozenset(given.tets[0].tolist())].flags = {3}
    there = words_of(eventual)
    mesh.conjoin_mesh(eventual)
    assert_untouched(eventual, there)
    compare(mesh, naive)  # flags came along
    if len(given.tets):
        with pytest.raises(InputError):
            mesh.conjoin_mesh(eventual)
    assert_untouched(eventual, there)


def test_foreign_eventual_mesh_is_refused(bits):
    eventual = HalfFaceMesh(4, bits=bits).eventual_mesh()
    with pytest.raises(InputError, match="no eventual mesh of this mesh"):
        HalfFaceMesh(4, bits=bits).conjoin_mesh(eventual)


def test_eventual_mesh_outlives_the_name_of_its_main_mesh(bits):
    eventual = HalfFaceMesh(4, bits=bits).eventual_mesh()
    assert eventual.add_tetrahedron(0, 1, 2, 3) == 0
    assert eventual.check() == []


ANY_HANDLE = {
    "handle_to_index": COUNTED,
    "is_border": tuple(Element),
    "one_to_all": KINDS,
    "one_to_any": KINDS,
    "one_to_all_many": KINDS,
}
OF_ONE = {
    V: ("remove_vertex",),
    E: ("tetrahedra_around_edge",),
    T: (
        "tetrahedron_to_vertices",
        "tetrahedron_to_vertices_ordered",
        "tetrahedron_to_edges",
        "tetrahedron_to_halffaces",
        "tetrahedron_to_faces",
        "get_delete_flag",
        "set_delete_flag",
    ),
    F: ("face_to_vertices", "face_to_edges", "face_to_halffaces", "face_to_tetrahedra"),
    H: (
        "halfface_to_vertices",
        "halfface_to_edges",
        "halfface_to_face",
        "halfface_to_tetrahedron",
        "get_opposite_halfface",
    ),
}


def edited_mesh(bits):
    """With a deleted vertex, a free border half-face and a flagged tetra."""
    mesh = HalfFaceMesh.construct_mesh([[0, 1, 2, 3], [1, 2, 3, 4], [0, 6, 7, 8]], bits=bits)
    mesh.remove_vertex(5)
    mesh.set_delete_flag(0)
    mesh.garbage_collect()
    mesh.set_delete_flag(1)
    return mesh


def invalid_handles(mesh, kind):
    """Some that stand for nothing, each for another reason."""
    names = Names(mesh)
    near = [INVALID, -7, *range(30), *(b << 31 | b + 1 for b in range(9)), 1 << 31, 3 << 31 | 1, 2**70]
    near += [extension << names.bits | base for extension in range(8) for base in (0, 1, 2, 3, (1 << names.bits) - 1)]
    return [handle for handle in near if handle not in names.of[kind]]


def test_no_operation_takes_what_is_no_handle(bits):
    mesh = edited_mesh(bits)
    before = words_of(mesh)
    for kind, operations in OF_ONE.items():
        for operation, handle in product(operations, invalid_handles(mesh, kind)):
            with pytest.raises(InputError):
                getattr(mesh, operation)(handle)
    for operation, kinds in ANY_HANDLE.items():
        for kind in kinds:
            for handle in invalid_handles(mesh, kind):
                with pytest.raises(InputError):
                    ask(mesh, operation, kind, handle)
    assert_untouched(mesh, before)


def ask(mesh, operation, kind, handle):
    if operation == "one_to_all_many":
        mesh.one_to_all_many(T, kind, [*Names(mesh).of[kind], handle])
    elif operation in ("one_to_all", "one_to_any"):
        getattr(mesh, operation)(T, kind, handle)
    else:
        getattr(mesh, operation)(kind, handle)


NO_ARGUMENTS = {
    "get_neighbour_tetrahedron(0, 4)": lambda mesh: mesh.get_neighbour_tetrahedron(0, 4),
    "get_neighbour_tetrahedron(0, -1)": lambda mesh: mesh.get_neighbour_tetrahedron(0, -1),
    "set_tetrahedron_flag(0, 6)": lambda mesh: mesh.set_tetrahedron_flag(0, 6),
    "reset_tetrahedron_flag(0, -1)": lambda mesh: mesh.reset_tetrahedron_flag(0, -1),
    "flip_tetrahedron_flag(5, 0)": lambda mesh: mesh.flip_tetrahedron_flag(5, 0),
    "get_tetrahedron_flag(0, 6)": lambda mesh: mesh.get_tetrahedron_flag(0, 6),
    "find_halfface(1, 2, 5)": lambda mesh: mesh.find_halfface(1, 2, 5),  # deleted
    "find_halfface(1, 2, 99)": lambda mesh: mesh.find_halfface(1, 2, 99),
    "find_halfface_by_edge(1, -1)": lambda mesh: mesh.find_halfface_by_edge(1, -1),
    "find_tetrahedron(1, 2, 3, 5)": lambda mesh: mesh.find_tetrahedron(1, 2, 3, 5),
    "vertices_to_edge(1, 1)": lambda mesh: mesh.vertices_to_edge(1, 1),
    "vertices_to_edge(1, 5)": lambda mesh: mesh.vertices_to_edge(1, 5),
    "edge_to_vertices(INVALID)": lambda mesh: mesh.edge_to_vertices(INVALID),
    "vertex_deleted(9)": lambda mesh: mesh.vertex_deleted(9),
    "vertex_deleted(-1)": lambda mesh: mesh.vertex_deleted(-1),
    "index_to_handle(T, 2)": lambda mesh: mesh.index_to_handle(T, 2),
    "index_to_handle(E, 0)": lambda mesh: mesh.index_to_handle(E, 0),
    "handle_to_index(H, 0)": lambda mesh: mesh.handle_to_index(H, 0),
    "mesh_size(E)": lambda mesh: mesh.mesh_size(E),
    "kernel_iterator(F)": lambda mesh: mesh.kernel_iterator(F),
    "one_to_all(F, V, 1)": lambda mesh: mesh.one_to_all(F, V, 1),
    "one_to_all(V, B, 1)": lambda mesh: mesh.one_to_all(V, B, 1),
    "one_to_any(F, V, 1)": lambda mesh: mesh.one_to_any(F, V, 1),
    "is_incident(F, 1, V, 1)": lambda mesh: mesh.is_incident(F, 1, V, 1),
    "is_incident(V, 5, T, 0)": lambda mesh: mesh.is_incident(V, 5, T, 0),
    "is_incident(T, 0, V, 5)": lambda mesh: mesh.is_incident(T, 0, V, 5),
    "tetrahedra_around_edge(1 << 31 | 2, 0)": lambda mesh: mesh.tetrahedra_around_edge(
        1 << 31 | 2, 0
    ),  # it has no such edge
    "tetrahedra_around_edge(1 << 31 | 2, 7)": lambda mesh: mesh.tetrahedra_around_edge(1 << 31 | 2, 7),
    "set_delete_flags([0, 1, 2])": lambda mesh: mesh.set_delete_flags([0, 1, 2]),
    "add_vertices(-1)": lambda mesh: mesh.add_vertices(-1),
    "add_tetrahedra([[0, 1, 2]])": lambda mesh: mesh.add_tetrahedra([[0, 1, 2]]),
    'add_attribute(E, "x")': lambda mesh: mesh.add_attribute(E, "x"),
    'attribute("x")': lambda mesh: mesh.attribute("x"),
    'remove_attribute("x")': lambda mesh: mesh.remove_attribute("x"),
    "reserve(tetrahedra=-1)": lambda mesh: mesh.reserve(tetrahedra=-1),
    "HalfFaceMesh(-1)": lambda mesh: HalfFaceMesh(-1),
    "HalfFaceMesh(4, bits=48)": lambda mesh: HalfFaceMesh(4, bits=48),
}


@pytest.mark.parametrize("refused", NO_ARGUMENTS.values(), ids=NO_ARGUMENTS)
def test_other_arguments_that_are_none(refused, bits):
    mesh = edited_mesh(bits)
    before = words_of(mesh)
    with pytest.raises(InputError):
        refused(mesh)
    assert_untouched(mesh, before)


# ------------------------------------------------------------------ limits


def test_beyond_the_limit_of_32_bits_is_refused():
    """Before any memory is taken: these would need 8 GB."""
    too_many = np.broadcast_to(np.arange(4, dtype=np.int32), (2**29, 4))
    mesh = HalfFaceMesh(3)
    before = words_of(mesh)
    for refused in (
        lambda: HalfFaceMesh.construct_mesh(too_many),
        lambda: HalfFaceMesh.construct_mesh(too_many, 4),
        lambda: HalfFaceMesh.construct_mesh([[0, 1, 2, 3]], 2**29),
        lambda: HalfFaceMesh.construct_mesh([[0, 1, 2, 2**29]]),
        lambda: HalfFaceMesh(2**29),
        lambda: mesh.add_vertices(2**29),
        lambda: mesh.reserve(vertices=2**29 - 3),
        lambda: mesh.reserve(tetrahedra=2**29),
        lambda: mesh.reserve(border_halffaces=2**29),
    ):
        with pytest.raises(InputError, match=r"2\^29.*bits=64"):
            refused()
        assert_untouched(mesh, before)


def test_beyond_the_limit_of_64_bits_is_refused():
    with pytest.raises(InputError, match=r"2\^60"):
        HalfFaceMesh(2, bits=64).reserve(tetrahedra=2**60)


def test_64_bits_take_what_32_refuse():
    """Vertices past the limit, in words: memory would be taken only for those that there are."""
    mesh = HalfFaceMesh(4, bits=64)
    assert mesh.storage.connectivity.dtype == np.int64
    mesh.add_tetrahedron(0, 1, 2, 3)
    assert mesh.tetrahedron_to_halffaces(0) == tuple((1 + x) << 60 for x in range(4))
    assert HalfFaceMesh(4).storage.connectivity.dtype == np.uint32


# ------------------------------------------------------------------ attributes


def filled(mesh, names):
    """Attributes of all kinds; values[kind][name] is what each element was given."""
    dense = {kind: mesh.add_attribute(kind, f"dense {kind.value}", np.int64, default=-5) for kind in COUNTED}
    sparse = {kind: mesh.add_sparse_attribute(kind, f"sparse {kind.value}", default="none") for kind in Element}
    values = {kind: {name: 1000 + handle for handle, name in names.of[kind].items()} for kind in Element}
    for kind in Element:
        for name, value in values[kind].items():
            sparse[kind][names.handles[kind][name]] = value
            if kind in dense:
                dense[kind][names.handles[kind][name]] = value
    return dense, sparse, values


def compare_attributes(mesh, dense, sparse, values):
    """Every element that there is has what it was given, or else the default; and none that is no more is named."""
    names = Names(mesh)
    for kind, attribute in dense.items():
        assert len(attribute) == len(attribute.values) == len(mesh.kernel_iterator(kind))
        for handle, name in names.of[kind].items():
            assert attribute[handle] == values[kind].get(name, -5), (kind, handle)
    for kind, attribute in sparse.items():
        there = {handle: values[kind][name] for handle, name in names.of[kind].items() if name in values[kind]}
        assert dict(attribute.items()) == there
        assert sorted(attribute) == sorted(there)
        assert len(attribute) == len(there)
        for handle in names.of[kind]:
            assert attribute[handle] == there.get(handle, "none"), (kind, handle)
            assert (handle in attribute) == (handle in there)


def test_attributes_follow_collection(mesh, names, rng):
    dense, sparse, values = filled(mesh, names)
    compare_attributes(mesh, dense, sparse, values)
    mesh.set_delete_flags(np.flatnonzero(rng.random(mesh.n_tetrahedra) < 0.4))
    mesh.garbage_collect()
    compare_attributes(mesh, dense, sparse, values)


def test_attributes_of_what_comes_are_the_default(mesh, naive, names):
    """A component of its own beside the others, then what was collected comes back as if it had never been there."""
    dense, sparse, values = filled(mesh, names)
    mesh.add_tetrahedron(*mesh.add_vertices(4).tolist())
    compare_attributes(mesh, dense, sparse, values)
    gone = [tetra.vertices for tetra in list(naive.tetras.values())[::2]]
    mesh.set_delete_flags(np.array([mesh.find_tetrahedron(*four) for four in gone], np.int64))
    mesh.garbage_collect()
    left = Names(mesh).of
    values = {kind: {name: v for name, v in values[kind].items() if name in left[kind].values()} for kind in Element}
    for four in gone:
        mesh.add_tetrahedron(*four)
        there = Names(mesh).of
        values[B] = {name: v for name, v in values[B].items() if name in there[B].values()}
        values[H] = {name: v for name, v in values[H].items() if name in there[H].values()}
        compare_attributes(mesh, dense, sparse, values)


def test_attributes_follow_a_conjoin(bits):
    mesh = HalfFaceMesh.construct_mesh([[0, 1, 2, 3], [1, 2, 3, 4]], 7, bits=bits)
    dense, sparse, values = filled(mesh, Names(mesh))
    eventual = mesh.eventual_mesh()
    eventual.add_tetrahedra([[0, 1, 2, 5], [0, 1, 5, 6]])
    mesh.conjoin_mesh(eventual)
    joined = frozenset({0, 1, 2})  # is on the border no more
    values[B].pop((joined, None))
    values[H].pop((joined, None))
    compare_attributes(mesh, dense, sparse, values)


def test_reused_vertex_has_the_default_again(bits):
    mesh = HalfFaceMesh(3, bits=bits)
    dense, sparse, values = filled(mesh, Names(mesh))
    mesh.remove_vertex(1)
    values[V].pop(1)
    compare_attributes(mesh, dense, sparse, values)
    assert mesh.add_vertex() == 1
    compare_attributes(mesh, dense, sparse, values)


@pytest.mark.parametrize("tetrahedra_only", [False, True])
def test_attributes_after_clearing(mesh, names, tetrahedra_only):
    dense, sparse, values = filled(mesh, names)
    mesh.clear_mesh(tetrahedra_only)
    values = {kind: values[kind] if kind == V and tetrahedra_only else {} for kind in Element}
    compare_attributes(mesh, dense, sparse, values)
    mesh.add_vertices(5)
    mesh.add_tetrahedron(*list(mesh.vertices)[:4])
    compare_attributes(mesh, dense, sparse, values)


def test_dense_attributes_have_shapes_and_types(bits):
    mesh = HalfFaceMesh.construct_mesh(ring().tets, bits=bits)
    points = mesh.add_attribute(V, "point", shape=(3,))
    colours = mesh.add_attribute(T, "colour", np.uint8, default=7)
    normals = mesh.add_attribute(B, "normal", np.float32, (2, 3), default=[[1, 2, 3], [4, 5, 6]])
    assert points.values.shape == (7, 3)
    assert points.values.dtype == np.float64
    assert not points.values.any()
    assert colours.values.tolist() == [7] * 5
    assert normals[3].tolist() == [[1, 2, 3], [4, 5, 6]]
    points[[1, 2]] = [[1, 2, 3], [4, 5, 6]]
    assert points[2].tolist() == [4, 5, 6]
    mesh.add_vertices(2000)
    assert points.values.shape == (2007, 3)
    assert points[2].tolist() == [4, 5, 6]
    assert mesh.attribute("colour") is colours


def test_attributes_by_name(bits):
    mesh = HalfFaceMesh(2, bits=bits)
    mesh.add_attribute(V, "one")
    mesh.add_sparse_attribute(E, "other")
    for name in ("one", "other"):
        with pytest.raises(InputError, match="already"):
            mesh.add_attribute(V, name)
        with pytest.raises(InputError, match="already"):
            mesh.add_sparse_attribute(V, name)
        mesh.remove_attribute(name)
        with pytest.raises(InputError, match="no attribute"):
            mesh.attribute(name)
    mesh.add_attribute(T, "one")


def test_sparse_attributes_forget_what_is_deleted_from_them(bits):
    mesh = HalfFaceMesh.construct_mesh(two_components_at_a_vertex().tets, bits=bits)
    attribute = mesh.add_sparse_attribute(E, "length")
    edge = mesh.vertices_to_edge(0, 3)
    attribute[edge] = 2.5
    assert edge in attribute
    del attribute[edge]
    assert edge not in attribute
    assert attribute[edge] is None
    assert list(attribute) == []


def test_sparse_attributes_take_no_invalid_handle(bits):
    mesh = edited_mesh(bits)
    for kind in Element:
        attribute = mesh.add_sparse_attribute(kind, kind.value)
        for handle in invalid_handles(mesh, kind):
            with pytest.raises(InputError):
                attribute[handle] = 1
            with pytest.raises(InputError):
                attribute[handle]
        assert len(attribute) == 0


# ------------------------------------------------------------------ larger


def test_a_large_fan(bits):
    """A vertex with more tetras than the first table of a walk takes."""
    count = 500
    mesh = HalfFaceMesh(count + 2, bits=bits)
    around = [(0, 1, 2 + n, 2 + (n + 1) % count) for n in range(count)]
    mesh.add_tetrahedra(around)
    assert mesh.check() == []
    assert len(mesh.one_to_all(T, V, 1)) == count
    assert len(mesh.tetrahedra_around_edge(1)) == count  # the edge (0, 1)
    mesh.set_delete_flags(range(0, count, 2))
    mesh.garbage_collect()
    assert mesh.check() == []
    assert len(mesh.one_to_all(T, V, 1)) == count // 2
    assert mesh.n_border_halffaces == 2 * count
    assert len(mesh.tetrahedra_around_edge(1)) == 1


def test_room_for_a_kernel_that_adds(bits):
    mesh = HalfFaceMesh(400, bits=bits)
    mesh.reserve(tetrahedra=100)
    storage = mesh.storage
    for t in range(100):  # each a component of its own
        assert edit.add_tetrahedron(storage, 4 * t, 4 * t + 1, 4 * t + 2, 4 * t + 3) == t
    assert mesh.check() == []
    assert mesh.n_tetrahedra == 100


def test_attributes_follow_what_a_kernel_added(bits):
    mesh = HalfFaceMesh.construct_mesh([[0, 1, 2, 3]], 8, bits=bits)
    of_tetras, of_border = mesh.add_attribute(T, "q", default=7), mesh.add_attribute(B, "b", default=8)
    mesh.reserve(tetrahedra=2)
    edit.add_tetrahedron(mesh.storage, 1, 2, 3, 4)
    edit.add_tetrahedron(mesh.storage, 4, 5, 6, 7)
    mesh.set_delete_flags([0])
    assert mesh.garbage_collect() == 1
    assert of_tetras.values.tolist() == [7, 7]
    assert set(of_border[mesh.border_halffaces.handles].tolist()) == {8}
    assert mesh.check() == []


def test_a_dense_attribute_of_nothing_is_refused(bits):
    values = HalfFaceMesh.construct_mesh([[0, 1, 2, 3]], bits=bits).add_attribute(T, "q")
    for handle in (INVALID, 1, [0, -1], 0.0, None, "0"):
        with pytest.raises(InputError):
            values[handle]
        with pytest.raises(InputError):
            values[handle] = 1
    values[:] = 5
    assert values[0] == values[[0]] == 5


def test_growing_one_by_one_leaves_little_behind(bits):
    """What walks need is not in proportion to how many were added."""
    mesh = HalfFaceMesh(2000, bits=bits)
    for t in range(0, 2000, 4):
        mesh.add_tetrahedra([[t, t + 1, t + 2, t + 3]])
    sizes = mesh.structure_bytes()
    assert sizes["queue"][1] + sizes["table"][1] < 60_000
    assert mesh.check() == []


def test_sets_go_where_many_handles_go(bits):
    mesh = HalfFaceMesh.construct_mesh([[0, 1, 2, 3], [1, 2, 3, 4], [2, 3, 4, 5]], bits=bits)
    mesh.set_delete_flags(mesh.one_to_all(T, V, 2) - mesh.one_to_all(T, V, 5))
    assert list(mesh.tetrahedra) == [2]
