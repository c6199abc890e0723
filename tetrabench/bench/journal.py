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

from tetrabench.bench.record import NO_JSON, SCHEMA, Backend, Launch, Memory, Results, Sample
from tetrabench.bench.soundness import find_fault
from tetrabench.errors import InputError
from tetrabench.printable import printable

SUFFIX = ".jsonl"
_FACTS = ("family", "profile", "tasks", "reference", "effort", "seed")
"""What must be the same in a run that is resumed; models and backends too, and of the environment:"""
_ENVIRONMENT = ("processor", "cores", "python", "numpy", "numba", "llvmlite", "tetrabench", "revision")


class _Line(msgspec.Struct, omit_defaults=True):
    """One of these: the run without what follows, or a part of it that has become known."""

    run: Results | None = None
    backend: Backend | None = None
    memory: Memory | None = None
    launch: Launch | None = None
    sample: Sample | None = None


class _Schema(msgspec.Struct, frozen=True):
    schema: str = ""


class _First(msgspec.Struct):
    """Of a first line what all versions agree on."""

    run: _Schema = _Schema()


class Journal:
    """Where a run writes down what it has done. With no file it keeps it in memory alone.

    Attributes:
        run: all that is known by now.
    """

    def __init__(self, run: Results, file: IO[bytes] | None = None) -> None:
        self.run = run
        self._file = file

    def write(self, part: Backend | Memory | Launch | Sample) -> None:
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
    with _locked(path, target), _resume(path, run) if resume else _begin(path, run) as journal:
        yield journal


@contextmanager
def _locked(path: Path, target: Path) -> Iterator[None]:
    """Nobody else writes to this journal meanwhile."""
    lock = FileLock(path.with_name(f".{path.name}.lock"))
    try:
        lock.acquire(timeout=0)
    except Timeout as error:
        raise InputError(f"{target}: another run is writing there; give this one another file") from error
    except OSError as error:
        raise _cannot_write(path, error) from error
    try:
        yield
    finally:
        with suppress(OSError):
            os.unlink(lock.lock_file)  # before it is released: nobody else has it yet
        lock.release()


@contextmanager
def _begin(path: Path, run: Results) -> Iterator[Journal]:
    try:
        file = path.open("xb")
    except FileExistsError:
        raise InputError(f"{path}: a run that was broken off; go on with it by --resume, or remove that file") from None
    except OSError as error:
        raise _cannot_write(path, error) from error
    journal = Journal(run, file)
    try:
        with _closing(file):
            journal.begin()
            yield journal
    except BaseException:
        if not (run.samples or run.memory):  # there is nothing to go on with
            path.unlink(missing_ok=True)
        raise


@contextmanager
def _resume(path: Path, run: Results) -> Iterator[Journal]:
    earlier, size = read_journal(path)
    _refuse_another(path, earlier, run)
    try:
        os.truncate(path, size)  # a line that was cut off
        file = path.open("ab")
    except OSError as error:
        raise _cannot_write(path, error) from error
    with _closing(file):
        yield Journal(earlier, file)


@contextmanager
def _closing(file: IO[bytes]) -> Iterator[None]:
    try:
        yield
    finally:
        with suppress(OSError):  # what could not be written has been told
            file.close()


def _cannot_write(path: Path, error: OSError) -> InputError:
    return InputError(f"{path}: cannot write: {error.strerror}")


def finish(target: Path | None) -> None:
    """Remove the journal of results that are saved."""
    if target is not None:
        journal_path(target).unlink(missing_ok=True)


def journal_path(target: Path) -> Path:
    """The journal's file.

    Raises:
        InputError: it would be that of the results.
    """
    if target.suffix == SUFFIX:
        raise InputError(f"{target}: in {SUFFIX} the journal of a run is written; save the results to another file")
    return target.with_suffix(SUFFIX)


def read_journal(path: Path) -> tuple[Results, int]:
    """What a journal holds that a run can go on from, and how many bytes of it that is: all lines that are whole. Of
    a thesis they end with a launch: its net has gone with its worker.

    Raises:
        InputError: there is none, or it is no journal.
    """
    try:
        data = path.read_bytes()
    except OSError as error:
        raise InputError(f"{path}: nothing to resume: {error.strerror}") from error
    texts = data.split(b"\n")[:-1]  # behind the last one is what was cut off
    lines = [_read_line(path, number, text) for number, text in enumerate(texts, 1)]
    if not lines or lines[0].run is None:
        raise InputError(f"{path}: nothing to resume: {'its first line is no run' if lines else 'no line is whole'}")
    run = lines[0].run
    if run.profile == "thesis":
        lines = lines[: max(number for number, line in enumerate(lines, 1) if line.launch or number == 1)]
    names = {one.name for one in run.backends}
    for number, line in enumerate(lines, 1):
        if line.backend and line.backend.name not in names:
            raise InputError(f"{path}:{number}: no journal of tetrabench: there is no backend {line.backend.name!r}")
        part = line.backend or line.memory or line.launch or line.sample
        if part is not None:
            run = _with(run, part)
    if fault := find_fault(run):
        raise InputError(f"{path}: this journal does not hang together: {fault}")
    return run, sum(len(text) + 1 for text in texts[: len(lines)])


def _read_line(path: Path, number: int, text: bytes) -> _Line:
    try:
        if number == 1:
            schema = msgspec.json.decode(text, type=_First).run.schema
            if schema not in ("", SCHEMA):
                raise InputError(f"{path}: schema {printable(schema[:80])}, this version goes on with {SCHEMA}")
        return msgspec.json.decode(text, type=_Line)
    except NO_JSON as error:
        raise InputError(f"{path}:{number}: no journal of tetrabench: {printable(f'{error}')}") from error


def _with(run: Results, part: Backend | Memory | Launch | Sample) -> Results:
    """A run that knows one thing more. (Its lists are its own.)"""
    match part:
        case Backend():
            run.backends[[one.name for one in run.backends].index(part.name)] = part
        case Memory():
            run.memory.append(part)
        case Launch():
            run.launches.append(part)
        case Sample():
            run.samples.append(part)
    return run


def _seat_of(backend: Backend) -> tuple[str, str, dict[str, int]]:
    """What stays the same of a backend while a run learns about it."""
    return backend.name, backend.against, backend.options


def _refuse_another(path: Path, earlier: Results, run: Results) -> None:
    """Refuse to go on with a run that was about something else."""
    differing = [name for name in _FACTS if getattr(earlier, name) != getattr(run, name)]
    differing += [name for name in _ENVIRONMENT if earlier.environment.get(name) != run.environment.get(name)]
    if [(one.name, one.digest) for one in earlier.models] != [(one.name, one.digest) for one in run.models]:
        differing.append("model")
    if list(map(_seat_of, earlier.backends)) != list(map(_seat_of, run.backends)):
        differing.append("backends")
    if differing:
        raise InputError(f"{path}: cannot go on with this run: another {', '.join(differing)}; give another file")
