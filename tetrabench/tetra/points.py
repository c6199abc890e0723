"""The points of a net: a growable array of coordinates. Points are appended, never deleted; a ref is an index."""

from typing import Any, NamedTuple

import numpy as np
from numba.extending import register_jitable
from numpy.typing import NDArray

from tetrabench.jit import kernel

COUNT, STALE, EDITS = 0, 1, 2  # places in the counters

SAME_POINT = 1e-9
"""Points nearer than this part of the bounding box's diagonal are one point to `insert_point`."""


class Points(NamedTuple):
    """Coordinates, and what the net as a whole has to know of itself.

    Attributes:
        xyz: (capacity, 3) float64, in any one unit of length; the first `counters[COUNT]` rows are points.
        counters: (3,) int64: COUNT points; STALE is 1 when the storage was outgrown, and an edit would be lost;
            EDITS counts the changes of the net, for whoever keeps something derived from it.
        diagonal: length of the bounding box's diagonal when the net was made.
    """

    xyz: NDArray[np.float64]
    counters: NDArray[np.int64]
    diagonal: float


def make_points(xyz: NDArray[np.float64]) -> Points:
    """Points from coordinates (n, 3); the array is copied."""
    return Points(np.array(xyz, np.float64, order="C"), np.array([len(xyz), 0, 0], np.int64), diagonal_of(xyz))


def diagonal_of(xyz: NDArray[np.float64]) -> float:
    """Length of the diagonal of the bounding box of points (n, 3), in their unit; 0 without points."""
    return float(np.sqrt((np.ptp(xyz, axis=0) ** 2).sum())) if len(xyz) else 0.0


@kernel(allocates=False)
def append_point(points: Points, x: float, y: float, z: float) -> int:
    """Append a point and return its ref; the room was made before."""
    ref = points.counters[COUNT]
    points.xyz[ref, 0] = x
    points.xyz[ref, 1] = y
    points.xyz[ref, 2] = z
    points.counters[COUNT] = ref + 1
    return ref


@register_jitable
def grown_points(points: Points, capacity: int) -> Points:
    """The same points with room for `capacity`, and counters of their own."""
    return Points(grown(points.xyz, capacity), points.counters.copy(), points.diagonal)


@register_jitable
def grown(array: Any, capacity: int) -> Any:
    """A longer copy of a contiguous array along its first axis; what is new holds anything.

    (Copied through flat views: slices of several dimensions take numba seconds to compile.)
    """
    longer = np.empty((capacity,) + array.shape[1:], array.dtype)
    source, target = array.reshape(-1), longer.reshape(-1)
    target[: len(source)] = source
    return longer
