"""The tetras around an edge, in the order in which they lie around it. Source: thesis, 8.5.4, which wishes for it."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from tetrabench.backends.tetra.halfface.handles import Tetrahedron
from tetrabench.backends.tetra.halfface.storage import (
    NONE,
    HalfFaces,
    is_border,
    number_of,
    opposite_of,
    tetra_of,
    vertex_at,
)
from tetrabench.jit import kernel


@kernel(allocates=False)
def turn(mesh: HalfFaces, t: int, a: int, b: int, entered: int) -> tuple[Any, Any]:
    """Go on around the edge (a, b) through the half-face of tetra t that has it and is not the one it was entered by.

    `entered` is -1 at the beginning. Returns the next tetra and its half-face that one comes through; NONE at the border.
    """
    following, through = NONE, NONE
    for x in range(4):
        if x != entered and following == NONE:
            lacking = vertex_at(mesh, t, 3 - x)
            if lacking != a and lacking != b:
                opposite = opposite_of(mesh, t, x)
                if is_border(mesh, opposite):
                    return NONE, NONE
                following, through = tetra_of(mesh, opposite), number_of(mesh, opposite)
    return following, through


@kernel(allocates=False)
def list_around_edge(mesh: HalfFaces, t: int, a: int, b: int, found: Any) -> Any:
    """The tetras around the edge (a, b) in order, from border to border or all around; from tetra t, which has it.

    Returns how many there are; as many as fit are in `found`.
    """
    here, entered = t, NONE
    following, through = turn(mesh, here, a, b, entered)
    while following != NONE and following != t:  # to the border, or around
        here, entered = following, through
        following, through = turn(mesh, here, a, b, entered)
    if following == t:
        here, entered = t, through
    else:
        entered = _border_face(mesh, here, a, b, entered)
    first, n = here, 0
    while here != NONE and (n == 0 or here != first):
        if n < len(found):
            found[n] = here
        n += 1
        here, entered = turn(mesh, here, a, b, entered)
    return n


@kernel(allocates=False)
def _border_face(mesh: HalfFaces, t: int, a: int, b: int, entered: int) -> Any:
    """The half-face at the edge (a, b) of tetra t, not the one it was entered by, that is opposite the border."""
    for x in range(4):
        lacking = vertex_at(mesh, t, 3 - x)
        if x != entered and lacking != a and lacking != b and is_border(mesh, opposite_of(mesh, t, x)):
            return np.int64(x)
    return NONE


class Circulator:
    """A place among the tetras around an edge: after the last comes the first again. There is none without tetras.

    Iterating makes one full turn from the place where it stands.
    """

    def __init__(self, tetras: list[int]) -> None:
        """`tetras`: as they lie around the edge, one at least."""
        self._tetras = tetras
        self._place = 0

    @property
    def current(self) -> Tetrahedron:
        """The tetra where it stands."""
        return Tetrahedron(self._tetras[self._place])

    def next(self) -> Tetrahedron:
        """Go on by one."""
        self._place = (self._place + 1) % len(self._tetras)
        return self.current

    def previous(self) -> Tetrahedron:
        """Go back by one."""
        self._place = (self._place - 1) % len(self._tetras)
        return self.current

    def __len__(self) -> int:
        return len(self._tetras)

    def __iter__(self) -> Iterator[Tetrahedron]:
        turned = self._tetras[self._place :] + self._tetras[: self._place]
        return map(Tetrahedron, turned)
