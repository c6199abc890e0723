"""Small named meshes of tetras without coordinates, by what is special about how they hang together."""

from itertools import combinations
from typing import NamedTuple

import numpy as np

from tetrabench.mesh.models import generate


class Connectivity(NamedTuple):
    """tets: (n, 4) int32; vertices: how many there are."""

    tets: np.ndarray
    vertices: int


def connectivity(tets, isolated=0):
    """From nested lists, with some isolated vertices behind the others."""
    tets = np.array(list(tets), np.int32).reshape(-1, 4)
    return Connectivity(tets, int(tets.max(initial=-1)) + 1 + isolated)


def cone(triangles, apex):
    """The tetras between a vertex and a surface, which is the vertex' link then."""
    return [(*triangle, apex) for triangle in triangles]


def empty():
    return connectivity([])


def empty_with_vertices():
    return connectivity([], isolated=5)


def single():
    return connectivity([[2, 0, 3, 1]])


def single_among_isolated():
    return connectivity([[4, 1, 3, 6]], isolated=2)


def pair():
    return connectivity([[0, 1, 2, 3], [4, 3, 2, 1]])


def inner_vertex():
    """A tetra split in four around vertex 4, which has no border."""
    return connectivity(cone(combinations(range(4), 3), 4))


def touching_in_an_edge():
    return connectivity([[0, 1, 2, 3], [5, 4, 1, 0]])


def touching_in_a_vertex():
    return connectivity([[0, 1, 2, 3], [4, 5, 6, 0]])


def touching_in_three_ways():
    """Two in an edge, a third one with them in a vertex."""
    return connectivity([[0, 1, 2, 3], [0, 1, 4, 5], [0, 6, 7, 8]])


def ring():
    """Five tetras all around the edge (0, 1)."""
    return connectivity([[0, 1, 2 + n, 2 + (n + 1) % 5] for n in range(5)])


def shortest_ring():
    return connectivity([[0, 1, 2, 3], [1, 0, 3, 4], [0, 4, 1, 2]])


def two_components_at_a_vertex():
    """Vertex 0 with two fans of three tetras each."""
    fan = [[1, 2, 3], [2, 3, 4], [3, 4, 5]]
    return connectivity(cone(fan, 0) + cone(np.array(fan) + 5, 0))


def two_fans_at_an_edge():
    """The edge (0, 1) with two open fans of two tetras each."""
    return connectivity([[0, 1, 2, 3], [1, 0, 4, 3], [0, 1, 5, 6], [7, 6, 1, 0]])


def closed_and_open_at_a_vertex():
    """Vertex 0 with a component that closes around it, and one with border."""
    return connectivity(cone(combinations(range(1, 5), 3), 0) + [(0, 5, 6, 7)])


def two_closed_at_a_vertex():
    """Vertex 0 with two components that close around it: two access half-faces, none on the border."""
    return connectivity(cone(combinations(range(1, 5), 3), 0) + cone(combinations(range(5, 9), 3), 0))


def apart():
    """Two components, each a pair, and a vertex that nothing has."""
    return connectivity([[0, 1, 2, 3], [1, 2, 3, 4], [6, 7, 8, 9], [7, 8, 10, 9]], isolated=1)


def sphere():
    """The boundary of a simplex of dimension 4: five tetras without any border."""
    return connectivity(combinations(range(5), 4))


def two_spheres():
    """Two of them with one common vertex, which is not a manifold's, and no border anywhere."""
    return connectivity([*combinations(range(5), 4), *combinations(range(4, 9), 4)])


def annulus_link():
    """Vertex 0 whose link is an annulus: one component with two circles of border."""
    annulus = [[1, 2, 5], [1, 4, 5], [2, 3, 6], [2, 5, 6], [3, 1, 4], [3, 6, 4]]
    return connectivity(cone(annulus, 0))


def torus_link():
    """Vertex 7 whose link is a torus, Möbius' with seven vertices: it closes, though not as a ball does."""
    torus = [[n, (n + 1) % 7, (n + 3) % 7] for n in range(7)] + [[n, (n + 2) % 7, (n + 3) % 7] for n in range(7)]
    return connectivity(cone(torus, 7))


def projective_link():
    """Vertex 0 whose link is the projective plane with six vertices: no orientation helps."""
    plane = ["125", "126", "134", "136", "145", "234", "235", "246", "356", "456"]
    return connectivity(cone([[int(v) for v in triangle] for triangle in plane], 0))


def pinched():
    """Two tetras apart at vertex 0 that a third one joins elsewhere: one component, two of them at 0."""
    return connectivity([[0, 1, 2, 3], [1, 2, 3, 4], [2, 3, 4, 5], [0, 3, 4, 5]])


def box():
    mesh = generate("box", 24, seed=1)
    return Connectivity(mesh.tets, len(mesh.points))


MESHES = {
    mesh.__name__: mesh
    for mesh in (
        empty,
        empty_with_vertices,
        single,
        single_among_isolated,
        pair,
        inner_vertex,
        touching_in_an_edge,
        touching_in_a_vertex,
        touching_in_three_ways,
        ring,
        shortest_ring,
        two_components_at_a_vertex,
        two_fans_at_an_edge,
        closed_and_open_at_a_vertex,
        two_closed_at_a_vertex,
        apart,
        sphere,
        two_spheres,
        annulus_link,
        torus_link,
        projective_link,
        pinched,
        box,
    )
}
