"""What a user of our half-face mesh would write: example 1, the walk around all vertices, a cube by formula."""

from typing import Any

import numpy as np

from tetrabench.backends.tetra.halfface.storage import TETRAS, HalfFaces, is_flagged, vertex_at
from tetrabench.backends.tetra.halfface.walks import walk_fan
from tetrabench.jit import kernel


@kernel(allocates=False)
def nearest_to_centroid(mesh: HalfFaces, xyz: Any) -> Any:
    """Volume of the tetra whose centroid is nearest to that of the mesh, in which tetras weigh by their volume.

    `xyz` (vertices, 3) float64: an attribute. Source: thesis, 7.3, example 1.
    """
    whole, x, y, z = 0.0, 0.0, 0.0, 0.0
    for t in range(mesh.counters[TETRAS]):
        if not is_flagged(mesh, t):
            volume = _volume(mesh, t, xyz)
            cx, cy, cz = _centroid(mesh, t, xyz)
            whole += volume
            x, y, z = x + volume * cx, y + volume * cy, z + volume * cz
    x, y, z = x / whole, y / whole, z / whole
    least, found = np.inf, 0.0
    for t in range(mesh.counters[TETRAS]):
        if not is_flagged(mesh, t):
            cx, cy, cz = _centroid(mesh, t, xyz)
            distance = (cx - x) * (cx - x) + (cy - y) * (cy - y) + (cz - z) * (cz - z)
            if distance < least:
                least, found = distance, _volume(mesh, t, xyz)
    return found


@kernel(allocates=False, inline=True)
def _volume(mesh: HalfFaces, t: int, xyz: Any) -> Any:
    p, q, r, s = _rows(mesh, t)
    ax, ay, az = xyz[q, 0] - xyz[p, 0], xyz[q, 1] - xyz[p, 1], xyz[q, 2] - xyz[p, 2]
    bx, by, bz = xyz[r, 0] - xyz[p, 0], xyz[r, 1] - xyz[p, 1], xyz[r, 2] - xyz[p, 2]
    cx, cy, cz = xyz[s, 0] - xyz[p, 0], xyz[s, 1] - xyz[p, 1], xyz[s, 2] - xyz[p, 2]
    return abs(ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)) / 6.0


@kernel(allocates=False, inline=True)
def _centroid(mesh: HalfFaces, t: int, xyz: Any) -> tuple[Any, Any, Any]:
    p, q, r, s = _rows(mesh, t)
    return (
        (xyz[p, 0] + xyz[q, 0] + xyz[r, 0] + xyz[s, 0]) / 4.0,
        (xyz[p, 1] + xyz[q, 1] + xyz[r, 1] + xyz[s, 1]) / 4.0,
        (xyz[p, 2] + xyz[q, 2] + xyz[r, 2] + xyz[s, 2]) / 4.0,
    )


@kernel(allocates=False, inline=True)
def _rows(mesh: HalfFaces, t: int) -> tuple[Any, Any, Any, Any]:
    """The vertices of a tetra as numbers that cannot be negative: an index that could be costs a test."""
    return (
        np.uint64(vertex_at(mesh, t, 0)),
        np.uint64(vertex_at(mesh, t, 1)),
        np.uint64(vertex_at(mesh, t, 2)),
        np.uint64(vertex_at(mesh, t, 3)),
    )


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
