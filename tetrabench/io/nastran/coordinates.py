"""Coordinate systems: CORD1R/C/S and CORD2R/C/S, nested, and the points that are given in them.

A system is given by three points: its origin A, B on its z axis, C in its half plane of positive x (MSC Nastran
Quick Reference Guide, "CORD2R"). CORD2 gives them as coordinates in another system, CORD1 as three GRIDs. In a
cylindrical system a point is (r, theta, z), in a spherical one (r, theta from the z axis, phi around it), angles in
degrees.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from tetrabench.errors import InputError
from tetrabench.io.nastran.cards import Integers, Reals

BASIC = 0


class FaultySystemError(InputError):
    """What is wrong with the definition of a coordinate system, and its card."""

    def __init__(self, place: int, reason: str) -> None:
        super().__init__(reason)
        self.place = place


@dataclass(frozen=True)
class System:
    """The definition of a coordinate system.

    Attributes:
        form: "R" rectangular, "C" cylindrical, "S" spherical.
        place: first byte of the card.
        within: the system of `corners`.
        corners: (3, 3) float64, the points A, B, C, where these are given by coordinates.
        grids: the ids of A, B, C where they are GRIDs, else empty.
    """

    form: str
    place: int
    within: int = BASIC
    corners: Reals = field(default_factory=lambda: np.zeros((3, 3)))
    grids: tuple[int, ...] = ()


def rectangular(form: str, given: Reals) -> Reals:
    """Coordinates (n, 3) of the form R, C or S as x, y, z along the same axes."""
    if form == "R":
        return given
    radius, theta, third = given[:, 0], np.radians(given[:, 1]), given[:, 2]
    if form == "C":
        return np.column_stack([radius * np.cos(theta), radius * np.sin(theta), third])
    phi = np.radians(third)
    around = radius * np.sin(theta)
    return np.column_stack([around * np.cos(phi), around * np.sin(phi), radius * np.cos(theta)])


class Frames:
    """The systems of a deck, each turned into origin and axes in the basic one when it is first asked for."""

    def __init__(self, systems: Mapping[int, System], points: Reals, ids: Integers, systems_of: Integers) -> None:
        """`points` (n, 3), their `ids` (n,) and systems (n,): the GRIDs as they are written."""
        self._systems = systems
        self._points = points
        self._systems_of = systems_of
        self._order = np.argsort(ids, kind="stable")
        self._ids = ids[self._order]
        self._frames: dict[int, tuple[Reals, Reals]] = {}
        self._waiting: list[int] = []

    def to_basic(self, number: int, given: Reals) -> Reals:
        """Coordinates (n, 3) in a system, in the basic one; of a system that is not there, as they are.

        Raises:
            FaultySystemError: its definition, or one that it needs, is circular, flat, or names a GRID that does not exist.
        """
        if number == BASIC or number not in self._systems:
            return given
        if number not in self._frames:
            self._frames[number] = self._frame(number)
        origin, axes = self._frames[number]
        return origin + rectangular(self._systems[number].form, given) @ axes

    def _frame(self, number: int) -> tuple[Reals, Reals]:
        """Origin (3,) and axes (3, 3), a row each, of a system in the basic one."""
        system = self._systems[number]
        if number in self._waiting:
            chain = " -> ".join(map(str, [*self._waiting[self._waiting.index(number) :], number]))
            raise FaultySystemError(system.place, f"coordinate system {number} needs itself: {chain}")
        self._waiting.append(number)
        if system.grids:
            a, b, c = (self._grid(node, number) for node in system.grids)
        else:
            a, b, c = self.to_basic(system.within, system.corners)
        self._waiting.pop()
        z = b - a
        y = np.cross(z, c - a)
        lengths = np.linalg.norm(z), np.linalg.norm(y)
        if not (lengths[0] > 0 and lengths[1] > 1e-12 * lengths[0] * np.linalg.norm(c - a)):
            raise FaultySystemError(system.place, f"coordinate system {number}: its three points lie on one line")
        z, y = z / lengths[0], y / lengths[1]
        return a, np.stack([np.cross(y, z), y, z])

    def _grid(self, node: int, number: int) -> Reals:
        """A GRID in the basic system, (3,)."""
        place = int(np.searchsorted(self._ids, node))
        if place == len(self._ids) or self._ids[place] != node:
            reason = f"coordinate system {number} uses GRID {node}, which does not exist"
            raise FaultySystemError(self._systems[number].place, reason)
        row = self._order[place]
        basic: Reals = self.to_basic(int(self._systems_of[row]), self._points[row : row + 1])[0]
        return basic
