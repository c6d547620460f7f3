"""Motions to export: joints splined over the path, run from rest to rest."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from scipy.interpolate import CubicSpline

from dualarm_pin.answer.folder import save_result
from dualarm_pin.answer.trajectory import Trajectory
from dualarm_pin.motion import Motion
from dualarm_pin.motion.summary import MotionSummary
from dualarm_pin.task import Task


def motion_of(trajectory: Trajectory, *, duration: float, samples: int) -> Motion:
    """Return a motion through the points of a trajectory, smooth from rest to rest."""
    length = trajectory.arc_length
    time = np.linspace(0.0, duration, samples)
    x = time / duration
    s = length[-1] * x**3 * (10 - 15 * x + 6 * x**2)
    rate = length[-1] * 30 * x**2 * (1 - x) ** 2 / duration
    change = length[-1] * 60 * x * (1 - x) * (1 - 2 * x) / duration**2
    curve = CubicSpline(length, trajectory.q)
    slope, bend = curve(s, 1), curve(s, 2)
    return Motion(
        "constant_feed",
        trajectory.joints,
        time,
        s,
        curve(s),
        slope * rate[:, None],
        bend * rate[:, None] ** 2 + slope * change[:, None],
        None,
        MotionSummary(
            duration, float(rate.max()), None, float(length[-1] / duration),
            0.01, 0.001, 0.01, 0.001, (), 1.0, "", (),
        ),
    )  # fmt: skip


def result_with_motion(
    folder: Path, task: Task, trajectory: Trajectory, *, duration: float = 4.0, samples: int = 401
) -> Motion:
    """Write a result folder with a motion and return the motion."""
    save_result(folder, task, trajectory)
    motion = motion_of(trajectory, duration=duration, samples=samples)
    motion.write(folder)
    return motion
