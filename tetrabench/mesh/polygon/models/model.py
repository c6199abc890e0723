"""What a model of polygons is: the unit square, divided into cells, and the row that names it."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

Points = NDArray[np.float64]
Integers = NDArray[np.int64]

SIDES = ((1, 0.0), (0, 1.0), (1, 1.0), (0, 0.0))
"""The sides of the unit square, bottom, right, top and left: the coordinate that is the same all along, and its
value. Their boundary conditions are -1, -2, -3 and -4."""


@dataclass(frozen=True)
class Division:
    """The unit square, divided into polygons.

    Attributes:
        points: (n, 2) float64; on a side of the square a coordinate is 0 or 1 to the bit.
        starts: (m + 1,) int32, as in PolygonMesh.
        nodes: (starts[m],) int32, counter-clockwise around each cell.
        words: how the square is divided.
    """

    points: Points
    starts: NDArray[np.int32]
    nodes: NDArray[np.int32]
    words: str


@dataclass(frozen=True)
class PolygonModel:
    """A row of MODELS.

    Attributes:
        name: as a person types it.
        title: one line.
        cells: default number of cells, the source's.
        build: (number of cells wanted, seed) -> the square in about that many.
        bytes: memory taken at the peak for each cell, measured at the default size in all numberings, rounded up.
    """

    family: ClassVar[str] = "polygon"
    name: str
    title: str
    cells: int
    build: Callable[[int, int], Division]
    bytes: int


def choose_grid(wanted: int, in_row: Callable[[int], float], shape: float) -> tuple[int, int]:
    """Choose a number of columns and of rows: those with the nearest count of cells, and of these the best shaped.

    Columns within 2 % of the best shape's number take part, and of a small number the next ones too.

    Args:
        wanted: number of cells, 1 or more.
        in_row: columns -> cells in a row, on average.
        shape: rows / columns where the cells are best shaped.
    """
    best = math.sqrt(wanted / shape / in_row(1 << 30) * (1 << 30))
    choices = []
    for columns in range(max(1, math.floor(0.98 * best)), math.ceil(1.02 * best) + 1):
        rows = max(1, round(wanted / in_row(columns)))
        distortion = abs(math.log(rows / columns / shape))
        choices.append((abs(int(rows * in_row(columns)) - wanted), distortion, columns, rows))
    return min(choices)[2:]


def in_table(points: Points, table: Integers, words: str) -> Division:
    """The division whose cells are the rows of a table, (m, most nodes) int64, with -1 in places that are empty. Points
    that are in no cell are left out."""
    held = table >= 0
    used = np.zeros(len(points), bool)
    used[table[held]] = True
    new = np.cumsum(used, dtype=np.int32) - 1
    starts = np.zeros(len(table) + 1, np.int32)
    np.cumsum(held.sum(axis=1), out=starts[1:])
    return Division(points[used], starts, new[table[held]].astype(np.int32), words)
