"""Models: conforming, positive, of the size asked for, the same bits for the same seed."""

from itertools import combinations

import numpy as np
import pytest

from tests.meshes import single
from tetrabench.errors import InputError
from tetrabench.mesh.check import check_mesh
from tetrabench.mesh.models import MODELS, generate
from tetrabench.mesh.quality import signed_volumes, smallest_dihedral_angle


def simplices(cells: np.ndarray, size: int) -> tuple[np.ndarray, np.ndarray]:
    """The different sub-simplices of `size` vertices, and in how many cells each one is."""
    ordered = np.sort(cells, axis=1)
    parts = np.concatenate([ordered[:, corners] for corners in combinations(range(cells.shape[1]), size)])
    return np.unique(parts, axis=0, return_counts=True)


@pytest.mark.parametrize("name", MODELS)
@pytest.mark.parametrize("tets", [1, 6, 18, 100, 777, 3000])
def test_model_is_a_conforming_ball_of_positive_tetras(name: str, tets: int) -> None:
    mesh = generate(name, tets)
    check_mesh(mesh)
    assert (signed_volumes(mesh.points, mesh.tets) > 0).all()
    faces, of_face = simplices(mesh.tets, 3)
    boundary = faces[of_face == 1]
    assert of_face.max() <= 2
    assert (simplices(boundary, 2)[1] == 2).all()  # the surface is closed
    edges = simplices(mesh.tets, 2)[0]
    assert np.array_equal(np.unique(mesh.tets), np.arange(len(mesh.points)))
    assert len(mesh.points) - len(edges) + len(faces) - len(mesh.tets) == 1  # a ball
    assert len(np.unique(boundary)) - len(simplices(boundary, 2)[0]) + len(boundary) == 2  # a sphere


@pytest.mark.parametrize("name", MODELS)
@pytest.mark.parametrize("tets", [2000, 5000, 10_000, 31_234])
def test_count_is_within_a_percent(name: str, tets: int) -> None:
    assert 100 * abs(len(generate(name, tets).tets) - tets) <= tets


def test_default_sizes_are_within_a_percent() -> None:
    nozzle = MODELS["nozzle"].build(MODELS["nozzle"].tets)
    assert (nozzle.words, len(nozzle.tets)) == ("24 rings x 62 layers", 642_816)
    box = MODELS["box"].build(MODELS["box"].tets)
    assert abs(len(box.tets) / 100_000 - 1) <= 0.01


@pytest.mark.parametrize("name", MODELS)
def test_same_bits_for_the_same_seed_and_others_for_another(name: str) -> None:
    first, again, other = (generate(name, 1500, seed=seed) for seed in (4, 4, 5))
    assert first.points.tobytes() == again.points.tobytes()
    np.testing.assert_array_equal(first.tets, other.tets)
    assert first.points.tobytes() != other.points.tobytes()


@pytest.mark.parametrize("name", MODELS)
@pytest.mark.parametrize("seed", range(20))
def test_no_seed_turns_a_tetra_over(name: str, seed: int) -> None:
    mesh = generate(name, 3000, seed=seed)
    assert smallest_dihedral_angle(mesh.points, mesh.tets) > 5


def test_nozzle_is_round_and_converges_and_diverges() -> None:
    mesh = generate("nozzle", 5000)
    faces, of_face = simplices(mesh.tets, 3)
    surface = mesh.points[np.unique(faces[of_face == 1])]
    wall = np.array([np.hypot(*surface[surface[:, 2] == z, :2].T).max() for z in np.unique(surface[:, 2])])
    throat = int(wall.argmin())
    assert wall[[0, -1]] == pytest.approx([0.10, 0.09])
    assert wall[throat] == pytest.approx(0.05, rel=0.01)
    assert (np.diff(wall[: throat + 1]) < 0).all()
    assert (np.diff(wall[throat:]) > 0).all()


def test_box_is_a_cubic_metre() -> None:
    mesh = generate("box", 1000)
    assert signed_volumes(mesh.points, mesh.tets).sum() == pytest.approx(1, rel=1e-12)


def test_source_states_what_was_made() -> None:
    source = generate("nozzle", 100, numbering="shuffled", seed=7).report.source
    assert source.startswith("nozzle: 108 tets, 49 points, 1 rings x 6 layers, lengths in metres, smallest dihedral")
    assert source.endswith("degrees, seed 7, shuffled (seed 7)")


def test_dihedral_angle_of_the_corner_of_a_cube() -> None:
    corner = single()
    assert smallest_dihedral_angle(corner.points, corner.tets) == pytest.approx(np.degrees(np.arctan(np.sqrt(2))))
    assert signed_volumes(corner.points, corner.tets).tolist() == [pytest.approx(1 / 6)]


def test_refusals() -> None:
    with pytest.raises(InputError, match="unknown model 'sphere'; there are nozzle, box"):
        generate("sphere")
    with pytest.raises(InputError, match="at least 1"):
        generate("box", 0)
    with pytest.raises(InputError, match="unknown numbering"):
        generate("box", 10, numbering="random")
