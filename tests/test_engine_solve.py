"""The interior point on the paper's task and on hard cases."""

from __future__ import annotations

import itertools
import warnings
from dataclasses import replace

import numba
import numpy as np
import pinocchio as pin
import pytest
from engine_cases import (
    TABLE_I,
    BareCell,
    ns16_cell,
    paper_problem,
    random_pair,
    random_problem,
)

from dualarm_pin import indices
from dualarm_pin.engine.batch import Batch
from dualarm_pin.engine.evaluation import evaluate
from dualarm_pin.engine.interior_point.line_search import Merit, remember
from dualarm_pin.engine.room import new_room
from dualarm_pin.engine.solve import Options, solve, solve_many
from dualarm_pin.engine.workspace import FILTER_SIZE
from dualarm_pin.errors import EngineError, InputError, ShapeError
from dualarm_pin.evidence.curvature import curvature_min
from dualarm_pin.evidence.kkt import stationarity
from dualarm_pin.problem import Problem
from dualarm_pin.solution import distinct
from dualarm_pin.solvers import interior_point

MIDDLE = 15
LOWER, UPPER = np.tile(TABLE_I[:, 0], 2), np.tile(TABLE_I[:, 1], 2)


@pytest.fixture(scope="module")
def paper():
    return paper_problem()


@pytest.fixture(scope="module")
def anchor(paper):
    """The best posture of the middle point alone, from a hundred starts."""
    starts = np.random.default_rng(0).uniform(LOWER, UPPER, (100, 1, 12))
    batch = solve_many(paper, starts, jobs=1, points=np.full(100, MIDDLE))
    assert batch.converged.mean() > 0.7
    cost = np.where(batch.feasible, batch.objective, np.inf)
    return batch.q[np.argmin(cost), 0]


@pytest.fixture(scope="module")
def best(paper, anchor):
    return solve(paper, np.tile(anchor, (31, 1)))


def kkt(data, outcome):
    """Return the largest KKT residual of an outcome, from its own multipliers."""
    at = evaluate(data, outcome.q)
    found = outcome.multipliers
    slope = at.gradient + np.einsum("ir,irk->ik", found.equalities, at.jacobian)
    slope -= np.einsum("ir,irk->ik", found.inequalities, at.row_jacobian)
    slope += found.upper - found.lower
    slack = [outcome.q - data.bounds.lower, data.bounds.upper - outcome.q, at.gap]
    pressed = zip([found.lower, found.upper, found.inequalities], slack, strict=True)
    unmet = max(np.abs(z * s).max(initial=0.0) for z, s in pressed)
    below = np.max(-at.gap, initial=0.0)
    return max(np.abs(slope).max(), np.abs(at.residual).max(), below, unmet)


def test_paper_reaches_best_known(paper, best):
    assert best.message == "converged"
    polished = solve(paper, best.q, Options.warm(1e-10), warm=best.multipliers)
    assert polished.converged
    assert polished.objective == pytest.approx(12.7309, abs=1e-4)
    assert polished.residual < 1e-9
    assert kkt(paper, polished) < 1e-8
    assert (polished.q >= data_bounds(paper)[0]).all()
    assert (polished.q <= data_bounds(paper)[1]).all()
    assert polished.objective == pytest.approx(evaluate(paper, polished.q).objective, abs=1e-12)


def data_bounds(data):
    return data.lower, data.upper


def test_six_points_of_the_paper():
    problem = paper_problem().subset([0, 6, 12, 18, 24, 30], 1.5)
    starts = np.random.default_rng(1).uniform(LOWER, UPPER, (60, 1, 12)).repeat(6, axis=1)
    batch = solve_many(problem, starts, jobs=2)
    assert batch.feasible.mean() > 0.6
    assert batch.objective[batch.feasible].min() > 4.0377


