"""README.md says what is true: its table is that of the committed run, and its examples run."""

import json
import re
import sys
from pathlib import Path

import pytest
from numba import config

from tests.commands import commands_of, run
from tetrabench.io import write_mesh
from tetrabench.mesh.models import generate

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text()


sys.path.insert(0, str(ROOT / "results"))
import regenerate  # noqa: E402

sys.path.pop(0)


@pytest.mark.parametrize("block", regenerate.BLOCKS)
def test_pages_show_what_the_committed_runs_say(block):
    _, make = regenerate.BLOCKS[block]
    assert regenerate.shown(block) == make().strip()


@pytest.mark.parametrize("page", regenerate.SOURCES)
def test_the_page_about_the_source_is_that_of_the_committed_runs(tmp_path, page):
    files = [regenerate.file_of(name) for name in regenerate.SOURCES[page][1]]
    regenerate.tetrabench("report", *files, "--thesis", "-o", str(tmp_path / f"{page}.md"))
    assert (tmp_path / f"{page}.md").read_text() == (ROOT / "results" / f"{page}.md").read_text()


def test_an_unknown_run_is_refused(monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["regenerate.py", "thesis-nozle"])
    with pytest.raises(SystemExit):
        regenerate.main()
    assert "no run thesis-nozle; there are: nozzle-120k-quick, " in capsys.readouterr().err
    assert not (regenerate.RESULTS / "thesis-nozle").exists()


def test_the_peers_are_those_of_the_committed_run():
    page = (ROOT / "results" / "README.md").read_text()
    for row in json.loads((ROOT / "results" / "peers-623k.json").read_text())["rows"]:
        times = f"{1e3 * row['ours_s']:.1f} | {1e3 * row['peer_s']:.1f} | {row['ratio']:.3f}"
        interval = f"[{row['low']:.3f}, {row['high']:.3f}]"
        assert f"| {row['operation']} | {row['numbering']} | {row['peer']} | {times} | {interval} |" in page


PAGES = [ROOT / "README.md", *(ROOT / "results").glob("*.md"), *(ROOT / "docs").rglob("*.md")]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: f"{page.parent.name}/{page.name}")
def test_pictures_and_files_are_there(page):
    for target in re.findall(r"\]\(([^)#:]*)\)", page.read_text()):
        assert (page.parent / target).exists(), target


@pytest.mark.skipif(bool(config.DISABLE_JIT), reason="takes hours without the JIT")
@pytest.mark.xdist_group("docs")
def test_the_commands_run_as_they_are_printed(tmp_path):
    asked = commands_of(README)
    assert [command.text.split()[0] for command in asked if command.why_not] == ["make", "make"]
    for command in asked:
        if not command.why_not:
            done = run(command, tmp_path)
            assert done.returncode == 0, f"{command.text}\n{done.stdout}"


@pytest.mark.skipif(bool(config.DISABLE_JIT), reason="compiled examples")
def test_the_examples_run(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    write_mesh(generate("nozzle", 5000), tmp_path / "nozzle.nas")
    # a kernel is cached by its file, so the examples become one
    (tmp_path / "readme_examples.py").write_text("\n".join(re.findall(r"```python\n(.*?)```", README, re.DOTALL)))
    monkeypatch.syspath_prepend(tmp_path)
    import readme_examples as examples

    assert examples.inside[0] >= 0
    assert examples.inside[1] == -1
    assert capsys.readouterr().out.startswith("0.")
    assert examples.largest_volume(examples.net.storage) == examples.net.volumes.max()


def test_the_table_of_contestants():
    """The two axes, as README shows them, are those of the code."""
    from tetrabench.backends.tetra import CONTESTANTS

    rows = [line.split("|") for line in README.splitlines() if line.startswith(("| **", "| |"))]
    policies = [cell.strip() for cell in rows[0][2:-1]]
    shown = {
        cell.strip(): (row[1].split("**")[1], policy)
        for row in rows[1:]
        for cell, policy in zip(row[2:-1], policies, strict=True)
        if cell.strip()
    }
    assert shown == {c.name: (c.layout, c.slots) for c in CONTESTANTS}
