"""Put an eventual mesh into its main mesh as a whole, or not at all. Source: thesis, 5.10.4.

The printed test looks at the border of the eventual mesh alone. A face inside it that the main mesh has too would be
shared by three as well, so it is looked for here.
"""

from typing import Any

import numpy as np

from tetrabench.backends.tetra.halfface.edit import SHARED, TWICE, settle
from tetrabench.backends.tetra.halfface.find import find_halfface, has_vertex
from tetrabench.backends.tetra.halfface.storage import (
    BORDERS,
    FLAGGED,
    FREE_RECORDS,
    LARGEST_FAN,
    NONE,
    RECORDS,
    TETRAS,
    VERTICES,
    HalfFaces,
    add_record,
    first_record,
    free_border,
    inner,
    inner_of,
    is_border,
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


def conjoin(mesh: HalfFaces, eventual: HalfFaces) -> tuple[HalfFaces, int]:
    """Put the tetras of an eventual mesh, which has the same vertices, behind those of the main mesh.

    Returns the storage to go on with, and 0; or the storage as it was, and why it cannot be (see `edit.REFUSALS`).
    """
    tetras = int(eventual.counters[TETRAS])
    if tetras == 0:
        return mesh, 0
    partners = np.full(int(eventual.counters[BORDERS]), NONE, np.int64)
    refusal = int(_find_partners(mesh, eventual, partners))
    if refusal:
        return mesh, refusal
    borders, fan = int(eventual.counters[BORDERS]), int(eventual.counters[LARGEST_FAN])
    mesh = reserve(mesh, tetras=tetras, borders=borders, fan=fan)
    before = int(mesh.counters[TETRAS])
    _append(mesh, eventual, partners)
    v, vertices = 0, int(eventual.counters[VERTICES])
    while v < vertices:
        mesh = reserve(mesh, records=int(_count_records(eventual, v)) + 2)
        v = _merge_access(mesh, eventual, before, v)
    _free_partners(mesh, partners)
    mesh.counters[LARGEST_FAN] += fan
    return mesh, 0


@kernel(allocates=False)
def _find_partners(mesh: HalfFaces, eventual: HalfFaces, partners: Any) -> Any:
    """For each border half-face of the eventual mesh the one of the main mesh with the same vertices; or a refusal, or 0."""
    refusal = 0
    for t in range(eventual.counters[TETRAS]):
        for x in range(4):
            lacking = vertex_at(eventual, t, 3 - x)
            opposite = opposite_of(eventual, t, x)
            found = NONE
            if is_border(eventual, opposite) or opposite > inner(eventual, t, x):  # once for each pair
                found = _find_face(mesh, eventual, t, x)
            if found != NONE:
                if has_vertex(mesh, tetra_of(mesh, inner_of(mesh, found)), lacking):
                    refusal = TWICE
                elif not is_border(mesh, found) or not is_border(eventual, opposite):
                    refusal = SHARED
                else:
                    partners[opposite] = found
    return refusal


@kernel(allocates=False)
def _find_face(mesh: HalfFaces, eventual: HalfFaces, t: int, x: int) -> Any:
    """The half-face in the main mesh with the vertices of half-face x of tetra t of the eventual mesh, or NONE."""
    a = vertex_at(eventual, t, 0 if x != 3 else 1)
    b = vertex_at(eventual, t, 1 if x < 2 else 2)
    c = vertex_at(eventual, t, 2 if x == 0 else 3)
    found = NONE
    if first_record(mesh, a)[0] != NONE and first_record(mesh, b)[0] != NONE and first_record(mesh, c)[0] != NONE:
        found = find_halfface(mesh, a, b, c)
    return found


@kernel(allocates=False)
def _append(mesh: HalfFaces, eventual: HalfFaces, partners: Any) -> None:
    """Put the tetras behind the others, renumbered, and join them to those at the border where they have partners."""
    counters = mesh.counters
    before = counters[TETRAS]
    counters[TETRAS] = before + eventual.counters[TETRAS]
    counters[FLAGGED] += eventual.counters[FLAGGED]
    for t in range(eventual.counters[TETRAS]):
        new = before + t
        for k in range(4):
            mesh.connectivity[new, k] = eventual.connectivity[t, k]
        for x in range(4):
            opposite = opposite_of(eventual, t, x)
            if not is_border(eventual, opposite):
                mesh.adjacency[new, x] = _renumbered(mesh, eventual, opposite, before)
            elif partners[opposite] == NONE:
                take_border(mesh, new, x)
            else:
                partner = inner_of(mesh, partners[opposite])
                mesh.adjacency[new, x] = partner
                mesh.adjacency[tetra_of(mesh, partner), number_of(mesh, partner)] = inner(mesh, new, x)


@kernel(allocates=False, inline=True)
def _renumbered(mesh: HalfFaces, eventual: HalfFaces, halfface: int, before: int) -> Any:
    """An inner half-face of the eventual mesh as it is called in the main mesh."""
    return inner(mesh, before + tetra_of(eventual, halfface), number_of(eventual, halfface))


@kernel(allocates=False)
def _count_records(mesh: HalfFaces, v: int) -> Any:
    count = 0
    record, place = first_record(mesh, v)
    while record != NONE:
        count += 1
        record, place = next_record(mesh, place)
    return count


@kernel(allocates=False)
def _merge_access(mesh: HalfFaces, eventual: HalfFaces, before: int, begin: int) -> Any:
    """Give the vertices from `begin` on the access half-faces of the eventual mesh, less those that are redundant now.

    Returns the vertex to go on with when there is more room for records, which is beyond the last one at the end.
    """
    counters = mesh.counters
    for v in range(begin, eventual.counters[VERTICES]):
        record, place = first_record(eventual, v)
        if record != NONE:
            if counters[RECORDS] - counters[FREE_RECORDS] + _count_records(eventual, v) + 2 > len(mesh.v2nhf):
                return v
            alone = mesh.v2hf[v] == isolated(mesh)
            while record != NONE:
                access = _renumbered(mesh, eventual, inner_of(eventual, record), before)
                if alone and is_border(eventual, record):  # nothing was joined at this vertex
                    access = opposite_of(mesh, tetra_of(mesh, access), number_of(mesh, access))
                add_record(mesh, v, access)
                record, place = next_record(eventual, place)
            if not alone:
                settle(mesh, v)
    return eventual.counters[VERTICES]


@kernel(allocates=False)
def _free_partners(mesh: HalfFaces, partners: Any) -> None:
    """Give back the border half-faces that were joined, which the access half-faces of vertices led over until now."""
    for partner in partners:
        if partner != NONE:
            free_border(mesh, partner)
