"""The verbs about meshes, on meshes of polygons: generate, convert, info and view."""

import json
import re
from dataclasses import fields
from pathlib import Path

import numpy as np
import pytest

from tests.test_cli import refusal, say
from tetrabench.io import read_mesh
from tetrabench.io.polygons import read_polygons, write_polygons
from tetrabench.mesh.polygon.inspection import PolygonInspection
from tetrabench.mesh.polygon.models import generate_polygons

BOW_TIE = "OFF\n6 2 0\n0 0 0\n1 0 0\n0 1 0\n-1 0 0\n0 -1 0\n9 9 0\n3 0 1 2\n3 0 3 4\n"
FRAME = (
    "OFF\n8 4 0\n0 0 0\n3 0 0\n3 3 0\n0 3 0\n1 1 0\n2 1 0\n2 2 0\n1 2 0\n4 0 1 5 4\n4 1 2 6 5\n4 2 3 7 6\n4 0 3 7 4\n"
)


@pytest.fixture
def bow_tie(tmp_path: Path) -> Path:
    """Two triangles that touch in a node, and a node alone."""
    (tmp_path / "tie.off").write_text(BOW_TIE)
    return tmp_path / "tie.off"


def test_generate_writes_what_the_model_is(tmp_path: Path) -> None:
    for name in ("triangle", "quad", "hexagon", "voronoi"):
        mesh = generate_polygons(name, 60, seed=3)
        result = say("generate", name, "--cells", 60, "--seed", 3, "-o", tmp_path / "a.obj")
        assert (result.exit_code, result.stdout) == (0, f"{mesh.report.source}\n")
        lost = (
            f"{tmp_path / 'a.obj'}: the boundary conditions -1, -2, -3, -4 are not in it; only .npz files hold them\n"
        )
        assert result.stderr == f"{lost}wrote {tmp_path / 'a.obj'}\n"
        np.testing.assert_array_equal(read_polygons(tmp_path / "a.obj").nodes, mesh.nodes)
    result = say("generate", "quad", "--tets", 60, "--numbering", "shuffled", "-o", tmp_path / "a.npz")
    assert result.stderr == f"wrote {tmp_path / 'a.npz'}\n"
    shuffled = generate_polygons("quad", 60, numbering="shuffled")
    np.testing.assert_array_equal(read_polygons(tmp_path / "a.npz").conditions, shuffled.conditions)
    assert say("generate", "box", "--cells", 48, "-o", tmp_path / "a.nas").exit_code == 0
    assert len(read_mesh(tmp_path / "a.nas").tets) == 48


