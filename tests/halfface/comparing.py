"""All that a half-face mesh answers, beside the naive twin: one function for each group of questions."""

from itertools import combinations, permutations, product

import numpy as np

from tests.halfface.naive import KINDS, Names
from tetrabench.backends.tetra.halfface import INVALID, Element

V, E, H, T, F, B = (
    Element.VERTEX,
    Element.EDGE,
    Element.HALFFACE,
    Element.TETRAHEDRON,
    Element.FACE,
    Element.BORDER_HALFFACE,
)
COUNTED = (V, T, B)
"""The kinds with an index of their own."""


def compare(mesh, naive, comparisons=None):
    """Everything, or these comparisons alone; returns what the handles stand for."""
    assert mesh.check() == []
    names = Names(mesh)
    for comparison in comparisons or COMPARISONS:
        comparison(mesh, naive, names)
    return names


def compare_elements(mesh, naive, names):
    """There are the same ones; no two handles stand for one."""
    for kind in Element:
        assert set(names.of[kind].values()) == naive.elements(kind), kind
        assert len(names.handles[kind]) == len(names.of[kind]), kind


def compare_sizes(mesh, naive, names):
    for kind in (*COUNTED, H):
        assert mesh.mesh_size(kind) == len(naive.elements(kind)), kind
    assert mesh.n_vertices == len(naive.elements(V))
    assert mesh.n_tetrahedra == len(naive.tetras)
    assert mesh.n_border_halffaces == len(naive.elements(B))
    assert mesh.kernel_iterator(V) == range(len(naive.deleted))
    assert mesh.kernel_iterator(T) == range(len(naive.tetras))
    assert set(names.of[B]) <= set(mesh.kernel_iterator(B))
    for used, reserved in mesh.structure_bytes().values():
        assert 0 <= used <= reserved


def compare_iterators(mesh, naive, names):
    live = [t for t, name in names.of[T].items() if not naive.tetras[name].flagged]
    for iterator, expected in (
        (mesh.vertices, sorted(names.of[V])),
        (mesh.tetrahedra, sorted(live)),
        (mesh.border_halffaces, sorted(names.of[B])),
    ):
        assert list(iterator) == expected
        assert list(reversed(iterator)) == expected[::-1]
        assert iterator.handles.tolist() == expected
        assert len(iterator) == len(expected)
        assert bool(iterator) == bool(expected)


def compare_validity(mesh, naive, names):
    """Of every handle that there could be, and some more."""
    bases = [*range(len(naive.deleted) + 4 * len(naive.tetras) + 2), (1 << names.bits) - 1]
    numbers = [extension << names.bits | base for extension in range(8) for base in bases]
    pairs = [a << 31 | b for a in range(len(naive.deleted) + 1) for b in range(len(naive.deleted) + 1)]
    for kind in Element:
        for handle in {INVALID, -2, 1 << 62, *bases, *numbers, *pairs}:
            assert mesh.is_valid(kind, handle) == (handle in names.of[kind]), (kind, handle)
    for v, deleted in enumerate(naive.deleted):
        assert mesh.vertex_deleted(v) == deleted


def compare_indices(mesh, naive, names):
    for kind in COUNTED:
        for handle in names.of[kind]:
            assert mesh.index_to_handle(kind, mesh.handle_to_index(kind, handle)) == handle
        indices = {mesh.handle_to_index(kind, handle) for handle in names.of[kind]}
        assert indices <= set(mesh.kernel_iterator(kind))
        assert len(indices) == len(names.of[kind])


def compare_flags(mesh, naive, names):
    for t, name in names.of[T].items():
        assert mesh.get_delete_flag(t) is naive.tetras[name].flagged
        assert {k for k in range(6) if mesh.get_tetrahedron_flag(t, k)} == naive.tetras[name].flags


