"""The torque index: what a unit force costs the joints, as shares of their limits."""

from __future__ import annotations

import numpy as np
import pytest
from ns16_pair import motions
from paper_case import TASK

from dualarm_pin.errors import InputError
from dualarm_pin.reference import index_value
from dualarm_pin.relative import Relative
from dualarm_pin.task import Task

LIMITS = np.tile([2000.0, 3000.0, 2500.0, 400.0, 200.0, 60.0], 2)
TORQUE = "cell.torque={" + ", ".join(f"joint_{j + 1}: {LIMITS[j]}" for j in range(6)) + "}"
INDEX = "index={torque: {direction: tangent}}"


def test_it_is_the_sum_of_squared_shares_of_the_torque_limits() -> None:
    task = Task.load(TASK, [INDEX, TORQUE])
    q = motions()[0][0][5]
    relative = Relative(task.cell, q)
    torque = relative.J_r.T @ task.path.u[5]
    value = index_value(task.index, relative, task.path.u[5], q, (task.cell.lower, task.cell.upper))
    assert value == pytest.approx(float(np.sum((torque / LIMITS) ** 2)))
    assert (task.index.name, task.index.units) == ("torque", "1/N^2")


def test_without_torque_limits_it_names_the_joint_and_the_key() -> None:
    with pytest.raises(InputError) as caught:
        Task.load(TASK, [INDEX])
    assert "arms.arm1.torque: {joint_1" in str(caught.value)


def test_weights_of_ones_own_take_the_place_of_the_limits() -> None:
    weights = "index={torque: {joint_weights: [1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1]}}"
    assert np.array_equal(Task.load(TASK, [weights]).index.joint_weights, np.ones(12))