def test_batch_is_the_same_for_any_number_of_jobs(paper):
    starts = np.random.default_rng(3).uniform(LOWER, UPPER, (24, 1, 12)).repeat(31, axis=1)
    one, four = solve_many(paper, starts, jobs=1), solve_many(paper, starts, jobs=4)
    assert np.array_equal(one.q, four.q)
    assert np.array_equal(one.status, four.status)
    alone = solve(paper, starts[7])
    assert np.array_equal(alone.q, one[7].q)
    assert alone.objective == one[7].objective


def test_the_last_digit_does_not_depend_on_where_arrays_lie(paper, best):
    room, ends = np.zeros(160), set()
    link = room[70:82].reshape(1, 12)
    for at in (*range(0, 59, 2), *range(82, 148, 2)):
        metric = room[at : at + 12].reshape(1, 12)
        one = paper.subset([17], 3.0, before=best.q[16])
        metric[:] = one.links.metric
        one = replace(one, links=one.links._replace(metric=metric))
        for start in np.random.default_rng(0).uniform(-0.2, 0.2, (10, 1, 12)):
            batch = Batch(one, (best.q[17] + start)[None])
            work = new_room(one)._replace(link=link)
            batch.run(one, work, np.array([0]), Options(iterations=7).settings())
            ends.add((start.tobytes(), batch.q.tobytes()))
    assert len(ends) == 10


def test_interrupted_batch_keeps_what_is_finished(paper):
    starts = np.random.default_rng(3).uniform(LOWER, UPPER, (8, 1, 12)).repeat(31, axis=1)
    stop = np.ones(1, dtype=np.int64)
    batch = solve_many(paper, starts, jobs=2, interrupt=stop)
    assert batch.interrupted
    assert not batch.ran.any()
    assert not batch.feasible.any()
    assert batch[0].message == "not run"


def test_windows_are_problems_of_their_own(paper, best):
    """A window from the middle has its own links, and no neighbours but the path's."""
    ends = paper.subset(range(31), [2.0] + [3.0] * 30, before=best.q[0] + 0.1)
    starts = best.q[None, 4:10]
    inside = solve_many(ends, starts, points=[4])[0]
    alone = paper.subset(range(4, 10), 3.0)
    assert np.array_equal(inside.q, solve(alone, starts[0]).q)
    first = solve_many(ends, best.q[None, :6], points=[0])[0]
    free = solve_many(paper, best.q[None, :6], points=[0])[0]
    assert np.abs(first.q - free.q).max() > 1e-3


def test_a_window_is_a_view(paper):
    window = paper.window(4, 6)
    for record in ("points", "links", "inequalities", "equalities"):
        for name in ("position", "u", "weight", "kind"):
            whole = getattr(getattr(paper, record), name, None)
            if whole is not None and whole.size:
                assert np.shares_memory(getattr(getattr(window, record), name), whole)


def test_every_start_may_have_neighbours_of_its_own(paper, best):
    """One point between two fixed ones, as in (eq. 20), many in one batch."""
    rng = np.random.default_rng(2)
    beside = best.q[[6, 8]] + rng.uniform(-0.05, 0.05, (5, 2, 12))
    batch = solve_many(
        paper, np.repeat(best.q[None, 7:8], 5, axis=0), points=[7] * 5, neighbours=beside, jobs=2
    )
    for end, (before, after) in zip(range(5), beside, strict=True):
        alone = solve(paper.subset([7], 3.0, before=before, after=after), best.q[7:8])
        assert np.array_equal(batch[end].q, alone.q)


def test_fixed_neighbours_are_links(paper, best):
    """The inner points of the best path, its ends fixed, are optimal too (eq. 20)."""
    inner = solve(paper, best.q, Options.warm(1e-9), warm=best.multipliers)
    data = paper.subset(range(7, 12), 3.0, before=inner.q[6], after=inner.q[12])
    rng = np.random.default_rng(0)
    again = solve(data, inner.q[7:12] + rng.uniform(-0.05, 0.05, (5, 12)), Options(1e-9))
    assert again.converged
    assert np.abs(again.q - inner.q[7:12]).max() < 1e-5


