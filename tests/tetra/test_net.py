"""TetraNet: the Python face, on every contestant."""

import copy
import gc
import pickle
import weakref

import numpy as np
import pytest

import tetrabench
from tests.meshes import box, mesh_of, nozzle, pair, single
from tests.oracle import OracleNet
from tetrabench import registry
from tetrabench.backends.tetra import CONTESTANTS as OURS
from tetrabench.backends.tetra.halfface import topology
from tetrabench.errors import InputError, MemoryRefusedError
from tetrabench.io import read_mesh
from tetrabench.jit import kernels
from tetrabench.mesh.models import generate
from tetrabench.tetra import edit, incidence, interface
from tetrabench.tetra.net import TetraNet

CONTESTANTS = [c.name for c in OURS]


@pytest.fixture(params=CONTESTANTS)
def build(request):
    contestant = registry.contestant("tetra", request.param)
    return lambda mesh: TetraNet(mesh, contestant)


def test_static_data_is_that_of_the_mesh(build, small_mesh):
    net, oracle = build(small_mesh), OracleNet(small_mesh.points, small_mesh.tets)
    np.testing.assert_array_equal(net.vertices, small_mesh.tets)
    np.testing.assert_array_equal(net.points, small_mesh.points)
    assert net.volumes.tolist() == [oracle.volume(t) for t in oracle.tetras]
    np.testing.assert_allclose(net.centroids, small_mesh.points[small_mesh.tets].mean(axis=1), rtol=0, atol=1e-14)
    areas = [[oracle.side_area(t, i) for i in range(4)] for t in oracle.tetras]
    np.testing.assert_allclose(net.side_areas, areas, rtol=1e-14)
    assert net.states.tolist() == [[0.0] * 5] * len(net)
    refs = net.refs.tolist()
    behind = [[-1 if (n := oracle.neighbour(t, i)) is None else refs[n] for i in range(4)] for t in oracle.tetras]
    assert net.neighbours.tolist() == behind
    for point in range(len(small_mesh.points)):
        assert set(net.tetras_around(point)) == {refs[t] for t in oracle.around(point)}


def test_normals_are_unit_and_outward(build):
    net = build(box())
    np.testing.assert_allclose(np.linalg.norm(net.side_normals, axis=2), 1.0, rtol=1e-14)
    for t in range(len(net)):
        for i in range(4):
            corner = net.points[net.vertices[t, (i + 1) % 4]]
            assert (corner - net.centroids[t]) @ net.side_normals[t, i] > 0
    # the area vectors of a closed body sum to nothing
    np.testing.assert_allclose((net.side_areas[:, :, None] * net.side_normals).sum(axis=1), 0.0, atol=1e-15)


def test_what_is_said_of_one_tetra_is_what_is_said_of_all(build, rng):
    net = build(nozzle())
    net.delete(int(net.refs[5]))
    net.states = rng.random((len(net), 5))
    for row, t in list(enumerate(net))[::7]:
        assert net.vertices_of(t) == tuple(net.vertices[row])
        assert net.neighbours_of(t) == tuple(net.neighbours[row])
        assert net.volume_of(t) == net.volumes[row]
        np.testing.assert_array_equal(net.centroid_of(t), net.centroids[row])
        np.testing.assert_array_equal(net.side_areas_of(t), net.side_areas[row])
        np.testing.assert_array_equal(net.side_normals_of(t), net.side_normals[row])
        np.testing.assert_array_equal(net.states_of(t), net.states[row])
    t, before = int(net.refs[3]), net.states
    net.set_states_of(t, [1, 2, 3, 4, 5])
    before[3] = [1, 2, 3, 4, 5]
    np.testing.assert_array_equal(net.states, before)
    for bad in ([1, 2], 3, [[1, 2, 3, 4, 5]]):
        with pytest.raises(InputError, match=r"shape \(5,\)"):
            net.set_states_of(t, bad)
    for ask in (net.volume_of, net.centroid_of, net.side_areas_of, net.side_normals_of, net.states_of):
        with pytest.raises(InputError, match="there is no tetra -1"):
            ask(-1)


def test_what_it_says_of_itself(build):
    net = build(pair())
    assert repr(net) == f"<TetraNet {net.contestant.name}: 2 tetras, 5 points>"
    net.close()
    assert repr(net) == f"<TetraNet {net.contestant.name}: closed>"


def test_a_closed_net_takes_no_storage(build):
    net, other = build(pair()), build(pair())
    net.close()
    with pytest.raises(InputError, match="this net is closed"):
        net.storage = other.storage


def test_a_contestant_may_be_given_itself(build):
    contestant = build(pair()).contestant
    net = tetrabench.open(pair(), backend=contestant)
    assert net.contestant is contestant
    assert net.convert(contestant).contestant is contestant


