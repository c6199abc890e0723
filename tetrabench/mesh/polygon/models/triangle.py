"""Triangles: rows of nearly equilateral ones, six around every inner node."""

import math

import numpy as np

from tetrabench.mesh.polygon.models.model import Division, PolygonModel, choose_grid, in_table


def build_triangles(wanted: int, seed: int) -> Division:
    """Divide the unit square into rows of triangles, 2 columns + 1 in each. Takes no seed.

    The lines between the rows have their points in turn at the whole columns, and at the half ones and both ends: 2
    triangles in each row are halves. No mesh with six edges at every inner node has the source's three counts: they make
    1643 boundary sides, which enclose at most 1643^2 / 6 such triangles (in a hexagon), fewer than half of them.
    """
    columns, rows = choose_grid(wanted, in_row=lambda columns: 2 * columns + 1, shape=2 / math.sqrt(3))
    line, place = (index.ravel() for index in np.indices((rows + 1, columns + 2)))
    x = np.where(line % 2 == 0, place, np.clip(place - 0.5, 0, columns)) / columns  # even lines: the last is unused
    points = np.column_stack([x, line / rows])

    row, turn = (index.ravel() for index in np.indices((rows, 2 * columns + 1)))
    below, above, step = row * (columns + 2), (row + 1) * (columns + 2), turn // 2
    whole, half = np.where(row % 2 == 0, (below, above), (above, below)) + step  # the next point of either line
    # In turn a triangle has its side on the line of half columns, and on that of whole ones.
    on_half = np.stack([half + 1, half, whole])
    on_whole = np.stack([whole, whole + 1, half + 1])
    table = np.where(turn % 2 == 0, on_half, on_whole).T
    table[row % 2 == 1] = table[row % 2 == 1, ::-1]  # upside down
    return in_table(points, table, f"{columns} x {rows} pairs")


TRIANGLE = PolygonModel("triangle", "nearly equilateral triangles in rows", 1_005_519, build_triangles, 350)
