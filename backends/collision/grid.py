"""grid: squares of one size, and the objects of each side by side in memory, sorted into them anew in each step.

Squares are as wide as the largest circle at least, so that what touches lies in one square or in neighbours; and as large
as it takes to hold `per_ten` objects in ten of them. Three neighbours in a row are one stretch of memory, so that an object
is tested against two stretches: the rest of its own square with the next one, and three squares of the row above.

Source: counting sort; such grids e.g. in S. Green, Particle simulation using CUDA, 2010.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tetrabench.collision import interface
from tetrabench.collision.objects import Floats
from tetrabench.jit import implements, kernel
from tetrabench.protocols import Options

WIDER = 1.0001
"""Squares are so much wider than they need to be: their numbers come from rounded coordinates."""
LEFT, BOTTOM, SIDE = range(3)
COLUMNS, ROWS, SORTED = range(3)


class Sorted(NamedTuple):
    """Objects square by square. number: (n,) int32: which; x, y, r: (n,) float64: theirs."""

    number: NDArray[np.int32]
    x: Floats
    y: Floats
    r: Floats


class Grid(NamedTuple):
    """Objects in the order of their squares, which are numbered row by row.

    Attributes:
        starts: (room,) int32: where each square begins; behind the last one, n.
        cell: (n,) int32: the square of each object, in the order of the step before.
        old: the objects; new: room for those of the next step, which then takes the place of old.
        frame: (3,) float64: LEFT and BOTTOM of the grid, SIDE of a square.
        shape: (3,) int64: COLUMNS and ROWS, and how often objects were SORTED.
        reach: how near to each other centres have to be to be looked at; per_ten: objects wanted in ten squares.
    """

    starts: NDArray[np.int32]
    cell: NDArray[np.int32]
    old: Sorted
    new: Sorted
    frame: Floats
    shape: NDArray[np.int64]
    reach: float
    per_ten: int


def make_grid(x: Floats, y: Floats, r: Floats, values: Options) -> Grid:
    """The grid of where they are."""
    grid: Grid = follow(empty_grid(r, 2 * float(r.max(initial=0.0)), values["per_ten"]), x, y)
    return grid


def empty_grid(r: Floats, reach: float, per_ten: int) -> Grid:
    """A grid before its objects were sorted. There are never three times as many squares as are wanted: see `lay_out`."""
    count = len(r)
    return Grid(
        starts=np.zeros(30 * count // per_ten + 8, np.int32),
        cell=np.zeros(count, np.int32),
        old=Sorted(np.arange(count, dtype=np.int32), np.zeros(count), np.zeros(count), r.copy()),
        new=Sorted(np.zeros(count, np.int32), np.zeros(count), np.zeros(count), np.zeros(count)),
        frame=np.array([0.0, 0.0, 1.0]),
        shape=np.array([1, 1, 0]),
        reach=reach,
        per_ten=per_ten,
    )


@implements(interface.update, Grid)
def update(storage, x, y):
    return follow(storage, x, y)


@implements(interface.pairs, Grid)
def pairs(storage, x, y, r, out):
    return find_near(storage, 0.0, out)


@implements(interface.query_rect, Grid)
def query_rect(storage, x, y, x_low, y_low, x_high, y_high, out):
    return look_into(storage, x, y, x_low, y_low, x_high, y_high, 0.0, out)


@implements(interface.stats, Grid)
def stats(storage):
    cells = int(storage.shape[COLUMNS] * storage.shape[ROWS])
    return {"leaves": cells, "fill": len(storage.cell) / cells, "rebuilds": int(storage.shape[SORTED]) - 1}


@implements(interface.leaf_rectangles, Grid)
def leaf_rectangles(storage):
    left, bottom, side = storage.frame
    columns, rows = storage.shape[:SORTED]
    x, y = np.meshgrid(left + side * np.arange(columns), bottom + side * np.arange(rows))
    return np.column_stack([x.ravel(), y.ravel(), x.ravel() + side, y.ravel() + side])


@implements(interface.structure_bytes, Grid)
def structure_bytes(storage):
    used = 4 * int(storage.shape[COLUMNS] * storage.shape[ROWS] + 1)
    sizes = interface.bytes_of(storage) | {"starts": (used, storage.starts.nbytes)}
    for part in ("old", "new"):
        sizes |= {f"{part}.{name}": size for name, size in interface.bytes_of(getattr(storage, part)).items()}
    return sizes


@kernel
def follow(grid, x, y):
    """Sort the objects again, in the order in which the step before has left them, for most are still where they were.

    Their places are fetched once, in that order; what is sorted after that is near to where it goes.
    """
    lay_out(grid, x, y)
    left, bottom, side = grid.frame[LEFT], grid.frame[BOTTOM], grid.frame[SIDE]
    columns, rows = grid.shape[COLUMNS], grid.shape[ROWS]
    starts, cell, old, new = grid.starts, grid.cell, grid.old, grid.new
    starts[: columns * rows + 1] = 0
    for place in range(len(cell)):
        i = old.number[place]
        px, py = x[i], y[i]
        c = square_of(py, bottom, side, rows) * columns + square_of(px, left, side, columns)
        old.x[place], old.y[place], cell[place] = px, py, c
        starts[c] += 1
    total = 0
    for c in range(columns * rows + 1):
        total += starts[c]
        starts[c] = total
    for place in range(len(cell) - 1, -1, -1):  # from the back, so that those of a square keep their order
        c = cell[place]
        starts[c] -= 1
        to = starts[c]
        new.number[to], new.x[to], new.y[to], new.r[to] = old.number[place], old.x[place], old.y[place], old.r[place]
    grid.shape[SORTED] += 1
    return Grid(starts, cell, new, old, grid.frame, grid.shape, grid.reach, grid.per_ten)


@kernel(allocates=False)
def lay_out(grid, x, y):
    """Choose the squares.

    With n objects and k wanted in a square: a side of at least sqrt(width * height * k / n) makes n / k squares, and one of
    at least an n-th of the longer side, k times, keeps the border squares within twice as many more.
    """
    count = len(x)
    low_x = high_x = low_y = high_y = 0.0
    if count:
        low_x = high_x = x[0]
        low_y = high_y = y[0]
    for i in range(count):
        low_x, high_x = min(low_x, x[i]), max(high_x, x[i])
        low_y, high_y = min(low_y, y[i]), max(high_y, y[i])
    width, height = high_x - low_x, high_y - low_y
    share = 0.1 * grid.per_ten / max(1, count)
    side = max(grid.reach * WIDER, np.sqrt(width * share) * np.sqrt(height), max(width, height) * share)
    if not 0.0 < side < np.inf:
        side = 1.0  # of one object, or none
    grid.frame[LEFT], grid.frame[BOTTOM], grid.frame[SIDE] = low_x, low_y, side
    most = 1.0 / share
    grid.shape[COLUMNS] = np.int64(min(width / side, most)) + 1
    grid.shape[ROWS] = np.int64(min(height / side, most)) + 1


@kernel(allocates=False, inline=True)
def square_of(coordinate, low, side, count):
    """The column of an x, or the row of a y; what is outside belongs to the first or to the last."""
    place = (coordinate - low) / side
    if not place > 0.0:
        return 0
    return np.int64(place) if place < count else count - 1


@kernel(allocates=False)
def find_near(grid, more, out):
    """All pairs nearer than the sum of their radii and `more`, which `reach` covers."""
    columns, rows, starts = grid.shape[COLUMNS], grid.shape[ROWS], grid.starts
    count = 0
    for row in range(rows):
        for column in range(columns):
            c = row * columns + column
            first, last = starts[c], starts[c + 1]
            if first == last:
                continue
            right = 1 if column < columns - 1 else 0
            end = starts[c + 1 + right]
            above = above_end = 0
            if row < rows - 1:
                above = starts[c + columns - (1 if column else 0)]
                above_end = starts[c + columns + right + 1]
            for place in range(first, last):
                count = test_stretch(grid, more, place, place + 1, end, out, count)
                count = test_stretch(grid, more, place, above, above_end, out, count)
    return count


@kernel(allocates=False, inline=True)
def test_stretch(grid, more, place, first, last, out, count):
    """One object against some that lie side by side."""
    objects = grid.old
    px, py, pr = objects.x[place], objects.y[place], objects.r[place]
    for other in range(first, last):
        dx, dy, near = px - objects.x[other], py - objects.y[other], pr + objects.r[other] + more
        if dx * dx + dy * dy < near * near:
            if count < len(out):
                i, j = objects.number[place], objects.number[other]
                out[count, 0], out[count, 1] = min(i, j), max(i, j)
            count += 1
    return count


@kernel(allocates=False)
def look_into(grid, x, y, x_low, y_low, x_high, y_high, moved, out):
    """All objects in a rectangle, of which each has moved at most so far since they were sorted."""
    left, bottom, side = grid.frame[LEFT], grid.frame[BOTTOM], grid.frame[SIDE]
    columns, rows = grid.shape[COLUMNS], grid.shape[ROWS]
    if not (x_low <= x_high and y_low <= y_high):
        return 0
    first = square_of(x_low - moved, left, side, columns)
    last = square_of(x_high + moved, left, side, columns)
    count = 0
    for row in range(square_of(y_low - moved, bottom, side, rows), square_of(y_high + moved, bottom, side, rows) + 1):
        for place in range(grid.starts[row * columns + first], grid.starts[row * columns + last + 1]):
            i = grid.old.number[place]
            if x_low <= x[i] <= x_high and y_low <= y[i] <= y_high:
                if count < len(out):
                    out[count] = i
                count += 1
    return count
