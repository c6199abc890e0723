"""What a net is seen through, and turned into: views by ref, files with states, other contestants."""

import numpy as np
import pytest

import tetrabench
from tests.meshes import box, nozzle
from tetrabench import registry
from tetrabench.backends.tetra import CONTESTANTS as OURS
from tetrabench.errors import InputError
from tetrabench.tetra.net import TetraNet

FIELDS = ("vertices", "neighbours", "volumes", "centroids", "side_areas", "side_normals", "states")
WITHOUT = {"v4": set(FIELDS), "halfface": {"vertices", "neighbours"}}


@pytest.fixture(params=[c.name for c in OURS])
def net(request, rng):
    net = TetraNet(nozzle(), registry.contestant("tetra", request.param))
    net.delete_many(net.refs[2:30:5])
    net.collect()
    net.states = rng.random((len(net), 5))
    yield net
    net.close()


@pytest.mark.parametrize("field", FIELDS)
def test_views_hold_what_properties_say(net, field):
    if field in WITHOUT.get(net.contestant.name, ()):
        with pytest.raises(InputError, match=r"no array of this kind .*: take the net's property of the same name"):
            getattr(net.by_ref, field)
        return
    view = getattr(net.by_ref, field)
    np.testing.assert_array_equal(view[net.refs], getattr(net, field))
    assert np.shares_memory(view, getattr(net.by_ref, field))  # no copy
    if field != "states":
        with pytest.raises(ValueError, match="read-only"):
            view[0] = 0


def test_states_are_written_through_a_view(net):
    if "states" in WITHOUT.get(net.contestant.name, ()):
        pytest.skip("it has none")
    net.by_ref.states[net.refs[4]] = [5, 4, 3, 2, 1]
    assert net.states_of(net.refs[4]).tolist() == [5, 4, 3, 2, 1]
    assert net.states[4].tolist() == [5, 4, 3, 2, 1]


def test_states_go_into_files_and_come_back(net, tmp_path, rng):
    for suffix in (".vtu", ".msh", ".vtk", ".xdmf"):
        path = tmp_path / f"net{suffix}"
        net.write(path)
        back = tetrabench.open(path, net.contestant.name)
        assert back.answer() == net.answer(), suffix
        assert not tetrabench.open(path, net.contestant.name, states=False).states.any()
        net.write(path, states=False)
        assert not tetrabench.open(path, net.contestant.name).states.any()


def test_what_keeps_no_states_says_so(net, tmp_path):
    path = tmp_path / "net.nas"
    with pytest.raises(InputError, match=r"no values of tetras are kept in this format; they are in \.msh \.vtk \.vtu"):
        net.write(path, states=True)
    assert not path.exists()
    net.write(path, field="free")
    back = tetrabench.open(path, net.contestant.name)
    np.testing.assert_array_equal(back.vertices, net.vertices)
    np.testing.assert_array_equal(back.points, net.points)


def test_states_are_taken_only_where_all_are_there(net):
    values = {f"state_{place}": column for place, column in enumerate(net.states.T)}
    before = net.states
    del values["state_3"]
    assert not net.take_states(values)
    np.testing.assert_array_equal(net.states, before)


def test_into_every_other_contestant(net):
    for other in OURS:
        with net.convert(other.name) as twin:
            assert twin.contestant.name == other.name
            assert twin.answer() == net.answer()
            twin.delete(twin.last)
    assert net.check() == []
    with pytest.raises(InputError, match="no backend 'v6'"):
        net.convert("v6")


def test_a_net_without_tetras(tmp_path):
    net = TetraNet(box(), registry.contestant("tetra", "v3y"))
    net.delete_many(net.refs)
    assert net.by_ref.volumes.shape == (0,)
    with net.edit():
        pass
