"""Move the points of a net: static data of the touched tetras anew, search tree anew, topology as it was."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from tetrabench.errors import InputError
from tetrabench.jit import kernel
from tetrabench.tetra.geometry import set_geometry
from tetrabench.tetra.interface import NONE, Net, first_tetra, next_tetra, vertex
from tetrabench.tetra.nearest import rebuild
from tetrabench.tetra.points import COUNT, EDITS, STALE, diagonal_of


def deform(net: Net, moved: NDArray[np.float64]) -> tuple[Net, int]:
    """Put the points where `moved` (n, 3) float64 says; returns the net to go on with and how many tetras were touched.

    Raises:
        InputError: another shape than that of the points, or a coordinate that is not finite. Nothing is changed then.
        ValueError: the storage is stale.
    """
    count = int(net.points.counters[COUNT])
    if moved.shape != (count, 3):
        raise InputError(f"the net has {count} points: their new places have the shape ({count}, 3), not {moved.shape}")
    if not np.isfinite(moved).all():
        raise InputError("a point was moved to nowhere: a coordinate is not finite")
    if net.points.counters[STALE]:
        raise ValueError("this storage was outgrown: go on with the net that reserve returned")
    touched = _move(net, moved, (net.points.xyz[:count] != moved).any(axis=1))
    return net._replace(points=net.points._replace(diagonal=diagonal_of(moved))), int(touched)


@kernel
def _move(net: Net, moved: Any, has_moved: Any) -> int:
    count = net.points.counters[COUNT]
    for point in range(count):
        for k in range(3):
            net.points.xyz[point, k] = moved[point, k]
    touched = 0
    cursor = first_tetra(net)
    while cursor.tetra != NONE:
        t = cursor.tetra
        if (
            has_moved[vertex(net, t, 0)]
            or has_moved[vertex(net, t, 1)]
            or has_moved[vertex(net, t, 2)]
            or has_moved[vertex(net, t, 3)]
        ):
            set_geometry(net, t)
            touched += 1
        cursor = next_tetra(net, cursor)
    rebuild(net.tree, net.points.xyz, count)
    net.points.counters[EDITS] += 1
    return touched
