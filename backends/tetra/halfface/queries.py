"""All elements that belong to one in a certain way (`one_to_all`), by vertex sets, asked around one of its vertices.

Source: thesis, 5.9. A kind is a number here: see VERTEX and so on. An edge is first << 31 | second, first < second.
"""

from typing import Any

import numpy as np

from tetrabench.backends.tetra.halfface.find import has_vertex
from tetrabench.backends.tetra.halfface.storage import (
    NONE,
    HalfFaces,
    inner,
    inner_of,
    is_border,
    number_of,
    opposite_of,
    tetra_of,
    vertex_at,
)
from tetrabench.backends.tetra.halfface.walks import walk_fan
from tetrabench.jit import kernel

VERTEX, EDGE, HALFFACE, TETRAHEDRON = 1, 2, 3, 4
"""Kinds of elements, by how many vertices they have."""

EDGE_BITS = 31
MOST_FROM_A_TETRA = 8
"""No query takes more elements than that from one tetra it meets."""


@kernel(allocates=False, inline=True)
def edge_of(a: int, b: int) -> Any:
    """The edge of two vertices."""
    return np.int64(min(a, b)) << EDGE_BITS | np.int64(max(a, b))


@kernel(allocates=False)
def list_vertices(mesh: HalfFaces, source: int, handle: int, vertices: Any) -> None:
    """The vertices of an element, ascending; as many of `vertices` (4,) int64 as it has, NONE in the others."""
    vertices[:] = NONE
    if source == VERTEX:
        vertices[0] = handle
    elif source == EDGE:
        vertices[0], vertices[1] = handle >> EDGE_BITS, handle & ((1 << EDGE_BITS) - 1)
    elif source == HALFFACE:
        halfface = inner_of(mesh, handle)
        t, n = tetra_of(mesh, halfface), 0
        for place in range(4):
            if place != 3 - number_of(mesh, halfface):
                vertices[n] = vertex_at(mesh, t, place)
                n += 1
    else:
        for place in range(4):
            vertices[place] = vertex_at(mesh, handle, place)


@kernel(allocates=False)
def list_many(
    mesh: HalfFaces, target: int, source: int, handles: Any, begin: int, starts: Any, found: Any, vertices: Any
) -> Any:
    """The elements of kind `target` of each of `handles` (n,) from `begin` on, ascending: found[starts[i]:starts[i + 1]].

    `vertices` (4,) int64 is for its own use. Stops where `found` has no room for what the next one might have. Returns
    which that is, n at the end.
    """
    for i in range(begin, len(handles)):
        end = _list_one(mesh, target, source, handles[i], vertices, starts[i], found)
        if end < 0:
            return i
        starts[i + 1] = _sort_and_unite(found, starts[i], end)
    return len(handles)


@kernel(allocates=False)
def _list_one(mesh: HalfFaces, target: int, source: int, handle: int, vertices: Any, n: int, found: Any) -> Any:
    """Append the elements of one, some of them twice; -1 where there is no room."""
    if n + 64 > len(found):
        return np.int64(-1)
    list_vertices(mesh, source, handle, vertices)
    a, b, c = vertices[0], vertices[1], vertices[2]
    if source == TETRAHEDRON and target >= HALFFACE:
        for x in range(4):
            opposite = opposite_of(mesh, handle, x)
            if target == HALFFACE:
                found[n], found[n + 1] = inner(mesh, handle, x), opposite
                n += 2
            elif not is_border(mesh, opposite):
                found[n] = tetra_of(mesh, opposite)
                n += 1
    elif target < source:
        n = _list_parts(target, source, vertices, n, found)
    elif source == VERTEX:
        n = _list_around(mesh, target, a, NONE, NONE, NONE, n, found)
    elif target == source:
        n = _list_around(
            mesh, target, a, b if source == HALFFACE else NONE, NONE, c if source == HALFFACE else b, n, found
        )
        if n >= 0:
            n = _list_around(mesh, target, b, c if source == HALFFACE else NONE, NONE, a, n, found)
        if n >= 0 and source == HALFFACE:
            n = _list_around(mesh, target, a, c, NONE, b, n, found)
    else:
        n = _list_around(mesh, target, a, b, c, NONE, n, found)
    return n


@kernel(allocates=False)
def _list_parts(target: int, source: int, vertices: Any, n: int, found: Any) -> Any:
    """Append the vertices or the edges of an element with `source` vertices."""
    for i in range(source):
        if target == VERTEX:
            found[n] = vertices[i]
            n += 1
        else:
            for j in range(i):
                found[n] = edge_of(vertices[j], vertices[i])
                n += 1
    return n


@kernel(allocates=False)
def _list_around(mesh: HalfFaces, target: int, a: int, b: int, c: int, without: int, n: int, found: Any) -> Any:
    """Append the elements with the vertices a, b and c (NONE: no further one), but for those with the vertex `without`.

    Returns how many there are now; -1 where there is no room.
    """
    tetras = walk_fan(mesh, a)
    if n + MOST_FROM_A_TETRA * tetras > len(found):
        return np.int64(-1)
    for place in range(tetras):
        t = mesh.queue[place] >> 2
        if (b != NONE and not has_vertex(mesh, t, b)) or (c != NONE and not has_vertex(mesh, t, c)):
            continue
        if target == TETRAHEDRON:
            found[n] = t
            n += 1
            continue
        has_without = has_vertex(mesh, t, without)
        for k in range(4):
            v = vertex_at(mesh, t, k)
            if v == a or v == b or v == c:
                continue
            if target == HALFFACE:
                if v == without or not has_without:  # the half-face that lacks v
                    found[n] = inner(mesh, t, 3 - k)
                    n += 1
                    opposite = opposite_of(mesh, t, 3 - k)
                    if is_border(mesh, opposite):
                        found[n] = opposite
                        n += 1
            elif v != without:
                found[n] = edge_of(a, v) if target == EDGE else v
                n += 1
    return n


@kernel(allocates=False)
def _sort_and_unite(found: Any, begin: int, end: int) -> Any:
    """Sort found[begin:end] (Shell's way: most are short) and drop what comes twice; returns the new end."""
    gap = 1
    while 3 * gap < end - begin:
        gap = 3 * gap + 1
    while gap > 0:
        for i in range(begin + gap, end):
            value, j = found[i], i
            while j - gap >= begin and found[j - gap] > value:
                found[j] = found[j - gap]
                j -= gap
            found[j] = value
        gap //= 3
    kept = begin
    for i in range(begin, end):
        if kept == begin or found[i] != found[kept - 1]:
            found[kept] = found[i]
            kept += 1
    return kept
