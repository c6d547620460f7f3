"""A task with base, workpiece or tool elsewhere, in Python and in its record."""

from __future__ import annotations

import copy
from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
import pinocchio as pin

from dualarm_pin.cell import Cell
from dualarm_pin.files.cell_spec import PlacementSpec
from dualarm_pin.placement.parameters import BASE, TOOL, moved_base, workpiece_pose

if TYPE_CHECKING:
    from dualarm_pin.task.task import Task


def moved_task(task: Task, change: Mapping[str, float]) -> Task:
    """Return a task after a change of parameters, by name [m or rad]; see `placement.parameters`.

    What is asked of a placement is left out: it has been answered.
    """
    cell, piece = task.cell, workpiece_pose(change)
    longer = float(change.get(f"{TOOL}.length", 0.0))
    base = moved_base(cell.arms[1].base, change)
    if any(name.startswith(f"{BASE}.") for name in change):
        cell = cell.moved(base2=base)
    if longer:
        cell = _with_longer_tool(cell, longer)
    record = None if task.record is None else _moved_record(task.record, cell, piece)
    path = task.path if piece.isIdentity() else task.path.moved(piece)
    return replace(task, cell=cell, path=path, placement=None, record=record)


def _with_longer_tool(cell: Cell, length: float) -> Cell:
    """Return a cell whose second tool is longer along its axis; bodies stay as they are."""
    out = pin.SE3(np.eye(3), length * np.asarray(cell.tool_axes[1]))
    model = pin.Model(cell.model)
    model.frames[cell.e2].placement = cell.model.frames[cell.e2].placement * out
    first, second = cell.arms
    return replace(cell, model=model, arms=(first, replace(second, tool=second.tool * out)))


def _moved_record(record: Mapping[str, Any], cell: Cell, piece: pin.SE3) -> dict[str, Any]:
    new: dict[str, Any] = copy.deepcopy(dict(record))
    new.pop("placement", None)
    arm = new["cell"]["arms"]["arm2"]
    if arm.get("base") is not None or not cell.arms[1].base.isIdentity():
        arm["base"] = placement_record(cell.arms[1].base)
    if arm.get("tool") is not None or not cell.arms[1].tool.isIdentity():
        arm["tool"] = placement_record(cell.arms[1].tool)
    if not piece.isIdentity():
        frame = new["path"].get("frame")
        before = PlacementSpec.model_validate(frame).pose if frame else pin.SE3.Identity()
        new["path"]["frame"] = placement_record(piece * before)
    return new


def placement_record(pose: pin.SE3) -> dict[str, list[float]]:
    """Return a pose as a cell file writes it: `xyz` [m], `rpy_deg`."""
    return {
        "xyz": [float(x) for x in pose.translation],
        "rpy_deg": [float(a) for a in np.rad2deg(pin.rpy.matrixToRpy(pose.rotation))],
    }
