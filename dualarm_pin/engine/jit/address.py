"""Call a function by its address, so that a new index or row compiles no engine.

Every such function has one C signature over pointers to doubles: f(a, b, c, out).
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
