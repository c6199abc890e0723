"""Pythons of this machine, environments made from them, and what a distribution is made of."""

import os
import shutil
import subprocess
import sys
from collections.abc import Mapping, Sequence
from importlib.metadata import Distribution, distribution
from pathlib import Path

from packaging.requirements import Requirement

ROOT = Path(__file__).parents[2]

VERSIONS = ("3.11", "3.12", "3.13", "3.14")


def find_python(version: str) -> Path | None:
    """A Python of the version, such as "3.12": on the path, or one of pyenv's; None where there is none that starts."""
    kept = Path(os.environ.get("PYENV_ROOT", Path.home() / ".pyenv")) / "versions"
    named = shutil.which(f"python{version}")
    for path in [*([Path(named)] if named else []), *sorted(kept.glob(f"{version}.*/bin/python"))]:
        # pyenv leaves names on the path that start nothing, and Debian Pythons without venv
        question = [str(path), "-c", "import sys, venv, ensurepip; print('%d.%d' % sys.version_info[:2])"]
        done = subprocess.run(question, capture_output=True, text=True)
        if done.returncode == 0 and done.stdout.strip() == version:
            return path
    return None


def make_environment(folder: Path, python: Path, *words: str) -> Path:
    """An environment that is empty but for pip; returns its folder of programs."""
    subprocess.run([python, "-m", "venv", "--clear", *words, folder], check=True)
    return folder / "bin"


def install(programs: Path, *words: str | Path) -> None:
    """Let the environment's own pip install."""
    command = [programs / "python", "-m", "pip", "install", "--quiet", "--disable-pip-version-check", *words]
    subprocess.run([str(word) for word in command], check=True)


def run(
    command: Sequence[str | Path], folder: Path, variables: Mapping[str, str] | None = None
) -> subprocess.CompletedProcess[str]:
    """Run a program in a folder, without what this process tells its own Python."""
    cleared = {name: value for name, value in os.environ.items() if not name.startswith(("PYTHON", "COVERAGE"))}
    words = [str(word) for word in command]
    return subprocess.run(words, cwd=folder, env={**cleared, **(variables or {})}, capture_output=True, text=True)


def copy_sources(target: Path) -> Path:
    """The checkout without what .gitignore names: what a distribution is built of, and may be built in."""
    ignored = [line.strip("/") for line in (ROOT / ".gitignore").read_text().split()]
    shutil.copytree(ROOT, target, ignore=shutil.ignore_patterns(".git", *ignored))
    return target


def build(sources: Path, target: Path) -> tuple[Path, Path]:
    """The sdist of a folder, and the wheel of that sdist."""
    done = run([sys.executable, "-m", "build", "--no-isolation", "--outdir", target, sources], target.parent)
    assert done.returncode == 0, done.stdout + done.stderr
    return next(target.glob("*.tar.gz")), next(target.glob("*.whl"))


def needed(name: str) -> dict[str, Distribution]:
    """All that an installed distribution declares to need, directly or not, without extras: name -> distribution."""
    found: dict[str, Distribution] = {}
    waiting = [name]
    while waiting:
        for line in distribution(waiting.pop()).requires or ():
            requirement = Requirement(line)
            # extras of what we need would be asked for by name here; we need none
            if requirement.name not in found and (not requirement.marker or requirement.marker.evaluate({"extra": ""})):
                found[requirement.name] = distribution(requirement.name)
                waiting.append(requirement.name)
    return found


def link(programs: Path, members: Mapping[str, Distribution]) -> None:
    """Make installed distributions visible in another environment of the same Python: as if installed, in no time."""
    site = next((programs.parent / "lib").glob("python*/site-packages"))
    for member in members.values():
        for top in {path.parts[0] for path in member.files or ()} - {"..", "__pycache__"}:
            if not (site / top).exists():  # a folder that several share is whole in the first
                (site / top).symlink_to(Path(str(member.locate_file(top))).resolve())
