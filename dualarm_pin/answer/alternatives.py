"""Alternatives: further answers to one task, and what separates them from the best."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from dualarm_pin.arrays import Array

if TYPE_CHECKING:
    from dualarm_pin.answer.trajectory import Trajectory
    from dualarm_pin.cell.parts import Joint

FOLDER = "alternatives"
APART = 0.3  # rad: postures of a path nearer than this in every joint are hardly told apart
_TRIES = 4  # candidates for each answer that are looked at: each costs a whole check
_SHARE = 0.3  # of the range of a joint that moves in metres, as 0.3 of a radian


@dataclass(frozen=True, eq=False)
class Alternative:
    """Another answer to the same task.

    Attributes:
        trajectory: The answer, checked like the best.
        apart: Joints that it holds in another posture, by the mean over the points of the
            difference from the best, without full turns [rad or m]; largest first.
    """

    trajectory: Trajectory
    apart: Mapping[str, float]


def alternatives_json(best: Trajectory) -> list[dict[str, Any]]:
    """Return what result.json says of a best answer and its alternatives, () without any."""
    rows = [
        (1, best, {}),
        *((i, a.trajectory, a.apart) for i, a in enumerate(best.alternatives, 2)),
    ]
    return [
        {
            "folder": place_of(number),
            "objective": t.objective,
            "mean_index": t.mean_index,
            "max_index": t.max_index,
            "min_clearance": t.min_clearance,
            "max_joint_step": t.max_joint_step,
            "ranges": dict(zip(t.joints, np.ptp(t.q, axis=0).tolist(), strict=True)),
            "apart": dict(apart),
        }
        for number, t, apart in (rows if best.alternatives else ())
    ]


def place_of(number: int) -> str:
    """Return where an answer stands beside the best, which is number 1."""
    return "." if number == 1 else f"{FOLDER}/{number}"


def difference(a: Array, b: Array, joints: Sequence[Joint]) -> Array:
    """Return by how much the postures of two paths differ (k, n), without full turns."""
    away = np.abs(np.asarray(b) - a)
    turns = np.array([joint.kind == "revolute" for joint in joints])
    around = np.abs((away + np.pi) % (2.0 * np.pi) - np.pi)
    return np.where(turns, around, away)


def other_posture(a: Array, b: Array, joints: Sequence[Joint]) -> bool:
    """Tell whether two paths hold some joint apart, in the mean over their points (k, n)."""
    enough = np.array([_enough(joint) for joint in joints])
    return bool(np.any(np.mean(difference(a, b, joints), axis=0) > enough))


def _enough(joint: Joint) -> float:
    return APART if joint.kind == "revolute" else _SHARE * (joint.upper - joint.lower)


def kept(
    best: Trajectory,
    candidates: Iterable[tuple[Array, Callable[[], Trajectory]]],
    count: int,
    joints: Sequence[Joint],
) -> tuple[Alternative, ...]:
    """Return the best answers that differ in posture from `best` and from each other.

    Args:
        best: The answer.
        candidates: Paths (k, n), best first, and what makes an answer of each: it is polished and
            checked, and left out where the check does not find it.
        count: How many answers there shall be, `best` among them.
        joints: Joints of the cell, in order of the columns.
    """
    found: list[Trajectory] = []

    def differs(q: Array) -> bool:
        return all(other_posture(each.q, q, joints) for each in (best, *found))

    left = _TRIES * count
    with suppress(KeyboardInterrupt):  # those that were made stay
        for rough, made in candidates:
            if len(found) == count - 1 or not left:
                break
            if differs(rough):
                left -= 1
                answer = made()
                if answer.found and differs(answer.q):
                    found.append(answer)
    found.sort(key=lambda answer: answer.objective)
    return tuple(Alternative(each, _apart(best.q, each.q, joints)) for each in found)


def _apart(a: Array, b: Array, joints: Sequence[Joint]) -> dict[str, float]:
    mean = np.mean(difference(a, b, joints), axis=0).tolist()
    pairs = [(j.name, far) for j, far in zip(joints, mean, strict=True) if far > _enough(j)]
    return dict(sorted(pairs, key=lambda pair: -pair[1]))
