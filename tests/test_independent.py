"""What solvers return, against references that share no code with them.

Poses come from Pinocchio's forward kinematics alone, derivatives from differences of these, the
objective from the paper's formula written out, and numbers from another implementation.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
from numpy.typing import NDArray

from dualarm_pin import reference
from dualarm_pin.cell import Cell
from dualarm_pin.problem import Problem
from dualarm_pin.solution import Solution
from dualarm_pin.solvers import interior_point as engine
from dualarm_pin.solvers import slsqp

Array = NDArray[np.float64]
CASES = json.loads((Path(__file__).parent / "data" / "ns16_reference.json").read_text())["cases"]
STEP = 1e-5  # of differences; pose errors of 1e-15 become 1e-10


def pose(cell: Cell, q: Array) -> pin.SE3:
    data = cell.model.createData()
    pin.framesForwardKinematics(cell.model, data, cell.joint_map @ q + cell.joint_offset)
    return data.oMf[cell.e1].actInv(data.oMf[cell.e2])


def jacobian(cell: Cell, q: Array) -> Array:
    """Return J_r (6, n) in the axes of e1 by differences of the pose."""
    here = pose(cell, q).rotation
    columns = []
    for e in STEP * np.eye(cell.n):
        ahead, behind = pose(cell, q + e), pose(cell, q - e)
        turn = pin.log3(ahead.rotation @ here.T) - pin.log3(behind.rotation @ here.T)
        columns.append(np.r_[ahead.translation - behind.translation, turn] / (2 * STEP))
    return np.column_stack(columns)


def objective(problem: Problem, q: Array) -> float:
    """Return the paper's cost (eq. 19) at q (k, n), written out."""
    u, links = problem.points.u, problem.links.weight[:-1]
    c = [np.sum((jacobian(problem.cell, x).T @ v) ** 2) for x, v in zip(q, u, strict=True)]
    return float(np.sum(c) + links @ np.linalg.norm(np.diff(q, axis=0), axis=1) ** 4)


def reachable(problem: Problem, seed: int) -> tuple[Problem, Array, Array]:
    """Return three linked points whose poses the arms can take, a start, and joints that do."""
    random = np.random.default_rng(seed)
    q = 0.8 * random.uniform(problem.lower, problem.upper)
    path = q + 0.1 * np.linspace(0.0, 1.0, 3)[:, None] * random.normal(size=problem.n)
    path = np.clip(path, problem.lower, problem.upper)
    T = [pose(problem.cell, x) for x in path]
    part = Problem.of(
        problem.cell,
        problem.index,
        [t.translation for t in T],
        [t.rotation for t in T],
        lower=problem.lower,
        upper=problem.upper,
        u=problem.points.u[[0, 15, 30]],
        link_weight=[1.5, 1.5],
    )
    return part, np.tile(random.uniform(problem.lower, problem.upper), (3, 1)), path


@pytest.mark.parametrize("case", CASES[:10])
def test_index_of_another_implementation(cell: Cell, problem: Problem, case) -> None:  # type: ignore[no-untyped-def]
    q = np.array(case["q"])
    T = pose(cell, q)
    np.testing.assert_allclose(T.translation, case["position"], atol=1e-9)
    np.testing.assert_allclose(T.rotation, case["rotation"], atol=1e-9)
    np.testing.assert_allclose(jacobian(cell, q), case["J_r"], atol=1e-8)
    u = np.r_[case["u"], np.zeros(3)]
    alone = problem.subset([0], 0.0).with_points(u=u[None])
    assert reference.objective(alone, q[None]) == pytest.approx(case["c"], rel=1e-9)


def test_a_start_with_a_reachable_path_converges_to_what_is_true(problem: Problem) -> None:
    converged = 0
    for seed in range(10):
        part, start, known = reachable(problem, seed)
        end = engine.solve(part, start)
        wanted = objective(part, end.q)
        assert end.objective == pytest.approx(wanted, rel=1e-8)
        assert ((end.q >= part.lower) & (end.q <= part.upper)).all()
        converged += end.converged
        if end.converged:
            assert_on_path_and_stationary(part, end)
        near = engine.solve(part, known)
        assert near.converged
        assert near.objective <= objective(part, known)
    assert converged >= 8


def assert_on_path_and_stationary(part: Problem, end: Solution) -> None:
    """First order by differences: along the path, away from active bounds, nothing goes down."""
    for i, q in enumerate(end.q):
        T = pose(part.cell, q)
        assert np.abs(T.translation - part.points.position[i]).max() < 1e-6
        assert np.abs(pin.log3(part.points.rotation[i].T @ T.rotation)).max() < 1e-6
        J = jacobian(part.cell, q)

        def cost(x: Array, i: int = i) -> float:
            return objective(part, np.r_[end.q[:i], x[None], end.q[i + 1 :]])

        steps = 1e-4 * np.eye(part.n)
        slope = np.array([(cost(q + e) - cost(q - e)) / 2e-4 for e in steps])
        free = (q > part.lower + 1e-4) & (q < part.upper - 1e-4)
        y = np.linalg.lstsq(J[:, free].T, slope[free], rcond=None)[0]
        assert np.abs(slope[free] - J[:, free].T @ y).max() < 1e-3


def ends_of_unreachable(problem: Problem, position: Array) -> set[str]:
    far = problem.with_points(position=position)
    random = np.random.default_rng(0)
    starts = random.uniform(problem.lower, problem.upper, (40, problem.n))
    ends = [engine.solve(far, np.tile(q, (problem.k, 1))) for q in starts]
    assert not any(end.feasible or end.converged for end in ends)
    assert all(np.isfinite(end.q).all() and end.residual > 0.05 for end in ends)
    return {end.message for end in ends}


@pytest.mark.parametrize("shift", [[0.0, 0.0, 4.0], [0.0, -6.0, 0.0], [50.0, 0.0, 0.0]], ids=str)
def test_an_unreachable_path_is_infeasible_from_every_start(
    problem: Problem, shift: list[float]
) -> None:
    position = problem.points.position + shift
    assert ends_of_unreachable(problem, position) == {"infeasible"}


def test_one_unreachable_point_makes_the_path_infeasible(problem: Problem) -> None:
    position = problem.points.position.copy()
    position[17, 2] += 5.0
    assert ends_of_unreachable(problem, position) == {"infeasible"}


def test_a_singular_start_ends_at_a_minimum(problem: Problem) -> None:
    """All joints at zero is singular; points that coincide are points like others."""
    part = problem.subset([0, 0, 0, 1, 1, 30], 3.0)
    end = engine.solve(part, np.zeros((6, 12)))
    assert end.converged
    assert end.objective == pytest.approx(objective(part, end.q))
    assert_on_path_and_stationary(part, end)


def test_nlopt_ends_at_what_is_true(problem: Problem) -> None:
    found = 0
    for seed in range(5):
        part, start, _ = reachable(problem, seed)
        end = slsqp.solve(part, start)
        wanted = objective(part, end.q)
        assert end.objective == pytest.approx(wanted, rel=1e-8)
        found += end.feasible
    assert found >= 3
