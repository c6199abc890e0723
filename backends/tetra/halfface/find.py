"""Which half-face has these vertices, which tetra: asked around one of them, so the size of the mesh does not matter."""

from typing import Any

from tetrabench.backends.tetra.halfface.storage import (
    NONE,
    HalfFaces,
    inner,
    is_border,
    opposite_of,
    vertex_at,
)
from tetrabench.backends.tetra.halfface.walks import walk_fan
from tetrabench.jit import kernel


@kernel(allocates=False, inline=True)
def has_vertex(mesh: HalfFaces, t: int, vertex: int) -> Any:
    """Whether tetra t has a vertex."""
    return (
        vertex_at(mesh, t, 0) == vertex
        or vertex_at(mesh, t, 1) == vertex
        or vertex_at(mesh, t, 2) == vertex
        or vertex_at(mesh, t, 3) == vertex
    )


@kernel(allocates=False)
def find_tetrahedron(mesh: HalfFaces, a: int, b: int, c: int, d: int) -> Any:
    """The tetra with these four vertices, NONE if there is none; flagged ones are found."""
    found = NONE
    for n in range(walk_fan(mesh, a)):
        t = mesh.queue[n] >> 2
        if has_vertex(mesh, t, b) and has_vertex(mesh, t, c) and has_vertex(mesh, t, d):
            found = t
    return found


@kernel(allocates=False)
def find_halfface(mesh: HalfFaces, a: int, b: int, c: int) -> Any:
    """A half-face with these three vertices: the border one if there is one, else that of the lower handle; or NONE."""
    found = NONE
    for n in range(walk_fan(mesh, a)):
        t = mesh.queue[n] >> 2
        if has_vertex(mesh, t, b) and has_vertex(mesh, t, c):
            for place in range(4):
                v = vertex_at(mesh, t, place)
                if v != a and v != b and v != c:
                    opposite = opposite_of(mesh, t, 3 - place)
                    found = opposite if is_border(mesh, opposite) else min(inner(mesh, t, 3 - place), opposite)
    return found


@kernel(allocates=False)
def find_halfface_by_edge(mesh: HalfFaces, a: int, b: int) -> Any:
    """A half-face with these two vertices, a border one if there is one; or NONE."""
    found, border = NONE, NONE
    for n in range(walk_fan(mesh, a)):
        t = mesh.queue[n] >> 2
        if has_vertex(mesh, t, b):
            for place in range(4):
                v = vertex_at(mesh, t, place)
                if v != a and v != b:  # the half-face that lacks it has the edge
                    opposite = opposite_of(mesh, t, 3 - place)
                    if is_border(mesh, opposite):
                        border = opposite
                    found = inner(mesh, t, 3 - place)
    return border if border != NONE else found
