"""The oldest and the newest dependencies: `python -m tests.packaging.versions dist/*.tar.gz`, by `make test-versions`.

The sdist is unpacked and installed twice, with the lower bounds of pyproject.toml on the oldest Python that we take, and
with the newest of everything on the newest Python of this machine; a part of its own suite runs in each. Ends with 1
where a test failed.
"""

import subprocess
import sys
import tarfile
import tempfile
from pathlib import Path

from tests.packaging.environments import VERSIONS, find_python, install, make_environment
from tests.packaging.lowest import EXTRAS, constraints

PART = [f"tests/{name}" for name in ("test_cli.py", "test_cli_mesh.py", "io", "mesh", "report", "tetra/test_net.py")]
PART += [f"tests/bench/test_{name}.py" for name in ("plan", "record", "registry", "results_files", "statistics")]
"""What meets every dependency, and takes some minutes."""


def try_with(python: Path, sdist: Path, folder: Path, *, lowest: bool) -> int:
    """Run the part in an environment of its own; returns pytest's exit code."""
    with tarfile.open(sdist) as archive:
        archive.extractall(folder, filter="data")
    sources = next(path for path in folder.iterdir() if path.is_dir())
    (folder / "constraints.txt").write_text("\n".join(constraints(sources / "pyproject.toml")) if lowest else "")
    programs = make_environment(folder / "environment", python)
    extras = ",".join((*EXTRAS, "test"))
    install(programs, "--constraint", folder / "constraints.txt", "--editable", f"{sources}[{extras}]")
    pytest = [programs / "python", "-m", "pytest", "-q", "-n", "auto", "--dist", "loadgroup", *PART]
    if lowest:
        pytest += ["-W", "default"]  # that old versions use what newer ones of others deprecate is not ours to mend
    return subprocess.run([str(word) for word in pytest], cwd=sources).returncode


def main(sdist: Path) -> int:
    """Returns the exit code."""
    there = [(version, python) for version in VERSIONS if (python := find_python(version))]
    worst = 0
    for (version, python), lowest in ((there[0], True), (there[-1], False)):
        print(f"Python {version}, {'lower bounds' if lowest else 'newest'} of all dependencies", flush=True)
        with tempfile.TemporaryDirectory() as folder:
            worst = max(worst, try_with(python, sdist, Path(folder), lowest=lowest))
    return int(bool(worst))


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]).resolve()))
