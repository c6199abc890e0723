"""Write Nastran bulk data in small, large or free field."""

import os
import re
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from tetrabench.drafts import drafted
from tetrabench.errors import InputError
from tetrabench.io.nastran.cards import DOT, MINUS, POWERS, ZERO, Bytes, Integers, Reals
from tetrabench.jit import kernel
from tetrabench.mesh.tetra_mesh import TetraMesh


class Layout(NamedTuple):
    """Where the fields of a form stand, for records of fixed length (one line, or two in large field).

    Attributes:
        width: columns a number may take.
        grid: record of a GRID with blank fields.
        grid_ends: the columns before which its id, x, y and z end.
        tetra: record of a CTETRA with blank fields.
        tetra_ends: the columns before which its id, property and four nodes end.
    """

    width: int
    grid: bytes
    grid_ends: tuple[int, ...]
    tetra: bytes
    tetra_ends: tuple[int, ...]


SMALL = Layout(
    width=8,
    grid=b"GRID".ljust(48) + b"\n",
    grid_ends=(16, 32, 40, 48),
    tetra=b"CTETRA".ljust(56) + b"\n",
    tetra_ends=(16, 24, 32, 40, 48, 56),
)
LARGE = Layout(
    width=16,
    grid=b"GRID*".ljust(72) + b"\n" + b"*".ljust(24) + b"\n",
    grid_ends=(24, 56, 72, 97),
    tetra=b"CTETRA*".ljust(72) + b"\n" + b"*".ljust(40) + b"\n",
    tetra_ends=(24, 40, 56, 72, 97, 113),
)


def write_nastran(
    mesh: TetraMesh, path: str | os.PathLike[str], *, field: str = "small", comments: Sequence[str] = ()
) -> None:
    """Write a mesh as Nastran bulk data: a whole file, or none.

    Args:
        mesh: its ids are kept; every tetra gets property 1.
        path: the file; one that exists is replaced.
        field: "small" and "large" round coordinates to what 8 and 16 columns hold (5 to 7 and 13 to 15
            digits), "free" keeps every bit.
        comments: lines for the top of the file, without the `$`.

    Raises:
        InputError: an unknown form, an id that is not positive or too long for its field, a coordinate that
            is NaN or infinite, a file that cannot be written.
    """
    if field not in ("small", "large", "free"):
        raise InputError(f"unknown field form {field!r}; there are small, large, free")
    points = np.require(mesh.points, np.float64, ["C", "W"])
    point_ids = np.require(mesh.point_ids, np.int64, ["C", "W"])
    tets = np.column_stack([mesh.tet_ids, np.ones(len(mesh.tets), np.int64), point_ids[mesh.tets]])
    if not np.isfinite(points).all():
        raise InputError(f"{path}: a coordinate that is NaN or infinite cannot be written")
    ids = np.append(tets, point_ids)
    low, high = (int(ids.min()), int(ids.max())) if len(ids) else (1, 1)
    layout = {"small": SMALL, "large": LARGE, "free": free_layout(len(str(high)))}[field]
    if low < 1 or len(str(high)) > layout.width:
        held = f"{field} field holds whole numbers from 1, of up to {layout.width} digits"
        raise InputError(f"{path}: ids run from {low} to {high}, but {held}")
    head = "".join(f"$ {line}\n" for comment in comments for line in comment.splitlines())
    with drafted(path) as draft, draft.open("wb") as file:
        file.write((head + "BEGIN BULK\n").encode(errors="surrogateescape"))  # a file may have any bytes for a name
        file.write(free_points(points, point_ids) if field == "free" else point_records(points, point_ids, layout).data)
        file.write(integer_records(tets, layout.tetra, layout.tetra_ends).data)
        file.write(b"ENDDATA\n")


def free_layout(width: int) -> Layout:
    """Make the layout of a free-field CTETRA, padded with blanks to one length (GRIDs have none)."""
    blank = b" " * width
    ends = tuple(np.cumsum([7 + width, 2, *[width + 1] * 4]).tolist())
    return Layout(width, b"", (), b"CTETRA," + b",".join([blank, b" ", *[blank] * 4]) + b"\n", ends)


