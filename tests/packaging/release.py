"""Is a tag a release? `python -m tests.packaging.release v0.1.0` prints its notes, or says what does not agree."""

import re
import sys
import tomllib

from tests.packaging.environments import ROOT


def notes_of(tag: str, project: str, changelog: str) -> str:
    """What CHANGELOG.md says of the release.

    Raises:
        ValueError: the version in pyproject.toml is another one, or CHANGELOG.md has nothing of it.
    """
    version = tomllib.loads(project)["project"]["version"]
    if tag != f"v{version}":
        raise ValueError(f"the tag is {tag}, and pyproject.toml says {version}")
    section = re.search(rf"^## {re.escape(version)}\b[^\n]*\n(.*?)(?=^## |\Z)", changelog, re.DOTALL | re.MULTILINE)
    if section is None or not section[1].strip():
        raise ValueError(f"CHANGELOG.md says nothing of {version}")
    return section[1].strip()


if __name__ == "__main__":
    try:
        print(notes_of(sys.argv[1], (ROOT / "pyproject.toml").read_text(), (ROOT / "CHANGELOG.md").read_text()))
    except ValueError as error:
        sys.exit(f"{error}; .github/RELEASING.md has the steps of a release")
