"""Python functions of small arrays as compiled functions with an address.

An index or a row is written as plain functions. Each is compiled by a small module written for it,
which imports the function by name, so that numba keeps the machine code on disk from one process to
the next. A function that cannot be imported (from a notebook, a closure) is compiled anew; what
numba cannot compile at all is called in Python, some hundred times slower, with a warning.
"""

from __future__ import annotations

import ctypes
import inspect
import sys
import warnings
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numba.core.dispatcher import Dispatcher
from numba.core.errors import NumbaError, NumbaWarning

from dualarm_pin.engine.jit.kept_module import kept_module
from dualarm_pin.indices.custom import DifferenceCurvature, DifferenceGradient
from dualarm_pin.rows.row import DifferenceBend, DifferenceSlope

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
_DIFFERENCES: dict[type, tuple[str, str, str, str]] = {
    # class -> module of the formula, its name, the attribute that it differences, its arguments
    DifferenceGradient: ("dualarm_pin.indices.custom", "difference_gradient", "phi", "a, b"),
    DifferenceCurvature: (
        "dualarm_pin.indices.custom",
        "difference_curvature",
        "gradient",
        "a, b, c",
    ),
    DifferenceSlope: ("dualarm_pin.rows.row", "difference_slope", "phi", "a, b, c"),
    DifferenceBend: ("dualarm_pin.rows.row", "difference_bend", "phi", "a, b, c"),
}
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


class _Text:
    """The module that compiles one function: its lines, and what they cannot import."""

    def __init__(self) -> None:
        self.lines = ["from numba import carray, cfunc, njit, types"]
        self.defined = 0
        self.given: dict[str, Function] = {}
        self.sources: list[Path] = []

    def define(self, function: Function) -> str:
        """Add lines that define a compiled function; return its name."""
        self.defined += 1
        name = f"f{self.defined}"
        if type(function) in _DIFFERENCES:
            module, formula, attribute, given = _DIFFERENCES[type(function)]
            inner = self.define(getattr(function, attribute))
            if hasattr(function, "step"):
                how = repr(function.step)
            else:
                how = "turned"
                self.lines += [f"from {module} import turned", "turned = njit(turned)"]
            self.lines += [
                f"from {module} import {formula} as formula_{name}",
                f"formula_{name} = njit(formula_{name})",
                "@njit(error_model='numpy')",
                f"def {name}({given}):",
                f"    return formula_{name}({inner}, {how}, {given})",
            ]
            return name
        plain = function.py_func if isinstance(function, Dispatcher) else function
        source = _importable(plain)
        if source is None:
            self.given[name] = plain
        else:
            self.sources.append(source)
            self.lines.append(f"from {plain.__module__} import {plain.__name__} as {name}")
        if not isinstance(function, Dispatcher) or source is None:
            self.lines.append(f"{name} = njit(error_model='numpy')({name})")
        return name

    def entry(self, name: str, signature: Signature) -> str:
        """Add the C function and return the whole text."""
        given = [
            f"carray({pointer}, {shape})"
            for pointer, shape in zip("abc", signature.arguments, strict=False)
        ]
        result = f"{name}({', '.join(given)})"
        whole = [f"result = carray(out, {signature.result})", "result[:] = float('nan')"]
        body = [*whole, f"result[:] = {result}"]
        if not signature.result:
            body = ["out[0] = float('nan')", f"out[0] = {result}"]
        self.lines += [
            "POINTER = types.CPointer(types.float64)",
            f"@cfunc(types.void(*[POINTER] * 4), cache={not self.given})",
            "def entry(a, b, c, out):",
            *(f"    {line}" for line in body),
        ]
        return "\n".join(self.lines) + "\n"


def _importable(function: Function) -> Path | None:
    """Return the file of a function that another process finds by its name, or None."""
    module = sys.modules.get(getattr(function, "__module__", None) or "")
    if module is None or module.__name__ == "__main__":
        return None
    if getattr(module, getattr(function, "__qualname__", ""), None) is not function:
        found = getattr(module, getattr(function, "__qualname__", ""), None)
        if not isinstance(found, Dispatcher) or found.py_func is not function:
            return None
    try:
        return Path(inspect.getfile(function))
    except TypeError:
        return None


def _compiled(function: Function, signature: Signature) -> Any:
    text = _Text()
    source = text.entry(text.define(function), signature)
    if text.given:
        space: dict[str, Any] = dict(text.given)
        exec(compile(source, "<function of the user>", "exec"), space)
        return space["entry"]
    return kept_module(source, [file.read_bytes() for file in text.sources]).entry


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
