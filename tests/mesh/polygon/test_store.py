"""The exact file of a polygon mesh: to the bit, whole or not there, and any damage is one clear line."""

import os
import zipfile
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.polygon.meshes import ALL
from tetrabench.errors import InputError, MemoryRefusedError
from tetrabench.mesh.polygon import PolygonMesh
from tetrabench.mesh.polygon.models import generate_polygons
from tetrabench.mesh.polygon.polygon_mesh import PolygonReport
from tetrabench.mesh.polygon.store import load_polygons, save_polygons

REPORT = PolygonReport(
    source="über/\udcff.obj",  # a name that is no text
    format="Wavefront",
    skipped={"line": 3},
    quadratic=4,
    unreferenced=5,
    dropped={"three at an edge": 6},
    turned=7,
    split=8,
    warnings=["one", "two"],
)


def bits(mesh: PolygonMesh) -> list[tuple[Any, ...]]:
    """All that the arrays hold."""
    arrays = mesh.points, mesh.starts, mesh.nodes, mesh.conditions
    return [(array.dtype, array.shape, array.tobytes()) for array in arrays]


def surface() -> PolygonMesh:
    """A mesh in space with everything in its report."""
    mesh = generate_polygons("voronoi", 20)
    return replace(mesh, points=np.insert(mesh.points, 2, -0.0, axis=1), report=REPORT)


def refused(path: Path) -> bool:
    """Whether the file is refused in the one line; what it holds otherwise is the surface to the bit."""
    try:
        mesh = load_polygons(path)
    except InputError as error:
        said = str(error)
    else:
        assert bits(mesh) == bits(surface())
        assert mesh.report == REPORT
        return False
    assert said == f"{path}: not a polygon mesh as tetrabench writes it, or damaged; make it again"
    return True


@pytest.mark.parametrize("name", sorted(ALL))
def test_what_is_read_is_what_was_written(name: str, tmp_path: Path) -> None:
    factory: Callable[[], PolygonMesh] = ALL[name]
    mesh = factory()
    save_polygons(mesh, tmp_path / "a.npz")
    again = load_polygons(str(tmp_path / "a.npz"))
    assert bits(again) == bits(mesh)
    assert again.report == mesh.report
    assert all(array.flags.writeable for array in (again.points, again.starts, again.nodes, again.conditions))


def test_points_that_are_odd_and_the_whole_report(tmp_path: Path) -> None:
    mesh = surface()
    mesh.points[0], mesh.points[1, 0] = [5e-324, -0.0, 1e308], np.nan
    save_polygons(mesh, tmp_path / "a.npz")
    assert bits(load_polygons(tmp_path / "a.npz")) == bits(mesh)
    assert load_polygons(tmp_path / "a.npz").report == REPORT


def test_same_mesh_same_file_under_any_suffix_and_in_any_layout(tmp_path: Path) -> None:
    mesh = surface()
    save_polygons(mesh, tmp_path / "a.npz")
    save_polygons(replace(mesh, points=np.asfortranarray(mesh.points)), tmp_path / "b")
    assert (tmp_path / "a.npz").read_bytes() == (tmp_path / "b").read_bytes()
    assert sorted(os.listdir(tmp_path)) == ["a.npz", "b"]


