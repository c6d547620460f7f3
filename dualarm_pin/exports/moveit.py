"""MoveIt: a `moveit_msgs/RobotTrajectory`, to show or to execute."""

from __future__ import annotations

from dualarm_pin.exports.format import Chord, Files, Format
from dualarm_pin.exports.joint_trajectory import read_trajectory, trajectory_lines
from dualarm_pin.exports.program import Points, Program

FILE = "robot_trajectory.yaml"


def _write(program: Program) -> Files:
    head = [f"# {line}" for line in program.comment]
    body = ["joint_trajectory:", *trajectory_lines(program, "  "), "multi_dof_joint_trajectory: {}"]
    return {FILE: "\n".join([*head, *body, ""])}


def _read(files: Files) -> Points:
    return read_trajectory(files[FILE], "joint_trajectory", FILE)


MOVEIT = Format("moveit", _write, _read, between="quintic", tolerance=Chord(0.01, 0.001))
