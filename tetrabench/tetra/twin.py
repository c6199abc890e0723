"""A net in plain Python, written from the definitions: dictionaries and sets. What every contestant must come to."""

from collections.abc import Iterable, Sequence
from itertools import combinations
from math import sqrt

from tetrabench.mesh import TetraMesh

Corners = tuple[int, int, int, int]
Place = tuple[float, float, float]


class Twin:
    """Tetras by their vertices as given, each with its states; every question is answered by looking at all of them.

    Attributes:
        points: coordinates, in the order of the refs of points.
        states: five of each tetra: vertices -> states.
    """

    def __init__(self, mesh: TetraMesh) -> None:
        self.points: list[Place] = [(x, y, z) for x, y, z in mesh.points.tolist()]
        self.states: dict[Corners, list[float]] = {(a, b, c, d): [0.0] * 5 for a, b, c, d in mesh.tets.tolist()}

    @property
    def tetras(self) -> list[Corners]:
        """All tetras, in the order in which they came."""
        return list(self.states)

    def behind(self) -> dict[tuple[Corners, int], Corners | None]:
        """The other tetra that has a side, None at the surface: (tetra, i) -> tetra; side i lacks vertex i."""
        users: dict[frozenset[int], list[Corners]] = {}
        for tetra in self.states:
            for side in combinations(tetra, 3):
                users.setdefault(frozenset(side), []).append(tetra)
        found: dict[tuple[Corners, int], Corners | None] = {}
        for tetra in self.states:
            for i in range(4):
                others = [other for other in users[frozenset(tetra) - {tetra[i]}] if other != tetra]
                found[tetra, i] = others[0] if others else None
        return found

    def around(self, point: int) -> set[Corners]:
        """The tetras that use a point."""
        return {tetra for tetra in self.states if point in tetra}

    def refusal(self, tetra: Sequence[int]) -> str:
        """Why a tetra cannot be inserted, "" where it can."""
        if len(set(tetra)) < 4:
            return "two of its points are equal"
        if not all(0 <= v < len(self.points) for v in tetra):
            return "one of its points is none"
        if any(set(tetra) == set(other) for other in self.states):
            return "it is there already"
        for side in combinations(tetra, 3):
            if sum(set(side) < set(other) for other in self.states) == 2:
                return f"two tetras share its side {side} already"
        return ""

    def insert(self, tetra: Corners) -> None:
        """Insert a tetra; its states are 0."""
        self.states[tetra] = [0.0] * 5

    def delete(self, tetra: Corners) -> None:
        """Delete a tetra; its points stay."""
        del self.states[tetra]

    def split(self, tetra: Corners) -> bool:
        """Four children around the centroid, child i with it in place of vertex i; False, and nothing, where it is a point."""
        centre = self.centroid(tetra)
        if centre in self.points:
            return False
        new, states = len(self.points), self.states.pop(tetra)
        self.points.append(centre)
        for i in range(4):
            a, b, c, d = (new if i == j else v for j, v in enumerate(tetra))
            self.states[a, b, c, d] = list(states)
        return True

    # The order of the operations is part of the definitions: answers are compared bit by bit.

    def centroid(self, tetra: Corners) -> Place:
        """The mean of the vertices."""
        p, q, r, s = (self.points[v] for v in tetra)
        return (p[0] + q[0] + r[0] + s[0]) / 4, (p[1] + q[1] + r[1] + s[1]) / 4, (p[2] + q[2] + r[2] + s[2]) / 4

    def volume(self, tetra: Corners) -> float:
        """Absolute."""
        p, q, r, s = (self.points[v] for v in tetra)
        return abs(_dot(_minus(q, p), _cross(_minus(r, p), _minus(s, p))) / 6)

    def side(self, tetra: Corners, i: int) -> tuple[float, Place]:
        """Area and outward unit normal of side i; the normal is 0 where there is no area."""
        a, b, c = (self.points[tetra[(i + n) % 4]] for n in (1, 2, 3))
        normal = _cross(_minus(b, a), _minus(c, a))
        length = sqrt(_dot(normal, normal))
        factor = 1 / length if length > 0 else 0.0
        if _dot(normal, _minus(self.points[tetra[i]], a)) > 0:
            factor = -factor
        return length / 2, (factor * normal[0], factor * normal[1], factor * normal[2])

    def floats(self, tetra: Corners) -> list[float]:
        """Volume, centroid (3), side areas (4), side normals (4 x 3) and states (5), one behind the other."""
        sides = [self.side(tetra, i) for i in range(4)]
        areas, normals = [area for area, _ in sides], [x for _, normal in sides for x in normal]
        return [self.volume(tetra), *self.centroid(tetra), *areas, *normals, *self.states[tetra]]


def corners_of(rows: Iterable[Sequence[int]]) -> list[Corners]:
    """Rows of four vertices, as tetras."""
    return [(int(a), int(b), int(c), int(d)) for a, b, c, d in rows]


def _minus(p: Place, q: Place) -> Place:
    return p[0] - q[0], p[1] - q[1], p[2] - q[2]


def _cross(u: Place, v: Place) -> Place:
    return u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]


def _dot(u: Place, v: Place) -> float:
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2]
