"""Is the engine compiled? The first use of a version compiles it once, for all later processes."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import pinocchio as pin
from numba.core import event

from dualarm_pin.engine import entries
from dualarm_pin.engine.chain import chain_from_model
from dualarm_pin.engine.solve import problem_data, solve
from dualarm_pin.indices import force

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
    """Solve for one joint and one point."""
    model = pin.Model()
    joint = model.addJoint(0, pin.JointModelRZ(), pin.SE3.Identity(), "joint")
    tip = model.addFrame(pin.Frame("tip", joint, pin.SE3.Identity(), pin.FrameType.BODY))
    chain = chain_from_model(model, 0, tip)
    data = problem_data(
        chain, force(), np.zeros((1, 3)), np.eye(3)[None], lower=[-1.0], upper=[1.0]
    )
    solve(data, np.zeros((1, 1)))
