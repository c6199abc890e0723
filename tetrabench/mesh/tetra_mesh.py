"""TetraMesh: a tetrahedral mesh as it was read, arrays and nothing else."""

import operator
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tetrabench.errors import InputError


@dataclass
class MeshReport:
    """What a reader met besides the mesh itself.

    Attributes:
        source: path of the file, or the words that describe a generated model.
        format: name of the file's format, "" for a generated model.
        included: paths of other files that were read because the file includes them.
        skipped: cards or cells of the file that are no part of the mesh, name -> count.
        quadratic: tetras with midside nodes, of which the corners alone are used.
        values: names of the numbers that the file holds for its points and cells; they are no part of the mesh.
        unreferenced: points that no tetra uses (dropped unless the reader was told to keep them).
        dropped: tetras left out because no net can hold them, reason -> count: see `mesh.check.REASONS`.
        inverted: tetras whose vertex order gives a negative volume (kept as they are).
        degenerate: tetras whose volume is zero to rounding (kept as they are): see `mesh.quality.count_signs`.
        warnings: sentences for a person.
    """

    source: str = ""
    format: str = ""
    included: list[str] = field(default_factory=list)
    skipped: dict[str, int] = field(default_factory=dict)
    quadratic: int = 0
    values: list[str] = field(default_factory=list)
    unreferenced: int = 0
    dropped: dict[str, int] = field(default_factory=dict)
    inverted: int = 0
    degenerate: int = 0
    warnings: list[str] = field(default_factory=list)


@dataclass
class TetraMesh:
    """A tetrahedral mesh: input data, not a net.

    Attributes:
        points: (n, 3) float64, coordinates in the file's order, in the file's unit of length.
        tets: (m, 4) int32, indices into `points`, in the file's order and vertex order.
        point_ids: (n,) int64, the file's own numbers of the points; 1, 2, 3, ... unless they are given.
        tet_ids: (m,) int64, the file's own numbers of the tetras; likewise.
        report: what the reader met besides.
    """

    points: NDArray[np.float64]
    tets: NDArray[np.int32]
    point_ids: NDArray[np.int64] = field(default_factory=lambda: np.empty(0, np.int64))
    tet_ids: NDArray[np.int64] = field(default_factory=lambda: np.empty(0, np.int64))
    report: MeshReport = field(default_factory=MeshReport)

    def __post_init__(self) -> None:
        if not len(self.point_ids):
            self.point_ids = np.arange(1, len(self.points) + 1)
        if not len(self.tet_ids):
            self.tet_ids = np.arange(1, len(self.tets) + 1)


MOST_POINTS = 2**31  # whose rows int32 holds


def as_vertices(tets: ArrayLike, points: int = MOST_POINTS) -> NDArray[np.int32]:
    """The vertices of tetras as kernels take them, which look at no bound: (m, 4) int32, contiguous.

    Args:
        tets: (m, 4) whole numbers.
        points: how many points there are; unless given, as many as need be.

    Raises:
        InputError: another shape, no whole numbers, a vertex below 0 or beyond the points, or no count of points.
    """
    try:
        last = min(operator.index(points), MOST_POINTS) - 1
    except TypeError:
        raise InputError(f"points is how many there are, not a {type(points).__name__}") from None
    if last < -1:
        raise InputError(f"points is how many there are, not {points}")
    try:
        given = np.asarray(tets)
    except ValueError:  # rows of different lengths
        raise InputError("tets are whole numbers of the shape (m, 4)") from None
    if given.ndim != 2 or given.shape[1] != 4 or given.dtype.kind not in "iu":
        raise InputError(f"tets are whole numbers of the shape (m, 4), not {given.dtype} {given.shape}")
    if given.size and not (given.min() >= 0 and given.max() <= last):
        raise InputError(f"tets have vertices from 0 to {last}; these go from {given.min()} to {given.max()}")
    return np.require(given, np.int32, ["C", "W", "O"])
