"""Remove the flagged tetras: the last ones go, the rightmost valid ones fill the gaps. Source: thesis, 5.10.3.

The printed version forgets what that does to vertices: they may become isolated, their tetras may fall apart. Here the
access half-faces of every vertex of a flagged tetra are made right. O(n), of which all but a look at every tetra and vertex
is in proportion to what goes.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from tetrabench.backends.tetra.halfface.edit import settle
from tetrabench.backends.tetra.halfface.storage import (
    FLAGGED,
    FREE_RECORDS,
    NONE,
    RECORDS,
    TETRAS,
    VERTICES,
    HalfFaces,
    add_record,
    first_record,
    free_border,
    free_record,
    inner,
    inner_of,
    is_border,
    is_flagged,
    isolated,
    next_record,
    number_of,
    opposite_of,
    reserve,
    take_border,
    tetra_of,
    vertex_at,
)
from tetrabench.jit import kernel


def collect(mesh: HalfFaces) -> tuple[HalfFaces, NDArray[np.int64], NDArray[np.int64]]:
    """Remove the flagged tetras.

    Returns the storage to go on with, and who moved: tetras `moved_from` (k,) int64 have become `moved_to` (k,) int64.
    What is left are the tetras below the new count.
    """
    flagged = int(mesh.counters[FLAGGED])
    if flagged == 0:
        nobody = np.empty(0, np.int64)
        return mesh, nobody, nobody
    gone = np.empty(flagged, np.int64)
    _list_flagged(mesh, gone)
    starts, corners = np.zeros(int(mesh.counters[VERTICES]) + 2, np.int64), np.empty(4 * flagged, np.int64)
    moved_from, moved_to = np.empty(flagged, np.int64), np.empty(flagged, np.int64)
    borders = _group_by_vertex(mesh, gone, starts, corners)
    mesh = reserve(mesh, borders=int(borders))
    _prune(mesh, starts, corners)
    _unlink(mesh, gone)
    v = 0
    while v < mesh.counters[VERTICES]:
        mesh = reserve(mesh, records=3 * int(starts[v + 1] - starts[v]) + 2)
        v = _correct(mesh, starts, corners, v)
    moved = _compact(mesh, gone, moved_from, moved_to)
    return mesh, moved_from[:moved], moved_to[:moved]


@kernel(allocates=False)
def _list_flagged(mesh: HalfFaces, gone: Any) -> None:
    """The flagged tetras, ascending."""
    n = 0
    for t in range(mesh.counters[TETRAS]):
        if is_flagged(mesh, t):
            gone[n] = t
            n += 1


@kernel(allocates=False)
def _group_by_vertex(mesh: HalfFaces, gone: Any, starts: Any, corners: Any) -> Any:
    """The corners of what goes, those of vertex v at corners[starts[v]:starts[v + 1]]; how many faces become border."""
    borders = 0
    for t in gone:
        for k in range(4):
            starts[vertex_at(mesh, t, k) + 2] += 1
            opposite = opposite_of(mesh, t, k)
            if not is_border(mesh, opposite) and not is_flagged(mesh, tetra_of(mesh, opposite)):
                borders += 1
    for v in range(2, len(starts)):
        starts[v] += starts[v - 1]
    for t in gone:
        for k in range(4):
            v = vertex_at(mesh, t, k)
            corners[starts[v + 1]] = t << 2 | k
            starts[v + 1] += 1
    return borders


@kernel(allocates=False, inline=True)
def _hangs_together(mesh: HalfFaces, v: int, going: int) -> Any:
    """Whether what is left around a vertex is one component for sure: one or two tetras go from one without border.

    The triangles opposite the vertex in its tetras are a closed surface, no two edges of which have the same ends. Two
    edges do not cut it, then, and so two of its triangles do not (their graph is cubic: it hangs together by three).
    """
    record, place = first_record(mesh, v)
    return going <= 2 and place == NONE and not is_border(mesh, record)


@kernel(allocates=False)
def _beside(mesh: HalfFaces, corner: int) -> Any:
    """A half-face at a corner's vertex of a tetra that stays, opposite one of a tetra that goes; NONE if there is none."""
    found = NONE
    for x in range(4):
        if x != 3 - (corner & 3):
            opposite = opposite_of(mesh, corner >> 2, x)
            if not is_border(mesh, opposite) and not is_flagged(mesh, tetra_of(mesh, opposite)):
                found = opposite
    return found


