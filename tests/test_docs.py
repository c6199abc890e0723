"""The documentation is true: its commands and examples run as they stand, and it leaves out no verb, option or variable."""

import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import click
import pytest
from numba import config

from tests.commands import ROOT, Command, commands_of, faults_of_usage, not_printed, run
from tetrabench.cli import main

DOCS = ROOT / "docs"
PAGES = [*sorted(DOCS.rglob("*.md"))]
BUSY = [page for page in PAGES if any(command.why_not is None for command in commands_of(page.read_text()))]
WITH_EXAMPLES = {"tutorial.md", "use-the-library.md", "write-a-plug-in.md", "collision.md"}
"""Pages whose Python runs after their commands; that of others has tests of its own, which ask more of it."""

COMPILED = pytest.mark.skipif(bool(config.DISABLE_JIT), reason="takes minutes without the JIT")


def name_of(page: Path) -> str:
    return page.relative_to(ROOT).as_posix()


def verbs(group: click.Group, path: str = "") -> Iterator[tuple[str, click.Command]]:
    """All verbs, those within verbs too, each with its whole name."""
    for name, verb in group.commands.items():
        yield f"{path}{name}", verb
        if isinstance(verb, click.Group):
            yield from verbs(verb, f"{path}{name} ")


VERBS = dict(verbs(main))


# ---- commands and examples


@COMPILED
@pytest.mark.xdist_group("docs")
@pytest.mark.parametrize("page", [p for p in PAGES if p in BUSY or p.name in WITH_EXAMPLES], ids=name_of)
def test_a_page_runs(page, tmp_path):
    text = page.read_text()
    for command in commands_of(text):
        if command.why_not is None:
            done = run(command, tmp_path)
            assert done.returncode == 0, f"{name_of(page)}, line {command.line}: {command.text}\n{done.stdout}"
            assert not_printed(command, done.stdout) == [], f"{command.text}\n{done.stdout}"
    if page.name in WITH_EXAMPLES:
        # a kernel is cached by its file, so the examples become one
        (tmp_path / "examples.py").write_text("\n".join(re.findall(r"^```python\n(.*?)^```", text, re.DOTALL | re.M)))
        done = run(Command("python -W error examples.py"), tmp_path)
        assert done.returncode == 0, done.stdout


def test_few_commands_are_not_run():
    """Each says why; and no page has commands that none of its tests knows of."""
    left_out = [c for page in PAGES for c in commands_of(page.read_text()) if c.why_not is not None]
    assert all(command.why_not for command in left_out)
    assert len(left_out) <= 40, "\n".join(f"{command.text}: {command.why_not}" for command in left_out)
    printed = sum(len(re.findall(r"^ *\$ ", page.read_text(), re.MULTILINE)) for page in PAGES)
    found = [c for page in PAGES for c in commands_of(page.read_text()) if "$REPOSITORY" not in c.text]
    prepared = sum(len(re.findall(r"<!-- before: (?!.*REPOSITORY)", page.read_text())) for page in PAGES)
    assert len(found) == printed + prepared


@pytest.mark.parametrize("page", [*PAGES, ROOT / "README.md", ROOT / "CONTRIBUTING.md"], ids=name_of)
def test_every_command_names_verbs_and_options_that_there_are(page):
    for command in commands_of(page.read_text()):
        assert faults_of_usage(command, main) == [], command.text


# ---- the runner itself


EXAMPLE = """# A page

<!-- before: echo three > number -->
Text.

```console
$ cat number  # a comment
three
$ echo one \\
  two | cat
one   two
took 3 s
```

<!-- not run: hours -->
```console
$ tetrabench run --modle x && tetrabench history ad; tetrabench list backends
```
"""


def test_commands_are_found_and_run(tmp_path):
    before, first, second, last = commands_of(EXAMPLE)
    assert [c.text for c in (before, first, second)] == [
        "echo three > number",
        "cat number  # a comment",
        "echo one two | cat",
    ]
    assert (first.shown, second.shown, last.shown) == (("three",), ("one   two", "took 3 s"), ())
    assert [c.why_not for c in (before, first, second, last)] == [None, None, None, "hours"]
    assert [c.line for c in (before, first, last)] == [3, 6, 15]
    run(before, tmp_path)
    for command in (first, second):
        printed = run(command, tmp_path).stdout
        assert not_printed(command, printed) == []
        assert not_printed(command, "two") == [" ".join(command.shown[0].split())]
    assert run(Command("false | true"), tmp_path).returncode == 1


def test_faults_of_usage_are_found():
    assert faults_of_usage(commands_of(EXAMPLE)[-1], main) == ["run has no --modle", "no verb ad"]


# ---- nothing is left out


@pytest.mark.parametrize("name", VERBS)
def test_every_verb_and_option_has_help(name):
    verb = VERBS[name]
    assert verb.help
    for option in verb.params:
        assert isinstance(option, click.Argument) or option.help, f"{name} {option.opts[0]}"


@pytest.mark.parametrize("name", VERBS)
def test_every_verb_has_its_place_in_a_page_that_shows_how(name):
    pages = [page for page in PAGES if page.parent.name not in ("reference", "explanation")]
    assert any(re.search(rf"tetrabench {name}\b", page.read_text()) for page in pages), name


def test_the_reference_of_the_command_line_is_complete(tmp_path):
    """Build that page alone, as text."""
    page = "docs/reference/command-line"
    only = [f"-Droot_doc={page}", f"-Dinclude_patterns={page}.md", "-W", "-q", "-b", "text"]
    subprocess.run([sys.executable, "-m", "sphinx", *only, "-c", str(DOCS), str(ROOT), str(tmp_path)], check=True)
    text = (tmp_path / f"{page}.txt").read_text()
    for name, verb in VERBS.items():
        section = re.search(rf"^{name.split()[-1]}\n[-=~*^]+\n(.*?)(?=^\w[\w-]*\n[-=~*^]+$|\Z)", text, re.DOTALL | re.M)
        assert section, name
        for option in verb.params:
            if isinstance(option, click.Option) and not option.hidden:
                assert re.search(rf"^\s*{option.opts[0]}\b", section[1].replace("*", ""), re.M), (
                    f"{name} {option.opts[0]}"
                )


def test_every_environment_variable_is_documented():
    """Those that are read or set anywhere in the package, and those that steer the tests."""
    files = [path for top in ("tetrabench", "backends", "scenarios") for path in (ROOT / top).rglob("*.py")]
    sources = "\n".join(path.read_text() for path in [*files, ROOT / "tests" / "conftest.py"])
    used = set(re.findall(r'"((?:TETRABENCH|NUMBA|OMP|OPENBLAS|MKL|VECLIB|SDL|PYGAME)_[A-Z_]+)"', sources))
    used |= set(re.findall(r'environ(?:\.\w+\(|\[)"(\w+)"', sources))
    assert "TETRABENCH_CACHE" in used
    page = (DOCS / "reference" / "environment.md").read_text()
    assert used - set(re.findall(r"`([A-Z_]+)`", page)) == set()
