"""What is shipped: the sdist is the repository, its wheel has every file, and needs no more than it declares."""

import sys
import tarfile
import tomllib
import zipfile
from pathlib import Path, PurePosixPath

import pytest
import yaml
from numba import config
from packaging.requirements import Requirement

from tests.packaging.environments import ROOT, build, copy_sources, find_python, link, make_environment, needed
from tests.packaging.environments import run as run_program
from tests.packaging.first_steps import QUICK, Step, take
from tests.packaging.lowest import constraints
from tests.packaging.release import notes_of

pytestmark = pytest.mark.xdist_group("packaging")

GENERATED = {"PKG-INFO", "setup.cfg"}


@pytest.fixture(scope="module")
def sources(tmp_path_factory):
    return copy_sources(tmp_path_factory.mktemp("sources") / "tetrabench")


@pytest.fixture(scope="module")
def shipped(sources, tmp_path_factory):
    there = files_of(sources) - GENERATED  # asked before building leaves files of its own; an unpacked sdist has some
    return there, *build(sources, tmp_path_factory.mktemp("dist") / "dist")


def files_of(folder: Path) -> set[str]:
    return {path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()}


def test_the_sdist_is_the_repository(shipped):
    there, sdist, _ = shipped
    with tarfile.open(sdist) as archive:
        packed = {str(PurePosixPath(*PurePosixPath(m.name).parts[1:])) for m in archive.getmembers() if m.isfile()}
    assert {name for name in packed - GENERATED if ".egg-info/" not in name} == there
    assert {"LICENSE", ".ci/run", "tests/test_packaging.py", "docs/measuring.md", "CITATION.cff"} <= packed
    assert not [name for name in packed if name.startswith((".git/", ".venv/", "build/")) or "__pycache__" in name]


def test_every_file_is_in_the_wheel(shipped):
    there, _, wheel = shipped
    installed = {name for name in there if name.startswith("tetrabench/")}
    installed |= {f"tetrabench/{name}" for name in there if name.startswith(("backends/", "scenarios/"))}
    with zipfile.ZipFile(wheel) as archive:
        packed = {name for name in archive.namelist() if ".dist-info/" not in name}
        licences = [name for name in archive.namelist() if name.endswith(".dist-info/licenses/LICENSE")]
    assert packed == installed
    assert licences


def test_every_package_is_named():
    """One that is not is shipped all the same, as data of the package around it: setuptools means to end that."""
    named = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["setuptools"]["packages"]
    folders = {
        file.parent.relative_to(ROOT)
        for top in ("tetrabench", "backends", "scenarios")
        for file in (ROOT / top).rglob("*.py")
    }
    there = {
        ".".join(folder.parts if folder.parts[0] == "tetrabench" else ("tetrabench", *folder.parts))
        for folder in folders
    }
    assert sorted(named) == sorted(there)


def test_twine_finds_no_fault(shipped):
    _, *files = shipped
    done = run_program([sys.executable, "-m", "twine", "check", "--strict", *files], ROOT)
    assert done.returncode == 0, done.stdout
    assert done.stdout.count("PASSED") == 2


@pytest.fixture(scope="module")
def programs(shipped, tmp_path_factory):
    """An environment that holds the wheel, and of this one only what the wheel declares to need."""
    *_, wheel = shipped
    programs = make_environment(tmp_path_factory.mktemp("alone") / "venv", Path(sys.executable), "--without-pip")
    link(programs, needed("tetrabench"))
    pip = [sys.executable, "-m", "pip", "--python", programs / "python", "install", "--quiet", "--no-deps", wheel]
    done = run_program(pip, programs)
    assert done.returncode == 0, done.stderr
    return programs


def test_the_wheel_runs_without_the_checkout(programs, tmp_path):
    modules = ("tetrabench", "tetrabench.backends.tetra", "tetrabench.scenarios.tetra")
    code = "".join(f"import {module}; print({module}.__file__);" for module in modules)
    done = run_program([programs / "python", "-c", code], tmp_path)
    assert done.returncode == 0, done.stderr
    assert all(Path(file).is_relative_to(programs.parent) for file in done.stdout.split())


@pytest.mark.parametrize("name", ["jinja2", "pygame", "h5py", "pytest"])
def test_nothing_else_is_visible(programs, tmp_path, name):
    done = run_program([programs / "python", "-c", f"import {name}"], tmp_path)
    assert "ModuleNotFoundError" in done.stderr


@pytest.mark.skipif(bool(config.DISABLE_JIT), reason="compiled steps")
def test_the_first_steps(programs, tmp_path):
    (tmp_path / "folder").mkdir()
    faults = [
        f"{taken.step}: {taken.fault}"
        for taken in take(QUICK, programs, tmp_path / "folder", tmp_path / "cache")
        if taken.fault
    ]
    assert not faults, "\n".join(faults)


def test_a_step_that_goes_wrong_is_noticed(programs, tmp_path):
    steps = [Step("--version", "nothing like it"), Step("--version", code=2), Step("info none.nas", code=2)]
    assert [bool(taken.fault) for taken in take(steps, programs, tmp_path, tmp_path / "cache")] == [True, True, False]


def test_lower_bounds_are_those_of_pyproject():
    pinned = [Requirement(line) for line in constraints(ROOT / "pyproject.toml")]
    assert {"numpy", "numba", "jinja2", "pygame-ce"} <= {requirement.name for requirement in pinned}
    assert all(str(requirement.specifier).startswith("==") for requirement in pinned)
    assert not [requirement for requirement in pinned if requirement.extras]  # pip refuses them in constraints


def test_a_dependency_without_a_lower_bound_is_noticed(tmp_path):
    (tmp_path / "pyproject.toml").write_text('[project]\ndependencies = ["numpy"]\n')
    with pytest.raises(ValueError, match="numpy"):
        constraints(tmp_path / "pyproject.toml")


def test_a_python_that_is_not_there_is_not_found():
    assert find_python("3.99") is None


@pytest.mark.parametrize(
    "path", [*(ROOT / ".github").rglob("*.yml"), ROOT / "CITATION.cff"], ids=lambda path: path.name
)
def test_yaml_is_yaml(path):
    assert isinstance(yaml.safe_load(path.read_text()), dict)


def test_the_citation_is_of_this_package():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text())
    assert (citation["title"], citation["license"]) == (project["name"], project["license"])


PROJECT = '[project]\nversion = "0.1.0"\n'


def test_the_notes_of_a_release_are_its_section():
    changelog = (
        "# Changelog\n\n## Unreleased\n\n- Later.\n\n## 0.1.0 (today)\n\n- First.\n- Second.\n\n## 0.0.1\n\n- Old.\n"
    )
    assert notes_of("v0.1.0", PROJECT, changelog) == "- First.\n- Second."


@pytest.mark.parametrize(
    ("tag", "changelog", "why"),
    [
        ("v0.1.1", "## 0.1.1\n\n- New.\n", "pyproject.toml says 0.1.0"),
        ("0.1.0", "## 0.1.0\n\n- New.\n", "the tag is 0.1.0"),
        ("v0.1.0", "## Unreleased\n\n- New.\n", "CHANGELOG.md says nothing of 0.1.0"),
        ("v0.1.0", "## 0.1.0\n\n## 0.0.1\n\n- Old.\n", "CHANGELOG.md says nothing of 0.1.0"),
    ],
)
def test_a_tag_that_is_no_release(tag, changelog, why):
    with pytest.raises(ValueError, match=why):
        notes_of(tag, PROJECT, changelog)
