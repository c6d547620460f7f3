"""Rows: values and derivatives against Pinocchio and differences, and that they are met."""

from __future__ import annotations

import pickle
from dataclasses import replace

import numpy as np
import pytest
from engine_cases import BareCell, paper_problem, random_pair, random_problem
from numpy.typing import NDArray
from paper_case import world_pose

from dualarm_pin import indices
from dualarm_pin.engine.evaluation import evaluate
from dualarm_pin.engine.solve import solve, solve_many
from dualarm_pin.errors import InputError, UnknownNameError
from dualarm_pin.evidence.curvature import curvature_min
from dualarm_pin.evidence.kkt import stationarity
from dualarm_pin.files.resources import urdf_folder
from dualarm_pin.reference import equalities, inequalities, violation
from dualarm_pin.relative import Relative
from dualarm_pin.rows import Row, above, axis_within, below, capsules, half_space
from dualarm_pin.rows.capsules import nearest_of_segments
from dualarm_pin.solvers import casadi_ipopt, slsqp
from dualarm_pin.task import Task

Array = NDArray[np.float64]


def squared_distance(R: Array, p: Array, parameters: Array) -> float:
    """A row of a user's own: the distance of a point of b from the origin of a, squared."""
    x = p + np.dot(R, parameters[:3])
    return float(np.dot(x, x) - parameters[3])


def squared_distance_slope(R: Array, p: Array, parameters: Array) -> Array:
    arm = np.dot(R, parameters[:3])
    x = p + arm
    slope = np.zeros(6)
    slope[:3] = 2.0 * x
    slope[3], slope[4], slope[5] = (
        2.0 * (arm[1] * x[2] - arm[2] * x[1]),
        2.0 * (arm[2] * x[0] - arm[0] * x[2]),
        2.0 * (arm[0] * x[1] - arm[1] * x[0]),
    )
    return slope


def own(first: str, second: str, **how: object) -> Row:
    number = np.array([0.2, -0.1, 0.3, 0.4])
    how = {"parameters": number, "slope": squared_distance_slope} | how
    return Row("own", first, second, squared_distance, **how)  # type: ignore[arg-type]


PAIRS = [
    ("world", "arm1/tip"),
    ("arm1/tip", "world"),
    ("world", "arm2/tip"),
    ("arm1/tip", "arm2/tip"),
    ("arm2/tip", "arm1/tip"),
    ("arm1/tip", "arm1/tip"),
]
ROWS = {
    "plane": lambda a, b: half_space(b, [0.3, -0.5, 0.8], 0.1, of=a, point=[0.1, 0.2, -0.3]),
    "axis": lambda a, b: axis_within(b, (0.3, 0.5, -0.8), (1, 2, 2), 40.0, seen_from=a),
    "capsules": lambda a, b: capsules(
        b, a, [[0.1, 0.2, -0.3], [0.3, 0.2, 0.5]], [[-0.5, 0.1, 0.2], [0.2, 0.1, -0.2]], 0.1
    ),
    "crossing capsules": lambda a, b: capsules(
        b, a, [[-4, 0.2, -0.3], [5, 0.2, 0.5]], [[0.1, -4, 0.2], [0.2, 5, -0.2]], 0.1
    ),
    "capsule and sphere": lambda a, b: capsules(
        a, b, [[0.1, 0.2, -0.3], [0.3, 0.2, 0.5]], [[0.5, 0.1, 0.2]] * 2, 0.1
    ),
    "own": own,
    "own, by differences": lambda a, b: own(a, b, slope=None),
    "equality": lambda a, b: replace(own(a, b), equality=True),
    "equal planes": lambda a, b: replace(
        half_space(b, [0.3, -0.5, 0.8], 0.1, of=a, point=[0.1, 0.2, -0.3]), equality=True
    ),
}


