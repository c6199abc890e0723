"""Every format: what is written is read again, and what goes wrong in meshio becomes one clear line."""

import random
import re
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest

from tests.meshes import mesh_of, single
from tetrabench.errors import InputError, MemoryRefusedError, RepairableError
from tetrabench.io import read_mesh, write_mesh
from tetrabench.io.formats import BY_SUFFIX, FORMATS, partners
from tetrabench.mesh import TetraMesh
from tetrabench.mesh.models import generate

WRITABLE = [suffix for suffix, form in BY_SUFFIX.items() if form.writes]
SURFACES = [suffix for suffix, form in BY_SUFFIX.items() if not form.writes]
CORNER = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [0.5, 0.5, 0.5]])


def model() -> TetraMesh:
    """A mesh with numbers that are hard to write, and ids of its own."""
    mesh = generate("box", 48, seed=1)
    points = mesh.points * np.pi
    points[0], points[1] = [1 / 3, -2e-300, 1e300], [5e-324, -0.0, np.nextafter(1, 2)]
    return replace(mesh, points=points, point_ids=mesh.point_ids * 7 + 10**9, tet_ids=mesh.tet_ids + 3 * 10**10)


def write_raw(path: Path, points: object, cells: list[tuple[str, object]], **options: Any) -> Path:
    """A file as meshio writes it."""
    options.setdefault("file_format", BY_SUFFIX[path.suffix].name)
    meshio.write(path, meshio.Mesh(points, [(kind, np.array(rows)) for kind, rows in cells]), **options)
    return path


def refused(path: Path, **options: str) -> str:
    """Why a file is refused, after its name."""
    with pytest.raises(InputError) as caught:
        read_mesh(path, **options)
    message = str(caught.value)
    assert "\n" not in message
    assert message.startswith(f"{path}: ")
    return message.removeprefix(f"{path}: ")


# ---------------------------------------------------------------------- round trips


@pytest.mark.parametrize("suffix", WRITABLE)
def test_round_trip(tmp_path: Path, suffix: str, capfd: pytest.CaptureFixture[str]) -> None:
    mesh, path = model(), tmp_path / f"part{suffix}"
    write_mesh(mesh, path)
    back = read_mesh(path)
    np.testing.assert_array_equal(back.tets, mesh.tets)
    assert back.points.tobytes() == mesh.points.tobytes()  # -0.0 and 0.0 differ
    if BY_SUFFIX[suffix].keeps_ids:
        np.testing.assert_array_equal(back.point_ids, mesh.point_ids)
        np.testing.assert_array_equal(back.tet_ids, mesh.tet_ids)
    else:
        assert back.point_ids.tolist() == list(range(1, len(mesh.points) + 1))
        assert back.tet_ids.tolist() == list(range(1, len(mesh.tets) + 1))
    assert (back.report.source, back.report.format) == (str(path), BY_SUFFIX[suffix].title)
    assert len(back.report.warnings) == (suffix == ".inp")
    assert {file.name for file in tmp_path.iterdir()} == {path.name, *(p.name for p in partners(path) if p.exists())}
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize(
    ("suffix", "options"),
    [
        (".msh", {"file_format": "gmsh", "binary": False}),
        (".msh", {"file_format": "gmsh22"}),
        (".msh", {"file_format": "gmsh22", "binary": False}),
        (".vtk", {"file_format": "vtk42"}),
        (".vtk", {"file_format": "vtk42", "binary": False}),
        (".vtk", {"file_format": "vtk", "binary": False}),
        (".vtu", {"file_format": "vtu", "binary": False}),
        (".vtu", {"file_format": "vtu", "compression": None}),
        (".vtu", {"file_format": "vtu", "compression": "lzma"}),
        (".xdmf", {"file_format": "xdmf", "data_format": "HDF"}),
        (".xdmf", {"file_format": "xdmf", "data_format": "Binary"}),
    ],
)
def test_dialects_that_others_write(tmp_path: Path, suffix: str, options: dict[str, Any]) -> None:
    mesh = generate("box", 48, seed=1)
    back = read_mesh(write_raw(tmp_path / f"part{suffix}", mesh.points, [("tetra", mesh.tets)], **options))
    np.testing.assert_array_equal(back.tets, mesh.tets)
    np.testing.assert_allclose(back.points, mesh.points, rtol=1e-10)
    assert back.points.dtype == np.float64


