"""The tetras around each vertex, for all vertices at once: a counting sort of the tetras' vertices."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from tetrabench.jit import kernel
from tetrabench.mesh.tetra_mesh import as_vertices


def vertex_tetras(tets: NDArray[np.int32], points: int) -> tuple[NDArray[np.int64], NDArray[np.int32]]:
    """List the tetras around each vertex, as rows of a compressed sparse matrix.

    Args:
        tets: (m, 4) int32, vertices of each tetra, from 0 to points - 1.
        points: the number of points.

    Returns:
        starts (points + 1,) int64, rows (4 m,) int32: the tetras around point v are rows[starts[v]:starts[v + 1]],
        ascending.

    Raises:
        InputError: tets of another shape, or a vertex that is none of the points.
    """
    tets = as_vertices(tets, points)
    # allocated here, not in a kernel: numpy asks the system for large pages, numba does not
    starts, rows = np.zeros(points + 2, np.int64), np.empty(tets.size, np.int32)
    _distribute(tets.reshape(-1), starts, rows)
    return starts[:-1], rows


@kernel(allocates=False)
def _distribute(vertices: Any, starts: Any, rows: Any) -> None:
    """Count the tetras of each vertex, add up, and put each tetra where the next one of its vertex belongs.

    starts[v + 1] is that place for vertex v, and at the end the place after its last tetra.
    """
    for n in range(len(vertices)):
        starts[vertices[n] + 2] += 1
    for v in range(2, len(starts)):
        starts[v] += starts[v - 1]
    for n in range(len(vertices)):
        place = starts[vertices[n] + 1]
        starts[vertices[n] + 1] = place + 1
        rows[place] = n >> 2
