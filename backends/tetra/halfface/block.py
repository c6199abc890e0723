"""The data that element sets share: handles in ascending order, and a tail of handles that are not sorted in yet.

Source: thesis, 5.8 (its superblock) and 5.10.5 (commit).
"""

import operator
from array import array
from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tetrabench.errors import InputError

LARGEST = 2**63 - 1
"""The largest handle there can be, whatever the kind: arrays of them are int64."""

Handles = NDArray[np.int64]


class Block:
    """Handles that one set, or several, hold; whoever changes them changes them for all.

    Attributes:
        committed: (n,) int64, ascending, with repeats. Replaced as a whole, never written to: so it can be handed out.
        tail: int64, in the order of insertion.
    """

    def __init__(self, committed: Handles | None = None, tail: "array[int] | None" = None) -> None:
        self.committed: Handles = np.empty(0, np.int64) if committed is None else committed
        self.tail: array[int] = array("q") if tail is None else tail

    def __len__(self) -> int:
        return len(self.committed) + len(self.tail)

    def commit(self) -> None:
        """Sort the tail and merge it with the rest, O(t log t + n). Repeats stay."""
        if self.tail:
            tail = np.sort(np.array(self.tail, np.int64))
            # two runs: a stable sort finds them and merges them, which costs less the more of either is in order
            self.committed = np.sort(np.concatenate((self.committed, tail)), kind="stable")
            self.tail = array("q")

    def unite(self) -> None:
        """Keep each committed handle once."""
        self.committed = distinct(self.committed)

    def clear(self) -> None:
        """Drop all handles, those of the tail, too."""
        self.committed, self.tail = np.empty(0, np.int64), array("q")

    def copy(self) -> "Block":
        """One of its own; O(t), for no one writes to what is committed."""
        return Block(self.committed, self.tail[:])


def distinct(ascending: Handles) -> Handles:
    """Each of (n,) int64 ascending numbers once; the same array where nothing repeats."""
    fresh = ascending[1:] != ascending[:-1]
    return ascending if fresh.all() else np.concatenate((ascending[:1], ascending[1:][fresh]))


def whole_number(given: Any) -> int:
    """A handle, valid or not, as an int.

    Raises:
        InputError: no whole number, or a bool, which is a slip.
    """
    try:
        if not isinstance(given, bool):
            return operator.index(given)
    except TypeError:
        pass
    raise InputError(f"a handle is a whole number, not {given!r}")


def as_handle(given: Any) -> int:
    """A handle that may belong to an element.

    Raises:
        InputError: no whole number, below 0 (INVALID is), or beyond int64.
    """
    handle = whole_number(given)
    if 0 <= handle <= LARGEST:
        return handle
    why = "is the invalid handle, of no element" if handle == -1 else "is no handle, which go from 0 to 2^63 - 1"
    raise InputError(f"{handle} {why}")


def as_handles(given: Iterable[Any]) -> "array[int]":
    """Handles that may belong to elements, in the given order: an array of whole numbers (n,), or any iterable of them.

    Raises:
        InputError: another shape, or one that is none; names the first.
    """
    if isinstance(given, np.ndarray) and given.ndim != 1:
        raise InputError(f"handles are an array of the shape (n,), not {given.shape}")
    if isinstance(given, np.ndarray) and given.dtype.kind in "iu":
        wrong = (given < 0) | (given > LARGEST)
        if wrong.any():
            as_handle(given[wrong.argmax()])
        return array("q", np.ascontiguousarray(given, np.int64).tobytes())
    try:
        each = iter(given)
    except TypeError:
        raise InputError(f"handles are several whole numbers, not {given!r}") from None
    return array("q", map(as_handle, each))