def free_points(points: Reals, point_ids: Integers) -> bytes:
    """Write GRIDs in free field, each coordinate as the shortest number that is read as the same bits."""
    lines = (
        f"GRID,{number},,{x!r},{y!r},{z!r}\n"
        for number, (x, y, z) in zip(point_ids.tolist(), points.tolist(), strict=True)
    )
    # Python writes 1e-05, Nastran wants the decimal point.
    return re.sub(r"(?<=[,-])(\d)e", r"\1.e", "".join(lines)).encode()


def point_records(points: Reals, point_ids: Integers, layout: Layout) -> Bytes:
    """Write GRIDs in fixed fields: one uint8 row of text for each point."""
    records = integer_records(point_ids[:, None], layout.grid, layout.grid_ends[:1])
    ends = np.array(layout.grid_ends[1:], np.int64)
    left = np.empty(points.size, np.int64)
    for place in left[: put_reals(records, ends, layout.width, points, left)]:
        row, k = divmod(int(place), 3)
        field = scientific(float(points[row, k]), layout.width).rjust(layout.width)
        records[row, ends[k] - layout.width : ends[k]] = np.frombuffer(field.encode(), np.uint8)
    return records


def integer_records(values: Integers, blank: bytes, ends: Sequence[int]) -> Bytes:
    """Copy `blank` for each row of (n, k) `values`, and write these into it, ending before columns `ends`."""
    records = np.tile(np.frombuffer(blank, np.uint8), (len(values), 1))
    put_integers(records, np.array(ends, np.int64), np.require(values, np.int64, ["C", "W"]))
    return records


def scientific(value: float, width: int) -> str:
    """Write a number with an exponent, as `-1.2345-6`, with the most digits that fit."""
    for digits in range(width, -1, -1):
        mantissa, exponent = f"{value:#.{digits}e}".split("e")
        field = f"{mantissa.rstrip('0')}{int(exponent):+d}"
        if len(field) <= width:
            break
    return field


@kernel
def put_integers(records: Bytes, ends: Integers, values: Integers) -> None:
    """Write positive `values[i, k]` into `records[i]`, right-justified before column `ends[k]`."""
    for i in range(values.shape[0]):
        for k in range(values.shape[1]):
            rest, column = values[i, k], ends[k]
            while rest > 0:
                column -= 1
                records[i, column] = ZERO + rest % 10
                rest //= 10


@kernel
def put_reals(records: Bytes, ends: Integers, width: int, values: Reals, left: Integers) -> int:
    """Write `values[i, k]` into `records[i]` with the most decimals, right-justified before column `ends[k]`.

    Numbers better written with an exponent (below 0.001, or too large) are left out: their flat indices go
    into `left`.

    Returns:
        How many are left out.
    """
    count = 0
    for i in range(values.shape[0]):
        for k in range(values.shape[1]):
            size, decimals = abs(values[i, k]), width - 1
            if values[i, k] < 0:
                decimals -= 1
            limit = POWERS[decimals]
            if (size < 0.001 and size != 0) or np.rint(size) >= limit:
                left[count] = i * values.shape[1] + k
                count += 1
                continue
            while np.rint(size * POWERS[decimals]) >= limit:
                decimals -= 1
            rest = int(np.rint(size * POWERS[decimals]))
            while decimals > 0 and rest % 10 == 0:
                decimals -= 1
                rest //= 10
            column = ends[k]
            for _ in range(decimals):
                column -= 1
                records[i, column] = ZERO + rest % 10
                rest //= 10
            column -= 1
            records[i, column] = DOT
            while rest > 0 or size == 0:
                column -= 1
                records[i, column] = ZERO + rest % 10
                rest //= 10
                size = 1.0
            if values[i, k] < 0:
                records[i, column - 1] = MINUS
    return count
