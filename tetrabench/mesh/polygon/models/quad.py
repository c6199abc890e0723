"""Quads: rows of equal rectangles, as nearly square as their number allows."""

import numpy as np

from tetrabench.mesh.polygon.models.model import Division, PolygonModel, choose_grid, in_table


def build_quads(wanted: int, seed: int) -> Division:
    """Divide the unit square into columns x rows rectangles. Takes no seed."""
    columns, rows = choose_grid(wanted, in_row=lambda columns: columns, shape=1.0)
    y, x = np.indices((rows + 1, columns + 1))  # x runs fastest
    points = np.column_stack([x.ravel() / columns, y.ravel() / rows])
    row, column = (place.ravel() for place in np.indices((rows, columns)))
    lowest = row * (columns + 1) + column
    table = lowest[:, None] + np.array([0, 1, columns + 2, columns + 1])
    return in_table(points, table, f"{columns} x {rows} quads")


QUAD = PolygonModel("quad", "equal rectangles in rows", 1_000_000, build_quads, 350)
