"""One tetra more, one vertex more or less, flags. A refused change leaves the mesh as it was. Source: thesis, 5.10.1."""

from typing import Any

import numpy as np

from tetrabench.backends.tetra.halfface.compound import FLAG, compound, extension_of
from tetrabench.backends.tetra.halfface.permutations import sorted_with_number
from tetrabench.backends.tetra.halfface.storage import (
    BORDERS,
    DELETED_VERTEX,
    DELETED_VERTICES,
    FLAGGED,
    FREE_BORDERS,
    FREE_RECORDS,
    LARGEST_FAN,
    NONE,
    RECORDS,
    TETRAS,
    VERTICES,
    HalfFaces,
    add_record,
    chained,
    first_record,
    free_border,
    free_record,
    inner,
    is_border,
    is_flagged,
    isolated,
    next_in_chain,
    next_record,
    number_of,
    opposite_of,
    place_in,
    says_deleted,
    take_border,
    tetra_of,
    vertex_at,
)
from tetrabench.backends.tetra.halfface.walks import (
    access_at,
    begin_walk,
    corner_at,
    next_on_border,
    walk_component,
    walk_fan,
    was_visited,
)
from tetrabench.jit import kernel

# Why a tetra cannot be added: what add_tetrahedron returns instead of it.
EQUAL, UNKNOWN, GONE, TWICE, SHARED, FULL = -2, -3, -4, -5, -6, -7
REFUSALS = {
    EQUAL: "the four vertices of a tetra must differ",
    UNKNOWN: "there is no such vertex",
    GONE: "one of the vertices is deleted",
    TWICE: "there is such a tetra already",
    SHARED: "two tetras share that face already",
    FULL: "no room for a tetra: call reserve first",
}
"""The sentence for each."""


@kernel(allocates=False)
def add_tetrahedron(mesh: HalfFaces, a: int, b: int, c: int, d: int) -> Any:
    """Add the tetra of four vertices, and return it; or why it cannot be, below -1. Flagged tetras block, like others."""
    counters = mesh.counters
    v0, v1, v2, v3, number = sorted_with_number(a, b, c, d)
    if v0 == v1 or v1 == v2 or v2 == v3:
        return EQUAL
    if v0 < 0 or v3 >= counters[VERTICES]:
        return UNKNOWN
    if says_deleted(mesh, v0) or says_deleted(mesh, v1) or says_deleted(mesh, v2) or says_deleted(mesh, v3):
        return GONE
    fits, h0, h1, h2, h3 = _faces_of_hole(mesh, v0, v1, v2, v3)
    if not fits:
        h0, h1, h2, refusal = _faces_around(mesh, v0, v1, v2, v3)
        if refusal != 0:
            return refusal
        h3, refusal = _face_beyond(mesh, v1, v2, v3)
        if refusal != 0:
            return refusal
    t = counters[TETRAS]
    if (
        t >= len(mesh.connectivity)
        or counters[BORDERS] - counters[FREE_BORDERS] + 4 > len(mesh.bhf2hf)
        or counters[RECORDS] - counters[FREE_RECORDS] + 8 > len(mesh.v2nhf)
        or counters[LARGEST_FAN] + 1 > len(mesh.queue)
    ):
        return FULL
    counters[TETRAS] = t + 1
    counters[LARGEST_FAN] += 1
    _write(mesh, t, v0, v1, v2, v3, number)
    freed0, freed1 = _join(mesh, t, 0, h0), _join(mesh, t, 1, h1)
    freed2, freed3 = _join(mesh, t, 2, h2), _join(mesh, t, 3, h3)
    for place in range(4):
        _correct_access(mesh, t, place, freed0, freed1, freed2, freed3)
    _free(mesh, freed0)
    _free(mesh, freed1)
    _free(mesh, freed2)
    _free(mesh, freed3)
    return t


