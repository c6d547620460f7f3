"""Call a function by its address, so that a new index or row compiles no engine.

A function of small arrays has one C signature over pointers to doubles: f(a, b, c, out). What an
index contributes at a point is a function of the engine's own records.
"""

from __future__ import annotations

from typing import Any

from llvmlite import ir  # type: ignore[import-untyped]
from numba import types
from numba.extending import intrinsic


def _call_address(typingctx, address, a, b, c, out):  # type: ignore[no-untyped-def]
    """Call address(a, b, c, out); all are integers, the last four addresses of data."""

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        pointer = ir.IntType(8).as_pointer()
        function = ir.FunctionType(ir.VoidType(), [pointer] * 4)
        target = builder.inttoptr(values[0], function.as_pointer())
        builder.call(target, [builder.inttoptr(value, pointer) for value in values[1:]])
        return context.get_dummy_value()

    return types.none(types.int64, *[types.uintp] * 4), generate


call_address: Any = intrinsic(_call_address)


def _call_point(typingctx, address, problem, i, scratch, wanted):  # type: ignore[no-untyped-def]
    """Return address(problem, i, scratch, wanted), a function compiled for `point_signature`."""

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        given = [context.get_value_type(kind) for kind in signature.args[1:]]
        function = ir.FunctionType(ir.DoubleType(), given)
        return builder.call(builder.inttoptr(values[0], function.as_pointer()), values[1:])

    return point_signature(problem, scratch, types.int64), generate


def point_signature(problem: Any, scratch: Any, *before: Any) -> Any:
    """Return the signature (problem, i, scratch, wanted) -> value of what a point calls."""
    return types.float64(*before, problem, types.int64, scratch, types.boolean)


call_point: Any = intrinsic(_call_point)
