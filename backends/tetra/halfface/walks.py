"""Walking around a vertex, from tetra to tetra through the half-faces that have it. Source: thesis, 5.6.2; how is ours.

A **corner** is a tetra and the place of the vertex in it, 4 t + place. Connectivity is ascending, so the three vertices of a
face come in the same order in both its tetras, and the place in the one tells that in the other: a walk reads nothing
but adjacency. (Half-face X lacks place 3 - X: it has a vertex at place p as number p - (p > 3 - X), which is place
r + (r >= 3 - Y) behind half-face Y.)

What a walk has visited lies in the queue, and in a hash table of places in the queue. An entry of the table counts only from
the stamp of the walk on, so that nothing has to be cleared: the next walk's stamp is higher by what this one visited.
Walks are no part of the mesh's content, but they write: two threads need a queue, a table and a state each.
"""

from typing import Any

import numpy as np

from tetrabench.backends.tetra.halfface.compound import BORDER, INNER, base_of, extension_of
from tetrabench.backends.tetra.halfface.storage import (
    MASK,
    NONE,
    STAMP,
    VISITED,
    HalfFaces,
    first_record,
    inner,
    inner_of,
    next_record,
    place_in,
    tetra_of,
)
from tetrabench.jit import kernel
from tetrabench.jit.prefetch import prefetch

_FIRST_MASK = 63
_GOLDEN = 2654435769  # 2^32 times the golden section


@kernel(allocates=False, inline=True)
def corner_tetra(corner: int) -> Any:
    """The tetra of a corner."""
    return np.int64(corner) >> 2


@kernel(allocates=False, inline=True)
def corner_place(corner: int) -> Any:
    """The place of a corner's vertex in its tetra."""
    return np.int64(corner) & 3


@kernel(allocates=False, inline=True)
def corner_at(mesh: HalfFaces, halfface: int, vertex: int) -> Any:
    """The corner that a vertex has in the tetra of a half-face, of the opposite one where it lies on the border."""
    t = tetra_of(mesh, inner_of(mesh, halfface))
    return t << 2 | place_in(mesh, t, vertex)


@kernel(allocates=False, inline=True)
def place_behind(place: int, x: int, y: int) -> Any:
    """Where a vertex is behind half-face x, which is half-face y there, that has a place before."""
    rank = place - np.int64(place > 3 - x)
    return rank + np.int64(rank >= 3 - y)


@kernel(allocates=False, inline=True)
def through(mesh: HalfFaces, corner: int, x: int) -> tuple[Any, Any]:
    """The opposite half-face of half-face x at a corner's vertex, and the corner behind it; NONE behind the border."""
    opposite = np.int64(mesh.adjacency[np.uint64(corner >> 2), np.uint64(x)])
    extension = extension_of(mesh.adjacency, opposite)
    behind = NONE
    if extension != BORDER:
        place = place_behind(corner_place(corner), x, extension - INNER)
        behind = base_of(mesh.adjacency, opposite) << 2 | place
    return opposite, behind


@kernel(allocates=False)
def next_on_border(mesh: HalfFaces, t: int, x: int, a: int, b: int) -> tuple[Any, Any]:
    """The next half-face on the border around an edge of one that is there.

    Half-face x of tetra t lies opposite the border, and a and b are the places in t of two of its vertices. Returns the
    tetra and its half-face opposite the border where one arrives, through the tetras around that edge.
    """
    arrived = False
    while not arrived:
        y = 3 - (6 - a - b - (3 - x))  # the half-face that has the edge and is not x lacks the fourth vertex's place
        opposite = np.int64(mesh.adjacency[np.uint64(t), np.uint64(y)])
        extension = extension_of(mesh.adjacency, opposite)
        if extension == BORDER:
            arrived, x = True, y
        else:
            x = extension - INNER
            a, b = place_behind(a, y, x), place_behind(b, y, x)
            t = base_of(mesh.adjacency, opposite)
    return t, x


@kernel(allocates=False, inline=True)
def begin_walk(mesh: HalfFaces) -> None:
    """Forget what was visited."""
    walk = mesh.walk
    walk[STAMP] += walk[VISITED]
    walk[VISITED] = 0
    walk[MASK] = _FIRST_MASK


