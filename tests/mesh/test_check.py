"""check_mesh refuses what no net may hold, and nothing else."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.meshes import single
from tetrabench.errors import InputError
from tetrabench.mesh import TetraMesh
from tetrabench.mesh.check import check_mesh, find_fault


def test_sound_meshes_pass(small_mesh: TetraMesh) -> None:
    check_mesh(small_mesh)
    small_mesh.tets = np.asfortranarray(small_mesh.tets).astype(np.int64)
    small_mesh.points.flags.writeable = False
    check_mesh(small_mesh)


FAULTS = {
    "index too large": (
        "tets",
        [[0, 1, 2, 4]],
        r"tetra 1 \(row 0\) has the vertices 0 1 2 4, .* from 0 to 3",
    ),
    "index negative": ("tets", [[0, -1, 2, 3]], "has the vertices 0 -1 2 3"),
    "index beyond int32": ("tets", [[0, 1, 2, 2**32 + 3]], "has the vertices 0 1 2 4294967299"),
    "vertex twice": ("tets", [[0, 1, 2, 0]], "repeats a vertex"),
    "NaN": (
        "points",
        np.where(np.eye(4, 3, -3), np.nan, 0),
        r"point 4 \(row 3\) has a coordinate that is NaN",
    ),
    "infinite": ("points", np.full((4, 3), np.inf), r"point 1 \(row 0\) has a coordinate"),
    "real indices": ("tets", [[0.0, 1.0, 2.0, 3.0]], "tets must be integers"),
    "triangles": ("tets", [[0, 1, 2]], r"integers of shape \(m, 4\), not int64 \(1, 3\)"),
    "points in the plane": ("points", np.zeros((4, 2)), r"points must be numbers of shape \(n, 3\)"),
    "ids missing": ("tet_ids", [], "one number for each"),
}


@pytest.mark.parametrize(("attribute", "value", "reason"), FAULTS.values(), ids=FAULTS.keys())
def test_fault_is_named(attribute: str, value: object, reason: str) -> None:
    mesh = single()
    setattr(mesh, attribute, np.array(value))
    with pytest.raises(InputError, match=f"^mesh: .*{reason}"):
        check_mesh(mesh)


def test_duplicate_is_found_in_any_vertex_order() -> None:
    tets = np.array([[0, 1, 2, 3], [4, 1, 2, 3], [2, 3, 0, 1]], np.int32)
    assert find_fault(np.zeros((5, 3)), tets) == (
        "tetra",
        2,
        "has the same four vertices as the tetra of row 0",
    )


@given(st.lists(st.lists(st.integers(0, 7), min_size=4, max_size=4), max_size=30))
def test_first_fault_is_that_of_the_naive_twin(rows: list[list[int]]) -> None:
    naive, seen = None, {}
    for row, four in enumerate(rows):
        if len(set(four)) < 4:
            naive = (row, "repeats a vertex")
        elif frozenset(four) in seen:
            naive = (row, f"has the same four vertices as the tetra of row {seen[frozenset(four)]}")
        if naive:
            break
        seen[frozenset(four)] = row
    fault = find_fault(np.zeros((8, 3)), np.array(rows, np.int32).reshape(-1, 4))
    assert (fault and fault[1:]) == naive
