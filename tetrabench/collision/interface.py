"""What every structure must answer: which objects are in contact, and which lie in a rectangle.

`storage` is the structure's NamedTuple of arrays, made of places x, y and radii r, each (n,) float64. Two objects are in
contact where dx * dx + dy * dy < (r_i + r_j)^2, each operation rounded on its own: so all structures find the same pairs,
to the last bit. Objects are known by their numbers, 0 to n - 1.

Answers are written into `out`, as many as it has room for; what is returned is how many there are. The order is free.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tetrabench.collision.objects import Floats
from tetrabench.jit import generic

Storage = Any
Pairs = NDArray[np.int32]
Numbers = NDArray[np.int32]


@generic()
def update(storage: Storage, x: Floats, y: Floats) -> Storage:
    """Follow the objects to where they are now. Returns the storage to go on with: the old one is dead where it had to grow."""


@generic()
def pairs(storage: Storage, x: Floats, y: Floats, r: Floats, out: Pairs) -> int:
    """All objects in contact, each pair once, the lesser number first. They are where the last `update` has found them.

    Args:
        out: (room, 2) int32.
    """


@generic()
def query_rect(
    storage: Storage,
    x: Floats,
    y: Floats,
    x_low: float,
    y_low: float,
    x_high: float,
    y_high: float,
    out: Numbers,
) -> int:
    """All objects with their centre in a rectangle, its border included. They are where the last `update` has found them.

    Args:
        out: (room,) int32.
    """


@generic()
def stats(storage: Storage) -> Mapping[str, float]:
    """What the structure counts, by name: "leaves", "depth" and "fill" as they are, "relocations", "splits", "merges" and
    "rebuilds" since it was built; those that it has. Not for kernels."""


@generic()
def leaf_rectangles(storage: Storage) -> Floats:
    """(k, 4) float64: x_low, y_low, x_high, y_high of what the plane is divided into; ends may be infinite. Not for kernels."""


@generic()
def structure_bytes(storage: Storage) -> Mapping[str, tuple[int, int]]:
    """Bytes (used, reserved) of each array of the structure, by name. Not for kernels."""


def bytes_of(storage: Storage, *, without: tuple[str, ...] = ()) -> dict[str, tuple[int, int]]:
    """`structure_bytes` where all that is reserved is used: of all arrays of a NamedTuple but some, which are not its own."""
    arrays = {
        name: one for name, one in storage._asdict().items() if isinstance(one, np.ndarray) and name not in without
    }
    return {name: (array.nbytes, array.nbytes) for name, array in arrays.items()}
