"""Renumbering changes the order and nothing else."""

import numpy as np
import pytest

from tests.meshes import mesh_of
from tetrabench.errors import InputError
from tetrabench.mesh import TetraMesh
from tetrabench.mesh.numbering import renumber


def corners(mesh: TetraMesh) -> list[list[list[float]]]:
    """The tetras as coordinates in their vertex order, sorted."""
    return sorted(mesh.points[mesh.tets].tolist())


def test_natural_is_the_mesh_as_it_is(small_mesh: TetraMesh) -> None:
    assert renumber(small_mesh, "natural") is small_mesh


def test_shuffled_holds_the_same_tetras_in_the_same_vertex_order(small_mesh: TetraMesh) -> None:
    shuffled = renumber(small_mesh, "shuffled", seed=5)
    assert corners(shuffled) == corners(small_mesh)
    assert sorted(shuffled.points.tolist()) == sorted(small_mesh.points.tolist())
    assert shuffled.point_ids.tolist() == list(range(1, len(small_mesh.points) + 1))
    assert shuffled.tet_ids.tolist() == list(range(1, len(small_mesh.tets) + 1))
    assert shuffled.tets.dtype == np.int32
    assert shuffled.report.source.endswith("shuffled (seed 5)")
    assert small_mesh.report.source != shuffled.report.source


def test_seed_decides() -> None:
    mesh = mesh_of(np.arange(60).reshape(20, 3), np.arange(20).reshape(5, 4))
    one, same, other = (renumber(mesh, "shuffled", seed) for seed in (1, 1, 2))
    assert one.points.tolist() == same.points.tolist()
    assert one.tets.tolist() == same.tets.tolist()
    assert one.points.tolist() != other.points.tolist()
    assert one.points.tolist() != mesh.points.tolist()


def test_unknown_numbering(small_mesh: TetraMesh) -> None:
    with pytest.raises(InputError, match="unknown numbering 'hilbert'; there are natural, shuffled"):
        renumber(small_mesh, "hilbert")
