"""`thread_time`: the CPU time of this thread, inside kernels too, where phases are too short to be timed from without."""

import sys
import time
from typing import Any

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic, overload

_CLOCK = getattr(time, "CLOCK_THREAD_CPUTIME_ID", 3)
_WORD = ir.IntType(64)


def thread_time() -> float:
    """CPU time that this thread has taken, seconds. To read it takes some tenths of a microsecond."""
    return time.thread_time()


@overload(thread_time, inline="never")
def _thread_time() -> Any:
    if sys.platform == "win32":  # no such clock there
        return lambda: 0.0
    return lambda: _read_clock()


@intrinsic  # type: ignore[misc]
def _read_clock(context: Any) -> Any:
    """C: clock_gettime into a timespec on the stack."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        spec = cgutils.alloca_once(builder, ir.ArrayType(_WORD, 2))
        kind = ir.FunctionType(ir.IntType(32), [ir.IntType(32), spec.type])
        builder.call(
            cgutils.get_or_insert_function(builder.module, kind, "clock_gettime"),
            [ir.Constant(ir.IntType(32), _CLOCK), spec],
        )
        seconds, nanoseconds = (
            builder.sitofp(builder.load(cgutils.gep_inbounds(builder, spec, 0, place)), ir.DoubleType())
            for place in (0, 1)
        )
        return builder.fadd(seconds, builder.fmul(nanoseconds, ir.Constant(ir.DoubleType(), 1e-9)))

    return types.float64(), generate