def test_points_one_by_one(build):
    net = build(pair())
    assert net.number_of_points == 5
    np.testing.assert_array_equal(net.point(4), net.points[4])
    assert net.insert_point(7.0, 8.0, 9.0) == 5
    assert net.point(5).tolist() == [7.0, 8.0, 9.0]
    assert net.tetras_around(5) == []
    for bad in (-1, 6):
        with pytest.raises(InputError, match=f"there is no point {bad}: the net has 6"):
            net.point(bad)
        with pytest.raises(InputError, match="there is no point"):
            net.tetras_around(bad)


def test_around_all_points_is_around_each(build):
    net = build(nozzle())
    net.delete(int(net.refs[2]))
    net.insert_point(9.0, 9.0, 9.0)
    starts, refs = net.around_points
    assert len(starts) == net.number_of_points + 1
    for point in range(net.number_of_points):
        assert sorted(refs[starts[point] : starts[point + 1]].tolist()) == sorted(net.tetras_around(point))


def test_a_net_beyond_the_memory_is_refused(build, monkeypatch):
    mesh = nozzle()
    monkeypatch.setattr("tetrabench.memory.available_bytes", lambda: 3000)
    with pytest.raises(MemoryRefusedError, match=r"a net of \d+ tetras needs about"):
        build(mesh)


def test_select(build):
    net = build(nozzle())
    net.delete(int(net.refs[2]))
    large = net.volumes > np.median(net.volumes)
    assert [net.volume_of(t) > np.median(net.volumes) for t in net] == large.tolist()
    assert net.select(large).tolist() == [t for t, is_large in zip(net, large, strict=True) if is_large]
    for bad in (large[1:], large.astype(int), True):
        with pytest.raises(InputError, match="one bool for each"):
            net.select(bad)


def test_written_net_is_the_net(build, tmp_path):
    net = build(nozzle())
    net.delete(int(net.refs[2]))
    net.write(tmp_path / "net.nas")
    back = read_mesh(tmp_path / "net.nas", unused="keep")
    np.testing.assert_array_equal(back.tets, net.vertices)
    np.testing.assert_allclose(back.points, net.points, atol=1e-6)
    with pytest.raises(InputError, match="names no known format"):
        net.write(tmp_path / "net.xyz")


def test_edits_and_refusals(build):
    net = build(pair())
    first, second = net.refs.tolist()
    assert first in net
    assert len(net) == 2
    assert net.last == second
    for bad in [(0, 1, 2, 2), (0, 1, 2, 9), (0, 1, 2, -1), (3, 2, 1, 0)]:
        with pytest.raises(InputError, match="cannot insert"):
            net.insert(*bad)
    with pytest.raises(InputError, match="share that side already"):
        net.insert(1, 2, 3, net.insert_point(2.0, 2.0, 2.0))
    assert net.check() == []
    net.delete(first)
    assert len(net) == 1
    assert net.neighbours_of(second) == (-1, -1, -1, -1)
    assert net.check() == []
    again = net.insert(0, 1, 2, 3)
    (second,) = set(net.refs.tolist()) - {again}  # where refs are not stable, the insertion may have collected
    assert again in net.neighbours_of(second)
    with pytest.raises(InputError, match="there is no tetra"):
        net.delete(-1)


def test_a_deleted_ref_is_refused(build):
    net = build(pair())
    t = int(net.refs[0])
    net.delete(t)
    with pytest.raises(InputError, match="there is no tetra"):
        net.delete(t)
    with pytest.raises(InputError, match="there is no tetra"):
        net.vertices_of(10**6)
    assert net.check() == []


def test_a_split_of_what_is_not_there_is_refused(build):
    net = build(pair())
    digest = net.answer().digest
    first, gone = net.refs.tolist()
    for bad in ([10**9], [-1], [first, first], [[first, gone]], first):
        with pytest.raises(InputError):
            net.split(bad)
    net.split([])  # the storage was not outgrown on the way to a refusal
    assert net.answer().digest == digest
    net.delete(gone)
    with pytest.raises(InputError, match=f"there is no tetra {gone}"):
        net.split([first, gone])
    assert net.check() == []


def test_points_merge_within_a_billionth_of_the_diagonal(build):
    net = build(single())
    assert net.insert_point(1e-12, 0, 0) == 0
    assert net.insert_point(1e-3, 0, 0) == 4
    with pytest.raises(InputError, match="is no point"):
        net.insert_point(np.nan, 0, 0)


