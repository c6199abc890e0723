"""The verbs about meshes: info, convert and generate."""

import json
import re
import time
from dataclasses import fields
from pathlib import Path

import click
import meshio
import numpy as np
import pytest

from tests.meshes import apart, mesh_of
from tests.test_cli import refusal, say
from tetrabench.bench.needs import Forecast
from tetrabench.cli.options import read_count
from tetrabench.io import read_mesh, write_mesh
from tetrabench.mesh.bandwidth import Bandwidth
from tetrabench.mesh.inspection import Inspection, Numbering, TetraQuality
from tetrabench.mesh.models import generate

POINTS = np.random.default_rng(1).uniform(size=(9, 3))
MEMORY = "memory of a run, about"
FAULTY = [[0, 1, 2, 3], [1, 2, 3, 4], [1, 2, 3, 5], [3, 2, 1, 0], [7, 7, 7, 6]]


@pytest.fixture
def faulty(tmp_path: Path) -> Path:
    """A file with a tetra of each kind that is left out."""
    write_mesh(mesh_of(POINTS, FAULTY), tmp_path / "faulty.vtu")
    return tmp_path / "faulty.vtu"


# ---------------------------------------------------------------------- info


def test_info_of_a_sound_file(tmp_path: Path) -> None:
    write_mesh(apart(), tmp_path / "a.vtu")
    result = say("info", tmp_path / "a.vtu")
    assert (result.exit_code, result.stderr) == (0, "")
    values = dict(re.split(" {2,}", line) for line in result.stdout.splitlines() if line)
    assert values["format"] == "VTK XML"
    assert (values["points"], values["tetras"], values["components"], values["unreferenced"]) == ("9", "2", "2", "1")
    assert (values["lowest"], values["highest"], values["volume"]) == ("0, 0, 0", "6, 6, 6", "0.333333333")
    assert (values["smallest dihedral angle"], values["dropped"]) == ("54.7 degrees", "none")
    assert (values["worst tetras"], values["distances of tetras"]) == ("1, 2", "largest 0, mean 0, profile 0")
    assert re.fullmatch(r"\S+ GiB with all backends at once, in groups .* at least; \S+ MiB a net", values[MEMORY])
    assert re.fullmatch(r"\d+ min, with --quick \d+ min", values["time of a run, about"])


def test_keys_of_the_json_are_those_documented(tmp_path: Path) -> None:
    write_mesh(generate("box", 48), tmp_path / "box.nas")
    result = say("info", tmp_path / "box.nas", "--format", "json")
    assert (result.exit_code, result.stderr) == (0, "")
    told = json.loads(result.stdout)
    assert list(told) == [*(field.name for field in fields(Inspection)), "needs"]
    parts = [(told, Inspection), (told["quality"], TetraQuality), (told["numbering"], Numbering)]
    parts += [(one, Bandwidth) for one in told["numbering"]["distances"].values()] + [(told["needs"], Forecast)]
    for part, kind in parts:
        documented = {line.partition(":")[0].strip() for line in (kind.__doc__ or "").splitlines()}
        assert set(part) <= documented | {"needs"}  # Python 3.13 takes the indentation away
    assert (told["tetras"], told["points"], told["surface_sides"]) == (48, 27, 48)
    assert told["volume"] == pytest.approx(1)
    assert (told["dropped"], told["refusal"]) == ({}, "")


def test_info_of_what_is_refused_for_faults_that_can_be_left_out(faulty: Path) -> None:
    result = say("info", faulty)
    assert result.exit_code == 0
    assert re.search("^dropped +repeated node 1, duplicate 1, crowded side 1$", result.stdout, re.MULTILINE)
    sentence = "tetra 5 repeats a node; also: 1 duplicate, 1 crowded side"
    assert f"- {faulty}: {sentence}; left out\n" in result.stdout
    assert result.stdout.endswith("- the file is refused, unless --repair drop leaves these tetras out\n")
    told = json.loads(say("info", faulty, "--format", "json").stdout)
    assert told["refusal"] == f"{faulty}: {sentence}; convert --repair drop leaves them out"
    assert (told["tetras"], told["points"], told["unreferenced"]) == (2, 9, 4)

    result = say("info", faulty, "--repair", "drop")
    assert result.exit_code == 0
    assert "is refused" not in result.stdout
    assert json.loads(say("info", faulty, "--repair", "drop", "--format", "json").stdout)["refusal"] == ""


def test_the_exit_code_of_info_is_the_one_that_is_described(faulty: Path) -> None:
    (faulty.parent / "cut.nas").write_text("BEGIN BULK\n")
    for file, code in ((faulty, 0), (faulty.parent / "cut.nas", 2)):
        assert say("info", file).exit_code == code
    told = " ".join(say("info", "--help").stdout.split())
    assert "is described without them, and the exit code is 0" in told
    assert "What cannot be described at all is refused with exit code 2" in told


