"""The Nastran reader against a naive twin, deck by deck, refusal by refusal; the writer by its round trip."""

import os
import re
from collections import Counter
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.meshes import mesh_of, single
from tetrabench.errors import InputError
from tetrabench.io import read_mesh, write_mesh
from tetrabench.io.nastran import read_nastran, write_nastran
from tetrabench.io.nastran.cards import eight_bytes, parse_eight, parse_integer, parse_real
from tetrabench.mesh import TetraMesh
from tetrabench.mesh.models import generate

CORNERS = {1: (0.0, 0.0, 0.0), 2: (1.0, 0.0, 0.0), 3: (0.0, 1.0, 0.0), 4: (0.0, 0.0, 1.0)}
FREE_POINTS = "GRID,1,,0.,0.,0.\nGRID,2,,1.,0.,0.\nGRID,3,,0.,1.,0.\nGRID,4,,0.,0.,1.\n"
FREE_TETRA = "CTETRA,1,1,1,2,3,4\n"
SMALL_TETRA = "CTETRA  " + "".join(f"{number:8}" for number in (1, 1, 1, 2, 3, 4))
LARGE_TETRA = "CTETRA *" + "".join(f"{number:16}" for number in (1, 1, 1, 2)) + "\n*" + f"{3:23}{4:16}\n"


def read_text(folder: Path, text: str | bytes, **options: str) -> TetraMesh:
    path = folder / "deck.nas"
    path.write_bytes(text if isinstance(text, bytes) else text.encode("latin-1"))
    return read_nastran(path, **options)


def write_read(mesh: TetraMesh, folder: Path, field: str) -> TetraMesh:
    """The one round trip of this file: everything but the coordinates must come back as it was."""
    path = folder / f"{field}.nas"
    write_nastran(mesh, path, field=field, comments=["a comment"])
    back = read_nastran(path)
    np.testing.assert_array_equal(back.tets, mesh.tets)
    np.testing.assert_array_equal(back.point_ids, mesh.point_ids)
    np.testing.assert_array_equal(back.tet_ids, mesh.tet_ids)
    assert not back.report.warnings
    assert back.report.source == str(path)
    return back


# ------------------------------ the naive twin


def naive_number(field: str) -> float:
    return float(re.sub(r"(?<=[\d.])e?([+-])", r"e\1", field.strip().lower().replace("d", "e"))) if field else 0.0


def naive_read(text: str) -> tuple[dict[int, tuple[float, ...]], dict[int, tuple[int, ...]], dict[str, int]]:
    """Well-formed bulk data in plain Python: points and tetras by id, other cards by count."""
    cards: list[list[str]] = []
    for raw in text.splitlines():
        line = raw.split("$")[0].rstrip()
        if not line:
            continue
        if line.upper().startswith("ENDDATA"):
            break
        name = line.split(",")[0] if "," in line else line[:8]
        count, width = (4, 16) if "*" in name else (8, 8)
        if "," in line:
            fields = [*line.split(",")[1:], *[""] * count][:count]
        else:
            fields = [line[8 + k * width : 8 + (k + 1) * width] for k in range(count)]
        fields = [field.strip() for field in fields]
        if name.strip() == "" or name[0] in "+*":
            cards[-1] += fields
        else:
            cards.append([name.strip().rstrip("*").strip().upper(), *fields])
    points, tets, skipped = {}, {}, {}
    for name, *fields in cards:
        if name.startswith("BEGIN"):
            skipped = {}  # so far it was executive and case control
        elif name == "GRID":
            points[int(fields[0])] = tuple(naive_number(field) for field in fields[2:5])
        elif name == "CTETRA":
            tets[int(fields[0])] = tuple(int(field) for field in fields[2:6])
        else:
            skipped[name] = skipped.get(name, 0) + 1
    return points, tets, skipped


def assert_same_as_naive(mesh: TetraMesh, text: str) -> None:
    points, tets, skipped = naive_read(text)
    assert mesh.point_ids.tolist() == list(points)
    assert mesh.tet_ids.tolist() == list(tets)
    assert mesh.report.skipped == skipped
    assert mesh.points.tobytes() == np.array(list(points.values()), np.float64).tobytes()  # -0.0 and 0.0 differ
    assert mesh.point_ids[mesh.tets].tolist() == [list(nodes) for nodes in tets.values()]


