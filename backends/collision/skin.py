"""skin: a list of all pairs that are nearly in contact, which stays good until something has moved by half of the skin.

Source: L. Verlet, Computer "experiments" on classical fluids, 1967; made here by a grid, whose reach is wider by the skin.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tetrabench.backends.collision.grid import Grid, empty_grid, find_near, follow, look_into
from tetrabench.backends.collision.grid import leaf_rectangles as squares
from tetrabench.collision import interface
from tetrabench.collision.dynamics import BITS, put_in_order, room_for
from tetrabench.collision.interface import Pairs
from tetrabench.collision.objects import Floats
from tetrabench.jit import implements, kernel
from tetrabench.protocols import Options

LISTED, REBUILDS = range(2)
SAFE = 0.4999
"""Of the skin, rather than half of it: distances are rounded."""


class Skin(NamedTuple):
    """Pairs that may be in contact.

    Attributes:
        grid: of where the objects were when the list was made.
        near, spare: (room, 2) int32: the list, in the order of numbers; room to sort it.
        square: (room,) float64: the square of the sum of the radii of each pair.
        counts: (2^BITS,) int64: to sort with.
        radius: (n,) float64: by number; not the list's own.
        then_x, then_y: (n,) float64: where the objects were when the list was made.
        state: (2,) int64: how many pairs are LISTED; how often the list was made.
        skin: how much further apart they may be than the sum of their radii.
    """

    grid: Grid
    near: Pairs
    spare: Pairs
    square: Floats
    counts: NDArray[np.int64]
    radius: Floats
    then_x: Floats
    then_y: Floats
    state: NDArray[np.int64]
    skin: float


def make_skin(x: Floats, y: Floats, r: Floats, values: Options) -> Skin:
    """The list of where they are."""
    diameter = 2 * float(r.max(initial=0.0))
    skin = diameter * values["skin"] / 100
    near = np.empty((64, 2), np.int32)
    storage = Skin(
        grid=empty_grid(r, diameter + skin, values["per_ten"]),
        near=near,
        spare=near.copy(),
        square=np.empty(64),
        counts=np.zeros(1 << BITS, np.int64),
        radius=r,
        then_x=np.zeros(len(x)),
        then_y=np.zeros(len(x)),
        state=np.array([0, -1]),
        skin=skin,
    )
    made: Skin = make_list(storage, x, y)
    return made


@implements(interface.update, Skin)
def update(storage, x, y):
    if moved(storage, x, y) < SAFE * storage.skin:
        return storage
    return make_list(storage, x, y)


@implements(interface.pairs, Skin)
def pairs(storage, x, y, r, out):
    return test_list(storage, x, y, out)


@implements(interface.query_rect, Skin)
def query_rect(storage, x, y, x_low, y_low, x_high, y_high, out):
    return look_into(storage.grid, x, y, x_low, y_low, x_high, y_high, storage.skin, out)


@implements(interface.stats, Skin)
def stats(storage):
    return {"listed": int(storage.state[LISTED]), "rebuilds": int(storage.state[REBUILDS])}


@implements(interface.leaf_rectangles, Skin)
def leaf_rectangles(storage):
    return squares(storage.grid)


@implements(interface.structure_bytes, Skin)
def structure_bytes(storage):
    listed = int(storage.state[LISTED])
    room = len(storage.near)
    lists = {name: (size * listed, size * room) for name, size in (("near", 8), ("spare", 8), ("square", 8))}
    grid = {f"grid.{name}": size for name, size in interface.structure_bytes(storage.grid).items()}
    return interface.bytes_of(storage, without=("radius",)) | lists | grid


@kernel(allocates=False)
def moved(storage, x, y):
    """At least as far as any object has moved since the list was made."""
    most = 0.0
    for i in range(len(x)):
        dx, dy = x[i] - storage.then_x[i], y[i] - storage.then_y[i]
        most = max(most, dx * dx + dy * dy)
    return np.sqrt(most)


@kernel
def make_list(storage, x, y):
    """Where the objects are now, and which are near to each other."""
    grid, near, spare, square = follow(storage.grid, x, y), storage.near, storage.spare, storage.square
    listed = find_near(grid, storage.skin, near)
    if listed > len(near):
        near, spare = room_for(listed), room_for(listed)
        square = np.empty(len(near))
        listed = find_near(grid, storage.skin, near)
    put_in_order(near, spare, storage.counts, listed, len(x))
    for k in range(listed):
        reach = storage.radius[near[k, 0]] + storage.radius[near[k, 1]]
        square[k] = reach * reach
    for i in range(len(x)):
        storage.then_x[i], storage.then_y[i] = x[i], y[i]
    storage.state[LISTED] = listed
    storage.state[REBUILDS] += 1
    return Skin(
        grid,
        near,
        spare,
        square,
        storage.counts,
        storage.radius,
        storage.then_x,
        storage.then_y,
        storage.state,
        storage.skin,
    )


@kernel(allocates=False)
def test_list(storage, x, y, out):
    """The pairs of the list that are in contact."""
    count = 0
    for k in range(storage.state[LISTED]):
        i, j = storage.near[k, 0], storage.near[k, 1]
        dx, dy = x[i] - x[j], y[i] - y[j]
        if dx * dx + dy * dy < storage.square[k]:
            if count < len(out):
                out[count, 0], out[count, 1] = i, j
            count += 1
    return count
