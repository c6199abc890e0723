"""The wheel in empty environments: `python -m tests.packaging.empty_environments dist/*.whl`, by `make test-dist`.

For each Python that there is: a fresh environment, `pip install` of the wheel alone, and a newcomer's first steps from
another folder, the examples of README.md among them. Ends with 1 where a step went wrong.
"""

import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from time import monotonic

from tests.packaging.environments import VERSIONS, find_python, install, make_environment
from tests.packaging.first_steps import WHOLE, Taken, take, take_library


def steps_on(python: Path, wheel: Path, folder: Path) -> Iterator[Taken]:
    """All steps on one Python, the installation first."""
    began = monotonic()
    programs = make_environment(folder / "environment", python)
    install(programs, wheel)
    yield Taken("pip install tetrabench", "", monotonic() - began)
    elsewhere, cache = folder / "elsewhere", folder / "cache"
    elsewhere.mkdir()
    yield from take(WHOLE, programs, elsewhere, cache)
    yield take_library(programs, elsewhere, cache)


def main(wheel: Path) -> int:
    """Print a line a step as it is taken; returns the exit code."""
    passed, failed, missing = 0, [], []
    for version in VERSIONS:
        python = find_python(version)
        if python is None:
            missing.append(version)
            continue
        with tempfile.TemporaryDirectory() as folder:
            for taken in steps_on(python, wheel, Path(folder)):
                print(
                    f"{version}  {taken.seconds:6.1f} s  {'FAULT' if taken.fault else 'ok   '}  {taken.step}",
                    flush=True,
                )
                passed += not taken.fault
                if taken.fault:
                    failed.append(f"{version}, {taken.step}: {taken.fault}")
    print(*failed, sep="\n")
    if missing:
        print(f"not tried, for they are not on this machine: Python {', '.join(missing)}")
    print(f"{passed} passed, {len(failed)} failed")
    return int(bool(failed) or not passed)


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]).resolve()))
