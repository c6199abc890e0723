"""The verbs about models, on objects: generate, info, convert and view."""

import json
import re
from dataclasses import fields
from pathlib import Path

import numpy as np
import pytest

from tests.collision.test_files import same
from tests.test_cli import refusal, say
from tetrabench.collision.start.files import read_objects
from tetrabench.collision.start.inspection import ObjectsInspection
from tetrabench.collision.start.models import MODELS, generate_objects
from tetrabench.io.polygons import read_polygons


def test_generate_writes_what_the_model_is(tmp_path: Path) -> None:
    for name in MODELS:
        start = generate_objects(name, 60, numbering="hilbert", seed=3)
        for suffix in (".csv", ".npz"):
            words = ("--objects", 60, "--seed", 3, "--numbering", "hilbert", "-o", tmp_path / f"a{suffix}")
            result = say("generate", name, *words)
            assert (result.exit_code, result.stdout) == (0, f"{start.source}\n")
            assert result.stderr == f"wrote {tmp_path / f'a{suffix}'}\n"
            assert same(read_objects(tmp_path / f"a{suffix}").objects, start.objects)
    told = " ".join(say("generate", "--help").stdout.split())
    assert all(name in told for name in MODELS)
    assert "--objects" in told


def test_generate_refuses_before_it_works(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tetrabench.collision.start.kind.generate_objects", None)
    assert "objects are written as .npz and .csv files, not as '.nas'" in refusal(
        "generate", "uniform", "-o", tmp_path / "a.nas"
    )
    assert "can only be chosen for Nastran" in refusal("generate", "mixed", "--field", "free", "-o", tmp_path / "a.csv")
    told = refusal("generate", "clusterd", "-o", tmp_path / "a.csv")
    assert "did you mean 'clustered'? there are: nozzle, intake, box, " in told
    assert told.endswith(f"{', '.join(MODELS)}\n")
    assert not list(tmp_path.iterdir())


def test_generate_refuses_what_objects_have_not(tmp_path: Path) -> None:
    words = ("generate", "uniform", "--objects", 5, "-o", tmp_path / "a.csv")
    assert "objects have no graph" in refusal(*words, "--numbering", "rcm")
    assert not list(tmp_path.iterdir())


def test_info_of_a_table(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text("# box 20 10\nx,y,vx,vy,r,m\n1,2,3,4,1,5\n2,2,0,0,1,7\n-5,2,0,0,2,5\n")
    result = say("info", tmp_path / "a.csv")
    assert (result.exit_code, result.stderr) == (0, "")
    values = dict(re.split(" {2,}", line, maxsplit=1) for line in result.stdout.splitlines() if line)
    assert values == {
        "source": str(tmp_path / "a.csv"),
        "objects": "3",
        "width": "20",
        "height": "10",
        "lowest": "-5, 2",
        "highest": "2, 2",
        "outside": "1",
        "radii": "1, 2",
        "masses": "5, 7",
        "speeds": "0, 5",
        "covered": "0.0942477796",
        "contacts": "1",
        "stride": "0.489897949",
        "memory of a run, about": values["memory of a run, about"],
    }
    told = json.loads(say("info", tmp_path / "a.csv", "--format", "json").stdout)
    assert list(told) == [*(field.name for field in fields(ObjectsInspection)), "needs"]
    assert (told["contacts"], told["radii"], told["refusal"]) == (1, [1.0, 2.0], "")


def test_info_of_what_cannot_be_read(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text("x,y\n1,two\n")
    assert "a.csv:2: y has to be a finite number, not 'two'" in refusal("info", tmp_path / "a.csv")
    assert "there is no such file" in refusal("info", tmp_path / "b.csv")
    assert "there is no such file" in refusal("info", tmp_path / "b.npz")
    assert "'.cvs' names no known format; did you mean .csv?" in refusal("info", tmp_path / "b.cvs")


def test_an_archive_is_looked_into(tmp_path: Path) -> None:
    say("generate", "uniform", "--objects", 7, "-o", tmp_path / "objects.npz")
    say("generate", "quad", "--cells", 9, "-o", tmp_path / "cells.npz")
    assert json.loads(say("info", tmp_path / "objects.npz", "--format", "json").stdout)["objects"] == 7
    assert json.loads(say("info", tmp_path / "cells.npz", "--format", "json").stdout)["cells"] == 9
    assert say("convert", tmp_path / "objects.npz", tmp_path / "cells.csv").exit_code == 0
    assert "polygons are not written" in refusal("convert", tmp_path / "cells.npz", tmp_path / "cells.nas")
    assert len(read_polygons(tmp_path / "cells.npz").points) == 16


def test_convert_there_and_back_and_in_another_order(tmp_path: Path) -> None:
    say("generate", "mixed", "--objects", 40, "-o", tmp_path / "a.npz")
    result = say("convert", tmp_path / "a.npz", tmp_path / "b.csv", "--numbering", "shuffled", "--seed", 2)
    assert (result.exit_code, result.stdout, result.stderr) == (0, "", f"wrote {tmp_path / 'b.csv'}: 40 objects\n")
    assert say("convert", tmp_path / "b.csv", tmp_path / "c.npz").exit_code == 0
    back, model = read_objects(tmp_path / "c.npz"), generate_objects("mixed", 40)
    assert (back.width, back.height) == (model.width, model.height)
    assert same(read_objects(tmp_path / "a.npz").objects, model.objects)
    assert not same(back.objects, model.objects)
    order = np.random.default_rng([2, 1]).permutation(40)
    for one, other in zip(back.objects, model.objects, strict=True):
        assert one.tolist() == other[order].tolist()


def test_convert_refuses_before_it_reads(tmp_path: Path) -> None:
    nowhere = tmp_path / "nowhere.csv"
    assert "objects are written as .npz and .csv files, not as '.vtu'" in refusal(
        "convert", nowhere, tmp_path / "b.vtu"
    )
    assert "can only be chosen for Nastran" in refusal("convert", nowhere, tmp_path / "b.csv", "--field", "free")
    (tmp_path / "a.csv").write_text("x,y\n1,2\n")
    assert "is what is read" in refusal("convert", tmp_path / "a.csv", tmp_path / "a.csv")
    assert "objects have no graph" in refusal("convert", tmp_path / "a.csv", tmp_path / "b.csv", "--numbering", "rcm")
    assert [file.name for file in tmp_path.iterdir()] == ["a.csv"]


def test_view_sends_objects_to_watch(tmp_path: Path) -> None:
    say("generate", "uniform", "--objects", 7, "-o", tmp_path / "a.npz")
    for model in ("uniform", "separated", tmp_path / "a.npz", "nowhere.csv"):
        told = refusal("view", model, "--family", "collision", "-o", tmp_path / "a.png")
        assert f"objects are drawn by: tetrabench watch --model {model} --steps 0 --record FILE.png" in told
    assert [file.name for file in tmp_path.iterdir()] == ["a.npz"]
