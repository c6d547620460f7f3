"""The largest feed as the aim: a public case, and a refinement that only goes up."""

from __future__ import annotations

import numpy as np
import pytest
from answers import answer
from paper_case import TASK

from dualarm_pin.answer.notes import FeedNotes
from dualarm_pin.errors import InputError
from dualarm_pin.feed.programme import FeedProgramme
from dualarm_pin.files.resources import urdf_folder
from dualarm_pin.motion.limits import limits_of
from dualarm_pin.motion.make import make_motion
from dualarm_pin.planners.feed import BUDGETS, FeedBudget
from dualarm_pin.planners.methods import plan
from dualarm_pin.relative import Relative
from dualarm_pin.task import Task
from dualarm_pin.task.motion_spec import ChordSpec

CURVE = urdf_folder() / "tasks" / "curve_1.yaml"
PUBLISHED = 1.2507  # m/s: what joint speeds allow on the path that was published for this case


def test_the_arms_of_the_public_case_stand_where_its_facts_say() -> None:
    cell = Task.load(CURVE).cell
    model, data = cell.model, cell.data()
    import pinocchio as pin

    pin.framesForwardKinematics(model, data, np.zeros(model.nq))
    flange = {
        arm: data.oMf[model.getFrameId(f"{arm}/flange")].translation for arm in ("arm1", "arm2")
    }
    np.testing.assert_allclose(flange["arm2"], [1.6625, 0.0, 2.055], atol=1e-9)
    local = cell.arms[0].base.actInv(pin.SE3(np.eye(3), flange["arm1"])).translation
    np.testing.assert_allclose(local, [0.533, 0.0, 0.8891], atol=1e-9)


def test_the_points_of_the_public_curve_lie_on_its_formula() -> None:
    path = Task.load(CURVE).path
    t, y, z = 1e3 * path.position.T
    np.testing.assert_allclose(y, 30 * np.sin(np.radians(0.54) * t**2 / 1000), atol=1e-6)
    np.testing.assert_allclose(z, 25.4 * (50.8**2 - y**2) / 50.8**2, atol=1e-6)
    axis = np.stack([0 * y, -2 * 25.4 * y / 50.8**2, -np.ones_like(y)], axis=1)
    axis /= np.linalg.norm(axis, axis=1, keepdims=True)
    np.testing.assert_allclose(path.rotation[:, :, 2], axis, atol=1e-6)
    assert path.arc_length[-1] == pytest.approx(1.0277, abs=3e-4)
    assert set(path.rows) == {5}


def test_from_nothing_the_public_curve_is_run_faster_than_published(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setitem(BUDGETS, "quick", FeedBudget(90, 1, 3))
    task = Task.load(CURVE, ["motion.limits=[velocity]"])
    found = plan(task, effort="quick", jobs=1)
    motion = make_motion(task, found)
    assert found.found
    assert isinstance(found.notes, FeedNotes)
    assert motion.summary.feed > 1.2 * PUBLISHED
    assert motion.summary.feed == pytest.approx(found.notes.steady_feed, rel=1e-3)
    speeds = np.abs(np.diff(motion.q, axis=0)) / np.diff(motion.time)[:, None]
    assert np.all(speeds <= limits_of(task.cell).velocity * 1.0001)
    for q, s in zip(motion.q[::40], motion.arc_length[::40], strict=True):
        t, y, z = 1e3 * Relative(task.cell, q).T_e1_e2.translation
        away = [y - 30 * np.sin(np.radians(0.54) * t**2 / 1000)]
        away.append(z - 25.4 * (50.8**2 - y**2) / 50.8**2)
        assert np.abs(away).max() < 0.05, s  # mm


def test_a_refinement_is_on_the_path_and_faster_and_ends() -> None:
    task = Task.load(TASK, ["motion={law: constant_feed}"])
    programme = FeedProgramme(task, limits_of(task.cell), ChordSpec())
    first = make_motion(task, answer()).summary.largest_feed
    q, feed = programme.refine(answer().q, 4)
    assert feed > 1.1 * first
    residual = max(
        np.abs(Relative(task.cell, q[i]).T_e1_e2.translation - task.path.position[i]).max()
        for i in range(31)
    )
    assert residual < 1e-9
    assert np.all((q >= task.cell.lower) & (q <= task.cell.upper))


def test_the_aim_needs_to_know_how_fast_joints_are() -> None:
    task = Task.load(TASK, ["aim=feed", "cell.velocity_deg={}"])
    with pytest.raises(InputError, match="velocity_deg"):
        plan(task)
