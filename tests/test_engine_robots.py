"""The engine's pose and J_r equal Pinocchio's on every robot of the tables."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest
from robot_table import NAMES, arguments, needs_robots

from dualarm_pin.cell import Cell
from dualarm_pin.engine.evaluation import evaluate
from dualarm_pin.engine.solve import solve_many
from dualarm_pin.indices import force
from dualarm_pin.problem import Problem
from dualarm_pin.relative import Relative
from dualarm_pin.solution import STATUS

pytestmark = needs_robots
BASE2 = pin.SE3(pin.rpy.rpyToMatrix(0.1, -0.2, 3.0), np.array([1.2, 0.3, 0.1]))


def load(name: str) -> Cell:
    urdfs, options, _ = arguments(name)
    return Cell.from_urdf(*urdfs, base2=BASE2 if len(urdfs) == 2 else None, **options)


def data_at(cell, targets, **stated):
    return Problem.of(
        cell,
        force(),
        [T.translation for T in targets],
        [T.rotation for T in targets],
        lower=cell.lower,
        upper=cell.upper,
        **stated,
    )


@pytest.mark.parametrize("name", NAMES)
def test_pose_jacobian_and_index_equal_pinocchio(name):
    cell = load(name)
    rng = np.random.default_rng(1)
    q = rng.uniform(cell.lower, cell.upper, (5, cell.n))
    u = rng.normal(size=(5, 6))
    reference = [Relative(cell, x) for x in q]
    at = evaluate(data_at(cell, [r.T_e1_e2 for r in reference], u=u), q)
    assert np.abs(at.residual).max() < 1e-9
    for i, r in enumerate(reference):
        np.testing.assert_allclose(at.J_r[i], r.J_r, rtol=0, atol=1e-9)
        assert at.values[i] == pytest.approx(np.sum((r.J_r.T @ u[i]) ** 2), rel=1e-9)


@pytest.mark.parametrize("name", ["finger_edu", "borinot"])
def test_too_few_joints_is_infeasible_not_wrong(name):
    """Rank J_r is 5 or 4 everywhere: a pose off the reachable ones has a residual, never NaN."""
    cell = load(name)
    rng = np.random.default_rng(2)
    q = rng.uniform(cell.lower, cell.upper)
    near = Relative(cell, q).T_e1_e2
    off = pin.SE3(near.rotation @ pin.exp3(np.array([0.7, -0.9, 0.4])), near.translation + 0.3)
    starts = rng.uniform(cell.lower, cell.upper, (4, 1, cell.n))
    batch = solve_many(data_at(cell, [off], u=[[1, 0, 0, 0, 0, 0]]), starts)
    assert not batch.feasible.any()
    assert (batch.status == STATUS.index("infeasible")).all()
    assert np.isfinite(batch.q).all()
