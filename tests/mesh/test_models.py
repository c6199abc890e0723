"""Models: conforming, positive, of the size asked for, the same bits for the same seed."""

import math
from collections.abc import Callable
from itertools import combinations

import numpy as np
import pytest
from click.testing import CliRunner
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from tests.meshes import single
from tetrabench.cli import main
from tetrabench.collision.start.models import MODELS as OBJECT_MODELS
from tetrabench.errors import InputError
from tetrabench.mesh import TetraMesh
from tetrabench.mesh.check import check_mesh
from tetrabench.mesh.models import MODELS, generate
from tetrabench.mesh.polygon.models import MODELS as POLYGON_MODELS
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
    starts, ends = edges.T
    graph = coo_array((np.ones(len(edges)), (starts, ends)), shape=(len(mesh.points),) * 2)
    assert connected_components(graph, directed=False, return_labels=False) == 1


@pytest.mark.parametrize("name", MODELS)
def test_surface_encloses_the_volumes_of_the_tetras(name: str) -> None:
    """The surface, each triangle turned as its tetra turns it, encloses what the tetras fill: none lies in another,
    or inside out."""
    mesh = generate(name, 3000)
    turned = np.concatenate([mesh.tets[:, side] for side in ([1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1])])
    _, first, times = np.unique(np.sort(turned, axis=1), axis=0, return_index=True, return_counts=True)
    a, b, c = (mesh.points[corner] for corner in turned[first[times == 1]].T)
    enclosed = np.einsum("ij,ij->", a, np.cross(b, c)) / 6
    assert enclosed == pytest.approx(signed_volumes(mesh.points, mesh.tets).sum(), rel=1e-12)


@pytest.mark.parametrize("name", MODELS)
def test_all_points_but_those_of_the_surface_are_moved(name: str) -> None:
    one, other = (generate(name, 3000, seed=seed) for seed in (1, 2))
    faces, of_face = simplices(one.tets, 3)
    surface = np.zeros(len(one.points), bool)
    surface[faces[of_face == 1]] = True
    assert np.array_equal(one.points[surface], other.points[surface])
    assert (one.points[~surface] != other.points[~surface]).all()


@pytest.mark.parametrize("name", MODELS)
@pytest.mark.parametrize("tets", [2000, 5000, 10_000, 31_234])
def test_count_is_within_a_percent(name: str, tets: int) -> None:
    assert 100 * abs(len(generate(name, tets).tets) - tets) <= tets


def test_default_sizes_are_within_a_percent() -> None:
    nozzle = MODELS["nozzle"].build(MODELS["nozzle"].tets)
    assert (nozzle.words, len(nozzle.tets)) == ("24 rings x 62 layers", 642_816)
    intake = MODELS["intake"].build(MODELS["intake"].tets)
    assert (intake.words, len(intake.tets)) == ("9 rings x 107 layers", 156_006)
    for name, tets in {"nozzle": 642_700, "intake": 155_325, "box": 100_000}.items():  # the first two: the source's
        assert MODELS[name].tets == tets
        assert abs(len(MODELS[name].build(tets).tets) / tets - 1) <= 0.01


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


@pytest.mark.parametrize("name", MODELS)
@pytest.mark.parametrize("tets", [777, 3000, 10_000])
def test_points_stay_near_their_place(name: str, tets: int) -> None:
    """No coordinate moves further than a sixth of the shortest edge there."""
    regular = MODELS[name].build(tets)
    starts, ends = simplices(regular.tets, 2)[0].T
    lengths = np.linalg.norm(regular.points[starts] - regular.points[ends], axis=1)
    shortest = np.full(len(regular.points), np.inf)
    for side in (starts, ends):
        np.minimum.at(shortest, side, lengths)
    shift = np.abs(generate(name, tets).points - regular.points).max(axis=1)
    assert (shift <= shortest / 6).all()
    assert shift.max() > 0


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


def section(point: np.ndarray) -> tuple[float, float, float]:
    """Where a point lies in the intake: arc length of the centre line, offsets towards the centre of the bend and
    along y. Negative arc length: nowhere."""
    x, y, z = point
    if z < 0.05:
        return z, x, y
    if x > 0.10:
        return x - 0.10 + np.pi * 0.05 + 0.05, 0.15 - z, y
    angle = np.arctan2(z - 0.05, 0.10 - x)
    return 0.05 + 0.10 * angle, 0.10 - np.hypot(z - 0.05, 0.10 - x), y


def section_sizes(place: float) -> tuple[float, float, float]:
    """Half height, half width and exponent of the intake's section."""
    blend = np.sin(np.pi / 2 * place / (0.10 + np.pi * 0.05)) ** 2
    return 0.032 - 0.012 * blend, 0.032, 2 + 2 * blend


def test_intake_is_bent_and_goes_from_round_to_flat() -> None:
    mesh = generate("intake", 10_000)
    faces, of_face = simplices(mesh.tets, 3)
    rims = []
    for corner in mesh.points[np.unique(faces[of_face == 1])]:
        place, u, v = section(corner)
        height, width, exponent = section_sizes(place)
        level = abs(u / height) ** exponent + abs(v / width) ** exponent
        in_an_end = corner[2] == 0 or corner[0] == pytest.approx(0.15)
        assert in_an_end or level == pytest.approx(1)
        assert level < 1 + 1e-9
        rims.append((place, u, v))
    place, u, v = np.array(rims).T
    start, end = place < 1e-9, place > place.max() - 1e-9
    assert np.hypot(u, v)[start].max() == pytest.approx(0.032)
    assert (np.abs(u[end]).max(), np.abs(v[end]).max()) == (pytest.approx(0.020), pytest.approx(0.032))
    assert np.hypot(u / 0.020, v / 0.032)[end].max() > 1.15  # its corners stand out