@pytest.mark.parametrize("pair", PAIRS, ids=" sees ".join)
@pytest.mark.parametrize("make", ROWS.values(), ids=ROWS)
def test_the_engine_has_value_gradient_and_hessian_of_a_row(pair, make) -> None:
    """Rows on a random chain with mimic joints, a fixed one, and prismatic ones."""
    row = make(*pair)
    problem = random_problem(3, indices.force(), rows=(row, above("arm1/tip", 0.1, points=[1])))
    n = problem.n
    q = np.random.default_rng(5).uniform(-1.0, 1.0, (4, n))
    random = np.random.default_rng(6)
    y = random.normal(size=(4, problem.m))
    push = random.normal(size=problem.inequalities.kind.shape)
    at = evaluate(problem, q, y, push)
    for i in range(4):
        relative = Relative(problem.cell, q[i])
        gap, slope = inequalities(problem, i, relative)
        zero, level = equalities(problem, i, relative)
        pose, equal = problem.points.pose_rows[i], problem.equalities.size[i]
        np.testing.assert_allclose(at.gap[i, : len(gap)], gap, atol=1e-12)
        np.testing.assert_allclose(at.row_jacobian[i, : len(gap)], slope, atol=1e-7)
        np.testing.assert_allclose(at.residual[i, pose : pose + equal], zero[pose:], atol=1e-12)
        np.testing.assert_allclose(at.jacobian[i, pose : pose + equal], level[pose:], atol=1e-7)

    def gradient(x: Array) -> Array:
        there = evaluate(problem, x)
        total = there.gradient.copy()
        for i in range(4):
            count = problem.row_count[i]
            total[i] += y[i, :count] @ there.jacobian[i, :count]
            total[i] -= (
                push[i, : problem.inequalities.size[i]]
                @ (there.row_jacobian[i, : problem.inequalities.size[i]])
            )
        return total

    step = 1e-5
    for i in range(4):
        for k in range(n):
            moved = np.zeros_like(q)
            moved[i, k] = step
            expected = (gradient(q + moved) - gradient(q - moved))[i] / (2.0 * step)
            scale = max(1.0, np.abs(expected).max())
            np.testing.assert_allclose(at.hessian[i, :, k], expected, atol=3e-5 * scale)


def test_segments_are_nearest_where_they_are() -> None:
    """Against a fine grid: crossing, end to end, parallel, and with one or two of no length."""
    random, grid = np.random.default_rng(3), np.linspace(0.0, 1.0, 201)
    for case in range(40):
        A, B, a, b = random.normal(size=(4, 3))
        a = {0: 0.0 * a, 1: a, 2: 1.5 * b, 3: 3.0 * a}[case % 4]
        b = b if case % 8 < 4 else 0.0 * b
        s, t, *moves = nearest_of_segments(a @ a, a @ b, b @ b, a @ (A - B), b @ (A - B))
        near = np.linalg.norm(B + t * b - A - s * a)
        every = (B + np.outer(grid, b))[None] - (A + np.outer(grid, a))[:, None]
        assert near <= np.linalg.norm(every, axis=2).min() + 1e-12
        assert all(0.0 < at < 1.0 for at, moved in zip((s, t), moves, strict=True) if moved)


@pytest.mark.parametrize("spin_axis", [[0, 0, 1.0], [0.3, -0.8, 0.5]])
def test_a_row_does_not_see_how_the_spin_axis_turns_the_chain(spin_axis) -> None:
    row = own("arm1/tip", "arm2/tip")
    plain, turned = (
        paper_problem(rows=[row], spin_axis=axis, pose_rows=np.full(31, 5))
        for axis in ([0, 0, 1.0], spin_axis)
    )
    q = np.random.default_rng(0).uniform(plain.lower, plain.upper, (31, 12))
    np.testing.assert_allclose(evaluate(plain, q).gap, evaluate(turned, q).gap, atol=1e-12)


BEST = {None: 12.730887, 0.4: 12.8758, 0.6: 14.8799, 1.0: 17.1269}


@pytest.fixture(scope="module")
def task() -> Task:
    return Task.load(urdf_folder() / "tasks" / "paper_corner.yaml")


@pytest.mark.parametrize("z", BEST)
def test_the_best_known_paths_with_the_first_tip_held_up(task: Task, z: float | None) -> None:
    from dualarm_pin.planners.whole_path import plan_global

    rows = () if z is None else (above("arm1/tip", z),)
    best = plan_global(replace(task, rows=rows), effort="quick", seed=1)
    assert best.found
    assert best.objective == pytest.approx(BEST[z], abs=2e-4)
    lowest = min(world_pose(task, "arm1/tip", q).translation[2] for q in best.q)
    assert z is None or lowest >= z - 1e-6


def test_evidence_reads_the_rows(task: Task) -> None:
    """At the constrained optimum the row holds with a multiplier, and without it no minimum."""
    from dualarm_pin.planners.whole_path import plan_global

    held = replace(task, rows=(above("arm1/tip", 0.6),))
    best = plan_global(held, effort="quick", seed=0)
    problem = held.problem()
    first = stationarity(problem, best.q)
    assert first.stationarity < 1e-6
    assert sum(map(len, first.active_rows)) > 0
    assert first.min_multiplier is not None
    assert first.min_multiplier > -1e-6
    curvature, _ = curvature_min(problem, best.q, first)
    assert curvature is not None
    assert curvature > 0.0
    free = stationarity(task.problem(), best.q)
    assert free.stationarity > 1e-2


