"""Decks of several files, coordinate systems, and mixed decks: what surrounds the cards that count."""

import random
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.io.fuzz_nastran import corpus, judge, mutated
from tests.io.test_nastran import CORNERS, FREE_POINTS, FREE_TETRA, read_text
from tetrabench.errors import InputError, MemoryRefusedError, RepairableError
from tetrabench.io.nastran import read_nastran, reader, source, write_nastran
from tetrabench.mesh.models import generate


def write(folder: Path, **files: str) -> Path:
    """Write files by name, `__` for a slash; return the first."""
    paths = [folder / f"{name.replace('__', '/')}.nas" for name in files]
    for path, text in zip(paths, files.values(), strict=True):
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return paths[0]


# ------------------------------ INCLUDE


@pytest.mark.parametrize(
    "card",
    [
        "INCLUDE 'parts/points.nas'",
        'include "parts/points.nas" $ the points',
        "  Include parts/points.nas",
        "INCLUDE='parts/points.nas'",
        "INCLUDE'parts/points.nas'",
        "INCLUDE 'parts/\npoints.nas'",
        "INCLUDE 'parts/\n  poin\nts.nas'",
        "INCLUDE 'parts\\points.nas'",
    ],
)
@pytest.mark.parametrize("first", [True, False])
def test_include(tmp_path: Path, card: str, first: bool) -> None:
    texts = [card + "\n", FREE_TETRA]
    path = write(tmp_path, main="".join(texts if first else reversed(texts)), parts__points=FREE_POINTS)
    mesh = read_nastran(path)
    assert dict(zip(mesh.point_ids.tolist(), map(tuple, mesh.points.tolist()), strict=True)) == CORNERS
    assert mesh.point_ids[mesh.tets].tolist() == [[1, 2, 3, 4]]


def test_include_looks_next_to_the_including_file_then_next_to_the_main_one(tmp_path: Path) -> None:
    path = write(
        tmp_path,
        main="INCLUDE 'a/first.nas'\n" + FREE_TETRA,
        a__first="INCLUDE 'near.nas'\nINCLUDE 'far.nas'\n",
        a__near="".join(FREE_POINTS.splitlines(keepends=True)[:2]),
        near="GRID,x\n",
        far="".join(FREE_POINTS.splitlines(keepends=True)[2:]),
    )
    assert read_nastran(path).point_ids.tolist() == [1, 2, 3, 4]


@pytest.mark.parametrize("encoding", ["utf-8", "latin-1"])
def test_include_of_a_name_beyond_ascii(tmp_path: Path, encoding: str) -> None:
    write(tmp_path, größe=FREE_POINTS)
    (tmp_path / "main.nas").write_bytes(("INCLUDE 'größe.nas'\n" + FREE_TETRA).encode(encoding))
    assert len(read_nastran(tmp_path / "main.nas").points) == 4
    (tmp_path / "größe.nas").unlink()
    with pytest.raises(InputError, match=r"there is no file 'größe\.nas' here"):
        read_nastran(tmp_path / "main.nas")


def test_what_follows_a_long_include_is_the_next_line(tmp_path: Path) -> None:
    comment = "x" * 2 * reader.LONGEST_INCLUDE
    path = write(tmp_path, main=f"INCLUDE 'rest.nas' $ {comment}\n{FREE_TETRA}", rest=FREE_POINTS)
    assert read_nastran(path).report.skipped == {}


def test_include_keeps_the_order_of_the_cards(tmp_path: Path) -> None:
    many = "".join(f"GRID,{number},,{number}.123456789012345678,0.,0.\n" for number in range(10, 3000))
    path = write(
        tmp_path, main=many + "INCLUDE 'rest.nas'\nGRID,9000,,3.,3.,3.\n" + FREE_TETRA, rest=FREE_POINTS + "PSOLID,1\n"
    )
    mesh = read_nastran(path, unused="keep")
    assert mesh.point_ids.tolist() == [*range(10, 3000), 1, 2, 3, 4, 9000]
    np.testing.assert_array_equal(mesh.points[:2990, 0], [float(f"{k}.123456789012345678") for k in range(10, 3000)])
    assert mesh.report.skipped == {"PSOLID": 1}


