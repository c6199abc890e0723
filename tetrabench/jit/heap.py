"""The C heap inside kernels: `allocate`, `release`, `usable_size`, `load`, `store`.

For the one contestant whose point is that each tetra is an allocation of its own, reached by a real pointer. An address
is an int64. Nothing checks these functions: an address that is not one crashes the process. That is why they stand in
one file, and why only a layout may call them. (numba has no pointers of its own; `malloc` and `free` are declared in
the module that is being compiled and found by the linker, so kernels that use them are cached like any other.)

Each has a twin in ctypes, so that the kernels also run with the JIT off.
"""

import ctypes
from typing import Any

import numpy as np
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic, overload

_libc = ctypes.CDLL(None)
_libc.malloc.restype = ctypes.c_void_p
_libc.malloc.argtypes = [ctypes.c_size_t]
_libc.free.argtypes = [ctypes.c_void_p]
_libc.malloc_usable_size.restype = ctypes.c_size_t
_libc.malloc_usable_size.argtypes = [ctypes.c_void_p]

_CTYPES: dict[type, Any] = {np.int32: ctypes.c_int32, np.int64: ctypes.c_int64, np.float64: ctypes.c_double}
_WORD = ir.IntType(64)
_POINTER = ir.IntType(8).as_pointer()


def allocate(size: int) -> int:
    """Address of `size` fresh bytes, 0 where there is no memory left (C: malloc)."""
    return _libc.malloc(int(size)) or 0


def release(address: int) -> None:
    """Give an allocation back (C: free)."""
    _libc.free(int(address))


def usable_size(address: int) -> int:
    """Bytes that the allocator set aside for an allocation, without its own header (C: malloc_usable_size)."""
    return int(_libc.malloc_usable_size(int(address)))


def load(kind: type, address: int) -> Any:
    """The value of type `kind` (np.int32, np.int64 or np.float64) at an address."""
    return kind(_CTYPES[kind].from_address(int(address)).value)


def store(kind: type, address: int, value: Any) -> None:
    """Write `value`, as type `kind`, to an address."""
    _CTYPES[kind].from_address(int(address)).value = kind(value).item()


def _call(builder: Any, name: str, result: Any, parameters: list[Any], arguments: list[Any]) -> Any:
    function = cgutils.get_or_insert_function(builder.module, ir.FunctionType(result, parameters), name)
    return builder.call(function, arguments)


@intrinsic
def _allocate(_context: Any, size: Any) -> Any:
    def code(_context: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
        return builder.ptrtoint(_call(builder, "malloc", _POINTER, [_WORD], arguments), _WORD)

    return types.int64(types.int64), code


@intrinsic
def _release(_context: Any, address: Any) -> Any:
    def code(context: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
        _call(builder, "free", ir.VoidType(), [_POINTER], [builder.inttoptr(arguments[0], _POINTER)])
        return context.get_dummy_value()

    return types.void(types.int64), code


@intrinsic
def _usable_size(_context: Any, address: Any) -> Any:
    def code(_context: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
        pointer = builder.inttoptr(arguments[0], _POINTER)
        return _call(builder, "malloc_usable_size", _WORD, [_POINTER], [pointer])

    return types.int64(types.int64), code


@intrinsic
def _load(_context: Any, kind: Any, address: Any) -> Any:
    def code(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        value_type = context.get_value_type(signature.return_type)
        return builder.load(builder.inttoptr(arguments[1], value_type.as_pointer()))

    return kind.dtype(kind, types.int64), code


@intrinsic
def _store(_context: Any, kind: Any, address: Any, value: Any) -> Any:
    def code(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        value_type = context.get_value_type(signature.args[2])
        builder.store(arguments[2], builder.inttoptr(arguments[1], value_type.as_pointer()))
        return context.get_dummy_value()

    return types.void(kind, types.int64, kind.dtype), code


_INLINE = {"forceinline": True}


@overload(allocate, jit_options=_INLINE)
def _(size):  # type: ignore[no-untyped-def]
    return lambda size: _allocate(size)


@overload(release, jit_options=_INLINE)
def _(address):  # type: ignore[no-untyped-def]
    return lambda address: _release(address)


@overload(usable_size, jit_options=_INLINE)
def _(address):  # type: ignore[no-untyped-def]
    return lambda address: _usable_size(address)


@overload(load, jit_options=_INLINE)
def _(kind, address):  # type: ignore[no-untyped-def]
    return lambda kind, address: _load(kind, address)


@overload(store, jit_options=_INLINE)
def _(kind, address, value):  # type: ignore[no-untyped-def]
    return lambda kind, address, value: _store(kind, address, value)
