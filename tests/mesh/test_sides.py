"""Side neighbours of all tetras at once, against the definition and against every refusal."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.oracle import OracleNet
from tetrabench.errors import InputError
from tetrabench.tetra.adjacency import side_neighbours


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


def test_vertex_of_enormous_degree():
    """All tetras share point 0: one bucket with all faces, the long way of sorting."""
    ring = np.arange(1, 301)
    tets = np.stack([np.zeros(300, int), np.full(300, 301), ring, np.roll(ring, 1)], axis=1).astype(np.int32)
    neighbours = side_neighbours(tets)
    assert ((neighbours >= 0).sum(axis=1) == 2).all()
    t = np.arange(300)
    assert set(neighbours[7][neighbours[7] >= 0]) == {t[6], t[8]}


@pytest.mark.parametrize("copies", [3, 4])
def test_side_of_three_names_the_tetras(copies):
    tets = np.array([[9, 8, 7, 6]] + [[0, 1, 2, 3 + n] for n in range(copies)], np.int32)
    with pytest.raises(InputError, match=r"tetras 1, 2 and 3 \(counted from 0\) share one side"):
        side_neighbours(tets)
