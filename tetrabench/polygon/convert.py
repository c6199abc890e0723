"""From a format back to plain cell lists: written once, against the queries."""

import numpy as np
from numpy.typing import NDArray

from tetrabench.mesh.polygon.polygon_mesh import PolygonMesh, PolygonReport
from tetrabench.polygon.interface import Storage
from tetrabench.polygon.queries import QUERIES


def mesh_of(storage: Storage, points: NDArray[np.float64], room: int, source: str = "") -> PolygonMesh:
    """The mesh that a storage holds: cells in their order, each from the node on that the format begins with.

    Args:
        storage: of any format.
        points: (n, 2) or (n, 3) float64: coordinates are in no format.
        room: as `list_room` has it.
        source: for the report.
    """
    cells = QUERIES["cell-nodes"].elements(storage)
    starts, nodes = QUERIES["cell-nodes"].lists(storage, cells, room)
    _, beyond = QUERIES["cell-neighbours"].lists(storage, cells, room)
    return PolygonMesh(
        points, starts.astype(np.int32), nodes, np.minimum(beyond, 0).astype(np.int32), PolygonReport(source=source)
    )