def test_a_file_is_replaced_whole_or_stays(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "a.npz"
    quads = generate_polygons("quad", 4)
    save_polygons(quads, path)
    os.link(path, tmp_path / "another name of it")
    save_polygons(surface(), path)
    assert not refused(path)
    assert bits(load_polygons(tmp_path / "another name of it")) == bits(quads)  # nothing is written into a file there
    (tmp_path / "another name of it").unlink()

    def fails(file: Any, **arrays: np.ndarray) -> None:
        file.write(b"half")
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(np, "savez", fails)
    with pytest.raises(InputError, match=r"a\.npz: cannot be written: No space left on device$"):
        save_polygons(generate_polygons("quad", 9), path)
    assert not refused(path)
    assert os.listdir(tmp_path) == ["a.npz"]


def test_places_where_nothing_can_be_written_or_read(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"none/a\.npz: cannot be written: No such file or directory$"):
        save_polygons(surface(), tmp_path / "none" / "a.npz")
    with pytest.raises(InputError, match=r"a\.npz: cannot be read: No such file or directory$"):
        load_polygons(tmp_path / "a.npz")
    with pytest.raises(InputError, match=r": cannot be read: Is a directory$"):
        load_polygons(tmp_path)


def test_any_cut_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.npz"
    save_polygons(surface(), path)
    whole = path.read_bytes()
    for end in [0, 1, 100, *range(200, len(whole), 97), len(whole) - 1]:
        path.write_bytes(whole[:end])
        assert refused(path)


def test_any_changed_byte_is_refused_or_changes_nothing(tmp_path: Path, rng: np.random.Generator) -> None:
    path = tmp_path / "a.npz"
    save_polygons(surface(), path)
    whole = path.read_bytes()
    heads = [place for name in (b"PK", b"NUMPY") for place in range(len(whole)) if whole.startswith(name, place)]
    places = {place + k for place in heads for k in range(0, 60, 3)} | set(rng.integers(0, len(whole), 200).tolist())
    damage = 0
    for place in sorted(place for place in places if place < len(whole)):
        changed = bytearray(whole)
        changed[place] ^= int(rng.integers(1, 256))
        path.write_bytes(changed)
        damage += refused(path)
    assert damage > len(places) / 2


@pytest.mark.parametrize(
    "changed",
    [
        {"points": np.zeros((5, 4))},
        {"points": np.zeros(10)},
        {"points": np.zeros((5, 2), np.float32)},
        {"nodes": np.array([0, 1, 2, 3, 2, 1, 5], np.int32)},
        {"nodes": np.array([0, 1, 2, 3, 2, 1, -1], np.int32)},
        {"nodes": np.array([0, 1, 2, 3, 2, 1, 4])},
        {"starts": np.array([0, 4], np.int32)},
        {"starts": np.array([0, 4, 4, 7], np.int32)},
        {"starts": np.zeros(0, np.int32)},
        {"starts": np.array([[0, 4, 7]], np.int32)},
        {"conditions": np.zeros(6, np.int32)},
        {"report": np.frombuffer(b'{"source": 3}', np.uint8)},
        {"report": np.frombuffer(b"{", np.uint8)},
        {"report": np.array([{}])},
    ],
)
def test_arrays_that_are_no_mesh(changed: dict[str, np.ndarray], tmp_path: Path) -> None:
    sound: dict[str, np.ndarray] = {
        "points": np.zeros((5, 2)),
        "starts": np.array([0, 4, 7], np.int32),
        "nodes": np.array([0, 1, 2, 3, 2, 1, 4], np.int32),
        "conditions": np.array([-1, 0, -1, -1, 0, -1, -1], np.int32),
        "report": np.frombuffer(b"{}", np.uint8),
    }
    np.savez(tmp_path / "a.npz", **sound)  # type: ignore[arg-type]
    load_polygons(tmp_path / "a.npz")
    np.savez(tmp_path / "a.npz", **{**sound, **changed})  # type: ignore[arg-type]
    assert refused(tmp_path / "a.npz")


def test_files_of_something_else(tmp_path: Path) -> None:
    path = tmp_path / "a.npz"
    path.write_text("solid\n")
    assert refused(path)
    np.savez(path, points=np.zeros((3, 2)))
    assert refused(path)
    with path.open("wb") as file:
        np.save(file, np.zeros(3))
    assert refused(path)


def test_an_array_that_says_it_is_enormous(tmp_path: Path) -> None:
    path = tmp_path / "a.npz"
    save_polygons(surface(), path)
    with zipfile.ZipFile(path) as archive:
        members = {name: archive.read(name) for name in archive.namelist()}
    shape = str(surface().nodes.shape).encode()
    for size in (10**4, 10**9, 10**14, 10**30):
        enormous = f"({size},)".encode()
        nodes = members["nodes.npy"].replace(shape + b", }" + b" " * (len(enormous) - len(shape)), enormous + b", }")
        assert nodes != members["nodes.npy"]
        with zipfile.ZipFile(path, "w") as archive:
            for name, data in {**members, "nodes.npy": nodes}.items():
                archive.writestr(name, data)
        assert refused(path)


def test_a_file_larger_than_the_memory(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    save_polygons(surface(), tmp_path / "a.npz")
    monkeypatch.setattr("tetrabench.memory.available_bytes", lambda: 1000)
    with pytest.raises(MemoryRefusedError, match=r"a\.npz needs about .* of memory, "):
        load_polygons(tmp_path / "a.npz")