def test_generate_refuses_before_it_works(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tetrabench.mesh.polygon.models.generate_polygons", None)
    assert "polygons are not written as STL" in refusal("generate", "quad", "-o", tmp_path / "a.stl")
    assert "polygons are not written as Nastran" in refusal("generate", "quad", "-o", tmp_path / "a.nas")
    assert "can only be chosen for Nastran" in refusal("generate", "quad", "--field", "free", "-o", tmp_path / "a.obj")
    told = refusal("generate", "quads", "-o", tmp_path / "a.obj")
    assert "did you mean 'quad'? there are: nozzle, intake, box, triangle, quad, hexagon, voronoi" in told
    assert not list(tmp_path.iterdir())


def test_info_of_a_frame(tmp_path: Path) -> None:
    (tmp_path / "frame.off").write_text(FRAME)
    result = say("info", tmp_path / "frame.off")
    assert (result.exit_code, result.stderr) == (0, "")
    values = dict(re.split(" {2,}", line) for line in result.stdout.splitlines() if line)
    assert [values[name] for name in ("format", "cells", "edges", "nodes", "euler number")] == [
        "OFF",
        "4",
        "12",
        "8",
        "0",
    ]
    assert [values[name] for name in ("boundary sides", "boundaries", "components")] == ["8", "2", "1"]
    assert [values[name] for name in ("conditions", "nodes per cell", "turned")] == ["-1 8", "4 4", "1"]
    assert [values[name] for name in ("area", "lowest", "highest")] == ["8", "0, 0", "3, 3"]


def test_keys_of_the_json_are_those_documented(tmp_path: Path) -> None:
    say("generate", "voronoi", "--cells", 50, "-o", tmp_path / "a.npz")
    told = json.loads(say("info", tmp_path / "a.npz", "--format", "json").stdout)
    assert list(told) == [*(field.name for field in fields(PolygonInspection)), "needs"]
    assert all(f"        {name}: " in (PolygonInspection.__doc__ or "") for name in told if name != "needs")
    mesh = generate_polygons("voronoi", 50)
    assert list(told["conditions"]) == ["-1", "-2", "-3", "-4"]
    assert sum(told["conditions"].values()) == told["boundary_sides"] == (mesh.conditions < 0).sum()
    sizes = np.diff(mesh.starts)
    assert told["nodes_per_cell"] == {str(size): int((sizes == size).sum()) for size in np.unique(sizes)}
    assert (told["euler_number"], told["boundaries"], told["refusal"]) == (1, 1, "")
    assert told["area"] == pytest.approx(1)


def test_a_file_that_is_refused_is_described_as_it_would_be_mended(bow_tie: Path) -> None:
    assert "node 0 is where parts of the mesh touch" in refusal("convert", bow_tie, bow_tie.with_suffix(".ply"))
    result = say("info", bow_tie)
    assert result.exit_code == 0
    assert result.stdout.endswith("- the file is refused, unless --repair drop mends it\n")
    told = json.loads(say("info", bow_tie, "--format", "json").stdout)
    assert "node 0 is where" in told["refusal"]
    assert [told[name] for name in ("nodes", "split", "unreferenced", "components")] == [6, 1, 1, 2]
    assert "is refused" not in say("info", bow_tie, "--repair", "drop").stdout
    result = say("convert", bow_tie, bow_tie.with_suffix(".ply"), "--repair", "drop")
    assert result.exit_code == 0
    assert result.stderr.splitlines() == [
        f"{bow_tie}: node 0 is where parts of the mesh touch that no sides around it join (counted from 0); split",
        f"{bow_tie}: node 5 is in no cell (counted from 0); left out",
        f"wrote {bow_tie.with_suffix('.ply')}: 2 cells, 6 points",
    ]


def test_convert_there_and_back_and_in_another_order(tmp_path: Path) -> None:
    say("generate", "hexagon", "--cells", 40, "-o", tmp_path / "a.npz")
    for name in ("b.vtk", "c.off", "d.obj", "e.ply", "f.vtu", "g.npz"):
        assert say("convert", tmp_path / "a.npz", tmp_path / name).exit_code == 0
        assert say("convert", tmp_path / name, tmp_path / "back.npz").exit_code == 0
        np.testing.assert_array_equal(
            read_polygons(tmp_path / "back.npz").nodes, generate_polygons("hexagon", 40).nodes
        )
    say("convert", tmp_path / "a.npz", tmp_path / "b.npz", "--numbering", "shuffled", "--seed", 2)
    shuffled = generate_polygons("hexagon", 40, numbering="shuffled", seed=2)
    np.testing.assert_array_equal(read_polygons(tmp_path / "b.npz").nodes, shuffled.nodes)


def test_convert_says_what_it_turned_and_refuses_before_it_reads(tmp_path: Path) -> None:
    (tmp_path / "frame.off").write_text(FRAME)
    assert "turned over 1 of 4 cells" in say("convert", tmp_path / "frame.off", tmp_path / "a.obj").stderr
    assert "turned" not in say("convert", tmp_path / "a.obj", tmp_path / "b.obj").stderr
    nowhere = tmp_path / "nowhere.obj"
    assert "polygons are not written as Nastran" in refusal("convert", nowhere, tmp_path / "b.nas")
    assert "can only be chosen for Nastran" in refusal("convert", nowhere, tmp_path / "b.ply", "--field", "free")
    assert "hold surfaces, no tetras" in refusal("convert", tmp_path / "nowhere.nas", tmp_path / "b.ply")
    assert "hold surfaces, no tetras" in refusal("convert", tmp_path / "nowhere.vtk", tmp_path / "b.stl")
    assert "is what is read" in refusal("convert", tmp_path / "a.obj", tmp_path / "a.obj")
    say("convert", tmp_path / "a.obj", tmp_path / "a.vtk")  # a suffix that tetras have, too
    assert "polygons are not written as Nastran" in refusal("convert", tmp_path / "a.vtk", tmp_path / "b.nas")


# ---------------------------------------------------------------------- view


@pytest.fixture
def drawn(monkeypatch: pytest.MonkeyPatch) -> list:
    """What is given to `draw_polygons`, and the figures that it makes."""
    from tetrabench.report import polygon_picture

    draw, calls = polygon_picture.draw_polygons, []

    def note(mesh, **words):
        calls.append((mesh, words, draw(mesh, **words)))
        return calls[-1][-1]

    monkeypatch.setattr(polygon_picture, "draw_polygons", note)
    return calls


def test_a_picture_of_a_plane_mesh_has_a_colour_for_each_number_of_nodes(tmp_path: Path, drawn: list) -> None:
    mesh = generate_polygons("voronoi", 60)
    write_polygons(mesh, tmp_path / "a.vtk")
    for source in (tmp_path / "a.vtk", "voronoi"):
        words = ("--cells", 60) if source == "voronoi" else ()
        result = say("view", source, *words, "-o", tmp_path / "a.png")
        assert (result.exit_code, result.stdout, result.stderr) == (0, "", f"wrote {tmp_path / 'a.png'}\n")
        assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")
    for shown, words, figure in drawn:
        np.testing.assert_array_equal(shown.nodes, mesh.nodes)
        assert words["title"] in ("a.vtk: 60 cells", "voronoi: 60 cells")
        cells, rim = figure.axes[0].collections
        assert len(rim.get_segments()) == (mesh.conditions < 0).sum()
        colours = {}
        for size, colour in zip(np.diff(mesh.starts), map(tuple, cells.get_facecolor()), strict=True):
            colours.setdefault(size, set()).add(colour)
        assert all(len(found) == 1 for found in colours.values())
        assert len(set.union(*colours.values())) == len({min(size, 10) for size in colours})
        for path, cell in zip(cells.get_paths(), np.split(mesh.nodes, mesh.starts[1:-1]), strict=True):
            np.testing.assert_array_equal(path.vertices[:-1], mesh.points[cell])


def test_a_picture_of_a_surface(tmp_path: Path, drawn: list) -> None:
    (tmp_path / "a.off").write_text(FRAME.replace("3 3 0\n", "3 3 1\n"))
    for suffix, magic in ((".svg", b"<?xml"), (".pdf", b"%PDF")):
        assert say("view", tmp_path / "a.off", "-o", tmp_path / f"a{suffix}").exit_code == 0
        assert (tmp_path / f"a{suffix}").read_bytes().startswith(magic)
    assert drawn[0][2].axes[0].name == "3d"


def test_view_refuses_what_polygons_have_not(tmp_path: Path) -> None:
    write_polygons(generate_polygons("quad", 9), tmp_path / "a.vtk")
    (tmp_path / "frame.off").write_text(FRAME)
    for file in ("a.vtk", "frame.off"):
        words = ("view", tmp_path / file, "-o", tmp_path / "a.png")
        for more in (("--cut", "x=50%"), ("--state", "1"), ("--vtu", tmp_path / "b.vtu")):
            assert "polygons have no states and no cuts" in refusal(*words, *more)
    told = refusal("view", tmp_path / "frame.off", "-o", tmp_path / "a.png", "--cells", 9)
    assert "is a file: a size or numbering can only be given" in told
    assert "no such file" in refusal("view", tmp_path / "nowhere.obj", "-o", tmp_path / "a.png")
    (tmp_path / "tie.off").write_text(BOW_TIE)
    assert "--repair drop splits it" in refusal("view", tmp_path / "tie.off", "-o", tmp_path / "a.png")
    assert not (tmp_path / "a.png").exists()
