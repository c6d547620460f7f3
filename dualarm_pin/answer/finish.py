"""From joints to a `Trajectory`: verify, measure, record where it came from."""

from __future__ import annotations

import platform
import time
from collections.abc import Mapping
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from dualarm_pin import __version__
from dualarm_pin.answer.trajectory import Evidence, Timing, Trajectory
from dualarm_pin.answer.verify import Verification, verify
from dualarm_pin.reference import coupling

if TYPE_CHECKING:
    from dualarm_pin.task import Task

Array = NDArray[np.float64]
_LIBRARIES = ("pin", "coal", "nlopt", "numpy", "numba", "scipy")


@dataclass(frozen=True)
class Clock:
    """Wall and processor time of this process since it was made."""

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


def finish(
    task: Task,
    q: Array,
    *,
    method: str,
    solver: str,
    timing: Timing,
    seed: int | None = None,
    evidence: Evidence | None = None,
    message: str = "",
    extra: Mapping[str, Any] | None = None,
    verification: Verification | None = None,
) -> Trajectory:
    """Check joints q (h, n) with Pinocchio and return them as a trajectory."""
    checked = verification or verify(task, q)
    problem = task.problem()
    clearance = checked.clearance
    return Trajectory(
        q=q,
        joints=task.cell.joint_names,
        arc_length=task.path.arc_length,
        index=checked.index,
        found=checked.found,
        method=method,
        solver=solver,
        objective=float(np.sum(checked.index)) + coupling(problem, q)[0],
        arc_mean_index=arc_mean(task.path.arc_length, checked.index),
        max_position_error=float(np.max(checked.position_error)),
        max_rotation_error=float(np.max(checked.rotation_error)),
        max_bound_violation=float(np.max(checked.bound_violation)),
        max_joint_step=checked.max_joint_step,
        min_clearance=None if clearance is None else float(np.min(clearance)),
        clearance=clearance,
        evidence=evidence or Evidence(),
        timing=timing,
        seed=seed,
        versions=versions(),
        message=message or _why(checked),
        extra=dict(extra or {})
        | {
            "smallest_singular_value": checked.smallest_singular_value,
            "arm_clearance": checked.arm_clearance,
        },
    )


def arc_mean(arc_length: Array, index: Array) -> float:
    """Return the mean of the index over the arc length, by trapezoids."""
    length = float(arc_length[-1] - arc_length[0])
    return float(np.trapezoid(index, arc_length)) / length if length > 0 else float(np.mean(index))


def versions() -> dict[str, str]:
    """Return the versions that made a result."""
    found = {"dualarm-pin": __version__, "python": platform.python_version()}
    for name in _LIBRARIES:
        try:
            found[name] = version(name)
        except PackageNotFoundError:  # a distribution under another name
            continue
    return found


def _why(checked: Verification) -> str:
    if checked.found:
        return ""
    worst = int(np.argmax(checked.position_error + checked.rotation_error))
    return (
        f"not verified: point {worst + 1} is {checked.position_error[worst]:.2g} m and "
        f"{checked.rotation_error[worst]:.2g} rad from the path, largest bound violation "
        f"{float(np.max(checked.bound_violation)):.2g}"
    )
