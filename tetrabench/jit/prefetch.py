"""`prefetch`: ask the processor for a row of an array that will be read soon, and do not wait for it.

For walks whose next steps are known some steps ahead, in arrays beyond the cache. With the JIT off it does nothing.
"""

from typing import Any

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic, overload

_FOR_READING, _KEEP, _DATA = 0, 3, 1


def prefetch(array: Any, row: int) -> None:
    """Fetch the cache line where row `row` (not negative) of a contiguous array begins."""


@intrinsic
def _prefetch(_context: Any, array: Any, row: Any) -> Any:
    def code(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        of_array, of_row = signature.args
        there = context.make_array(of_array)(context, builder, arguments[0])
        index = context.cast(builder, arguments[1], of_row, types.intp)
        stride = cgutils.unpack_tuple(builder, there.strides, of_array.ndim)[0]
        begin = builder.ptrtoint(there.data, stride.type)
        address = builder.inttoptr(builder.add(begin, builder.mul(index, stride)), ir.IntType(8).as_pointer())
        number = ir.IntType(32)
        kind = ir.FunctionType(ir.VoidType(), [address.type, number, number, number])
        function = cgutils.get_or_insert_function(builder.module, kind, "llvm.prefetch.p0i8")
        builder.call(function, [address, number(_FOR_READING), number(_KEEP), number(_DATA)])
        return context.get_dummy_value()

    return types.void(array, row), code


@overload(prefetch, jit_options={"forceinline": True})
def _prefetch_in_kernels(array: Any, row: Any) -> Any:
    def code(array: Any, row: Any) -> None:
        _prefetch(array, row)

    return code
