"""Every word of a half-face mesh is damaged in turn, in several ways, and the audit must find it, unless it harms nobody."""

from itertools import combinations

import numpy as np
import pytest

from tests.halfface.comparing import USED, H
from tests.halfface.naive import NaiveMesh, Names
from tetrabench.backends.tetra.halfface import HalfFaceMesh, conjoin
from tetrabench.backends.tetra.halfface.storage import LARGEST_FAN, VERTICES

BITS = (32, 64)
DELETED, SPECIAL = 5, 6  # extensions


def worn_mesh(bits):
    """All that there can be: see `test_nothing_is_missing`."""
    mesh = HalfFaceMesh(24, bits=bits)
    spheres = [*combinations(range(5), 4), *combinations(range(4, 9), 4)]  # at vertex 4 no component has border
    fans = [[9, 10, 11, 12], [10, 9, 13, 12], [9, 10, 14, 15], [16, 15, 10, 9]]  # two, all around the edge (9, 10)
    closed_and_open = [*([17, *three] for three in combinations(range(18, 22), 3)), [17, 9, 14, 16]]
    passing = [[9, 20, 21, 11], [4, 10, 12, 18], [4, 11, 13, 19]]
    tets = np.array([*passing, *spheres, *fans, *closed_and_open])
    mesh.add_tetrahedra(np.random.default_rng(1).permuted(tets, axis=1))  # in any order
    mesh.set_delete_flags(range(3))
    mesh.garbage_collect()
    mesh.remove_vertex(22)
    mesh.set_delete_flags([2, 7, 11])
    for t, k in ((0, 0), (3, 2), (3, 5), (7, 4)):
        mesh.set_tetrahedron_flag(t, k)
    return mesh


def twin_of(mesh):
    return NaiveMesh.of(mesh.connectivity.tolist(), len(mesh.storage.v2hf))


def parts(mesh, word):
    """Extension and base of a word."""
    bits = 29 if mesh.bits == 32 else 60
    return int(word) >> bits, int(word) & (1 << bits) - 1


def owners(mesh):
    """Place in v2nhf -> the vertex of that record; free ones have none."""
    storage, found = mesh.storage, {}
    for v in mesh.vertices:
        extension, base = parts(mesh, storage.v2hf[v])
        place = base - 1 if extension == SPECIAL else -1
        while 0 <= place < len(storage.v2nhf):
            found[place] = v
            place = parts(mesh, storage.v2nhf[place, 1])[1]
    return found


@pytest.mark.parametrize("bits", BITS)
def test_nothing_is_missing(bits):
    """Of what the net is for: both kinds of half-faces as access, chains of each kind, flags."""
    mesh = worn_mesh(bits)
    storage, naive = mesh.storage, twin_of(mesh)
    assert mesh.check() == []
    assert storage.counters.all()  # -1 is an empty chain
    assert (storage.counters >= 0).all()
    said = [parts(mesh, word)[0] for word in storage.v2hf[: storage.counters[5]]]
    assert {0, SPECIAL, DELETED} < set(said)
    assert any(1 <= extension <= 4 for extension in said)
    assert SPECIAL << (29 if bits == 32 else 60) in storage.v2hf.tolist()  # an isolated one
    assert not naive.is_manifold()
    assert {parts(mesh, word)[0] for word in storage.v2nhf[: storage.counters[8], 0]} > {0, DELETED}
    assert len({parts(mesh, word)[0] for word in storage.connectivity[: storage.counters[0], 1]}) > 3


# ------------------------------------------------------------------ what harms nobody


class Harmless:
    """Whether a word may be another one, from the definitions; of a mesh that is sound yet."""

    def __init__(self, mesh):
        self.mesh, self.naive, self.names, self.owners = mesh, twin_of(mesh), Names(mesh), owners(mesh)

    def why(self, field, row, column, before, after):
        """The reason, or None: that damage has to be found."""
        (extension, base), (was, based) = parts(self.mesh, after), parts(self.mesh, before)
        if field == "counters":
            return self._count(row, before, after)
        if field == "connectivity" and base == based:
            if column >= 2:
                return "user flags may be any" if extension < 8 else None
            return self._order(row, column, extension, was)
        if field == "v2hf":
            return self._access(row, before, after)
        if field == "v2nhf" and column == 0 and row in self.owners:
            return self._access(self.owners[row], before, after)
        if field == "v2nhf" and column == 0 and extension == DELETED:
            return "nobody reads the base in a record that is free"
        return None

    def _count(self, place, before, after):
        if place == LARGEST_FAN:
            largest = max(sum(v in tetra for tetra in self.naive.tetras) for v in range(len(self.naive.deleted)))
            return "it is a bound" if largest <= after <= len(self.mesh.storage.queue) else None
        last = parts(self.mesh, self.mesh.storage.v2hf[before - 1]) if place == VERTICES else None
        return "of isolated vertices nobody knows" if last == (SPECIAL, 0) and after == before - 1 else None

    def _order(self, t, column, extension, was):
        words = self.mesh.storage.connectivity[t]
        high, low = (parts(self.mesh, words[k])[0] for k in (0, 1))
        if column == 0:
            high = extension
        else:
            low = extension
        same_flag = column == 1 or was >> 2 == extension >> 2
        known = same_flag and extension < 8 and (high & 3) << 3 | low < 24
        return "in which order the vertices were given nothing else says" if known else None

    def _access(self, v, before, after):
        """Any half-face of the same component gives access, on the border if one of them is."""
        meaning = self.names.of[H]
        if before not in meaning or after not in meaning or v not in meaning[after][0]:
            return None
        tetras = [
            next(iter(self.naive.sharing(face))) if t is None else t for face, t in map(meaning.get, (before, after))
        ]
        together = any(set(tetras) <= component for component in self.naive.components(frozenset({v})))
        same_kind = (meaning[before][1] is None) == (meaning[after][1] is None)
        return "it gives access to the same component" if together and same_kind else None


