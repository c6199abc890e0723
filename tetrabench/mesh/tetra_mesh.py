"""TetraMesh: a tetrahedral mesh as it was read, arrays and nothing else."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray


@dataclass
class MeshReport:
    """What a reader met besides the mesh itself.

    Attributes:
        source: path of the file, or the words that describe a generated model.
        format: name of the file's format, "" for a generated model.
        skipped: cards or cells of the file that are no part of the mesh, name -> count.
        quadratic: tetras with midside nodes, of which the corners alone are used.
        unreferenced: points that no tetra uses (dropped unless the reader was told to keep them).
        dropped: tetras left out because no net can hold them, reason -> count: see `mesh.check.REASONS`.
        inverted: tetras whose vertex order gives a negative volume (kept as they are).
        degenerate: tetras whose volume is zero to rounding (kept as they are): see `mesh.quality.count_signs`.
        warnings: sentences for a person.
    """

    source: str = ""
    format: str = ""
    skipped: dict[str, int] = field(default_factory=dict)
    quadratic: int = 0
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
        point_ids: (n,) int64, the file's own numbers of the points.
        tet_ids: (m,) int64, the file's own numbers of the tetras.
        report: what the reader met besides.
    """

    points: NDArray[np.float64]
    tets: NDArray[np.int32]
    point_ids: NDArray[np.int64]
    tet_ids: NDArray[np.int64]
    report: MeshReport = field(default_factory=MeshReport)
