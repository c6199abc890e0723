"""The order of objects in memory: as they come, at random, or so that neighbours in space are neighbours in memory."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from tetrabench.collision.objects import Objects, Start
from tetrabench.errors import InputError, find_named
from tetrabench.mesh.hilbert import hilbert_order
from tetrabench.mesh.numbering import check_seed

Rows = NDArray[np.int64]


def renumber_objects(start: Start, numbering: str, seed: int = 0) -> Start:
    """Return the start with its objects in another order, one of NUMBERINGS.

    Args:
        start: any.
        numbering: its name.
        seed: of the shuffling, 0 or more.

    Raises:
        InputError: see `check_numbering`; or a seed below 0.
    """
    check_numbering(numbering)
    check_seed(seed)
    order = NUMBERINGS[numbering]
    if order is None:
        return start
    rows = order(start.objects, seed)
    drawn = f" (seed {seed})" if order is shuffled_order else ""
    return replace(
        start,
        objects=Objects(*(column[rows] for column in start.objects)),
        source=f"{start.source}, {numbering} numbering{drawn}",
    )


def check_numbering(name: str) -> None:
    """Refuse, with InputError, a numbering that is unknown, or that objects cannot have."""
    if name == "rcm":
        raise InputError(f"objects have no graph, which rcm would follow; number them {', '.join(NUMBERINGS)}")
    find_named("numbering", NUMBERINGS, name)


def shuffled_order(objects: Objects, seed: int) -> Rows:
    """Objects at random."""
    return np.random.default_rng([seed, 1]).permutation(len(objects.x))  # a stream of its own: models draw from [seed]


def curve_order(objects: Objects, seed: int) -> Rows:
    """Objects along a Hilbert curve, by their centres. Takes no seed."""
    return hilbert_order(np.column_stack([objects.x, objects.y, np.zeros(len(objects.x))]))


NUMBERINGS: dict[str, Callable[[Objects, int], Rows] | None] = {
    "natural": None,
    "shuffled": shuffled_order,
    "hilbert": curve_order,
}