@kernel(allocates=False)
def _prune(mesh: HalfFaces, starts: Any, corners: Any) -> None:
    """Take away the access half-faces that go. Where the rest hangs together for sure, put one beside what goes instead.

    The first of such a vertex's corners is marked: it becomes -1 - corner.
    """
    for v in range(mesh.counters[VERTICES]):
        going = starts[v + 1] - starts[v]
        if going > 0:
            record, place = first_record(mesh, v)
            if _hangs_together(mesh, v, going):
                mesh.v2hf[v] = _beside(mesh, corners[starts[v]])
                corners[starts[v]] = -1 - corners[starts[v]]
            elif place == NONE:
                if is_flagged(mesh, tetra_of(mesh, inner_of(mesh, record))):
                    mesh.v2hf[v] = isolated(mesh)
            else:
                mesh.v2hf[v] = isolated(mesh)
                while place != NONE:
                    here, halfface = place, record
                    record, place = next_record(mesh, place)
                    free_record(mesh, here)
                    if not is_flagged(mesh, tetra_of(mesh, inner_of(mesh, halfface))):
                        add_record(mesh, v, halfface)


@kernel(allocates=False)
def _unlink(mesh: HalfFaces, gone: Any) -> None:
    """Free the border half-faces of what goes, and make new ones where it leaves somebody behind."""
    for t in gone:
        for x in range(4):
            opposite = opposite_of(mesh, t, x)
            if is_border(mesh, opposite):
                free_border(mesh, opposite)
            elif not is_flagged(mesh, tetra_of(mesh, opposite)):
                take_border(mesh, tetra_of(mesh, opposite), number_of(mesh, opposite))


@kernel(allocates=False)
def _correct(mesh: HalfFaces, starts: Any, corners: Any, begin: int) -> Any:
    """Make the access half-faces right of all vertices from `begin` on that lose a tetra.

    Every component that is left was not touched, and has its access half-face, or lies beside something that went.
    Returns the vertex to go on with when there is more room for records, which is beyond the last one at the end.
    """
    counters = mesh.counters
    for v in range(begin, counters[VERTICES]):
        going = starts[v + 1] - starts[v]
        if going == 0:
            continue
        if corners[starts[v]] < 0:
            beside = np.int64(mesh.v2hf[v])
            mesh.v2hf[v] = opposite_of(mesh, tetra_of(mesh, beside), number_of(mesh, beside))
            continue
        if counters[RECORDS] - counters[FREE_RECORDS] + 3 * going + 2 > len(mesh.v2nhf):
            return v
        for n in range(starts[v], starts[v + 1]):
            for x in range(4):
                if x != 3 - (corners[n] & 3):
                    beside = opposite_of(mesh, corners[n] >> 2, x)
                    if not is_border(mesh, beside) and not is_flagged(mesh, tetra_of(mesh, beside)):
                        add_record(mesh, v, beside)
        settle(mesh, v)
    return counters[VERTICES]


@kernel(allocates=False)
def _compact(mesh: HalfFaces, gone: Any, moved_from: Any, moved_to: Any) -> Any:
    """Fill the gaps that flagged tetras leave with the rightmost valid ones; returns how many moved."""
    counters = mesh.counters
    left, moved, right = counters[TETRAS] - len(gone), 0, counters[TETRAS] - 1
    for gap in gone:
        if gap < left:
            while is_flagged(mesh, right):
                right -= 1
            _move(mesh, right, gap)
            moved_from[moved], moved_to[moved] = right, gap
            moved += 1
            right -= 1
    counters[TETRAS] = left
    counters[FLAGGED] = 0
    return moved


@kernel(allocates=False)
def _move(mesh: HalfFaces, old: int, new: int) -> None:
    """Renumber a tetra, where it stands and wherever it is named."""
    for k in range(4):
        mesh.connectivity[new, k] = mesh.connectivity[old, k]
    for x in range(4):
        opposite = opposite_of(mesh, old, x)
        mesh.adjacency[new, x] = opposite
        if is_border(mesh, opposite):
            mesh.bhf2hf[opposite] = inner(mesh, new, x)
        else:
            mesh.adjacency[tetra_of(mesh, opposite), number_of(mesh, opposite)] = inner(mesh, new, x)
    for k in range(4):
        v = vertex_at(mesh, new, k)
        record, place = first_record(mesh, v)
        while record != NONE:
            if not is_border(mesh, record) and tetra_of(mesh, record) == old:
                renamed = inner(mesh, new, number_of(mesh, record))
                if place == NONE:
                    mesh.v2hf[v] = renamed
                else:
                    mesh.v2nhf[place, 0] = renamed
            record, place = next_record(mesh, place)
