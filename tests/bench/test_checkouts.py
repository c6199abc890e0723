"""Revisions out of real git repositories: what is installed, kept, refused, and left behind (nothing)."""

import shutil
import subprocess
from pathlib import Path

import pytest

from tetrabench.bench import checkouts
from tetrabench.bench.checkouts import check_out, find_commit, find_repository, is_clean
from tetrabench.bench.messages import PROTOCOL
from tetrabench.errors import InputError, NotComparableError

PYPROJECT = """
[build-system]
requires = ["setuptools"]
build-backend = "setuptools.build_meta"
[project]
name = "plugin"
version = "1"
dependencies = ["numpy", "pytest; extra == 'dev'"]
[project.entry-points."tetrabench.contestants"]
scripted = "plugin:CONTESTANTS"
[tool.setuptools]
py-modules = ["plugin"]
"""


def git(folder: Path, *words: str) -> str:
    identity = ["-c", "user.name=somebody", "-c", "user.email=somebody"]
    done = subprocess.run(["git", "-C", folder, *identity, *words], check=True, capture_output=True, text=True)
    return done.stdout.strip()


def commit(folder: Path, message: str = "a change", **files: str) -> str:
    for name, text in files.items():
        (folder / name.replace("_", ".")).write_text(text)
    git(folder, "add", "--all")
    git(folder, "commit", "--quiet", "--message", message)
    return git(folder, "rev-parse", "HEAD")


