"""What a function is, as bytes that are the same in every process and change with what it does."""

from __future__ import annotations

import hashlib
import pickle
import sys
from pathlib import Path
from types import CodeType, FunctionType, ModuleType
from typing import Any

import numba
from numba.core.dispatcher import Dispatcher

from dualarm_pin.engine.jit.jitted import is_own, names_in, of_library, plain


def identity_of(function: Any) -> bytes | None:
    """Return the identity of a function: its code, what it closes over, the globals that it reads.

    None where some of it has no form that lasts, such as an object that cannot be pickled.
    """
    digest, seen = hashlib.sha256(numba.__version__.encode()), set[int]()
    try:
        _add(function, digest, seen)
    except (pickle.PicklingError, TypeError, AttributeError, ValueError, OSError):
        return None
    return digest.digest()


def _add(value: Any, digest: Any, seen: set[int]) -> None:
    if isinstance(value, Dispatcher):
        digest.update(repr(sorted(value.targetoptions.items())).encode())
    if is_own(value):
        function: FunctionType = plain(value)
        if id(function) not in seen:
            seen.add(id(function))
            _add_function(function, digest, seen)
        digest.update(function.__qualname__.encode())
    elif isinstance(value, ModuleType):
        digest.update(_module(value))
    elif callable(value) and of_library(getattr(value, "__module__", None)):
        digest.update(f"{value.__module__}.{value.__qualname__}".encode())
        digest.update(_module(sys.modules[value.__module__.partition(".")[0]]))
    else:
        digest.update(pickle.dumps(value, protocol=4))


def _add_function(function: FunctionType, digest: Any, seen: set[int]) -> None:
    digest.update(_code(function.__code__))
    digest.update(pickle.dumps((function.__defaults__, function.__kwdefaults__), protocol=4))
    for cell in function.__closure__ or ():
        _add(cell.cell_contents, digest, seen)
    for name in sorted(set(names_in(function.__code__))):
        if name in function.__globals__:
            digest.update(name.encode())
            _add(function.__globals__[name], digest, seen)


def _code(code: CodeType) -> bytes:
    """Return what a code object does, without where it stands."""
    constants = [_code(c) if isinstance(c, CodeType) else repr(c) for c in code.co_consts]
    names = (code.co_names, code.co_varnames, code.co_freevars, code.co_cellvars)
    return repr((code.co_code, constants, names, code.co_argcount)).encode()


def _module(module: ModuleType) -> bytes:
    """Return name and version of a library, or the source of a module of the user's own."""
    version = getattr(module, "__version__", "")
    file = getattr(module, "__file__", None)
    if of_library(module.__name__) or file is None:
        return f"{module.__name__} {version}".encode()
    return Path(file).read_bytes()
