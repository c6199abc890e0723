"""What is installed: every file is in the wheel, and the wheel runs in an environment of its own."""

import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    folder = tmp_path_factory.mktemp("wheel")
    command = [
        sys.executable,
        "-m",
        "pip",
        "wheel",
        "--quiet",
        "--no-deps",
        "--no-build-isolation",
        "-w",
        folder,
        ROOT,
    ]
    subprocess.run([str(word) for word in command], check=True, capture_output=True, cwd=folder)
    return next(folder.glob("*.whl"))


def test_every_file_is_in_the_wheel(wheel):
    here = {
        f"tetrabench/{path.relative_to(ROOT)}"
        for top in ("backends", "scenarios")
        for path in (ROOT / top).rglob("*.*")
    }
    here |= {str(path.relative_to(ROOT)) for path in (ROOT / "tetrabench").rglob("*.*")}
    here = {name for name in here if "__pycache__" not in name}
    with zipfile.ZipFile(wheel) as archive:
        there = {name for name in archive.namelist() if ".dist-info/" not in name}
    assert there == here


def test_the_wheel_runs_without_the_checkout(wheel, tmp_path):
    target = tmp_path / "installed"
    command = [sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", "--target", target, wheel]
    subprocess.run([str(word) for word in command], check=True, capture_output=True)
    code = (
        f"import sys; sys.path.insert(0, {str(target)!r});"
        "sys.meta_path[:] = [finder for finder in sys.meta_path if 'editable' not in repr(finder)];"
        "import tetrabench, tetrabench.backends.tetra as b, tetrabench.scenarios.tetra as s;"
        "print(tetrabench.__file__, b.__file__, s.__file__)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=tmp_path, check=True)
    assert all(Path(file).is_relative_to(target) for file in done.stdout.split())
