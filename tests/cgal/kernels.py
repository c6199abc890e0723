"""What a user of our half-face mesh would write: example 1, the walk around all vertices, a cube by formula."""

from typing import Any

import numpy as np

from tetrabench.backends.tetra.halfface.storage import TETRAS, HalfFaces, is_flagged, vertex_at
from tetrabench.backends.tetra.halfface.walks import walk_fan
from tetrabench.jit import kernel


@kernel(allocates=False)
def nearest_to_centroid(mesh: HalfFaces, xyz: Any) -> Any:
    """Volume of the tetra whose centroid is nearest to that of the mesh, in which tetras weigh by their volume.

    `xyz` (vertices, 3) float64: an attribute. Source: thesis, 7.1, with the weights that its text says.
    """
    whole, x, y, z = 0.0, 0.0, 0.0, 0.0
    for t in range(mesh.counters[TETRAS]):
        if not is_flagged(mesh, t):
            volume, cx, cy, cz = _shape(mesh, t, xyz)
            whole += volume
            x, y, z = x + volume * cx, y + volume * cy, z + volume * cz
    x, y, z = x / whole, y / whole, z / whole
    least, found = np.inf, 0.0
    for t in range(mesh.counters[TETRAS]):
        if not is_flagged(mesh, t):
            volume, cx, cy, cz = _shape(mesh, t, xyz)
            distance = (cx - x) * (cx - x) + (cy - y) * (cy - y) + (cz - z) * (cz - z)
            if distance < least:
                least, found = distance, volume
    return found


@kernel(allocates=False, inline=True)
def _shape(mesh: HalfFaces, t: int, xyz: Any) -> tuple[Any, Any, Any, Any]:
    """Volume and centroid of a tetra."""
    p, q, r, s = (
        np.uint64(vertex_at(mesh, t, 0)),
        np.uint64(vertex_at(mesh, t, 1)),
        np.uint64(vertex_at(mesh, t, 2)),
        np.uint64(vertex_at(mesh, t, 3)),
    )
    px, py, pz = xyz[p, 0], xyz[p, 1], xyz[p, 2]
    qx, qy, qz = xyz[q, 0], xyz[q, 1], xyz[q, 2]
    rx, ry, rz = xyz[r, 0], xyz[r, 1], xyz[r, 2]
    sx, sy, sz = xyz[s, 0], xyz[s, 1], xyz[s, 2]
    ax, ay, az = qx - px, qy - py, qz - pz
    bx, by, bz = rx - px, ry - py, rz - pz
    cx, cy, cz = sx - px, sy - py, sz - pz
    volume = abs(ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)) / 6.0
    return volume, (px + qx + rx + sx) / 4.0, (py + qy + ry + sy) / 4.0, (pz + qz + rz + sz) / 4.0


@kernel(allocates=False)
def walk_all(mesh: HalfFaces, vertices: int) -> tuple[Any, Any]:
    """Sum of the tetras around all vertices, and how many there are."""
    total, visits = np.int64(0), np.int64(0)
    for v in range(vertices):
        found = walk_fan(mesh, v)
        for n in range(found):
            total += mesh.queue[n] >> 2
        visits += found
    return total, visits


@kernel(allocates=False)
def touch_all(mesh: HalfFaces, vertices: int) -> tuple[Any, Any]:
    """The same, of the smallest vertex of each tetra."""
    total, visits = np.int64(0), np.int64(0)
    for v in range(vertices):
        found = walk_fan(mesh, v)
        for n in range(found):
            total += vertex_at(mesh, mesh.queue[n] >> 2, 0)
        visits += found
    return total, visits


@kernel(allocates=False)
def cube(side: int, tets: Any, xyz: Any) -> None:
    """A cube of side^3 subcubes, six tetras each: tets (6 side^3, 4) int32, xyz ((side + 1)^3, 3) float64, in the unit cube.

    Each tetra goes from the lowest corner of its subcube to the highest one, along the axes in one of six orders (Kuhn 1960).
    """
    line, v, t = side + 1, 0, 0
    for z in range(line):
        for y in range(line):
            for x in range(line):
                xyz[v, 0], xyz[v, 1], xyz[v, 2] = x / side, y / side, z / side
                if x < side and y < side and z < side:
                    for k in range(6):
                        first, second = k % 3, (k + (1 if k < 3 else 2)) % 3
                        b = v + _step(line, first)
                        c = b + _step(line, second)
                        d = v + 1 + line + line * line
                        tets[t, 0], tets[t, 1] = v, b
                        tets[t, 2], tets[t, 3] = (c, d) if k < 3 else (d, c)
                        t += 1
                v += 1


@kernel(allocates=False, inline=True)
def _step(line: int, axis: int) -> Any:
    """How far the next vertex along an axis is."""
    return 1 if axis == 0 else line if axis == 1 else line * line
