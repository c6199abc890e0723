"""Files of objects: a write and a read give the same bits; what cannot be taken is refused with its line."""

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tetrabench.collision.objects import Objects, Start, make_objects
from tetrabench.collision.start import files
from tetrabench.collision.start.files import (
    check_objects_source,
    check_objects_target,
    holds_objects,
    read_objects,
    write_objects,
)
from tetrabench.collision.start.models import generate_objects
from tetrabench.errors import InputError, MemoryRefusedError
from tetrabench.io.polygons import write_polygons
from tetrabench.mesh.polygon.models import generate_polygons

ANY = st.floats(allow_nan=False, allow_infinity=False, width=64)
ABOVE_0 = st.floats(min_value=0, exclude_min=True, allow_infinity=False)
CIRCLES = st.lists(st.tuples(ANY, ANY, ANY, ANY, ABOVE_0, ABOVE_0), max_size=6)


@pytest.fixture
def table(tmp_path: Path) -> Callable[[str], Path]:
    """Writes a .csv file."""

    def write(text: str) -> Path:
        (tmp_path / "a.csv").write_text(text)
        return tmp_path / "a.csv"

    return write


def same(one: Objects, other: Objects) -> bool:
    """To the bit."""
    return all(a.tobytes() == b.tobytes() for a, b in zip(one, other, strict=True))


@settings(deadline=None, max_examples=60)
@given(circles=CIRCLES, width=ABOVE_0, height=ABOVE_0)
def test_there_and_back(tmp_path_factory: pytest.TempPathFactory, circles: list, width: float, height: float) -> None:
    folder = tmp_path_factory.mktemp("files")
    objects = make_objects(*np.array(circles, np.float64).reshape(-1, 6).T)
    start = Start(objects, width, height, "words of \udcff any kind")
    for name in ("a.npz", "a.csv", "A.NPZ", "A.CSV"):
        write_objects(start, folder / name)
        back = read_objects(folder / name)
        assert same(back.objects, objects)
        assert (back.width, back.height) == (width, height)
        assert back.source == (start.source if "npz" in name.lower() else str(folder / name))
        for column in back.objects:
            assert column.dtype == np.float64
            assert column.flags.c_contiguous
            assert column.flags.writeable
    assert sorted(file.name for file in folder.iterdir()) == ["A.CSV", "A.NPZ", "a.csv", "a.npz"]


def test_same_start_same_file(tmp_path: Path) -> None:
    start = generate_objects("mixed", 30)
    for suffix in (".npz", ".csv"):
        for name in ("a", "b"):
            write_objects(start, tmp_path / f"{name}{suffix}")
        assert (tmp_path / f"a{suffix}").read_bytes() == (tmp_path / f"b{suffix}").read_bytes()


def test_columns_in_any_order_and_defaults(table: Callable[[str], Path]) -> None:
    start = read_objects(table("# box 12 8.5\n\n# a remark\n r , y, x\n1,2,3 # another\n\n  4,5,6\r\n"))
    assert (start.width, start.height) == (12.0, 8.5)
    assert [column.tolist() for column in start.objects] == [[3, 6], [2, 5], [0, 0], [0, 0], [1, 4], [5, 5]]
    start = read_objects(table("\ufeffx,y\n1,2"))
    assert [column.tolist() for column in start.objects] == [[1], [2], [0], [0], [10], [5]]


def test_without_words_the_box_is_what_the_circles_reach(table: Callable[[str], Path]) -> None:
    start = read_objects(table("x,y,r\n-5,4,2\n3,-9,1\n"))
    assert (start.width, start.height) == (4.0, 6.0)
    start = read_objects(table("# boxes are nice\nx,y,r\n5,4,2\n"))
    assert (start.width, start.height) == (7.0, 6.0)
    with pytest.raises(
        InputError, match=r"a\.csv: no object is where x and y are above 0; say in the first line: # box"
    ):
        read_objects(table("x,y,r\n-5,4,2\n"))
    with pytest.raises(InputError, match=r"a\.csv: holds no objects; a box without any is # box WIDTH HEIGHT"):
        read_objects(table("x,y\n"))
    assert len(read_objects(table("# box 3 3\nx,y\n")).objects.x) == 0


