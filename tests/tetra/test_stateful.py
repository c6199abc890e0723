"""Random edits on all contestants and the oracle, side by side; every structure is audited after every step."""

import contextlib

import numpy as np
import pytest
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, invariant, rule

from tests.meshes import MESHES
from tests.oracle import OracleNet, diagonal
from tetrabench.backends.tetra import CONTESTANTS as OURS
from tetrabench.errors import InputError
from tetrabench.tetra.net import TetraNet

PICK = st.integers(0, 10**6)
COORDINATE = st.floats(-1.5, 1.5).map(lambda x: round(x, 3))


class AllTogether(RuleBasedStateMachine):
    """The same edits everywhere; whatever can be asked must be answered alike."""

    @initialize(name=st.sampled_from(sorted(MESHES)))
    def build(self, name):
        mesh = MESHES[name]()
        self.oracle = OracleNet(mesh.points, mesh.tets)
        self.nets = {c.name: TetraNet(mesh, c) for c in OURS}
        # oracle's id -> ref, for each contestant: refs of survivors must stay what they are, but where `find_anew` says
        self.refs = {name: dict(enumerate(net.refs.tolist())) for name, net in self.nets.items()}
        self.gone = []

    def find_anew(self):
        """Find tetras by their vertices, where refs may have changed."""
        for name, net in self.nets.items():
            if not net.contestant.stable_refs:
                by_vertices = {net.vertices_of(ref): ref for ref in net.refs.tolist()}
                self.refs[name] = {t: by_vertices[vertices] for t, vertices in self.oracle.tetras.items()}

    def pick(self, number):
        ids = list(self.oracle.tetras)
        return ids[number % len(ids)] if ids else None

    @rule(number=PICK)
    def delete(self, number):
        t = self.pick(number)
        if t is None:
            return
        self.gone.append(self.oracle.tetras[t])
        self.oracle.delete(t)
        for name, net in self.nets.items():
            net.delete(self.refs[name].pop(t))

    @rule()
    def delete_last(self):
        lasts = {tuple(sorted(net.vertices_of(net.last))) for net in self.nets.values() if len(net)}
        for vertices in lasts:  # contestants differ in which is the last, once there were insertions
            t = next(t for t, there in self.oracle.tetras.items() if tuple(sorted(there)) == vertices)
            self.delete(list(self.oracle.tetras).index(t))

    @rule(vertices=st.tuples(PICK, PICK, PICK, PICK))
    def insert_any(self, vertices):
        self.insert(tuple(v % (len(self.oracle.points) + 1) for v in vertices))  # one of them is no point

    @rule(number=PICK)
    def insert_again(self, number):
        if self.gone:
            self.insert(self.gone[number % len(self.gone)])

    def insert(self, vertices):
        if not self.oracle.can_insert(vertices):
            for net in self.nets.values():
                with pytest.raises(InputError):
                    net.insert(*vertices)
            self.find_anew()
            return
        t = self.oracle.insert(vertices)
        for name, net in self.nets.items():
            self.refs[name][t] = net.insert(*vertices)
            assert net.vertices_of(self.refs[name][t]) == vertices
        self.find_anew()

    @rule(number=PICK)
    def split(self, number):
        t = self.pick(number)
        if t is None:
            return
        children = self.oracle.split(t)
        for name, net in self.nets.items():
            assert net.split([self.refs[name][t]]) == (0 if children else 1)
            if children and net.contestant.stable_refs:
                del self.refs[name][t]
                by_vertices = {net.vertices_of(ref): ref for ref in net.refs.tolist()}
                for child in children:
                    self.refs[name][child] = by_vertices[self.oracle.tetras[child]]
        self.find_anew()

    @rule(numbers=st.lists(PICK, max_size=4))
    def delete_many(self, numbers):
        chosen = list(dict.fromkeys(t for t in map(self.pick, numbers) if t is not None))
        for t in chosen:
            self.gone.append(self.oracle.tetras[t])
            self.oracle.delete(t)
        for name, net in self.nets.items():
            net.delete_many([self.refs[name].pop(t) for t in chosen])

    @rule(numbers=st.lists(PICK, min_size=1, max_size=4))
    def insert_many(self, numbers):
        rows = [self.gone[number % len(self.gone)] for number in numbers if self.gone]
        born = []
        for vertices in rows:
            if not self.oracle.can_insert(vertices):
                for t in born:
                    self.oracle.delete(t)
                for net in self.nets.values():
                    with pytest.raises(InputError, match="cannot insert the tetra"):
                        net.insert_many(rows)
                self.find_anew()
                return
            born.append(self.oracle.insert(vertices))
        for name, net in self.nets.items():
            self.refs[name].update(zip(born, net.insert_many(rows).tolist(), strict=True))
        self.find_anew()

    @rule(number=PICK, point=st.tuples(COORDINATE, COORDINATE, COORDINATE))
    def change_in_vain(self, number, point):
        """An edit that fails: refs, order and all else are what they were."""
        t = self.pick(number)
        if t is None:
            return
        for name, net in self.nets.items():
            before = (net.refs.tolist(), net.vertices.tolist(), net.states.tolist(), net.points.tolist())
            with pytest.raises(InputError, match="there is no tetra -1"), net.edit():  # noqa: PT012
                vertices = net.vertices_of(self.refs[name][t])
                net.insert_point(*point)
                net.split([self.refs[name][t]])
                net.delete_many(net.refs[: len(net) // 2])
                net.states = net.states + 1.0
                if vertices not in {tuple(row) for row in net.vertices.tolist()}:
                    with contextlib.suppress(InputError):
                        net.insert(*vertices)
                net.delete(-1)
            after = (net.refs.tolist(), net.vertices.tolist(), net.states.tolist(), net.points.tolist())
            assert after == before

    @rule()
    def collect(self):
        for net in self.nets.values():
            assert not (net.collect() and net.contestant.stable_refs)
            assert not net.collect()  # nothing is left
        self.find_anew()

    @rule(point=st.tuples(COORDINATE, COORDINATE, COORDINATE))
    def insert_point(self, point):
        expected = self.oracle.insert_point(point)
        assert {net.insert_point(*point) for net in self.nets.values()} == {expected}

    @rule(number=PICK, values=st.lists(st.floats(-1e6, 1e6), min_size=5, max_size=5))
    def set_states(self, number, values):
        t = self.pick(number)
        if t is None:
            return
        self.oracle.states[t] = list(values)
        for name, net in self.nets.items():
            states = net.states
            states[net.refs == self.refs[name][t]] = values
            net.states = states

    @rule(
        point=st.tuples(COORDINATE, COORDINATE, COORDINATE),
        method=st.sampled_from(["walk", "source", "brute"]),
    )
    def locate(self, point, method):
        depth = {t: self.oracle.share_inside(t, point) for t in self.oracle.tetras}
        for name, net in self.nets.items():
            found = int(net.locate([point], method)[0])
            if found == -1:
                assert max(depth.values(), default=-1) < 1e-9
            else:
                ids = [t for t, ref in self.refs[name].items() if ref == found]
                assert depth[ids[0]] > -1e-9 or self.oracle.volume(ids[0]) == 0

    @rule(factor=st.floats(0.9, 1.1))
    def deform(self, factor):
        self.oracle.points = [(x * factor, y, z) for x, y, z in self.oracle.points]
        self.oracle.diagonal = diagonal(self.oracle.points)
        for net in self.nets.values():
            net.deform(lambda points: points * np.array([factor, 1.0, 1.0]))

    @invariant()
    def all_sound(self):
        for name, net in getattr(self, "nets", {}).items():
            assert net.check() == [], name

    @invariant()
    def all_agree(self):
        if not hasattr(self, "nets"):
            return
        digest = self.oracle.digest()
        for name, net in self.nets.items():
            refs = net.refs.tolist()
            assert sorted(refs) == sorted(self.refs[name].values()), name
            assert len(net) == len(self.oracle.tetras)
            for t, ref in self.refs[name].items():
                assert net.vertices_of(ref) == self.oracle.tetras[t], name
            assert net.answer().digest == digest, name

    def teardown(self):
        for net in getattr(self, "nets", {}).values():
            net.close()


TestAllTogether = AllTogether.TestCase
