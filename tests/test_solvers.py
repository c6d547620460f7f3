"""Solvers on a table of problems with known answers; a solution judges itself."""

from __future__ import annotations

import nlopt
import numpy as np
import pytest
from numpy.typing import NDArray

from dualarm_pin.problem import Problem
from dualarm_pin.reference import equalities, objective_and_gradient, violation
from dualarm_pin.relative import Relative
from dualarm_pin.solution import Solutions, distinct
from dualarm_pin.solvers import interior_point as engine
from dualarm_pin.solvers import slsqp as nlopt_slsqp
from dualarm_pin.solvers.projection import project, project_point
from dualarm_pin.solvers.slsqp import SlsqpOptions

Array = NDArray[np.float64]
SOLVERS = {"nlopt": nlopt_slsqp.solve, "engine": engine.solve}


@pytest.fixture(scope="module")
def posture(problem: Problem) -> Array:
    """A posture at the first point, from which the whole path can be reached."""
    random = np.random.default_rng(0)
    while True:
        q, residual = project_point(problem, 0, random.uniform(problem.lower, problem.upper))
        along = project(problem, np.tile(q, (problem.k, 1)))
        if residual < 1e-9 and along[1] < 1e-9:
            return q


@pytest.mark.parametrize("solve", SOLVERS.values(), ids=SOLVERS)
def test_a_solution_is_on_the_path_within_bounds_and_stationary(
    problem: Problem, posture: Array, solve: object
) -> None:
    part = problem.subset([0, 6, 12], 1.5)
    solution = solve(part, np.tile(posture, (3, 1)))  # type: ignore[operator]
    assert solution.feasible
    assert violation(part, solution.q) <= 1e-7
    assert np.all(solution.q >= part.lower)
    assert np.all(solution.q <= part.upper)
    assert solution.objective == pytest.approx(part.objective(solution.q), rel=1e-9)
    # No step along the path constraints, away from active bounds, goes downhill.
    gradient = objective_and_gradient(part, solution.q)[1]
    for i, q in enumerate(solution.q):
        J = equalities(part, i, Relative(part.cell, q))[1]
        margin = 1e-4
        free = (q > part.lower + margin) & (q < part.upper - margin)
        y = np.linalg.lstsq(J[:, free].T, gradient[i][free], rcond=None)[0]
        assert np.abs(gradient[i][free] - J[:, free].T @ y).max() < 2e-3


def test_both_solvers_find_one_minimum_from_one_start(problem: Problem, posture: Array) -> None:
    part = problem.subset([0, 6, 12, 18], 1.5)
    start = np.tile(posture, (4, 1))
    first = nlopt_slsqp.solve(part, start, SlsqpOptions(evaluations=1000))
    second = engine.solve(part, first.q)
    assert second.objective == pytest.approx(first.objective, rel=1e-5)
    assert np.abs(first.q - second.q).max() < 0.02


def test_fixed_neighbours_pull_the_solution(problem: Problem, posture: Array) -> None:
    ends = [project_point(problem, i, posture)[0] for i in (0, 4)]
    part = problem.subset([1, 2, 3], 300.0, before=ends[0], after=ends[1])
    loose = problem.subset([1, 2, 3], 0.0, before=ends[0], after=ends[1])
    start = np.linspace(*ends, 5)[1:-1]
    tight = nlopt_slsqp.solve(part, start).q
    free = nlopt_slsqp.solve(loose, start).q
    assert np.abs(tight - start).max() < np.abs(free - start).max()


def test_an_unreachable_pose_is_not_feasible(problem: Problem, posture: Array) -> None:
    far = problem.subset([0], 0.0).with_points(position=[[9.0, 0.0, 0.0]])
    for solve in SOLVERS.values():
        solution = solve(far, posture[None])
        assert not solution.feasible
        assert solution.residual > 1.0
        assert np.isfinite(solution.q).all()


def test_ctrl_c_inside_nlopt_is_not_swallowed(
    problem: Problem, posture: Array, monkeypatch: pytest.MonkeyPatch
) -> None:
    def stop(*args: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(nlopt_slsqp, "point_gradient", stop)
    with pytest.raises(KeyboardInterrupt):
        nlopt_slsqp.solve(problem.subset([0], 0.0), posture[None])


def test_the_end_of_a_start_does_not_depend_on_the_clock(
    problem: Problem, posture: Array, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A slow or busy machine ends at the same point: evaluations alone are counted."""
    limits: list[float] = []

    class Watched(nlopt.opt):
        def set_maxtime(self, seconds: float) -> None:
            limits.append(seconds)

    monkeypatch.setattr(nlopt, "opt", Watched)
    part = problem.subset([0, 6, 12], 1.5)
    options = SlsqpOptions(evaluations=7)
    solution = nlopt_slsqp.solve(part, np.tile(posture, (3, 1)), options)
    assert limits == []
    assert solution.iterations <= 7
    assert solution.message == "evaluation limit"
    assert not solution.converged


def test_the_projection_stays_within_bounds(problem: Problem) -> None:
    random = np.random.default_rng(1)
    reached = 0
    for _ in range(20):
        q, residual = project_point(problem, 5, random.uniform(problem.lower, problem.upper))
        assert np.all((q >= problem.lower) & (q <= problem.upper))
        reached += residual < 1e-9
    assert reached >= 10


def ends_of(q: Array, objective: Array, converged: list[bool] | None = None) -> Solutions:
    ok = np.ones(len(q), bool) if converged is None else np.array(converged)
    none = np.zeros(len(q), np.int64)
    no_saddle = np.zeros(len(q), bool)
    return Solutions(q[:, None], objective, np.zeros(len(q)), ok, ok, none, no_saddle, none)


def test_mirror_twins_are_two_minima() -> None:
    q = np.array([[0.5, 1.0], [-0.5, 1.0], [0.5, 1.001]])
    minima = distinct(ends_of(q, np.array([2.0, 2.0, 2.0 + 1e-6])))
    assert len(minima) == 2
    assert sorted(minima.hits) == [1, 2]
    assert minima.label.tolist()[0] == minima.label.tolist()[2]


def test_an_objective_apart_is_another_minimum_and_failures_count_for_none() -> None:
    q = np.zeros((3, 2))
    minima = distinct(ends_of(q, np.array([2.0, 2.1, 1.0]), [True, True, False]))
    assert len(minima) == 2
    assert minima.ends.objective.tolist() == [2.0, 2.1]
    assert minima.label.tolist() == [0, 1, -1]