def test_linear_term_moves_the_optimum(paper, best):
    """Envelope theorem: d(optimum) / d(theta) along a direction is sum(direction * q)."""
    direction = np.zeros((31, 12))
    direction[10] = np.random.default_rng(0).normal(size=12)
    base = solve(paper, best.q, Options.warm(1e-10), warm=best.multipliers)
    step = 1e-4
    tilted = [
        solve(
            paper_problem(linear=sign * step * direction),
            base.q,
            Options.warm(1e-10),
            warm=base.multipliers,
        )
        for sign in (1, -1)
    ]
    slope = (tilted[0].objective - tilted[1].objective) / (2 * step)
    assert slope == pytest.approx(np.sum(direction * base.q), rel=1e-5)


def test_warm_start_after_moving_the_base(paper, best):
    """One centimetre: few iterations, and the same optimum as from cold."""
    moved = pin.SE3(np.eye(3), np.array([0.01, 0.0, 0.0]))
    turned = pin.SE3(pin.utils.rotate("z", np.pi), np.array([2.5, 0, 0]))
    data = paper_problem(cell=ns16_cell(moved * turned))
    warm = solve(data, best.q, warm=best.multipliers)
    cold = solve(data, best.q)
    assert warm.converged
    assert warm.iterations <= 15
    assert warm.objective == pytest.approx(cold.objective, abs=1e-4)
    assert abs(warm.objective - best.objective) > 1e-3


def test_fixed_variable_stays_and_counts(paper, anchor):
    """Equal bounds hold a joint exactly, and its column still counts in the index."""
    lower, upper = LOWER.copy(), UPPER.copy()
    lower[5] = upper[5] = anchor[5]
    lower[8] = upper[8] = anchor[8] + 0.05
    data = paper_problem(lower=lower, upper=upper)
    outcome = solve(data, np.tile(anchor, (31, 1)))
    assert outcome.converged
    assert np.array_equal(outcome.q[:, 5], np.full(31, anchor[5]))
    assert np.array_equal(outcome.q[:, 8], np.full(31, anchor[8] + 0.05))
    J = evaluate(data, outcome.q).J_r
    c = np.einsum("ir,irk->ik", data.points.u, J)
    values = evaluate(data, outcome.q).values
    assert values == pytest.approx((c**2).sum(axis=1))


def test_free_spin_and_position_only_are_cheaper(paper, best):
    for rows, below in ((5, best.objective), (3, best.objective)):
        data = paper_problem(pose_rows=np.full(31, rows))
        outcome = solve(data, best.q)
        assert outcome.converged
        assert outcome.objective < below - 0.1
    mixed = solve(paper_problem(pose_rows=np.tile([6, 5, 3], 11)[:31]), best.q)
    assert mixed.converged
    assert mixed.objective < best.objective


@pytest.mark.parametrize("angle", [np.pi, np.pi - 1e-6, -np.pi])
@pytest.mark.parametrize("rows", [6, 5])
def test_a_start_that_faces_the_wrong_way(rows, angle):
    """A tool turned by half a turn is not a trap."""
    model = pin.Model()
    parent = 0
    for number, joint in enumerate(
        [pin.JointModelPX(), pin.JointModelPY(), pin.JointModelPZ(), pin.JointModelRZ(),
         pin.JointModelRY(), pin.JointModelRX()]
    ):  # fmt: skip
        parent = model.addJoint(parent, joint, pin.SE3.Identity(), f"j{number}")
    e2 = model.addFrame(pin.Frame("tip", parent, pin.SE3.Identity(), pin.FrameType.BODY))
    data = Problem.of(
        BareCell(model, 0, e2),
        indices.force(),
        [[0.1, 0.2, 0.3]],
        [np.eye(3)],
        pose_rows=[rows],
        lower=np.full(6, -7.0),
        upper=np.full(6, 7.0),
    )
    start = np.array([[0.1, 0.2, 0.3, 0.0, 0.01, angle]])
    outcome = solve(data, start)
    assert outcome.converged
    assert outcome.residual < 1e-7