@pytest.mark.parametrize(
    ("text", "line", "reason"),
    [
        ("x,y\n1,2\n3,four\n", 3, "y has to be a finite number, not 'four'"),
        ("# box 9 9\n\nx,y\n# no\n1,2\n\n3,nan\n", 7, "y has to be a finite number, not 'nan'"),
        ("x,y,vx\n1,2,3\n1,2,inf\n", 3, "vx has to be a finite number, not 'inf'"),
        ("x,y,m\n1,2,3\n1,,3\n", 3, "y has to be a finite number, and there is none"),
        ("x,y,m\n1,2,3\n1,2\n", 3, "2 values, and the columns are x, y, m"),
        ("x,y,r\n1,2,3\n1,2,0\n1,2,-1\n", 3, "r has to be a finite number above 0, not '0'"),
        ("x,y,m\n1,2,-3\n", 2, "m has to be a finite number above 0, not '-3'"),
        ("x,y\n1,2\n3,4,5\n", 3, "3 values, and the columns are x, y"),
        ("x,y\n1,2,3\n4,5,6\n", 2, "3 values, and the columns are x, y"),
        ('x,y\n1,"2\n', 2, "y has to be a finite number, not '\"2'"),
        ("x,y\n1,True\n", 2, "y has to be a finite number, not 'True'"),
        ("x,y\n1e999,1\n", 2, "x has to be a finite number, not '1e999'"),
        ("# box 9\nx,y\n1,2\n", 1, "a box is written as # box WIDTH HEIGHT, in numbers"),
        ("# box 9 wide\nx,y\n1,2\n", 1, "a box is written as # box WIDTH HEIGHT, in numbers"),
    ],
)
def test_faults_have_their_line(table: Callable[[str], Path], text: str, line: int, reason: str) -> None:
    path = table(text)
    with pytest.raises(InputError, match=f"^{re.escape(f'{path}:{line}: {reason}')}$"):
        read_objects(path)


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("", "holds no line of names, such as x,y,vx,vy,r,m"),
        ("\n# box 3 3\n", "holds no line of names, such as x,y,vx,vy,r,m"),
        ("x,r\n1,2\n", "there is no column y"),
        ("# none\nr\n1\n", "there is no column x"),
        *(
            (f"{names}\n1,2,3\n", f"{bad!r} is no column; this line names the columns, by commas: x, y, vx, vy, r, m")
            for names, bad in (("x,radius,y", "radius"), ("x,y,VX", "VX"), ("x,y,", ""), ("x;y", "x;y"), ("1,2", "1"))
        ),
        ("y,x,y\n1,2,3\n", "'y' stands there twice; columns are x, y, vx, vy, r, m, each once"),
        ("# box 0 9\nx,y\n1,2\n", "a box of 0.0 x 9.0: width and height have to be finite numbers above 0"),
        ("x,y,r\n1e308,1,1e308\n", "a box of inf x 1e+308: width and height have to be finite numbers above 0"),
        ("# box nan 9\nx,y\n1,2\n", "a box of nan x 9.0: width and height have to be finite numbers above 0"),
    ],
)
def test_what_is_no_table(table: Callable[[str], Path], text: str, reason: str) -> None:
    path = table(text)
    with pytest.raises(InputError, match=f"^{re.escape(str(path))}:([12]:)? {re.escape(reason)}$") as caught:
        read_objects(path)
    assert "\n" not in str(caught.value)


