"""From element connectivity to half-faces, all at once. Source: thesis, 5.10.2, with buckets where it sorts."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from tetrabench.backends.tetra.halfface.compound import WORDS, base_mask, compound, refuse_beyond
from tetrabench.backends.tetra.halfface.permutations import sorted_with_number
from tetrabench.backends.tetra.halfface.storage import (
    BORDERS,
    LARGEST_FAN,
    NONE,
    RECORDS,
    TETRAS,
    VISITED,
    HalfFaces,
    add_record,
    count_border,
    inner,
    make_halffaces,
    number_of,
    reserve,
    tetra_of,
    vertex_at,
)
from tetrabench.backends.tetra.halfface.walks import access_at, begin_walk, walk_component, was_visited
from tetrabench.errors import InputError
from tetrabench.jit import kernel
from tetrabench.jit.prefetch import prefetch
from tetrabench.mesh.sides import side_pairs
from tetrabench.mesh.tetra_mesh import as_vertices

_AHEAD = 2  # vertices: their walks take about as long as memory does


def construct(tets: Any, vertices: int | None = None, *, bits: int = 32, manifold: bool = False) -> HalfFaces:
    """The half-faces of a mesh, with exactly the room that it needs. O(n).

    Args:
        tets: (n, 4) whole numbers, the vertices of each tetra.
        vertices: how many there are; by default the largest in `tets` and one.
        bits: of a word, 32 or 64.
        manifold: a promise that the tetras of every vertex hang together through faces that have it; nobody looks then.

    Raises:
        InputError: tets of another shape, an unknown vertex, a tetra with a vertex twice, two tetras with the same four
            vertices, three with one face, or more of anything than the words can count.
    """
    refuse_beyond(bits, tetrahedra=rows_of(tets), vertices=vertices or 0)  # before they are copied
    tets = as_vertices(tets) if vertices is None else as_vertices(tets, vertices)
    if vertices is None:
        vertices = int(tets.max()) + 1 if len(tets) else 0
        refuse_beyond(bits, vertices=vertices)
    connectivity = np.empty((len(tets), 4), WORDS[bits])
    ascending = connectivity.view(np.int32) if bits == 32 else np.empty((len(tets), 4), np.int32)
    numbers = np.empty(len(tets), np.uint8)
    _sort(tets, ascending, numbers)
    pairs = side_pairs(ascending)
    border, twin = _count_border(pairs)
    if twin >= 0:
        raise InputError(f"tetras {pairs[twin, 0] >> 2} and {twin} (counted from 0) have the same four vertices")
    refuse_beyond(bits, border_halffaces=border)
    mesh = make_halffaces(vertices, 0, border, bits=bits)
    mesh = mesh._replace(connectivity=connectivity, adjacency=np.empty_like(connectivity))
    mesh.counters[TETRAS], mesh.counters[BORDERS] = len(tets), border
    first, fans = np.full(vertices, NONE, np.int64), np.zeros(vertices, np.int32)
    _link(mesh, ascending, numbers, pairs, first, fans)
    mesh.counters[LARGEST_FAN] = fans.max(initial=0)
    mesh = reserve(mesh)  # room for walks around the largest fan
    split = np.zeros(vertices, np.bool_)
    if manifold:
        _trust(mesh, first)
    elif _find_access(mesh, first, fans, split):
        mesh = _settle_split(mesh, split)
    return mesh


def rows_of(tets: Any) -> int:
    """How many rows an array has; 0 of what is none, which may be of any shape, and small."""
    return len(tets) if isinstance(tets, np.ndarray) and tets.ndim else 0


@kernel(allocates=False)
def _sort(tets: Any, ascending: Any, numbers: Any) -> None:
    for t in range(len(tets)):
        a, b, c, d, number = sorted_with_number(tets[t, 0], tets[t, 1], tets[t, 2], tets[t, 3])
        ascending[t, 0], ascending[t, 1], ascending[t, 2], ascending[t, 3] = a, b, c, d
        numbers[t] = number


@kernel(allocates=False)
def _count_border(pairs: Any) -> tuple[Any, Any]:
    """How many half-faces have no opposite one, and a tetra that another one repeats, or -1."""
    border, twin = np.int64(0), np.int64(-1)
    for t in range(len(pairs)):
        for x in range(4):
            border += np.int64(pairs[t, x] < 0)
        if pairs[t, 0] >= 0 and (pairs[t, 0] >> 2 == pairs[t, 1] >> 2 or pairs[t, 0] >> 2 == pairs[t, 2] >> 2):
            twin = np.int64(t)  # who shares two faces shares all four vertices
        if pairs[t, 3] >= 0 and (pairs[t, 3] >> 2 == pairs[t, 1] >> 2 or pairs[t, 3] >> 2 == pairs[t, 2] >> 2):
            twin = np.int64(t)
    return border, twin


@kernel(allocates=False)
def _link(mesh: HalfFaces, ascending: Any, numbers: Any, pairs: Any, first: Any, fans: Any) -> None:
    """Connectivity with its permutations, adjacency, border half-faces; a corner of each vertex, and how many it has.

    `ascending` may be a view of the connectivity that is written here.
    """
    words, border = mesh.connectivity, np.int64(0)
    for t in range(len(pairs)):
        number = np.int64(numbers[t])
        for k in range(4):
            v = np.int64(ascending[t, k])
            fans[v] += 1
            first[v] = 4 * t + k
            extension = number >> 3 if k == 0 else number & 7 if k == 1 else 0
            words[t, k] = compound(words, v, extension)
            x, pair = 3 - k, np.int64(pairs[t, k])
            if pair >= 0:
                mesh.adjacency[t, x] = inner(mesh, pair >> 2, 3 - (pair & 3))
            else:
                mesh.bhf2hf[border] = inner(mesh, t, x)
                mesh.adjacency[t, x] = border
                border += 1
    for halfface in mesh.bhf2hf:
        count_border(mesh, tetra_of(mesh, halfface), number_of(mesh, halfface), 1)


@kernel(allocates=False)
def _find_access(mesh: HalfFaces, first: Any, fans: Any, split: Any) -> Any:
    """The access half-face of each vertex whose tetras hang together; marks the others, and counts the marked."""
    found = 0
    for v in range(len(first)):
        ahead = min(v + _AHEAD, len(first) - 1)
        if first[ahead] != NONE:
            prefetch(mesh.adjacency, first[ahead] >> 2)
        if first[v] != NONE:
            begin_walk(mesh)
            border = walk_component(mesh, first[v])
            if mesh.walk[VISITED] == fans[v]:
                mesh.v2hf[v] = access_at(mesh, first[v], border)
            else:
                split[v] = True
                found += 1
    return found


@kernel(allocates=False)
def _trust(mesh: HalfFaces, first: Any) -> None:
    """The access half-face of each vertex, all of them manifold."""
    for v in range(len(first)):
        if first[v] != NONE:
            mesh.v2hf[v] = access_at(mesh, first[v], NONE)
    for border in range(mesh.counters[BORDERS]):
        t, x = tetra_of(mesh, mesh.bhf2hf[border]), number_of(mesh, mesh.bhf2hf[border])
        for k in range(4):
            if k != 3 - x:
                mesh.v2hf[vertex_at(mesh, t, k)] = border


def _settle_split(mesh: HalfFaces, split: NDArray[np.bool_]) -> HalfFaces:
    """The access half-faces of the marked vertices, one for each component of their tetras."""
    vertices = mesh.connectivity.astype(np.int64) & int(base_mask(mesh.connectivity))
    tetras, places = np.nonzero(split[vertices])
    owners = vertices[tetras, places]
    order = np.argsort(owners, kind="stable")
    mesh = reserve(mesh, records=len(order))
    _settle(mesh, owners[order], (4 * tetras + places)[order])
    return mesh._replace(v2nhf=mesh.v2nhf[: mesh.counters[RECORDS]].copy())


@kernel(allocates=False)
def _settle(mesh: HalfFaces, owners: Any, corners: Any) -> None:
    """One record for each component; corners (n,) come sorted by their vertices, `owners` (n,)."""
    for n in range(len(corners)):
        if n == 0 or owners[n] != owners[n - 1]:
            begin_walk(mesh)
        if not was_visited(mesh, corners[n]):
            add_record(mesh, owners[n], access_at(mesh, corners[n], walk_component(mesh, corners[n])))
