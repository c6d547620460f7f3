"""Call an index's compiled functions by address, so that a new index compiles no engine.

The functions have C signatures over pointers to doubles: phi(A, u, out), gradient(A, u, out) and
curvature(A, u, D, out), with A, D and matrix results (6, 6) by rows.
"""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba import types
from numba.extending import intrinsic


def _caller(arguments: int) -> Any:
    """Return code that calls an address with so many data pointers (as integers)."""

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        pointer = ir.IntType(8).as_pointer()
        function = ir.FunctionType(ir.VoidType(), [pointer] * arguments)
        address = builder.inttoptr(values[0], function.as_pointer())
        builder.call(address, [builder.inttoptr(v, pointer) for v in values[1:]])
        return context.get_dummy_value()

    return generate


@intrinsic
def call_with_3(typingctx, address, a, b, c):  # type: ignore[no-untyped-def]
    """Call address(a, b, c); all are addresses as integers."""
    return types.none(types.int64, types.intp, types.intp, types.intp), _caller(3)


@intrinsic
def call_with_4(typingctx, address, a, b, c, d):  # type: ignore[no-untyped-def]
    """Call address(a, b, c, d); all are addresses as integers."""
    return types.none(types.int64, types.intp, types.intp, types.intp, types.intp), _caller(4)