def holders_in(mesh: TetraMesh) -> Callable[[np.ndarray], int]:
    """A function that says how many tetras hold a point, having asked all of them."""
    a, b, c, d = (mesh.points[mesh.tets[:, k]] for k in range(4))
    to_barycentric = np.linalg.inv(np.stack([b - a, c - a, d - a], axis=2))

    def holders(point: np.ndarray) -> int:
        shares = np.einsum("tij,tj->ti", to_barycentric, point - a)
        return int(((shares >= 0).all(axis=1) & (shares.sum(axis=1) <= 1)).sum())

    return holders


@pytest.mark.parametrize("tets", [1, 777, 10_000])
def test_intake_is_not_convex(tets: int) -> None:
    mesh = generate("intake", tets)
    holders = holders_in(mesh)
    inlet, outlet = (mesh.points[mesh.points @ way == (mesh.points @ way).max()] for way in ([0, 0, -1], [1, 0, 0]))
    assert holders(inlet.mean(axis=0) + [0.0, 1e-5, 1e-5]) == 1
    assert holders(outlet.mean(axis=0) - [1e-5, 1e-5, 0.0]) == 1
    assert holders((inlet.mean(axis=0) + outlet.mean(axis=0)) / 2) == 0  # half way, in the elbow


def test_intake_holds_each_point_once_and_none_that_lies_outside(rng: np.random.Generator) -> None:
    """A bent body: by the definition of the pipe, against all tetras one by one."""
    holders = holders_in(generate("intake", 3000))
    counts = {0: 0, 1: 0}
    for point in rng.uniform([-0.04, -0.04, 0], [0.15, 0.04, 0.19], (2000, 3)):
        place, u, v = section(point)
        height, width, exponent = section_sizes(place)
        level = (abs(u / height) ** exponent + abs(v / width) ** exponent) ** (1 / exponent)
        if abs(level - 1) > 0.15:  # far from the wall, which the tetras follow in chords
            assert holders(point) == (level < 1)
            counts[int(level < 1)] += 1
    assert min(counts.values()) > 300


def test_intake_has_the_volume_of_its_sections() -> None:
    """Pappus: a section around its centroid fills its area times the length of the centroid's path, bent or not.
    Tetras follow the wall in chords, whose error falls with the square of their number in a section."""
    places = np.linspace(0, 0.10 + np.pi * 0.05, 1001)
    gamma = np.vectorize(math.gamma)
    height, width, exponent = section_sizes(places)
    areas = 4 * height * width * gamma(1 + 1 / exponent) ** 2 / gamma(1 + 2 / exponent)  # of superellipses
    body = np.trapezoid(areas, places)
    missing = []
    for rings, tets in ((4, 13_000), (8, 104_000)):
        mesh = generate("intake", tets)
        assert f"{rings} rings" in mesh.report.source
        missing.append(1 - signed_volumes(mesh.points, mesh.tets).sum() / body)
    assert 0 < missing[1] < 0.005
    assert missing[0] / missing[1] == pytest.approx(4, rel=0.2)


def test_box_is_a_cubic_metre() -> None:
    mesh = generate("box", 1000)
    assert signed_volumes(mesh.points, mesh.tets).sum() == pytest.approx(1, rel=1e-12)


def test_source_states_what_was_made() -> None:
    source = generate("nozzle", 100, numbering="shuffled", seed=7).report.source
    assert source.startswith("nozzle: 108 tets, 49 points, 1 rings x 6 layers, lengths in metres, smallest dihedral")
    assert source.endswith("degrees, seed 7, shuffled numbering (seed 7)")


def test_ids_follow_the_rows_in_any_numbering() -> None:
    mesh = generate("box", 100, numbering="rcm")
    assert mesh.point_ids.tolist() == list(range(1, len(mesh.points) + 1))
    assert mesh.tet_ids.tolist() == list(range(1, len(mesh.tets) + 1))


def test_help_names_the_models() -> None:
    words = CliRunner().invoke(main, ["generate", "--help"]).stdout.replace(",", " ").replace(";", " ").split()
    assert {*MODELS, *POLYGON_MODELS, *OBJECT_MODELS} <= set(words)


def test_dihedral_angle_of_the_corner_of_a_cube() -> None:
    corner = single()
    assert smallest_dihedral_angle(corner.points, corner.tets) == pytest.approx(np.degrees(np.arctan(np.sqrt(2))))
    assert signed_volumes(corner.points, corner.tets).tolist() == [pytest.approx(1 / 6)]


def test_refusals() -> None:
    with pytest.raises(InputError, match="no model 'sphere'; there are: nozzle, intake, box"):
        generate("sphere")
    with pytest.raises(InputError, match="no model 'Intak'; did you mean 'intake'"):
        generate("Intak")
    with pytest.raises(InputError, match="at least 1"):
        generate("box", 0)
    with pytest.raises(InputError, match="no numbering 'random'"):
        generate("box", 10, numbering="random")