def test_enddata_ends_the_deck_in_whatever_file(tmp_path: Path) -> None:
    path = write(tmp_path, main=FREE_TETRA + "INCLUDE 'rest.nas'\nGRID,x\n", rest=FREE_POINTS + "ENDDATA\nGRID,x\n")
    assert len(read_nastran(path).points) == 4


def test_errors_name_the_included_file(tmp_path: Path) -> None:
    path = write(tmp_path, main="\nINCLUDE 'rest.nas'\n" + FREE_TETRA, rest=FREE_POINTS + "\nGRID,x\n")
    with pytest.raises(InputError, match=r"rest\.nas:6: 'x' is not a whole number"):
        read_nastran(path)
    path = write(tmp_path, main="INCLUDE 'rest.nas'\n" + FREE_TETRA, rest=FREE_POINTS.replace("GRID,4", "GRID,5"))
    with pytest.raises(InputError, match=r"main\.nas:2: CTETRA 1 uses GRID 4, which does not exist"):
        read_nastran(path)


@pytest.mark.parametrize(
    ("files", "reason"),
    [
        ({"main": "INCLUDE 'main.nas'\n"}, r"main\.nas:1: INCLUDE: 'main\.nas' includes itself"),
        ({"main": "$\nINCLUDE 'b.nas'\n", "b": "INCLUDE './main.nas'\n"}, r"b\.nas:1: INCLUDE: '\./main\.nas' includes"),
        ({"main": "INCLUDE\n"}, r"main\.nas:1: INCLUDE: there is no file ''"),
        ({"main": "INCLUDE 'x\n"}, r"main\.nas:1: INCLUDE: there is no file"),
        ({"main": f"INCLUDE '{'x' * 3000}'\n"}, r"main\.nas:1: INCLUDE: there is no file"),
        ({"main": "INCLUDE 'b.nas'\n", "b": ""}, r"b\.nas: is empty"),
    ],
)  # fmt: skip
def test_include_that_cannot_be_followed(tmp_path: Path, files: dict[str, str], reason: str) -> None:
    with pytest.raises(InputError, match=reason):
        read_nastran(write(tmp_path, **files))


def test_include_without_end_is_stopped(tmp_path: Path) -> None:
    deep = {f"f{k}": f"INCLUDE 'f{k + 1}.nas'\n" for k in range(60)}
    with pytest.raises(InputError, match="INCLUDE: over 50 files deep"):
        read_nastran(write(tmp_path, **deep))
    twice = {f"g{k}": f"INCLUDE 'g{k + 1}.nas'\n" * 2 for k in range(40)} | {"g40": "$\n"}
    with pytest.raises(InputError, match="or 10000 in all"):
        read_nastran(write(tmp_path, **twice))


# ------------------------------ windows


@pytest.mark.parametrize("field", ["small", "large", "free"])
def test_the_window_changes_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, field: str) -> None:
    """Cards, long comments between a card and its continuation, and includes, in windows of any size."""
    mesh = generate("box", 60)
    mesh.points[7] *= 1 + 1e-13  # a number left to float()
    path = tmp_path / "main.nas"
    write_nastran(mesh, path, field=field)
    lines = path.read_text().splitlines(keepends=True)
    for place, comment in ((90, 700), (40, 300), (15, 3)):
        lines.insert(place, "$" + "x" * comment + "\n")
    half = next(k for k in range(50, 60) if lines[k][0] in "GC")
    (tmp_path / "rest.nas").write_text("".join(lines[half:]))
    path.write_text("\ufeff" + "".join(lines[:half]) + "INCLUDE 'rest.nas'\nGRID,x\n")
    whole = read_nastran(path)
    for size in [*range(1, 200, 7), *range(200, 3000, 331)]:
        monkeypatch.setattr(source, "WINDOW", size)
        windowed = read_nastran(path)
        assert windowed.points.tobytes() == whole.points.tobytes()
        assert windowed.tets.tobytes() == whole.tets.tobytes()
        assert windowed.tet_ids.tobytes() == whole.tet_ids.tobytes()
        assert windowed.report == whole.report
    (tmp_path / "rest.nas").write_text("".join([*lines[half:-1], "CTETRA,1,1,x\n"]))
    with pytest.raises(InputError, match=rf"rest\.nas:{len(lines) - half}: 'x' is not"):
        read_nastran(path)


