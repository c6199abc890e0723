"""Meshes of polygons in files: what each format holds, what is refused, what is taken of other programs' files."""

import struct
from pathlib import Path

import meshio
import numpy as np
import pytest

from tests.mesh.polygon.test_check import CUBE, CUBE_CELLS, cells_of
from tetrabench.errors import InputError, MemoryRefusedError, RepairableError
from tetrabench.io.formats import BY_SUFFIX
from tetrabench.io.kinds import read_any
from tetrabench.io.polygons import MOST_NODES, check_polygon_target, read_polygons, write_polygons
from tetrabench.mesh import TetraMesh
from tetrabench.mesh.models import generate
from tetrabench.mesh.polygon import PolygonMesh
from tetrabench.mesh.polygon.check import settle
from tetrabench.mesh.polygon.models import generate_polygons
from tetrabench.mesh.polygon.polygon_mesh import CONDITION

HOUSE = """# two squares under a pentagon
mtllib a.mtl
v 0 0 0 0.5 0.5 0.5
v 1 0 0 0.5 0.5 0.5
v 2 0 0 0.5 0.5 0.5
v 0 1 0 0.5 0.5 0.5
v 1 1 0 0.5 0.5 0.5
v 2 1 0 0.5 0.5 0.5
v 1 2 0 0.5 0.5 0.5
vt 0 0
vn 0 0 1
g walls
f 1/1/1 2/1/1 5/1/1 4/1/1
f 2//1 5//1 6//1 3//1
g roof
f 4 5 6 7
"""


@pytest.fixture(scope="module")
def meshes() -> dict[str, PolygonMesh]:
    """By what the widest cell is."""
    square = np.cumsum([0, *map(len, CUBE_CELLS)])
    return {
        "triangles": generate_polygons("triangle", 40),
        "quads": generate_polygons("quad", 30, numbering="shuffled"),
        "surface": settle(CUBE, square, np.concatenate(CUBE_CELLS)),
        "many": generate_polygons("voronoi", 60),
    }


def wheel(rim: int) -> PolygonMesh:
    """One cell with a node too many for a byte, beside a triangle."""
    angles = np.linspace(0, 2 * np.pi, rim, endpoint=False)
    points = np.column_stack([np.cos(angles), np.sin(angles)])
    return settle(np.append(points, [[2, 1]], axis=0), [0, rim, rim + 3], [*range(rim), 1, 0, rim])


@pytest.mark.parametrize("suffix", MOST_NODES)
@pytest.mark.parametrize("kind", ["triangles", "quads", "surface", "many"])
def test_there_and_back(tmp_path: Path, meshes: dict[str, PolygonMesh], suffix: str, kind: str) -> None:
    mesh, path = meshes[kind], tmp_path / f"a{suffix}"
    if np.diff(mesh.starts).max() > MOST_NODES[suffix]:
        with pytest.raises(InputError, match=r"holds no cell of \d+ nodes, and the mesh does; write .npz .obj"):
            write_polygons(mesh, path)
        assert not list(tmp_path.iterdir())
        return
    lost = write_polygons(mesh, path)
    assert [file.name for file in tmp_path.iterdir()] == [path.name]
    back = read_polygons(path)
    for array in ("points", "starts", "nodes"):
        np.testing.assert_array_equal(getattr(back, array), getattr(mesh, array))
    if suffix == ".npz":
        np.testing.assert_array_equal(back.conditions, mesh.conditions)
        assert lost == ""
        return
    np.testing.assert_array_equal(back.conditions, np.where(mesh.conditions < 0, CONDITION, 0))
    assert back.report.turned == 0
    assert back.report.format == BY_SUFFIX[suffix].title
    assert lost == (
        ""
        if kind == "surface"
        else f"{path}: the boundary conditions -1, -2, -3, -4 are not in it; only .npz files hold them"
    )


def test_cells_with_more_nodes_than_a_byte_counts(tmp_path: Path) -> None:
    mesh = wheel(256)
    with pytest.raises(InputError, match="no cell of 256 nodes"):
        write_polygons(mesh, tmp_path / "a.ply")
    for suffix, rim in ((".ply", 255), (".obj", 256), (".vtk", 256), (".vtu", 256), (".off", 256)):
        mesh = wheel(rim)
        write_polygons(mesh, tmp_path / f"a{suffix}")
        assert cells_of(read_polygons(tmp_path / f"a{suffix}")) == cells_of(mesh)


