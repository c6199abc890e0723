"""Small simulations to be watched, and a naive twin that tells who is in contact."""

from collections.abc import Sequence

import numpy as np

from tetrabench.backends.collision import STRUCTURES
from tetrabench.collision.objects import Objects, Start, make_objects
from tetrabench.collision.simulation import Simulation
from tetrabench.watch.player import Player

SIDE = 400.0


def make_start(rng: np.random.Generator, count: int, *, height: float = SIDE) -> Start:
    """Objects of several sizes, some of them in contact, some with their centre outside of the box."""
    x, y = rng.uniform(-5, SIDE + 5, count), rng.uniform(-5, height + 5, count)
    vx, vy = rng.integers(-5, 5, (2, count)) / 2
    return Start(make_objects(x, y, vx, vy, rng.uniform(4, 12, count), 5.0), SIDE, height)


def make_player(
    rng: np.random.Generator, backend: str = "kdtree", *, count: int = 60, among: Sequence[str] = ("kdtree", "grid")
) -> Player:
    """A player of a small simulation."""
    contestants = {name: STRUCTURES[name] for name in dict.fromkeys([*among, backend])}
    return Player(Simulation(make_start(rng, count), contestants[backend]), contestants)


def naive_contacts(objects: Objects) -> set[tuple[int, int]]:
    """All pairs, tested one by one."""
    x, y, _, _, r, _ = (column.tolist() for column in objects)
    return {
        (i, j)
        for i in range(len(x))
        for j in range(i + 1, len(x))
        if (x[i] - x[j]) ** 2 + (y[i] - y[j]) ** 2 < (r[i] + r[j]) ** 2
    }
