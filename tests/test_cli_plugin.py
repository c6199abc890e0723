"""--plugin: a file of one's own takes part in every verb that looks things up."""

import os

import pytest
from click.testing import CliRunner

from tests.bench.test_registry import MINE
from tetrabench.cli import main


def say(*words):
    return CliRunner().invoke(main, [str(word) for word in words])


@pytest.fixture
def mine(tmp_path):
    path = tmp_path / "mine.py"
    path.write_text(MINE)
    return path


def test_it_is_listed_and_forgotten_again(mine):
    for what, name in (("backends", "my-v3"), ("scenarios", "mine-alfa"), ("models", "my-box")):
        assert name in say("list", what, "--plugin", mine).stdout
        assert name not in say("list", what).stdout
    assert "TETRABENCH_PLUGINS" not in os.environ


def test_a_path_that_would_be_two(mine):
    (mine.parent / "a:b").mkdir()
    mine.rename(mine.parent / "a:b" / "mine.py")
    done = say("list", "backends", "--plugin", mine.parent / "a:b" / "mine.py")
    assert done.exit_code == 2
    assert "a plug-in cannot lie at a path with ':'" in done.output
    assert done.output.count("\n") == 1


def test_it_takes_part_in_a_run(mine, tmp_path):
    words = ("--model", "my-box", "--tets", "400", "--backend", "v3,my-v3", "--scenario", "mine-alfa")
    done = say("check", *words, "--plugin", mine)
    assert done.exit_code == 0, done.output
    assert "my-v3" in done.stdout
    told = say("run", *words, "--plugin", mine, "--dry-run").stdout
    assert "tetrabench run --model my-box --plugin mine.py --backend v3,my-v3" in told


def test_the_command_names_it_from_here(mine, monkeypatch):
    monkeypatch.chdir(mine.parent.parent)
    told = say("run", "--model", "box", "--tets", "300", "--plugin", mine, "--backend", "my-v3", "--dry-run").stdout
    assert f"--plugin {mine.parent.name}/mine.py " in told


def test_its_model_is_generated(mine, tmp_path):
    done = say("generate", "my-box", "--tets", "400", "-o", tmp_path / "box.nas", "--plugin", mine)
    assert done.exit_code == 0, done.output
    assert done.stdout.startswith("my-box: 384 tets")


def test_a_broken_one_is_named_and_skipped(tmp_path):
    path = tmp_path / "broken.py"
    path.write_text("1/0")
    done = say("list", "backends", "--plugin", path)
    assert done.exit_code == 0
    assert done.stderr == (
        "tetrabench: skipped plug-in broken.py: cannot be imported: ZeroDivisionError: division by zero (broken.py:1)\n"
    )
    assert "v3y" in done.stdout
    done = say("run", "--backend", "mine", "--plugin", path, "--model", "box", "--tets", "300")
    assert done.exit_code == 2
    assert "skipped plug-in broken.py" in done.stderr
    assert "no backend 'mine'" in done.stderr


def test_one_that_is_not_there_is_refused(tmp_path):
    done = say("list", "backends", "--plugin", tmp_path / "nowhere.py")
    assert done.exit_code == 2
    assert "there is no file" in done.stderr
    assert done.stderr.count("\n") == 1


@pytest.mark.parametrize(
    ("model", "told"),
    [
        (
            "from tetrabench.mesh.models.model import Model\nMODELS = [Model('mine', 't', 9, lambda n: 1 / 0)]",
            "ZeroDivisionError",
        ),
        (
            "import dataclasses\nfrom tetrabench.mesh.models.box import BOX\ndef make(n):\n    one = BOX.build(n)\n"
            "    one.tets[:, :2] = one.tets[:, 1::-1]\n    return one\n"
            "MODELS = [dataclasses.replace(BOX, name='mine', build=make)]",
            "48 tets have no positive volume, once its points are moved by `reach`",
        ),
        (
            "from tetrabench.mesh.polygon.models.model import PolygonModel\n"
            "MODELS = [PolygonModel('mine', 't', 9, lambda n, seed: None, 50)]",
            "AttributeError",
        ),
        (
            "from tetrabench.collision.start.models import Model\nMODELS = [Model('mine', 't', lambda *_: (1, 2))]",
            "ValueError: not enough values to unpack",
        ),
    ],
)
def test_a_model_that_cannot_be_made_is_a_line(tmp_path, model, told):
    (tmp_path / "mine.py").write_text(model)
    suffix = ".npz" if "collision" in model else ".obj" if "polygon" in model else ".nas"
    done = say("generate", "mine", "--tets", "48", "-o", tmp_path / f"a{suffix}", "--plugin", tmp_path / "mine.py")
    assert done.exit_code == 2, done.output
    assert done.stderr.splitlines()[-1].startswith("tetrabench: the model mine: ")
    assert told in done.stderr
    assert "Traceback" not in done.output
    assert not (tmp_path / f"a{suffix}").exists()
