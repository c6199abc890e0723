"""column: a column of square cross-section, ten times as high as it is wide: a box of other proportions.

Layer by layer, as it is numbered, neighbours are never far from each other: kind to caches.
"""

from itertools import product

import numpy as np

from tetrabench.mesh.models.box import cut_cubes
from tetrabench.mesh.models.model import Model, Regular, nearest

SLENDERNESS = 10


def build_column(wanted: int) -> Regular:
    """Build a column, a metre wide, of n x n x h equal cubes, each in six tetras."""
    middle = max(1, round((wanted / (6 * SLENDERNESS)) ** (1 / 3)))
    width, height = nearest(
        product(range(max(1, middle - 1), middle + 2), range(1, SLENDERNESS * (middle + 2))),
        count=lambda choice: 6 * choice[0] ** 2 * choice[1],
        wanted=wanted,
        distortion=lambda choice: abs(np.log(choice[1] / (SLENDERNESS * choice[0]))),
    )
    grid, tets = cut_cubes(width, width, height)
    surface = ((grid == 0) | (grid == (width, width, height))).any(axis=1)
    reach = np.where(surface, 0.0, 0.15 / width)
    return Regular(grid / width, tets, reach, f"{width} x {width} x {height} cubes")


MODELS = [Model("column", "column of jittered cubes, ten times as high as wide", 100_000, build_column)]
