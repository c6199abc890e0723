"""Which objects are in contact, with no structure at all: a sweep over them from left to right."""

import numpy as np
from numpy.typing import NDArray

from tetrabench.collision.objects import Floats
from tetrabench.jit import kernel


def sweep(x: Floats, y: Floats, r: Floats) -> tuple[int, NDArray[np.bool_]]:
    """Find the objects in contact, as `interface` defines it, to the last bit.

    Each object is tested against those whose circles begin before its own one ends: in a box of n objects that is about
    n^1.5 tests, a second for a million, and no memory to speak of. Rounding hides nothing: it keeps the order of numbers,
    so where two are in contact the one does not begin beyond the other's end, however both are rounded.

    Args:
        x, y, r: (n,) float64.

    Returns:
        How many pairs there are; (n,) bool, the objects in contact with one of a lower number.
    """
    low, high = x - r, x + r
    is_later = np.zeros(len(x), np.bool_)
    count = sweep_ordered(np.argsort(low, kind="stable"), low, high, x, y, r, is_later)
    return count, is_later


@kernel
def sweep_ordered(
    order: NDArray[np.int64],
    low: Floats,
    high: Floats,
    x: Floats,
    y: Floats,
    r: Floats,
    is_later: NDArray[np.bool_],
) -> int:
    """Count the pairs, and mark the later one of each; `order` (n,) int64 is that of `low`, where the circles begin."""
    count = 0
    for place in range(len(order)):
        i = order[place]
        for following in range(place + 1, len(order)):
            j = order[following]
            if low[j] > high[i]:
                break
            dx, dy, reach = x[i] - x[j], y[i] - y[j], r[i] + r[j]
            if dx * dx + dy * dy < reach * reach:
                count += 1
                is_later[max(i, j)] = True
    return count
