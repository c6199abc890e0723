"""Structure bytes: every buffer of a net once, by name, exact; what is in use, and what is reserved."""

from functools import singledispatch
from typing import Any

import numpy as np

from tetrabench.tetra import incidence, nearest, points
from tetrabench.tetra.interface import Net, slots_used


def structure_bytes(net: Net) -> dict[str, tuple[int, int]]:
    """Bytes (used, reserved) of each buffer of a net, by name.

    The rows up to the last live tetra are used, holes among them included: they take room.
    """
    sizes: dict[str, tuple[int, int]] = {}
    for part in net:
        for name, size in buffers(part, net).items():
            sizes[name if name not in sizes else f"{type(part).__name__}.{name}"] = size
    return sizes


@singledispatch
def buffers(part: Any, net: Net) -> dict[str, tuple[int, int]]:
    """Bytes (used, reserved) of the buffers of one part of a net.

    A storage whose buffers are arrays of one row a slot need not register: this default counts them, and takes small
    arrays (counters) as used throughout.
    """
    rows = int(slots_used(net))
    return {
        name: (array_bytes(array, min(rows, len(array)) if len(array) > 16 else len(array)), array.nbytes)
        for name, array in part._asdict().items()
        if isinstance(array, np.ndarray)
    }


def array_bytes(array: np.ndarray[Any, Any], rows: int) -> int:
    """Bytes of the first `rows` rows of an array."""
    return rows * (array.nbytes // len(array)) if len(array) else 0


@buffers.register
def _(part: points.Points, net: Net) -> dict[str, tuple[int, int]]:
    return {"points": (array_bytes(part.xyz, int(part.counters[points.COUNT])), part.xyz.nbytes)}


@buffers.register
def _(part: incidence.Incidence, net: Net) -> dict[str, tuple[int, int]]:
    heads = array_bytes(part.heads, int(net.points.counters[points.COUNT]))
    entries = array_bytes(part.entries, int(part.counters[incidence.USED]))
    return {"incidence": (heads + entries, part.heads.nbytes + part.entries.nbytes)}


@buffers.register
def _(part: nearest.Tree, net: Net) -> dict[str, tuple[int, int]]:
    return {"tree": (array_bytes(part.nodes, int(part.counters[nearest.COUNT])), part.nodes.nbytes)}
