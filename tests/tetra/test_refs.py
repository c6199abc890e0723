"""A ref that is none never reaches a kernel, on no contestant: the Python face refuses it, or says that it is none."""

import numpy as np
import pytest

import tetrabench
from tetrabench.backends.tetra import CONTESTANTS
from tetrabench.errors import InputError
from tetrabench.mesh.models import generate

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
