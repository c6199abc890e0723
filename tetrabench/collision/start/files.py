"""Files of objects: .npz, our own, all bits of a start; .csv, for people and other programs, all bits of the objects.

A .csv file has a line of names and a line for each object. Columns are x, y, vx, vy, r, m in any order; those but x and y
may be left out. Lines that are empty, or begin with #, are left out; the first one may say how large the box is:

    # box 1200 800
    x,y,vx,vy,r,m
    20.5,30,-0.5,1,10,5

Else the box is as large as what the circles reach from the origin.
"""

import contextlib
import math
import os
import tempfile
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from tetrabench.collision.objects import Floats, Objects, Start, check_box, make_objects
from tetrabench.collision.start.models import MASS, MODELS, RADIUS
from tetrabench.errors import InputError, find_named
from tetrabench.io import is_file, known_suffix
from tetrabench.memory import refuse_if_too_large

EXACT, TABLE = ".npz", ".csv"
DEFAULTS = {"vx": 0.0, "vy": 0.0, "r": RADIUS, "m": MASS}
BOX, SOURCE = "box", "source"
TABLE_ROOM = 4  # bytes of memory for each byte of a file, measured


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
    suffix, target = check_objects_target(path), Path(path)
    try:
        with tempfile.TemporaryDirectory(dir=target.absolute().parent, prefix=".writing-") as draft:
            file = Path(draft) / target.name
            write_exact(start, file) if suffix == EXACT else write_table(start, file)
            file.replace(target)
    except OSError as error:
        raise InputError(f"{path}: cannot be written: {error.strerror or error}") from error


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
            with np.load(path) as archive:
                return {*Objects._fields, BOX} <= {*archive.files}
        except Exception:  # no file, or damaged: whoever reads it says so
            return False
    return suffix == TABLE


# ---------------------------------------------------------------------- .npz


def read_exact(path: Path) -> Start:
    """Read what `write_exact` wrote; sums in the file tell damage."""
    refuse_if_too_large(f"{path}", path.stat().st_size)
    try:
        with np.load(path) as archive:
            is_other = not {*Objects._fields, BOX, SOURCE} <= {*archive.files}
            arrays = {} if is_other else {name: archive[name] for name in archive.files}
    except OSError:
        raise
    except Exception as error:  # numpy and zipfile raise anything
        raise InputError(f"{path}: damaged, or not objects as tetrabench writes them; make it again") from error
    if is_other:
        raise InputError(f"{path}: holds no objects as tetrabench writes them; other programs can write {TABLE}")
    with told_of(path):
        objects = make_objects(*(arrays[name] for name in Objects._fields))
        width, height = arrays[BOX].tolist()
        check_box(width, height)
    return Start(objects, width, height, arrays[SOURCE].tobytes().decode(errors="surrogateescape"))


def write_exact(start: Start, path: Path) -> None:
    """The arrays of the objects by their names, the box, and the words."""
    words = np.frombuffer(start.source.encode(errors="surrogateescape"), np.uint8)
    arrays: dict[str, Any] = {**start.objects._asdict(), BOX: np.array([start.width, start.height]), SOURCE: words}
    with path.open("wb") as file:
        np.savez(file, **arrays)


# ---------------------------------------------------------------------- .csv