def test_info_of_what_cannot_be_read(tmp_path: Path) -> None:
    assert "there is no such file" in refusal("info", tmp_path / "no.vtu")
    (tmp_path / "bad.vtu").write_text("nonsense")
    assert "cannot be read as VTK XML" in refusal("info", tmp_path / "bad.vtu")
    assert "'.vtux' names no known format" in refusal("info", tmp_path / "a.vtux")
    (tmp_path / "binary.nas").write_bytes(bytes(range(256)) * 20)
    assert "null bytes, as no deck does: is it a binary file?\n" in refusal("info", tmp_path / "binary.nas")


def test_info_and_convert_name_the_values_that_they_leave_out(tmp_path: Path) -> None:
    mesh = generate("box", 48)
    raw = meshio.Mesh(
        mesh.points,
        [("tetra", mesh.tets)],
        point_data={"heat": np.zeros(len(mesh.points))},
        cell_data={"load": [np.zeros(len(mesh.tets))], "tetra_id": [mesh.tet_ids]},
    )
    meshio.write(tmp_path / "with.vtu", raw)
    assert "values heat, load" in " ".join(say("info", tmp_path / "with.vtu").stdout.split())
    told = say("convert", tmp_path / "with.vtu", tmp_path / "without.mesh").stderr.splitlines()
    assert told[0] == "left out the values heat, load"
    surface = meshio.Mesh(mesh.points[:3], [("triangle", [[0, 1, 2]])], point_data={"heat": np.zeros(3)})
    meshio.write(tmp_path / "surface.vtu", surface)
    assert "values heat" in " ".join(say("info", tmp_path / "surface.vtu").stdout.split())


