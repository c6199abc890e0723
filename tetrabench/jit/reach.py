"""What functions of others are made from: the modules that they reach by name, and the constants that they take along."""

import sys
from collections.abc import Iterable, Iterator
from types import CodeType, FunctionType, ModuleType
from typing import Any

import numpy as np

_KNOWN = frozenset({"tetrabench", "numba", "numpy", "llvmlite", *sys.stdlib_module_names})
"""Top-level packages whose code does not change between two runs of the same versions, or is looked at elsewhere."""


def is_foreign(module: str | None) -> bool:
    """Whether a module is neither ours nor a part of what everybody has."""
    return (module or "").split(".")[0] not in _KNOWN


def reach(functions: Iterable[Any]) -> tuple[set[str], set[str]]:
    """The foreign modules that functions come from, and those of all that they call; and the constants that these name.

    The compiler puts constants, and what is called, into the code: where one of them changes, the code is another. Names are
    followed through functions, kernels, tuples, and attributes of modules. What a class or another container holds is not.
    """
    modules: set[str] = set()
    constants: set[str] = set()
    waiting, seen = list(functions), set()
    while waiting:
        found = waiting.pop()
        function = getattr(found, "py_func", found)
        if function in seen or not isinstance(function, FunctionType) or not is_foreign(function.__module__):
            continue
        seen.add(function)
        modules.add(function.__module__ or "")
        for name, value in _single(_named_by(function)):
            if isinstance(value, FunctionType) or hasattr(value, "py_func"):
                waiting.append(value)
            elif isinstance(value, type):
                modules |= {value.__module__} if is_foreign(value.__module__) else set()
            elif isinstance(value, np.ndarray):
                constants.add(f"{name} {value.dtype} {value.shape} {value.tobytes().hex()}")
            elif isinstance(value, bool | int | float | complex | str | bytes | np.generic):
                constants.add(f"{name} {type(value).__name__} {value!r}")
    return modules, constants


def _named_by(function: FunctionType) -> Iterator[tuple[str, Any]]:
    """The global values, and those of the functions around it, that a function names; of modules what it names of them."""
    names = set(_names(function.__code__))
    cells = zip(function.__code__.co_freevars, function.__closure__ or (), strict=True)
    values = {name: function.__globals__[name] for name in names if name in function.__globals__}
    for name, cell in cells:
        try:
            values[name] = cell.cell_contents
        except ValueError:  # of a function that is still being defined
            continue
    for name, value in values.items():
        if not isinstance(value, ModuleType):
            yield name, value
        elif is_foreign(value.__name__):
            yield from ((one, vars(value)[one]) for one in names if one in vars(value))


def _single(values: Iterable[tuple[str, Any]]) -> Iterator[tuple[str, Any]]:
    """The same with the elements of tuples instead of these, each by its name and place."""
    for name, value in values:
        if isinstance(value, tuple):
            yield f"{name}[{len(value)}]", len(value)
            yield from _single((f"{name}[{place}]", element) for place, element in enumerate(value))
        else:
            yield name, value


def _names(code: CodeType) -> Iterator[str]:
    """What code names, that of functions within it too."""
    yield from code.co_names
    for inner in code.co_consts:
        if isinstance(inner, CodeType):
            yield from _names(inner)
