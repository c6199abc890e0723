"""Naive twins in plain Python: slow, obvious, written from the definitions, not from the code they check.

Where an answer is compared bit by bit, the order of the floating-point operations is part of the definition.
"""

import struct
from itertools import combinations
from math import cos, inf, sin, sqrt

Vertices = tuple[int, int, int, int]
MASK = 2**64 - 1


class OracleNet:
    """A net as a dict of tetras: id -> vertices, id -> states. Every question is answered by looking at all of them."""

    def __init__(self, points, tets):
        self.points = [tuple(map(float, point)) for point in points]
        self.tetras: dict[int, Vertices] = {n: tuple(map(int, tet)) for n, tet in enumerate(tets)}
        self.states: dict[int, list[float]] = {n: [0.0] * 5 for n in self.tetras}
        self.next_id = len(self.tetras)
        self.diagonal = diagonal(self.points)

    # ------------------------------------------------------------------ questions

    def side(self, t, i):
        return frozenset(self.tetras[t]) - {self.tetras[t][i]}

    def neighbour(self, t, i):
        """The other tetra that has this side, None at the surface."""
        others = [u for u, vertices in self.tetras.items() if u != t and self.side(t, i) < frozenset(vertices)]
        assert len(others) <= 1
        return others[0] if others else None

    def volume(self, t):
        return abs(signed_volume(*(self.points[v] for v in self.tetras[t])))

    def centroid(self, t):
        p, q, r, s = (self.points[v] for v in self.tetras[t])
        return tuple((p[k] + q[k] + r[k] + s[k]) / 4 for k in range(3))

    def side_area(self, t, i):
        a, b, c = (self.points[self.tetras[t][(i + n) % 4]] for n in (1, 2, 3))
        return sqrt(dot(cross(minus(b, a), minus(c, a)), cross(minus(b, a), minus(c, a)))) / 2

    def around(self, point):
        return {t for t, vertices in self.tetras.items() if point in vertices}

    def nearest_distance(self, x):
        return min((dot(minus(p, x), minus(p, x)) for p in self.points), default=inf)

    def share_inside(self, t, x):
        """How deep x lies in t: the least of its barycentric coordinates (negative outside); 0 in a flat tetra."""
        corners = [self.points[v] for v in self.tetras[t]]
        whole = signed_volume(*corners)
        if whole == 0:
            return -inf
        return min(signed_volume(*(x if j == i else corners[j] for j in range(4))) / whole for i in range(4))

    def middle(self):
        """The first tetra whose centroid is nearest to that of the net, weighted by volume; its volume; that centroid."""
        whole = sum(self.volume(t) for t in self.tetras)
        if whole == 0:
            return None, 0.0, (0.0, 0.0, 0.0)
        centre = tuple(sum(self.volume(t) * self.centroid(t)[k] for t in self.tetras) / whole for k in range(3))
        away = {t: minus(self.centroid(t), centre) for t in self.tetras}
        nearest = min(self.tetras, key=lambda t: dot(away[t], away[t]))
        return nearest, self.volume(nearest), centre

    # ------------------------------------------------------------------ changes

    def can_insert(self, vertices):
        if len(set(vertices)) < 4 or not all(0 <= v < len(self.points) for v in vertices):
            return False
        if any(set(vertices) == set(there) for there in self.tetras.values()):
            return False
        sides = [frozenset(side) for side in combinations(vertices, 3)]
        return all(sum(side < frozenset(there) for there in self.tetras.values()) < 2 for side in sides)

    def insert(self, vertices):
        assert self.can_insert(vertices)
        t = self.next_id
        self.next_id += 1
        self.tetras[t], self.states[t] = tuple(vertices), [0.0] * 5
        return t

    def delete(self, t):
        del self.tetras[t], self.states[t]

    def insert_point(self, x):
        for ref, p in enumerate(self.points):
            if dot(minus(p, x), minus(p, x)) < (1e-9 * self.diagonal) ** 2:
                return ref
        self.points.append(x)
        return len(self.points) - 1

    def split(self, t):
        """Four children around the centroid, child i without vertex i; () where the centroid is a point already."""
        before = len(self.points)
        centre = self.insert_point(self.centroid(t))
        if centre < before:
            return ()
        vertices, states = self.tetras[t], self.states[t]
        self.delete(t)
        children = [self.insert(vertices[:i] + (centre,) + vertices[i + 1 :]) for i in range(4)]
        for child in children:
            self.states[child] = list(states)
        return tuple(children)

    # ------------------------------------------------------------------ sweeps

    def set_initial_states(self):
        for t in self.tetras:
            x, y, z = (c / self.diagonal for c in self.centroid(t))
            self.states[t] = [0.5 + 0.5 * sin(3 * x) * cos(2 * y) * sin(1.7 * z + 0.3), 0.0, 0.0, 0.0, 0.0]

    def alfa(self, sweeps):
        for _ in range(sweeps):
            new = {}
            for t in self.tetras:
                own, around = self.states[t][0], 0.0
                for i in range(4):
                    n = self.neighbour(t, i)
                    around += own if n is None else self.states[n][0]
                new[t] = 0.5 * own + 0.5 * (around * 0.25)
            self._store(new)

    def flow_step(self):
        largest = max((sum(self.exchange(t, i) for i in range(4)) for t in self.tetras), default=0.0)
        return 0.9 / largest if largest > 0 else 0.0

    def exchange(self, t, i):
        n = self.neighbour(t, i)
        both = 0 if n is None else self.volume(t) + self.volume(n)
        return self.side_area(t, i) ** 2 / both if both > 0 else 0.0

    def flow(self, sweeps, step):
        for _ in range(sweeps):
            new = {}
            for t in self.tetras:
                own, gain = self.states[t][0], 0.0
                for i in range(4):
                    n = self.neighbour(t, i)
                    both = 0 if n is None else self.volume(t) + self.volume(n)
                    if both > 0:
                        area = self.side_area(t, i)
                        gain += -1.0 * (own - self.states[n][0]) * (area * area) / both
                new[t] = own + step * gain
            self._store(new)

    def _store(self, new):
        for t, value in new.items():
            self.states[t][0] = self.states[t][1] = value

    # ------------------------------------------------------------------ answer

    def digest(self):
        """SYSTEMS' definition: sum of mixes of sorted vertices, neighbours by opposite vertex, bits of volume and states."""
        total = 0
        for t, vertices in self.tetras.items():
            h = mix_all(0x9E3779B97F4A7C15, sorted(vertices))
            for i in sorted(range(4), key=lambda i: vertices[i]):
                n = self.neighbour(t, i)
                h = mix(h ^ 0x5BD1E995) if n is None else mix_all(h, sorted(self.tetras[n]))
            for value in [self.volume(t), *self.states[t]]:
                h = mix(h ^ struct.unpack("<Q", struct.pack("<d", value))[0])
            total = (total + h) & MASK
        for count in (len(self.tetras), len(self.points)):
            total = mix(total ^ count)
        return f"{total:016x}"


def mix(z):
    z ^= z >> 30
    z = z * 0xBF58476D1CE4E5B9 & MASK
    z ^= z >> 27
    z = z * 0x94D049BB133111EB & MASK
    return z ^ (z >> 31)


def mix_all(h, values):
    for value in values:
        h = mix(h ^ value)
    return h


def minus(p, q):
    return (p[0] - q[0], p[1] - q[1], p[2] - q[2])


def cross(u, v):
    return (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])


def dot(u, v):
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2]


def signed_volume(p, q, r, s):
    return dot(minus(q, p), cross(minus(r, p), minus(s, p))) / 6


def diagonal(points):
    if not points:
        return 0.0
    extents = [max(p[k] for p in points) - min(p[k] for p in points) for k in range(3)]
    return sqrt(sum(e * e for e in extents))