def test_one_point_without_freedom_left():
    """Six joints, six rows: nothing to choose, the inverse kinematics is found."""
    model, e1, e2 = random_pair(8, (3, 3), prismatic=0.0)
    rng = np.random.default_rng(0)
    q = rng.uniform(-1, 1, 6)
    data = model.createData()
    pin.framesForwardKinematics(model, data, q)
    T = data.oMf[e1].actInv(data.oMf[e2])
    stated = Problem.of(
        BareCell(model, e1, e2),
        indices.force(),
        T.translation[None],
        T.rotation[None],
        u=[[1, 0, 0, 0, 0, 0]],
        lower=np.full(6, -2.0),
        upper=np.full(6, 2.0),
    )
    outcome = solve(stated, q[None] + rng.uniform(-0.2, 0.2, (1, 6)))
    assert outcome.converged
    assert np.abs(outcome.q - q).max() < 1e-5


@pytest.mark.parametrize("joints", [(2, 2), (0, 3), (1, 0)])
def test_fewer_joints_than_rows(joints):
    """Over-determined: right where the pose can be met, infeasible where it cannot."""
    model, e1, e2 = random_pair(9, joints, prismatic=0.0)
    q = np.random.default_rng(0).uniform(-1, 1, model.nv)
    data = model.createData()
    pin.framesForwardKinematics(model, data, q)
    T = data.oMf[e1].actInv(data.oMf[e2])

    def stated(shift):
        return Problem.of(
            BareCell(model, e1, e2),
            indices.force(),
            (T.translation + np.array([0, 0, shift]))[None],
            T.rotation[None],
            u=[[1, 0, 0, 0, 0, 0]],
            lower=np.full(model.nv, -2.0),
            upper=np.full(model.nv, 2.0),
        )

    start = q[None] + 0.1
    met = solve(stated(0.0), start)
    assert met.residual < 1e-6
    assert met.converged
    missed = solve(stated(5.0), start)
    assert missed.message == "infeasible"
    assert missed.residual > 0.1
    assert np.isfinite(missed.q).all()


@pytest.mark.parametrize("iterations", [5, 150])
def test_unreachable_target_is_infeasible(paper, anchor, iterations):
    """Also where the cap on iterations comes first: an unreachable path does not ask for more."""
    far = paper.points.position + np.array([0.0, 0.0, 9.0])
    outcome = solve(
        paper.with_points(position=far), np.tile(anchor, (31, 1)), Options(iterations=iterations)
    )
    assert outcome.message == "infeasible"
    assert outcome.residual > 1.0
    assert np.isfinite(outcome.q).all()
    assert np.isfinite(outcome.objective)


def test_singular_start_and_repeated_points(paper, anchor):
    """All joints at zero is singular; points that coincide are points like others."""
    data = paper.subset([0, 0, 0, 1, 1, 30], 3.0)
    outcome = solve(data, np.zeros((6, 12)))
    assert np.isfinite(outcome.q).all()
    assert outcome.objective == pytest.approx(evaluate(data, outcome.q).objective)
    repeated = solve(data, np.tile(anchor, (6, 1)))
    assert repeated.converged
    assert np.abs(repeated.q[0] - repeated.q[2]).max() < 0.2


def test_iteration_limit_reports_the_residual_of_the_last_iterate(paper, anchor):
    outcome = solve(paper, np.tile(anchor, (31, 1)), Options(iterations=3))
    assert outcome.message == "iteration limit"
    assert outcome.iterations == 3
    assert outcome.residual == np.abs(evaluate(paper, outcome.q).residual).max()
    none = solve(paper, np.tile(anchor, (31, 1)), Options(iterations=0))
    assert none.residual == np.abs(evaluate(paper, none.q).residual).max()


