"""Arrays from outside: what is none of tetras is refused at the door, before a kernel takes it at its word."""

import numpy as np
import pytest

from tetrabench.errors import InputError
from tetrabench.mesh import TetraMesh
from tetrabench.mesh.incidence import vertex_tetras
from tetrabench.mesh.sides import crowded_tetras, side_neighbours

BAD = {
    "beyond int32": [[0, 1, 2, 2**40]],
    "negative": [[0, 1, 2, -5]],
    "of another shape": [0, 1, 2, 3],
    "triangles": [[0, 1, 2]],
    "no whole numbers": [[0.0, 1.0, 2.0, 3.0]],
}


@pytest.mark.parametrize("tets", BAD.values(), ids=BAD)
def test_no_tetras(tets: list) -> None:
    for function in (side_neighbours, crowded_tetras, lambda some: vertex_tetras(some, 10)):
        with pytest.raises(InputError, match=r"^tets (are|have)"):
            function(np.array(tets))


def test_a_vertex_beyond_the_points() -> None:
    with pytest.raises(InputError, match="from 0 to 9; these go from 0 to 12"):
        vertex_tetras(np.array([[0, 1, 2, 12]]), 10)
    assert vertex_tetras(np.array([[0, 1, 2, 9]], np.uint16), 10)[1].tolist() == [0, 0, 0, 0]


def test_a_mesh_from_arrays_numbers_itself_from_1() -> None:
    mesh = TetraMesh(np.zeros((5, 3)), np.array([[0, 1, 2, 3], [1, 2, 3, 4]], np.int32))
    assert (mesh.point_ids.tolist(), mesh.tet_ids.tolist()) == ([1, 2, 3, 4, 5], [1, 2])