def test_outgrown_storage_is_dead(build):
    net = build(single())
    old = net.storage
    net.insert_point(5.0, 5.0, 5.0)
    assert net.storage is not old
    with pytest.raises(ValueError, match="outgrown"):
        interface.insert_tetra(old, 0, 1, 2, 3)
    with pytest.raises(ValueError, match="outgrown"):
        interface.delete_tetra(old, int(net.refs[0]))
    assert net.check() == []


@pytest.mark.parametrize("part", ["layout", "slots", "points", "incidence", "tree"])
def test_a_net_that_there_is_no_memory_to_grow_stays_what_it_was(build, part, monkeypatch):
    net = build(single())
    digest = net.answer().digest

    def no_memory(*_):
        raise MemoryError

    with monkeypatch.context() as patch:
        patch.setattr(edit, f"grown_{part}", no_memory)
        with pytest.raises(MemoryError):
            net.insert_point(5.0, 5.0, 5.0)
    with monkeypatch.context() as patch:
        for module in (incidence, topology):
            patch.setattr(module, "make_stack", no_memory)
        with pytest.raises(MemoryError):
            net.split(net.refs)
    assert net.answer().digest == digest
    net.insert(1, 2, 3, net.insert_point(5.0, 5.0, 5.0))
    assert net.split(net.refs) == 0
    assert net.check() == []


def test_edit_without_room_is_refused(build):
    net = build(mesh_of([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]], [[0, 1, 2, 3]]))
    with pytest.raises(ValueError, match="call reserve first"):
        interface.insert_tetra(net.storage, 1, 2, 3, 4)
    assert net.check() == []


def test_growth_is_by_a_quarter_and_keeps_everything(build):
    net = build(box())
    before, digest = net.structure_bytes(), net.answer().digest
    net.storage = edit.reserve(net.storage, 1, 1)
    after = net.structure_bytes()
    assert net.answer().digest == digest
    assert net.check() == []
    for name in set(before) - {"queue", "table"}:  # what walks need is for as many tetras as there is room for
        assert after[name][0] == before[name][0], name
    if "nodes" not in after:
        rows = len(net) + 1024
        field = "records" if "records" in after else "volume"
        assert after[field][1] == rows * (232 if field == "records" else 8)


def test_copies_and_pickles_are_independent(build, rng):
    net = build(nozzle())
    net.delete(int(net.refs[3]))
    net.states = rng.random((len(net), 5))
    digest = net.answer().digest
    twins = [copy.copy(net), copy.deepcopy(net), pickle.loads(pickle.dumps(net))]
    for twin in twins:
        assert twin.answer().digest == digest
        assert twin.check() == []
        twin.delete(twin.last)
    assert net.answer().digest == digest
    assert net.check() == []
    del twins, twin
    gc.collect()
    assert net.answer().digest == digest


def test_close_gives_back_and_may_come_twice(build):
    net = build(box())
    net.close()
    net.close()
    assert not net.is_open
    with pytest.raises(InputError, match="closed"):
        len(net)
    with build(single()) as other:
        assert len(other) == 1
    assert not other.is_open


def test_states_shape_is_checked(build):
    net = build(single())
    with pytest.raises(InputError, match=r"shape \(1, 5\)"):
        net.states = np.zeros((2, 5))


def test_what_is_no_number_is_refused():
    net = tetrabench.open(single())
    digest = net.answer().digest
    for refused in (
        lambda: net.insert_points("abc"),
        lambda: net.insert_points([[0.0, 1.0], [2.0]]),
        lambda: net.insert_point(None, 0, 0),
        lambda: net.insert_point([1.0], 0, 0),
        lambda: net.insert_point("x", 0, 0),
        lambda: setattr(net, "states", "x"),
        lambda: net.set_states_of(0, ["a"] * 5),
        lambda: net.take_states({f"state_{n}": np.zeros(1 + n) for n in range(5)}),
        lambda: net.locate("abc"),
        lambda: net.nearest_points({}),
        lambda: net.deform(lambda points: None),
        lambda: net.deform(lambda points: "left"),
    ):
        with pytest.raises(InputError) as error:
            refused()
        assert "\n" not in str(error.value)
    assert net.answer().digest == digest


def test_deform_refusals(build):
    net = build(single())
    digest = net.answer().digest
    with pytest.raises(InputError, match="shape"):
        net.deform(lambda points: points[:2])
    with pytest.raises(InputError, match="finite"):
        net.deform(lambda points: points + np.inf)
    assert net.answer().digest == digest


