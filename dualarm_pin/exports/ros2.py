"""ROS 2: a goal of FollowJointTrajectory for one controller of both arms, and its sender."""

from __future__ import annotations

from pathlib import Path

from dualarm_pin.exports.format import Chord, Files, Format
from dualarm_pin.exports.joint_trajectory import read_trajectory, trajectory_lines
from dualarm_pin.exports.program import Points, Program

GOAL, SENDER = "both.goal.yaml", "send_goal.py"
_HINT = (
    "The first point is not approached: the arms must stand there.",
    "Send it: python3 send_goal.py both.goal.yaml",
    "A shell argument holds about 280 points at most: do not pass this file as one.",
)


def _write(program: Program) -> Files:
    head = [f"# {line}" for line in (*program.comment, *_HINT)]
    body = ["trajectory:", *trajectory_lines(program, "  ")]
    end = ["goal_time_tolerance: {sec: 0, nanosec: 500000000}", ""]
    sender = Path(__file__).with_name("ros") / SENDER
    return {GOAL: "\n".join([*head, *body, *end]), SENDER: sender.read_text(encoding="utf-8")}


def _read(files: Files) -> Points:
    return read_trajectory(files[GOAL], "trajectory", GOAL)


ROS2 = Format("ros2", _write, _read, between="quintic", tolerance=Chord(0.01, 0.001))
