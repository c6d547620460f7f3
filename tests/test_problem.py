"""The programme over k points: gradients against differences, (19) and (20) as one code."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest
from numpy.typing import NDArray

from dualarm_pin.errors import ShapeError
from dualarm_pin.indices import force
from dualarm_pin.problem import Problem
from dualarm_pin.reference import coupling, objective_and_gradient
from dualarm_pin.relative import Relative
from dualarm_pin.rows.pose import pose_residual
from dualarm_pin.task import Task

Array = NDArray[np.float64]


@pytest.fixture
def random() -> np.random.Generator:
    return np.random.default_rng(4)


def differences(function, q: Array, step: float = 1e-6) -> Array:  # type: ignore[no-untyped-def]
    """Return the central differences of a function of q (k, n), last axis over q.ravel()."""
    columns = []
    for i in range(q.size):
        e = np.zeros(q.size)
        e[i] = step
        e = e.reshape(q.shape)
        columns.append((np.asarray(function(q + e)) - np.asarray(function(q - e))) / (2 * step))
    return np.stack(columns, axis=-1)


VARIANTS = {
    "eq. 19": {},
    "joint centre": {"index": replace(force(), joint_centre=0.3)},
    "task weights": {"index": force(task_weights=np.array([1.0, 2.0, 0.5, 0.1, 0.0, 0.2]))},
    "joint weights": {"index": force(joint_weights=np.linspace(0.5, 2.0, 12))},
    "linear": {"linear": np.linspace(-1, 1, 36).reshape(3, 12)},
    "metric": {"metric": np.linspace(0.1, 3.0, 12)},
    "weights of the points": {"index_weight": np.array([0.5, 1.0, 0.0])},
}


def changed(problem: Problem, changes: dict[str, object]) -> Problem:
    """Return the problem with another index, metric or field of its points."""
    if "index" in changes:
        return replace(problem, index=changes["index"])  # type: ignore[arg-type]
    if "metric" in changes:
        return replace(
            problem, links=problem.links._replace(metric=np.array([changes["metric"]] * 3))
        )  # type: ignore[arg-type]
    return problem.with_points(**changes)  # type: ignore[arg-type]


@pytest.mark.parametrize("changes", VARIANTS.values(), ids=VARIANTS)
def test_gradient_is_the_derivative_of_the_objective(
    task: Task, random: np.random.Generator, changes: dict[str, object]
) -> None:
    problem = task.problem().subset([0, 14, 30], 1.5)
    problem = changed(problem, changes).with_points(u=random.normal(size=(3, 6)))
    q = random.uniform(problem.lower, problem.upper, (3, 12))
    value, gradient = objective_and_gradient(problem, q)
    assert value == pytest.approx(problem.objective(q), rel=1e-12)
    wanted = differences(problem.objective, q).reshape(q.shape)
    np.testing.assert_allclose(gradient, wanted, atol=2e-6 * max(1.0, np.abs(wanted).max()))


@pytest.mark.parametrize("ends", ["before", "after", "both"])
def test_fixed_neighbours_make_eq_20_of_eq_19(
    task: Task, random: np.random.Generator, ends: str
) -> None:
    whole = task.problem().subset([0, 1, 2, 3, 4], 3.0)
    q = random.uniform(whole.lower, whole.upper, (5, 12))
    first, last = (0 if ends == "after" else 1), (5 if ends == "before" else 4)
    inner = whole.subset(
        range(first, last),
        3.0,
        before=None if first == 0 else q[0],
        after=None if last == 5 else q[4],
    )
    fixed = [i for i in range(5) if not first <= i < last]
    alone = sum(whole.subset([i], 0.0).objective(q[[i]]) for i in fixed)
    assert inner.objective(q[first:last]) + alone == pytest.approx(whole.objective(q), rel=1e-12)
    gradient = objective_and_gradient(inner, q[first:last])[1]
    np.testing.assert_allclose(gradient, objective_and_gradient(whole, q)[1][first:last], atol=1e-9)


def test_the_paper_sums_fourth_powers_of_steps(task: Task) -> None:
    problem = task.problem().subset([0, 1], 2.0)
    q = np.zeros((2, 12))
    q[1, 3], q[1, 7] = 0.3, -0.4
    assert coupling(problem, q)[0] == pytest.approx(2.0 * 0.5**4)


@pytest.mark.parametrize("rows", [6, 5, 3])
def test_the_pose_jacobian_is_the_derivative_of_the_residual(
    task: Task, random: np.random.Generator, rows: int
) -> None:
    axis = np.array([0.6, 0.0, 0.8])
    position, rotation = random.normal(size=3), pin.exp3(random.normal(size=3))
    q = random.uniform(task.cell.lower, task.cell.upper)

    def residual(q: Array) -> Array:
        return pose_residual(Relative(task.cell, q), position, rotation, rows, axis)[0]

    assert residual(q).shape == (rows,)
    J = pose_residual(Relative(task.cell, q), position, rotation, rows, axis)[1]
    np.testing.assert_allclose(J, differences(residual, q), atol=1e-8)


class Turned:
    """Stands in for `Relative` at a pose of choice."""

    def __init__(self, R: Array) -> None:
        self.T_e1_e2 = pin.SE3(R, np.zeros(3))
        self.J_r = np.zeros((6, 1))


@pytest.mark.parametrize("turn", [0.0, 1.0, 3.0, np.pi, -np.pi / 2])
def test_the_rotation_residual_vanishes_at_the_right_rotation_alone(turn: float) -> None:
    wanted = pin.exp3(np.array([0.3, -1.0, 0.5]))
    given = wanted @ pin.exp3(turn * np.array([0.0, 0.6, 0.8]))
    r = pose_residual(Turned(given), np.zeros(3), wanted, 6, np.array([0.0, 0, 1]))[0]  # type: ignore[arg-type]
    assert np.linalg.norm(r[3:]) == pytest.approx(2 * abs(np.sin(turn / 2)), abs=1e-9)


def test_the_free_spin_does_not_count_and_the_opposite_axis_does() -> None:
    axis = np.array([0.0, 0.0, 1.0])
    wanted = pin.exp3(np.array([0.3, -1.0, 0.5]))

    def size(R: Array) -> float:
        r = pose_residual(Turned(wanted @ R), np.zeros(3), wanted, 5, axis)[0]  # type: ignore[arg-type]
        return float(np.linalg.norm(r[3:]))

    assert size(pin.exp3(np.array([0, 0, 2.0]))) < 1e-12
    assert size(pin.exp3(np.array([0.2, 0, 0]))) == pytest.approx(2 * np.sin(0.1))
    assert size(pin.exp3(np.array([np.pi - 1e-3, 0, 0]))) > 1.9


def test_a_wrong_shape_is_refused_with_its_name(task: Task) -> None:
    with pytest.raises(ShapeError, match=r"u: has shape \(31, 3\), not \(31, 6\)"):
        task.problem().with_points(u=np.zeros((31, 3)))


def test_a_subset_keeps_what_belongs_to_its_points(task: Task) -> None:
    problem = task.problem().with_points(linear=np.arange(31 * 12.0).reshape(31, 12))
    part = problem.subset([4, 9], np.array([1.0, 2.0, 3.0]), np.zeros(12), np.ones(12))
    for name in part.points._fields:
        whole = getattr(problem.points, name)
        np.testing.assert_array_equal(getattr(part.points, name), whole[[4, 9]])
    assert part.links.weight.tolist() == [2.0, 0.0]
    assert part.neighbours.weight.tolist() == [1.0, 3.0]


@pytest.mark.parametrize("factor", [1e-3, 1.0, 1e4])
def test_the_size_of_an_index_does_not_decide_when_a_solver_stops(
    task: Task, factor: float
) -> None:
    """Fault: absolute tolerances let a small index stop early and a large one never end."""
    from dualarm_pin.indices import custom
    from dualarm_pin.solvers import interior_point

    def phi(A, u):  # type: ignore[no-untyped-def]
        return factor * np.dot(u, np.dot(A, u))

    def gradient(A, u):  # type: ignore[no-untyped-def]
        return factor * np.outer(u, u)

    def curvature(A, u, D):  # type: ignore[no-untyped-def]
        return np.zeros((6, 6))

    index = custom("scaled", phi, gradient, curvature)
    problem = replace(task, index=index, smoothness=3.0 * factor).problem()
    plain = task.problem()
    start = np.tile((plain.lower + plain.upper) / 2.0, (31, 1))
    expected = interior_point.solve(plain, start)
    got = interior_point.solve(problem, start)
    assert expected.converged
    assert got.converged
    assert got.objective == pytest.approx(factor * expected.objective, rel=1e-6)
    assert problem.size == 1.0 or problem.scaled().size == 1.0