def compare_conversions(mesh, naive, names):
    handles = names.handles
    for v, w in combinations(sorted(names.of[V]), 2):
        assert mesh.vertices_to_edge(v, w) == mesh.vertices_to_edge(w, v) == v << 31 | w
    for e, name in names.of[E].items():
        assert mesh.edge_to_vertices(e) == tuple(sorted(name))
    for t, name in names.of[T].items():
        faces = [frozenset(name) - {v} for v in sorted(name, reverse=True)]  # half-face X lacks vertex 3 - X
        assert mesh.tetrahedron_to_vertices(t) == tuple(sorted(name))
        assert mesh.tetrahedron_to_vertices_ordered(t) == naive.tetras[name].vertices
        assert edges_of(mesh.tetrahedron_to_edges(t), names, name)
        assert mesh.tetrahedron_to_halffaces(t) == tuple(handles[H][face, name] for face in faces)
        assert mesh.tetrahedron_to_faces(t) == tuple(handles[F][face] for face in faces)
        for k, face in enumerate(faces):
            assert mesh.get_neighbour_tetrahedron(t, k) == handles[T].get(naive.neighbour(name, face), INVALID)
    for f, face in names.of[F].items():
        tetras = naive.sharing(face)
        halffaces = {(face, tetra) for tetra in tetras} | ({(face, None)} if len(tetras) == 1 else set())
        assert mesh.face_to_vertices(f) == tuple(sorted(face))
        assert edges_of(mesh.face_to_edges(f), names, face)
        assert all_of(mesh.face_to_halffaces(f), names.of[H], halffaces)
        assert all_of(mesh.face_to_tetrahedra(f), names.of[T], set(tetras))
    for h, (face, tetra) in names.of[H].items():
        assert mesh.halfface_to_vertices(h) == tuple(sorted(face))
        assert edges_of(mesh.halfface_to_edges(h), names, face)
        assert mesh.halfface_to_face(h) == handles[F][face]
        assert mesh.halfface_to_tetrahedron(h) == handles[T].get(tetra, INVALID)
        assert mesh.get_opposite_halfface(h) == handles[H][naive.opposite((face, tetra))]
    expected = [naive.tetras[name].vertices for _, name in sorted(names.of[T].items())]
    assert mesh.connectivity.tolist() == [list(vertices) for vertices in expected]
    assert mesh.connectivity.dtype == np.int64
    assert mesh.connectivity.shape == (len(expected), 4)


def edges_of(found, names, vertices):
    return all_of(found, names.of[E], {frozenset(pair) for pair in combinations(vertices, 2)})


def all_of(found, meaning, expected):
    """Whether handles, each once, stand for what is expected."""
    assert isinstance(found, tuple)
    return len(found) == len(expected) and {meaning[handle] for handle in found} == expected


def compare_finds(mesh, naive, names):
    """An element's own vertices in any order, and any two, three, four vertices (of the first few, there are so many)."""
    vertices, handles = sorted(names.of[V]), names.handles
    for pair in permutations(vertices, 2):
        found, edge = mesh.find_halfface_by_edge(*pair), frozenset(pair)
        if edge not in handles[E]:
            assert found == INVALID
        else:
            assert edge < names.of[H][found][0]
            assert (found in names.of[B]) == naive.is_border(E, edge)
    for face in {frozenset(triple) for triple in combinations(vertices[:10], 3)} | set(handles[F]):
        expected = handles[B].get((face, None), handles[F].get(face, INVALID))
        for given in permutations(face) if face in handles[F] else [face]:
            assert mesh.find_halfface(*given) == expected
    for tetra in {frozenset(four) for four in combinations(vertices[:10], 4)} | set(handles[T]):
        expected = handles[T].get(tetra, INVALID)
        for given in permutations(tetra) if expected != INVALID else [tetra]:
            assert mesh.find_tetrahedron(*given) == expected
    for v, w, x in product(vertices[:3], repeat=3):  # nothing has a vertex twice
        if len({v, w, x}) < 3:
            assert mesh.find_halfface(v, w, x) == INVALID
            assert mesh.find_tetrahedron(v, w, x, vertices[-1]) == INVALID
        if v == w:
            assert mesh.find_halfface_by_edge(v, w) == INVALID


