"""From postures to motion: the answer to a task in time."""

from __future__ import annotations

import numpy as np

from dualarm_pin.answer.distances import distances_along
from dualarm_pin.answer.trajectory import Trajectory
from dualarm_pin.arrays import Array
from dualarm_pin.errors import InputError
from dualarm_pin.motion.constant_feed import constant_feed
from dualarm_pin.motion.joint_curve import JointCurve, joint_curve
from dualarm_pin.motion.limits import Limits, limits_of
from dualarm_pin.motion.record import Motion
from dualarm_pin.motion.samples import Samples, samples_of
from dualarm_pin.motion.schedule import Schedule
from dualarm_pin.motion.summary import LimitUse, MotionSummary, TorqueUse
from dualarm_pin.motion.time_optimal import smoothed, time_optimal
from dualarm_pin.motion.torque import Torques
from dualarm_pin.motion.use import Use, use_of
from dualarm_pin.task import Task
from dualarm_pin.task.motion_spec import MotionSpec


def make_motion(task: Task, trajectory: Trajectory, spec: MotionSpec | None = None) -> Motion:
    """Return the motion along a path that was found.

    Args:
        task: What was asked.
        trajectory: The postures that answer it.
        spec: How it shall run; as the task says by default.

    Raises:
        InputError: The postures are not on the path, a limit is not known, or no motion keeps
            them all; the message says which joint stops it where.
    """
    spec = spec or task.motion or MotionSpec()
    if not trajectory.found:
        raise InputError("the postures of this result are not on the path: there is no motion")
    limits = limits_of(task.cell, spec.limits)
    torques = Torques(task.cell, spec.tool_force)
    curve = joint_curve(task, trajectory.q, spec.chord)
    feed = np.inf if spec.feed is None else spec.feed
    largest = None
    if spec.law == "constant_feed":
        schedule, stop = constant_feed(curve, limits, torques, spec.feed)
        largest, feed = stop.feed, np.inf
    else:
        schedule = time_optimal(curve, limits, torques, feed)
        if "jerk" in limits.kinds:
            schedule = smoothed(curve, schedule, limits, torques, feed)
    slower = use_of(curve, schedule, limits, torques, feed).slower
    schedule = schedule.slower(slower)
    use = use_of(curve, schedule, limits, torques, feed)
    samples = samples_of(curve, schedule, spec)
    return _motion(curve, spec, limits, torques, schedule, use, samples, largest, slower)


def _motion(
    curve: JointCurve,
    spec: MotionSpec,
    limits: Limits,
    torques: Torques,
    schedule: Schedule,
    use: Use,
    samples: Samples,
    largest: float | None,
    slower: float,
) -> Motion:
    motion = samples.motion
    torque = None
    if torques.known:
        torque = torques.moving(motion.q, motion.velocity, motion.acceleration)
        torque = torque + torques.pressing(motion.q, curve.relative.direction(motion.place))
    everywhere, arms = distances_along(curve.task.cell, curve.at(curve.grid))
    uses = _limit_uses(limits, use, spec.feed if "feed" in use.share else None)
    summary = MotionSummary(
        duration=schedule.duration,
        feed=float(np.max(motion.speed)),
        largest_feed=largest,
        mean_feed=curve.task.path.length / schedule.duration,
        path_error_mm=1e3 * samples.path_error[0],
        path_error_deg=float(np.rad2deg(samples.path_error[1])),
        chord_error_mm=1e3 * samples.chord_error[0],
        chord_error_deg=float(np.rad2deg(samples.chord_error[1])),
        kinds=limits.kinds,
        stretch=slower,
        jerk="checked" if "jerk" in limits.kinds else "",
        limits=uses,
        held_by=_held_by(uses, use, curve.relative.place),
        least_clearance=None if everywhere is None else everywhere.least,
        least_arm_clearance=None if arms is None else arms.least,
        tool_force=spec.tool_force,
        torques=() if torque is None else _torque_uses(curve.task, samples, torque),
        torque_note=torques.note,
    )
    return Motion(
        law=spec.law,
        joints=limits.joints,
        time=samples.time,
        arc_length=curve.relative.arc_length(motion.place),
        q=motion.q,
        velocity=motion.velocity,
        acceleration=motion.acceleration,
        torque=torque,
        summary=summary,
    )


def _limit_uses(limits: Limits, use: Use, feed: float | None) -> tuple[LimitUse, ...]:
    """Return what each limit does; its share of the path is where it holds the motion back."""
    tightest = np.argmax(use.paces, axis=1)
    weight = np.gradient(use.place)
    held = np.bincount(tightest, np.maximum(weight, 0.0), use.paces.shape[1])
    held = held / max(held.sum(), 1e-300)
    found, column = [], 0
    for kind, share in use.share.items():
        for j in range(share.shape[1]):
            joint = "" if kind == "feed" else limits.joints[j]
            value = float(feed or 0.0) if kind == "feed" else float(limits.of(kind)[j])
            largest = float(share[:, j].max())
            found.append(LimitUse(kind, joint, value, largest, float(held[column])))
            column += 1
    return tuple(found)


def _held_by(uses: tuple[LimitUse, ...], use: Use, place: Array) -> tuple[str, ...]:
    """Return which limit holds the motion back at places (h,), looking halfway to their next."""
    owner = np.searchsorted(0.5 * (place[1:] + place[:-1]), use.place)
    names = [f"{each.joint or 'the tool'} {each.kind}" for each in uses]
    pace = np.zeros((len(place), len(uses)))
    np.maximum.at(pace, owner, use.paces)
    return tuple(names[k] for k in np.argmax(pace, axis=1))


def _torque_uses(task: Task, samples: Samples, torque: Array) -> tuple[TorqueUse, ...]:
    duration = samples.time[-1]
    power = np.abs(torque * samples.motion.velocity)
    found = []
    for j, joint in enumerate(task.cell.joints):
        largest = float(np.abs(torque[:, j]).max())
        rms = float(np.sqrt(np.trapezoid(torque[:, j] ** 2, samples.time) / duration))
        limit = joint.effort or np.nan
        shares = [None if joint.effort is None else value / limit for value in (largest, rms)]
        energy = float(np.trapezoid(power[:, j], samples.time))
        found.append(TorqueUse(joint.name, largest, rms, shares[0], shares[1], energy))
    return tuple(found)
