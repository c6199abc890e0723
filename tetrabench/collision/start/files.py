"""Files of objects: .npz, our own, all bits of a start; .csv, for people and other programs, all bits of the objects.

A .csv file has a line of names and a line for each object. Columns are x, y, vx, vy, r, m in any order; those but x and y
may be left out. Lines that are empty, or begin with #, are left out; the first one may say how large the box is:

    # box 1200 800
    x,y,vx,vy,r,m
    20.5,30,-0.5,1,10,5

Else the box is as large as what the circles reach from the origin.
"""

import contextlib
import itertools
import math
import os
import warnings
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from tetrabench.archive import open_archive
from tetrabench.collision.objects import Floats, Objects, Start, check_box, make_objects
from tetrabench.collision.start.models import MASS, MODELS, RADIUS
from tetrabench.drafts import drafted
from tetrabench.errors import InputError, MemoryRefusedError
from tetrabench.io import is_file, known_suffix
from tetrabench.memory import refuse_if_too_large

EXACT, TABLE = ".npz", ".csv"
DEFAULTS = {"vx": 0.0, "vy": 0.0, "r": RADIUS, "m": MASS}
BOX, SOURCE = "box", "source"
TABLE_ROOM = 200  # bytes of memory for each line: measured, rounded up


def read_objects(path: str | os.PathLike[str]) -> Start:
    """Read a start in the format of its suffix.

    Raises:
        InputError: an unknown suffix, no such file, or what is wrong with it, as `path:line: reason`;
            `MemoryRefusedError` where there is not enough memory to read it.
    """
    suffix, file = check_objects_source(path), Path(path)
    if not is_file(file):
        hint = f"; make it with: tetrabench generate {file.stem} -o {file.name}" if file.stem in MODELS else ""
        raise InputError(f"{path}: there is no such file{hint}")
    try:
        return read_exact(file) if suffix == EXACT else read_table(file)
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror or error}") from error


def write_objects(start: Start, path: str | os.PathLike[str]) -> None:
    """Write a start in the format of the suffix: a whole file, or none. The same start gives the same file, byte for byte.

    Args:
        start: what to write; .csv has no room for the words in `source`.
        path: the file; one that exists is replaced.

    Raises:
        InputError: an unknown suffix, or a place that cannot be written to.
    """
    write = write_exact if check_objects_target(path) == EXACT else write_table
    with drafted(path) as draft:
        write(start, draft)


def check_objects_source(path: str | os.PathLike[str]) -> str:
    """Return the suffix of a file in small letters, if objects may be read from it.

    Raises:
        InputError: an unknown suffix.
    """
    return known_suffix(path, (EXACT, TABLE))


def check_objects_target(path: str | os.PathLike[str]) -> str:
    """Return the suffix of a file that objects may be written to: to be asked before the work, not after it.

    Raises:
        InputError: an unknown suffix.
    """
    suffix = Path(path).suffix.lower()
    if suffix not in (EXACT, TABLE):
        raise InputError(f"{path}: objects are written as {EXACT} and {TABLE} files, not as {suffix!r}")
    return suffix


def holds_objects(path: str | os.PathLike[str]) -> bool:
    """Whether a file holds objects, as far as its suffix says; of .npz, which meshes are kept in, too, by what is in it."""
    suffix = Path(path).suffix.lower()
    if suffix == EXACT:
        try:
            with open(path, "rb") as file, open_archive(Path(path), file) as archive:
                return {*Objects._fields, BOX} <= {*archive.files}
        except Exception:  # no file, or damaged: whoever reads it says so
            return False
    return suffix == TABLE


# ---------------------------------------------------------------------- .npz


def read_exact(path: Path) -> Start:
    """Read what `write_exact` wrote; sums in the file tell damage."""
    try:
        with path.open("rb") as file, open_archive(path, file) as archive:
            is_other = not {*Objects._fields, BOX, SOURCE} <= {*archive.files}
            if not is_other:
                columns = [archive[name] for name in Objects._fields]
                width, height = map(float, archive[BOX])
                source = archive[SOURCE].tobytes().decode(errors="surrogateescape")
    except (OSError, MemoryRefusedError):
        raise
    except Exception as error:  # numpy and zipfile raise anything
        raise InputError(f"{path}: damaged, or not objects as tetrabench writes them; make it again") from error
    if is_other:
        raise InputError(f"{path}: holds no objects as tetrabench writes them; other programs can write {TABLE}")
    with told_of(path):
        check_box(width, height)
        return Start(make_objects(*columns), width, height, source)


def write_exact(start: Start, path: Path) -> None:
    """The arrays of the objects by their names, the box, and the words."""
    words = np.frombuffer(start.source.encode(errors="surrogateescape"), np.uint8)
    arrays: dict[str, Any] = {**start.objects._asdict(), BOX: np.array([start.width, start.height]), SOURCE: words}
    with path.open("wb") as file:
        np.savez(file, **arrays)


