"""A ref that is none never reaches a kernel, on no contestant: the Python face refuses it, or says that it is none."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import tetrabench
from tests.meshes import pair
from tetrabench.backends.tetra import CONTESTANTS
from tetrabench.errors import InputError
from tetrabench.mesh.models import generate
from tetrabench.tetra import interface

NAMES = [contestant.name for contestant in CONTESTANTS]
METHODS = ("vertices_of", "neighbours_of", "volume_of", "centroid_of", "side_areas_of", "side_normals_of", "states_of")


@pytest.mark.parametrize("name", NAMES)
def test_a_wrong_ref_is_refused(name: str, rng: np.random.Generator) -> None:
    with tetrabench.open(generate("box", 100), backend=name) as net:
        dead = int(net.refs[10])
        net.delete(dead)
        live = set(net.refs.tolist())
        for ref in [dead, -1, 0, 8, 12345, 2**62, *rng.integers(-(2**40), 2**40, 20).tolist()]:
            assert (ref in net) == (ref in live)
            if ref in live:
                continue
            for method in METHODS:
                with pytest.raises(InputError, match="there is no tetra"):
                    getattr(net, method)(ref)
            with pytest.raises(InputError, match="there is no tetra"):
                net.delete(ref)
            with pytest.raises(InputError, match="there is no tetra"):
                net.split([ref])
            with pytest.raises(InputError, match="there is no tetra"):
                net.set_states_of(ref, np.zeros(5))
        assert net.check() == []


NO_REFS = {
    "NaN": np.nan,
    "infinite": np.inf,
    "a fraction": 1.5,
    "a whole float": 1.0,
    "nothing": None,
    "a word": "1",
    "a list": [1],
    "an array": np.arange(3),
    "a complex number": 1j,
    "of more than 64 bits": 2**64 + 1,
    "of many digits": -(10**5000),
}


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("what", NO_REFS.values(), ids=NO_REFS)
def test_what_is_no_whole_number_is_refused(name: str, what: object) -> None:
    with tetrabench.open(pair(), backend=name) as net:
        assert what not in net
        asked = [getattr(net, method) for method in METHODS]
        asked += [net.delete, net.tetras_around, net.point, lambda t: net.set_states_of(t, np.zeros(5))]
        asked += [lambda t: net.insert(0, 1, 2, t), lambda t: net.split([t])]
        for ask in asked:
            with pytest.raises(InputError) as refusal:
                ask(what)
            assert "\n" not in str(refusal.value)
        for refs in ([[0], [0, 1]], [[0]], [True, False], ["0"], 0):
            with pytest.raises(InputError, match="refs are whole numbers"):
                net.split(refs)
        assert net.split([]) == 0
        assert len(net) == 2
        assert net.check() == []


UNSIGNED = st.integers(0, 2**64 - 1).map(np.uint64)


@given(what=st.one_of(st.integers(), st.integers(-3, 3), st.floats(), st.text(), st.none(), UNSIGNED))
def test_anything_may_be_asked(what: object) -> None:
    for name in NAMES:
        with tetrabench.open(pair(), backend=name) as net:
            if what in net:
                assert what in net.refs.tolist()
                net.delete(what)
            else:
                for ask in (net.volume_of, net.delete, lambda t: net.split([t])):
                    with pytest.raises(InputError):
                        ask(what)
            assert net.check() == []


@pytest.mark.parametrize("name", NAMES)
def test_refs_of_any_kind_of_whole_number(name: str) -> None:
    with tetrabench.open(pair(), backend=name) as net:
        for kind in (int, np.int64, np.uint64):
            t = kind(net.refs[1])
            assert t in net
            assert net.vertices_of(t) == (4, 3, 2, 1)
        corners = net.vertices[0]
        net.delete(net.refs[0])
        assert net.insert(*corners) in net


@pytest.mark.parametrize("name", NAMES)
def test_a_kernel_of_others_may_edit_in_between(name: str) -> None:
    """The Python face keeps no list of refs beyond an edit that it has not seen."""
    with tetrabench.open(generate("box", 100), backend=name) as net:
        first, second, third, *_ = known = net.refs.tolist()
        assert first in net
        interface.delete_tetra(net.storage, first)
        assert first not in net
        corners = net.vertices_of(second)
        interface.delete_tetra(net.storage, second)
        interface.delete_tetra(net.storage, third)
        known.append(net.insert(*corners))  # it may stand where one of the two stood
        assert {ref for ref in known if ref in net} == set(net.refs.tolist())


@pytest.mark.parametrize("name", NAMES)
def test_refs_are_known_after_every_kind_of_edit(name: str) -> None:
    with tetrabench.open(generate("box", 100), backend=name) as net:
        gone = []
        for _ in range(3):
            t = int(net.refs[5])
            assert t in net
            a, b, c, d = (int(point) for point in net.vertices_of(t))
            net.delete(t)
            again = net.insert(a, b, c, d)
            assert again in net
            gone.append(int(net.refs[7]))
            net.split(net.refs[7:9])
            assert set(net.refs.tolist()) == {ref for ref in [*net.refs.tolist(), *gone, t, again] if ref in net}
        assert net.check() == []
