"""A design session: the motion follows base, workpiece, weights and limits, and is planned on."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

from dualarm_pin.design import Session, pool
from dualarm_pin.errors import InputError, ShapeError, UnknownNameError
from dualarm_pin.solvers import interior_point as engine


@pytest.fixture
def session(task) -> Session:
    return Session(task)


def test_the_motion_follows_the_base_to_where_another_basin_is_best(task, session):
    assert session.answer.objective == pytest.approx(12.730887, abs=1e-5)
    first = session.answer.basin
    for x in np.linspace(2.5, 3.0, 26):
        answer = session.move(base2_x=x)
        assert answer.valid
    assert answer.basin != first
    assert answer.objective == pytest.approx(13.1956, abs=1e-3)  # a global search there
    moved = session.moved_task()
    assert moved.problem().objective(answer.q) == pytest.approx(answer.objective, rel=1e-8)
    assert answer.search_due
    assert session.search().search_due == ""


def test_in_a_hurry_the_best_is_always_of_now_and_the_others_take_turns(session, monkeypatch):
    solved = []
    solve = pool.solve
    counted = lambda *args, **more: solved.append(1) or solve(*args, **more)  # noqa: E731
    monkeypatch.setattr(pool, "solve", counted)
    first, counts = session.answer.basin, []
    for x in np.linspace(2.5, 3.0, 26):
        solved.clear()
        answer = session.move(base2_x=x, hurried=True)
        counts.append(len(solved))
        there = session.moved_task().problem()
        assert there.objective(answer.q) == pytest.approx(answer.objective, rel=1e-8)
    assert np.median(counts) <= 3 < len(answer.pool)
    assert answer.basin != first
    assert answer.objective == pytest.approx(13.1956, abs=1e-3)
    at_rest = session.move(base2_x=3.0)  # all of them again: none is better
    assert at_rest.objective == pytest.approx(answer.objective, rel=1e-6)


def test_a_pose_moves_the_base_like_its_coordinates_do(session):
    turned = pin.SE3(pin.utils.rotate("z", np.pi - 0.1), np.array([2.45, 0.02, 0.01]))
    by_pose = session.move(turned)
    change = {key: value for key, value in by_pose.change.items() if value}
    assert change == pytest.approx(
        {"base2.x": -0.05, "base2.y": 0.02, "base2.z": 0.01, "base2.yaw": -0.1}
    )
    objective = by_pose.objective
    session.move(base2_x=2.5, base2_y=0.0, base2_z=0.0, base2_yaw=np.pi)
    again = session.move(base2_x=2.45, base2_y=0.02, base2_z=0.01, base2_yaw=np.pi - 0.1)
    assert again.objective == pytest.approx(objective, rel=1e-6)


def test_lambda_and_limits_change_what_is_asked(task, session):
    wider = session.set(limits={"arm1/joint_5": (-np.pi / 2, np.deg2rad(100.0))})
    assert wider.objective == pytest.approx(10.0429, abs=1e-3)
    smooth = session.set(smoothness=30.0)
    problem = task.with_smoothness(30.0).problem()
    upper = problem.upper.copy()
    upper[4] = np.deg2rad(100.0)
    again = engine.solve(problem.with_bounds(problem.lower, upper), smooth.q)
    assert again.objective == pytest.approx(smooth.objective, rel=1e-5)


def test_callbacks_hear_every_answer_and_an_impossible_place_keeps_the_last_valid_motion(session):
    heard = []
    session.callbacks.append(heard.append)
    valid = session.move(base2_x=2.4)
    lost = session.move(base2_x=9.0)
    assert not lost.valid
    assert "search again" in lost.why
    assert (lost.q == valid.q).all()
    assert heard == [valid, lost]
    session.move(base2_x=2.5)
    assert session.search().objective == pytest.approx(12.730887, abs=1e-5)


def test_the_rest_of_the_path_is_planned_from_a_measured_posture(session):
    best, random = session.answer.q, np.random.default_rng(0)
    for _ in range(30):
        measured = best[0] + 0.05 * random.standard_normal(12)
        rest = session.replan(measured, 30)
        assert rest.converged
        assert rest.q.shape == (30, 12)
    # The step from the measured posture counts: what is planned starts nearer to it.
    away = best[10] + 0.1
    near = session.replan(away, 20)
    assert np.linalg.norm(near.q[0] - away) < np.linalg.norm(best[11] - away)


@pytest.mark.parametrize(
    ("call", "error", "message"),
    [
        (lambda s: s.move(base2_w=1.0), UnknownNameError, "no parameter 'base2.w'"),
        (lambda s: s.move(base2_x=np.nan), InputError, "not a finite number"),
        (lambda s: s.move(pin.SE3(pin.utils.rotate("x", 0.1), np.zeros(3))), InputError, "tilted"),
        (lambda s: s.set(limits={"arm1/joint_9": (0, 1)}), UnknownNameError, "no joint"),
        (lambda s: s.set(limits={"arm1/joint_1": (1, 0)}), InputError, "no range"),
        (lambda s: s.set(smoothness=-1.0), InputError, "0 or more"),
        (lambda s: s.replan(np.zeros(12), 40), InputError, "1 to 31"),
        (lambda s: s.replan(np.zeros(11), 30), ShapeError, "posture"),
    ],
)
def test_wrong_calls_are_refused_and_change_nothing(session, call, error, message):
    before = session.answer
    with pytest.raises(error, match=message):
        call(session)
    assert session.answer is before