@pytest.mark.parametrize("seed", range(6))
def test_random_problems_end_with_true_numbers(seed):
    """Whatever happens, what is reported is what is true at the q returned."""
    data = random_problem(seed, indices.force())
    start = np.random.default_rng(seed).uniform(-1, 1, (4, len(data.lower)))
    outcome = solve(data, start)
    at = evaluate(data, outcome.q)
    assert np.isfinite(outcome.q).all()
    assert (outcome.q >= data.lower).all()
    assert (outcome.q <= data.upper).all()
    assert outcome.residual == pytest.approx(np.abs(at.residual).max(), abs=1e-12)
    assert outcome.objective == pytest.approx(at.objective, abs=1e-9)
    assert outcome.converged == (kkt(data, outcome) < 1e-4)


@pytest.mark.parametrize(
    "index",
    [
        indices.velocity(task_weights=[1, 1, 1, 0.1, 0.1, 0.1]),
        indices.yoshikawa(task_weights=[1, 1, 1, 0.1, 0.1, 0.1]),
        indices.force(joint_centre=0.1),
    ],
    ids=lambda i: i.name,
)
def test_other_indices_are_solved(index):
    data = paper_problem(index)
    starts = np.random.default_rng(1).uniform(LOWER, UPPER, (8, 1, 12)).repeat(31, axis=1)
    batch = solve_many(data, starts)
    assert batch.converged.sum() >= 4
    outcome = solve(data, starts[int(np.argmax(batch.converged))])
    assert kkt(data, outcome) < 1e-5


def test_user_index_in_numba_and_in_python(anchor):
    """An index that numba cannot compile runs as Python and gives the same answer."""
    written = indices.force()
    names: dict[str, float] = {}

    def slow(A, u):
        names.setdefault("calls", 0.0)  # a dictionary of the outer scope: not for numba
        return float(u @ A @ u)

    plain = indices.custom("plain", written.phi)
    data = paper_problem(plain, points=(3, 1, 3))
    start = np.tile(anchor, (7, 1))
    expected = solve(paper_problem(points=(3, 1, 3)), start)
    assert solve(data, start).objective == pytest.approx(expected.objective, abs=1e-5)
    python = indices.custom("slow", slow, written.gradient, written.curvature)
    data = paper_problem(python, points=(3, 1, 3))
    with pytest.warns(UserWarning, match="'slow' cannot be compiled and runs as Python"):
        solve(data, start)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert solve(data, start).objective == pytest.approx(expected.objective, abs=1e-9)


def test_messages(paper):
    with pytest.raises(ShapeError, match=r"start: has shape \(2, 12\), not \(31, 12\)"):
        solve(paper, np.zeros((2, 12)))
    with pytest.raises(InputError, match=r"start: is not finite at \[3, 4\]"):
        start = np.zeros((31, 12))
        start[3, 4] = np.nan
        solve(paper, start)
    with pytest.raises(InputError, match="position: is not finite"):
        Problem.of(
            paper.cell, indices.force(), [[np.nan, 0, 0]], np.eye(3), lower=LOWER, upper=UPPER
        )
    with pytest.raises(InputError, match=r"lower: column 2 has lower bound .* above"):
        paper_problem(lower=np.where(np.arange(12) == 2, 3.0, LOWER))
    with pytest.raises(InputError, match=r"pose_rows: has \[4, 6\]: allowed are 6, 5 and 3"):
        paper_problem(pose_rows=[4] + [6] * 30)
    with pytest.raises(InputError, match=r"points: 2 points from 30 \.\. 30 leave the path"):
        solve_many(paper, np.zeros((1, 2, 12)), points=[30])
    with pytest.raises(InputError, match=r"tolerance: is 0\.0, must be above 0"):
        solve(paper, np.zeros((31, 12)), Options(tolerance=0.0))