def test_what_is_no_text(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_bytes(b"x,y\n\xff\xfe,1\n")
    with pytest.raises(InputError, match=r"a\.csv:2: x has to be a finite number, not '\ufffd\ufffd'$"):
        read_objects(tmp_path / "a.csv")
    (tmp_path / "a.csv").write_bytes(bytes(range(256)))
    with pytest.raises(InputError, match=r"a\.csv:1: '\\x00\\x01.*' is no column; this line names"):
        read_objects(tmp_path / "a.csv")


def test_what_is_no_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(
        InputError, match=r"uniform\.csv: there is no such file; make it with: tetrabench generate uniform"
    ):
        read_objects(tmp_path / "uniform.csv")
    with pytest.raises(InputError, match=r"a\.npz: there is no such file$"):
        read_objects(tmp_path / "a.npz")
    (tmp_path / "a.npz").mkdir()
    with pytest.raises(InputError, match="a folder, not a file"):
        read_objects(tmp_path / "a.npz")
    start = generate_objects("uniform", 3)
    with pytest.raises(InputError, match=r"b\.csv: cannot be written: No such file or directory"):
        write_objects(start, tmp_path / "nowhere" / "b.csv")
    for suffix in (".npz", ".csv"):
        write_objects(start, tmp_path / f"b{suffix}")
        monkeypatch.setattr("tetrabench.memory.available_bytes", lambda: 10)
        with pytest.raises(MemoryRefusedError, match=r"^reading .*b\..* needs about 0.0 MiB of memory"):
            read_objects(tmp_path / f"b{suffix}")
        monkeypatch.undo()


def test_a_write_that_fails_leaves_the_old_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "a.csv"
    write_objects(generate_objects("uniform", 3), path)
    before = path.read_bytes()

    def break_off(start: Start, file: Path) -> None:
        file.write_text("x,y\n1")
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(files, "write_table", break_off)
    with pytest.raises(InputError, match=r"a\.csv: cannot be written: No space left on device"):
        write_objects(generate_objects("uniform", 9), path)
    assert path.read_bytes() == before
    assert [file.name for file in tmp_path.iterdir()] == ["a.csv"]


def test_damage_and_other_archives(tmp_path: Path) -> None:
    path = tmp_path / "a.npz"
    write_objects(generate_objects("uniform", 50), path)
    whole = path.read_bytes()
    assert holds_objects(path)
    damaged = bytearray(whole)
    damaged[200] ^= 0xFF
    for held, still in ((whole[: len(whole) // 2], False), (b"", False), (bytes(damaged), True)):
        path.write_bytes(held)
        assert holds_objects(path) is still
        with pytest.raises(
            InputError, match=r"a\.npz: damaged, or not objects as tetrabench writes them; make it again$"
        ):
            read_objects(path)
    write_polygons(generate_polygons("quad", 9), path)
    assert not holds_objects(path)
    with pytest.raises(
        InputError, match=r"a\.npz: holds no objects as tetrabench writes them; other programs can write"
    ):
        read_objects(path)


def test_what_others_put_into_an_archive_is_checked(tmp_path: Path) -> None:
    path, source = tmp_path / "a.npz", np.frombuffer(b"me", np.uint8)
    columns = dict.fromkeys(Objects._fields, np.ones(3))
    np.savez(path, **columns, box=np.array([4, 5]), source=source)
    assert (read_objects(path).width, read_objects(path).height, read_objects(path).source) == (4, 5, "me")
    np.savez(path, **{**columns, "r": -np.ones(3)}, box=np.array([4, 5]), source=source)
    with pytest.raises(InputError, match=r"a\.npz: object 0: the radius has to be above 0, not -1.0 \(and 2 more\)$"):
        read_objects(path)
    for box in (np.array([4.0]), np.array(4.0), np.array(["a", "b"])):
        np.savez(path, **columns, box=box, source=source)
        with pytest.raises(InputError, match=r"a\.npz: "):
            read_objects(path)


def test_suffixes() -> None:
    for name in ("a.npz", "a.CSV"):
        assert check_objects_source(name) == check_objects_target(name) == name[1:].lower()
    with pytest.raises(
        InputError, match=r"a\.cvs: the suffix '\.cvs' names no known format; did you mean \.csv\? known"
    ):
        check_objects_source("a.cvs")
    with pytest.raises(InputError, match=r"a\.vtu: objects are written as \.npz and \.csv files, not as '\.vtu'$"):
        check_objects_target("a.vtu")
    with pytest.raises(InputError, match=r"not as '\.vtu'$"):
        write_objects(generate_objects("uniform", 1), "a.vtu")
    assert holds_objects("nowhere.csv")
    assert not holds_objects("nowhere.npz")
    assert not holds_objects("nowhere.vtu")
