"""The package's own indices as three compiled functions with addresses, kept on disk."""

from __future__ import annotations

from functools import cache
from typing import Any

import numba
import numpy as np
from numba import carray, types  # type: ignore[attr-defined]

from dualarm_pin.engine.compiled import source_stamp
from dualarm_pin.engine.layout import CONDITION, SMALLEST, VELOCITY, YOSHIKAWA
from dualarm_pin.indices import spectral, transmission

_POINTER: Any = types.CPointer(types.float64)  # type: ignore[no-untyped-call]
WITH_2 = types.void(types.int64, *[_POINTER] * 3)
WITH_3 = types.void(types.int64, *[_POINTER] * 4)

_jit = numba.njit(error_model="numpy")
_velocity = _jit(transmission.velocity_phi)
_velocity_gradient = _jit(transmission.velocity_gradient)
_velocity_curvature = _jit(transmission.velocity_curvature)
_yoshikawa = _jit(spectral.yoshikawa_phi)
_yoshikawa_gradient = _jit(spectral.yoshikawa_gradient)
_yoshikawa_curvature = _jit(spectral.yoshikawa_curvature)
_condition = _jit(spectral.condition_phi)
_condition_gradient = _jit(spectral.condition_gradient)
_condition_curvature = _jit(spectral.condition_curvature)
_smallest = _jit(spectral.smallest_phi)
_smallest_gradient = _jit(spectral.smallest_gradient)
_smallest_curvature = _jit(spectral.smallest_curvature)


@cache
def package_calls() -> tuple[int, int, int]:
    """Compile or load phi, gradient and curvature and return their addresses."""
    value, gradient, curvature = _functions(source_stamp())
    return value.address, gradient.address, curvature.address


@cache
def _functions(stamp: int) -> tuple[Any, Any, Any]:
    """Return the functions; the stamp is part of their key in the cache."""

    @numba.cfunc(WITH_2, cache=True)
    def value(kind, A, u, out):  # type: ignore[no-untyped-def]
        _ = stamp
        a, d = carray(A, (6, 6)), carray(u, (6,))
        if kind == VELOCITY:
            out[0] = _velocity(a, d)
        elif kind == YOSHIKAWA:
            out[0] = _yoshikawa(a, d)
        elif kind == CONDITION:
            out[0] = _condition(a, d)
        elif kind == SMALLEST:
            out[0] = _smallest(a, d)
        else:
            out[0] = np.nan

    @numba.cfunc(WITH_2, cache=True)
    def gradient(kind, A, u, out):  # type: ignore[no-untyped-def]
        _ = stamp
        a, d, result = carray(A, (6, 6)), carray(u, (6,)), carray(out, (6, 6))
        if kind == VELOCITY:
            result[:] = _velocity_gradient(a, d)
        elif kind == YOSHIKAWA:
            result[:] = _yoshikawa_gradient(a, d)
        elif kind == CONDITION:
            result[:] = _condition_gradient(a, d)
        elif kind == SMALLEST:
            result[:] = _smallest_gradient(a, d)

    @numba.cfunc(WITH_3, cache=True)
    def curvature(kind, A, u, D, out):  # type: ignore[no-untyped-def]
        _ = stamp
        a, d, b, result = (
            carray(A, (6, 6)),
            carray(u, (6,)),
            carray(D, (6, 6)),
            carray(out, (6, 6)),
        )
        if kind == VELOCITY:
            result[:] = _velocity_curvature(a, d, b)
        elif kind == YOSHIKAWA:
            result[:] = _yoshikawa_curvature(a, d, b)
        elif kind == CONDITION:
            result[:] = _condition_curvature(a, d, b)
        elif kind == SMALLEST:
            result[:] = _smallest_curvature(a, d, b)

    return value, gradient, curvature
