"""Two contenders in turn: paired samples, the median of their ratios, and an interval that holds it.

What disturbs a machine for longer than a turn disturbs both samples of a pair, and cancels in their ratio. The interval
is that of the sign test (W. J. Conover, Practical Nonparametric Statistics, 3.2): it takes nothing for granted about how
the ratios are spread.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from statistics import median
from typing import NamedTuple, TypeVar

Ours = TypeVar("Ours")
Theirs = TypeVar("Theirs")

CONFIDENCE = 0.95
FEWEST = 6
"""Pairs that an interval needs: the range of five holds the median with less than CONFIDENCE."""


class Ratio(NamedTuple):
    """The median of paired ratios, and the ends of the interval that holds it with CONFIDENCE at least."""

    median: float
    low: float
    high: float


def in_turn(turns: int, ours: Callable[[], Ours], theirs: Callable[[], Theirs]) -> Iterator[tuple[Ours, Theirs]]:
    """Pairs of samples (ours, theirs), one a turn; every other turn begins with theirs."""
    for turn in range(turns):
        if turn % 2:
            second = theirs()
            yield ours(), second
        else:
            yield ours(), theirs()


def paired_ratio(ours: Sequence[float], theirs: Sequence[float]) -> Ratio:
    """The ratio ours / theirs, pair by pair; at least FEWEST pairs."""
    ratios = sorted(one / other for one, other in zip(ours, theirs, strict=True))
    rank = interval_rank(len(ratios))
    return Ratio(median(ratios), ratios[rank], ratios[-1 - rank])


def interval_rank(n: int, confidence: float = CONFIDENCE) -> int:
    """The largest k, from 0, for which the k-th smallest and the k-th largest of n hold the median with `confidence`.

    Raises:
        ValueError: n is less than `fewest_for` it.
    """
    tail, rank = 0.0, -1
    for k in range(n // 2):
        tail += math.comb(n, k) / 2**n
        if tail > (1 - confidence) / 2:
            break
        rank = k
    if rank < 0:
        raise ValueError(f"an interval needs {fewest_for(confidence)} values at least, not {n}")
    return rank


def fewest_for(confidence: float) -> int:
    """How many values it takes until their range holds the median with `confidence`."""
    return math.ceil(1 - math.log2(1 - confidence))
