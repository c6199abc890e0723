"""The tetras around each vertex, against the definition."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from tetrabench.mesh.incidence import vertex_tetras


def naive(tets, points):
    return [[t for t, tet in enumerate(tets) for vertex in tet if vertex == v] for v in range(points)]


def listed(tets, points):
    starts, rows = vertex_tetras(tets, points)
    assert starts.shape == (points + 1,)
    assert rows.shape == (4 * len(tets),)
    assert starts.dtype == np.int64
    assert rows.dtype == np.int32
    assert starts[0] == 0
    assert starts[-1] == len(rows)
    return [rows[starts[v] : starts[v + 1]].tolist() for v in range(points)]


def test_against_the_definition(small_mesh):
    points = len(small_mesh.points)
    assert listed(small_mesh.tets, points) == naive(small_mesh.tets.tolist(), points)


@given(st.lists(st.lists(st.integers(0, 9), min_size=4, max_size=4), max_size=20), st.integers(10, 13))
def test_against_the_definition_with_anything(tets, points):
    """Points without a tetra, at the end too; no tetra at all; a tetra that repeats a vertex is there twice."""
    assert listed(np.array(tets, np.int32).reshape(-1, 4), points) == naive(tets, points)


def test_any_kind_of_array():
    tets = np.array([[3, 1, 2, 0], [4, 3, 2, 1]])
    tets.flags.writeable = False
    assert listed(np.asfortranarray(tets), 5) == naive(tets.tolist(), 5)
