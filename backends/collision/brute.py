"""brute: no structure at all: every object is tested against every other. What all others are checked with."""

from typing import NamedTuple

import numpy as np

from tetrabench.collision import interface
from tetrabench.collision.objects import Floats
from tetrabench.jit import implements, kernel
from tetrabench.protocols import Options


class Brute(NamedTuple):
    """Nothing. `objects`: how many there are."""

    objects: int


def make_brute(x: Floats, y: Floats, r: Floats, values: Options) -> Brute:
    """Nothing to be made."""
    return Brute(len(x))


@implements(interface.update, Brute)
def update(storage, x, y):
    return storage


@implements(interface.pairs, Brute)
def pairs(storage, x, y, r, out):
    return test_all(x, y, r, out)


@implements(interface.query_rect, Brute)
def query_rect(storage, x, y, x_low, y_low, x_high, y_high, out):
    return scan(x, y, x_low, y_low, x_high, y_high, out)


@implements(interface.stats, Brute)
def stats(storage):
    return {}


@implements(interface.leaf_rectangles, Brute)
def leaf_rectangles(storage):
    return np.empty((0, 4))


@implements(interface.structure_bytes, Brute)
def structure_bytes(storage):
    return interface.bytes_of(storage)


@kernel(allocates=False)
def test_all(x, y, r, out):
    """All pairs of numbers."""
    count = 0
    for i in range(len(x)):
        for j in range(i + 1, len(x)):
            dx, dy, reach = x[i] - x[j], y[i] - y[j], r[i] + r[j]
            if dx * dx + dy * dy < reach * reach:
                if count < len(out):
                    out[count, 0], out[count, 1] = i, j
                count += 1
    return count


@kernel(allocates=False)
def scan(x, y, x_low, y_low, x_high, y_high, out):
    """All objects."""
    count = 0
    for i in range(len(x)):
        if x_low <= x[i] <= x_high and y_low <= y[i] <= y_high:
            if count < len(out):
                out[count] = i
            count += 1
    return count
