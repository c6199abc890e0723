"""Signs of volumes and dihedral angles, against exact and naive twins."""

import math
from fractions import Fraction
from itertools import combinations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tetrabench.mesh.models import generate
from tetrabench.mesh.quality import count_signs, dihedral_angles, radius_ratios, smallest_dihedral_angle

ONE = np.array([[0, 1, 2, 3]], np.int32)


def exact_volume(points: np.ndarray) -> Fraction:
    a, b, c, d = ([Fraction(x) for x in point] for point in points.tolist())
    u, v, w = ([x - y for x, y in zip(point, a, strict=True)] for point in (b, c, d))
    return (
        u[0] * (v[1] * w[2] - v[2] * w[1]) - u[1] * (v[0] * w[2] - v[2] * w[0]) + u[2] * (v[0] * w[1] - v[1] * w[0])
    ) / 6


COORDINATES = st.floats(-1e3, 1e3, allow_subnormal=False).filter(lambda x: x == 0 or abs(x) > 1e-30)


@given(
    st.lists(st.tuples(COORDINATES, COORDINATES, COORDINATES), min_size=3, max_size=3),
    st.tuples(st.floats(-2, 2), st.floats(-2, 2)),
    st.integers(-40, 40),
)
def test_a_counted_sign_is_the_exact_one(corners, weights, steps) -> None:
    """The fourth point lies in the plane of the others, or a few roundings off it."""
    corner = np.array(corners)
    fourth = corner[0] + weights[0] * (corner[1] - corner[0]) + weights[1] * (corner[2] - corner[0])
    fourth[2] += steps * np.spacing(fourth[2])
    points = np.vstack([corner, fourth])
    inverted, degenerate = count_signs(points, ONE)
    exact = exact_volume(points)
    if not degenerate:
        assert exact != 0
        assert inverted == (exact < 0)
    else:
        assert not inverted


def test_thin_tetras_are_none_without_volume() -> None:
    thin = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0.3, 0.3, 1e-12]])
    assert count_signs(thin, ONE) == (0, 0)
    assert count_signs(thin * [1, 1, -1], ONE) == (1, 0)
    assert count_signs(thin * [1, 1, 0], ONE) == (0, 1)
    assert count_signs(thin * 1e-50, ONE) == (0, 0)


def test_volumes_beyond_float64_are_no_volumes() -> None:
    huge = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]) * 1e300
    with np.errstate(all="ignore"):
        assert count_signs(huge, ONE) == (0, 1)


def test_smallest_angle_is_that_of_the_naive_twin() -> None:
    mesh = generate("nozzle", 150, seed=3)
    angles = []
    for four in mesh.points[mesh.tets]:
        for one, other in combinations(range(4), 2):  # the edge between them
            start, end = four[one], four[other]
            along = (end - start) / np.linalg.norm(end - start)
            rest = [four[k] - start for k in range(4) if k not in (one, other)]
            rest = [arm - arm @ along * along for arm in rest]
            angles.append(math.acos(rest[0] @ rest[1] / np.linalg.norm(rest[0]) / np.linalg.norm(rest[1])))
    assert smallest_dihedral_angle(mesh.points, mesh.tets) == pytest.approx(math.degrees(min(angles)), rel=1e-9)
    assert dihedral_angles(mesh.points, mesh.tets)[1] == pytest.approx(math.degrees(max(angles)), rel=1e-9)


def test_flat_tetras_have_no_angles() -> None:
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0], [1, 1, 0]])
    flat, upright = [0, 1, 2, 4], [0, 1, 2, 3]
    assert math.isnan(smallest_dihedral_angle(points, np.array([flat], np.int32)))
    expected = pytest.approx(math.degrees(math.atan(math.sqrt(2))))
    assert smallest_dihedral_angle(points, np.array([flat, upright], np.int32)) == expected


def test_radius_ratios_are_those_of_the_naive_twin() -> None:
    """The inscribed radius is 3 V / sum of areas; the circumscribed sphere's centre solves three linear equations."""
    mesh = generate("nozzle", 150, seed=3)
    for four, ratio in zip(mesh.points[mesh.tets], radius_ratios(mesh.points, mesh.tets), strict=True):
        edges = four[1:] - four[0]
        volume = abs(np.linalg.det(edges)) / 6
        areas = [np.linalg.norm(np.cross(b - a, c - a)) / 2 for a, b, c in combinations(four, 3)]
        centre = np.linalg.solve(2 * edges, (edges**2).sum(axis=1))
        assert ratio == pytest.approx(3 * (3 * volume / sum(areas)) / np.linalg.norm(centre), rel=1e-9)


@pytest.mark.parametrize("size", [1e-150, 1.0, 1e150])
def test_a_regular_tetra_is_as_round_as_can_be_at_any_size(size: float) -> None:
    regular = np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1.0]]) * size
    with np.errstate(all="ignore"):
        assert radius_ratios(regular, ONE)[0] == pytest.approx(1.0)
        assert radius_ratios(regular[::-1].copy(), ONE)[0] == pytest.approx(1.0)


def test_flat_and_endless_tetras_are_not_round_at_all() -> None:
    flat = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0.0]])
    with np.errstate(all="ignore"):
        for points in (flat, flat * 0, np.eye(4, 3) * np.inf, np.eye(4, 3) * 1e300):
            assert radius_ratios(points, ONE).tolist() == [0.0]