# ---------------------------------------------------------------------- .csv


def read_table(path: Path) -> Start:
    """Read a table of numbers, whoever wrote it."""
    with path.open("rb") as file:
        refuse_if_too_large(f"reading {path}", TABLE_ROOM * sum(1 for _ in file))
    box = read_box(path)
    line, names = read_names(path)
    try:
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", "loadtxt: input contained no data")
            table = np.loadtxt(path, delimiter=",", skiprows=line, ndmin=2, encoding="utf-8")
        table = table if table.size else np.empty((0, len(names)))
        columns: dict[str, Any] = {**DEFAULTS, **dict(zip(names, table.T, strict=True))}
        objects = make_objects(**columns)
    except (InputError, ValueError) as error:
        raise InputError(find_fault(path, names) or f"{path}: {error}") from error
    if box is None:
        box = reach(objects.x, objects.r), reach(objects.y, objects.r)
        if not len(objects.x):
            raise InputError(f"{path}: holds no objects; a box without any is # box WIDTH HEIGHT in the first line")
        if min(box) <= 0:
            raise InputError(
                f"{path}: no object is where x and y are above 0; say in the first line: # box WIDTH HEIGHT"
            )
    with told_of(path):
        check_box(*box)
    return Start(objects, *box, source=str(path))


def read_box(path: Path) -> tuple[float, float] | None:
    """What the first line says of the box, None where it says nothing."""
    with path.open(encoding="utf-8-sig", errors="replace") as file:
        before, _, words = file.readline().partition("#")
    if before.strip() or words.split()[:1] != [BOX]:
        return None
    try:
        width, height = map(float, words.split()[1:])
    except ValueError as error:
        raise InputError(f"{path}:1: a box is written as # box WIDTH HEIGHT, in numbers") from error
    return width, height


def read_names(path: Path) -> tuple[int, list[str]]:
    """The line of names, counted from 1, and the columns that it names."""
    line, names = next(rows_of(path), (0, []))
    if not names:
        raise InputError(f"{path}: holds no line of names, such as {','.join(Objects._fields)}")
    known = ", ".join(Objects._fields)
    for name in names:
        if name not in Objects._fields:
            raise InputError(f"{path}:{line}: {name!r} is no column; this line names the columns, by commas: {known}")
        if names.count(name) > 1:
            raise InputError(f"{path}:{line}: {name!r} stands there twice; columns are {known}, each once")
    for name in Objects._fields:
        if name not in names and name not in DEFAULTS:
            raise InputError(f"{path}:{line}: there is no column {name}")
    return line, names


def rows_of(path: Path) -> Iterator[tuple[int, list[str]]]:
    """The lines with something in them: their numbers, counted from 1, and their words."""
    with path.open(encoding="utf-8-sig", errors="replace") as file:
        for line, text in enumerate(file, 1):
            if held := text.partition("#")[0].strip():
                yield line, [word.strip() for word in held.split(",")]


def find_fault(path: Path, names: Sequence[str]) -> str | None:
    """Say what is wrong with the first object that cannot be taken; None where nothing is found."""
    for line, words in itertools.islice(rows_of(path), 1, None):
        if len(words) != len(names):
            return f"{path}:{line}: {len(words)} values, and the columns are {', '.join(names)}"
        for name, word in zip(names, words, strict=True):
            try:
                number = float(word)
            except ValueError:
                number = math.nan
            if not math.isfinite(number) or (name in ("r", "m") and number <= 0):
                demand = "a finite number above 0" if name in ("r", "m") else "a finite number"
                return f"{path}:{line}: {name} has to be {demand}, {f'not {word!r}' if word else 'and there is none'}"
    return None


def reach(centre: Floats, r: Floats) -> float:
    """How far circles reach along an axis; 0 where there is none."""
    with np.errstate(over="ignore"):  # infinite is no box
        return float(np.max(centre + r, initial=0.0))


def write_table(start: Start, path: Path) -> None:
    """As few digits as tell a number from all others."""
    with path.open("w", encoding="utf-8", newline="\n") as file:
        file.write(f"# {BOX} {float(start.width)!r} {float(start.height)!r}\n")
        file.write(",".join(Objects._fields) + "\n")
        columns = (column.tolist() for column in start.objects)
        file.writelines(",".join(map(repr, row)) + "\n" for row in zip(*columns, strict=True))


@contextlib.contextmanager
def told_of(path: Path) -> Iterator[None]:
    """Put the name of the file before what is refused."""
    try:
        yield
    except InputError as error:
        raise InputError(f"{path}: {error}") from error
