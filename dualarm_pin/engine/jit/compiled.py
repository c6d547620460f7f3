"""How the engine is compiled: one decorator for its functions, one for its few entry points.

Only entry points are cached on disk. Their cache key holds a stamp of every source file of the
engine, because numba itself looks only at the file of the function it caches. Where the package
folder is read-only numba writes to the user's cache folder by itself.
"""

from __future__ import annotations

import gc
import hashlib
import inspect
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, TypeVar, cast

import numba
import numba.extending
from numba.core import codegen
from numba.core.compiler_lock import global_compiler_lock

F = TypeVar("F", bound=Callable[..., Any])
_OURS: set[str] = set()
"""Names of the functions that only other compiled functions of ours call."""
_OBJECTS = 100_000  # between two looks for garbage, not 700: a compilation makes millions
_RECORDS = (
    "chain.py",
    *(f"problem/{name}.py" for name in ("bounds", "links", "points", "terms")),
    "rows/capsules.py",
    "rows/table.py",
)

_njit: Any = numba.njit
_cfunc: Any = numba.cfunc

# Everything of fast math that keeps the meaning of nan and inf: the line search relies on both.
_FAST = {"reassoc", "contract", "nsz", "arcp"}


def compiled(function: F) -> F:
    """Compile a function that only other compiled functions call.

    It may not allocate: arrays are not counted in it, which would cost more than the work does.
    """
    jitted: F = _njit(
        fastmath=_FAST,
        error_model="numpy",
        nogil=True,
        no_cpython_wrapper=True,
        no_cfunc_wrapper=True,
        _nrt=False,
    )(function)
    _OURS.add(function.__qualname__)
    return jitted


def inlined(function: F) -> F:
    """Compile a function with one caller as part of it: every level of calls costs compile time."""
    jitted: F = _njit(fastmath=_FAST, error_model="numpy", nogil=True, inline="always", _nrt=False)(
        function
    )
    return jitted


def by_type(plain: F, other: Callable[..., Any], field: str) -> F:
    """Return a function for compiled code only: `other` where the first argument has a field.

    The choice is made at compile time; both functions name their arguments alike. What is not
    chosen is not compiled.
    """

    def choice(*given: Any) -> Any:
        raise NotImplementedError("only compiled code calls this")

    def choose(first: Any, *_: Any) -> Any:
        chosen: Any = other if field in getattr(first, "fields", ()) else plain
        return chosen.py_func

    choose.__signature__ = inspect.signature(cast(Any, plain).py_func)  # type: ignore[attr-defined]
    options: Any = {"fastmath": _FAST, "error_model": "numpy", "nogil": True, "_nrt": False}
    numba.extending.overload(choice, jit_options=options, strict=False)(choose)
    return cast(F, choice)


def entry(function: F) -> F:
    """Compile a function that Python calls; kept on disk from one process to the next."""
    jitted: Any = _njit(fastmath=_FAST, error_model="numpy", nogil=True, cache=True)(function)
    whole = jitted.compile

    def compile_as_a_whole(signature: Any) -> Any:
        with global_compiler_lock, _only_the_entry(function.__qualname__):
            return whole(signature)

    jitted.compile = compile_as_a_whole
    return cast(F, jitted)


def c_function(function: Callable[..., Any], signature: Any) -> Any:
    """Compile a function that compiled code calls by its `address`; kept on disk likewise."""
    how = _cfunc(signature, fastmath=_FAST, error_model="numpy", nogil=True, _nrt=False, cache=True)
    with global_compiler_lock, _only_the_entry(function.__qualname__):
        return how(function)


@contextmanager
def _only_the_entry(name: str) -> Iterator[None]:
    """Link, optimise and assemble the entry alone: what it calls never runs by itself.

    numba does all three for each of the hundred functions below it, each with all that it calls:
    more than half of the time. The methods are numba's own; where one is missing it goes on as
    usual. Garbage is looked for less often: nearly all of what a compilation makes is in use.
    """
    library, generator = codegen.CPUCodeLibrary, codegen.JITCPUCodegen
    places = (
        (library, "finalize"),
        (library, "_optimize_final_module"),
        (library, "_finalize_final_module"),
        (generator, "set_env"),
    )
    if not all(hasattr(*place) for place in places):
        yield
        return
    finalize, optimise, assemble, set_env = (getattr(*place) for place in places)

    def link_into_entry(self: Any) -> None:
        if self.name == name:
            self._linking_libraries = list(_below(self, {}))
        if self.name == name or self.name not in _OURS:
            finalize(self)
        else:
            self._finalized = True

    def optimise_entry(self: Any) -> None:
        if self.name == name:
            optimise(self)

    def assemble_entry(self: Any) -> None:
        if self.name == name:
            assemble(self)
        else:
            self._finalized = True

    def set_env_of_entry(self: Any, env_name: str, env: Any) -> None:
        if self._engine.is_symbol_defined(env_name):
            set_env(self, env_name, env)

    ours = (link_into_entry, optimise_entry, assemble_entry, set_env_of_entry)
    thresholds = gc.get_threshold()
    gc.set_threshold(_OBJECTS, *thresholds[1:])
    for place, method in zip(places, ours, strict=True):
        setattr(*place, method)
    try:
        yield
    finally:
        for place, method in zip(places, (finalize, optimise, assemble, set_env), strict=True):
            setattr(*place, method)
        gc.set_threshold(*thresholds)


def _below(library: Any, found: dict[Any, None]) -> dict[Any, None]:
    """Return the libraries of all functions below one, each once."""
    for each in library._linking_libraries:
        if each not in found:
            found[each] = None
            _below(each, found)
    return found


@compiled
def copy_row(source: Any, target: Any) -> None:
    """Copy a (n,) array."""
    for k in range(source.shape[0]):
        target[k] = source[k]


@compiled
def copy_rows(source: Any, target: Any) -> None:
    """Copy a (k, n) array."""
    for i in range(source.shape[0]):
        for k in range(source.shape[1]):
            target[i, k] = source[i, k]


def source_stamp() -> int:
    """Return a number that changes with any source file of the engine or its records."""
    digest = hashlib.sha256()
    engine = Path(__file__).parents[1]
    records = [engine.parent / name for name in _RECORDS]
    for file in sorted([*engine.rglob("*.py"), *records]):
        digest.update(file.read_bytes())
    return int.from_bytes(digest.digest()[:6], "big")
