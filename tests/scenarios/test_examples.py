"""The examples of the half-face thesis as scenarios: the middle of a net, and a cube, on every contestant."""

from itertools import combinations

import numpy as np
import pytest

from tests.meshes import MESHES, mesh_of
from tests.oracle import OracleNet
from tetrabench import registry
from tetrabench.backends.tetra import CONTESTANTS as OURS
from tetrabench.mesh import TetraMesh
from tetrabench.mesh.models import generate
from tetrabench.protocols import Answer
from tetrabench.scenarios.tetra.centroid import Middle
from tetrabench.scenarios.tetra.generate import cube
from tetrabench.tetra.family import FAMILY
from tetrabench.tetra.interface import NONE
from tetrabench.tetra.net import TetraNet

CONTESTANTS = [contestant.name for contestant in OURS]


def net_of(mesh: TetraMesh, name: str) -> TetraNet:
    return TetraNet(mesh, registry.contestant("tetra", name))


def sample_of(net: TetraNet) -> tuple[Middle, Answer]:
    """The scenario, run as the harness runs it."""
    scenario = registry.scenario("tetra", "centroid")
    middle = scenario.run(net)
    return middle, scenario.answer(net, middle)


@pytest.mark.parametrize("name", CONTESTANTS)
@pytest.mark.parametrize("mesh", sorted(MESHES))
def test_centroid_is_the_oracles(mesh, name):
    mesh = MESHES[mesh]()
    with net_of(mesh, name) as net:
        middle, answer = sample_of(net)
        expected, volume, centre = OracleNet(mesh.points, mesh.tets).middle()
        assert net.vertices_of(middle.tetra) == tuple(mesh.tets[expected])
        assert tuple(middle[1:]) == (volume, *centre)
        assert answer.figures == dict(zip(("volume", "x", "y", "z"), (volume, *centre), strict=True))


@pytest.mark.parametrize("name", CONTESTANTS)
def test_centroid_of_a_net_that_changed(name):
    mesh = generate("box", 48, seed=3)
    with net_of(mesh, name) as net:
        for _ in range(6):  # the tetra in the middle goes, and is asked for no more
            net.delete(sample_of(net)[0].tetra)
        oracle = OracleNet(net.points, net.vertices)
        middle, _ = sample_of(net)
        expected, volume, centre = oracle.middle()
        assert net.vertices_of(middle.tetra) == oracle.tetras[expected]
        assert tuple(middle[1:]) == (volume, *centre)


@pytest.mark.parametrize("name", CONTESTANTS)
def test_weights_are_volumes(name):
    """Three tetras along a line, one of them large: the mean lies in that, not in the middle one."""
    corner = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    points = np.concatenate([corner, corner + [10, 0, 0], 9 * corner + [20, 0, 0]])
    with net_of(mesh_of(points, np.arange(12).reshape(3, 4)), name) as net:
        middle, _ = sample_of(net)
        assert net.vertices_of(middle.tetra) == (8, 9, 10, 11)
        assert middle.volume == pytest.approx(9**3 / 6)


@pytest.mark.parametrize("name", CONTESTANTS)
def test_of_two_tetras_as_near_the_first_is_the_answer(name):
    """Two alike on both sides of their common centroid, to the last bit; in either order of the file."""
    corner = np.array([[0, 0, 0], [2, 0, 0], [0, 2, 0], [0, 0, 2]])
    points = np.concatenate([corner, -corner])
    digests = []
    for tets in ([[0, 1, 2, 3], [4, 5, 6, 7]], [[4, 5, 6, 7], [0, 1, 2, 3]]):
        with net_of(mesh_of(points, tets), name) as net:
            middle, answer = sample_of(net)
            assert tuple(middle[1:]) == (8 / 6, 0.0, 0.0, 0.0)
            assert net.vertices_of(middle.tetra) == tuple(tets[0])
            digests.append(answer.digest)
    assert digests[0] != digests[1]


@pytest.mark.parametrize("tets", [[], [[0, 1, 2, 3]]], ids=["empty", "flat"])
@pytest.mark.parametrize("name", CONTESTANTS)
def test_no_volume_no_middle(name, tets):
    with net_of(mesh_of([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]], tets), name) as net:
        middle, answer = sample_of(net)
        assert middle == (NONE, 0.0, 0.0, 0.0, 0.0)
        assert answer.figures["volume"] == 0.0
    assert answer.digest != sample_of(net_of(MESHES["single"](), name))[1].digest


@pytest.mark.parametrize("name", CONTESTANTS)
def test_the_middle_of_the_box_is_that_of_the_block_and_moves_with_it(name):
    """However the points inside are jittered, the tetras fill the block."""
    mesh = generate("box", 162, seed=4)
    with net_of(mesh, name) as net:
        middle, answer = sample_of(net)
        np.testing.assert_allclose(middle[2:], mesh.points.max(axis=0) / 2, rtol=1e-13)
        corners = net.vertices_of(middle.tetra)
        net.deform(lambda points: points + [64.0, -16.0, 4.0])
        moved, its_answer = sample_of(net)
        np.testing.assert_allclose(np.subtract(moved[2:], middle[2:]), [64.0, -16.0, 4.0], rtol=1e-13)
        assert net.vertices_of(moved.tetra) == corners
        assert moved.volume == pytest.approx(middle.volume, rel=1e-10)
        assert its_answer.digest != answer.digest  # the bits of the volume are part of it


@pytest.mark.parametrize("task", ["generate", "generate-add"])
@pytest.mark.parametrize("cubes", [1, 3])
def test_cubes_are_the_oracles(task, cubes):
    scenario = registry.scenario("tetra", task)
    points, tets = cube(cubes)
    expected = OracleNet(points, tets).digest()
    for contestant in OURS:
        stage = FAMILY.stage(contestant, FAMILY.small_model(), chained=False)
        order = scenario.prepare(stage, {"cubes": cubes})
        net = scenario.run(order)
        assert net.check() == []
        assert scenario.work(order, net).items == 6 * cubes**3 == len(net)
        answer = scenario.answer(order, net)
        assert answer.digest == expected, contestant.name
        assert answer.figures["surface_sides"] == 12 * cubes**2
        assert answer.figures["points"] == (cubes + 1) ** 3
        assert answer.figures["volume"] == pytest.approx(1.0, rel=1e-12)
        assert not net.is_open
        stage.close()


def test_the_cube_is_whole():
    """Every face inside has two tetras, those on the surface one; every tetra has a sixth of a subcube."""
    points, tets = cube(4)
    assert len(points) == 5**3
    faces: dict[tuple[int, ...], int] = {}
    for tet in tets.tolist():
        for face in combinations(sorted(tet), 3):
            faces[face] = faces.get(face, 0) + 1
    assert sorted(set(faces.values())) == [1, 2]
    for face, count in faces.items():
        on_surface = any(
            len({points[v][k] for v in face} & {side}) == 1 == len({points[v][k] for v in face})
            for k in range(3)
            for side in (0.0, 1.0)
        )
        assert (count == 1) == on_surface
    assert OracleNet(points, tets).volume(7) == pytest.approx(1 / 6 / 4**3)
