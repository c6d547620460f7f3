"""Which code of the engine evaluates an index: the fast path, or functions called by address.

The package's own indices share three functions that are kept on disk like the engine itself. A
user's functions are compiled when they are first used; what numba cannot compile is called in
Python. The engine is the same for all of them.
"""

from __future__ import annotations

import ctypes
import warnings
from collections.abc import Callable
from functools import cache
from typing import TYPE_CHECKING, Any

import numba
import numpy as np
from numba import carray  # type: ignore[attr-defined]
from numba.core.dispatcher import Dispatcher
from numba.core.errors import NumbaError, NumbaPerformanceWarning
from numpy.typing import NDArray

from dualarm_pin.engine.layout import (
    CONDITION,
    CUSTOM,
    FORCE,
    SMALLEST,
    VELOCITY,
    YOSHIKAWA,
)
from dualarm_pin.engine.package_calls import WITH_2, WITH_3, package_calls
from dualarm_pin.indices import spectral, transmission
from dualarm_pin.indices.custom import (
    DifferenceCurvature,
    DifferenceGradient,
    difference_curvature,
    difference_gradient,
)

if TYPE_CHECKING:
    from dualarm_pin.indices import Index

Function = Callable[..., Any]

_KINDS: dict[Function, int] = {
    transmission.force_phi: FORCE,
    transmission.velocity_phi: VELOCITY,
    spectral.yoshikawa_phi: YOSHIKAWA,
    spectral.condition_phi: CONDITION,
    spectral.smallest_phi: SMALLEST,
}
_kept: list[Any] = []  # whatever has an address in use must stay alive


def index_calls(index: Index) -> tuple[int, NDArray[np.int64]]:
    """Return the kind of an index and the addresses of phi, gradient and curvature (3,)."""
    kind = _KINDS.get(index.phi, CUSTOM)
    if kind == FORCE:
        return kind, np.zeros(3, dtype=np.int64)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", NumbaPerformanceWarning)
        if kind == CUSTOM:
            addresses = _custom_calls(index.name, index.phi, index.gradient, index.curvature)
        else:
            addresses = package_calls()
    return kind, np.array(addresses, dtype=np.int64)


@cache
def _custom_calls(
    name: str, phi: Function, gradient: Function, curvature: Function
) -> tuple[int, int, int]:
    """Return addresses for a user's functions, compiled if numba can, else called in Python."""
    try:
        return _compiled_calls(phi, gradient, curvature)
    except NumbaError as error:
        reason = str(error).strip().splitlines()[-1]
        warnings.warn(
            f"index {name!r} cannot be compiled and runs as Python, some hundred times slower: "
            f"{reason}",
            stacklevel=5,
        )
        return _python_calls(phi, gradient, curvature)


def _compiled_calls(phi: Function, gradient: Function, curvature: Function) -> tuple[int, int, int]:
    value: Any = _jit(phi)
    slope: Any = _jit(gradient)
    bend: Any = _jit(curvature)

    @numba.cfunc(WITH_2)
    def call_value(kind, A, u, out):  # type: ignore[no-untyped-def]
        out[0] = np.nan  # what stays if the function raises
        out[0] = value(carray(A, (6, 6)), carray(u, (6,)))

    @numba.cfunc(WITH_2)
    def call_slope(kind, A, u, out):  # type: ignore[no-untyped-def]
        result = carray(out, (6, 6))
        result[:] = np.nan
        result[:] = slope(carray(A, (6, 6)), carray(u, (6,)))

    @numba.cfunc(WITH_3)
    def call_bend(kind, A, u, D, out):  # type: ignore[no-untyped-def]
        result = carray(out, (6, 6))
        result[:] = np.nan
        result[:] = bend(carray(A, (6, 6)), carray(u, (6,)), carray(D, (6, 6)))

    calls: Any = (call_value, call_slope, call_bend)
    _kept.append(calls)
    return calls[0].address, calls[1].address, calls[2].address


def _jit(function: Function) -> Function:
    """Return a function that compiled code can call, differences made of compiled parts."""
    if isinstance(function, DifferenceGradient):
        phi, step = _jit(function.phi), function.step
        formula: Any = numba.njit(difference_gradient)

        def gradient(A, u):  # type: ignore[no-untyped-def]
            return formula(phi, step, A, u)

        function = gradient
    elif isinstance(function, DifferenceCurvature):
        slope, step = _jit(function.gradient), function.step
        formula = numba.njit(difference_curvature)

        def curvature(A, u, D):  # type: ignore[no-untyped-def]
            return formula(slope, step, A, u, D)

        function = curvature
    if isinstance(function, Dispatcher):
        return function
    jitted: Function = numba.njit(error_model="numpy")(function)
    return jitted


_C_ARRAY = ctypes.POINTER(ctypes.c_double)


def _python_calls(phi: Function, gradient: Function, curvature: Function) -> tuple[int, int, int]:
    """Return addresses of C functions that call Python; it takes the interpreter's lock itself."""

    def call_value(kind: int, A: Any, u: Any, out: Any) -> None:
        out[0] = np.nan
        out[0] = float(phi(_matrix(A).copy(), _vector(u).copy()))

    def call_slope(kind: int, A: Any, u: Any, out: Any) -> None:
        result = _matrix(out)
        result[:] = np.nan
        result[:] = gradient(_matrix(A).copy(), _vector(u).copy())

    def call_bend(kind: int, A: Any, u: Any, D: Any, out: Any) -> None:
        result = _matrix(out)
        result[:] = np.nan
        result[:] = curvature(_matrix(A).copy(), _vector(u).copy(), _matrix(D).copy())

    with_2 = ctypes.CFUNCTYPE(None, ctypes.c_int64, *[_C_ARRAY] * 3)
    with_3 = ctypes.CFUNCTYPE(None, ctypes.c_int64, *[_C_ARRAY] * 4)
    calls = (with_2(call_value), with_2(call_slope), with_3(call_bend))
    _kept.append(calls)
    addresses = [ctypes.cast(call, ctypes.c_void_p).value or 0 for call in calls]
    return addresses[0], addresses[1], addresses[2]


def _matrix(pointer: Any) -> NDArray[np.float64]:
    return np.ctypeslib.as_array(pointer, (6, 6))


def _vector(pointer: Any) -> NDArray[np.float64]:
    return np.ctypeslib.as_array(pointer, (6,))
