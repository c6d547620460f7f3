"""Joints of the URDF and axes of the controllers: one linear map, and its way back."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from dualarm_pin.arrays import Array
from dualarm_pin.cell import Cell
from dualarm_pin.cell.parts import ARMS
from dualarm_pin.errors import InputError
from dualarm_pin.exports.format import Axes, Format


@dataclass(frozen=True, eq=False)
class Convention:
    """Values of a file: matrix @ q + offset.

    Attributes:
        matrix: (n, n).
        offset: (n,).
    """

    matrix: Array
    offset: Array

    def values(self, q: Array) -> Array:
        """Return the values of a file (k, n) for joints (k, n) [rad or m]."""
        return np.asarray(q @ self.matrix.T + self.offset)

    def joints(self, values: Array) -> Array:
        """Return the joints (k, n) [rad or m] for the values of a file (k, n)."""
        return np.asarray(np.linalg.solve(self.matrix, (values - self.offset).T).T)


def arm_columns(cell: Cell) -> Mapping[str, slice]:
    """Return the columns of each arm that moves; the rest of q is common to both."""
    first = len(cell.arms[0].joints)
    both = (slice(0, first), slice(first, first + len(cell.arms[1].joints)))
    return {arm: part for arm, part in zip(ARMS, both, strict=True) if part.start < part.stop}


def convention_of(cell: Cell, target: Format) -> Convention:
    """Return how a format counts the joints of a cell.

    Raises:
        InputError: The cell has joints that the format has no axes for.
    """
    matrix, offset = np.eye(cell.n), np.zeros(cell.n)
    axes = target.axes
    if axes is None:
        return Convention(matrix, offset)
    _refuse(cell, target.name, axes)
    unit = 180.0 / math.pi if axes.unit == "deg" else 1.0
    controllers = {arm.name: arm.controller for arm in cell.arms}
    for arm, part in arm_columns(cell).items():
        controller = controllers[arm]
        known = np.zeros((axes.count, axes.count))
        for row, column, factor in axes.coupling:
            known[row, column] = factor
        coupled = known if controller.coupling is None else controller.coupling
        scaled = unit * (np.eye(axes.count) + coupled)
        matrix[part, part] = scaled * controller.signs
        offset[part] = scaled @ controller.offsets
    return Convention(matrix, offset)


def ros_names(cell: Cell) -> tuple[str, ...]:
    """Return the names of the joints as a ROS controller calls them.

    Those of the URDF where one holds both arms, else with `arm1_` or `arm2_` before them; or with
    what the cell file says.

    Raises:
        InputError: Two joints have the same name.
    """
    said = {arm.name: arm.controller.prefix for arm in cell.arms}
    names = []
    for joint in cell.joints:
        owner, _, name = joint.name.partition("/")
        prefix = said.get(owner)
        usual = "" if cell.one_urdf else f"{owner}_"
        names.append((usual if prefix is None else prefix) + name)
    for name in names:
        if names.count(name) > 1:
            message = f"two joints would be called {name!r}: give each arm a prefix of its own"
            raise InputError(message, field="arms.arm1.controller.prefix")
    return tuple(names)


def _refuse(cell: Cell, name: str, axes: Axes) -> None:
    else_to = "export to ros2, moveit or csv"
    for joint in cell.joints:
        if joint.arm == "common":
            lack = f"moves both arms, and no axis of a {name} program does"
            raise InputError(f"{lack}: lock it and solve again, or {else_to}", field=joint.name)
        if joint.kind == "prismatic":
            lack = f"is prismatic: the axes of a {name} program are angles here"
            raise InputError(f"{lack}; {else_to}", field=joint.name)
    for arm, part in arm_columns(cell).items():
        count = part.stop - part.start
        if count != axes.count:
            message = f"{count} joints move; a {name} program has {axes.count} axes: {else_to}"
            raise InputError(message, field=arm)
