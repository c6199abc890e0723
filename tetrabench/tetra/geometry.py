"""Static data of a tetra from its four points: volume, centroid, side areas, outward side normals."""

from typing import Any

import numpy as np
from numba.extending import register_jitable

from tetrabench.jit import kernel
from tetrabench.tetra.interface import (
    Net,
    set_centroid,
    set_side_area,
    set_side_normal,
    set_volume,
    vertex,
)


@kernel(allocates=False, inline=True)
def set_geometry(net: Net, t: int) -> None:
    """Compute and store the static data of tetra t, whose vertices are stored already."""
    xyz = net.points.xyz
    p0, p1, p2, p3 = vertex(net, t, 0), vertex(net, t, 1), vertex(net, t, 2), vertex(net, t, 3)
    set_volume(net, t, abs(signed_volume(xyz, p0, p1, p2, p3)))
    for k in range(3):
        set_centroid(net, t, k, (xyz[p0, k] + xyz[p1, k] + xyz[p2, k] + xyz[p3, k]) / 4.0)
    _set_side(net, t, 0, side_geometry(xyz, p1, p2, p3, p0))
    _set_side(net, t, 1, side_geometry(xyz, p2, p3, p0, p1))
    _set_side(net, t, 2, side_geometry(xyz, p3, p0, p1, p2))
    _set_side(net, t, 3, side_geometry(xyz, p0, p1, p2, p3))


@kernel(allocates=False)
def signed_volume(xyz: Any, p0: int, p1: int, p2: int, p3: int) -> float:
    """(p1 - p0) . ((p2 - p0) x (p3 - p0)) / 6: positive where p1, p2, p3 run counter-clockwise seen from p0's far side."""
    ax, ay, az = xyz[p1, 0] - xyz[p0, 0], xyz[p1, 1] - xyz[p0, 1], xyz[p1, 2] - xyz[p0, 2]
    bx, by, bz = xyz[p2, 0] - xyz[p0, 0], xyz[p2, 1] - xyz[p0, 1], xyz[p2, 2] - xyz[p0, 2]
    cx, cy, cz = xyz[p3, 0] - xyz[p0, 0], xyz[p3, 1] - xyz[p0, 1], xyz[p3, 2] - xyz[p0, 2]
    return (ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)) / 6.0


@kernel(allocates=False)
def side_geometry(xyz: Any, a: int, b: int, c: int, opposite: int) -> tuple[float, float, float, float]:
    """Area and outward unit normal of the side (a, b, c): half the cross product, turned away from the opposite vertex."""
    ux, uy, uz = xyz[b, 0] - xyz[a, 0], xyz[b, 1] - xyz[a, 1], xyz[b, 2] - xyz[a, 2]
    vx, vy, vz = xyz[c, 0] - xyz[a, 0], xyz[c, 1] - xyz[a, 1], xyz[c, 2] - xyz[a, 2]
    wx, wy, wz = xyz[opposite, 0] - xyz[a, 0], xyz[opposite, 1] - xyz[a, 1], xyz[opposite, 2] - xyz[a, 2]
    nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    length = np.sqrt(nx * nx + ny * ny + nz * nz)
    factor = 1.0 / length if length > 0.0 else 0.0
    if nx * wx + ny * wy + nz * wz > 0.0:
        factor = -factor
    return length / 2.0, factor * nx, factor * ny, factor * nz


@register_jitable
def _set_side(net: Net, t: int, i: int, side: tuple[float, float, float, float]) -> None:
    set_side_area(net, t, i, side[0])
    set_side_normal(net, t, i, 0, side[1])
    set_side_normal(net, t, i, 1, side[2])
    set_side_normal(net, t, i, 2, side[3])
