"""The lower bounds of pyproject.toml as constraints for pip: `python -m tests.packaging.lowest > constraints.txt`.

Of what a person installs: the dependencies, and the extras that verbs ask for. Tools of tests may be as new as they are.
"""

import sys
import tomllib
from pathlib import Path

from packaging.requirements import Requirement

EXTRAS = ("formats", "report", "watch")


def constraints(pyproject: Path) -> list[str]:
    """A line `name==version` for each requirement.

    Raises:
        ValueError: one has no lower bound.
    """
    project = tomllib.loads(pyproject.read_text())["project"]
    lines = list(project["dependencies"])
    for extra in EXTRAS:
        lines += project.get("optional-dependencies", {}).get(extra, ())
    return sorted({_lowest(Requirement(line)) for line in lines})


def _lowest(requirement: Requirement) -> str:
    bounds = [bound.version for bound in requirement.specifier if bound.operator == ">="]
    if len(bounds) != 1:
        raise ValueError(f"{requirement}: pyproject.toml has to say from which version on it is known to work")
    return f"{requirement.name}=={bounds[0]}"


if __name__ == "__main__":
    print("\n".join(constraints(Path(sys.argv[1] if len(sys.argv) > 1 else "pyproject.toml"))))
