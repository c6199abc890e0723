"""`generic`: one interface function, one implementation for each storage type, in numba and in plain Python.

A function of the interface is declared once, with its contract in the docstring:

    @generic(on="layout")
    def volume(net, t):
        "Volume of tetra t."

and implemented for the type of `net.layout` (a NamedTuple class):

    @implements(interface.volume, PropertyArrays)
    def volume(net, t):
        return net.layout.volume[t]

Where nothing but the storage is asked, it is the argument itself: `@generic()`.

The one registration serves numba, through `numba.extending.overload`, and plain Python, so that every kernel also
runs with the JIT off, in a debugger and under coverage (a bare overload stub would return None there).

Implementations are inlined into the kernel that calls them, always: a storage is some hundred words, and numba would
pass it by value, on the stack, to every function that is not inlined. That is why they have to be small.
"""

import inspect
from collections.abc import Callable, Container
from types import FunctionType, ModuleType
from typing import Any

from numba.core.errors import TypingError
from numba.extending import overload

Function = Callable[..., Any]

_IMPLEMENTATIONS: dict[Function, dict[type, Function]] = {}
_FIELDS: dict[Function, str | None] = {}  # what each was declared with as `on`


def generic(*, on: str | None = None) -> Callable[[Function], Function]:
    """Declare a function that is dispatched on the class of its first argument, or of that one's field `on`."""

    def declare(contract: Function) -> Function:
        table: dict[type, Function] = {}

        def dispatch(*arguments: Any) -> Any:
            storage = _decisive(arguments[0], on)
            if storage not in table:
                raise TypeError(_missing(contract, storage))
            return table[storage](*arguments)

        def choose(net: Any, *_: Any) -> Function:
            storage = (net if on is None else net.types[net.fields.index(on)]).instance_class
            if storage not in table:
                raise TypingError(_missing(contract, storage))
            return table[storage]

        dispatch.__name__ = dispatch.__qualname__ = contract.__name__
        dispatch.__doc__ = contract.__doc__
        dispatch.__module__ = contract.__module__
        dispatch.__signature__ = inspect.signature(contract)  # type: ignore[attr-defined]
        choose.__signature__ = _bare(contract)  # type: ignore[attr-defined]
        overload(dispatch, jit_options={"forceinline": True, "error_model": "numpy"})(choose)
        _IMPLEMENTATIONS[dispatch], _FIELDS[dispatch] = table, on
        return dispatch

    return declare


def implements(function: Function, storage: type) -> Callable[[Function], Function]:
    """Register an implementation of the generic `function` for nets that hold a `storage`.

    Raises:
        TypeError: the parameters differ from the declared ones, or `storage` has an implementation already.
    """
    table = _IMPLEMENTATIONS[function]

    def register(implementation: Function) -> Function:
        declared, given = inspect.signature(function), inspect.signature(implementation)
        if list(declared.parameters) != list(given.parameters):
            raise TypeError(f"{storage.__name__}: {function.__name__} takes {declared}, not {given}")
        if storage in table:
            raise TypeError(f"{storage.__name__} implements {function.__name__} already")
        implementation.__signature__ = _bare(implementation)  # type: ignore[attr-defined]
        table[storage] = implementation
        return implementation

    return register


def generics_of(interface: ModuleType) -> list[Function]:
    """The generic functions that a module declares, in its order."""
    return [one for one in vars(interface).values() if isinstance(one, FunctionType) and one in _IMPLEMENTATIONS]


def is_implemented(function: Function, net: Any) -> bool:
    """Whether the generic `function` can be called with this net, or storage, as its first argument."""
    return _decisive(net, _FIELDS[function]) in _IMPLEMENTATIONS[function]


def lacks(interface: ModuleType, net: Any, may_lack: Container[str] = ()) -> list[str]:
    """The generic functions of a module that cannot be called with a net, with their parameters; but for those named."""
    needed = [one for one in generics_of(interface) if one.__name__ not in may_lack]
    return [_spell_lack(one, net) for one in needed if not is_implemented(one, net)]


def _spell_lack(function: Function, net: Any) -> str:
    field = _FIELDS[function]
    place = f" of its {field}, {_decisive(net, field).__name__}" if field else ""
    return f"{function.__name__}({', '.join(inspect.signature(function).parameters)}){place}"


def implementations_of(storage: type) -> list[Function]:
    """All functions that are implemented for `storage`, of any interface."""
    return [table[storage] for table in _IMPLEMENTATIONS.values() if storage in table]


def _decisive(net: Any, field: str | None) -> type:
    """The type that says which implementation is meant."""
    return type(net if field is None else getattr(net, field))


def _bare(function: Function) -> inspect.Signature:
    """The signature without annotations, which numba would compare, too."""
    parameters = inspect.signature(function).parameters
    return inspect.Signature([inspect.Parameter(name, inspect.Parameter.POSITIONAL_OR_KEYWORD) for name in parameters])


def _missing(contract: Function, storage: type) -> str:
    return f"{storage.__name__} does not implement {contract.__name__}{inspect.signature(contract)}"
