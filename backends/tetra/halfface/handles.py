"""Handles: plain numbers that name the elements of a mesh, a type for each kind, and the kinds. Source: thesis, 5.6.4.

The types are for annotations alone: a handle is an int, in arrays an int64. All valid ones are 0 or more.
"""

import enum
from typing import NewType

Vertex = NewType("Vertex", int)
"""The index of a vertex."""

Edge = NewType("Edge", int)
"""Its two vertices, first < second: first << 31 | second."""

HalfFace = NewType("HalfFace", int)
"""A compound number (see `compound`): half-face X of a tetra, or a border half-face, which is just its index."""

Face = NewType("Face", int)
"""One of its inner half-faces, the one with the lower handle where there are two."""

Tetrahedron = NewType("Tetrahedron", int)
"""The index of a tetra, until the next `garbage_collect`."""

INVALID = -1
"""The handle of no element, whatever its kind."""


class Element(enum.Enum):
    """The kinds of elements; the value is what a person reads."""

    VERTEX = "vertex"
    EDGE = "edge"
    HALFFACE = "half-face"
    TETRAHEDRON = "tetra"
    FACE = "face"
    BORDER_HALFFACE = "border half-face"
