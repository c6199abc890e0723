"""Numbers of the tetras, in the formats that keep them."""

import meshio
import numpy as np
import pytest

from tests.meshes import single
from tetrabench.errors import InputError
from tetrabench.io import read_mesh, write_mesh
from tetrabench.io.formats import BY_SUFFIX, FORMATS
from tetrabench.io.values import read_values
from tetrabench.mesh.models import generate

KEEPING = [suffix for form in FORMATS if form.keeps_values for suffix in form.suffixes]
OTHERS = [suffix for form in FORMATS if form.writes and not form.keeps_values for suffix in form.suffixes] + [".nas"]


@pytest.mark.parametrize("suffix", KEEPING)
def test_there_and_back(tmp_path, rng, suffix):
    mesh = generate("box", 48, numbering="shuffled", seed=1)
    values = {"state_0": rng.normal(size=48), "state_3": np.full(48, 1e-300), "heat": np.arange(48.0)}
    path = tmp_path / f"a{suffix}"
    write_mesh(mesh, path, values=values)
    back = read_values(path)
    assert list(back) == list(values)
    for name, numbers in values.items():
        np.testing.assert_array_equal(back[name], numbers)
    np.testing.assert_array_equal(read_mesh(path).tets, mesh.tets)
    if BY_SUFFIX[suffix].keeps_ids:
        np.testing.assert_array_equal(read_mesh(path).tet_ids, mesh.tet_ids)


@pytest.mark.parametrize("suffix", OTHERS)
def test_what_keeps_none_says_so(tmp_path, suffix):
    with pytest.raises(InputError, match=r"no values of tetras are kept .*; they are in \.msh \.vtk \.vtu"):
        write_mesh(single(), tmp_path / f"a{suffix}", values={"state_0": np.zeros(1)})
    assert not list(tmp_path.iterdir())


def test_nastran_holds_none(tmp_path):
    write_mesh(single(), tmp_path / "a.nas")
    assert read_values(tmp_path / "a.nas") == {}


def test_in_a_file_of_others_the_tetras_are_picked_out(tmp_path):
    points = np.vstack([np.eye(3), np.zeros(3), np.ones(3)])
    cells = [("tetra", [[0, 1, 2, 3]]), ("triangle", [[0, 1, 2]]), ("tetra", [[0, 1, 2, 4]]), ("line", [[0, 1]])]
    numbers = {
        "heat": [np.array([1.5]), np.array([9.0]), np.array([2.5]), np.array([9.0])],
        "whole": [np.array([n]) for n in (3, 9, 4, 9)],
        "flow": [np.ones((1, 3))] * 4,
    }
    meshio.Mesh(points, cells, cell_data=numbers).write(tmp_path / "a.vtu")
    values = read_values(tmp_path / "a.vtu")
    assert {name: numbers.tolist() for name, numbers in values.items()} == {"heat": [1.5, 2.5], "whole": [3.0, 4.0]}
    assert {numbers.dtype for numbers in values.values()} == {np.dtype(float)}
    assert len(read_mesh(tmp_path / "a.vtu").tets) == 2


def test_a_file_that_is_none_is_refused(tmp_path):
    (tmp_path / "a.vtu").write_text("nonsense")
    with pytest.raises(InputError, match="cannot be read as VTK XML"):
        read_values(tmp_path / "a.vtu")