# ------------------------------ decks at random


@st.composite
def number_texts(draw: st.DrawFn, width: int) -> str:
    """A number in any of the spellings, at most `width` long."""
    sign = draw(st.sampled_from(["", "-", "+"]))
    whole, fraction = draw(st.tuples(*[st.text("0123456789", max_size=min(10, width // 2 - 2))] * 2))
    exponent = draw(st.sampled_from(["", "", "", "-3", "+2", "E1", "e-5", "D+3", "d2", "E+05", "-12", "+25"]))
    text = f"{sign}{whole or '0'}.{fraction}{exponent}"
    return text if len(text) <= width else "1.5"


def card_text(draw: st.DrawFn, name: str, fields: list[str], mark: str) -> str:
    """One card in a form drawn at random."""
    form = draw(st.sampled_from(["small", "large", "free", "free*"]))
    place = draw(st.sampled_from([str.ljust, str.rjust, str.center]))
    if max(map(len, fields)) > 8 and form == "small":
        form = "large"
    if form == "small":
        return name.ljust(8) + "".join(place(field, 8) for field in fields) + "\n"
    pad = draw(st.sampled_from(["", " "]))
    first, rest = fields[:4], fields[4:]
    if form == "free":
        return ",".join(pad + field + pad for field in [name, *fields]) + "\n"
    between = draw(st.sampled_from(["", "$ between a card and its continuation\n", "\n"]))
    if form == "large":
        head = (name + "*").ljust(8) + "".join(place(field, 16) for field in first) + f"*{mark}"
        return head.rstrip() + "\n" + between + f"*{mark}".ljust(8) + "".join(place(field, 16) for field in rest) + "\n"
    return ",".join([name + "*", *first, f"*{mark}"]) + "\n" + between + ",".join([f"*{mark}", *rest]) + "\n"


@st.composite
def decks(draw: st.DrawFn) -> str:
    """A well-formed deck: forms, spellings, order, comments, other cards and ends of lines at random."""
    count = draw(st.integers(4, 9))
    ids = draw(st.lists(st.integers(1, 99_999_999), min_size=count, max_size=count, unique=True))
    cards = []
    for number in ids:
        width = 16 if draw(st.booleans()) else 8
        coordinates = [draw(number_texts(width)) for _ in range(3)]
        cards.append(("GRID", [str(number), draw(st.sampled_from(["", "0"])), *coordinates]))
    nodes = st.permutations(ids).map(lambda order: tuple(order[:4]))
    tets = draw(st.lists(nodes, min_size=1, max_size=6, unique_by=lambda four: tuple(sorted(four))))
    sides: Counter[frozenset[int]] = Counter()
    for four in list(tets):
        own = [frozenset(four) - {node} for node in four]
        if any(sides[side] == 2 for side in own):
            tets.remove(four)
        else:
            sides.update(own)
    used = {node for four in tets for node in four}
    cards = [card for card in cards if int(card[1][0]) in used]
    for number, four in enumerate(tets, start=draw(st.integers(1, 1000))):
        cards.append(("CTETRA", [str(number), "1", *map(str, four)]))
    lines = []
    for k, (name, fields) in enumerate(draw(st.permutations(cards))):
        lines.append(
            draw(st.sampled_from(["", "", "$ GRID,1,,0.,0.,0.\n", "PSOLID,1,1\n", "CQUAD4  7\n+A      1.0\n"]))
        )
        spelled = draw(st.sampled_from([name, name.lower(), name.capitalize()]))
        lines.append(card_text(draw, spelled, fields, draw(st.sampled_from(["", f"C{k}"]))))
    head = draw(st.sampled_from(["", "SOL 101\nCEND\n  TITLE = a, b\nBEGIN BULK\n", "$ BEGIN BULK\n"]))
    ends = ["ENDDATA\n", "enddata"] if head.startswith("SOL") else ["", "ENDDATA\n", "enddata"]
    text = head + "".join(lines) + draw(st.sampled_from(ends))
    return text.replace("\n", draw(st.sampled_from(["\n", "\r\n"])))


@given(decks())
def test_reads_what_the_naive_twin_reads(tmp_path_factory: pytest.TempPathFactory, text: str) -> None:
    assert_same_as_naive(read_text(tmp_path_factory.mktemp("deck"), text), text)


@given(st.data())
def test_number_is_rounded_correctly(data: st.DataObject) -> None:
    text = data.draw(number_texts(24))
    bits = np.frombuffer(f" {text} ".encode(), np.uint8).copy()
    _, value = parse_real(bits, 1, 1 + len(text))
    assert np.isnan(value) or np.float64(value).tobytes() == np.float64(naive_number(text)).tobytes()


@given(st.lists(st.floats(allow_nan=False, allow_infinity=False), min_size=12, max_size=12))
def test_free_field_keeps_every_bit(tmp_path_factory: pytest.TempPathFactory, numbers: list[float]) -> None:
    mesh = single()
    mesh.points[:] = np.array(numbers).reshape(4, 3)
    with np.errstate(over="ignore", invalid="ignore"):  # its volume may be beyond float64
        back = write_read(mesh, tmp_path_factory.mktemp("free"), "free")
    assert back.points.tobytes() == mesh.points.tobytes()


# ------------------------------ single decks

DIALECTS = {
    "free": FREE_POINTS + FREE_TETRA,
    "elements first": FREE_TETRA + FREE_POINTS,
    "no newline at the end": FREE_POINTS + FREE_TETRA.rstrip(),
    "CRLF": (FREE_POINTS + FREE_TETRA).replace("\n", "\r\n"),
    "lower case": (FREE_POINTS + FREE_TETRA).lower(),
    "byte order mark": "\xef\xbb\xbf" + FREE_POINTS + FREE_TETRA,
    "END BULK": FREE_POINTS + FREE_TETRA + "END BULK\nnonsense GRID\nGRID,x\n",
    "cards in free field, indented": FREE_POINTS.replace("GRID,4", " \t GRID ,4") + "PSOLID,1\n" + " " * 12 + FREE_TETRA,
    "END BULK, indented": FREE_POINTS + FREE_TETRA + "  END BULK\nGRID,x\n",
    "nothing after ENDDATA counts": FREE_POINTS + FREE_TETRA + "ENDDATA*\nGRID,x\n",
    "trailing commas": FREE_POINTS + "CTETRA,1,1,1,2,3,4,,,,,,\n",
    "padded free field": FREE_POINTS + "CTETRA , 1 ,\t1 , 1 , 2 , 3 , 4\n",
    "comment on a line": FREE_POINTS + "CTETRA,1,1,1,2,3,4 $, the first\n",
    "property left out": FREE_POINTS + "CTETRA,1,,1,2,3,4\n",
    "same GRID twice": FREE_POINTS + "GRID,2,,1.0,0.,0.\n" + FREE_TETRA,
    "other cards": FREE_POINTS + "CQUAD4,1,1,1,2,3,4\n=,*1,=(5)\n+,\tx\n" + FREE_TETRA,
    "default coordinate system": "GRDSET,,0\nGRDSET,,,,,,,123\n" + FREE_POINTS + FREE_TETRA,
    "executive and case control": "INIT\nSOL 101\nCEND\n LOAD = 1\nBEGIN BULK\n" + FREE_POINTS + FREE_TETRA + "ENDDATA",
    "tabs": "".join(f"GRID\t{k}\t\t{x}\t{y}\t{z}\n" for k, (x, y, z) in CORNERS.items())
    + "CTETRA\t1\t1\t1\t2\t3\t4\n",
    "tabs in large field": "".join(f"GRID*\t{k}\t\t\t\t{x}\t\t{y}\n*\t{z}\n" for k, (x, y, z) in CORNERS.items())
    + "CTETRA*\t1\t\t1\t\t1\t\t2\n*\t3\t\t4\n",
    "tabs and blanks": FREE_POINTS + "CTETRA  1\t1\t1\t 2       3\t4 \n",
    "plus signs": FREE_POINTS.replace("GRID,2", "GRID,+2") + "CTETRA,+1,1,1,2,+3,4\n",
    "right-justified exponent": FREE_POINTS.replace("1.,0.,0.", "10.   -1,0.,0.   E 5") + FREE_TETRA,
    "midside nodes": FREE_POINTS + "CTETRA,1,1,1,2,3,4,5,6,+\n+,7,8,9,10\n",
    "midside nodes left out": FREE_POINTS + "CTETRA,1,1,1,2,3,4,0,,+\n+,7,,,10\n",
    "more than ten fields": FREE_POINTS + "CTETRA,1,1,1,2,3,4,5,6,7,8,9,10\n",
    "continuation and more on a line": FREE_POINTS + "CTETRA,1,1,1,2,3,4,5,6,+A,+A,7,8,9,10\n",
    "continuation elsewhere": FREE_POINTS + "CTETRA*,1,1,1,2,*N1\nGRID,5,,0.,0.,0.\n*N1,3,4\n",
    "continuation elsewhere, indented": FREE_POINTS + "CTETRA*,1,1,1,2,*N1\nPSOLID,1\n  *N1,3,4\n",
    "continuations at the end": "GRID*,4,,0.,0.,*G4\n" + FREE_POINTS.replace("GRID,4,,0.,0.,1.\n", "")
    + SMALL_TETRA + "       5       6+T1\n+T1     7\n*G4,1.\n",
    "a skipped card's continuation": FREE_TETRA + "CHEXA,1,1,1,2,3,4,5,6,+H1\n" + FREE_POINTS + "+H1,7,8\n",
    "a skipped card's continuation, asked for before a comment": FREE_TETRA + "CHEXA,1,1,1,2,3,4,5,6,+H1 $ eight\n"
    + FREE_POINTS + "+H1,7,8\n",
    "coordinate system 0": "GRDSET,,7\n" + FREE_POINTS.replace(",,", ",0,") + FREE_TETRA,
    "free continuation": FREE_POINTS + "CTETRA,1,1,1,2,3,4,,,+a\n+a,,\n",
    "blank continuation": FREE_POINTS + SMALL_TETRA + "\n        \n",
    "sequence numbers": FREE_POINTS + SMALL_TETRA.ljust(72) + "00000005\n",
    "star in column 8": FREE_POINTS + LARGE_TETRA,
    "blank coordinates are zero": "GRID    1\nGRID,2,,1.0\nGRID,3,,,1\nGRID,4,,,,1.0\n" + FREE_TETRA,
}  # fmt: skip


@pytest.mark.parametrize("text", DIALECTS.values(), ids=DIALECTS.keys())
def test_dialect(tmp_path: Path, text: str) -> None:
    mesh = read_text(tmp_path, text)
    assert dict(zip(mesh.point_ids.tolist(), map(tuple, mesh.points.tolist()), strict=True)) == CORNERS
    assert mesh.point_ids[mesh.tets].tolist() == [[1, 2, 3, 4]]
    assert mesh.points.dtype == np.float64
    assert mesh.tets.dtype == np.int32
    assert mesh.report.inverted == 0


REFUSED = {
    "coordinate system": ("\nGRID,5,x,0.,0.,0.\n", 2, "'x' is not the number of a coordinate system"),
    "default coordinate system": ("GRDSET,,-7\n", 1, "'-7' is not the number of a coordinate system"),
    "midside node": ("CTETRA,2,1,1,2,3,4,5,x\n", 1, "'x' is not a whole number"),
    "file to include": ("$\ninclude 'other.nas'\n", 2, "INCLUDE: there is no file 'other.nas'"),
    "words across fields with tabs": ("GRID\t5\t\t0.123456789\t0.\t0.\n", 1, "'0.123456789' crosses the columns"),
    "unknown node": ("CTETRA,2,1,1,2,3,77\n", 1, "CTETRA 2 uses GRID 77, which does not exist"),
    "unknown node far off": ("\nCTETRA,2,1,1,2,3,123456789012\n", 2, "GRID 123456789012, which does"),
    "repeated node": ("CTETRA,2,1,1,2,3,3\n", 1, "CTETRA 2 repeats a node"),
    "same four nodes": ("CTETRA,2,1,4,3,2,1\n", 6, "has the same four nodes as an earlier one"),
    "GRID twice": ("GRID,5,,0.,0.,0.\n$\nGRID,5,,0.,0.,1.\n", 3, "GRID 5 twice, at different places"),
    "tetra twice": ("GRID,5,,9.,9.,9.\nCTETRA,1,1,5,3,2,1\n", 7, "CTETRA 1 twice"),
    "two tetras twice": (
        "GRID,5,,9.,9.,9.\nGRID,6,,8.,8.,7.\nCTETRA,7,1,5,6,2,1\nCTETRA,1,1,5,3,2,1\nCTETRA,7,1,6,3,4,5\n",
        5,
        "CTETRA 7 twice",
    ),
    "id not a number": ("GRID,1x,,0.,0.,0.\n", 1, "'1x' is not a whole number above 0"),
    "id zero": ("CTETRA,0,1,1,2,3,4\n", 1, "'0' is not a whole number above 0"),
    "id blank": ("GRID,,,0.,0.,0.\n", 1, "'' is not a whole number above 0"),
    "id negative": ("CTETRA,2,1,1,2,3,-4\n", 1, "'-4' is not a whole number above 0"),
    "id real": ("CTETRA,2,1,1,2,3,4.\n", 1, "'4.' is not a whole number above 0"),
    "id of blanks within": (SMALL_TETRA[:-3] + "1 4\n", 1, "'1 4' is not a whole number"),
    "number": ("GRID,5,,0.,1.0.0,0.\n", 1, "'1.0.0' is not a number"),
    "number in large field": ("GRID*,5,,0.,0.\n*,abc\n", 2, "'abc' is not a number"),
    "number with a blank": ("GRID,5,,1. 5,0.,0.\n", 1, "'1. 5' is not a number"),
    "exponent": ("GRID,5,,1.5E,0.,0.\n", 1, "'1.5E' is not a number"),
    "dot": ("GRID,5,,.,0.,0.\n", 1, "'.' is not a number"),
    "NaN": ("GRID,5,,0.,0.,NaN\n", 1, "'NaN' is not a number"),
    "infinity": ("GRID,5,,0.,0.,-inf\n", 1, "'-inf' is not a number"),
    "beyond float64": ("\n\nGRID,5,,0.,0.,1.+999\n", 3, "1.+999 is beyond the largest number"),
    "no continuation": ("GRID*" + " " * 18 + "5\n", 1, "continuation"),
    "named continuation missing": ("CTETRA,2,1,1,2,3,4,,,+C1\nPSOLID,1\n", 1, "continuation"),
    "another's continuation": ("CTETRA,2,1,1,2,3,4,,,+C1\n+C2,7\n", 1, "continuation 'C1' is missing"),
    "nobody's continuation": ("CTETRA,2,1,1,2,3,4\n+C2,7\n", 2, "continues a card 'C2', which is not there"),
    "two continuations of one name": ("CTETRA*,2,1,1,2,*C\nGRID,5\n*C,3,4\n*C,3,4\n", 1, "stands 2 times"),
    "faulty continuation elsewhere": ("CTETRA*,2,1,1,2,*C\nGRID,5\n*C,3,x\n", 1, "'x' is not a whole number"),
    "number beyond float64 elsewhere": ("GRID*,5,,1.,2.,*C\nPSOLID,1\n*C,1.+999\n", 1, "1.+999 is beyond"),
    "small continuation of a large field": (LARGE_TETRA.replace("\n*", "\n "), 2, "begin with *"),
    "three nodes": ("CTETRA,2,1,1,2,3\n", 1, "four corner nodes"),
    "too many fields": ("CTETRA,2,1,1,2,3,4,,,,11" + ",12" * 40 + "\n", 1, "more fields"),
    "too many lines": ("CTETRA,2,1,1,2,3,4\n" + "+,\n" * 9, 6, "more fields"),
    "replication": ("CTETRA,2,1,1,2,3,4\n=,*1,=,*1,*1,*1,*1\n", 2, "replication"),
}  # fmt: skip


@pytest.mark.parametrize(("text", "line", "reason"), REFUSED.values(), ids=REFUSED.keys())
def test_refusal_names_file_line_and_reason(tmp_path: Path, text: str, line: int, reason: str) -> None:
    with pytest.raises(InputError) as caught:
        read_text(tmp_path, text + FREE_POINTS + FREE_TETRA)
    message = str(caught.value)
    assert reason in message
    assert message.startswith(f"{tmp_path / 'deck.nas'}:{line}: ")


def test_deck_without_tetras_says_what_it_holds(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"deck\.nas: holds no CTETRA; it holds GRID 4, CQUAD4 3, PSOLID 1$"):
        read_text(tmp_path, FREE_POINTS + "PSOLID,1\n" + "CQUAD4,1,1,1,2,3,4\n" * 3)
    with pytest.raises(InputError, match="it holds no card at all"):
        read_text(tmp_path, "$ nothing\n")


def test_unreadable_files(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="cannot be read"):
        read_nastran(tmp_path / "missing.nas")
    with pytest.raises(InputError, match="cannot be read"):
        read_nastran(tmp_path)
    for nothing in (b"", b"\xef\xbb\xbf"):
        with pytest.raises(InputError, match="is empty"):
            read_text(tmp_path, nothing)


def test_unused_points_are_dropped_and_counted_or_kept(tmp_path: Path) -> None:
    text = "GRID,9,,7.,7.,7.\nGRID,9,,7.,7.,7.\n" + FREE_POINTS + FREE_TETRA
    dropped, kept = read_text(tmp_path, text), read_text(tmp_path, text, unused="keep")
    assert dropped.report.unreferenced == kept.report.unreferenced == 1
    assert dropped.point_ids.tolist() == [1, 2, 3, 4]
    assert kept.point_ids.tolist() == [9, 1, 2, 3, 4]
    np.testing.assert_array_equal(dropped.points[dropped.tets], kept.points[kept.tets])
    with pytest.raises(InputError, match="'drop' or 'keep'"):
        read_text(tmp_path, text, unused="both")


def test_inverted_tetras_are_kept_and_counted(tmp_path: Path) -> None:
    mesh = read_text(tmp_path, FREE_POINTS + "CTETRA,1,1,1,3,2,4\n")
    assert mesh.report.inverted == 1
    assert mesh.tets.tolist() == [[0, 2, 1, 3]]


def test_ids_far_apart(tmp_path: Path) -> None:
    text = re.sub(r"(?<=GRID,)(\d)", r"12345678901234567\1", FREE_POINTS)
    mesh = read_text(tmp_path, text + "CTETRA,1,1," + ",".join(f"12345678901234567{k}" for k in (4, 2, 1, 3)) + "\n")
    assert mesh.tets.tolist() == [[3, 1, 0, 2]]


def test_fields_of_full_width_touch(tmp_path: Path) -> None:
    deck = [
        "GRID    10000001        -1.234567.1234561.234-12",
        "GRID    10000002        2.00000012345.67-.987654",
        "GRID*   1000000000000003                -1.2345678901234.123456789012345",
        "*       -1.23456789-0012",
        "GRID    10000004        1.+1    2.-1    0.0     ",
        "CTETRA  12345678       1100000011000000210000004       1",
        "GRID           1",
    ]
    text = "\n".join(deck) + "\n"
    mesh = read_text(tmp_path, text, unused="keep")
    assert_same_as_naive(mesh, text)
    assert mesh.points[0].tolist() == [-1.23456, 7.123456, 1.234e-12]


@pytest.mark.parametrize("spelled", ["1.5-3", "1.5D-3", "1.5   E -3", "1.5 e  -3", "1.5  -3", "1.5e3", "1.5   E 3"])
def test_number_of_any_length_is_spelled_in_any_way(tmp_path: Path, spelled: str) -> None:
    long = spelled.replace("1.5", "1.5" + 40 * "0").replace("3", 40 * "0" + "3")  # found by fuzzing
    mesh = read_text(tmp_path, FREE_POINTS.replace("GRID,2,,1.", f"GRID,2,,{long}") + FREE_TETRA)
    assert mesh.points[1, 0] == (1.5e-3 if "-" in spelled else 1.5e3)


def test_parse_integer_takes_digits_alone() -> None:
    for text, number in {"": -1, "12": 12, "+1": 1, "+": -1, "9" * 18: 10**18 - 1, "1" * 19: -1, "1e2": -1}.items():
        assert parse_integer(np.frombuffer(f"x{text}x".encode(), np.uint8).copy(), 1, 1 + len(text)) == number


def test_parse_eight_takes_digits_between_blanks() -> None:
    texts = [
        "",
        "1",
        "12345678",
        "99999999",
        "   12",
        "12 ",
        "  7  ",
        "00000000",
        "1 2",
        "1\t",
        "+1",
        "-1",
        "1.",
        "!1",
        "\xff",
    ]
    for text in [*texts, *("".join(four) for four in product(" 09/:", repeat=4))]:
        for spelled in (text.ljust(8), text.rjust(8)):
            word = eight_bytes(np.frombuffer(f"x{spelled}x".encode("latin-1"), np.uint8).copy(), 1)
            plain = re.fullmatch(" *[0-9]* *", spelled)
            assert parse_eight(np.uint64(word)) == (int(spelled.strip() or 0) if plain else -1), repr(spelled)


# ------------------------------ cut files


@pytest.mark.parametrize("field", ["small", "large", "free"])
def test_cut_file_is_never_taken_for_whole(tmp_path: Path, rng: np.random.Generator, field: str) -> None:
    mesh = generate("box", 30, numbering="shuffled")
    path = tmp_path / "whole.nas"
    write_nastran(mesh, path, field=field)
    text = path.read_bytes()
    end = text.index(b"ENDDATA")
    for size in [*rng.integers(0, end, 150).tolist(), *range(end, len(text) + 1)]:
        try:
            cut = read_text(tmp_path, text[:size])
        except InputError:
            continue
        np.testing.assert_array_equal(cut.tets, mesh.tets)


@pytest.mark.parametrize(
    "text", ["GRID    5               1.      2.", "GRID,5,,1.", "GRID*,5,,1.,2.", "CTETRA,2,1,1,2,3"]
)
def test_card_cut_at_the_end_is_refused(tmp_path: Path, text: str) -> None:
    with pytest.raises(InputError, match=":6: "):
        read_text(tmp_path, FREE_POINTS + FREE_TETRA + text)


# ------------------------------ writer


@pytest.mark.parametrize("field", ["small", "large", "free"])
def test_round_trip_of_a_model(tmp_path: Path, field: str) -> None:
    mesh = generate("nozzle", 500, numbering="shuffled", seed=3)
    once = write_read(mesh, tmp_path, field)
    twice = write_read(once, tmp_path, field)
    assert twice.points.tobytes() == once.points.tobytes()
    most = {"small": 5.001e-7, "large": 5.01e-15, "free": 0}[field]  # -.012345 and -.01234567890123
    np.testing.assert_allclose(once.points, mesh.points, rtol=0, atol=most)


def best_text(value: float, width: int) -> float:
    """The nearest number that fits: every spelling is tried."""
    spellings = [f"{value:.{digits}f}" for digits in range(width)]
    spellings = [re.sub(r"^(-?)0\.", r"\1.", text) if "." in text else text + "." for text in spellings]
    for digits in range(width):
        mantissa, exponent = f"{value:#.{digits}e}".split("e")
        spellings.append(f"{mantissa}{int(exponent):+d}")
    fitting = [text for text in spellings if len(text) <= width and text not in (".", "-.")]
    return min((naive_number(text) for text in fitting), key=lambda number: abs(number - value))


HUGE = st.floats(-1e300, 1e300)  # more could be rounded up to infinity


@given(st.lists(st.floats(-1e12, 1e12) | st.floats(-2, 2) | HUGE, min_size=12, max_size=12))
def test_fixed_fields_carry_the_most_digits(tmp_path_factory: pytest.TempPathFactory, numbers: list[float]) -> None:
    mesh = single()
    mesh.points[:] = np.array(numbers).reshape(4, 3)
    for field, width in (("small", 8), ("large", 16)):
        back = write_read(mesh, tmp_path_factory.mktemp(field), field).points.ravel()
        best = np.array([best_text(number, width) for number in numbers])
        # Scaling by a power of ten rounds once: the last digit may be off where nearly a 5 follows.
        assert (abs(back - numbers) <= 1.2 * abs(best - numbers) + 2e-16 * abs(best)).all()


def test_ids_must_fit_the_field(tmp_path: Path) -> None:
    mesh = single()
    mesh.point_ids[3] = 123_456_789
    with pytest.raises(InputError, match="ids run from 1 to 123456789, but small field holds"):
        write_nastran(mesh, tmp_path / "wide.nas")
    assert not list(tmp_path.iterdir())
    write_read(mesh, tmp_path, "large")
    write_read(mesh, tmp_path, "free")
    mesh.tet_ids[0] = 0
    with pytest.raises(InputError, match="ids run from 0"):
        write_nastran(mesh, tmp_path / "zero.nas", field="free")


def test_writer_refuses_what_cannot_be_written(tmp_path: Path) -> None:
    mesh = single()
    with pytest.raises(InputError, match="there are small, large, free"):
        write_nastran(mesh, tmp_path / "x.nas", field="wide")
    with pytest.raises(InputError, match="cannot be written"):
        write_nastran(mesh, tmp_path / "no folder" / "x.nas")
    (tmp_path / "file").touch()
    with pytest.raises(InputError, match=r"x\.nas: cannot be written: Not a directory"):
        write_nastran(mesh, tmp_path / "file" / "x.nas")
    with pytest.raises(InputError, match="cannot be written: File name too long"):
        write_nastran(mesh, tmp_path / f"{'x' * 300}.nas")
    (tmp_path / "file").unlink()
    mesh.points[0, 0] = np.nan
    with pytest.raises(InputError, match="NaN"):
        write_nastran(mesh, tmp_path / "x.nas")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("field", ["small", "large", "free"])
def test_a_mesh_of_nothing_is_written(tmp_path: Path, field: str) -> None:
    write_nastran(mesh_of([], []), tmp_path / "x.nas", field=field)
    assert (tmp_path / "x.nas").read_text() == "BEGIN BULK\nENDDATA\n"


def test_whole_file_or_the_one_before(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write_nastran(single(), tmp_path / "x.nas")
    before = (tmp_path / "x.nas").read_bytes()

    def fail(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "replace", fail)
    with pytest.raises(InputError, match=r"x\.nas: cannot be written: No space left on device"):
        write_nastran(generate("box", 20), tmp_path / "x.nas")
    assert {file.name: file.read_bytes() for file in tmp_path.iterdir()} == {"x.nas": before}


def test_comments_stand_at_the_top(tmp_path: Path) -> None:
    write_nastran(single(), tmp_path / "x.nas", comments=["first", "second\nGRID,1"])
    assert (tmp_path / "x.nas").read_text().startswith("$ first\n$ second\n$ GRID,1\nBEGIN BULK\nGRID ")
    assert [file.name for file in tmp_path.iterdir()] == ["x.nas"]
    write_nastran(single(), tmp_path / "x.nas", comments=[os.fsdecode(b"caf\xe9.nas")])
    assert (tmp_path / "x.nas").read_bytes().startswith(b"$ caf\xe9.nas\nBEGIN BULK\n")


# ------------------------------ suffixes


@pytest.mark.parametrize("suffix", [".nas", ".bdf", ".dat", ".fem", ".NAS"])
def test_mesh_files_by_suffix(tmp_path: Path, suffix: str) -> None:
    mesh = generate("box", 20)
    write_mesh(mesh, tmp_path / f"box{suffix}")
    np.testing.assert_array_equal(read_mesh(tmp_path / f"box{suffix}").tets, mesh.tets)
    assert "smallest dihedral angle" in (tmp_path / f"box{suffix}").read_text().splitlines()[0]


def test_unknown_suffix_and_missing_file(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"'\.nax' names no known format; did you mean \.nas\? known are \.nas \.bdf"):
        read_mesh(tmp_path / "x.nax")
    with pytest.raises(InputError, match="no known format"):
        write_mesh(single(), tmp_path / "x")
    with pytest.raises(InputError, match=r"no such file; make it with: tetrabench generate nozzle -o nozzle\.nas$"):
        read_mesh(tmp_path / "nozzle.nas")
    with pytest.raises(InputError, match=r"no such file$"):
        read_mesh(tmp_path / "other.nas")
