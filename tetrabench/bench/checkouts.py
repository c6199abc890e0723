"""Revisions of a git repository, each installed into a folder of its own that a worker can import first.

Nothing is written into the repository or its index: a revision is taken out with `git archive`, the working tree is
copied. What a revision depends on is shared with the running environment, so that only its own code differs.
"""

import os
import re
import shutil
import subprocess
import sys
import tarfile
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.metadata import distributions
from pathlib import Path

import msgspec

from tetrabench.bench.catalogue import Guide, Inquiry
from tetrabench.bench.messages import PROTOCOL
from tetrabench.bench.spawn import WorkerProcess
from tetrabench.errors import InputError, NotComparableError
from tetrabench.folders import cache_root

WORKING_TREE = "working tree"


class Checkout(msgspec.Struct, frozen=True, kw_only=True):
    """A revision that is installed.

    Attributes:
        revision: as it was asked for, or WORKING_TREE; commit: 40 hexadecimal digits, with a "+" where files were
            changed since.
        folder: of its packages, with their metadata.
        requirements: what it declares to depend on.
    """

    revision: str
    commit: str
    folder: Path
    requirements: list[str] = []

    @property
    def title(self) -> str:
        """For people: how it was called, and its commit."""
        short = self.commit[:10] + "+" * self.commit.endswith("+")
        return short if self.commit.startswith(self.revision) else f"{self.revision} ({short})"


def find_repository(folder: Path) -> Path:
    """The top folder of the git checkout that a folder lies in.

    Raises:
        InputError: it lies in none, or git is missing or refuses it.
    """
    try:
        return Path(_git(folder, "rev-parse", "--show-toplevel"))
    except InputError as error:
        raise InputError(f"{error}; the gate runs in a git checkout of the code") from error


def find_commit(repository: Path, revision: str) -> str:
    """The commit that a revision, such as HEAD~1 or origin/main, stands for.

    Raises:
        InputError: there is none.
    """
    try:
        return _git(repository, "rev-parse", "--verify", "--quiet", "--end-of-options", f"{revision}^{{commit}}")
    except InputError:
        advice = "git fetch brings what is only in another repository, with --unshallow where the clone has no history"
        raise InputError(f"no revision '{revision}' in {repository.name}; {advice}") from None


def is_clean(repository: Path) -> bool:
    """Whether the working tree is what was committed last; files that git ignores do not count."""
    return not _git(repository, "status", "--porcelain")


def check_out(repository: Path, revision: str | None, scratch: Path) -> Checkout:
    """Install a revision.

    A commit is kept in the cache folder of the user, and installed once; a changed working tree lasts as long as
    `scratch` does.

    Args:
        repository: top folder of a git checkout.
        revision: None: the working tree as it is, with changes that are not committed, without what git ignores.
        scratch: an existing folder for what does not last.

    Raises:
        InputError: no such revision.
        NotComparableError: it cannot be installed, or has nothing to run.
    """
    commit = find_commit(repository, revision or "HEAD")
    name = revision or WORKING_TREE
    if revision is None and not is_clean(repository):
        source, folder = scratch / "tree", scratch / "tree-installed"
        _copy_tree(repository, source)
        _install(source, folder, name)
        return _describe(name, commit + "+", folder)
    kept = _cache() / commit
    if not kept.is_dir():
        source, folder = scratch / commit, scratch / f"{commit}-installed"
        if not source.is_dir():
            _take_out(repository, commit, source)
            _install(source, folder, name)
        kept = _keep(folder, kept)
    return _describe(name, commit, kept)


@contextmanager
def guide_of(checkout: Checkout) -> Iterator[Guide]:
    """Who knows what a checkout has to offer: a worker of it."""
    with Inquiry(lambda: WorkerProcess(checkout=checkout.folder)) as guide:
        yield guide


def _cache() -> Path:
    return cache_root() / "checkouts" / f"python{sys.version_info.major}.{sys.version_info.minor}"


def _take_out(repository: Path, commit: str, folder: Path) -> None:
    """The files of a commit.

    Raises:
        InputError: there are none, or git cannot read them.
    """
    command = ["git", "-C", str(repository), "archive", "--format=tar", commit]
    with subprocess.Popen(command, stdout=subprocess.PIPE) as git:
        assert git.stdout is not None
        try:
            with tarfile.open(fileobj=git.stdout, mode="r|") as archive:
                archive.extractall(folder, filter="data")
        except tarfile.TarError as error:
            raise InputError(f"commit {commit[:10]} has no files, or git cannot read them: {error}") from error


