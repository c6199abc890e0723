"""Sets and multisets of elements, and set algebra that is worked out only as far as a question needs it.

Source: thesis, 5.5.8 and 5.8; the lazy algebra is its wish (8.5.3).

A set or multiset holds a `Block`, maybe together with others. What is inserted waits there in a tail until `commit()`. All
questions but `size` (`len`) and `is_committed` see the committed part alone. A block may hold a handle several times: a
multiset has it so often, a set once.

`a | b`, `a & b`, `a ^ b` and `a - b` are expressions: they hold their operands and no handles. Each question to one looks
at the operands as they are at that moment. Where one operand has a handle m times and the other n times, the expression
has it

    | union                  max(m, n) times
    & intersection           min(m, n)
    ^ symmetric difference   |m - n|
    - difference             max(m - n, 0)

as std::set_union and its like do in C++, which the source is written in. So the result is a multiset where one operand is one.
"""

import sys
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Iterator
from functools import reduce
from typing import NamedTuple, TypeVar

import numpy as np

from tetrabench.backends.tetra.halfface.block import (
    LARGEST,
    Block,
    Handles,
    as_handle,
    as_handles,
    distinct,
    whole_number,
)
from tetrabench.backends.tetra.halfface.handles import INVALID, Element
from tetrabench.errors import InputError

_FIRST_PAGE, _LARGEST_PAGE = 16, 4096
"""Handles looked at together: few at first, for a question may be answered by the first of them."""

_DEEPEST = 100
"""Levels of an expression, each of which takes stack when it is asked. A chain of one operator is one level."""

_SHOWN = 8
"""Handles that a set shows of itself."""

_Self = TypeVar("_Self", bound="_Set")


class Page(NamedTuple):
    """Some elements in ascending order, with nothing left out between the first and `end`.

    Attributes:
        handles: (n,) int64, ascending, distinct.
        counts: (n,) int64, how often each is there, more than 0.
        end: the handle up to which these are all; LARGEST on the last page.
    """

    handles: Handles
    counts: Handles
    end: int


class Operand(ABC):
    """What set algebra takes: a set, a multiset, an expression.

    Subclasses say how often they have a handle (`_count`, `_counts`) and list what they have in pages (`_page`); all else
    follows.

    Attributes:
        element: the kind of all its elements.
        levels: how deep an expression is; 0 for what is none.
    """

    element: Element
    levels = 0

    __hash__ = None  # type: ignore[assignment]

    @property
    @abstractmethod
    def multiple(self) -> bool:
        """Whether it may have an element more than once."""

    @abstractmethod
    def _count(self, handle: int) -> int:
        """How often a handle is there; `handle` is 0 to LARGEST."""

    @abstractmethod
    def _counts(self, handles: Handles) -> Handles:
        """How often each of (n,) ascending handles is there, (n,) int64."""

    @abstractmethod
    def _page(self, after: int, most: int) -> Page:
        """The elements beyond the handle `after`, up to some handle that is near enough for few of them.

        No set or multiset puts in more than `most`.
        """

    @abstractmethod
    def _bound(self) -> int:
        """There are no more distinct elements than that."""

    @abstractmethod
    def _frozen(self) -> "Operand":
        """The same with the elements of this moment, whatever is done to it later. Copies none of them."""

    def _pages(self) -> Iterator[Page]:
        """All elements, ascending; first a short page, for a question may be answered by the first of them."""
        end, most = INVALID, _FIRST_PAGE
        while end < LARGEST:
            page = self._page(end, most)
            yield page
            end, most = page.end, min(2 * most, _LARGEST_PAGE)

    def count(self, handle: int) -> int:
        """How often an element is there. A handle that can be of none, such as INVALID, is there 0 times.

        Raises:
            InputError: no whole number.
        """
        handle = whole_number(handle)
        return self._count(handle) if 0 <= handle <= LARGEST else 0

    def __contains__(self, handle: object) -> bool:
        return self.count(handle) > 0  # type: ignore[arg-type]

    def elem(self, handle: int) -> bool:
        """Whether an element is there: the same as `handle in ...`; a binary search for each operand, two in a multiset."""
        return handle in self

    def any(self) -> int:
        """The element with the lowest handle; INVALID where there is none. Looks no further than the page with the first."""
        return next((int(page.handles[0]) for page in self._pages() if len(page.handles)), INVALID)

    def is_empty(self) -> bool:
        """Whether there is no element; looks no further than `any`."""
        return self.any() == INVALID

    def __bool__(self) -> bool:
        return not self.is_empty()

    def __iter__(self) -> Iterator[int]:
        """Ascending, each as often as it is there; goes on over what was there at its beginning, whatever is changed."""
        pages = self._frozen()._pages()
        return (handle for page in pages for handle in np.repeat(page.handles, page.counts).tolist())

    def __eq__(self, other: object) -> bool:
        """Whether both have elements of the same kind, the same ones, each equally often."""
        if not isinstance(other, Operand):
            return NotImplemented
        return self.element is other.element and Expression(_SYMMETRIC_DIFFERENCE, (self, other), 0).is_empty()

    def evaluate(self) -> "ElementSet | ElementMultiset":
        """A committed set, or a multiset if `multiple`, of the elements of this moment, with data of its own."""
        whole = self._page(INVALID, sys.maxsize)
        kind = ElementMultiset if self.multiple else ElementSet
        return kind._of(self.element, Block(np.repeat(whole.handles, whole.counts)))

    def __or__(self, other: object) -> "Expression":
        return _combined(_UNION, self, other)

    def __and__(self, other: object) -> "Expression":
        return _combined(_INTERSECTION, self, other)

    def __xor__(self, other: object) -> "Expression":
        return _combined(_SYMMETRIC_DIFFERENCE, self, other)

    def __sub__(self, other: object) -> "Expression":
        return _combined(_DIFFERENCE, self, other)


