"""Random changes of a half-face mesh, its eventual meshes and its attributes, beside the naive twin.

After each step the mesh is audited, and what it holds is compared; now and then, and in the end, everything that it answers.
What is refused leaves it bit for bit as it was. Handles stay what they are until a collection; then elements are found
again by their vertices.
"""

import numpy as np
import pytest
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, invariant, precondition, rule

from tests.halfface.comparing import (
    COUNTED,
    B,
    E,
    H,
    T,
    V,
    assert_untouched,
    compare,
    compare_elements,
    compare_flags,
    compare_iterators,
    compare_sizes,
    words_of,
)
from tests.halfface.meshes import MESHES
from tests.halfface.naive import KINDS, NaiveMesh, Names, RefusedError
from tetrabench.backends.tetra.halfface import Element, HalfFaceMesh
from tetrabench.backends.tetra.halfface.storage import LARGEST_FAN
from tetrabench.errors import InputError

PICK = st.integers(0, 10**6)
FOUR = st.tuples(PICK, PICK, PICK, PICK)
NOBODY = np.empty((0, 4), np.int64)
SMALL = sorted(set(MESHES) - {"box", "torus_link"})
MOST_VERTICES = 12


class HalfFaces(RuleBasedStateMachine):
    """The same changes on both sides; whatever can be asked is answered alike."""

    @initialize(
        name=st.sampled_from(SMALL), bits=st.sampled_from([32, 64]), reuse=st.booleans(), one_by_one=st.booleans()
    )
    def build(self, name, bits, reuse, one_by_one):
        given = MESHES[name]()
        self.naive = NaiveMesh.of(given.tets, given.vertices, reuse_vertices=reuse)
        if one_by_one:
            self.mesh = HalfFaceMesh(given.vertices, bits=bits, reuse_vertices=reuse)
            self.mesh.add_tetrahedra(given.tets)
        else:
            self.mesh = HalfFaceMesh.construct_mesh(given.tets, given.vertices, bits=bits, reuse_vertices=reuse)
        self.eventual = []
        self.dense = {
            kind: self.mesh.add_attribute(kind, f"dense {kind.value}", np.int32, default=-1) for kind in COUNTED
        }
        self.sparse = {
            kind: self.mesh.add_sparse_attribute(kind, f"sparse {kind.value}", default=-1) for kind in Element
        }
        self.values = {attribute: {} for attribute in (*self.dense.values(), *self.sparse.values())}
        self.known = Names(self.mesh).of

    # ------------------------------------------------------------------ vertices

    @precondition(lambda self: len(self.naive.deleted) < MOST_VERTICES)
    @rule(count=st.integers(1, 3))
    def add_vertices(self, count):
        assert self.mesh.add_vertices(count).tolist() == [self.naive.add_vertex() for _ in range(count)]

    @rule(number=PICK)
    def remove_vertex(self, number):
        v = number % (len(self.naive.deleted) + 1)  # one of them is none
        self.both(lambda naive: naive.remove_vertex(v), lambda mesh: mesh.remove_vertex(v))

    # ------------------------------------------------------------------ tetras

    def both(self, on_naive, on_mesh, naive=None, mesh=None):
        """A change on both sides; refused on one, it is refused on the other, and changes nothing."""
        naive, mesh = (self.naive, self.mesh) if mesh is None else (naive, mesh)
        if mesh is not self.mesh:
            mesh.add_tetrahedra(
                NOBODY
            )  # so that it knows the vertices of its main mesh, whatever becomes of the change
        before = [(each, words_of(each)) for each in (self.mesh, mesh)]
        try:
            on_naive(naive)
        except RefusedError:
            with pytest.raises(InputError):
                on_mesh(mesh)
            for each, words in before:
                assert_untouched(each, words)
            return None
        return on_mesh(mesh)

    def add(self, four, naive=None, mesh=None):
        size = (mesh or self.mesh).n_tetrahedra
        added = self.both(
            lambda naive: naive.add_tetrahedron(four), lambda mesh: mesh.add_tetrahedron(*four), naive, mesh
        )
        assert added in (None, size)

    @rule(four=FOUR)
    def add_any(self, four):
        self.add(tuple(v % (len(self.naive.deleted) + 1) for v in four))

    @rule(number=PICK, v=PICK, turns=st.integers(0, 3))
    def add_on_a_face(self, number, v, turns):
        """On one face of some tetra, on the border or not."""
        faces = sorted(map(sorted, self.naive.elements(Element.FACE)))
        if faces:
            four = (*faces[number % len(faces)], v % len(self.naive.deleted))
            self.add(four[turns:] + four[:turns])

    @rule(number=PICK)
    def add_again(self, number):
        tetras = list(self.naive.tetras.values())
        if tetras:
            self.add(tetras[number % len(tetras)].vertices[::-1])

    @rule(fours=st.lists(FOUR, min_size=2, max_size=4))
    def add_many(self, fours):
        """Up to the first refused one."""
        rows = [tuple(v % max(len(self.naive.deleted), 4) for v in four) for four in fours]
        refused = None
        for n, four in enumerate(rows):
            try:
                self.naive.add_tetrahedron(four)
            except RefusedError:
                refused = n
                break
        before = self.mesh.n_tetrahedra
        if refused is None:
            assert self.mesh.add_tetrahedra(rows).tolist() == list(range(before, before + len(rows)))
        else:
            with pytest.raises(InputError, match=f"row {refused}|vertices from"):
                self.mesh.add_tetrahedra(rows)

    def pick(self, number):
        """Some tetra, its handle and its naive twin."""
        names = Names(self.mesh).of[T]
        t = number % max(len(names), 1)
        return (t, self.naive.tetras[names[t]]) if names else None

    @rule(number=PICK, value=st.sampled_from([True, True, True, False]))
    def flag(self, number, value):
        if picked := self.pick(number):
            self.mesh.set_delete_flag(picked[0], value)
            picked[1].flagged = value

    @rule(number=PICK, k=st.integers(0, 5), change=st.sampled_from(["set", "reset", "flip"]))
    def user_flag(self, number, k, change):
        if picked := self.pick(number):
            getattr(self.mesh, f"{change}_tetrahedron_flag")(picked[0], k)
            flags = picked[1].flags
            flags ^= {k} & flags if change == "reset" else {k} - flags if change == "set" else {k}

    @rule()
    def garbage_collect(self):
        gone = self.naive.garbage_collect()
        before = words_of(self.mesh)
        assert self.mesh.garbage_collect() == gone
        if gone == 0:
            assert_untouched(self.mesh, before)
        self.known = {V: self.known[V], E: self.known[E]}  # handles of the others are invalid now

    @rule(number=PICK, share=st.sampled_from([1, 2, 3]))
    def collect_many(self, number, share):
        """Flag every so many-th tetra, and collect."""
        for t in range(number % share, self.mesh.n_tetrahedra, share):
            self.flag(t, True)
        self.garbage_collect()

    @rule(tetrahedra_only=st.booleans(), sure=st.sampled_from([False, False, False, True]))
    def clear_mesh(self, tetrahedra_only, sure):
        if sure:
            self.both(lambda naive: naive.clear_mesh(tetrahedra_only), lambda mesh: mesh.clear_mesh(tetrahedra_only))
            self.known = {}

    @rule(count=st.integers(0, 2000))
    def reserve(self, count):
        before = words_of(self.mesh)
        self.mesh.reserve(vertices=count, tetrahedra=count, border_halffaces=count)
        before["counters"][LARGEST_FAN] = self.mesh.storage.counters[LARGEST_FAN]  # a bound, which may be counted anew
        assert_untouched(self.mesh, before)

    # ------------------------------------------------------------------ eventual meshes

    @precondition(lambda self: len(self.eventual) < 2)
    @rule()
    def make_eventual(self):
        self.eventual.append((self.mesh.eventual_mesh(), self.naive.eventual_mesh()))

    @precondition(lambda self: self.eventual)
    @rule(number=PICK, four=FOUR)
    def add_any_to_eventual(self, number, four):
        mesh, naive = self.eventual[number % len(self.eventual)]
        self.add(tuple(v % (len(self.naive.deleted) + 1) for v in four), naive, mesh)

    @precondition(lambda self: self.eventual)
    @rule(number=PICK, v=PICK, of_main=st.booleans())
    def add_on_a_face_to_eventual(self, number, v, of_main):
        """On a face of its own, or on one of the main mesh, so that something is to be joined or refused."""
        mesh, naive = self.eventual[number % len(self.eventual)]
        faces = sorted(map(sorted, (self.naive if of_main else naive).elements(Element.FACE)))
        if faces:
            self.add((*faces[number % len(faces)], v % len(self.naive.deleted)), naive, mesh)

    @precondition(lambda self: self.eventual)
    @rule(number=PICK, collect=st.booleans())
    def flag_in_eventual(self, number, collect):
        mesh, naive = self.eventual[number % len(self.eventual)]
        names = Names(mesh).of[T]
        if names:
            mesh.set_delete_flag(number % len(names))
            naive.tetras[names[number % len(names)]].flagged = True
        if collect:
            assert mesh.garbage_collect() == naive.garbage_collect()

    @precondition(lambda self: self.eventual)
    @rule(number=PICK)
    def conjoin(self, number):
        mesh, naive = self.eventual[number % len(self.eventual)]
        before, there = self.mesh.n_tetrahedra, words_of(mesh)
        added = self.both(lambda main: main.conjoin_mesh(naive), lambda main: main.conjoin_mesh(mesh))
        assert_untouched(mesh, there)
        if added is not None:
            assert added.tolist() == list(range(before, before + len(naive.tetras)))

    @precondition(lambda self: self.eventual)
    @rule(number=PICK, forget=st.booleans())
    def drop_eventual(self, number, forget):
        """Either it is emptied, or nobody knows it any more; its vertices are free then."""
        mesh, naive = self.eventual[number % len(self.eventual)]
        naive.tetras.clear()
        if forget:
            self.eventual.remove((mesh, naive))
            self.naive.eventual.remove(naive)
        else:
            mesh.clear_mesh()

    # ------------------------------------------------------------------ attributes

    @rule(number=PICK, value=st.integers(0, 99), sparse=st.booleans(), kind=st.sampled_from(list(Element)))
    def set_value(self, number, value, sparse, kind):
        names = Names(self.mesh).of[kind]
        if names and (sparse or kind in self.dense):
            attribute = (self.sparse if sparse else self.dense)[kind]
            handle = list(names)[number % len(names)]
            attribute[handle] = value
            self.values[attribute][names[handle]] = value

    @rule(number=PICK, kind=st.sampled_from(list(Element)))
    def delete_value(self, number, kind):
        names, attribute = Names(self.mesh).of[kind], self.sparse[kind]
        if names:
            handle = list(names)[number % len(names)]
            del attribute[handle]
            self.values[attribute].pop(names[handle], None)

    # ------------------------------------------------------------------ questions

    @rule()
    def ask_everything(self):
        """Costly, so not after each step, but once in the end."""
        compare(self.mesh, self.naive)

    def teardown(self):
        if hasattr(self, "mesh"):
            self.ask_everything()

    @rule(number=PICK, kinds=st.tuples(st.sampled_from(KINDS), st.sampled_from(KINDS)))
    def ask_whether_incident(self, number, kinds):
        names, (target, source) = Names(self.mesh).of, kinds
        if names[source]:
            y = list(names[source])[number % len(names[source])]
            expected = self.naive.one_to_all(target, source, names[source][y])
            for x, name in names[target].items():
                assert self.mesh.is_incident(target, x, source, y) is (name in expected)

    @invariant()
    def main_agrees(self):
        if not hasattr(self, "mesh"):
            return
        names = compare(self.mesh, self.naive, (compare_elements, compare_sizes, compare_iterators, compare_flags))
        for kind, known in self.known.items():
            for handle, name in known.items():
                if name in names.handles[kind]:
                    assert names.handles[kind][name] == handle or kind == Element.FACE, (kind, handle)
        self.known = names.of
        for attribute, values in self.values.items():
            kind = attribute.element
            self.values[attribute] = values = {n: v for n, v in values.items() if n in names.handles[kind]}
            for handle, name in names.of[kind].items():
                assert attribute[handle] == values.get(name, -1), (attribute, handle)
        for kind, attribute in self.sparse.items():
            expected = {names.handles[kind][name]: value for name, value in self.values[attribute].items()}
            assert dict(attribute.items()) == expected

    @invariant()
    def eventual_agree(self):
        for mesh, naive in getattr(self, "eventual", ()):
            assert mesh.check() == []
            names = Names(mesh)
            for kind in (T, H, B, E):
                assert set(names.of[kind].values()) == naive.elements(kind)
            for t, name in names.of[T].items():
                assert mesh.tetrahedron_to_vertices_ordered(t) == naive.tetras[name].vertices
                assert mesh.get_delete_flag(t) == naive.tetras[name].flagged


TestHalfFaces = HalfFaces.TestCase
