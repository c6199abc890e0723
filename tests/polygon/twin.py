"""The twin of every format, and lists out of arrays to compare with its own."""

from collections.abc import Iterable
from itertools import pairwise

from tetrabench.polygon.twin import Twin, circle, sides_of

__all__ = ["Twin", "as_lists", "circle", "sides_of"]


def as_lists(starts: Iterable[int], items: Iterable[int]) -> list[list[int]]:
    """Lists that lie one behind the other, one by one."""
    starts, items = list(map(int, starts)), list(map(int, items))
    assert starts[0] == 0
    assert starts[-1] == len(items)
    return [items[begin:end] for begin, end in pairwise(starts)]
