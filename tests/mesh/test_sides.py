"""Side neighbours of all tetras at once, against the definition and against every refusal."""

import re

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numba import config

from tests.oracle import OracleNet
from tetrabench.errors import InputError
from tetrabench.mesh.sides import crowded_tetras, side_neighbours

needs_the_jit = pytest.mark.skipif(config.DISABLE_JIT, reason="takes a minute in plain Python")


def naive(tets):
    net = OracleNet([], tets)
    return [[-1 if (n := net.neighbour(t, i)) is None else n for i in range(4)] for t in range(len(tets))]


def test_against_the_definition(small_mesh):
    np.testing.assert_array_equal(side_neighbours(small_mesh.tets), naive(small_mesh.tets))


def test_shape_and_type():
    result = side_neighbours(np.array([[0, 1, 2, 3]], np.int32))
    assert result.dtype == np.int32
    assert result.tolist() == [[-1, -1, -1, -1]]
    assert side_neighbours(np.empty((0, 4), np.int32)).shape == (0, 4)


@given(st.randoms(use_true_random=False))
def test_numbering_does_not_matter(random):
    """A fan of tetras around one edge, under any numbering of its points."""
    points = list(range(12))
    random.shuffle(points)
    tets = [[points[0], points[1], points[2 + n], points[2 + (n + 1) % 10]] for n in range(10)]
    for tet in tets:
        random.shuffle(tet)
    assert side_neighbours(np.array(tets, np.int32)).tolist() == naive(tets)


@pytest.mark.parametrize("stride", [1, 64])
@pytest.mark.parametrize("degree", [300, pytest.param(100_000, marks=needs_the_jit)])
def test_vertex_of_enormous_degree(degree, stride):
    """A fan of tetras around one edge: all share point 0, and all but two sides of each are in one bucket."""
    ring, t = np.arange(1, degree + 1), np.arange(degree)
    tets = np.stack([0 * ring, 0 * ring + degree + 1, ring, np.roll(ring, 1)], axis=1) * stride
    neighbours = side_neighbours(tets.astype(np.int32))
    assert (neighbours[:, :2] == -1).all()
    np.testing.assert_array_equal(neighbours[:, 2], np.roll(t, 1))
    np.testing.assert_array_equal(neighbours[:, 3], np.roll(t, -1))


@pytest.mark.parametrize("copies", [3, 4])
def test_side_of_three_names_the_tetras(copies):
    tets = np.array([[9, 8, 7, 6]] + [[0, 1, 2, 3 + n] for n in range(copies)], np.int32)
    with pytest.raises(InputError, match=r"tetras 1, 2 and 3 \(counted from 0\) share one side"):
        side_neighbours(tets)


def naive_crowded(tets):
    sharers = {}
    for t, tet in enumerate(tets):
        for i in range(4):
            sharers.setdefault(tuple(sorted(tet[:i] + tet[i + 1 :])), []).append(t)
    return sorted({t for all_of_them in sharers.values() for t in all_of_them[2:]})


@given(st.lists(st.lists(st.integers(0, 7), min_size=4, max_size=4, unique=True), max_size=30))
def test_crowded_tetras_are_those_of_the_naive_twin(rows):
    tets = np.array(rows, np.int32).reshape(-1, 4)
    crowded = crowded_tetras(tets)
    assert crowded.dtype == np.int64
    assert crowded.tolist() == naive_crowded(rows)
    if len(crowded):
        with pytest.raises(InputError, match="share one side") as refusal:
            side_neighbours(tets)
        one, two, three = (set(rows[int(number)]) for number in re.findall(r"\d+", str(refusal.value))[:3])
        assert len(one & two & three) >= 3
    else:
        assert side_neighbours(tets).tolist() == naive(rows)
    side_neighbours(np.delete(tets, crowded, axis=0))  # refuses nothing