def test_more_memory_than_there_is_is_6(faulty: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tetrabench.memory.available_bytes", lambda: 1000)
    for words in (["info", faulty], ["convert", faulty, faulty.with_suffix(".mesh")]):
        result = say(*words)
        assert (result.exit_code, result.stdout) == (6, "")
        assert re.fullmatch(r"tetrabench: reading .* needs about .*; take a smaller one.*\n", result.stderr)
    assert list(faulty.parent.iterdir()) == [faulty]


def test_what_takes_long_says_what_it_is(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write_mesh(apart(), tmp_path / "a.vtu")
    monkeypatch.setattr("tetrabench.cli.speech.PATIENCE", 0.05)

    def slow_read(*words: object, **options: str) -> object:
        time.sleep(0.5)
        return read_mesh(*words, **options)

    monkeypatch.setattr("tetrabench.io.kinds.read_mesh", slow_read)
    result = say("info", tmp_path / "a.vtu")
    assert result.stderr.splitlines()[0] == f"reading {tmp_path / 'a.vtu'} ..."
    assert "\x1b" not in result.output
    assert result.exit_code == 0


# ---------------------------------------------------------------------- convert


def test_convert_there_and_back(tmp_path: Path) -> None:
    mesh = generate("box", 48, seed=4)
    write_mesh(mesh, tmp_path / "a.nas", field="free")
    result = say("convert", tmp_path / "a.nas", tmp_path / "b.vtu")
    assert (result.exit_code, result.stdout) == (0, "")
    assert result.stderr == f"wrote {tmp_path / 'b.vtu'}: 48 tetras, 27 points\n"
    say("convert", tmp_path / "b.vtu", tmp_path / "c.nas", "--field", "free")
    back = read_mesh(tmp_path / "c.nas")
    assert back.points.tobytes() == mesh.points.tobytes()
    np.testing.assert_array_equal(back.tets, mesh.tets)
    np.testing.assert_array_equal(back.point_ids, mesh.point_ids)


def test_convert_does_not_overwrite_what_it_reads(tmp_path: Path) -> None:
    write_mesh(generate("box", 48), tmp_path / "a.vtk")
    write_mesh(generate("box", 48), tmp_path / "b.ele")  # and b.node
    (tmp_path / "link.vtk").symlink_to(tmp_path / "a.vtk")
    before = {file.name: file.read_bytes() for file in tmp_path.iterdir()}
    for source, target in (("a.vtk", "a.vtk"), ("a.vtk", "link.vtk"), ("link.vtk", "a.vtk"), ("b.ele", "b.node")):
        said = refusal("convert", tmp_path / source, tmp_path / target, "--numbering", "shuffled")
        assert f"{target}: is what is read, and would be lost; write to another file" in said
    assert {file.name: file.read_bytes() for file in tmp_path.iterdir()} == before
    assert say("convert", tmp_path / "a.vtk", tmp_path / "b.node").exit_code == 0  # another file may be replaced
    assert "File name too long" in refusal("convert", tmp_path / "a.vtk", tmp_path / f"{'a' * 300}.vtk")


def test_convert_does_not_overwrite_what_a_deck_includes(tmp_path: Path) -> None:
    write_mesh(generate("box", 48), tmp_path / "all.nas")
    lines = (tmp_path / "all.nas").read_text().splitlines(keepends=True)
    grids = [number for number, line in enumerate(lines) if line.startswith("GRID")]
    first, last = grids[0], grids[-1] + 1
    (tmp_path / "grids.nas").write_text("".join(lines[first:last]))
    (tmp_path / "deck.nas").write_text("".join([*lines[:first], "INCLUDE 'grids.nas'\n", *lines[last:]]))
    (tmp_path / "link.nas").symlink_to(tmp_path / "grids.nas")
    before = {file.name: file.read_bytes() for file in tmp_path.iterdir()}
    for target in ("deck.nas", "grids.nas", "link.nas"):
        said = refusal("convert", tmp_path / "deck.nas", tmp_path / target)
        assert f"{target}: is what is read, and would be lost; write to another file" in said
    assert {file.name: file.read_bytes() for file in tmp_path.iterdir()} == before
    rows = [line.split() for line in say("info", tmp_path / "deck.nas").stdout.splitlines()]
    assert ["included", str(tmp_path / "grids.nas")] in rows
    assert say("convert", tmp_path / "deck.nas", tmp_path / "all.nas").exit_code == 0


def test_convert_renumbers_and_nothing_else(tmp_path: Path) -> None:
    write_mesh(generate("box", 48), tmp_path / "a.vtk")
    orders = {}
    for words in ((), ("--numbering", "shuffled"), ("--numbering", "shuffled", "--seed", 1)):
        say("convert", tmp_path / "a.vtk", tmp_path / "b.vtk", *words)
        back = read_mesh(tmp_path / "b.vtk")
        places = np.sort(back.points[back.tets].reshape(len(back.tets), -1), axis=0)
        orders[back.tets.tobytes()] = places.tobytes()
    assert len(orders) == 3
    assert len(set(orders.values())) == 1


def test_convert_says_what_it_leaves_out(faulty: Path) -> None:
    target = faulty.with_suffix(".mesh")
    assert "repeats a node" in refusal("convert", faulty, target)
    assert not target.exists()
    result = say("convert", faulty, target, "--repair", "drop")
    assert result.exit_code == 0
    assert result.stderr.splitlines() == [
        f"{faulty}: tetra 5 repeats a node; also: 1 duplicate, 1 crowded side; left out",
        "left out 4 points that no tetra uses",
        f"wrote {target}: 2 tetras, 5 points",
    ]
    assert say("convert", faulty, target, "--repair", "drop", "--unused", "keep").exit_code == 0
    assert len(read_mesh(target, unused="keep").points) == 9


def test_convert_refuses_before_it_reads(tmp_path: Path) -> None:
    nowhere = tmp_path / "nowhere.vtu"
    assert "did you mean .vtu?" in refusal("convert", nowhere, tmp_path / "b.vtux")
    assert "hold surfaces" in refusal("convert", nowhere, tmp_path / "b.stl")
    assert "can only be chosen for Nastran" in refusal("convert", nowhere, tmp_path / "b.vtk", "--field", "free")
    assert "there is no folder" in refusal("convert", nowhere, tmp_path / "nowhere" / "b.vtk")
    assert not list(tmp_path.iterdir())


# ---------------------------------------------------------------------- generate


def test_generate_refuses_before_it_works(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tetrabench.mesh.models.generate", None)
    assert "did you mean .nas?" in refusal("generate", "box", "-o", tmp_path / "box.nass")
    assert "hold surfaces" in refusal("generate", "box", "-o", tmp_path / "box.ply")


def test_generate_writes_the_digits_that_are_asked_for(tmp_path: Path) -> None:
    mesh = generate("box", 48, seed=4)
    errors = {}
    for field in ("small", "large", "free"):
        words = ("generate", "box", "--tets", 48, "--seed", 4, "--field", field, "-o", tmp_path / "box.nas")
        assert say(*words).exit_code == 0
        errors[field] = np.abs(read_mesh(tmp_path / "box.nas").points - mesh.points).max()
    assert errors["small"] > 1e-9 > errors["large"] > errors["free"] == 0
    say("generate", "box", "--tets", 48, "--seed", 4, "-o", tmp_path / "box.nas")
    assert np.abs(read_mesh(tmp_path / "box.nas").points - mesh.points).max() == errors["small"]
    assert "can only be chosen for Nastran" in refusal("generate", "box", "--field", "free", "-o", tmp_path / "box.vtu")


@pytest.mark.parametrize(
    "verb", [("generate", "box", "-o", "box.nas"), ("convert", "a.nas", "b.nas"), ("run", "--model", "box")]
)
def test_a_seed_below_0_is_one_line_and_2(verb: tuple[str, ...]) -> None:
    assert "-1 is not in the range x>=0" in refusal(*verb, "--seed", "-1")


def test_counts_are_exact() -> None:
    counts = {"1.001k": 1001, "8.2M": 8_200_000, "642,700": 642_700, "1_000": 1000, "9" * 400: int("9" * 400)}
    assert {text: read_count(None, None, text) for text in counts} == counts
    for text in ("1.0001k", "0.5", "1e3", "-1", "k", "", "\u0661"):
        with pytest.raises(click.BadParameter, match="is no count such as"):
            read_count(None, None, text)
