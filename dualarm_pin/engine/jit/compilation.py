"""Is the engine compiled? The first use of a version compiles it once, for all later processes."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numba.core import event

from dualarm_pin.cell import Cell
from dualarm_pin.engine import entries
from dualarm_pin.engine.solve import Options, solve
from dualarm_pin.files.resources import urdf_folder
from dualarm_pin.indices import force
from dualarm_pin.problem import Problem

NOTICE = "compiling the engine, once for this version: about half a minute"


@dataclass(frozen=True)
class CompileReport:
    """What it took to have the engine ready.

    Attributes:
        seconds: Time to compile it or to load it.
        from_cache: Whether it was on disk or loaded already.
        folder: Where the compiled code is kept.
    """

    seconds: float
    from_cache: bool
    folder: str


def ensure_compiled(notify: Callable[[str], None] | None = None) -> CompileReport:
    """Compile or load the engine now, and tell the user if it has to be compiled.

    Args:
        notify: Called with one line when a compilation starts, for instance `print`.
    """
    listener = _Listener(notify)
    start = time.perf_counter()
    if not entries.solve_items.signatures:
        with event.install_listener("numba:compile", listener):
            _smallest_solve()
    seconds = time.perf_counter() - start
    if listener.heard and notify is not None:
        notify(f"compiled in {seconds:.0f} s; from now on it is read from the disk")
    return CompileReport(seconds, not listener.heard, str(entries.solve_items.stats.cache_path))


class _Listener(event.Listener):
    """Hear the first compilation; loading from disk makes no such event."""

    def __init__(self, notify: Callable[[str], None] | None) -> None:
        self._tell, self.heard = notify, False

    def on_start(self, event: Any) -> None:
        if not self.heard and self._tell is not None:
            self._tell(NOTICE)
        self.heard = True

    def on_end(self, event: Any) -> None:
        """Nothing to do."""


def _smallest_solve() -> None:
    """Solve one point of a cell that ships: the types are those of every other problem."""
    cell = Cell.load(urdf_folder() / "cells" / "ns16_pair.yaml")
    middle = (cell.lower + cell.upper) / 2.0
    problem = Problem.of(
        cell, force(), np.zeros((1, 3)), np.eye(3), lower=cell.lower, upper=cell.upper
    )
    solve(problem, middle[None], Options(iterations=0))
