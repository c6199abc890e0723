"""tetrabench new: what it writes works as it is, and keeps to the rules of its family."""

import ast
import json
import os
import re
import subprocess
import sys
import tomllib
from contextlib import nullcontext
from pathlib import Path
from types import SimpleNamespace

import pytest
from numba import config

import tetrabench
from tests.test_cli import refusal, say
from tetrabench import registry
from tetrabench.cli.new import TEMPLATES

FAMILIES = [family.name for family in registry.families()]

PLAIN_RULES = """
import json, sys
from tetrabench import registry
name, family = sys.argv[1:]
one = registry.contestant(family, name)
print(json.dumps({rule.name: list(rule.faults(one)) for rule in registry.family(family).rules}))
"""


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def write(name: str, family: str, *words: object) -> None:
    done = say("new", "contestant", name, "--family", family, *words)
    assert (done.exit_code, done.stdout) == (0, ""), done.output


@pytest.mark.parametrize("family", FAMILIES)
def test_it_keeps_to_the_rules_in_plain_python(here: Path, family: str) -> None:
    """Compiled, it is what our own contestants are, whose rules are tried in all modes."""
    write("zebra_x", family)
    environment = {**os.environ, "TETRABENCH_PLUGINS": "zebra_x/zebra_x.py", "NUMBA_DISABLE_JIT": "1"}
    command = [sys.executable, "-c", PLAIN_RULES, "zebra_x", family]
    done = subprocess.run(command, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    faults = json.loads(done.stdout)
    assert list(faults) == [rule.name for rule in registry.family(family).rules]
    assert not any(faults.values()), faults


@pytest.mark.parametrize("family", FAMILIES)
def test_nothing_of_the_template_is_left(here: Path, family: str) -> None:
    write("zebra_x", family)
    folder = here / "zebra_x"
    texts = {path.name: path.read_text() for path in folder.iterdir()}
    assert set(texts) == {"README.md", "pyproject.toml", "test_zebra_x.py", "zebra_x.py"}
    for text in texts.values():
        assert not re.search("mine|Mine|FAMILY|REFERENCE|MODEL|SIZE", text)
        assert "zebra_x" in text
    project = tomllib.loads(texts["pyproject.toml"])
    assert project["project"]["entry-points"] == {"tetrabench.contestants": {family: "zebra_x:CONTESTANTS"}}
    assert project["project"]["name"] == "zebra_x"
    assert project["tool"]["setuptools"] == {"py-modules": ["zebra_x"]}
    known = registry.family(family)
    assert (
        f"--family {family} --model {known.default_model} --{known.size_option} 20k --backend {known.reference},zebra_x"
        in texts["README.md"]
    )


@pytest.mark.parametrize("family", FAMILIES)
def test_each_function_says_what_is_asked_of_it(family: str) -> None:
    tree = ast.parse((TEMPLATES / family / "mine.py").read_text())
    functions = [node for node in tree.body if isinstance(node, ast.FunctionDef | ast.ClassDef)]
    assert len(functions) > 8
    assert [one.name for one in functions if not ast.get_docstring(one)] == []
    classes = [one.name for one in functions if isinstance(one, ast.ClassDef)]
    assert classes == ["Mine"]


@pytest.mark.skipif(bool(config.DISABLE_JIT), reason="runs workers, which take minutes without the JIT")
def test_it_takes_part_compiled_as_a_file(here: Path) -> None:
    write("zebra_x", "polygon", "-o", "there")
    words = ("--family", "polygon", "--model", "quad", "--cells", 400, "--backend", "by-edge,zebra_x")
    once = ("--scenario", "cell-nodes", "--launches", 1, "--rounds", 1, "-o", "out.json")
    done = say("run", *words, *once, "--plugin", "there/zebra_x.py")
    assert done.exit_code == 0, done.output
    samples = json.loads((here / "out.json").read_text())["samples"]
    assert {(one["backend"], one["status"]) for one in samples} >= {("by-edge", "ok"), ("zebra_x", "ok")}
    assert len({one["digest"] for one in samples}) == 1


@pytest.mark.parametrize("faults", [[], ["volume: it gives 0.0"]])
def test_its_test_asks_for_it_and_finds_faults(here: Path, monkeypatch: pytest.MonkeyPatch, faults: list[str]) -> None:
    write("zebra_x", "tetra")
    asked = []

    def check_contestant(name: str, family: str) -> list:
        asked.append((name, family, os.environ["TETRABENCH_PLUGINS"]))
        return [SimpleNamespace(rule="fields", mode="compiled", status="faulty" if faults else "sound", faults=faults)]

    monkeypatch.setattr(tetrabench, "check_contestant", check_contestant)
    scope = {"__file__": str(here / "zebra_x" / "test_zebra_x.py")}
    exec((here / "zebra_x" / "test_zebra_x.py").read_text(), scope)
    with pytest.raises(AssertionError) if faults else nullcontext():
        scope["test_it_keeps_to_the_rules"](monkeypatch)
    assert asked == [("zebra_x", "tetra", str(here / "zebra_x" / "zebra_x.py"))]


def test_what_it_says(here: Path) -> None:
    done = say("new", "contestant", "zebra", "-o", "there")
    assert done.stderr == (
        "wrote there: README.md, zebra.py, pyproject.toml, test_zebra.py\n"
        "next: tetrabench check --contestant zebra --family tetra --plugin there/zebra.py\n"
    )


@pytest.mark.parametrize(
    ("words", "reason"),
    [
        (("hot-cold",), "'hot-cold' can be no name of a Python module: take letters, digits and _, such as hot_cold"),
        (("5v",), "'5v' can be no name"),
        (("lambda",), "'lambda' can be no name"),
        (("zebra_",), "'zebra_' can be no name"),
        (("zèbre",), "'zèbre' can be no name"),
        (("",), "'' can be no name"),
        (("../zebra",), "'../zebra' can be no name"),
        (("setup",), "'setup' can be no name"),
        (("numpy",), "there is a Python module 'numpy' already"),
        (("v3y",), "there is a backend 'v3y' already: take another name"),
        (("tables", "--family", "polygon"), "there is a backend 'tables' already"),
        (("zebra", "--family", "tetras"), "no family 'tetras'; did you mean 'tetra'?"),
        (("zebra", "-o", "missing/zebra"), "missing/zebra cannot be written: No such file or directory"),
        (("zebra", "-o", "."), ". is there already: take another name, or another folder with -o"),
    ],
)
def test_what_is_refused(here: Path, words: tuple[str, ...], reason: str) -> None:
    assert reason in refusal("new", "contestant", *words)
    assert list(here.iterdir()) == []


def test_a_folder_that_is_there_stays_as_it_is(here: Path) -> None:
    (here / "zebra").mkdir()
    (here / "zebra" / "zebra.py").write_text("precious")
    assert "zebra is there already: take another name" in refusal("new", "contestant", "zebra")
    assert (here / "zebra" / "zebra.py").read_text() == "precious"
    assert len(list((here / "zebra").iterdir())) == 1
