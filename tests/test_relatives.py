"""The reference kinematics at many q: as those of one q at a time, from which they are written."""

from __future__ import annotations

import numpy as np
import pytest

from dualarm_pin import indices
from dualarm_pin.cell import Cell
from dualarm_pin.errors import ShapeError
from dualarm_pin.files.resources import urdf_folder
from dualarm_pin.indices import Index
from dualarm_pin.reference import (
    index_gradient,
    index_gradients,
    index_value,
    index_values,
    reported_value,
)
from dualarm_pin.relative import Relative
from dualarm_pin.relatives import Relatives
from dualarm_pin.rows.pose import pose_pulls, pose_residual

CELLS = ["ns16_pair", "b05_kinova_pair", "b09_pr2"]  # one after another, continuous, one body


@pytest.fixture(scope="module", params=CELLS)
def several(request: pytest.FixtureRequest) -> tuple[Cell, np.ndarray, list[Relative]]:
    cell = Cell.load(urdf_folder() / "cells" / f"{request.param}.yaml")
    q = np.random.default_rng(1).uniform(cell.lower, cell.upper, (7, cell.n))
    return cell, q, [Relative(cell, x) for x in q]


def test_poses_and_jacobians_are_those_of_each_q(several) -> None:
    cell, q, alone = several
    every = Relatives(cell, q)
    for i, one in enumerate(alone):
        np.testing.assert_allclose(every.translation[i], one.T_e1_e2.translation, atol=1e-12)
        np.testing.assert_allclose(every.rotation[i], one.T_e1_e2.rotation, atol=1e-12)
        np.testing.assert_allclose(every.J_r[i], one.J_r, atol=1e-12)


def test_along_is_what_the_derivative_gives(several) -> None:
    cell, q, alone = several
    P = np.random.default_rng(2).normal(size=(len(q), 6, cell.n))
    for slope, weight, one in zip(Relatives(cell, q).along(P), P, alone, strict=True):
        np.testing.assert_allclose(slope, np.einsum("ak,akl->l", weight, one.dJ_r), atol=1e-11)


@pytest.mark.parametrize("rows", [6, 5, 3])
def test_pulls_are_multipliers_times_the_pose_rows(several, rows: int) -> None:
    cell, q, alone = several
    random = np.random.default_rng(3)
    wanted = np.linalg.qr(random.normal(size=(len(q), 3, 3)))[0]
    wanted *= np.linalg.det(wanted)[:, None, None]
    wanted[0] = alone[0].T_e1_e2.rotation  # on the path
    axis, y = np.array([0.6, 0.0, 0.8]), random.normal(size=(len(q), 6))
    pulls = pose_pulls(Relatives(cell, q), wanted, np.full(len(q), rows), axis, y)
    for pull, R, y_i, one in zip(pulls, wanted, y, alone, strict=True):
        jacobian = pose_residual(one, np.zeros(3), R, rows, axis)[1]
        np.testing.assert_allclose(pull, y_i[:rows] @ jacobian, atol=1e-9)


@pytest.mark.parametrize(
    "index",
    [
        indices.force(task_weights=[1, 1, 1, 0.1, 0.1, 0.1]),
        indices.velocity().with_joint_centre(0.1),
        indices.inverse_condition_number(),
    ],
    ids=lambda index: index.name,
)
def test_indices_and_their_gradients_are_those_of_each_q(several, index: Index) -> None:
    cell, q, alone = several
    u, bounds = np.random.default_rng(4).normal(size=(len(q), 6)), (cell.lower, cell.upper)
    every = Relatives(cell, q)
    values, gradients = index_gradients(index, every, u, bounds)
    reported = index_values(index, every, u, bounds, reported=True)
    for i, one in enumerate(alone):
        value, gradient = index_gradient(index, one, u[i], q[i], bounds)
        assert values[i] == pytest.approx(value, rel=1e-9)
        assert values[i] == pytest.approx(index_value(index, one, u[i], q[i], bounds), rel=1e-9)
        assert reported[i] == pytest.approx(
            reported_value(index, one, u[i], q[i], bounds), rel=1e-9
        )
        np.testing.assert_allclose(gradients[i], gradient, rtol=1e-8, atol=1e-9)


def test_no_q_and_a_wrong_number_of_joints(cell: Cell) -> None:
    none = Relatives(cell, np.zeros((0, cell.n)))
    assert none.J_r.shape == (0, 6, cell.n)
    assert none.along(none.J_r).shape == (0, cell.n)
    with pytest.raises(ShapeError, match=r"not \(s, 12\)"):
        Relatives(cell, np.zeros((2, 5)))