class _Operator(NamedTuple):
    """What an operator makes of how often its operands have a handle.

    Attributes:
        sign: as it is written.
        of_numbers: for one handle, int and int -> int.
        of_arrays: for several, (n,) and (n,) int64 -> (n,) int64.
        driver: the operand that has all elements of the result; None where any of them may have some. If so, what has a
            handle 0 times changes nothing.
    """

    sign: str
    of_numbers: Callable[[int, int], int]
    of_arrays: Callable[[Handles, Handles], Handles]
    driver: Callable[[tuple[Operand, ...]], Operand] | None


_UNION = _Operator("|", max, np.maximum, None)
_INTERSECTION = _Operator("&", min, np.minimum, lambda operands: min(operands, key=lambda one: one._bound()))
_SYMMETRIC_DIFFERENCE = _Operator("^", lambda m, n: abs(m - n), lambda m, n: np.abs(m - n), None)
_DIFFERENCE = _Operator(
    "-", lambda m, n: max(m - n, 0), lambda m, n: np.maximum(m - n, 0), lambda operands: operands[0]
)


class Expression(Operand):
    """Operands of one kind under one operator, from left to right. Made by the operators of `Operand`."""

    def __init__(self, operator: _Operator, operands: tuple[Operand, ...], levels: int) -> None:
        self.operator, self.operands, self.levels = operator, operands, levels
        self.element = operands[0].element

    @property
    def multiple(self) -> bool:
        """Whether one of the operands is a multiset."""
        return any(one.multiple for one in self.operands)

    def _count(self, handle: int) -> int:
        return reduce(self.operator.of_numbers, (one._count(handle) for one in self.operands))

    def _counts(self, handles: Handles) -> Handles:
        return reduce(self.operator.of_arrays, (one._counts(handles) for one in self.operands))

    def _page(self, after: int, most: int) -> Page:
        if self.operator.driver is None:
            handles, counts, end = _merged([one._page(after, most) for one in self.operands], self.operator.of_arrays)
        else:
            driver = self.operator.driver(self.operands)
            handles, known, end = driver._page(after, most)
            each = (known if one is driver else one._counts(handles) for one in self.operands)
            counts = reduce(self.operator.of_arrays, each)
        there = counts > 0
        return Page(handles[there], counts[there], end)

    def _bound(self) -> int:
        if self.operator.driver is None:
            return sum(one._bound() for one in self.operands)
        return self.operator.driver(self.operands)._bound()

    def _frozen(self) -> "Expression":
        return Expression(self.operator, tuple(one._frozen() for one in self.operands), self.levels)

    def __str__(self) -> str:
        shown = [f"({one})" if isinstance(one, Expression) else str(one) for one in self.operands[:_SHOWN]]
        more = ["..."] if len(self.operands) > _SHOWN else []
        return f" {self.operator.sign} ".join(shown + more)

    def __repr__(self) -> str:
        return f"<{self.element.value} expression {self}>"


