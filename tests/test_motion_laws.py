"""A motion keeps every limit and the path; what cannot be done is said in one sentence."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from answers import answer
from paper_case import TASK

from dualarm_pin.errors import InputError
from dualarm_pin.motion import Motion
from dualarm_pin.motion.limits import limits_of
from dualarm_pin.motion.make import make_motion
from dualarm_pin.motion.text import motion_text
from dualarm_pin.relative import Relative
from dualarm_pin.task import Task

JERK = (
    "cell.jerk_deg_s3={joint_1: 3000, joint_2: 3000, joint_3: 3000, "
    "joint_4: 9000, joint_5: 9000, joint_6: 9000}"
)
TORQUE = (
    "cell.torque={joint_1: 2000, joint_2: 3000, joint_3: 2500, "
    "joint_4: 400, joint_5: 200, joint_6: 60}"
)


@cache
def case(*changes: str) -> tuple[Task, Motion]:
    """Return the paper's corner as a motion of one of its optima."""
    task = Task.load(TASK, ["motion={law: constant_feed}", *changes])
    return task, make_motion(task, answer())


CASES: dict[str, tuple[str, ...]] = {
    "constant feed": (),
    "a given feed": ("motion.feed=0.015",),
    "time optimal": ("motion.law=time_optimal",),
    "time optimal with a cap": ("motion.law=time_optimal", "motion.feed=0.1"),
    "speeds alone": ("motion.limits=[velocity]",),
    "jerk": ("motion.law=time_optimal", JERK),
    "constant feed with jerk": (JERK,),
    "torque": ("motion.law=time_optimal", TORQUE, "motion.tool_force=50"),
    "constant feed with torque": (TORQUE,),
}


@pytest.mark.parametrize("name", CASES)
def test_samples_keep_all_limits_by_their_own_differences(name: str) -> None:
    task, motion = case(*CASES[name])
    limits, t = limits_of(task.cell, task.motion.limits), motion.time
    step = np.diff(t)[:, None]
    speed = np.diff(motion.q, axis=0) / step
    assert np.all(np.abs(speed) <= limits.velocity * (1 + 1e-4))
    assert np.allclose(speed, 0.5 * (motion.velocity[1:] + motion.velocity[:-1]), atol=0.02)
    if "acceleration" in limits.kinds:
        change = np.diff(motion.velocity, axis=0) / step
        assert np.all(np.abs(change) <= limits.acceleration * (1 + 1e-3))
        assert np.all(np.abs(motion.acceleration) <= limits.acceleration * (1 + 1e-3))
        assert np.allclose(motion.velocity[[0, -1]], 0.0, atol=1e-9)
    if "jerk" in limits.kinds:
        assert motion.summary.jerk == "checked"
        jerk = np.diff(motion.acceleration, axis=0) / step
        assert np.all(np.abs(jerk) <= limits.jerk * 1.001)
    if "torque" in limits.kinds:
        assert np.all(np.abs(motion.torque) <= limits.torque * 1.001)


