"""Edits of a net that happen as a whole, or not at all: a copy is taken first, and is the net again if they fail.

A copy of the storage rather than a list of what was done: a user's kernel may change a net without telling anybody. What
is not in arrays, such as nodes on the C heap, a slot policy keeps itself, in their places, so that refs that are addresses
survive too (`interface.hold`).
"""

from typing import Any, NamedTuple, TypeVar

import numpy as np

from tetrabench.jit.generic import is_implemented
from tetrabench.memory import refuse_if_too_large
from tetrabench.tetra import interface
from tetrabench.tetra.interface import Net
from tetrabench.tetra.memory import structure_bytes
from tetrabench.tetra.points import STALE

Part = TypeVar("Part")


class Snapshot(NamedTuple):
    """A net as it was.

    Attributes:
        storage: copies of all its arrays.
        held: what its slot policy keeps of what is in none; None where all is.
    """

    storage: Net
    held: Any


def take(net: Net) -> Snapshot:
    """Keep a net as it is, until `drop` or `restore`, one of which must follow.

    Raises:
        MemoryRefusedError: there is no room for a copy.
    """
    size = sum(reserved for _, reserved in structure_bytes(net).values())
    refuse_if_too_large("a copy of the net to go back to", size)
    storage = copied(net)
    return Snapshot(storage, interface.hold(net) if is_implemented(interface.hold, net) else None)


def drop(net: Net, snapshot: Snapshot) -> None:
    """Forget a snapshot of a net: it was changed for good."""
    if snapshot.held is not None:
        interface.let_go(net, snapshot.held, False)


def restore(net: Net, snapshot: Snapshot) -> Net:
    """The net of a snapshot, to go on with, bit for bit; `net`, what has become of it, is stale then."""
    if snapshot.held is not None:
        interface.let_go(net, snapshot.held, True)
    net.points.counters[STALE] = 1
    return snapshot.storage


def copied(part: Part, known: dict[int, Any] | None = None) -> Part:
    """A storage with copies of all its arrays; one that is there twice is one again."""
    known = {} if known is None else known
    if isinstance(part, np.ndarray) and id(part) not in known:
        known[id(part)] = part.copy()
    if isinstance(part, tuple):
        return type(part)(*(copied(field, known) for field in part))
    found: Part = known.get(id(part), part)
    return found