def _combined(operator: _Operator, left: Operand, right: object) -> Expression:
    """The expression of two operands. `a | b | c` is one level: one more operand for a `left` of the same operator.

    Raises:
        InputError: they are of different kinds, or there are too many levels.
    """
    if not isinstance(right, Operand):
        return NotImplemented  # type: ignore[no-any-return]
    _check_element(left, right)
    if isinstance(left, Expression) and left.operator is operator:
        made = Expression(operator, (*left.operands, right), max(left.levels, right.levels + 1))
    else:
        made = Expression(operator, (left, right), max(left.levels, right.levels) + 1)
    if made.levels > _DEEPEST:
        raise InputError(f"an expression of more than {_DEEPEST} levels; evaluate() a part of it in between")
    return made


def _merged(pages: list[Page], of_arrays: Callable[[Handles, Handles], Handles]) -> Page:
    """The page of operands without a driver, from theirs; its counts may be 0."""
    end = min(page.end for page in pages)  # beyond it one of them may have more
    handles = np.concatenate([page.handles for page in pages])
    counts = np.concatenate([page.counts for page in pages])
    order = np.argsort(handles, kind="stable")  # merges; equal ones stay in the order of the operands
    order = order[: handles.searchsorted(end, "right", sorter=order)]
    handles, counts = handles[order], counts[order]
    first = np.flatnonzero(np.concatenate(([True], handles[1:] != handles[:-1]))[: len(handles)])
    beyond = np.append(first[1:], len(handles))
    result = counts[first]
    for n in range(1, int((beyond - first).max(initial=0))):  # the n-th operand after the first that has the handle
        more = np.flatnonzero(first + n < beyond)
        result[more] = of_arrays(result[more], counts[first[more] + n])
    return Page(handles[first], result, end)


def _check_element(one: Operand, other: Operand) -> None:
    if one.element is not other.element:
        raise InputError(
            f"elements of two kinds, {one.element.value} and {other.element.value}: convert one to the other's kind"
        )