def test_structure_bytes_are_exact(build):
    net = build(nozzle())
    sizes, n, p = net.structure_bytes(), len(net), len(net.points)
    assert sizes["points"][0] == 24 * p
    assert sizes["tree"][0] == 40 * p
    if net.contestant.name == "halfface":
        assert sizes["connectivity"][0] == sizes["adjacency"][0] == 4 * 4 * n
        assert sizes["v2hf"][0] == 4 * p
        fields = sum(sizes[name][0] for name in ("volume", "centroid", "side_area", "side_normal", "state"))
        assert fields == n * 200
    else:
        entry = 16 if net.contestant.name == "v4" else 8
        assert sizes["incidence"][0] == 4 * n * entry + 4 * p
        fields = sum(used for name, (used, _) in sizes.items() if name not in ("points", "tree", "incidence", "holes"))
        counters = sum(used for name, (used, _) in sizes.items() if name.endswith("counters"))
        assert fields - counters == n * (264 if net.contestant.name == "v4" else 232)
    assert all(used <= reserved for used, reserved in sizes.values())


def test_one_signature_a_kernel_and_contestant(build):
    """A read-only or strided array would silently compile a kernel once more."""
    net = build(box())
    net.split(net.refs[:2])
    net.delete(net.last)
    net.locate(net.centroids)
    net.locate(net.points)
    net.deform(lambda points: points * 1.1)
    net.check()
    storage = type(net.storage.layout).__name__, type(net.storage.slots).__name__
    for kernel in kernels():
        of_this = [s for s in getattr(kernel, "signatures", []) if storage == parts(s)]
        assert len(of_this) <= 1, (kernel.__name__, of_this)


def parts(signature):
    """Layout and slot policy of the net in a signature, None where there is no net."""
    for argument in signature:
        if getattr(argument, "fields", ())[:2] == ("layout", "slots"):
            return tuple(kind.instance_class.__name__ for kind in argument.types[:2])
    return None


def test_a_refused_edit_keeps_nothing_alive(build):
    """An exception in a kernel that counts references would keep the whole net in memory for good."""
    net = build(box())
    arrays = [weakref.ref(array) for part in net.storage for array in part if isinstance(array, np.ndarray)]
    for bad in [(0, 1, 2, 2), (0, 1, 2, 10**6), net.vertices_of(net.last)]:
        with pytest.raises(InputError):
            net.insert(*bad)
    net.close()
    gc.collect()
    assert arrays
    assert [array for array in arrays if array() is not None] == []


def test_halfface_that_there_is_no_memory_to_split_stays_what_it_was(monkeypatch):
    with TetraNet(box(), registry.contestant("tetra", "halfface")) as net:
        digest, points = net.answer().digest, net.number_of_points

        def no_memory(*_):
            raise MemoryError

        for name in ("construct", "_with_room"):
            with monkeypatch.context() as patch:
                patch.setattr(topology, name, no_memory)
                with pytest.raises(MemoryError):
                    net.split(net.refs[:4])
            assert net.check() == []
        assert net.number_of_points == points
        assert net.answer().digest == digest
        assert net.split(net.refs[:4]) == 0
        assert net.check() == []


def test_an_insert_that_has_to_collect_first_has_room_for_it():
    """Collecting takes border half-faces out of the room that was made for the insert."""
    with TetraNet(generate("box", 750), registry.contestant("tetra", "halfface")) as net:
        inner, seen = [], set()
        for t, neighbours in zip(net.refs.tolist(), net.neighbours.tolist(), strict=True):
            if -1 not in neighbours and not seen & {t, *neighbours}:
                inner.append(t)
                seen |= {t, *neighbours}
        corners = [net.vertices_of(t) for t in inner]
        for t in inner:
            net.delete(t)
        for vertices in corners:
            net.insert(*vertices)
        assert len(net) == 750
        assert net.check() == []


def test_a_refused_insert_leaves_what_waits_alone():
    with TetraNet(box(), registry.contestant("tetra", "halfface")) as net:
        net.delete(int(net.refs[3]))
        refs = net.refs.tolist()
        for vertices in [(0, 0, 1, 2), (0, 1, 2, 10**6)]:
            with pytest.raises(InputError):
                net.insert(*vertices)
            assert net.refs.tolist() == refs
        assert net.storage.incidence.counters[1] == 1  # flagged, as before


def test_fields_and_half_faces_never_disagree_about_room():
    """Half-faces have room for more tetras than fields have: the tetra is refused before anything is written."""
    with TetraNet(box(), registry.contestant("tetra", "halfface")) as net:
        net.storage = edit.reserve(net.storage, 100, 0)
        fields = net.storage.layout
        short = type(fields)(*(field[: len(net)] for field in fields))
        t = int(net.refs[-1])
        vertices = net.vertices_of(t)
        with pytest.raises(ValueError, match="call reserve first"):
            interface.insert_tetra(net.storage._replace(layout=short), *vertices)
