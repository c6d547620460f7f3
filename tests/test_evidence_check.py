"""The local check against independent computations on small problems."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from evidence_cases import minima_of_six, six_points, whole
from numpy.typing import NDArray
from scipy.linalg import null_space

from dualarm_pin.answer.evidence import LocalCheck
from dualarm_pin.evidence import check
from dualarm_pin.evidence.check import check_minimum, near, polished
from dualarm_pin.evidence.curvature import curvature_min
from dualarm_pin.evidence.kkt import Stationarity, _signed_multipliers, stationarity
from dualarm_pin.problem import Problem
from dualarm_pin.reference import equalities
from dualarm_pin.relative import Relative
from dualarm_pin.solvers import interior_point as engine

Array = NDArray[np.float64]


@pytest.fixture(scope="module")
def best() -> Array:
    return polished(six_points(), minima_of_six().ends.q[0])


def test_a_polished_minimum_is_stationary_and_a_moved_one_is_not(best: Array) -> None:
    problem = six_points()
    first = stationarity(problem, best)
    assert first.residual < 1e-9
    assert first.stationarity < 1e-7
    assert first.objective == pytest.approx(problem.objective(best), rel=1e-12)
    middle = 0.5 * (problem.lower + problem.upper)
    moved = stationarity(problem, best + 1e-3 * (middle - best))
    assert moved.stationarity > 1e-4
    assert moved.residual > 1e-5


def test_multipliers_agree_with_those_of_the_engine(best: Array) -> None:
    problem = six_points()
    first = stationarity(problem, best)
    multipliers = engine.solve(problem, best, near(1e-10)).multipliers
    assert multipliers is not None
    theirs = multipliers.lower + multipliers.upper
    assert np.count_nonzero(first.active) > 0
    assert np.abs(first.bound_multipliers - theirs).max() < 1e-5
    assert first.min_multiplier == pytest.approx(theirs[first.active != 0].min(), abs=1e-5)


def test_multipliers_predict_what_wider_limits_gain(best: Array) -> None:
    problem = six_points()
    _, local = check_minimum(problem, best, seed=0, jobs=1)
    joint = problem.cell.joint_names.index(local.costliest_joint)
    room = np.zeros(problem.n)
    room[joint] = 1e-4
    wider = problem.with_bounds(problem.lower - room, problem.upper + room)
    gain = local.objective - wider.objective(polished(wider, best))
    assert gain == pytest.approx(1e-4 * local.limit_cost[local.costliest_joint], rel=0.02)


def reduced_hessian_by_values(problem: Problem, q: Array, first: Stationarity) -> Array:
    """Return the reduced Hessian by second differences of values of L, no gradient used."""

    def lagrangian(at: Array) -> float:
        value = problem.objective(at)
        for i, q_i in enumerate(at):
            residual = equalities(problem, i, Relative(problem.cell, q_i))[0]
            value += float(first.row_multipliers[i] @ residual)
        return value

    k, n = q.shape
    rows = []
    for i in range(k):
        J = equalities(problem, i, Relative(problem.cell, q[i]))[1]
        held = np.eye(n)[first.active[i] != 0]
        block = np.zeros((len(J) + len(held), k, n))
        block[:, i] = np.vstack([J, held])
        rows.append(block.reshape(len(block), -1))
    basis = null_space(np.concatenate(rows))
    size, step = basis.shape[1], 1e-3
    moves = step * basis.T.reshape(size, k, n)
    H = np.zeros((size, size))
    for a in range(size):
        for b in range(a + 1):
            signs = [(1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)]
            total = sum(w * lagrangian(q + s * moves[a] + t * moves[b]) for s, t, w in signs)
            H[a, b] = H[b, a] = total / (4.0 * step**2)
    return H


@pytest.mark.parametrize("rows", [6, 5, 3])
def test_curvature_agrees_with_differences_of_values(rows: int) -> None:
    problem = six_points().subset([0, 2, 3], 1.5)
    problem = problem.with_points(pose_rows=np.full(3, rows))
    q = polished(problem, minima_of_six().ends.q[0][[0, 2, 3]])
    first = stationarity(problem, q)
    value, size = curvature_min(problem, q, first)
    H = reduced_hessian_by_values(problem, q, first)
    assert size == len(H) > 0
    assert value == pytest.approx(np.linalg.eigvalsh(H)[0], abs=1e-4)


def test_curvature_counts_links_to_fixed_neighbours(best: Array) -> None:
    problem = six_points().subset([1, 2], np.array([2.0, 1.5, 3.0]), best[0] + 0.1, best[3] - 0.1)
    q = polished(problem, best[1:3])
    first = stationarity(problem, q)
    value, _ = curvature_min(problem, q, first)
    expected = np.linalg.eigvalsh(reduced_hessian_by_values(problem, q, first))[0]
    assert value == pytest.approx(expected, abs=1e-4)


def test_smallest_singular_value_and_active_set(best: Array) -> None:
    problem = six_points()
    _, local = check_minimum(problem, best, seed=0, jobs=1)
    free = (best > problem.lower + 1e-6) & (best < problem.upper - 1e-6)
    smallest = min(
        np.linalg.svd(equalities(problem, i, Relative(problem.cell, q))[1][:, free[i]])[1][-1]
        for i, q in enumerate(best)
    )
    assert local.sigma_min == pytest.approx(smallest, rel=1e-6)
    assert local.active_bounds == np.count_nonzero(~free)
    assert local.strict


def test_every_figure_of_the_best_path_known() -> None:
    """The published figures of this minimum were measured with another program."""
    problem = whole()
    seed = minima_of_six().ends.q
    starts = np.array([q[np.minimum((np.arange(31) + 3) // 6, 5)] for q in seed[:40]])
    ends = engine.solve_many(problem, starts, jobs=2)
    q = ends.q[np.argmin(np.where(ends.converged, ends.objective, np.inf))]
    _, local = check_minimum(problem, q, seed=0, jobs=2)
    assert local.objective == pytest.approx(12.7309, abs=2e-4)
    assert (local.active_bounds, local.free_directions) == (98, 88)
    assert local.curvature_min == pytest.approx(0.284, abs=1e-3)
    assert local.min_multiplier == pytest.approx(0.0093, abs=1e-4)
    assert local.sigma_min == pytest.approx(0.2144, abs=1e-3)
    assert local.return_share == 1.0
    assert local.return_radius == 0.2
    assert local.costliest_joint == "arm1/joint_5"
    assert local.limit_cost["arm1/joint_5"] == pytest.approx(22.1, abs=0.1)


def test_a_better_path_nearby_is_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    problem = six_points()
    worse = minima_of_six().ends.q[-1]
    monkeypatch.setattr(check, "SHIFTS", (3.0,))  # far enough to leave any basin
    _, local = check_minimum(problem, worse, seed=1, jobs=2)
    assert local.adopted_from_nearby > 0
    assert local.objective < problem.objective(worse) - 0.01


def test_smaller_shifts_are_tried_where_some_starts_do_not_return(
    best: Array, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(check, "SHIFTS", (3.0, 0.01))
    _, local = check_minimum(six_points(), best, seed=1, jobs=2)
    assert local.adopted_from_nearby == 0
    assert local.return_share < 1.0
    assert local.return_radius == 0.01


def test_the_check_does_not_depend_on_the_number_of_threads(best: Array) -> None:
    one, two = (check_minimum(six_points(), best, seed=3, jobs=jobs) for jobs in (1, 2))
    assert np.array_equal(one[0], two[0])
    assert one[1] == two[1]


def test_a_wrong_sign_from_too_few_free_joints_is_mended() -> None:
    # All three joints at their lower bounds, one pose row: y is free, z = gradient + y J >= 0.
    gradient, J = np.array([-1.0, 1.0, 3.0]), np.array([[1.0, 0.0, -1.0]])
    y, z, left = _signed_multipliers(gradient, J, np.array([-1, -1, -1]), 0)
    assert np.abs(left).max() < 1e-12
    assert z.min() >= 0.0
    assert z == pytest.approx(gradient + y @ J)


def test_a_descent_direction_into_the_box_is_not_stationary() -> None:
    gradient, J = np.array([-1.0, 1.0]), np.zeros((1, 2))
    _, z, left = _signed_multipliers(gradient, J, np.array([-1, -1]), 0)
    assert z == pytest.approx([0.0, 1.0])
    assert left == pytest.approx([-1.0, 0.0])


@pytest.mark.parametrize(
    ("change", "stationary", "minimum", "strict"),
    [
        ({}, True, True, True),
        ({"stationarity": 1e-3}, False, False, False),
        ({"feasibility": 1e-3}, False, False, False),
        ({"min_multiplier": -1e-2}, False, False, False),
        ({"min_multiplier": None}, True, True, True),
        ({"curvature_min": -1e-3}, True, False, False),
        ({"curvature_min": 0.0}, True, True, False),
        ({"curvature_min": None}, True, True, True),
    ],
)
def test_what_counts_as_a_minimum(
    change: dict[str, float | None], stationary: bool, minimum: bool, strict: bool
) -> None:
    sound = LocalCheck(1.0, 0.0, 0.0, 0.1, 1, 0.5, 3, 0.2, 0.2, 1.0)
    local = replace(sound, **change)
    assert (local.stationary, local.minimum, local.strict) == (stationary, minimum, strict)
