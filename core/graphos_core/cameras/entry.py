"""How compiled code calls the kernel of a model by its address.

Twenty models inlined into a dozen loops would multiply the time of compilation; called through an address, a loop
compiles once whatever models there are, and a model is compiled when it is first used. The call passes bare pointers,
which costs a few nanoseconds; passing numba's arrays would cost ten times the projection.
"""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba import types
from numba.core.errors import TypingError
from numba.extending import intrinsic

_POINTER = types.CPointer(types.float64)

SIGNATURE = types.int64(
    _POINTER, types.float64, types.float64, types.float64, _POINTER, _POINTER, _POINTER, types.int64
)
"""C signature of an entry: values, x, y, z, pixel (2), d_point (2×3), d_values (2×row), row; returns 0 for no image.

The arguments are those of a kernel (`graphos_core.cameras.model`) as bare pointers, matrices row by row; ``row`` is the
distance from one row of d_values to the next, at least the number of parameters.
"""


@intrinsic
def call_entry(
    typing_context: Any,
    address: Any,
    values: Any,
    x: Any,
    y: Any,
    z: Any,
    pixel: Any,
    d_point: Any,
    d_values: Any,
) -> Any:
    """Call the entry at `address` (int64); the arrays must be float64 and contiguous in memory."""
    for array in (values, pixel, d_point, d_values):
        if getattr(array, "layout", "") != "C" or array.dtype != types.float64:
            raise TypingError("a camera kernel needs contiguous float64 arrays")
    number = types.float64
    signature = types.int64(types.int64, values, number, number, number, pixel, d_point, d_values)
    return signature, _call


def _call(context: Any, builder: Any, signature: Any, args: Any) -> Any:
    arrays = {k: context.make_array(signature.args[k])(context, builder, args[k]) for k in (1, 5, 6, 7)}
    row = builder.extract_value(arrays[7].shape, 1)
    number = ir.DoubleType()
    pointer = number.as_pointer()
    kind = ir.FunctionType(
        ir.IntType(64), [pointer, number, number, number, pointer, pointer, pointer, ir.IntType(64)]
    )
    function = builder.inttoptr(args[0], kind.as_pointer())
    return builder.call(
        function,
        [arrays[1].data, args[2], args[3], args[4], arrays[5].data, arrays[6].data, arrays[7].data, row],
    )