def read_table(path: Path) -> Start:
    """Read a table of numbers, whoever wrote it."""
    refuse_if_too_large(f"reading {path}", TABLE_ROOM * path.stat().st_size)
    box = read_box(path)
    names = [name.strip() for name in load_table(path, dtype=str, nrows=0).columns]
    for name in names:
        with told_of(path):
            find_named("column", dict.fromkeys(Objects._fields), name)
    missing = [name for name in Objects._fields if name not in names and name not in DEFAULTS]
    if missing:
        raise InputError(
            f"{path}: no column {' and no column '.join(missing)}; the line of names has {', '.join(names)}"
        )
    try:
        table = load_table(path, dtype=np.float64, float_precision="round_trip")
    except ValueError as error:
        raise InputError(find_fault(path) or f"{path}: cannot be read as numbers: {error}") from error
    table.columns = pd.Index(names)
    columns: dict[str, Any] = {**DEFAULTS, **{name: table[name].to_numpy() for name in names}}
    try:
        objects = make_objects(**columns)
    except InputError as error:
        raise InputError(find_fault(path) or f"{path}: {error}") from error
    if box is None:
        box = reach(objects.x, objects.r), reach(objects.y, objects.r)
        if min(box) <= 0:
            raise InputError(
                f"{path}: no object is where x and y are above 0; say in the first line: # box WIDTH HEIGHT"
            )
    with told_of(path):
        check_box(*box)
    return Start(objects, *box, source=str(path))


def reach(centre: Floats, r: Floats) -> float:
    """How far circles reach along an axis; 0 where there is none."""
    return float(np.max(centre + r, initial=0.0))


def write_table(start: Start, path: Path) -> None:
    """As few digits as tell a number from all others."""
    with path.open("w", encoding="utf-8", newline="") as file:
        file.write(f"# {BOX} {float(start.width)!r} {float(start.height)!r}\n")
        pd.DataFrame(start.objects._asdict()).to_csv(file, index=False, lineterminator="\n")


def read_box(path: Path) -> tuple[float, float] | None:
    """What the first line says of the box, None where it says nothing."""
    with path.open(encoding="utf-8-sig", errors="replace") as file:
        words = file.readline(1000).partition("#")
    if words[0].strip() or words[2].split()[:1] != [BOX]:
        return None
    try:
        width, height = map(float, words[2].split()[1:])
    except ValueError as error:
        raise InputError(f"{path}:1: a box is written as # box WIDTH HEIGHT, in numbers") from error
    return width, height


def load_table(path: Path, **words: Any) -> pd.DataFrame:
    """What pandas makes of the file."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", pd.errors.ParserWarning)
            return pd.read_csv(
                path,
                comment="#",
                skipinitialspace=True,
                index_col=False,
                encoding="utf-8-sig",
                memory_map=True,
                **words,
            )
    except pd.errors.EmptyDataError as error:
        raise InputError(f"{path}: holds no line of names, such as {','.join(Objects._fields)}") from error
    except (pd.errors.ParserError, pd.errors.ParserWarning) as error:
        reason = " ".join(str(error).split()).removeprefix("Error tokenizing data. C error: ")
        raise InputError(f"{path}: cannot be read as a table: {reason}") from error
    except UnicodeDecodeError as error:
        raise InputError(f"{path}: cannot be read as a table: it is no text") from error


def find_fault(path: Path) -> str | None:
    """Say what is wrong with the first object that cannot be taken; None where nothing is found."""
    table = load_table(path, dtype=str, keep_default_na=False)
    names = [name.strip() for name in table.columns]
    for row, words in enumerate(table.itertuples(index=False)):
        for name, word in zip(names, words, strict=True):
            try:
                number = float(word)
            except ValueError:
                number = math.nan
            if not math.isfinite(number) or (name in ("r", "m") and number <= 0):
                demand = "a finite number above 0" if name in ("r", "m") else "a finite number"
                found = f"not '{word}'" if isinstance(word, str) and word.strip() else "and there is none"
                return f"{path}:{line_of(path, row)}: {name} has to be {demand}, {found}"
    return None


def line_of(path: Path, row: int) -> int:
    """The line, counted from 1, of a row of the table."""
    with path.open(encoding="utf-8-sig", errors="replace") as file:
        lines = (number for number, line in enumerate(file, 1) if line.partition("#")[0].strip())
        for _ in range(row + 1):  # that of names is one of them
            next(lines)
        return next(lines)


@contextlib.contextmanager
def told_of(path: Path) -> Iterator[None]:
    """Put the name of the file before what is refused."""
    try:
        yield
    except InputError as error:
        raise InputError(f"{path}: {error}") from error
