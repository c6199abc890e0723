"""Broken contestants: a good one, with one function of it in the place of another. For plug-in files of tests."""

from typing import Any, NamedTuple

from tetrabench.jit.generic import _IMPLEMENTATIONS, implements


def broken_type(good: type, functions: dict[Any, Any], without: tuple[Any, ...] = ()) -> type:
    """A storage like `good`, of a type of its own, which implements all that it does: `functions` in other ways.

    `functions`: generic function -> (implementation of the good one -> that of the broken one), with the same parameters.
    """
    fields = [(name, Any) for name in good._fields]
    made = NamedTuple("Broken", fields)
    for function, table in _IMPLEMENTATIONS.items():
        if good in table and function not in without:
            implementation = _of_type(table[good], good, made)
            if function in functions:
                implementation = functions[function](implementation)
            implements(function, made)(implementation)
    return made


def _of_type(implementation: Any, good: type, made: type) -> Any:
    """The same, which gives storages of the broken type where it gave good ones."""
    if not implementation.__name__.startswith(("grown_", "update")):
        return implementation

    def of_type(*arguments: Any) -> Any:
        grown = implementation(*arguments)
        return made(*grown) if isinstance(grown, good) else grown

    of_type.__signature__ = implementation.__signature__  # type: ignore[attr-defined]
    return of_type
