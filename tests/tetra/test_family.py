"""The tetra family finds its models: files as they are, generated ones in the user's cache."""

from pathlib import Path

import numpy as np
import pytest

from tetrabench.errors import InputError
from tetrabench.io import read_mesh, shelf
from tetrabench.mesh import models
from tetrabench.mesh.models import SMALL_NOZZLE, generate
from tetrabench.tetra.family import FAMILY


@pytest.fixture
def find(tmp_path, monkeypatch):
    """find_model in a cache of its own, and in a folder of its own."""
    monkeypatch.setenv("TETRABENCH_CACHE", str(tmp_path / "cache"))
    monkeypatch.chdir(tmp_path)
    return lambda model, size=None, seed=0: FAMILY.find_model(model, size=size, numbering="natural", seed=seed)


def test_a_model_is_made_once(find):
    first = find("box", 48)
    assert len(read_mesh(first).tets) == 48
    first.write_text("kept")
    assert find("box", 48).read_text() == "kept"
    assert len({first, find("box", 6), find("box", 48, seed=1)}) == 3


def test_a_model_that_other_code_made_is_not_taken(find, monkeypatch):
    old = find("box", 48)
    old.write_text("of a generator that has changed since")
    shelf._stamp.cache_clear()
    read_bytes = Path.read_bytes
    changed = lambda path: read_bytes(path) + (b"# changed" if path.name == "box.py" else b"")  # noqa: E731
    monkeypatch.setattr(Path, "read_bytes", changed)
    try:
        new = find("box", 48)
    finally:
        shelf._stamp.cache_clear()
    assert new != old
    assert len(read_mesh(new).tets) == 48


@pytest.mark.parametrize(
    ("asked", "advised"),
    [
        ("./nozzle", "nozzle.nas"),
        ("nozzle.nas", "nozzle.nas"),
        ("nozzle.vtu", "nozzle.vtu"),
        ("nozzle.xyz", "nozzle.nas"),
        ("nozzle.stl", "nozzle.nas"),
        ("folder/nozzle", "folder/nozzle.nas"),
    ],
)
def test_advice_about_a_missing_file_can_be_taken(find, asked, advised):
    with pytest.raises(InputError, match=f"no such file. Make one with `tetrabench generate nozzle -o {advised}`, or"):
        find(asked)


def test_a_mesh_of_polygons_is_sent_to_its_family(tmp_path):
    (tmp_path / "part.off").write_text("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")
    with pytest.raises(InputError, match=r"holds no tetras; it holds triangle 1; .* goes with --family polygon"):
        FAMILY.describe_model(tmp_path / "part.off")


def test_what_can_be_no_file_is_refused(find, tmp_path):
    with pytest.raises(InputError, match="a folder, not a file"):
        find(str(tmp_path))
    with pytest.raises(InputError, match=r"a\.nas: cannot be read: File name too long$"):
        find(f"{'a' * 5000}.nas")
    with pytest.raises(InputError, match=r"no such file, and no model of that name; models are .*did you mean nozzle"):
        find("nozle")
    with pytest.raises(InputError, match="no such file"):
        find("a\0b.nas")


def test_the_small_nozzle_is_what_its_command_makes(find):
    shipped, made = read_mesh(find("small-nozzle")), generate("nozzle", 12_000)
    np.testing.assert_array_equal(shipped.tets, made.tets)
    np.testing.assert_allclose(shipped.points, made.points, atol=1e-6)  # its digits are few
    assert "--tets 12k -o small-nozzle.nas" in Path(models.__file__).read_text()
    assert "small-nozzle" in FAMILY.models


def test_the_small_nozzle_has_one_size_and_no_other_order(find):
    with pytest.raises(InputError, match="small-nozzle is a file: a size or numbering can only be given for nozzle, "):
        find("small-nozzle", 48)
    Path("small-nozzle").write_text("of a person's own, and of no suffix")
    assert find("small-nozzle") == SMALL_NOZZLE
