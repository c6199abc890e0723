"""The box: a cubic metre of jittered cubes, six tets each."""

from itertools import combinations_with_replacement, permutations

import numpy as np
from numpy.typing import NDArray

from tetrabench.mesh.models.model import Model, Regular, nearest


def build_box(wanted: int) -> Regular:
    """Build a box of 1 m^3 from nx x ny x nz equal cubes."""
    middle = round((wanted / 6) ** (1 / 3))
    sizes = nearest(
        combinations_with_replacement(range(max(1, middle - 4), middle + 5), 3),
        count=lambda choice: 6 * choice[0] * choice[1] * choice[2],
        wanted=wanted,
        distortion=lambda choice: choice[2] / choice[0],
    )
    nx, ny, nz = sizes
    spacing = (nx * ny * nz) ** (-1 / 3)
    grid, tets = cut_cubes(nx, ny, nz)
    surface = ((grid == 0) | (grid == sizes)).any(axis=1)
    reach = np.where(surface, 0.0, 0.15 * spacing)
    return Regular(grid * spacing, tets, reach, f"{nx} x {ny} x {nz} cubes")


def cut_cubes(nx: int, ny: int, nz: int) -> tuple[NDArray[np.int64], NDArray[np.int32]]:
    """A grid of cubes with edges of length 1, each cut in 6 tets along its diagonal (Kuhn 1960).

    Every cube is cut alike, so that neighbours agree: a tetra goes from the lowest corner to the highest along the three
    axes, in one of their 6 orders. Returns points ((nx + 1) (ny + 1) (nz + 1), 3) int64 and tets (6 nx ny nz, 4) int32.
    """
    z, y, x = np.indices((nz + 1, ny + 1, nx + 1))  # x runs fastest
    grid = np.column_stack([x.ravel(), y.ravel(), z.ravel()])
    step = np.array([1, nx + 1, (nx + 1) * (ny + 1)])
    lowest = (grid[(grid < (nx, ny, nz)).all(axis=1)] @ step)[:, None]
    cuts = []
    for first, second, third in permutations(range(3)):
        corners = [0, step[first], step[first] + step[second], step.sum()]
        even = (first, second, third) in ((0, 1, 2), (1, 2, 0), (2, 0, 1))
        cuts.append(corners if even else [corners[k] for k in (0, 1, 3, 2)])
    return grid, (lowest[:, :, None] + np.array(cuts)).reshape(-1, 4).astype(np.int32)


BOX = Model("box", "box of jittered cubes, six tetras each", 100_000, build_box)