@pytest.fixture
def repository(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A plug-in in its second version; nothing is kept from elsewhere."""
    monkeypatch.setenv("TETRABENCH_CACHE", str(tmp_path / "cache"))
    folder = tmp_path / "repository"
    folder.mkdir()
    git(folder, "init", "--quiet")
    commit(folder, pyproject_toml=PYPROJECT, plugin_py="VERSION = 1\n", _gitignore="*.log\n")
    commit(folder, plugin_py="VERSION = 2\n")
    return folder


@pytest.fixture
def scratch(tmp_path: Path) -> Path:
    (tmp_path / "scratch").mkdir()
    return tmp_path / "scratch"


@pytest.fixture
def copied(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """pip takes seconds: a copy with metadata in its place; names of what was installed."""
    names = []

    def install(source: Path, folder: Path, name: str) -> None:
        names.append(name)
        shutil.copytree(source, folder)
        metadata = folder / "plugin-1.dist-info"
        metadata.mkdir()
        (metadata / "METADATA").write_text("Metadata-Version: 2.1\nName: plugin\nVersion: 1\n")
        (metadata / "entry_points.txt").write_text("[tetrabench.contestants]\nscripted = plugin:CONTESTANTS\n")

    monkeypatch.setattr(checkouts, "_install", install)
    return names


def version(folder: Path) -> str:
    return (folder / "plugin.py").read_text().strip()


def test_a_commit_is_installed_with_its_metadata_and_kept(repository, scratch):
    before = sorted(repository.iterdir())
    found = check_out(repository, "HEAD~1", scratch)
    assert version(found.folder) == "VERSION = 1"
    assert found.commit == git(repository, "rev-parse", "HEAD~1")
    assert found.requirements == ["numpy"]
    assert not found.folder.is_relative_to(scratch)
    assert found.title == f"HEAD~1 ({found.commit[:10]})"
    assert sorted(repository.iterdir()) == before
    assert is_clean(repository)
    assert git(repository, "worktree", "list").count("\n") == 0


def test_a_commit_is_installed_once(repository, scratch, copied):
    first = check_out(repository, "HEAD~1", scratch)
    assert check_out(repository, first.commit, scratch).folder == first.folder
    assert check_out(repository, None, scratch).folder != first.folder  # a clean tree is its commit
    assert check_out(repository, "HEAD", scratch).commit == check_out(repository, None, scratch).commit
    assert len(copied) == 2


def test_a_changed_tree_is_taken_as_it_is_and_not_kept(repository, scratch, copied):
    (repository / "plugin.py").write_text("VERSION = 3\n")
    (repository / "more.py").write_text("")
    (repository / "some.log").write_text("")
    (repository / "link.py").symlink_to("plugin.py")
    found = check_out(repository, None, scratch)
    assert version(found.folder) == "VERSION = 3"
    assert (found.folder / "more.py").exists()
    assert (found.folder / "link.py").exists()
    assert not (found.folder / "some.log").exists()
    assert found.folder.is_relative_to(scratch)
    assert found.commit == git(repository, "rev-parse", "HEAD") + "+"
    assert found.title == f"working tree ({found.commit[:10]}+)"
    assert version(check_out(repository, "HEAD", scratch).folder) == "VERSION = 2"


def test_a_deleted_file_is_gone(repository, scratch, copied):
    commit(repository, more_py="")
    (repository / "more.py").unlink()
    assert not (check_out(repository, None, scratch).folder / "more.py").exists()


def test_a_cache_that_cannot_be_written_to_is_no_hindrance(repository, scratch, copied, tmp_path):
    (tmp_path / "cache").write_text("a file in its place")
    assert check_out(repository, "HEAD", scratch).folder.is_relative_to(scratch)


def test_what_was_half_kept_is_not_taken_for_whole(repository, scratch, copied, monkeypatch):
    def break_off(source, target):
        target.mkdir()
        raise KeyboardInterrupt

    source = checkouts.shutil.copytree
    copies = iter([source, break_off])  # the first is the installation
    monkeypatch.setattr(checkouts.shutil, "copytree", lambda *folders: next(copies)(*folders))
    with pytest.raises(KeyboardInterrupt):
        check_out(repository, "HEAD", scratch)
    assert not list(checkouts._cache().glob("*"))


def test_a_revision_that_is_not_there(repository, scratch):
    with pytest.raises(InputError, match="no revision 'nonsense' in repository; git fetch") as refused:
        check_out(repository, "nonsense", scratch)
    assert refused.value.exit_code == 2
    with pytest.raises(InputError, match="no revision '--all'"):
        find_commit(repository, "--all")


def test_a_folder_that_is_no_repository(tmp_path, repository):
    (tmp_path / "plain").mkdir()
    with pytest.raises(InputError, match="plain: not a git repository"):
        find_repository(tmp_path / "plain")
    (repository / "deep").mkdir()
    assert find_repository(repository / "deep").samefile(repository)


def test_git_is_missing(repository, monkeypatch):
    monkeypatch.setenv("PATH", "")
    with pytest.raises(InputError, match="git is not installed"):
        find_repository(repository)


def test_a_commit_without_files(tmp_path, scratch):
    git(tmp_path, "init", "--quiet", "empty")
    git(tmp_path / "empty", "commit", "--quiet", "--allow-empty", "--message", "nothing")
    with pytest.raises(InputError, match="has no files"):
        check_out(tmp_path / "empty", "HEAD", scratch)


def test_what_cannot_be_installed_is_5(repository, scratch):
    (repository / "pyproject.toml").unlink()
    commit(repository)
    with pytest.raises(NotComparableError, match=r"HEAD cannot be installed: .*pyproject\.toml") as refused:
        check_out(repository, "HEAD", scratch)
    assert "\n" not in str(refused.value)
    assert refused.value.exit_code == 5
    assert not checkouts._cache().exists()


def test_what_has_no_contestants_is_5(repository, scratch):
    commit(repository, pyproject_toml=PYPROJECT.replace("tetrabench.contestants", "other.things"))
    with pytest.raises(NotComparableError, match="neither tetrabench nor a plug-in"):
        check_out(repository, "HEAD", scratch)


@pytest.mark.parametrize(
    ("messages", "said"),
    [
        ("", "is too old to be compared: it is from before there was a gate"),
        (f"PROTOCOL = {PROTOCOL - 1}\n", f"is too old to be compared: its workers speak protocol {PROTOCOL - 1}"),
        (f"import x\nPROTOCOL = {PROTOCOL + 1}\n", "is too new to be compared"),
        (f"PROTOCOL = {PROTOCOL}\n", ""),
    ],
)
def test_a_tetrabench_of_another_protocol_is_5(repository, scratch, copied, messages, said):
    (repository / "tetrabench/bench").mkdir(parents=True)
    (repository / "tetrabench/bench/messages.py").write_text(messages)
    commit(repository)
    if said:
        with pytest.raises(NotComparableError, match=said):
            check_out(repository, "HEAD", scratch)
    else:
        check_out(repository, "HEAD", scratch)