def test_an_obj_of_another_program(tmp_path: Path) -> None:
    path = tmp_path / "house.obj"
    path.write_text(HOUSE)
    mesh = read_polygons(path)
    assert cells_of(mesh) == [[0, 1, 4, 3], [1, 2, 5, 4], [3, 4, 5, 6]]
    assert (mesh.points.shape, mesh.report.turned, mesh.report.format) == ((7, 2), 1, "OBJ")
    path.write_text(HOUSE[:-3])
    with pytest.raises(InputError, match="ends within a line; is it cut"):
        read_polygons(path)


def test_nodes_of_an_obj_may_be_counted_from_the_last_one(tmp_path: Path) -> None:
    """Relative names are those of the points so far, wherever further points follow; whatever else is said is left out."""
    text = HOUSE.splitlines()
    (tmp_path / "house.obj").write_text(HOUSE)
    mesh = read_polygons(tmp_path / "house.obj")
    for with_rest in ("{}", "{}/1", "{}//2", "{}/-1/-2"):
        path, so_far, lines = tmp_path / "a.obj", 0, ["mtllib a.mtl", "vt 0 0", "vn 0 0 1"]
        for line in text:
            kind, *words = line.split() or [""]
            so_far += kind == "v"
            if kind == "f":
                named = [int(word.partition("/")[0]) - 1 - so_far for word in words]
                lines += [
                    "f " + with_rest.format(named[0]) + " \\",
                    " ".join(map(with_rest.format, named[1:])) + " # f",
                ]
            else:
                lines.append(line + " 0.5 0.5 0.5" * (kind == "v"))
        path.write_text("\n".join([*lines, "l -1 -2", "p 1", ""]))
        other = read_polygons(path)
        assert cells_of(other) == cells_of(mesh)
        assert other.points.tolist() == mesh.points.tolist()
        assert other.report.skipped == {"line": 1, "vertex": 1}


def test_what_an_obj_is_refused_for(tmp_path: Path) -> None:
    path, points = tmp_path / "a.obj", "v 0 0\nv 1 0 0\nv 0 1 0\n"
    path.write_text(points + "f -3 -2 -1\n")
    assert read_polygons(path).points.tolist() == [[0, 0], [1, 0], [0, 1]]
    for text, reason in (
        (points + "f 1 2 -4\n", ":4: cannot be read as OBJ: a cell names node -4, and 3 are there so far"),
        (points + "f 0 1 2\n", ":4: cannot be read as OBJ: a cell names node 0, and 3"),
        (points + "\nf 1 2 x/1\n", ":5: cannot be read as OBJ: invalid literal"),
        (points + "f 1 2 4\n", ": cell 0 names node 3, but nodes run from 0 to 2"),
        (points + f"f 1 2 {10**30}\n", ":4: cannot be read as OBJ"),
        ("v 0 one 0\n", ":1: cannot be read as OBJ: could not convert"),
        ("v 1\n", ":1: cannot be read as OBJ: a point of 1 coordinates"),
        (points + "f 1 2 \\\n", ": ends within a statement; is it cut?"),
        (points + "f 1 2 3", ": ends within a line; is it cut?"),
        (points + "l 1 2\n", ": holds no polygons; it holds line 1"),
    ):
        path.write_text(text)
        with pytest.raises(InputError) as told:
            read_polygons(path)
        assert str(told.value).startswith(f"{path}{reason}"), told.value


def test_a_ply_under_either_name_in_text_or_binary(tmp_path: Path) -> None:
    head = "ply\nformat {}\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\n"
    head += "element face 6\nproperty list uchar int {}\n{}end_header\n"
    binary = CUBE.astype("<f4").tobytes() + b"".join(struct.pack("<B4i", 4, *cell) for cell in CUBE_CELLS)
    text = "".join("{} {} {}\n".format(*point) for point in CUBE)
    text += "".join("4 {} {} {} {}\n".format(*cell) for cell in CUBE_CELLS)
    path = tmp_path / "cube.ply"
    for name in ("vertex_index", "vertex_indices"):
        for kind, body in (("ascii 1.0", text.encode()), ("binary_little_endian 1.0", binary)):
            path.write_bytes(head.format(kind, name, "").encode() + body)
            assert cells_of(read_polygons(path)) == CUBE_CELLS
            path.write_bytes(head.format(kind, name, "").encode() + body[: -17 if kind != "ascii 1.0" else -10])
            with pytest.raises(InputError):
                read_polygons(path)
    flagged = CUBE.astype("<f4").tobytes() + b"".join(struct.pack("<B4iB", 4, *cell, 0) for cell in CUBE_CELLS)
    path.write_bytes(
        head.format("binary_little_endian 1.0", "vertex_indices", "property uchar red\n").encode() + flagged
    )
    with pytest.raises(InputError, match=r"cube\.ply: has values of its faces, such as colours"):
        read_polygons(path)


