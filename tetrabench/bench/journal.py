"""The journal of a run: what has been measured so far, a line of JSON each, on disk before the next sample begins.

It lies beside the file that the results will be saved to, `results.jsonl` for `results.json`, and goes when that is
written. A run that was killed, interrupted or out of budget leaves it, and `--resume` goes on from it: finished samples
are neither lost nor taken twice. A line that was cut off by the end is no line.
"""

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO

import msgspec
from filelock import FileLock, Timeout

from tetrabench.bench.record import SCHEMA, Backend, Launch, Memory, Model, Results, Sample
from tetrabench.errors import InputError

_FACTS = ("family", "profile", "tasks", "reference", "effort", "seed")
"""What must be the same in a run that is resumed; models and backends too, and of the environment:"""
_ENVIRONMENT = ("processor", "cores", "python", "numpy", "numba", "llvmlite", "tetrabench", "revision")


class _Line(msgspec.Struct, omit_defaults=True):
    """One of these: the run without what follows, or a part of it that has become known."""

    run: Results | None = None
    model: Model | None = None
    backend: Backend | None = None
    memory: Memory | None = None
    launch: Launch | None = None
    sample: Sample | None = None


class Journal:
    """Where a run writes down what it has done. With no file it keeps it in memory alone.

    Attributes:
        run: all that is known by now.
    """

    def __init__(self, run: Results, file: IO[bytes] | None = None) -> None:
        self.run = run
        self._file = file

    def write(self, part: Model | Backend | Memory | Launch | Sample) -> None:
        """Add a part.

        Raises:
            InputError: the disk is full, say.
        """
        self.run = _with(self.run, part)
        line = _Line()
        setattr(line, type(part).__name__.lower(), part)
        self._append(line)
        if isinstance(part, Launch) and self._file is not None:
            os.fsync(self._file.fileno())

    def begin(self) -> None:
        """Write the run's own line."""
        self._append(_Line(run=self.run))

    def _append(self, line: _Line) -> None:
        if self._file is None:
            return
        try:
            self._file.write(msgspec.json.encode(line) + b"\n")
            self._file.flush()
        except OSError as error:
            hint = "what was written before stays; with room for more, --resume goes on"
            raise InputError(f"{self._file.name}: cannot write: {error.strerror}; {hint}") from error


@contextmanager
def open_journal(run: Results, target: Path | None, *, resume: bool = False) -> Iterator[Journal]:
    """The journal of a run whose results will be saved to `target`; it is removed by `finish`.

    Raises:
        InputError: another run is writing there; there is a journal already, and `resume` was not asked for, or the
            other way round; it is of another run.
    """
    if target is None:
        yield Journal(run)
        return
    path = journal_path(target)
    lock = target.with_name(f".{target.name}.lock")
    try:
        with FileLock(lock, timeout=0), _open(path, run, resume) as journal:
            yield journal
    except Timeout as error:
        raise InputError(f"{target}: another run is writing there; give this one another file") from error
    except OSError as error:
        raise InputError(f"{path}: cannot write: {error.strerror}") from error
    with suppress(OSError):
        lock.unlink()


@contextmanager
def _open(path: Path, run: Results, resume: bool) -> Iterator[Journal]:
    if not resume:
        try:
            file = path.open("xb")
        except FileExistsError:
            raise InputError(
                f"{path}: a run that was broken off; go on with it by --resume, or remove that file"
            ) from None
        with file:
            journal = Journal(run, file)
            journal.begin()
            yield journal
        return
    earlier, size = read_journal(path)
    _refuse_another(path, earlier, run)
    os.truncate(path, size)  # a line that was cut off
    with path.open("ab") as file:
        yield Journal(earlier, file)


def finish(target: Path | None) -> None:
    """Remove the journal of results that are saved."""
    if target is not None:
        journal_path(target).unlink(missing_ok=True)


def journal_path(target: Path) -> Path:
    """The journal's file."""
    return target.with_suffix(".jsonl")


def read_journal(path: Path) -> tuple[Results, int]:
    """What a journal holds, and how many bytes of it are whole lines.

    Raises:
        InputError: there is none, or it is no journal.
    """
    try:
        data = path.read_bytes()
    except OSError as error:
        raise InputError(f"{path}: nothing to resume: {error.strerror}") from error
    size = data.rfind(b"\n") + 1
    run: Results | None = None
    for number, text in enumerate(data[:size].splitlines(), 1):
        try:
            line = msgspec.json.decode(text, type=_Line)
        except msgspec.DecodeError as error:
            raise InputError(f"{path}:{number}: no journal of tetrabench: {error}") from error
        part = line.model or line.backend or line.memory or line.launch or line.sample
        if line.run is not None:
            run = line.run
        elif run is not None and part is not None:
            run = _with(run, part)
    if run is None:
        raise InputError(f"{path}: nothing to resume: no line is whole")
    if run.schema != SCHEMA:
        raise InputError(f"{path}: schema {run.schema}, this version goes on with {SCHEMA}")
    return run, size


def _with(run: Results, part: Model | Backend | Memory | Launch | Sample) -> Results:
    """A run that knows one thing more. (Its lists are its own.)"""
    match part:
        case Model():
            _replace(run.models, part)
        case Backend():
            _replace(run.backends, part)
        case Memory():
            run.memory.append(part)
        case Launch():
            run.launches.append(part)
        case Sample():
            run.samples.append(part)
    return run


def _replace(known: list, part: Model | Backend) -> None:  # type: ignore[type-arg]
    names = [one.name for one in known]
    known[names.index(part.name)] = part


def _refuse_another(path: Path, earlier: Results, run: Results) -> None:
    """Refuse to go on with a run that was about something else."""
    differing = [name for name in _FACTS if getattr(earlier, name) != getattr(run, name)]
    differing += [name for name in _ENVIRONMENT if earlier.environment.get(name) != run.environment.get(name)]
    if [(one.name, one.digest) for one in earlier.models] != [(one.name, one.digest) for one in run.models]:
        differing.append("model")
    if [(one.name, one.against) for one in earlier.backends] != [(one.name, one.against) for one in run.backends]:
        differing.append("backends")
    if differing:
        raise InputError(f"{path}: cannot go on with this run: another {', '.join(differing)}; give another file")
