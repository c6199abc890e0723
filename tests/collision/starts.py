"""Starts by property, each of a few objects: where structures have gone wrong, or might."""

from collections.abc import Callable
from functools import partial

import numpy as np
from numba import config
from numpy.typing import ArrayLike

from tetrabench.collision.objects import Floats, Start, make_objects

SLOW = bool(config.DISABLE_JIT)
SIZE = 48
BOX = 100.0


def start_of(
    x: ArrayLike, y: ArrayLike, r: ArrayLike = 3.0, *, seed: int = 1, speed: float = 1.0, box: float = BOX
) -> Start:
    """Objects with the velocities of the source, -2.5, -2, ..., 2 times `speed`, masses 1 to 8, in a square."""
    rng = np.random.default_rng(seed)
    count = np.size(x)
    vx, vy = speed * 0.5 * rng.integers(-5, 5, (2, count))
    return Start(make_objects(x, y, vx, vy, r, rng.integers(1, 9, count).astype(float)), box, box)


def scattered(low: float, high: float, *, size: int = SIZE, seed: int = 2) -> tuple[Floats, Floats]:
    """Places at random in a square."""
    x, y = np.random.default_rng(seed).uniform(low, high, (2, size))
    return x, y


def scaled(factor: float) -> Start:
    """A start at random, in other units."""
    x, y = scattered(0, BOX)
    return start_of(factor * x, factor * y, factor * 3, speed=factor, box=factor * BOX)


def line(dx: float, dy: float) -> Start:
    """Objects on a line, some of them in one place; in no order."""
    t = np.random.default_rng(3).integers(0, 2 * SIZE, SIZE).astype(float)
    return start_of(20 + dx * t, 20 + dy * t)


def places(kinds: int, *, speed: float) -> Start:
    """All in so many places."""
    return start_of(30.0 + 7 * (np.arange(SIZE) % kinds), 40.0 - 5 * (np.arange(SIZE) % kinds), speed=speed)


def lattice(step: float, r: float, *, copies: int = 1, speed: float = 1.0) -> Start:
    """Dyadic lattice: means and medians of some are coordinates of others."""
    side = int(np.sqrt(SIZE // copies))
    x, y = np.meshgrid(step * np.arange(side), step * np.arange(side))
    order = np.random.default_rng(4).permutation(side * side * copies)
    return start_of(np.tile(x.ravel(), copies)[order], np.tile(y.ravel(), copies)[order], r, speed=speed)


def means() -> Start:
    """Each object at the mean of all before it, or where one of them is, in x and in y."""
    rng = np.random.default_rng(5)
    x, y = [0.0, 96.0], [0.0, 64.0]
    while len(x) < SIZE:
        here = rng.integers(len(x))
        x.append(float(np.mean(x)) if rng.random() < 0.5 else x[here])
        y.append(float(np.mean(y)) if rng.random() < 0.5 else y[here])
    return start_of(x, y)


def doubling(first: int, last: int) -> Start:
    """Coordinates are powers of 2: the mean has all but few on one side, so that the tree is a chain."""
    x = 2.0 ** np.arange(first, last)
    return start_of(x, x[::-1], 1.0, speed=0.25)


def far() -> Start:
    """Far outside of the box, on all sides of it, and fleeing or coming back."""
    x, y = scattered(0, 20)
    side = np.array([-1e9, -1e6, 0, 1e6, 1e9])
    return start_of(x + side[np.arange(SIZE) % 5], y + side[np.arange(SIZE) // 5 % 5])


def outlier() -> Start:
    """All but one in the box."""
    x, y = scattered(0, BOX)
    x[SIZE // 2], y[SIZE // 2] = -1e9, 1e9
    return start_of(x, y)


def mixed(ratio: float) -> Start:
    """Small ones, and some that are so many times larger."""
    x, y = scattered(0, BOX)
    r = np.where(np.arange(SIZE) % 8 == 3, ratio * 0.25, 0.25)
    return start_of(x, y, r)


def clustered() -> Start:
    """Almost all in a hundredth of the box."""
    x, y = scattered(45, 55)
    x[:3], y[:3] = [0, 100, 3], [100, 1, 0]
    return start_of(x, y, 1.0)


def zeros() -> Start:
    """Around the origin, some at 0 and some at -0."""
    x, y = scattered(-8, 8)
    x[::3], y[::4] = 0.0, -0.0
    x[::6], y[::8] = -0.0, 0.0
    return start_of(x, y)


def few(count: int) -> Start:
    """None, one, two or three; the first two in contact, on a course towards each other."""
    x, y = np.array([50.0, 53, 58])[:count], np.array([50.0, 51, 49])[:count]
    return start_of(x, y)


STARTS: dict[str, Callable[[], Start]] = {
    "random": lambda: start_of(*scattered(0, BOX)),
    "negative": lambda: start_of(*scattered(-BOX, -1)),
    "clustered": clustered,
    "vertical": partial(line, 0.0, 1.5),
    "horizontal": partial(line, 1.5, 0.0),
    "diagonal": partial(line, 1.0, 1.0),
    "one place": partial(places, 1, speed=0.0),
    "a burst": partial(places, 1, speed=1.0),
    "two places": partial(places, 2, speed=0.0),
    "five bursts": partial(places, 5, speed=0.5),
    "lattice": partial(lattice, 8.0, 3.0),
    "lattice of duplicates": partial(lattice, 16.0, 7.0, copies=4),
    "touching": partial(lattice, 4.0, 2.0, speed=0.0),  # centres as far apart as the sum of radii: no contact
    "means": means,
    "doubling": partial(doubling, -SIZE // 2, SIZE // 2),
    "far": far,
    "outlier": outlier,
    "radii 10:1": partial(mixed, 10.0),
    "radii 1000:1": partial(mixed, 1000.0),
    "units 1e-12": partial(scaled, 1e-12),
    "units 1e12": partial(scaled, 1e12),
    "zeros": zeros,
    "none": partial(few, 0),
    "one": partial(few, 1),
    "two": partial(few, 2),
    "three": partial(few, 3),
}
