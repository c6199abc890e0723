"""PolygonMesh: a mesh of polygons as plain cell lists, arrays and nothing else."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

CONDITION = -1
"""The boundary condition of a side that nobody gave another."""


@dataclass
class PolygonReport:
    """What a reader met besides the mesh itself.

    Attributes:
        source: path of the file, or the words that describe a generated model.
        format: name of the file's format, "" for a generated model.
        skipped: cells of the file that are no polygons, kind -> count.
        quadratic: polygons with midside nodes, of which the corners alone are used.
        values: names of the numbers that the file holds for its points and cells; they are no part of the mesh.
        unreferenced: nodes that no cell uses (dropped).
        dropped: cells left out because no format can hold them, reason -> count.
        turned: cells whose nodes were listed the other way round, and are turned over.
        split: nodes that were split because two parts of the mesh touch in them alone.
        warnings: sentences for a person.
    """

    source: str = ""
    format: str = ""
    skipped: dict[str, int] = field(default_factory=dict)
    quadratic: int = 0
    values: list[str] = field(default_factory=list)
    unreferenced: int = 0
    dropped: dict[str, int] = field(default_factory=dict)
    turned: int = 0
    split: int = 0
    warnings: list[str] = field(default_factory=list)


@dataclass
class PolygonMesh:
    """A mesh of polygons, in the plane or on a surface: input data, and what every format can be made from and into.

    A corner is a place in `nodes`: a node of a cell, and the side of the cell from there to its next node.

    Attributes:
        points: (n, 2) or (n, 3) float64, coordinates of the nodes.
        starts: (m + 1,) int32: cell c has the corners from starts[c] up to, not with, starts[c + 1].
        nodes: (starts[m],) int32, indices into `points`, counter-clockwise around each cell.
        conditions: (starts[m],) int32: the boundary condition of the corner's side, a negative number; 0 where another
            cell lies beyond it.
        report: what the reader met besides.
    """

    points: NDArray[np.float64]
    starts: NDArray[np.int32]
    nodes: NDArray[np.int32]
    conditions: NDArray[np.int32]
    report: PolygonReport = field(default_factory=PolygonReport)

    @property
    def number_of_cells(self) -> int:
        """How many cells there are."""
        return len(self.starts) - 1
