"""The paper's task, loaded once a process; tests take it as the fixtures of `conftest`."""

from functools import cache

import numpy as np
import pinocchio as pin

from dualarm_pin.files.resources import urdf_folder
from dualarm_pin.problem import Problem
from dualarm_pin.relative import relative_motion
from dualarm_pin.rows.row import frame_id
from dualarm_pin.task import Task

TASK = urdf_folder() / "tasks" / "paper_corner.yaml"
CELL = urdf_folder() / "cells" / "ns16_pair.yaml"


@cache
def task() -> Task:
    return Task.load(TASK)


@cache
def problem() -> Problem:
    return task().problem()


def world_pose(task: Task, name: str, q: np.ndarray) -> pin.SE3:
    """Return the pose of a frame of the task's cell in the world at q (n,)."""
    return relative_motion(task.cell, 0, frame_id(task.cell, name, name), q)[0]
