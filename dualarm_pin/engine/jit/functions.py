"""Python functions of small arrays as compiled functions with an address.

An index or a row is written as plain functions. Each is compiled by a small module written for it,
so that numba keeps the machine code on disk from one process to the next, wherever the function
comes from: a module, a notebook, another function. What numba cannot compile at all is called in
Python, some hundred times slower, with a warning.
"""

from __future__ import annotations

import ctypes
import warnings
from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numba.core.errors import NumbaError, NumbaWarning

from dualarm_pin.engine.jit.identity import identity_of
from dualarm_pin.engine.jit.jitted import jitted
from dualarm_pin.engine.jit.kept_module import kept_module

Function = Callable[..., Any]
Shape = tuple[int, ...]


class Signature(NamedTuple):
    """Shapes of up to three arguments and of the result, () for a number.

    Attributes:
        arguments: Shapes of a, b and c, as many as the function takes.
        result: Shape of what it returns.
    """

    arguments: tuple[Shape, ...]
    result: Shape


MATRIX, VECTOR = (6, 6), (6,)
INDEX = (
    Signature((MATRIX, VECTOR), ()),
    Signature((MATRIX, VECTOR), MATRIX),
    Signature((MATRIX, VECTOR, MATRIX), MATRIX),
)
_kept: list[Any] = []  # whatever has an address in use must stay alive


def row_signatures(parameters: int) -> tuple[Signature, ...]:
    """Return the signatures of a row's phi, slope and bend."""
    given = ((3, 3), (3,), (max(parameters, 1),))
    return tuple(Signature(given, result) for result in ((), VECTOR, MATRIX))


def addresses(
    name: str, functions: tuple[Function, ...], signatures: tuple[Signature, ...]
) -> tuple[int, ...]:
    """Return the address of each function; compiled once, and loaded from disk afterwards."""
    return tuple(
        _address(name, function, signature)
        for function, signature in zip(functions, signatures, strict=True)
    )


@cache
def _address(name: str, function: Function, signature: Signature) -> int:
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", NumbaWarning)
            found = _compiled(function, signature)
    except NumbaError as error:
        reason = str(error).strip().splitlines()[-1]
        warnings.warn(
            f"{name!r} cannot be compiled and runs as Python, some hundred times slower: {reason}",
            stacklevel=5,
        )
        found = _in_python(function, signature)
    _kept.append(found)
    if hasattr(found, "address"):
        return int(found.address)
    return ctypes.cast(found, ctypes.c_void_p).value or 0


_ENTRY = """from numba import carray, cfunc, types
POINTER = types.CPointer(types.float64)
@cfunc(types.void(*[POINTER] * 4), cache={kept})
def entry(a, b, c, out):
    {first}
    {then} = function({given})
"""


def _compiled(function: Function, signature: Signature) -> Any:
    identity = identity_of(function)
    pointers = zip("abc", signature.arguments, strict=False)
    first, then = "out[0] = float('nan')", "out[0]"
    if signature.result:
        first = f"result = carray(out, {signature.result}); result[:] = float('nan')"
        then = "result[:]"
    text = _ENTRY.format(
        kept=identity is not None,
        first=first,
        then=then,
        given=", ".join(f"carray({pointer}, {shape})" for pointer, shape in pointers),
    )
    if identity is not None:
        return kept_module(text, [identity], function=jitted(function)).entry
    space: dict[str, Any] = {"function": jitted(function)}
    exec(compile(text, "<function of the user>", "exec"), space)
    return space["entry"]


_POINTER = ctypes.POINTER(ctypes.c_double)


def _in_python(function: Function, signature: Signature) -> Any:
    """Return a C function that calls Python; it takes the interpreter's lock itself."""
    number = not signature.result

    def call(*pointers: Any) -> None:
        result = np.ctypeslib.as_array(pointers[3], (1,) if number else signature.result)
        result[:] = np.nan
        given = zip(pointers, signature.arguments, strict=False)
        result[...] = function(*(np.ctypeslib.as_array(p, shape).copy() for p, shape in given))

    return ctypes.CFUNCTYPE(None, *[_POINTER] * 4)(call)