def test_more_cards_than_the_size_of_the_file_promises(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Points, tetras, hard numbers, systems and scattered continuations beyond the room that there is at first."""
    mesh, path = generate("box", 3000), tmp_path / "main.nas"
    mesh.points *= 1 + 1e-13  # numbers left to float()
    write_nastran(mesh, path, field="free")
    more = range(10_001, 11_200)
    scattered = "".join(f"GRID*,{k},,1.,2.,*G{k - 10_000}\n" for k in more) + "PSOLID,1\n"
    scattered += "".join(f"*G{k - 10_000},{k}.\n" for k in more) + "".join(f"CORD1R,{k},1,2,3\n" for k in more)
    path.write_text(path.read_text().replace("ENDDATA", scattered + "ENDDATA"))
    monkeypatch.setattr(reader, "CARD_BYTES", 10**9)
    read = read_nastran(path, unused="keep")
    assert min(len(mesh.points) + len(more), len(mesh.tets), len(more)) > 1024  # all that there is room for at first
    np.testing.assert_array_equal(read.points, [*mesh.points, *([1.0, 2.0, k] for k in more)])
    assert read.point_ids.tolist() == [*mesh.point_ids, *more]
    np.testing.assert_array_equal(read.tets, mesh.tets)
    assert read.report.skipped == {"CORD1R": len(more), "PSOLID": 1}


def test_lines_of_a_file_of_any_size_are_counted(tmp_path: Path) -> None:
    (tmp_path / "deck.nas").write_bytes(b"\n" * 3_000_000)
    assert source.Sources().add(tmp_path / "deck.nas").line_of(2_900_000) == 2_900_001


def test_numbers_of_any_length(tmp_path: Path) -> None:
    texts = [
        "0." + "1234567890" * 30,
        "0" * 5000 + "1.5-1",
        "1." + "0" * 40_000 + "D+2",
        "-.1234567890123456789012345678",
    ]
    deck = "".join(f"GRID,{k},,{text},0.,0.\n" for k, text in enumerate(texts, start=11)) + FREE_POINTS + FREE_TETRA
    mesh = read_text(tmp_path, deck, unused="keep")
    assert mesh.points[:4, 0].tolist() == [float(texts[0]), 0.15, 100.0, float(texts[3])]


# ------------------------------ coordinate systems

TURNED = "CORD2R,7,,1.,2.,3.,1.,2.,4.,+\n+,1.,3.,3.\n"  # x is the basic y, y the basic -x


def test_rectangular_system(tmp_path: Path) -> None:
    mesh = read_text(tmp_path, FREE_POINTS.replace("GRID,2,,1.", "GRID,2,7,1.") + FREE_TETRA + TURNED)
    np.testing.assert_allclose(mesh.points[1], [1.0, 3.0, 3.0], atol=1e-15)
    np.testing.assert_array_equal(mesh.points[2], CORNERS[3])  # basic ones keep every bit
    assert mesh.report.skipped == {"CORD2R": 1}
    assert len(mesh.report.warnings) == 1  # no ENDDATA


def test_cylindrical_and_spherical_systems(tmp_path: Path) -> None:
    points = "GRID,1,1,2.,90.,5.\nGRID,2,2,2.,90.,0.\nGRID,3,2,2.,30.,90.\nGRID,4,2,0.,77.,-5.\n"
    systems = "CORD2C,1,0,0.,0.,0.,0.,0.,1.,+\n+,1.,0.,0.\nCORD2S,2,,0.,0.,0.,0.,0.,1.,+\n+,1.,0.,0.\n"
    mesh = read_text(tmp_path, systems + points + FREE_TETRA)
    expected = [[0, 2, 5], [2, 0, 0], [0, 1, np.sqrt(3)], [0, 0, 0]]
    np.testing.assert_allclose(mesh.points, expected, atol=1e-15)


def test_nested_systems_against_scipy(tmp_path: Path, rng: np.random.Generator) -> None:
    """System 3 within 2 within 1, by random rotations, and system 4 by the GRIDs of system 3."""
    turns, shifts = Rotation.from_quat(rng.normal(size=(3, 4))), rng.normal(size=(3, 3))
    cards = []
    for k in range(3):
        a, b, c = shifts[k] + np.array([[0, 0, 0], [0, 0, 1], [1, 0, 1]]) @ turns[k].as_matrix().T
        fields = ",".join(repr(float(x)) for x in [*a, *b])
        cards.append(f"CORD2R,{k + 1},{k},{fields},+\n+," + ",".join(repr(float(x)) for x in c) + "\n")
    corners = np.array(list(CORNERS.values()))
    points = "".join(f"GRID,{k},3,{x!r},{y!r},{z!r}\n" for k, (x, y, z) in enumerate(corners.tolist(), start=1))
    grids = "GRID,11,3,0.,0.,0.\nGRID,12,3,0.,0.,1.\nGRID,13,3,1.,0.,0.\nGRID,14,4,1.,2.,3.\nGRID,15,3,1.,2.,3.\n"
    deck = points + FREE_TETRA + grids + "CORD1R,4,11,12,13\n" + "".join(rng.permutation(cards))
    mesh = read_text(tmp_path, deck, unused="keep")
    expected = corners
    for k in (2, 1, 0):
        expected = turns[k].apply(expected) + shifts[k]
    np.testing.assert_allclose(mesh.points[:4], expected, atol=1e-13)
    np.testing.assert_allclose(mesh.points[7], mesh.points[8], atol=1e-13)


def test_two_systems_on_a_card_and_a_default_one(tmp_path: Path) -> None:
    base = "GRID,11,0,0.,0.,0.\nGRID,12,0,0.,0.,1.\nGRID,13,0,0.,1.,0.\n"
    systems = "CORD1C,8,11,12,13,9,11,12,13\nGRDSET,,9\n"
    mesh = read_text(tmp_path, base + systems + FREE_POINTS.replace("GRID,2,,1.,0.", "GRID,2,,1.,90.") + FREE_TETRA)
    np.testing.assert_allclose(mesh.points[1], [-1.0, 0.0, 0.0], atol=1e-15)


def test_unknown_system_is_taken_as_basic_with_one_warning(tmp_path: Path) -> None:
    mesh = read_text(tmp_path, FREE_POINTS.replace(",,", ",5,") + FREE_TETRA + "ENDDATA")
    assert dict(zip(mesh.point_ids.tolist(), map(tuple, mesh.points.tolist()), strict=True)) == CORNERS
    (warning,) = mesh.report.warnings
    assert "coordinate system 5 of 4 GRIDs is not defined; taken as the basic one" in warning


@pytest.mark.parametrize(
    ("systems", "line", "reason"),
    [
        ("CORD2R,7,8,0.,0.,0.,0.,0.,1.,+\n+,1.,0.,0.\nCORD2R,8,7,0.,0.,0.,0.,0.,1.,+\n+,1.,0.,0.\n", None, "needs itself"),
        ("CORD1R,7,1,2,3\n", 6, "coordinate system 7 needs itself"),
        ("CORD1R,7,11,12,13\n", 6, "uses GRID 11, which does not exist"),
        ("CORD2R,7,,0.,0.,0.,0.,0.,1.,+\n+,0.,0.,5.\n", 6, "its three points lie on one line"),
        ("CORD2R,7,,0.,0.,0.,0.,0.,1.,+\n+,1.-14,0.,5.\n", 6, "its three points lie on one line"),
        ("CORD2R,7\n", 6, "its three points lie on one line"),
        ("CORD2R,7,,x\n", 6, "CORD2R: 'x' is not a number"),
        ("CORD2R,7,,inf\n", 6, "CORD2R: 'inf' is not a number"),
        ("CORD2R,7,,1.+999\n", 6, r"CORD2R: 1\.\+999 is beyond the largest number"),
        ("CORD2R,7,1.\n", 6, r"CORD2R: '1\.' is not a whole number above 0"),
        ("CORD2R,7,,0.,0.,0.,0.,1.+308,1.+308,+\n+,1.+308,0.,0.\n", 6, "its three points lie on one line"),
        ("CORD1R,7,1,,3\n", 6, "CORD1R: '' is not a whole number above 0"),
        ("CORD2R,7,,0.,0.,0.,0.,0.,1.,+C\nPSOLID,1\n", 6, "its continuation 'C' is missing"),
        (TURNED + TURNED.replace("3.\n", "5.\n"), 8, "coordinate system 7 is defined twice, in different ways"),
    ],
)  # fmt: skip
def test_faulty_system(tmp_path: Path, systems: str, line: int | None, reason: str) -> None:
    with pytest.raises(InputError, match=reason) as caught:
        read_text(tmp_path, FREE_POINTS.replace(",,", ",7,") + FREE_TETRA + systems)
    assert line is None or f"deck.nas:{line}: " in str(caught.value)


@pytest.mark.parametrize("between", ["PSOLID,1\n", "GRID,9,,0.,0.,0.\n"])
def test_continuation_of_a_system_elsewhere(tmp_path: Path, between: str) -> None:
    card, continuation = TURNED.replace("+\n+,", "+C7\n+C7,").splitlines(keepends=True)
    points = FREE_POINTS.replace("GRID,2,,1.", "GRID,2,7,1.")
    mesh = read_text(tmp_path, card + points + FREE_TETRA + between + continuation)
    np.testing.assert_allclose(mesh.points[1], [1.0, 3.0, 3.0], atol=1e-15)


def test_the_same_system_twice_is_one(tmp_path: Path) -> None:
    mesh = read_text(tmp_path, FREE_POINTS.replace("GRID,2,,1.", "GRID,2,7,1.") + FREE_TETRA + TURNED * 2)
    np.testing.assert_allclose(mesh.points[1], [1.0, 3.0, 3.0], atol=1e-15)


# ------------------------------ mixed decks


def test_quadratic_tetras_are_counted(tmp_path: Path) -> None:
    ten = "CTETRA,{},1,{},5,6,+\n+,7,8,9,10\n"
    deck = FREE_POINTS + "GRID,11,,1.,1.,1.\n" + FREE_TETRA + ten.format(2, "1,2,3,11") + ten.format(3, "1,2,4,11")
    mesh = read_text(tmp_path, deck)
    assert mesh.report.quadratic == 2
    assert len(mesh.tets) == 3


def test_mixed_deck(tmp_path: Path) -> None:
    others = "CHEXA,1,1,1,2,3,4,1,2,+\n+,3,4\nCTRIA3,1,1,1,2,3\nSPC1,1,123,1,THRU,4\nMAT1,1,2.+11,,.3\n"
    mesh = read_text(tmp_path, others + FREE_POINTS + FREE_TETRA + "CTRIA3,2,1,1,2,3\n" + "ENDDATA\n")
    assert mesh.report.skipped == {"CTRIA3": 2, "CHEXA": 1, "SPC1": 1, "MAT1": 1}
    assert not mesh.report.warnings


def test_names_without_end_are_counted_together(tmp_path: Path) -> None:
    mesh = read_text(tmp_path, "".join(f"X{k:05}\n" * 2 for k in range(1000)) + FREE_POINTS + FREE_TETRA)
    assert sum(mesh.report.skipped.values()) == 2000
    assert mesh.report.skipped["others"] == 2 * (1000 - 255)


def test_begin_bulk_without_enddata_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="BEGIN BULK, but no ENDDATA: the file may have been cut off; if it is whole"):
        read_text(tmp_path, "BEGIN BULK\n" + FREE_POINTS + FREE_TETRA)


def test_many_scattered_continuations(tmp_path: Path, rng: np.random.Generator) -> None:
    count = 200
    xyz = rng.normal(size=(count, 3)).round(6)
    heads = [f"GRID*,{k + 1},,{x},{y},*G{k}\n" for k, (x, y, _) in enumerate(xyz.tolist())]
    tails = [f"*G{k},{z}\n" for k, (_, _, z) in enumerate(xyz.tolist())]
    mesh = read_text(tmp_path, "".join(heads) + FREE_TETRA + "".join(rng.permutation(tails)), unused="keep")
    np.testing.assert_array_equal(mesh.points, xyz)


# ------------------------------ faulty tetras

FAULTY = FREE_POINTS + (
    "GRID,5,,1.,1.,1.\nGRID,6,,-1.,-1.,-1.\nGRID,7,,2.,2.,2.\n"
    "CTETRA,1,1,1,2,3,4\nCTETRA,2,1,1,2,2,4\nCTETRA,3,1,4,3,2,1\nCTETRA,4,1,2,3,4,5\nCTETRA,5,1,2,3,4,6\n"
)


def test_faulty_tetras_are_refused_by_line_with_the_way_out(tmp_path: Path) -> None:
    with pytest.raises(RepairableError) as caught:
        read_text(tmp_path, FAULTY)
    message = str(caught.value)
    assert message.startswith(f"{tmp_path / 'deck.nas'}:9: CTETRA 2 repeats a node; also: 1 duplicate, 1 crowded side")
    assert message.endswith("; convert --repair drop leaves them out")
    with pytest.raises(RepairableError, match=r"deck\.nas:12: CTETRA 5 shares a side with two earlier ones"):
        read_text(tmp_path, FAULTY.replace("1,1,2,2,4", "1,1,2,7,6").replace("3,1,4,3,2,1\n", "3,1,7,3,2,1\n"))


def test_an_id_twice_is_refused_by_the_line_of_a_tetra_that_stays(tmp_path: Path) -> None:
    """CTETRA 1 stands three times: in line 8, in line 9, where it is left out, and in line 14."""
    deck = FAULTY.replace("CTETRA,2,1,1,2,2,4", "CTETRA,1,1,1,2,2,4") + "CTETRA,1,1,4,5,6,7\n"
    with pytest.raises(InputError, match=r"deck\.nas:13: CTETRA 1 twice, with different nodes$"):
        read_text(tmp_path, deck, repair="drop")
    with pytest.raises(InputError, match=r"deck\.nas:9: CTETRA 1 twice, with different nodes$"):
        read_text(tmp_path, deck.replace("1,1,2,2,4", "1,1,2,4,7").replace("CTETRA,3,", "$").replace("CTETRA,5,", "$"))


def test_repair_leaves_faulty_tetras_out_and_says_so(tmp_path: Path) -> None:
    mesh = read_text(tmp_path, FAULTY, repair="drop")
    assert mesh.tet_ids.tolist() == [1, 4]
    assert mesh.point_ids.tolist() == [1, 2, 3, 4, 5]
    assert mesh.report.dropped == {"repeated node": 1, "duplicate": 1, "crowded side": 1}
    assert any("CTETRA 2 repeats a node" in warning and "left out" in warning for warning in mesh.report.warnings)


def test_binary_rubbish_is_refused(tmp_path: Path, rng: np.random.Generator) -> None:
    for size in (1, 100, 10_000, 200_000):
        with pytest.raises(InputError, match="holds no CTETRA"):
            read_text(tmp_path, rng.integers(0, 256, size, np.uint8).tobytes())


def test_a_deck_beyond_the_memory_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tetrabench.memory.available_bytes", lambda: 100)
    with pytest.raises(MemoryRefusedError, match=r"reading .*deck\.nas needs about"):
        read_text(tmp_path, FAULTY)


def test_mutated_decks_lose_nothing(tmp_path: Path) -> None:
    """A little of what `make fuzz` does."""
    decks = corpus()
    for k in range(400):
        deck = mutated(decks, random.Random(f"tests {k}"))
        fault = judge(deck, tmp_path)
        assert fault is None, deck
