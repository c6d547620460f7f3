"""A plain function with all plain functions below it, for numba."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from types import CellType, CodeType, FunctionType
from typing import Any

import numba
from numba.core.dispatcher import Dispatcher

Function = Callable[..., Any]
_njit: Any = numba.njit


def jitted(function: Function) -> Any:
    """Return a function that compiled code can call.

    The functions that it calls by a name of its module, or that it closes over, are compiled with
    it; those of libraries are left to numba.
    """
    return _jitted(function, {})


def plain(function: Any) -> Any:
    """Return the Python function behind a compiled one, or behind one by differences."""
    if isinstance(function, Dispatcher):
        return function.py_func
    return function.as_function() if hasattr(function, "as_function") else function


def is_own(value: Any) -> bool:
    """Tell whether a value is a function that is compiled with its caller."""
    value = plain(value)
    return isinstance(value, FunctionType) and not of_library(value.__module__)


def of_library(module: str | None) -> bool:
    """Tell whether a module is installed or comes with Python: numba knows it, or nobody does."""
    root = (module or "").partition(".")[0]
    if root == __name__.partition(".")[0]:
        return False
    file = str(getattr(sys.modules.get(root), "__file__", None) or "")
    return root in sys.stdlib_module_names - {"__main__"} or "site-packages" in file


def names_in(code: CodeType) -> Iterator[str]:
    """Yield the names that code, and the functions defined in it, look up outside."""
    yield from code.co_names
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from names_in(constant)


def _jitted(function: Any, known: dict[int, Any]) -> Any:
    if isinstance(function, Dispatcher):
        return function
    function = plain(function)
    if not isinstance(function, FunctionType) or id(function) in known:
        return known.get(id(function), _njit(error_model="numpy")(function))
    space = dict(function.__globals__)
    known[id(function)] = function  # where it calls itself
    for name in set(names_in(function.__code__)):
        if name in space and space[name] is not function and is_own(space[name]):
            space[name] = _jitted(space[name], known)
    cells = [cell.cell_contents for cell in function.__closure__ or ()]
    made = FunctionType(
        function.__code__,
        space,
        function.__name__,
        function.__defaults__,
        tuple(CellType(_jitted(each, known) if is_own(each) else each) for each in cells),
    )
    made.__kwdefaults__, made.__qualname__ = function.__kwdefaults__, function.__qualname__
    made.__module__ = __name__  # what is kept imports this; its own may be a file, or no module
    known[id(function)] = _njit(error_model="numpy")(made)
    return known[id(function)]