class _Set(Operand):
    """What sets and multisets share: all but how often a handle counts that the block has several times."""

    def __init__(self, element: Element | Operand, handles: Iterable[int] | None = None) -> None:
        """A committed one of a kind of element, with these handles; or one of what another operand has.

        Of a set or multiset it shares the data, as in the source (`isolate` parts them); an expression is evaluated.

        Raises:
            InputError: `element` is neither a kind nor an operand, or an operand and there are handles, too; or see
                `insert_range`.
        """
        if isinstance(element, Operand) and handles is None:
            self.element = element.element
            self.assign(element)
        elif isinstance(element, Element):
            self.element, self._block = element, Block()
            self.insert_range(() if handles is None else handles)
            self.commit()
        else:
            raise InputError(f"a set is made of a kind, such as Element.VERTEX, and handles, not of {element!r}")

    @classmethod
    def _of(cls: type[_Self], element: Element, block: Block) -> _Self:
        """One that holds this block."""
        made = cls(element)
        made._block = block
        return made

    def _page(self, after: int, most: int) -> Page:
        committed = self._block.committed
        begin = committed.searchsorted(after, "right")
        handles = committed[begin : begin + most]
        end = int(handles[-1]) if begin + most < len(committed) else LARGEST
        handles = distinct(handles)
        return Page(handles, self._counts(handles), end)

    def _bound(self) -> int:
        return self.committed_size

    def _frozen(self: _Self) -> _Self:
        return self._of(self.element, self._block.copy())

    @property
    def handles(self) -> Handles:
        """(n,) int64, read-only: the elements as iteration gives them. Kernels want a copy: they take writable arrays.

        A view of the data; in a set with repeats in it a copy without them.
        """
        handles = self._block.committed if self.multiple else distinct(self._block.committed)
        view = handles.view()
        view.flags.writeable = False
        return view

    def __reversed__(self) -> Iterator[int]:
        """Descending; goes on over what was there at its beginning."""
        return iter(self.handles[::-1].tolist())

    @property
    def size(self) -> int:
        """How many handles the block has, committed or not, each as often as it was inserted, in a set too."""
        return len(self._block)

    def __len__(self) -> int:
        return self.size

    @property
    def committed_size(self) -> int:
        """How many of them are committed."""
        return len(self._block.committed)

    @property
    def empty(self) -> bool:
        """The same as `is_empty()`."""
        return self.is_empty()

    def is_committed(self) -> bool:
        """Whether no handle waits in the tail."""
        return self.size == self.committed_size

    def insert(self, handle: int) -> None:
        """Put a handle at the end of the tail.

        Raises:
            InputError: no whole number, INVALID, or beyond int64.
        """
        self._block.tail.append(as_handle(handle))

    def insert_range(self, handles: Iterable[int]) -> None:
        """Put several at the end of the tail, in their order: an array of integers (n,), or any iterable of them.

        Raises:
            InputError: one of them is none, see `insert`, or they are of an operand of another kind; nothing is inserted.
        """
        if isinstance(handles, Operand):
            _check_element(self, handles)
            handles = handles.evaluate().handles
        self._block.tail.extend(as_handles(handles))

    def commit(self) -> None:
        """Sort the tail and merge it with what is committed; handles that are there several times stay so."""
        self._block.commit()

    def unique(self) -> None:
        """Keep each committed element once, in multisets that share the data, too."""
        self._block.unite()

    def clear(self) -> None:
        """Drop all handles, those of the tail, too."""
        self._block.clear()

    def isolate(self: _Self) -> _Self:
        """Take a copy of the data, so that no other set shares it from now on; returns this set."""
        self._block = self._block.copy()
        return self

    def assign(self, other: Operand) -> None:
        """Let go of the data and share those of another set or multiset; an expression is evaluated.

        Raises:
            InputError: it is neither, or of another kind of element.
        """
        if isinstance(other, _Set):
            _check_element(self, other)
            self._block = other._block
        elif isinstance(other, Operand):
            _check_element(self, other)
            self._block = other.evaluate()._block
            if not self.multiple:
                self.unique()
        else:
            raise InputError(f"only a set, a multiset or an expression can be assigned, not {other!r}")

    def swap(self, other: "ElementSet | ElementMultiset") -> None:
        """Exchange the data with another set or multiset; those that share them do not follow.

        Raises:
            InputError: it is neither, or of another kind of element.
        """
        if not isinstance(other, _Set):
            raise InputError(f"a set can be swapped with a set or multiset, not with {other!r}")
        _check_element(self, other)
        self._block, other._block = other._block, self._block

    def __str__(self) -> str:
        handles = self.handles
        more = [f"... of {len(handles):,}"] if len(handles) > _SHOWN else []
        return "{" + ", ".join([str(handle) for handle in handles[:_SHOWN]] + more) + "}"

    def __repr__(self) -> str:
        waiting = self.size - self.committed_size
        tail = f", {waiting:,} not committed" if waiting else ""
        return f"<{self.element.value} {'multiset' if self.multiple else 'set'} {self}{tail}>"


class ElementSet(_Set):
    """A set of elements of one kind: each is there once, even if its block has it several times."""

    multiple = False

    def _count(self, handle: int) -> int:
        committed = self._block.committed
        place = committed.searchsorted(handle)
        return int(place < len(committed) and committed[place] == handle)

    def _counts(self, handles: Handles) -> Handles:
        committed = self._block.committed
        if not len(committed):
            return np.zeros(len(handles), np.int64)
        places = committed.searchsorted(handles)  # (len(committed) beyond the last)
        there: Handles = (committed.take(places, mode="clip") == handles).astype(np.int64)
        return there


class ElementMultiset(_Set):
    """A multiset of elements of one kind: each is there as often as it was inserted, until `unique()`."""

    multiple = True

    def _count(self, handle: int) -> int:
        committed = self._block.committed
        return int(committed.searchsorted(handle, "right") - committed.searchsorted(handle))

    def _counts(self, handles: Handles) -> Handles:
        committed = self._block.committed
        return committed.searchsorted(handles, "right") - committed.searchsorted(handles)
