"""The paper's task, loaded once a process; tests take it as the fixtures of `conftest`."""

from functools import cache

from dualarm_pin.files.resources import urdf_folder
from dualarm_pin.problem import Problem
from dualarm_pin.task import Task

TASK = urdf_folder() / "tasks" / "paper_corner.yaml"
CELL = urdf_folder() / "cells" / "ns16_pair.yaml"


@cache
def task() -> Task:
    return Task.load(TASK)


@cache
def problem() -> Problem:
    return task().problem()
