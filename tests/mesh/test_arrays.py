"""Arrays from outside: what is none of tetras is refused at the door, before a kernel takes it at its word."""

import numpy as np
import pytest

import tetrabench
from tetrabench.errors import InputError, MemoryRefusedError
from tetrabench.mesh import TetraMesh
from tetrabench.mesh.incidence import vertex_tetras
from tetrabench.mesh.sides import crowded_tetras, side_neighbours

BAD = {
    "beyond int32": [[0, 1, 2, 2**40]],
    "negative": [[0, 1, 2, -5]],
    "of another shape": [0, 1, 2, 3],
    "triangles": [[0, 1, 2]],
    "no whole numbers": [[0.0, 1.0, 2.0, 3.0]],
    "more than 64 bits": [[0, 1, 2, 2**70]],
    "unsigned beyond int64": np.array([[0, 1, 2, 2**64 - 1]], np.uint64),
}


@pytest.mark.parametrize("tets", BAD.values(), ids=BAD)
def test_no_tetras(tets: list) -> None:
    for function in (side_neighbours, crowded_tetras, lambda some: vertex_tetras(some, 10)):
        with pytest.raises(InputError, match=r"^tets (are|have)"):
            function(np.array(tets))
        with pytest.raises(InputError, match=r"^tets are whole numbers of the shape \(m, 4\)$"):
            function([[0, 1, 2, 3], [0, 1]])


def test_a_tetra_that_repeats_a_vertex_is_named() -> None:
    for row in ([0, 0, 1, 2], [2, 1, 0, 1], [7, 8, 9, 9], [5, 5, 5, 5]):
        for function in (side_neighbours, crowded_tetras):
            with pytest.raises(InputError, match=r"^tetra 1 \(counted from 0\) repeats a vertex$"):
                function(np.array([[0, 1, 2, 3], row]))


def test_vertices_with_gaps_beyond_the_memory(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tetrabench.memory.available_bytes", lambda: 10**9)
    for function in (side_neighbours, crowded_tetras):
        with pytest.raises(MemoryRefusedError, match=r"vertices up to 2,147,483,647 needs about 16.*without gaps"):
            function(np.array([[0, 1, 2, 2**31 - 1]]))


@pytest.mark.parametrize("points", [-1, -5, 10.0, None, np.zeros((10, 3)), "10"])
def test_no_count_of_points(points: object) -> None:
    for tets in (np.empty((0, 4), np.int32), np.array([[0, 1, 2, 3]])):
        with pytest.raises(InputError, match=r"^points is how many there are, not "):
            vertex_tetras(tets, points)
    assert vertex_tetras(np.empty((0, 4), np.int32), 0)[0].tolist() == [0]


def test_a_vertex_beyond_the_points() -> None:
    with pytest.raises(InputError, match="from 0 to 9; these go from 0 to 12"):
        vertex_tetras(np.array([[0, 1, 2, 12]]), 10)
    assert vertex_tetras(np.array([[0, 1, 2, 9]], np.uint16), 10)[1].tolist() == [0, 0, 0, 0]


def test_a_mesh_from_arrays_numbers_itself_from_1() -> None:
    mesh = TetraMesh(np.zeros((5, 3)), np.array([[0, 1, 2, 3], [1, 2, 3, 4]], np.int32))
    assert (mesh.point_ids.tolist(), mesh.tet_ids.tolist()) == ([1, 2, 3, 4, 5], [1, 2])


def test_nested_lists_become_a_net() -> None:
    mesh = TetraMesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 1, 2, 3]])
    with tetrabench.open(mesh, backend="v3y") as net:
        assert net.volumes.tolist() == [1 / 6]