@pytest.mark.parametrize("name", CASES)
def test_every_sample_lies_on_the_corner_itself(name: str) -> None:
    task, motion = case(*CASES[name])
    every = slice(None, None, max(1, len(motion.q) // 60))
    for q in motion.q[every]:
        placed = Relative(task.cell, q).T_e1_e2
        x, y, z = placed.translation
        straight = abs(x - 0.15) if y <= 0.14 else abs(y - 0.15)
        if x > 0.14 and y > 0.14:  # the fillet: radius 10 mm about (0.14, 0.14)
            straight = abs(np.hypot(x - 0.14, y - 0.14) - 0.01)
        assert max(straight, abs(z - 0.3)) < 0.05e-3
        assert np.allclose(placed.rotation, np.diag([1.0, -1.0, -1.0]), atol=np.deg2rad(0.01))


def test_a_given_feed_is_held_between_its_ramps() -> None:
    _, motion = case("motion.feed=0.015")
    speed = np.diff(motion.arc_length) / np.diff(motion.time)
    middle = (motion.arc_length[1:] > 0.03) & (motion.arc_length[1:] < 0.26)
    assert np.allclose(speed[middle], 0.015, rtol=1e-9)
    assert motion.summary.feed == pytest.approx(0.015)
    assert motion.arc_length[-1] == pytest.approx(answer().arc_length[-1])


def test_the_fastest_motion_is_faster_and_touches_a_limit() -> None:
    _, steady = case()
    _, fast = case("motion.law=time_optimal")
    assert fast.duration < 0.5 * steady.duration
    assert max(use.largest for use in fast.summary.limits) == pytest.approx(1.0, abs=1e-3)
    assert fast.summary.stretch < 1.05
    assert sum(use.share for use in fast.summary.limits) == pytest.approx(1.0)
    held = {use.joint for use in fast.summary.limits if use.share > 0.05}
    assert held <= {name.split()[0] for name in fast.summary.held_by}
    assert len(fast.summary.held_by) == 31
    _, smooth = case("motion.law=time_optimal", JERK)
    assert fast.duration < smooth.duration < 3.0 * fast.duration


def test_the_steady_feed_cannot_be_raised() -> None:
    _, motion = case("motion.limits=[velocity]")
    assert max(use.largest for use in motion.summary.limits) == pytest.approx(1.0, abs=1e-6)
    with pytest.raises(InputError, match=r"largest is 0\.0666.*joint_6 stops it by its velocity"):
        case("motion.limits=[velocity]", "motion.feed=0.07")


def test_the_work_of_the_torques_is_the_change_of_energy() -> None:
    task, motion = case("motion.law=time_optimal", TORQUE)
    model, data = task.cell.model, task.cell.data()
    energy = np.array(
        [
            pin.computeKineticEnergy(model, data, q, v) + pin.computePotentialEnergy(model, data, q)
            for q, v in zip(motion.q, motion.velocity, strict=True)
        ]
    )
    power = np.sum(motion.torque * motion.velocity, axis=1)
    work = np.concatenate([[0.0], np.cumsum(0.5 * (power[1:] + power[:-1]) * np.diff(motion.time))])
    assert np.ptp(energy) > 1.0
    assert np.allclose(work, energy - energy[0], atol=0.02 * np.ptp(energy))


def test_a_tool_force_adds_what_its_virtual_work_asks_for() -> None:
    _, loaded = case("motion.feed=0.015", "motion.tool_force=100")
    _, free = case("motion.feed=0.015")
    power = np.sum((loaded.torque - free.torque) * free.velocity, axis=1)
    speed = np.gradient(free.arc_length, free.time)
    steady = slice(len(power) // 3, len(power) // 3 + 50)  # u is the tangent: force times speed
    assert np.allclose(power[steady], 100.0 * speed[steady], rtol=1e-2)
    assert "tool force" in loaded.summary.torque_note


def test_clearance_is_that_of_the_worst_sample() -> None:
    _, motion = case()
    coarse = min(answer().checked.clearance.distance)
    assert motion.summary.least_clearance <= coarse + 1e-4


REFUSED: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "a missing speed": (
        ("cell.velocity_deg={joint_1: 90}",),
        ("no velocity limit", "arm1/joint_2", "arms.arm1.velocity_deg"),
    ),
    "a feed beyond the largest": (("motion.feed=3",), ("3 m/s", "largest is 0.0219", "0.1400 m")),
    "gravity beyond a torque": (
        (TORQUE.replace("3000", "30"),),
        ("standing still", "joint_2", "near point", "gravity"),
    ),
    "too many samples": (("motion.rate=0.00001",), ("motion.rate",)),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_cannot_be_done_is_one_sentence(name: str) -> None:
    changes, pieces = REFUSED[name]
    with pytest.raises(InputError) as caught:
        case(*changes)
    assert all(piece in str(caught.value) for piece in pieces), caught.value
    assert "\n" not in str(caught.value)


def test_postures_off_the_path_make_no_motion() -> None:
    checked: Any = replace(answer().checked, found=False)
    with pytest.raises(InputError, match="not on the path"):
        make_motion(case()[0], replace(answer(), checked=checked))


def test_a_motion_reads_as_a_few_lines() -> None:
    text = motion_text(case("motion.law=time_optimal", TORQUE)[1])
    assert "time optimal" in text
    assert "mechanical work" in text
    assert "held by" in text


def test_a_torque_above_a_limit_that_is_not_kept_is_said() -> None:
    """Limits of some joints alone are not kept, and a motion far above them must not look sound."""
    text = motion_text(case("motion.law=constant_feed", "cell.torque={joint_2: 1}")[1])
    assert "ABOVE ITS LIMIT: torque limits are not kept" in text
    assert "ABOVE" not in motion_text(case("motion.law=time_optimal", TORQUE)[1])