@kernel(allocates=False)
def _faces_of_hole(mesh: HalfFaces, v0: int, v1: int, v2: int, v3: int) -> tuple[Any, Any, Any, Any, Any]:
    """Whether the tetra fills a hole that just fits it, and the half-faces (v0, v1, v2), (v0, v1, v3) ... of the hole.

    Found from the access half-face of v0 by going around three edges, which is a short way; if they are not found this
    way they may be there all the same. (Where all four are opposite the border nothing can be shared by three.)
    """
    record, listed = first_record(mesh, v0)
    if listed != NONE or record == NONE or not is_border(mesh, record):
        return False, NONE, NONE, NONE, NONE
    t, x = tetra_of(mesh, mesh.bhf2hf[record]), number_of(mesh, mesh.bhf2hf[record])
    p0 = place_in(mesh, t, v0)
    pa = np.int64(0)
    while pa == p0 or pa == 3 - x:
        pa += 1
    pb = 6 - p0 - pa - (3 - x)
    a, b = vertex_at(mesh, t, pa), vertex_at(mesh, t, pb)
    c = v1 + v2 + v3 - a - b
    if (a != v1 and a != v2 and a != v3) or (b != v1 and b != v2 and b != v3) or vertex_at(mesh, t, 3 - x) == c:
        return False, NONE, NONE, NONE, NONE
    without_b, third = _around_edge(mesh, t, x, p0, pa)
    without_a, other = _around_edge(mesh, t, x, p0, pb)
    without_v0, another = _around_edge(mesh, t, x, pa, pb)
    without_c = inner(mesh, t, x)
    h0 = without_c if v3 == c else without_b if v3 == b else without_a
    h1 = without_c if v2 == c else without_b if v2 == b else without_a
    h2 = without_c if v1 == c else without_b if v1 == b else without_a
    return third == c and other == c and another == c, h0, h1, h2, without_v0


@kernel(allocates=False)
def _around_edge(mesh: HalfFaces, t: int, x: int, a: int, b: int) -> tuple[Any, Any]:
    """The half-face where one comes to the border around an edge, as `next_on_border`, and its third vertex."""
    arrived, y = next_on_border(mesh, t, x, a, b)
    third = -vertex_at(mesh, t, a) - vertex_at(mesh, t, b)
    for place in range(4):
        if place != 3 - y:
            third += vertex_at(mesh, arrived, place)
    return inner(mesh, arrived, y), third


@kernel(allocates=False)
def _faces_around(mesh: HalfFaces, v0: int, v1: int, v2: int, v3: int) -> tuple[Any, Any, Any, Any]:
    """The half-faces (v0, v1, v2), (v0, v1, v3), (v0, v2, v3) of tetras that are there, NONE each, and a refusal or 0."""
    h0, h1, h2, refusal = NONE, NONE, NONE, np.int64(0)
    for n in range(walk_fan(mesh, v0)):
        t = mesh.queue[n] >> 2
        has, other = np.int64(0), np.int64(0)
        for place in range(4):
            v = vertex_at(mesh, t, place)
            match = np.int64(v == v1) | np.int64(v == v2) << 1 | np.int64(v == v3) << 2
            has |= match
            other += place * np.int64((match == 0) & (v != v0))  # counts where just one is another
        if has == 0b111:
            refusal = np.int64(TWICE)
        elif has == 0b011 or has == 0b101 or has == 0b110:
            halfface = inner(mesh, t, 3 - other)
            if refusal == 0 and not is_border(mesh, opposite_of(mesh, t, 3 - other)):
                refusal = np.int64(SHARED)
            if has == 0b011:
                h0 = halfface
            elif has == 0b101:
                h1 = halfface
            else:
                h2 = halfface
    return h0, h1, h2, refusal


@kernel(allocates=False)
def _face_beyond(mesh: HalfFaces, v1: int, v2: int, v3: int) -> tuple[Any, Any]:
    """The half-face (v1, v2, v3) of a tetra that is there, or NONE, and a refusal or 0."""
    found, refusal = NONE, np.int64(0)
    for n in range(walk_fan(mesh, v1)):
        t = mesh.queue[n] >> 2
        has, other = np.int64(0), np.int64(0)
        for place in range(4):
            v = vertex_at(mesh, t, place)
            match = np.int64(v == v2) | np.int64(v == v3) << 1
            has |= match
            other += place * np.int64((match == 0) & (v != v1))
        if has == 0b11:
            found = inner(mesh, t, 3 - other)
            if not is_border(mesh, opposite_of(mesh, t, 3 - other)):
                refusal = np.int64(SHARED)
    return found, refusal


@kernel(allocates=False, inline=True)
def _write(mesh: HalfFaces, t: int, v0: int, v1: int, v2: int, v3: int, number: int) -> None:
    words = mesh.connectivity
    words[t, 0] = compound(words, v0, number >> 3)
    words[t, 1] = compound(words, v1, number & 7)
    words[t, 2] = compound(words, v2, 0)
    words[t, 3] = compound(words, v3, 0)


@kernel(allocates=False)
def _join(mesh: HalfFaces, t: int, x: int, halfface: int) -> Any:
    """Put half-face x of a new tetra opposite one that is there, or the border; the border half-face to be freed, or NONE."""
    border = NONE
    if halfface == NONE:
        take_border(mesh, t, x)
    else:
        border = opposite_of(mesh, tetra_of(mesh, halfface), number_of(mesh, halfface))
        mesh.adjacency[t, x] = halfface
        mesh.adjacency[tetra_of(mesh, halfface), number_of(mesh, halfface)] = inner(mesh, t, x)
    return border


