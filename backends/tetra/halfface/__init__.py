"""The half-face kernel: the least memory with local queries, manifold or not. A contestant, and a library of queries.

from tetrabench.backends.tetra.halfface import Element, HalfFaceMesh

mesh = HalfFaceMesh.construct_mesh(tets)
around = mesh.one_to_all(Element.TETRAHEDRON, Element.VERTEX, 7)
"""

from tetrabench.backends.tetra.halfface.halfface_mesh import EventualMesh, HalfFaceMesh
from tetrabench.backends.tetra.halfface.handles import (
    INVALID,
    Edge,
    Element,
    Face,
    HalfFace,
    Tetrahedron,
    Vertex,
)
from tetrabench.backends.tetra.halfface.sets import ElementMultiset, ElementSet

__all__ = [
    "INVALID",
    "Edge",
    "Element",
    "ElementMultiset",
    "ElementSet",
    "EventualMesh",
    "Face",
    "HalfFace",
    "HalfFaceMesh",
    "Tetrahedron",
    "Vertex",
]