def test_no_starts_are_no_error(paper):
    """Fault: a batch without starts raised a bare ValueError."""
    ends = solve_many(paper, np.zeros((0, 31, 12)))
    assert len(ends) == 0
    assert not ends.interrupted


def test_a_point_of_weight_0_asks_nothing_of_the_index(anchor):
    """Fault: its value was skipped but its derivatives were not, and 0 times nan is nan."""
    undefined = indices.custom(
        "undefined",
        lambda A, u: np.nan,
        lambda A, u: np.full((6, 6), np.nan),
        lambda A, u, D: np.full((6, 6), np.nan),
    )
    problem = paper_problem(undefined, points=(3, 1, 3)).with_points(index_weight=np.zeros(7))
    at = evaluate(problem, np.tile(anchor, (7, 1)))
    assert np.isfinite(at.objective)
    assert np.isfinite(at.gradient).all()
    assert np.isfinite(at.hessian).all()
    assert solve(problem, np.tile(anchor, (7, 1))).converged


def test_what_is_returned_is_the_best_so_far(paper, anchor):
    """Fault: a solve that was cut off or stalled returned its last point, not its best."""
    start = np.tile(anchor + 0.2, (31, 1))
    caps = range(40)
    ends = [solve(paper, start, Options(tolerance=1e-12, iterations=cap)) for cap in caps]
    off_path = [np.abs(evaluate(paper, end.q).residual).sum() for end in ends]
    assert all(b <= a for a, b in itertools.pairwise(off_path) if b > 1e-6)
    on_path = [end.objective for end, away in zip(ends, off_path, strict=True) if away <= 1e-6]
    assert len(on_path) > 3
    assert all(b <= a for a, b in itertools.pairwise(on_path))


def test_a_saddle_is_no_minimum(paper):
    """Fault: stationary points with a direction that leads down were counted as minima."""
    problem = paper.window(MIDDLE, 1)
    starts = np.random.default_rng(0).uniform(LOWER, UPPER, (400, 1, 12))
    ends = solve_many(problem, starts)
    saddles = np.flatnonzero(ends.converged & ends.saddle)
    assert 0 < len(saddles) < 0.2 * len(ends)
    minima = distinct(ends)
    assert (minima.label[saddles] == -1).all()
    for end in saddles[:5]:
        q = ends.q[end]
        lowest, _ = curvature_min(problem, q, stationarity(problem, q))
        assert lowest < -1e-6
    for q in minima.ends.q[:10]:
        lowest, _ = curvature_min(problem, q, stationarity(problem, q))
        assert lowest is None or lowest > -1e-6


def test_a_full_filter_takes_the_newest_pair():
    """Fault: pairs past the 500th were dropped."""

    @numba.njit
    def add(pairs, filtered, violation, value):
        return remember(pairs, filtered, 0.0, Merit(value, 0.0, violation))

    pairs, filtered = np.zeros((FILTER_SIZE, 2)), 0
    for number in range(FILTER_SIZE + 1):
        filtered = add(pairs, filtered, 1.0 + number, float(number))
    assert filtered == FILTER_SIZE
    assert pairs[:, 1].max() == pytest.approx(FILTER_SIZE, rel=1e-4)
    assert pairs[:, 0].max() == pytest.approx(FILTER_SIZE + 1, rel=1e-4)


def test_an_engine_that_disagrees_with_pinocchio_is_not_used(monkeypatch):
    """Fault: the engine was not compared with Pinocchio when a cell was first solved."""
    problem = paper_problem()
    chain = problem.chain._replace(translation=problem.chain.translation + 1e-6)
    with pytest.raises(EngineError, match="the engine and Pinocchio differ by"):
        interior_point.solve(replace(problem, chain=chain), np.zeros((31, 12)))
    assert interior_point.solve(problem, np.zeros((31, 12))).iterations > 0
