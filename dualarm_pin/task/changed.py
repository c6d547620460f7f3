"""A task with another lambda, clearance or joint limits, in Python and in its record."""

from __future__ import annotations

import copy
from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from dualarm_pin.cell import Cell
from dualarm_pin.clearance.rule import ClearanceRule

if TYPE_CHECKING:
    from dualarm_pin.task.task import Task

Limits = Mapping[str, tuple[float, float]]


def changed_task(
    task: Task,
    *,
    smoothness: float | None = None,
    clearance: float | None = None,
    limits: Limits | None = None,
) -> Task:
    """Return a task that asks something else; None leaves what it asks.

    Args:
        task: The task.
        smoothness: lambda of (eq. 19).
        clearance: What every pair of bodies must keep that has no distance of its own [m].
        limits: Bounds by joint [rad or m].

    Raises:
        InputError: The clearance is negative or not finite.
    """
    rule = task.clearance
    if clearance is not None:
        rule = ClearanceRule(clearance) if rule is None else rule
        rule = replace(rule, distance=clearance, spare_fixed=False)
    record = None
    if task.record is not None:
        record = _changed_record(task.record, smoothness, clearance, limits or {})
    return replace(
        task,
        cell=_limited(task.cell, limits or {}),
        smoothness=task.smoothness if smoothness is None else smoothness,
        clearance=rule,
        record=record,
    )


def _limited(cell: Cell, limits: Limits) -> Cell:
    if not limits:
        return cell
    joints = tuple(
        replace(joint, lower=limits[joint.name][0], upper=limits[joint.name][1], continuous=False)
        if joint.name in limits
        else joint
        for joint in cell.joints
    )
    # A moved cell keeps what was loaded, from which it is moved again.
    loaded = None if cell._loaded is None else replace(cell._loaded, joints=joints)
    return replace(cell, joints=joints, _loaded=loaded)


def _changed_record(
    record: Mapping[str, Any], smoothness: float | None, clearance: float | None, limits: Limits
) -> dict[str, Any]:
    new: dict[str, Any] = copy.deepcopy(dict(record))
    for key, inside, value in (
        ("smoothness", "weight", smoothness),
        ("clearance", "required", clearance),
    ):
        if value is None:
            continue
        if isinstance(new.get(key), dict):
            new[key][inside] = float(value)
        else:
            new[key] = float(value)
    for joint, bounds in limits.items():
        owner, _, name = joint.partition("/")
        level = new["cell"] if owner == "common" else new["cell"]["arms"][owner]
        for key in ("limits", "limits_deg"):
            for known in (name, joint):
                (level.get(key) or {}).pop(known, None)
        level["limits"] = (level.get("limits") or {}) | {name: [float(x) for x in bounds]}
    return new
