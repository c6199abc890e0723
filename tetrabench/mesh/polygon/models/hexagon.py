"""Hexagons: rows of them, every other one shifted by half a cell; the square's sides cut those at its border."""

import numpy as np

from tetrabench.mesh.polygon.models.model import Division, PolygonModel, choose_grid, in_table


def build_hexagons(wanted: int, seed: int) -> Division:
    """Divide the unit square into rows of hexagons, in turn columns and columns + 1 in each. Takes no seed.

    The first and the last cell of a longer row are halves, with 4 nodes. The first and the last row are cut through
    the upright sides, so that their cells, with 5 nodes, have the area of all others. Every node but the square's corners
    has 3 edges. With as many rows as columns the default has exactly the source's counts of cells, edges and nodes
    (1000500, 3001501, 2001002): hexagons on a square grid, 15 % taller than regular ones.
    """
    columns, rows = choose_grid(wanted, in_row=lambda columns: columns + 0.5, shape=1.0)
    width = 2 * columns + 1  # points in the zigzag line between two rows
    line, place = (index.ravel() for index in np.indices((rows + 1, width)))
    zigzag = np.where((line + place) % 2 == 0, 1, -1) / (6 * rows)
    y = np.where((line == 0) | (line == rows), line / rows, line / rows + zigzag)
    points = np.column_stack([place / (2 * columns), y])

    row, cell = (index.ravel() for index in np.indices((rows, columns + 1)))
    exists = (row % 2 == 1) | (cell < columns)
    row, cell = row[exists], cell[exists]
    middle = 2 * cell + 1 - row % 2  # the place of the cell's lowest and highest point
    places = middle[:, None] + np.array([-1, 0, 1, 1, 0, -1])
    lines = row[:, None] + np.array([0, 0, 0, 1, 1, 1])
    # A peak on a side of the square is a node only where the side ends.
    peak = np.array([0, 1, 0, 0, 1, 0], bool) & (places > 0) & (places < 2 * columns)
    missing = (places < 0) | (places > 2 * columns) | (peak & ((lines == 0) | (lines == rows)))
    table = np.where(missing, -1, lines * width + places)
    return in_table(points, table, f"{columns} x {rows} hexagons")


HEXAGON = PolygonModel("hexagon", "hexagons in shifted rows, cut at the border", 1_000_500, build_hexagons, 500)