def test_suffixes_are_taken_in_any_case(tmp_path: Path) -> None:
    write_mesh(single(), tmp_path / "PART.VTU")
    assert len(read_mesh(tmp_path / "PART.VTU").tets) == 1


def test_every_format_of_the_table_is_documented() -> None:
    table = sys.modules["tetrabench.io.formats"].__doc__
    assert table
    for form in FORMATS:
        (row,) = (line for line in table.splitlines() if f" {form.suffixes[0]} " in line and line.startswith("|"))
        if form.writes and form.name != "medit":
            assert all(suffix in row for suffix in form.suffixes)
            assert ("kept" in row) == form.keeps_ids


# ---------------------------------------------------------------------- what files hold


def test_blocks_are_joined_and_other_cells_counted(tmp_path: Path) -> None:
    cells = [
        ("triangle", [[0, 1, 2]]),
        ("tetra", [[0, 1, 2, 3]]),
        ("line", [[0, 1], [1, 2]]),
        ("tetra", [[1, 2, 3, 4]]),
    ]
    mesh = read_mesh(write_raw(tmp_path / "part.vtu", CORNER, cells))
    assert mesh.tets.tolist() == [[0, 1, 2, 3], [1, 2, 3, 4]]
    assert mesh.report.skipped == {"line": 2, "triangle": 1}


def test_corners_of_quadratic_tetras(tmp_path: Path) -> None:
    corners = CORNER[:4]
    middles = [(corners[a] + corners[b]) / 2 for a, b in ((0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3))]
    points = np.concatenate([corners, middles, CORNER[4:]])
    cells = [("tetra10", [list(range(10))]), ("tetra", [[1, 2, 3, 10]])]
    for suffix, name in ((".vtu", "vtu"), (".msh", "gmsh22"), (".inp", "abaqus")):
        path = write_raw(tmp_path / f"part{suffix}", points, cells, file_format=name)
        mesh = read_mesh(path)
        assert mesh.points[mesh.tets].tolist() == CORNER[[[0, 1, 2, 3], [1, 2, 3, 4]]].tolist()
        assert (mesh.report.quadratic, mesh.report.unreferenced) == (1, 6)
        assert len(read_mesh(path, unused="keep").points) == 11


def test_no_tetras(tmp_path: Path) -> None:
    surface = [("triangle", [[0, 1, 2], [0, 1, 3]]), ("line", [[0, 1]])]
    assert refused(write_raw(tmp_path / "a.vtu", CORNER, surface)) == "holds no tetras; it holds triangle 2, line 1"
    assert refused(write_raw(tmp_path / "b.mesh", CORNER, [])) == "holds no tetras; it holds no cells at all"
    for suffix in SURFACES:
        path = write_raw(tmp_path / f"c{suffix}", CORNER, surface[:1])
        assert refused(path) == "holds no tetras; it holds triangle 2"
    in_the_plane = write_raw(tmp_path / "d.su2", CORNER[:3, :2], [("triangle", [[0, 1, 2]])])
    assert refused(in_the_plane) == "holds no tetras; it holds triangle 1"