def compare_border(mesh, naive, names):
    for kind in Element:
        for handle, name in names.of[kind].items():
            assert mesh.is_border(kind, handle) is naive.is_border(kind, name), (kind, handle)


def compare_incidence(mesh, naive, names):
    """All that belongs to anything: asked at once, and one of each."""
    for target, source in product(KINDS, KINDS):
        given = list(names.of[source])
        starts, found = mesh.one_to_all_many(target, source, np.array(given, np.int64))
        assert (starts[0], starts[-1], len(starts)) == (0, len(found), len(given) + 1)
        for n, handle in enumerate(given):
            around = naive.one_to_all(target, source, names.of[source][handle])
            expected = sorted(names.handles[target][name] for name in around)
            assert found[starts[n] : starts[n + 1]].tolist() == expected, (target, source, handle)
            any_of_them = mesh.one_to_any(target, source, handle)
            assert any_of_them in expected if expected else any_of_them == INVALID, (target, source, handle)


def compare_circulators(mesh, naive, names):
    """A full turn is one fan of the edge, in an order in which each shares a face with the next."""
    for edge, name in names.of[E].items():
        fans = naive.components(name)
        assert {names.of[T][t] for t in mesh.tetrahedra_around_edge(edge)} in fans
        for fan in fans:
            border = {face for tetra in fan for face in faces_at(tetra, name) if naive.is_border(F, face)}
            assert len(border) in (0, 2) or len(fan) == 1
            for start in fan:
                circulator = mesh.tetrahedra_around_edge(edge, names.handles[T][start])
                turn = list(circulator)
                tetras = [names.of[T][t] for t in turn]
                assert len(circulator) == len(fan) == len(tetras)
                assert set(tetras) == fan
                steps = list(zip(tetras, tetras[1:] + tetras[:1], strict=True))
                for one, other in steps[:-1] if border else steps:
                    assert len(one & other) == 3
                    assert name < one & other
                if border:
                    assert faces_at(tetras[0], name) & border
                    assert faces_at(tetras[-1], name) & border
                assert_cyclic(circulator, turn)


def faces_at(tetra, edge):
    """The two faces of a tetra that have an edge."""
    return {edge | {v} for v in tetra - edge}


def assert_cyclic(circulator, turn):
    assert circulator.current == turn[0]
    assert [circulator.next() for _ in turn] == turn[1:] + turn[:1]
    assert [circulator.previous() for _ in turn] == turn[::-1]
    assert circulator.current == turn[0]
    if len(turn) > 1:
        circulator.next()
        assert list(circulator) == turn[1:] + turn[:1]  # from where it stands
        assert circulator.current == turn[1]


COMPARISONS = (
    compare_elements,
    compare_sizes,
    compare_iterators,
    compare_validity,
    compare_indices,
    compare_flags,
    compare_conversions,
    compare_finds,
    compare_border,
    compare_incidence,
    compare_circulators,
)


USED = {"connectivity": 0, "adjacency": 0, "bhf2hf": 2, "v2hf": 5, "vborders": 5, "v2nhf": 8}
"""The arrays that are content, and which counter says how many of their rows are in use; the others are workspace of walks."""


def words_of(mesh):
    """Copies of all that is content: words in use, and the counters."""
    counters = mesh.storage.counters
    words = {name: getattr(mesh.storage, name)[: counters[place]].copy() for name, place in USED.items()}
    return words | {"counters": counters.copy()}


def assert_untouched(mesh, before):
    """Bit for bit as `words_of` found it."""
    after = words_of(mesh)
    for name, words in before.items():
        assert np.array_equal(words, after[name]), f"{name}: {words.tolist()} became {after[name].tolist()}"
        assert words.dtype == after[name].dtype
