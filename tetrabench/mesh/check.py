"""check_mesh: what no net may hold, found before a net is built."""

import numpy as np
from numpy.typing import NDArray

from tetrabench.errors import InputError
from tetrabench.jit import kernel
from tetrabench.mesh.tetra_mesh import TetraMesh

FINE, RANGE, REPEATED, DUPLICATE = 0, 1, 2, 3


def check_mesh(mesh: TetraMesh) -> None:
    """Refuse a mesh that no net may hold.

    Raises:
        InputError: arrays of the wrong shape or kind, a coordinate that is NaN or infinite, a tetra with a
            vertex out of range, a tetra that repeats a vertex, two tetras of the same four vertices.
    """
    name = mesh.report.source or "mesh"
    points, tets = np.asarray(mesh.points), np.asarray(mesh.tets)
    if points.ndim != 2 or points.shape[1] != 3 or points.dtype.kind not in "fiu":
        raise InputError(f"{name}: points must be numbers of shape (n, 3), not {points.dtype} {points.shape}")
    if tets.ndim != 2 or tets.shape[1] != 4 or tets.dtype.kind not in "iu":
        raise InputError(f"{name}: tets must be integers of shape (m, 4), not {tets.dtype} {tets.shape}")
    if np.shape(mesh.point_ids) != (len(points),) or np.shape(mesh.tet_ids) != (len(tets),):
        raise InputError(f"{name}: point_ids and tet_ids must hold one number for each point and each tetra")
    fault = find_fault(points, tets)
    if fault is not None:
        kind, row, reason = fault
        number = (mesh.point_ids if kind == "point" else mesh.tet_ids)[row]
        raise InputError(f"{name}: {kind} {number} (row {row}) {reason}")


def find_fault(points: NDArray[np.float64], tets: NDArray[np.integer]) -> tuple[str, int, str] | None:
    """Find the first thing that no net may hold, in two arrays.

    Args:
        points: (n, 3) float64.
        tets: (m, 4) of any integer type.

    Returns:
        "point" or "tetra", its row and the reason; None where there is no fault.
    """
    finite = np.isfinite(points)
    if not finite.all():
        return "point", int(np.argmin(finite.all(axis=1))), "has a coordinate that is NaN or infinite"
    # Numbers that int32 cannot hold must not wrap around into range.
    small = tets if tets.dtype == np.int32 else np.clip(tets, -1, len(points))
    held = np.require(small, np.int32, ["C", "W"])
    fault, row, other = first_fault(held, len(points))
    vertices = "{} {} {} {}".format(*tets[row]) if fault else ""
    reasons = {
        RANGE: f"has the vertices {vertices}, but the indices run from 0 to {len(points) - 1}",
        REPEATED: "repeats a vertex",
        DUPLICATE: f"has the same four vertices as the tetra of row {other}",
    }
    return ("tetra", int(row), reasons[fault]) if fault else None


@kernel
def first_fault(tets: NDArray[np.int32], points: int) -> tuple[int, int, int]:
    """Find the first tetra that is out of range, repeats a vertex or repeats an earlier tetra.

    Duplicates are found in a hash table of the sorted vertices, open addressing, less than half full: one
    pass, whatever the numbering. The multiplier is Knuth's (The Art of Computer Programming 3, 6.4): 2^32
    times the golden section.

    Args:
        tets: (m, 4) int32, C-contiguous.
        points: the number of points.

    Returns:
        FINE, RANGE, REPEATED or DUPLICATE; the row; for DUPLICATE the row of the earlier tetra.
    """
    size = 2
    while size < 2 * tets.shape[0]:
        size *= 2
    table = np.full(size, -1, np.int32)
    for t in range(tets.shape[0]):
        low, high = min(tets[t, 0], tets[t, 1]), max(tets[t, 0], tets[t, 1])
        lower, higher = min(tets[t, 2], tets[t, 3]), max(tets[t, 2], tets[t, 3])
        a, d = min(low, lower), max(high, higher)
        b, c = max(low, lower), min(high, higher)
        if b > c:
            b, c = c, b
        if a < 0 or d >= points:
            return RANGE, t, t
        if a == b or b == c or c == d:
            return REPEATED, t, t
        place = 0
        for vertex in (a, b, c, d):  # 31 bits times 32 bits stay below 2^63
            place = ((place ^ int(vertex)) * 2654435769) >> 7 & 0x7FFFFFFF
        place &= size - 1
        while table[place] >= 0:
            s = int(table[place])
            common = 0
            for k in range(4):
                common += tets[s, k] in (a, b, c, d)
            if common == 4:
                return DUPLICATE, t, s
            place = (place + 1) & (size - 1)
        table[place] = t
    return FINE, 0, 0


def settle(mesh, *, where, unused="drop", repair="refuse"):
    """Stand-in."""
    from tetrabench.mesh.quality import signed_volumes
    fault = find_fault(mesh.points, mesh.tets)
    if fault is not None:
        kind, row, sentence = fault
        raise InputError(f"{where(kind, row)} {sentence}")
    used = np.zeros(len(mesh.points), np.bool_)
    used[mesh.tets.ravel()] = True
    mesh.report.unreferenced = int(len(used) - np.count_nonzero(used))
    if unused == "drop" and not used.all():
        moved = (np.cumsum(used, dtype=np.int32) - np.int32(1))[mesh.tets]
        mesh = TetraMesh(mesh.points[used], moved, mesh.point_ids[used], mesh.tet_ids.copy(), mesh.report)
    mesh.report.inverted = int(np.count_nonzero(signed_volumes(mesh.points, mesh.tets) < 0))
    return mesh