def test_points_in_the_plane(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    flat = meshio.Mesh(CORNER[:, :2], [("tetra", [[0, 1, 2, 3]])])
    monkeypatch.setattr(meshio, "read", lambda *_, **__: flat)
    write_mesh(single(), tmp_path / "a.vtk")
    assert refused(tmp_path / "a.vtk") == "its points have 2 coordinates, not 3"


def test_faults_are_named_by_file_and_id(tmp_path: Path) -> None:
    mesh = mesh_of(CORNER, [[0, 1, 2, 3], [0, 0, 1, 2], [1, 2, 3, 4], [4, 4, 4, 4]])
    mesh.tet_ids = mesh.tet_ids * 11
    write_mesh(mesh, tmp_path / "a.vtu")
    assert refused(tmp_path / "a.vtu") == "tetra 22 repeats a node; so does 44; convert --repair drop leaves them out"
    with pytest.raises(RepairableError):
        read_mesh(tmp_path / "a.vtu")
    back = read_mesh(tmp_path / "a.vtu", repair="drop")
    assert back.tet_ids.tolist() == [11, 33]
    assert back.report.dropped == {"repeated node": 2}
    mesh.points[2, 1] = np.nan
    write_mesh(mesh, tmp_path / "a.vtu")
    assert refused(tmp_path / "a.vtu", repair="drop") == "point 3 has a coordinate that is NaN or infinite"


def test_vertex_that_is_no_point(tmp_path: Path) -> None:
    path = write_raw(tmp_path / "a.vtu", CORNER, [("tetra", [[0, 1, 2, 3], [0, 1, 2, 7]])])
    assert refused(path) == "tetra 2 has the vertices 0 1 2 7, but the indices run from 0 to 4"


def test_ids_that_are_no_numbers_for_all_are_rows(tmp_path: Path) -> None:
    wrong = {"point_data": {"point_id": np.arange(5) / 2}, "cell_data": {"tetra_id": [np.array([8]), np.array([3.0])]}}
    raw = meshio.Mesh(CORNER, [("tetra", [[0, 1, 2, 3]]), ("triangle", [[0, 1, 2]])], **wrong)
    raw.write(tmp_path / "a.xdmf", data_format="XML")
    mesh = read_mesh(tmp_path / "a.xdmf", unused="keep")
    assert mesh.point_ids.tolist() == [1, 2, 3, 4, 5]


# ---------------------------------------------------------------------- what goes wrong


@pytest.mark.parametrize("suffix", WRITABLE)
def test_cut_file_is_refused_or_whole_or_doubted(tmp_path: Path, suffix: str) -> None:
    mesh = generate("box", 48, seed=1)
    path = tmp_path / f"part{suffix}"
    write_mesh(mesh, path)
    text = path.read_bytes()
    cuts = random.Random(1)
    for size in [*range(len(text) - 30, len(text)), *cuts.sample(range(len(text)), 40)]:
        path.write_bytes(text[:size])
        try:
            back = read_mesh(path)
        except InputError:
            continue
        if not (suffix == ".inp" and back.report.warnings):
            np.testing.assert_array_equal(back.tets, mesh.tets)
            np.testing.assert_array_equal(back.points, mesh.points)


@pytest.mark.parametrize("suffix", [".ele", ".node"])
def test_partner_may_be_cut_too(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"part{suffix}"
    write_mesh(generate("box", 48, seed=1), path)
    (partner,) = partners(path)
    text = partner.read_bytes()
    for size in (0, 40, len(text) // 2, len(text) - 2, len(text) - 1):
        partner.write_bytes(text[:size])
        with pytest.raises(InputError, match=re.escape(str(tmp_path / "part."))):
            read_mesh(path)
    partner.unlink()
    assert refused(path) == f"cannot be read as TetGen: No such file or directory: {partner}"


@pytest.mark.parametrize("suffix", BY_SUFFIX)
def test_rubbish(tmp_path: Path, suffix: str, capfd: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / f"part{suffix}"
    chance = random.Random(2)
    for text in (chance.randbytes(1), chance.randbytes(1000), b"solid nonsense\n" * 9, b"\0" * 5000, b"1 2 3\n"):
        path.write_bytes(text)
        refused(path)
    for text in (b"", b"\n\n", b"# nothing\n\n#"):
        path.write_bytes(text)
        assert refused(path) == "is empty"
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("suffix", [".vtk", ".msh", ".vtu", ".mesh", ".med", ".xml"])
def test_file_of_another_format(tmp_path: Path, suffix: str) -> None:
    write_mesh(single(), tmp_path / "part.inp")
    (tmp_path / "part.inp").rename(tmp_path / f"part{suffix}")
    assert refused(tmp_path / f"part{suffix}").startswith(f"cannot be read as {BY_SUFFIX[suffix].title}: ")


def test_fewer_cells_than_announced(tmp_path: Path) -> None:
    mesh = generate("box", 48)
    for suffix, mark in ((".vtk", b"CELL_TYPES 48"), (".su2", b"NELEM= 48")):
        path = tmp_path / f"part{suffix}"
        write_raw(path, mesh.points, [("tetra", mesh.tets)], file_format="vtk42" if suffix == ".vtk" else "su2")
        text = path.read_bytes()
        assert mark in text
        cut = len(text) - 20 if suffix == ".vtk" else text.index(b"NMARK") - len(b"10 0 0 0 0\n")
        path.write_bytes(text[:cut] if suffix == ".vtk" else text[: text.rindex(b"\n", 0, cut) + 1])
        assert re.match(r"announces 48 cells and holds 4\d; is it cut\?|ends within", refused(path))


ABAQUS = "*NODE\n1,0.,0.,0.\n2,1.,0.,0.\n3,0.,1.,0.\n4,0.,0.,1.\n*ELEMENT, TYPE=C3D4\n1,1,2,3,4\n"


def test_abaqus_that_meshio_would_get_wrong(tmp_path: Path) -> None:
    path = tmp_path / "part.inp"
    path.write_text(ABAQUS + "*NSET, NSET=all\n1,2,3,4\n*NODE OUTPUT\n*NODE PRINT, NSET=all\n**\n")
    mesh = read_mesh(path)
    assert (len(mesh.tets), mesh.report.warnings) == (1, [])
    path.write_text(ABAQUS)
    assert read_mesh(path).report.warnings == [
        f"{path}: its last line belongs to the mesh; Abaqus files that are cut look the same"
    ]
    path.write_text(ABAQUS + "*node , nset=more\n9,0.,0.,0.\n")
    assert refused(path).startswith("has 2 *NODE blocks, and meshio takes the last alone")
    for line in ("*ELGEN, ELSET=all\n1,2,1,1\n", "*System\n", "*NGEN\n1,4\n"):
        path.write_text(ABAQUS + line)
        assert "which meshio ignores" in refused(path)
    path.write_text(ABAQUS.replace("*NODE", "*NODE, SYSTEM=C"))
    assert "'*NODE, SYSTEM=C'" in refused(path)
    path.write_text(ABAQUS + "*ELEMENT, TYPE=C3D4, INPUT=more.inp\n**\n")
    assert "which meshio ignores" in refused(path)
    path.write_text(ABAQUS.replace("C3D4", "C3D99"))
    assert refused(path) == "cannot be read as Abaqus: Element type not available: C3D99"


class Stub:
    """meshio.read, doing something else."""

    def __init__(self, outcome: object) -> None:
        self.outcome = outcome

    def __call__(self, *_: object, **__: object) -> object:
        print("chatter")
        print("chatter", file=sys.stderr)
        if isinstance(self.outcome, BaseException):
            raise self.outcome
        return self.outcome


OUTCOMES: dict[str, tuple[object, str]] = {
    "SystemExit": (SystemExit(1), "cannot be read as Medit: chatter"),
    "nothing": (None, "cannot be read as Medit: AttributeError: 'NoneType' object has no attribute 'points'"),
    "an error of many lines": (ValueError("one\n  two\n"), "cannot be read as Medit: ValueError: one two"),
    "an error without words": (AssertionError(), "cannot be read as Medit: AssertionError"),
    "a file that cannot be opened": (PermissionError(13, "Permission denied", "x"), "Permission denied: x"),
    "recursion": (RecursionError("too deep"), "RecursionError: too deep"),
    "no memory": (MemoryError(), "it needs more memory than there is, or it is damaged"),
    "ragged cells": (
        type("Raw", (), {"points": CORNER, "cells": [meshio.CellBlock("tetra", [[0, 1, 2]])]})(),
        "cannot be read as Medit",
    ),
    "points that are none": (type("Raw", (), {"points": ["a"], "cells": []})(), "could not convert string to float"),
}


@pytest.mark.parametrize(("outcome", "reason"), OUTCOMES.values(), ids=OUTCOMES.keys())
def test_whatever_meshio_does_is_one_line(
    tmp_path: Path,
    outcome: object,
    reason: str,
    monkeypatch: pytest.MonkeyPatch,
    capfd: pytest.CaptureFixture[str],
) -> None:
    write_mesh(single(), tmp_path / "part.mesh")
    monkeypatch.setattr(meshio, "read", Stub(outcome))
    assert reason in refused(tmp_path / "part.mesh")
    assert capfd.readouterr() == ("", "")


def test_interruption_is_none_of_its_errors(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write_mesh(single(), tmp_path / "part.mesh")
    monkeypatch.setattr(meshio, "read", Stub(KeyboardInterrupt()))
    with pytest.raises(KeyboardInterrupt):
        read_mesh(tmp_path / "part.mesh")


def test_what_meshio_warns_of_is_reported(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "part.mesh"
    write_mesh(single(), path)
    path.write_text(path.read_text().replace("End", "RequiredVertices\n1\n1\nRequiredVertices\n1\n2\nEnd"))
    mesh = read_mesh(path)
    assert len(mesh.report.warnings) == 1  # said twice
    assert re.search(r"part\.mesh: .*RequiredVertices", mesh.report.warnings[0])
    assert capfd.readouterr() == ("", "")


def test_what_meshio_writes_as_msh_unless_told_otherwise(tmp_path: Path) -> None:
    path = tmp_path / "part.msh"
    meshio.write(path, meshio.Mesh(single().points, [("tetra", single().tets)]))
    with pytest.raises(InputError, match=r"part\.msh: is a mesh of Ansys Fluent, .*file_format='gmsh'$"):
        read_mesh(path)


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="only Linux limits addresses")
def test_damaged_file_does_not_take_the_memory(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Node tags up to 2^29: meshio makes a table of them all, four gigabytes, more than a process has left over of its own."""
    lines = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 4 1 {0}\n3 1 0 4\n1\n2\n3\n{0}\n"
    lines += "0 0 0\n1 0 0\n0 1 0\n0 0 1\n$EndNodes\n$Elements\n1 1 1 1\n3 1 4 1\n1 1 2 3 {0}\n$EndElements\n"
    path = tmp_path / "part.msh"
    path.write_text(lines.format(4))
    assert read_mesh(path).tets.tolist() == [[0, 1, 2, 3]]
    path.write_text(lines.format(2**29))
    monkeypatch.setattr("tetrabench.memory.available_bytes", lambda: 2**28)
    with pytest.raises(MemoryRefusedError, match="more memory than there is"):
        read_mesh(path)


# ---------------------------------------------------------------------- writing


@pytest.mark.parametrize("suffix", SURFACES)
def test_surfaces_cannot_be_written(tmp_path: Path, suffix: str) -> None:
    with pytest.raises(InputError, match="files hold surfaces, no tetras"):
        write_mesh(single(), tmp_path / f"part{suffix}")


def test_whole_file_or_the_one_before(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "part.ele"
    write_mesh(single(), path)
    before = {file.name: file.read_bytes() for file in tmp_path.iterdir()}

    def write(draft: Path, *_: object, **__: object) -> None:
        draft.write_text("half of")
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(meshio, "write", write)
    with pytest.raises(InputError, match=r"part\.ele: cannot be written as TetGen: No space left on device$"):
        write_mesh(generate("box", 48), path)
    assert {file.name: file.read_bytes() for file in tmp_path.iterdir()} == before


def test_folder_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"part\.vtu: cannot be written: No such file"):
        write_mesh(single(), tmp_path / "nowhere" / "part.vtu")


# ---------------------------------------------------------------------- dispatch


def test_unknown_suffixes_and_the_nearest(tmp_path: Path) -> None:
    for use in (read_mesh, lambda path: write_mesh(single(), path)):
        with pytest.raises(InputError, match=r"'\.vtux' names no known format; did you mean \.vtu\? known are \.nas "):
            use(tmp_path / "part.vtux")
        with pytest.raises(InputError, match="the suffix '' names no known format; known are"):
            use(tmp_path / "part")


def test_missing_files_and_folders(tmp_path: Path) -> None:
    assert refused(tmp_path / "other.vtu") == "there is no such file"
    assert refused(tmp_path / "box.msh").endswith("make it with: tetrabench generate box -o box.msh")
    assert refused(tmp_path / f"{'x' * 300}.nas") == "cannot be read: File name too long"
    (tmp_path / "part.mesh").mkdir()
    assert refused(tmp_path / "part.mesh") == "a folder, not a file"


def test_field_is_nastrans(tmp_path: Path) -> None:
    write_mesh(single(), tmp_path / "part.nas", field="large")
    assert "GRID*" in (tmp_path / "part.nas").read_text()
    with pytest.raises(InputError, match="can only be chosen for Nastran"):
        write_mesh(single(), tmp_path / "part.vtu", field="large")


@pytest.mark.parametrize("suffix", [".nas", ".vtu"])
def test_too_large_for_the_memory(tmp_path: Path, suffix: str, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / f"part{suffix}"
    write_mesh(single(), path)
    available: Callable[[], int] = lambda: 100  # noqa: E731
    monkeypatch.setattr("tetrabench.memory.available_bytes", available)
    with pytest.raises(MemoryRefusedError, match=r"^reading .*part.* needs about .* MiB of memory, 0\.0 MiB are"):
        read_mesh(path)