def test_an_off_of_another_program(tmp_path: Path) -> None:
    path = tmp_path / "a.off"
    body = "0 0 0\n1 0 0\n1 1 0 # here\n0 1 0\n2 0.5 0\n\n4 0 1 2 3 255 0 0\n3 1 4 2\n"
    for head in ("OFF\n# a comment\n5 2 0\n", "OFF 5 2 0\n", "\nOFF\n5 2\n"):
        path.write_text(head + body)
        assert cells_of(read_polygons(path)) == [[0, 1, 2, 3], [1, 4, 2]]
    for text, reason in (
        ("COFF\n5 2 0\n" + body, "begins with 'COFF', not with OFF"),
        ("", "is empty"),
        ("OFF\n5 3 0\n" + body, "announces 5 points and 3 cells and holds 5 and 2; is it cut?"),
        ("OFF\n5 2 0\n" + body[:-3], "cell 1 announces 3 nodes and holds 2; is it cut?"),
        ("OFF\n5 2 0\n" + body.replace("0.5", "half"), "cannot be read as OFF: could not convert"),
        ("OFF\n5 2 0\n" + body.replace("1 1 0", "1 1"), "cannot be read as OFF"),
        ("OFF\n", "does not say how many"),
        ("OFF\n5 2 0\n" + body.replace("3 1 4 2", "3 1 4 5"), "cell 1 names node 5, but nodes run from 0 to 4"),
    ):
        path.write_text(text)
        with pytest.raises(InputError) as told:
            read_polygons(path)
        assert reason in str(told.value)
        assert str(told.value).startswith(f"{path}: ")


def test_a_gmsh_surface_with_midside_nodes_lines_and_a_centre(tmp_path: Path) -> None:
    points = np.array(
        [[0, 0], [2, 0], [2, 2], [0, 2], [1, 0], [2, 1], [1, 2], [0, 1], [4, 1], [3, 0.5], [3, 1.5], [9, 9]]
    )
    cells = [
        ("line3", [[0, 1, 4]]),
        ("quad8", [[0, 1, 2, 3, 4, 5, 6, 7]]),
        ("triangle6", [[2, 1, 8, 5, 9, 10]]),
        ("vertex", [[11]]),
    ]
    path = tmp_path / "a.msh"
    meshio.write(path, meshio.Mesh(np.column_stack([points, np.zeros(12)]), cells), file_format="gmsh22")
    with pytest.raises(RepairableError, match="in no cell"):
        read_polygons(path)
    mesh = read_polygons(path, repair="drop")
    assert cells_of(mesh) == [[0, 1, 2, 3], [2, 1, 4]]
    assert mesh.points.tolist() == points[[0, 1, 2, 3, 8]].tolist()
    assert (mesh.report.quadratic, mesh.report.unreferenced) == (2, 1)
    assert mesh.report.skipped == {"line3": 1, "vertex": 1}


def test_a_file_of_both_kinds_is_one_of_tetras(tmp_path: Path) -> None:
    path, box = tmp_path / "a.vtu", generate("box", 48)
    meshio.write(path, meshio.Mesh(box.points, [("triangle", box.tets[:, :3]), ("tetra", box.tets)]))
    assert isinstance(read_any(path), TetraMesh)
    meshio.write(path, meshio.Mesh(CUBE, [("quad", CUBE_CELLS)]))
    assert isinstance(read_any(path), PolygonMesh)
    meshio.write(path, meshio.Mesh(CUBE, [("hexahedron", [list(range(8))])]))
    with pytest.raises(InputError, match="holds no tetras; it holds hexahedron 1"):
        read_any(path)
    with pytest.raises(InputError, match="holds no polygons; it holds hexahedron 1"):
        read_polygons(path)


def test_what_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, meshes: dict[str, PolygonMesh]) -> None:
    with pytest.raises(InputError, match="there is no such file"):
        read_polygons(tmp_path / "a.obj")
    with pytest.raises(InputError, match="did you mean"):
        read_polygons(tmp_path / "a.objj")
    for name, title in (("a.stl", "STL"), ("a.nas", "Nastran")):
        with pytest.raises(InputError, match=f"polygons are not written as {title}; write .npz .obj"):
            check_polygon_target(tmp_path / name)
    for suffix in (".obj", ".off"):
        with pytest.raises(InputError, match="cannot be written"):
            write_polygons(meshes["quads"], tmp_path / "nowhere" / f"a{suffix}")
        write_polygons(meshes["quads"], tmp_path / f"a{suffix}")
    monkeypatch.setattr("tetrabench.memory.available_bytes", lambda: 1000)
    for suffix in (".obj", ".off"):
        with pytest.raises(MemoryRefusedError):
            read_polygons(tmp_path / f"a{suffix}")
