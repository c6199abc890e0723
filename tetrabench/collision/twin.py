"""Objects that move, in plain Python as the words of the specification have it: what every structure must come to, bit by bit.

Contacts are looked for in all pairs, the lesser number first; nothing here is taken from the kernels.
"""

import math

from tetrabench.collision.objects import Objects, Start

Pair = tuple[int, int]


class Twin:
    """Circles in a box: lists x, y, vx, vy, r, m of floats, and the rules, which may be changed between steps."""

    def __init__(self, start: Start, gravity: float = 0.0, bounce: float = 1.0, mode: str = "paper") -> None:
        self.take(start.objects)
        self.width, self.height = start.width, start.height
        self.gravity, self.bounce, self.mode = gravity, bounce, mode
        self.contacts = 0

    def take(self, objects: Objects) -> None:
        """Go on from where some objects are."""
        self.x, self.y, self.vx, self.vy, self.r, self.m = (column.tolist() for column in objects)

    def pairs(self) -> list[Pair]:
        """All objects in contact, in the order of their numbers."""
        found = []
        for i in range(len(self.x)):
            for j in range(i + 1, len(self.x)):
                dx, dy, reach = self.x[i] - self.x[j], self.y[i] - self.y[j], self.r[i] + self.r[j]
                if dx * dx + dy * dy < reach * reach:
                    found.append((i, j))
        return found

    def within(self, x_low: float, y_low: float, x_high: float, y_high: float) -> list[int]:
        """The objects with their centre in a rectangle, its border included."""
        return [i for i in range(len(self.x)) if x_low <= self.x[i] <= x_high and y_low <= self.y[i] <= y_high]

    def step(self, found: list[Pair] | None = None) -> list[Pair]:
        """One step: contacts, gravity, walls, move. Returns the pairs; `found`: they are known already."""
        found = self.pairs() if found is None else found
        if self.mode == "paper":
            self._turn(found)
        else:
            self._exchange(found)
        for i in range(len(self.x)):
            self.vy[i] -= self.gravity
            if (self.x[i] < 0 and self.vx[i] < 0) or (self.x[i] > self.width and self.vx[i] > 0):
                self.vx[i] *= -self.bounce
            if (self.y[i] < 0 and self.vy[i] < 0) or (self.y[i] > self.height and self.vy[i] > 0):
                self.vy[i] *= -self.bounce
            self.x[i] += self.vx[i]
            self.y[i] += self.vy[i]
        self.contacts = len(found)
        return found

    def _turn(self, found: list[Pair]) -> None:
        """One hit an object, the first in order: v' = 2 v_cm - v for both."""
        hit: set[int] = set()
        for i, j in found:
            if i in hit or j in hit:
                continue
            hit |= {i, j}
            for v in (self.vx, self.vy):
                centre = (self.m[i] * v[i] + self.m[j] * v[j]) / (self.m[i] + self.m[j])
                v[i], v[j] = 2 * centre - v[i], 2 * centre - v[j]

    def _exchange(self, found: list[Pair]) -> None:
        """All pairs that approach, in order: an impulse along the line of centres, such that they part as fast as they met."""
        for i, j in found:
            distance = math.hypot(self.x[j] - self.x[i], self.y[j] - self.y[i])
            if distance < 1e-140:  # no direction
                continue
            along = (self.x[j] - self.x[i]) / distance, (self.y[j] - self.y[i]) / distance
            speed = (self.vx[j] - self.vx[i]) * along[0] + (self.vy[j] - self.vy[i]) * along[1]
            if speed >= 0:
                continue
            impulse = 2 * speed / (1 / self.m[i] + 1 / self.m[j])
            for v, part in ((self.vx, along[0]), (self.vy, along[1])):
                v[i] += impulse * part / self.m[i]
                v[j] -= impulse * part / self.m[j]