@kernel(allocates=False, inline=True)
def was_visited(mesh: HalfFaces, corner: int) -> Any:
    """Whether the walk has visited a corner."""
    return _find(mesh, corner, mesh.walk[STAMP], mesh.walk[MASK])[0]


@kernel(allocates=False)
def walk_component(mesh: HalfFaces, corner: int) -> Any:
    """Visit all corners that can be reached from one not yet visited, around its vertex. Needs room in the queue.

    Returns the last border half-face that was met, NONE where there is none.
    """
    queue = mesh.queue
    stamp, found, mask = mesh.walk[STAMP], mesh.walk[VISITED], mesh.walk[MASK]
    border, here = NONE, found
    stamp, found, mask = _visit(mesh, corner, stamp, found, mask)
    while here < found:
        corner = queue[here]
        here += 1
        lacking = 3 - corner_place(corner)
        for x in range(4):
            if x != lacking:
                opposite, behind = through(mesh, corner, x)
                if behind == NONE:
                    border = opposite
                else:
                    stamp, found, mask = _visit(mesh, behind, stamp, found, mask)
    mesh.walk[STAMP], mesh.walk[VISITED], mesh.walk[MASK] = stamp, found, mask
    return border


@kernel(allocates=False)
def walk_fan(mesh: HalfFaces, vertex: int) -> Any:
    """Visit all tetras of a vertex, flagged ones too: their corners are in the queue then. Returns how many there are."""
    begin_walk(mesh)
    record, place = first_record(mesh, vertex)
    while record != NONE:
        walk_component(mesh, corner_at(mesh, record, vertex))
        record, place = next_record(mesh, place)
    return mesh.walk[VISITED]


@kernel(allocates=False, inline=True)
def access_at(mesh: HalfFaces, corner: int, border: int) -> Any:
    """The access half-face of a component: a border one where there is one, else one of a corner's."""
    return border if border != NONE else inner(mesh, corner >> 2, 0 if corner & 3 != 3 else 1)


@kernel(allocates=False, inline=True)
def _visit(mesh: HalfFaces, corner: int, stamp: int, found: int, mask: int) -> tuple[Any, Any, Any]:
    """Append a corner to the queue unless it is there; returns the state of the walk."""
    known, place = _find(mesh, corner, stamp, mask)
    if not known:
        prefetch(mesh.adjacency, corner >> 2)
        mesh.queue[found] = corner
        mesh.table[place] = stamp + found
        found += 1
        if 2 * found > mask:  # never more than half full
            stamp, mask = _spread(mesh, stamp, found, mask)
    return stamp, found, mask


@kernel(allocates=False, inline=True)
def _find(mesh: HalfFaces, corner: int, stamp: int, mask: int) -> tuple[Any, Any]:
    """Whether a corner is in the table, and its place there, or the free one where it would be."""
    place = _hash(corner) & mask
    entry = mesh.table[np.uint64(place)]
    while entry >= stamp and mesh.queue[np.uint64(entry - stamp)] != corner:
        place = (place + 1) & mask
        entry = mesh.table[np.uint64(place)]
    return entry >= stamp, place


@kernel(allocates=False)
def _spread(mesh: HalfFaces, stamp: int, found: int, mask: int) -> tuple[Any, Any]:
    """Enter all of the queue anew into twice as much of the table."""
    stamp, mask = stamp + found, 2 * mask + 1
    if mask < len(mesh.table):
        for n in range(found):
            place = _hash(mesh.queue[n]) & mask
            while mesh.table[place] >= stamp:
                place = (place + 1) & mask
            mesh.table[place] = stamp + n
    else:
        mask = mask >> 1  # the table is as large as the queue wants it
        stamp -= found
    return stamp, mask


@kernel(allocates=False, inline=True)
def _hash(corner: int) -> Any:
    """Bits that depend on all bits of a corner."""
    folded = (corner ^ corner >> 31) & 0x7FFFFFFF  # 31 bits times 32 bits stay below 2^63
    return folded * _GOLDEN >> 29 & 0x3FFFFFFF
