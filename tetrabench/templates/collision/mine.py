"""mine: a structure that finds which of many moving objects touch.

It works as it is: a list of the objects, sorted by x in each step, in which each object looks ahead as far as it can reach.
Begin with the class, then let the functions follow. Each says what the rest of tetrabench relies on; `tetrabench check
--contestant mine --family collision` says where yours do not keep to it.

Words: objects are circles with centres x and y and radii r, (n,) float64 each, and known by their numbers, 0 to n - 1. They
touch where dx * dx + dy * dy < (r_i + r_j)^2, in just these operations: all structures find the same pairs, to the last bit.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tetrabench import protocols
from tetrabench.collision import interface
from tetrabench.collision.contestant import CollisionContestant
from tetrabench.jit import implements, kernel


class Mine(NamedTuple):
    """What is known of where the objects are. Change this.

    Attributes:
        order: (n,) int64: numbers of the objects, by rising x.
        reach: the largest sum of two radii, and a little more: differences are rounded.
        look: whether each object looks ahead no further than the largest could reach; it may be chosen, as an option.
    """

    order: NDArray[np.int64]
    reach: float
    look: int


def make_mine(x, y, r, values):
    """The structure of objects where they are now; `values` are those of the options, by name. Change it with the class."""
    return Mine(np.argsort(x), 2.0 * r.max(initial=0.0) * (1.0 + 1e-9), values["look"])


@implements(interface.update, Mine)
def update(storage, x, y):
    """Follow the objects to where they are now; return the storage to go on with: this one, or another if it had to grow."""
    sort_again(storage.order, x)
    return storage


@implements(interface.pairs, Mine)
def pairs(storage, x, y, r, out):
    """All objects that touch, each pair once, the lesser number first, in any order.

    As many as there is room for are written into `out`, (room, 2) int32; how many there are is returned, also where that is
    more. The objects are where `update` has seen them.
    """
    return test_ahead(storage, x, y, r, out)


@implements(interface.query_rect, Mine)
def query_rect(storage, x, y, x_low, y_low, x_high, y_high, out):
    """All objects with their centre in a rectangle or on its border, in any order, into `out`, (room,) int32; as above.

    The rectangle may be infinite, or empty (x_low > x_high).
    """
    return scan(storage, x, y, x_low, y_low, x_high, y_high, out)


@implements(interface.stats, Mine)
def stats(storage):
    """What the structure counts, by name, such as {"rebuilds": 3}; nothing, if it counts nothing. Plain Python."""
    return {}


@implements(interface.leaf_rectangles, Mine)
def leaf_rectangles(storage):
    """What the plane is divided into, for pictures: (k, 4) float64 x_low, y_low, x_high, y_high. Plain Python."""
    return np.empty((0, 4))


@implements(interface.structure_bytes, Mine)
def structure_bytes(storage):
    """Bytes (used, reserved) of each array, by name. `bytes_of` counts all arrays of the class. Plain Python."""
    return interface.bytes_of(storage)


@kernel(allocates=False)
def sort_again(order, x):
    """By insertion: in a step of time hardly any object passes another."""
    for place in range(1, len(order)):
        number, hole = order[place], place
        while hole > 0 and x[order[hole - 1]] > x[number]:
            order[hole] = order[hole - 1]
            hole -= 1
        order[hole] = number


@kernel(allocates=False)
def test_ahead(storage, x, y, r, out):
    """Each object and those behind it in the list, until none can be reached. No part of the interface, as all below."""
    count, order = 0, storage.order
    for place in range(len(order)):
        first = order[place]
        for ahead in range(place + 1, len(order)):
            other = order[ahead]
            if storage.look == 1 and x[other] - x[first] > storage.reach:
                break
            i, j = min(first, other), max(first, other)
            dx, dy, reach = x[i] - x[j], y[i] - y[j], r[i] + r[j]
            if dx * dx + dy * dy < reach * reach:
                if count < len(out):
                    out[count, 0], out[count, 1] = i, j
                count += 1
    return count


@kernel(allocates=False)
def scan(storage, x, y, x_low, y_low, x_high, y_high, out):
    """All objects, up to the right border."""
    count = 0
    for number in storage.order:
        if x[number] > x_high:
            break
        if x_low <= x[number] and y_low <= y[number] <= y_high:
            if count < len(out):
                out[count] = number
            count += 1
    return count


CONTESTANTS = [
    CollisionContestant(
        name="mine",
        title="a list sorted by x",
        trade_off="say in a line what it is good at; and what it pays for that",
        build=make_mine,
        options={
            "look": protocols.Option(
                1, 0, 1, "whether an object looks ahead no further than it can reach; else at all others"
            )
        },
        extension=True,
        # A library's structure, which kernels cannot take, says is_compiled=False: the same steps then run in Python.
    )
]
