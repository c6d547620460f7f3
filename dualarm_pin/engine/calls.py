"""Call an index's compiled functions by address, so that a new index compiles no engine.

The functions have C signatures over pointers to doubles: phi(kind, A, u, out),
gradient(kind, A, u, out) and curvature(kind, A, u, D, out), with A, D and matrix results (6, 6) by
rows. `kind` tells the package's own indices apart.
"""

from __future__ import annotations

from typing import Any

from llvmlite import ir  # type: ignore[import-untyped]
from numba import types
from numba.extending import intrinsic


def _caller(arguments: int) -> Any:
    """Return code that calls an address with a number and so many data pointers (as integers)."""

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        pointer = ir.IntType(8).as_pointer()
        number = ir.IntType(64)
        function = ir.FunctionType(ir.VoidType(), [number] + [pointer] * arguments)
        address = builder.inttoptr(values[0], function.as_pointer())
        pointers = [builder.inttoptr(value, pointer) for value in values[2:]]
        builder.call(address, [values[1], *pointers])
        return context.get_dummy_value()

    return generate


def _call_with_3(typingctx, address, kind, a, b, c):  # type: ignore[no-untyped-def]
    """Call address(kind, a, b, c); all are integers, the last three addresses of data."""
    return types.none(types.int64, types.int64, *[types.uintp] * 3), _caller(3)


def _call_with_4(typingctx, address, kind, a, b, c, d):  # type: ignore[no-untyped-def]
    """Call address(kind, a, b, c, d); all are integers, the last four addresses of data."""
    return types.none(types.int64, types.int64, *[types.uintp] * 4), _caller(4)


call_with_3: Any = intrinsic(_call_with_3)
call_with_4: Any = intrinsic(_call_with_4)
