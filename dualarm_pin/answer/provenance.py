"""Where an answer comes from: the seconds spent and the versions that made it."""

from __future__ import annotations

import platform
import time
from dataclasses import dataclass
from functools import cache

from dualarm_pin import __version__

_LIBRARIES = ("pin", "coal", "nlopt", "numpy", "numba", "scipy")


@dataclass(frozen=True)
class Timing:
    """Seconds spent: wall clock, processor (workers included), compilation as a part of both."""

    wall_s: float = 0.0
    cpu_s: float = 0.0
    compile_s: float = 0.0


@dataclass(frozen=True)
class Clock:
    """Wall and processor time of this process since it was made.

    Start it before anything is compiled: `compile_s` is a part of what it reads.
    """

    wall: float
    cpu: float

    @classmethod
    def start(cls) -> Clock:
        """Begin to count."""
        return cls(time.perf_counter(), time.process_time())

    def read(self, compile_s: float = 0.0, workers_cpu_s: float = 0.0) -> Timing:
        """Return the seconds so far; what worker processes spent is told by themselves."""
        cpu = time.process_time() - self.cpu + workers_cpu_s
        return Timing(time.perf_counter() - self.wall, cpu, compile_s)


def versions() -> dict[str, str]:
    """Return the versions that make a result."""
    return dict(_versions())


@cache
def _versions() -> dict[str, str]:
    from importlib.metadata import PackageNotFoundError, version

    found = {"dualarm-pin": __version__, "python": platform.python_version()}
    for name in _LIBRARIES:
        try:
            found[name] = version(name)
        except PackageNotFoundError:  # a distribution under another name
            continue
    return found