@pytest.mark.parametrize("equality", [False, True])
def test_nlopt_and_casadi_read_the_same_row(task: Task, equality: bool) -> None:
    row = replace(above("arm1/tip", 0.5), equality=equality)
    problem = replace(task, rows=(row,)).problem().subset([0, 15, 30], 1.5)
    middle = problem.window(1, 1)
    starts = np.random.default_rng(1).uniform(problem.lower, problem.upper, (40, 1, 12))
    ends = solve_many(middle, starts)
    at = int(np.argmin(np.where(ends.converged, ends.objective, np.inf)))
    start = np.tile(ends.q[at], (3, 1))
    ours = solve(problem, start)
    assert ours.converged
    assert violation(problem, ours.q) < 1e-6
    theirs = slsqp.solve(problem, ours.q)
    assert theirs.feasible
    assert theirs.objective == pytest.approx(ours.objective, rel=1e-5)
    pytest.importorskip("casadi")
    referee = casadi_ipopt.solve(problem, ours.q)
    assert referee.converged
    assert referee.objective == pytest.approx(ours.objective, rel=1e-5)
    structured = casadi_ipopt.solve(problem, ours.q, "fatrop")
    assert structured.objective == pytest.approx(ours.objective, rel=1e-4)


def test_a_row_that_cannot_hold_is_infeasible(task: Task) -> None:
    problem = replace(task, rows=(above("arm1/tip", 9.0),)).problem()
    end = solve(problem, np.tile((problem.lower + problem.upper) / 2.0, (31, 1)))
    assert end.message == "infeasible"
    assert not end.feasible


def test_a_row_at_some_points_leaves_the_others_alone(task: Task) -> None:
    problem = replace(task, rows=(below("arm1/tip", 0.2, points=[3, 4]),)).problem()
    assert problem.inequalities.size.tolist() == [int(i in (3, 4)) for i in range(31)]
    assert problem.window(3, 1).inequalities.size.tolist() == [1]
    assert problem.subset([0, 4], 1.0).inequalities.size.tolist() == [0, 1]


def test_wrong_rows_are_refused(task: Task) -> None:
    with pytest.raises(UnknownNameError, match=r"no frame 'arm1/tipp'.*did you mean 'arm1/tip'"):
        replace(task, rows=(above("arm1/tipp", 0.1),)).problem()
    with pytest.raises(InputError, match=r"point 32 does not exist: the path has points 1 to 31"):
        replace(task, rows=(above("arm1/tip", 0.1, points=[31]),)).problem()
    with pytest.raises(InputError, match="normal"):
        half_space("arm1/tip", [0, 0, 0], 0.1)
    with pytest.raises(InputError, match="offset: a finite number"):
        above("arm1/tip", np.nan)
    with pytest.raises(InputError, match="phi: is 3, must be a function"):
        Row("three", "world", "arm1/tip", 3)  # type: ignore[arg-type]


def test_a_frame_below_a_common_joint_is_refused() -> None:
    import pinocchio as pin

    model, e1, e2 = random_pair(4, (3, 3), prismatic=0.0)
    torso = pin.Model()
    first = torso.addJoint(0, pin.JointModelRZ(), pin.SE3.Identity(), "torso")
    whole, tips = torso, []
    for frame in (e1, e2):
        parent = first
        for joint in model.supports[model.frames[frame].parentJoint].tolist()[1:]:
            place = model.jointPlacements[joint]
            parent = whole.addJoint(parent, model.joints[joint], place, f"{joint}")
        tips.append(
            whole.addFrame(pin.Frame(f"tip{frame}", parent, pin.SE3.Identity(), pin.FrameType.BODY))
        )
    cell = BareCell(whole, *tips)
    with pytest.raises(InputError, match="common torso that was set free"):
        paper_problem(
            cell=cell,
            rows=[above("arm1/tip", 0.1)],
            lower=np.full(7, -1.0),
            upper=np.full(7, 1.0),
        )


def test_a_problem_with_rows_can_be_sent_to_another_process(task: Task) -> None:
    problem = replace(task, rows=(above("arm2/tip", 0.3),)).problem()
    again = pickle.loads(pickle.dumps(problem))
    q = np.random.default_rng(0).uniform(problem.lower, problem.upper, (31, 12))
    assert violation(again, q) == violation(problem, q)
