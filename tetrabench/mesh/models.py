"""Models: meshes of any size made without a mesher, the same bits for the same seed. Lengths in metres.

Every point off the surface is moved at random by a fraction of the spacing around it, so that no two tetras
are alike.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from itertools import combinations_with_replacement, permutations
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from tetrabench.errors import InputError
from tetrabench.mesh.numbering import renumber
from tetrabench.mesh.quality import signed_volumes, smallest_dihedral_angle
from tetrabench.mesh.tetra_mesh import MeshReport, TetraMesh

Points = NDArray[np.float64]
Tets = NDArray[np.int32]
Choice = TypeVar("Choice")


@dataclass(frozen=True)
class Regular:
    """A model before its points are moved.

    Attributes:
        points: (n, 3) float64, metres.
        tets: (m, 4) int32, all of positive volume.
        reach: (n,) float64, metres: how far each coordinate of a point may be moved; 0 on the surface.
        words: how the model is divided.
    """

    points: Points
    tets: Tets
    reach: NDArray[np.float64]
    words: str


@dataclass(frozen=True)
class Model:
    """A row of MODELS: name, one-line title, default number of tets, and the function that builds about that
    many."""

    name: str
    title: str
    tets: int
    build: Callable[[int], Regular]


def generate(name: str, tets: int | None = None, *, numbering: str = "natural", seed: int = 0) -> TetraMesh:
    """Make a model: conforming, every volume positive, lengths in metres.

    Args:
        name: one of MODELS.
        tets: the number of tets wanted (the model's default where None). The model takes the nearest it can
            divide into; what it holds, and its smallest dihedral angle in degrees, stand in `report.source`.
        numbering: "natural" (layer by layer) or "shuffled".
        seed: of the moved points, and of the shuffling.

    Raises:
        InputError: an unknown model or numbering, or fewer than one tetra wanted.
    """
    if name not in MODELS:
        raise InputError(f"unknown model {name!r}; there are {', '.join(MODELS)}")
    wanted = MODELS[name].tets if tets is None else tets
    if wanted < 1:
        raise InputError(f"a model of {wanted} tets cannot be made; ask for at least 1")
    regular = MODELS[name].build(wanted)
    shift = np.random.default_rng([seed]).uniform(-1, 1, regular.points.shape) * regular.reach[:, None]
    points = regular.points + shift
    assert signed_volumes(points, regular.tets).min() > 0, "the reach of the points is too long"
    angle = smallest_dihedral_angle(points, regular.tets)
    source = (
        f"{name}: {len(regular.tets)} tets, {len(points)} points, {regular.words}, lengths in metres, "
        f"smallest dihedral angle {angle:.1f} degrees, seed {seed}"
    )
    mesh = TetraMesh(
        points=points,
        tets=regular.tets,
        point_ids=np.arange(1, len(points) + 1, dtype=np.int64),
        tet_ids=np.arange(1, len(regular.tets) + 1, dtype=np.int64),
        report=MeshReport(source=source),
    )
    return renumber(mesh, numbering, seed)


def build_nozzle(wanted: int) -> Regular:
    """Build a converging-diverging nozzle, solid and round: inlet radius 0.10 m, throat 0.05 m, outlet 0.09
    m, length 0.18 m.

    A disc of m rings, ring k with 6 k points, has 6 m^2 triangles. Extruded along the axis in n layers it
    gives 6 m^2 n prisms, each split in 3 tets: 18 m^2 n. A layer is as thick as the nozzle is narrow there,
    which keeps the cells near isotropic.
    """
    ideal = 2.6  # layers for each ring
    middle = round((wanted / 18 / ideal) ** (1 / 3))
    rings, layers = nearest(
        ((m, max(1, round(wanted / 18 / m**2))) for m in range(max(1, middle * 3 // 4), middle * 5 // 4 + 2)),
        count=lambda choice: 18 * choice[0] ** 2 * choice[1],
        wanted=wanted,
        distortion=lambda choice: abs(np.log(choice[1] / choice[0] / ideal)),
    )
    disc, triangles = build_disc(rings)
    z, radius = nozzle_profile(layers)

    points = np.empty((layers + 1, len(disc), 3))
    points[:, :, :2] = disc * radius[:, None, None]
    points[:, :, 2] = z[:, None]

    # A prism over the triangle a < b < c is cut along a b', a c', b c' (' is one layer up). The cut of a side
    # depends on its two columns of points alone, so neighbours agree.
    a, b, c = np.sort(triangles, axis=1).T
    up = len(disc)
    prism = np.stack([[a, b, c, c + up], [a, b, c + up, b + up], [a, a + up, b + up, c + up]]).transpose(2, 0, 1)
    # Sorting may have turned a triangle over, and its prism inside out.
    ab, ac = disc[b] - disc[a], disc[c] - disc[a]
    turned = ab[:, 0] * ac[:, 1] < ab[:, 1] * ac[:, 0]
    prism[turned] = prism[turned][:, :, [0, 2, 1, 3]]
    tets = (prism.reshape(1, -1, 4) + up * np.arange(layers)[:, None, None]).reshape(-1, 4)

    thickness = np.minimum(np.diff(z, prepend=-1.0), np.diff(z, append=z[-1] + 1.0))
    reach = np.tile(np.minimum(radius / rings, thickness)[:, None] * 0.12, (1, up))
    reach[:, up - 6 * rings :] = 0  # the wall
    reach[[0, -1]] = 0  # inlet and outlet
    words = f"{rings} rings x {layers} layers"
    return Regular(points.reshape(-1, 3), tets.astype(np.int32), reach.ravel(), words)


def build_disc(rings: int) -> tuple[Points, NDArray[np.int64]]:
    """Triangulate the unit disc by concentric rings: the middle, then ring k = 1, 2, ... with 6 k points.

    Returns:
        points (1 + 3 m (m + 1), 2) float64; triangles (6 m^2, 3) int64, counter-clockwise.
    """
    points, triangles = [np.zeros((1, 2))], []
    inner, outer = 0, 1  # first points of rings k - 1 and k
    for k in range(1, rings + 1):
        angle = np.arange(6 * k) * (np.pi / (3 * k))
        points.append(k / rings * np.stack([np.cos(angle), np.sin(angle)], axis=1))
        sector, j = (grid.ravel() for grid in np.indices((6, k)))
        on_outer = [outer + (sector * k + j + step) % (6 * k) for step in (0, 1)]
        on_inner = [inner + (sector * (k - 1) + j + step) % max(1, 6 * (k - 1)) for step in (0, 1)]
        triangles.append(np.stack([on_inner[0], on_outer[0], on_outer[1]], axis=1))
        triangles.append(np.stack([on_inner[0], on_outer[1], on_inner[1]], axis=1)[j < k - 1])
        inner, outer = outer, outer + 6 * k
    return np.concatenate(points), np.concatenate(triangles)


def nozzle_profile(layers: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Heights and radii of the nozzle's layers, in metres: two (layers + 1,) float64.

    Two half cosine waves meet in the throat at 0.08 m, so radius and slope are continuous.
    """
    throat, length = 0.08, 0.18

    def radius(z: NDArray[np.float64]) -> NDArray[np.float64]:
        converging = 0.075 + 0.025 * np.cos(np.pi * z / throat)
        diverging = 0.07 - 0.02 * np.cos(np.pi * (z - throat) / (length - throat))
        return np.where(z < throat, converging, diverging)

    fine = np.linspace(0.0, length, 2001)
    # The integral of dz / radius: each layer gets an equal part of it.
    steps = np.concatenate([[0.0], np.cumsum(1 / radius((fine[1:] + fine[:-1]) / 2))])
    z = np.interp(np.linspace(0.0, steps[-1], layers + 1), steps, fine)
    return z, radius(z)


def build_box(wanted: int) -> Regular:
    """Build a box of 1 m^3 from nx x ny x nz equal cubes, each cut in 6 tets along its diagonal (Kuhn 1960).

    Every cube is cut alike, so that neighbours agree: a tetra goes from the lowest corner to the highest
    along the three axes, in one of their 6 orders.
    """
    middle = round((wanted / 6) ** (1 / 3))
    sizes = nearest(
        combinations_with_replacement(range(max(1, middle - 4), middle + 5), 3),
        count=lambda choice: 6 * choice[0] * choice[1] * choice[2],
        wanted=wanted,
        distortion=lambda choice: choice[2] / choice[0],
    )
    nx, ny, nz = sizes
    spacing = (nx * ny * nz) ** (-1 / 3)
    z, y, x = np.indices((nz + 1, ny + 1, nx + 1))  # x runs fastest
    grid = np.column_stack([x.ravel(), y.ravel(), z.ravel()])
    surface = ((grid == 0) | (grid == sizes)).any(axis=1)

    step = np.array([1, nx + 1, (nx + 1) * (ny + 1)])
    lowest = (grid[(grid < sizes).all(axis=1)] @ step)[:, None]
    cuts = []
    for first, second, third in permutations(range(3)):
        corners = [0, step[first], step[first] + step[second], step.sum()]
        even = (first, second, third) in ((0, 1, 2), (1, 2, 0), (2, 0, 1))
        cuts.append(corners if even else [corners[k] for k in (0, 1, 3, 2)])
    tets = (lowest[:, :, None] + np.array(cuts)).reshape(-1, 4)
    reach = np.where(surface, 0.0, 0.15 * spacing)
    return Regular(grid * spacing, tets.astype(np.int32), reach, f"{nx} x {ny} x {nz} cubes")


def nearest(
    choices: Iterable[Choice],
    *,
    count: Callable[[Choice], int],
    wanted: int,
    distortion: Callable[[Choice], float],
) -> Choice:
    """Choose the least distorted division among those within 1 % of the count wanted; where none is, the
    nearest count."""

    def cost(choice: Choice) -> tuple[int, float]:
        return max(wanted // 100, abs(count(choice) - wanted)), distortion(choice)

    return min(choices, key=cost)


MODELS = {
    model.name: model
    for model in (
        Model("nozzle", "converging-diverging nozzle, curved wall, round cross-section", 642_700, build_nozzle),
        Model("box", "box of jittered cubes, six tetras each", 100_000, build_box),
    )
}
