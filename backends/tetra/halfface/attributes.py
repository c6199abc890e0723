"""Values of elements: dense, one for each, or sparse, for a few. Source: thesis, 5.5.5; sparse ones are its wish."""

from collections.abc import Callable, Hashable, Iterator
from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

from tetrabench.backends.tetra.halfface.handles import Element
from tetrabench.errors import InputError


class DenseAttribute:
    """One value for each element of a kind, in an array that grows with them and is renumbered with them.

    `attribute[handle]` is a value, `attribute[handles]` values, and both can be set; `values` is the whole array.
    """

    def __init__(
        self, element: Element, name: str, size: int, *, dtype: DTypeLike, shape: tuple[int, ...], default: Any
    ) -> None:
        """`size` elements, each with a value of `shape` and `dtype`, which is `default` until it is set."""
        self.element, self.name, self.default = element, name, np.asarray(default, dtype)
        self._array = np.empty((size, *shape), dtype)
        self._array[:] = self.default
        self._size = size

    @property
    def values(self) -> NDArray[Any]:
        """(elements, ...), a view of all values, those of deleted elements too; valid until the mesh grows."""
        return self._array[: self._size]

    def __getitem__(self, handles: Any) -> Any:
        return self.values[self._checked(handles)]

    def __setitem__(self, handles: Any, values: Any) -> None:
        self.values[self._checked(handles)] = values

    def _checked(self, handles: Any) -> Any:
        """Handles that there are, or a slice; InputError for others, INVALID among them: numpy would count from the end."""
        if isinstance(handles, slice):
            return handles
        given = np.asarray(handles)
        if given.dtype.kind not in "iu" and given.size:
            raise InputError(f"handles are whole numbers, not {given.dtype}")
        if given.size and not (given.min() >= 0 and given.max() < self._size):
            strange = given[(given < 0) | (given >= self._size)].ravel()[0]
            raise InputError(f"there is no {self.element.value} {strange}")
        return handles if given.size else given.astype(np.int64)

    def __len__(self) -> int:
        return self._size

    def fit(self, size: int) -> None:
        """Follow the mesh to another number of elements; new ones have the default."""
        if size > len(self._array):
            longer = np.empty((max(size, len(self._array) * 5 // 4), *self._array.shape[1:]), self._array.dtype)
            longer[: self._size] = self.values
            self._array = longer
        self._array[self._size : size] = self.default
        self._size = size

    def move(self, old: NDArray[np.int64], new: NDArray[np.int64]) -> None:
        """Elements `old` (k,) have become elements `new` (k,)."""
        self._array[new] = self._array[old]

    def reset(self, handles: Any) -> None:
        """Give elements the default again."""
        self._array[handles] = self.default

    def __repr__(self) -> str:
        return f"<{self.element.value} attribute {self.name!r}: {self.values.dtype} {self.values.shape}>"


class SparseAttribute:
    """Values of a few elements of any kind; all others have the default.

    Kept by the vertices of an element, which nothing renumbers.
    """

    def __init__(
        self,
        element: Element,
        name: str,
        default: Any,
        *,
        key_of: Callable[[Element, int], Hashable],
        handle_of: Callable[[Element, Any], int],
    ) -> None:
        """`key_of` names an element of this kind, valid or InputError, by its vertices; `handle_of` undoes that, or INVALID."""
        self.element, self.name, self.default = element, name, default
        self._key_of, self._handle_of = key_of, handle_of
        self._values: dict[Hashable, Any] = {}

    def __getitem__(self, handle: int) -> Any:
        return self._values.get(self._key_of(self.element, handle), self.default)

    def __setitem__(self, handle: int, value: Any) -> None:
        self._values[self._key_of(self.element, handle)] = value

    def __delitem__(self, handle: int) -> None:
        self._values.pop(self._key_of(self.element, handle), None)

    def __contains__(self, handle: int) -> bool:
        return self._key_of(self.element, handle) in self._values

    def __len__(self) -> int:
        return len(self._values)

    def __iter__(self) -> Iterator[int]:
        """The handles of the elements that have a value of their own."""
        return iter([self._handle_of(self.element, key) for key in self._values])

    def items(self) -> Iterator[tuple[int, Any]]:
        """Handles and values."""
        return zip(self, list(self._values.values()), strict=True)

    def forget(self, key: Hashable) -> None:
        """Drop the value of an element that is no more."""
        self._values.pop(key, None)

    def purge(self) -> None:
        """Drop the values of all elements that are no more."""
        self._values = {key: value for key, value in self._values.items() if self._handle_of(self.element, key) >= 0}

    def __repr__(self) -> str:
        return f"<sparse {self.element.value} attribute {self.name!r}: {len(self)} values>"


class Attributes:
    """The attributes of a mesh, by name."""

    def __init__(self) -> None:
        self._dense: dict[str, DenseAttribute] = {}
        self._sparse: dict[str, SparseAttribute] = {}

    def add(self, attribute: DenseAttribute | SparseAttribute) -> None:
        """Keep an attribute under its name.

        Raises:
            InputError: there is one of that name.
        """
        if attribute.name in self._dense or attribute.name in self._sparse:
            raise InputError(f"there is an attribute {attribute.name!r} already")
        if isinstance(attribute, DenseAttribute):
            self._dense[attribute.name] = attribute
        else:
            self._sparse[attribute.name] = attribute

    def get(self, name: str) -> DenseAttribute | SparseAttribute:
        """The attribute of a name, or InputError."""
        if name not in self._dense and name not in self._sparse:
            raise InputError(f"there is no attribute {name!r}")
        return self._dense[name] if name in self._dense else self._sparse[name]

    def remove(self, name: str) -> None:
        """Forget an attribute, or InputError."""
        self.get(name)
        self._dense.pop(name, None)
        self._sparse.pop(name, None)

    def dense(self, element: Element) -> list[DenseAttribute]:
        """The dense ones of a kind of element."""
        return [attribute for attribute in self._dense.values() if attribute.element == element]

    def sparse(self, *elements: Element) -> list[SparseAttribute]:
        """The sparse ones of some kinds of element."""
        return [attribute for attribute in self._sparse.values() if attribute.element in elements]