def damaged(before, neighbour, bits, is_word):
    """Other values that a word could have been left with."""
    if not is_word:
        return {before + 1, before - 1, before // 2, -1, -7, 0, 2**40} - {before}
    base = 29 if bits == 32 else 60
    flipped = {before ^ 1 << k for k in (0, 1, 2, 4, base - 1, base, base + 1, base + 2)}
    others = {before + 1, before - 1, neighbour, 0, (1 << base) - 1, (1 << base + 3) - 1}
    return {value for value in flipped | others if 0 <= value < 1 << base + 3} - {before}


@pytest.mark.parametrize("bits", BITS)
@pytest.mark.parametrize("field", [*USED, "counters"])
def test_every_damage_is_found(field, bits):
    """Found if it does harm; and nothing is found where it does none."""
    mesh = worn_mesh(bits)
    harmless, storage = Harmless(mesh), mesh.storage
    array = getattr(storage, field)
    rows = len(array) if field == "counters" else storage.counters[USED[field]]
    words = array.reshape(len(array), -1)
    missed, false_alarms, counted = [], [], 0
    for row, column in np.ndindex(int(rows), words.shape[1]):
        before, neighbour = int(words[row, column]), int(words[(row + 1) % rows, column])
        for after in sorted(damaged(before, neighbour, bits, field != "counters")):
            reason = harmless.why(field, row, column, before, after)
            words[row, column] = after
            found = mesh.check()
            words[row, column] = before
            if reason is None and found == []:
                missed.append((row, column, before, after))
            if reason is not None and found != []:
                false_alarms.append((row, column, before, after, reason, found))
            counted += reason is None
    assert missed == []
    assert false_alarms == []
    assert counted > 7
    assert mesh.check() == []


# ------------------------------------------------------------------ faults of several words


def conjoined_without_looking(monkeypatch, main, eventual, bits):
    """An eventual mesh put into a main mesh with nothing joined: all its border stays on the border."""
    monkeypatch.setattr(conjoin, "_find_partners", lambda mesh, eventual, partners: 0)
    mesh = HalfFaceMesh.construct_mesh(main, 9, bits=bits)
    other = mesh.eventual_mesh()
    other.add_tetrahedra(eventual)
    mesh.conjoin_mesh(other)
    return mesh


@pytest.mark.parametrize("bits", BITS)
@pytest.mark.parametrize(
    ("main", "eventual"),
    [
        ([[0, 1, 2, 3]], [[0, 1, 2, 4]]),  # two on the border, which ought to be opposite
        ([[0, 1, 2, 3]], [[3, 2, 1, 0]]),  # the same tetra twice
        ([[0, 1, 2, 3], [0, 1, 2, 4]], [[0, 1, 2, 5]]),
        ([[0, 1, 2, 3], [0, 1, 2, 4]], [[0, 1, 2, 5], [0, 1, 2, 6]]),
    ],
)
def test_what_conjoin_has_to_refuse_is_found(monkeypatch, main, eventual, bits):
    assert conjoined_without_looking(monkeypatch, main, eventual, bits).check() != []


@pytest.mark.parametrize("bits", BITS)
def test_what_it_need_not_refuse_is_sound(monkeypatch, bits):
    """The control: where there is nothing to join, not looking does no harm."""
    mesh = conjoined_without_looking(monkeypatch, [[0, 1, 2, 3]], [[0, 1, 4, 5], [3, 6, 7, 8]], bits)
    assert mesh.check() == []


@pytest.mark.parametrize("bits", BITS)
def test_lost_tetra_is_found(bits):
    """The last one, which its neighbours know."""
    mesh = worn_mesh(bits)
    mesh.storage.counters[0] -= 1
    assert mesh.check() != []


@pytest.mark.parametrize("bits", BITS)
def test_swapped_tetras_are_found(bits):
    """Each row is sound, but lies where another one should."""
    mesh = worn_mesh(bits)
    for field in (mesh.storage.connectivity, mesh.storage.adjacency):
        field[[1, 14]] = field[[14, 1]]
        assert mesh.check() != []
        field[[1, 14]] = field[[14, 1]]
    assert mesh.check() == []