@kernel(allocates=False, inline=True)
def _free(mesh: HalfFaces, border: int) -> None:
    if border != NONE:
        free_border(mesh, border)


@kernel(allocates=False)
def _correct_access(mesh: HalfFaces, t: int, place: int, freed0: int, freed1: int, freed2: int, freed3: int) -> None:
    """Make the access half-faces right of one vertex of a new tetra, whose joins have used up some of the border."""
    v = vertex_at(mesh, t, place)
    joined, border = 0, NONE
    for x in range(4):
        if x != 3 - place:
            opposite = opposite_of(mesh, t, x)
            if is_border(mesh, opposite):
                border = opposite
            else:
                joined += 1
    record, listed = first_record(mesh, v)
    if joined == 0:
        add_record(mesh, v, border)  # a component of its own
    elif listed != NONE:
        add_record(mesh, v, access_at(mesh, t << 2 | place, border))
        settle(mesh, v)
    elif border != NONE:
        mesh.v2hf[v] = border
    elif mesh.vborders[v] == joined:  # all its border half-faces are about to be freed
        mesh.v2hf[v] = access_at(mesh, t << 2 | place, NONE)
    elif record == freed0 or record == freed1 or record == freed2 or record == freed3:
        begin_walk(mesh)
        mesh.v2hf[v] = access_at(mesh, t << 2 | place, walk_component(mesh, t << 2 | place))


@kernel(allocates=False)
def settle(mesh: HalfFaces, v: int) -> None:
    """Make the access half-faces of a vertex right where its components have changed.

    Of those that it has, redundant ones go, and border ones are preferred; each component must have one.
    """
    record, place = first_record(mesh, v)
    if record == NONE:
        return
    begin_walk(mesh)
    if place == NONE:
        corner = corner_at(mesh, record, v)
        mesh.v2hf[v] = access_at(mesh, corner, walk_component(mesh, corner))
    else:
        mesh.v2hf[v] = isolated(mesh)
        while place != NONE:
            here, corner = place, corner_at(mesh, record, v)
            record, place = next_record(mesh, place)
            free_record(mesh, here)
            if not was_visited(mesh, corner):
                add_record(mesh, v, access_at(mesh, corner, walk_component(mesh, corner)))


@kernel(allocates=False)
def add_vertex(mesh: HalfFaces, reuse: bool) -> Any:
    """A new isolated vertex: with `reuse` the one that was deleted last, if there is one. Needs room."""
    counters = mesh.counters
    v = counters[DELETED_VERTEX]
    if reuse and v != NONE:
        counters[DELETED_VERTEX] = next_in_chain(mesh.v2hf, mesh.v2hf[v])
        counters[DELETED_VERTICES] -= 1
    else:
        v = counters[VERTICES]
        counters[VERTICES] = v + 1
    mesh.v2hf[v] = isolated(mesh)
    mesh.vborders[v] = 0
    return v


@kernel(allocates=False)
def remove_vertex(mesh: HalfFaces, v: int) -> None:
    """Delete an isolated vertex."""
    mesh.v2hf[v] = chained(mesh.v2hf, mesh.counters[DELETED_VERTEX])
    mesh.counters[DELETED_VERTEX] = v
    mesh.counters[DELETED_VERTICES] += 1


@kernel(allocates=False)
def set_delete_flag(mesh: HalfFaces, t: int, value: bool) -> None:
    """Flag tetra t as one to be collected, or take the flag away."""
    if value != is_flagged(mesh, t):
        mesh.connectivity[t, 0] = np.int64(mesh.connectivity[t, 0]) ^ compound(mesh.connectivity, 0, FLAG)
        mesh.counters[FLAGGED] += 1 if value else -1


@kernel(allocates=False)
def user_flag(mesh: HalfFaces, t: int, k: int) -> Any:
    """User flag k, 0..5, of tetra t."""
    return extension_of(mesh.connectivity, mesh.connectivity[t, 2 + k // 3]) >> k % 3 & 1


@kernel(allocates=False)
def set_user_flag(mesh: HalfFaces, t: int, k: int, value: bool) -> None:
    """Set user flag k, 0..5, of tetra t."""
    if np.int64(value) != user_flag(mesh, t, k):
        word = np.int64(mesh.connectivity[t, 2 + k // 3])
        mesh.connectivity[t, 2 + k // 3] = word ^ compound(mesh.connectivity, 0, 1 << k % 3)