def _copy_tree(repository: Path, folder: Path) -> None:
    """The files of the working tree: those that git knows, and those that it would add."""
    names = _git(repository, "ls-files", "-z", "--cached", "--others", "--exclude-standard").split("\0")
    for name in filter(None, dict.fromkeys(names)):
        source, target = repository / name, folder / name
        if source.is_symlink() or source.is_file():  # else it was deleted, or is another repository
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(source, target, follow_symlinks=False)


def _install(source: Path, folder: Path, name: str) -> None:
    """Install what lies in `source` into a folder of its own, without what it depends on.

    Raises:
        NotComparableError: that does not work.
    """
    pip = [sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", "--disable-pip-version-check"]
    for more in (["--no-build-isolation"], []):  # pip only has to fetch what builds it where that is missing or too old
        command = [*pip, *more, "--target", str(folder), str(source)]
        done = subprocess.run(command, capture_output=True, text=True, stdin=subprocess.DEVNULL)
        if done.returncode == 0:
            return
    raise NotComparableError(f"{name} cannot be installed: {_reason(done.stderr)}")


def _keep(folder: Path, kept: Path) -> Path:
    """Move a folder to where it is kept, whole or not at all; where that cannot be written to, it stays."""
    staging = kept.with_name(f".{kept.name}.{os.getpid()}")
    try:
        kept.parent.mkdir(parents=True, exist_ok=True)
        shutil.copytree(folder, staging)
        staging.rename(kept)
    except OSError:
        return kept if kept.is_dir() else folder  # another gate was as fast
    finally:
        shutil.rmtree(staging, ignore_errors=True)
    return kept


def _describe(revision: str, commit: str, folder: Path) -> Checkout:
    """What its metadata say.

    Raises:
        NotComparableError: it is neither tetrabench nor a plug-in of it.
    """
    found = list(distributions(path=[str(folder)]))
    if not any(entry.group.startswith("tetrabench.") for one in found for entry in one.entry_points):
        raise NotComparableError(
            f"{revision} has no contestants: it is neither tetrabench nor a plug-in of it, or too old"
        )
    _refuse_foreign_protocol(folder, revision)
    asked = {line for one in found for line in one.requires or [] if not re.search(r"extra\s*==", line)}
    return Checkout(revision=revision, commit=commit, folder=folder, requirements=sorted(asked))


def _refuse_foreign_protocol(folder: Path, revision: str) -> None:
    """Refuse a tetrabench whose workers the running one does not understand, before one of them is started.

    Raises:
        NotComparableError: it is one.
    """
    if not (folder / "tetrabench").is_dir():  # a plug-in, which runs in the tetrabench that is installed here
        return
    messages = folder / "tetrabench/bench/messages.py"
    found = re.search(r"^PROTOCOL = (\d+)$", messages.read_text() if messages.is_file() else "", re.MULTILINE)
    if found is None:
        raise NotComparableError(f"{revision} is too old to be compared: it is from before there was a gate")
    if int(found[1]) != PROTOCOL:
        age = "old" if int(found[1]) < PROTOCOL else "new"
        raise NotComparableError(
            f"{revision} is too {age} to be compared: its workers speak protocol {found[1]}, this version {PROTOCOL}"
        )


def _git(folder: Path, *arguments: str) -> str:
    """What git says.

    Raises:
        InputError: it complains.
    """
    command = ["git", "-C", str(folder), *arguments]
    try:
        done = subprocess.run(command, capture_output=True, text=True, env={**os.environ, "LC_ALL": "C"})
    except FileNotFoundError as error:
        raise InputError("git is not installed, and the gate takes both versions from a git repository") from error
    if done.returncode:
        raise InputError(f"{folder.absolute().name}: {_reason(done.stderr).removeprefix('fatal: ')}")
    return done.stdout.removesuffix("\n")


def _reason(text: str) -> str:
    """The line of a program's complaints that says most: its first error, or the last line."""
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    errors = [
        line for line in lines if re.match(r"error: (?![a-z]+(-[a-z]+)+$)", line, re.IGNORECASE)
    ]  # no pip's class
    return (errors or lines[-1:] or ["it does not say why"])[0]
