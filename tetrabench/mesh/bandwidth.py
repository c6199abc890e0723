"""How far apart neighbours lie in a numbering, and whether another order would bring them together."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tetrabench.mesh.hilbert import hilbert_order

Rows = NDArray[np.integer]
Pairs = Iterable[tuple[Rows, Rows]]

FEWEST = 20_000
"""Elements of a mesh whose numbering matters: fewer lie in the caches in any order."""
WORTH = 4.0
"""So many times as far apart as along a Hilbert curve, and another order is worth its while: in a shuffled mesh neighbours are
tens to hundreds of times as far apart, in one numbered layer by layer about as far, which costs little (results/README.md)."""


@dataclass(frozen=True)
class Bandwidth:
    """Of a numbering from 0, and of pairs of neighbours in it.

    Attributes:
        largest: the bandwidth: the greatest distance |i - j| of neighbours i and j.
        mean: of these distances.
        profile: sum over all rows of how far before a row its first neighbour lies; 0 where none is before it (A. George and
            J. W. H. Liu, Computer Solution of Large Sparse Positive Definite Systems, 1981, chapter 4).
    """

    largest: int
    mean: float
    profile: int


def measure_bandwidth(count: int, pairs: Pairs) -> Bandwidth:
    """Measure a numbering.

    Args:
        count: how many rows there are.
        pairs: neighbours, (k,) rows and (k,) rows, in portions; one that comes twice counts twice in the mean.
    """
    first = np.arange(count)
    largest, total, number = 0, 0, 0
    for one, other in pairs:
        if len(one):
            low, high = np.minimum(one, other), np.maximum(one, other)
            distances = np.subtract(high, low, dtype=np.int64)
            largest = max(largest, int(distances.max()))
            total += int(distances.sum())
            number += len(distances)
            np.minimum.at(first, high, low)
    return Bandwidth(largest, total / number if number else 0.0, int((np.arange(count) - first).sum()))


def along_curve(places: NDArray[np.float64], pairs: Pairs) -> Bandwidth:
    """As `measure_bandwidth`, if the rows were in the order of their places, (count, 3), along a Hilbert curve."""
    new = np.empty(len(places), np.int64)
    new[hilbert_order(places)] = np.arange(len(places))
    return measure_bandwidth(len(places), ((new[one], new[other]) for one, other in pairs))


def measure_both(
    name: str, places: NDArray[np.float64], pairs: Callable[[], Pairs]
) -> tuple[dict[str, Bandwidth], str]:
    """Measure a numbering beside the order along a Hilbert curve.

    Args:
        name: of the elements, such as "tetras".
        places: (count, 3).
        pairs: gives the neighbours, anew each time.

    Returns:
        Both, by what they are of; and in words what reordering would give, "" where that is little.
    """
    now, then = measure_bandwidth(len(places), pairs()), along_curve(places, pairs())
    both = {name: now, f"{name} along a Hilbert curve": then}
    if len(places) < FEWEST or now.mean < WORTH * then.mean:
        return both, ""
    return both, (
        f"convert --numbering hilbert would bring neighbouring {name} from {now.mean:,.0f} rows apart to {then.mean:,.0f}, on "
        "average, and into the caches"
    )
