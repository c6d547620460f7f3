"""Motions to export: joints splined over the path, run from rest to rest."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any
from xml.sax.saxutils import escape

import numpy as np
import pinocchio as pin
from scipy.interpolate import CubicSpline

from dualarm_pin.answer.folder import save_result
from dualarm_pin.answer.trajectory import Trajectory
from dualarm_pin.answer.verify import verified
from dualarm_pin.arrays import Array
from dualarm_pin.cell import Cell
from dualarm_pin.motion import Motion
from dualarm_pin.motion.summary import MotionSummary
from dualarm_pin.relative import Relative
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


JOINT = """\
  <link name="l{k}"/>
  <joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="l{k}"/>
    <origin xyz="0.02 0 {length}"/><axis xyz="{axis}"/>
    <limit lower="-2.5" upper="2.5" effort="50" velocity="3"/></joint>
"""


def arm_urdf(names: Sequence[str], prismatic: Sequence[str] = ()) -> str:
    """Return a URDF of one arm whose joints turn about y, z and x by turns."""
    parts = ['<robot name="arm">\n  <link name="l0"/>\n']
    for k, name in enumerate(names, 1):
        parts.append(
            JOINT.format(
                k=k, name=escape(name, {'"': "&quot;"}), parent=f"l{k - 1}", length=0.25,
                kind="prismatic" if name in prismatic else "revolute",
                axis=("0 1 0", "0 0 1", "1 0 0")[k % 3],
            )
        )  # fmt: skip
    return "".join([*parts, "</robot>\n"])


def joint_line(folder: Path, cell: str, *, free: str = "", turn: float = 0.4) -> Task:
    """Write a task whose path a straight line in the joints of a cell follows, and load it.

    Args:
        folder: Where to.
        cell: Content of the cell file.
        free: What the path leaves free: `spin` or `rotation`.
        turn: How far each joint goes at most [rad or m].
    """
    (folder / "cell.yaml").write_text(cell)
    loaded = Cell.load(folder / "cell.yaml")
    rows = []
    for q in joints_of(loaded, turn):
        pose = Relative(loaded, q).T_e1_e2
        x, y, z, w = pin.Quaternion(pose.rotation).coeffs()
        rows.append([*pose.translation, w, x, y, z])
    table = "\n".join(",".join(map(repr, map(float, row))) for row in rows)
    (folder / "path.csv").write_text(f"x,y,z,qw,qx,qy,qz\n{table}\n")
    how = f"csv: path.csv, free: {free or 'none'}"
    (folder / "task.yaml").write_text(
        f"cell: cell.yaml\npath: {{{how}}}\nindex: {{force: {{direction: tangent}}}}\n"
    )
    return Task.load(folder / "task.yaml")


def joints_of(cell: Cell, turn: float = 0.4) -> Array:
    """Return the joints of `joint_line` at its points (9, n)."""
    draw = np.random.default_rng(3).uniform(-1.0, 1.0, (2, cell.n))
    middle = (cell.lower + cell.upper) / 2 + 0.4 * draw[0]
    share = np.linspace(-1.0, 1.0, 9)[:, None]
    return np.asarray(middle + turn * share * draw[1] + 0.1 * (share * draw[0]) ** 2)


def line_result(folder: Path, cell: str, **how: Any) -> Path:
    """Return a result folder with a motion for a cell."""
    task = joint_line(folder, cell, **how)
    q = joints_of(task.cell, how.get("turn", 0.4))
    result_with_motion(
        folder / "result", task, verified(task, q, method="mine", solver="none"), samples=201
    )
    return folder / "result"
