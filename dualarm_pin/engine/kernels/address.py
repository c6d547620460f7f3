"""What an index contributes at a point, by its address: compiled when a task first asks for it.

It is a function by itself, kept on disk, so that no index makes the engine slower to compile.
"""

from __future__ import annotations

import inspect
from functools import cache
from pathlib import Path
from typing import Any

import numba

from dualarm_pin.engine.jit import records  # noqa: F401  registers what compiled code reads
from dualarm_pin.engine.jit.address import point_signature
from dualarm_pin.engine.jit.compiled import c_function, source_stamp
from dualarm_pin.engine.jit.kept_module import kept_module
from dualarm_pin.engine.kernels import KERNELS
from dualarm_pin.engine.workspace import Scratch
from dualarm_pin.errors import InputError
from dualarm_pin.indices import spectral
from dualarm_pin.problem import Problem

_CALLED = """from dualarm_pin.engine.kernels.called import called
def entry(problem, i, scratch, wanted):
    return called(problem, i, scratch, wanted)
"""
_MODELLED = """from dualarm_pin.engine.chain.directions import task_matrix
from dualarm_pin.engine.kernels.layout import VALUE
from dualarm_pin.engine.kernels.modelled import add_modelled
from {module} import {name} as kernel
def entry(problem, i, scratch, wanted):
    task_matrix(problem, scratch)
    kernel(scratch.A, problem.points.u[i], wanted, scratch.model)
    if wanted:
        add_modelled(problem, i, scratch)
    return scratch.model[VALUE, 0]
"""
_typeof: Any = numba.typeof
_kept: list[Any] = []  # whatever has an address in use must stay alive


def index_address(problem: Problem, scratch: Scratch) -> int:
    """Return the address of what the problem's index contributes at a point.

    Raises:
        InputError: The index names a kernel that there is not.
    """
    return _address(problem.index.kernel, point_signature(_typeof(problem), _typeof(scratch)))


@cache
def _address(name: str, signature: Any) -> int:
    if name and name not in KERNELS:
        allowed = ", ".join(["force", *KERNELS])
        raise InputError(f"is {name!r}, allowed are {allowed}", field="index.kernel")
    text = _CALLED
    if name:
        function = KERNELS[name].py_func  # type: ignore[attr-defined]
        text = _MODELLED.format(module=function.__module__, name=function.__name__)
    numbers = Path(inspect.getfile(spectral)).read_bytes()  # those of the smooth extremes
    module = kept_module(text, [str(source_stamp()).encode(), numbers])
    compiled = c_function(module.entry, signature)
    _kept.append(compiled)
    return int(compiled.address)
