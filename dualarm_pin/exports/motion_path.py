"""The relative path that a motion runs along, and how far a program leaves it.

Between the samples of the motion the joints are a smooth curve over the length of the relative
path, so what the path is does not depend on how fast it is run. The error of a posture is its
distance from the nearest pose of the path, near in the measure of the tolerance: where along it a
program is at what time is no error of the path.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.spatial.transform import Rotation

from dualarm_pin.arrays import Array, Integers
from dualarm_pin.cell import Cell
from dualarm_pin.errors import InputError
from dualarm_pin.exports.format import Chord
from dualarm_pin.files.numbers import LARGEST
from dualarm_pin.path import Path
from dualarm_pin.path.path import POSITION_ONLY, SPIN_FREE, WHOLE_POSE
from dualarm_pin.relative import Relative

_AHEAD, _SLACK = 2.0, 4.0  # how far ahead to look: in steps of the program, and in tolerances
_SLIDES = 4  # Gauss-Newton steps to the nearest pose: they begin within half a sample of it
_IDLE = 1e-3  # m/rad: joints that turn while the tools stand still make the length rise a little
_STILL = 1e-12  # squared speed of poses that stand still, in tolerances


class Poses(NamedTuple):
    """Relative poses T_e1_e2: position (k, 3), rotation (k, 3, 3), rate (k, 6).

    The rate is [linear; angular] in axes of e1, by the length of the path.
    """

    position: Array
    rotation: Array
    rate: Array

    def at(self, which: Integers) -> Poses:
        """Return some of them."""
        return Poses(self.position[which], self.rotation[which], self.rate[which])


class MotionPath:
    """The relative path of a motion.

    Args:
        cell: The two arms.
        q: Joints of the motion (m, n).
        path: What the task asks for.
        arc_length: Where on it each sample lies (m,) [m].
        tolerance: The measure of what is near.

    Attributes:
        length: Length up to each sample (m,) [m], of what counts; the tolerances say how turns do.
        joint_step: Mean step of all joints from one sample to the next [rad or m].
    """

    def __init__(
        self, cell: Cell, q: Array, path: Path, arc_length: Array, tolerance: Chord
    ) -> None:
        self._cell, self._spin_axis = cell, path.spin_axis
        self._scale = np.repeat([1e3 / tolerance.mm, np.rad2deg(1.0) / tolerance.deg], 3)
        after = np.clip(np.searchsorted(path.arc_length, arc_length), 1, path.h - 1)
        # Between points of a task the stricter of the two says what counts.
        self._rows = np.maximum(path.rows[after - 1], path.rows[after])
        step = self._steps(q, self._poses(q, np.zeros_like(q)), self._rows[1:])
        self.length = np.concatenate([[0.0], np.cumsum(step)])
        self.joint_step = float(np.linalg.norm(np.diff(q, axis=0), axis=1).mean())
        moves = np.concatenate([[True], step > 0.0])
        self._curve = CubicSpline(self.length[moves], q[moves])
        self._samples = self._poses(q, self._curve(self.length, 1))

    def within(self, q: Array, samples: Integers, share: float, *, slide: bool) -> bool:
        """Return whether postures are within a share of the tolerance at samples of the motion.

        Args:
            q: Joints (k, n).
            samples: With which samples they are compared (k,).
            share: Of the tolerance.
            slide: What lies along the path is no error.
        """
        given = self._poses(q, np.zeros_like(q))
        error, rate = self._compare(given, self._samples.at(samples), samples)
        if slide:
            error -= _along(error, rate)[:, None] * rate
        return bool(np.all(np.linalg.norm(error.reshape(-1, 2, 3), axis=2) <= share))

    def deviation(self, q: Array) -> Array:
        """Return how far postures in the order of a program are from the path (k, 2) [mm, deg].

        Args:
            q: Joints (k, n), about as close to each other as the samples of the motion; the first
                and the last are compared with the ends of the motion.

        Raises:
            InputError: They lead where no robot is.
        """
        given = self._poses(q, np.zeros_like(q))
        if not np.all(np.abs(given.position) <= LARGEST):
            message = (
                f"the program leads beyond {LARGEST:g} m: look at the lengths in the cell file"
            )
            raise InputError(message, field="controller")
        where = self.length[self._nearest_samples(q, given)]
        where[0], where[-1] = 0.0, self.length[-1]
        error, rate = self._error(given, where)
        for _ in range(_SLIDES):
            moved = np.clip(where + _along(error, rate), 0.0, self.length[-1])
            moved[0], moved[-1] = 0.0, self.length[-1]
            other, other_rate = self._error(given, moved)
            nearer = np.linalg.norm(other, axis=1) < np.linalg.norm(error, axis=1)
            where[nearer], error[nearer], rate[nearer] = (
                moved[nearer],
                other[nearer],
                other_rate[nearer],
            )
        error /= self._scale
        mm = 1e3 * np.linalg.norm(error[:, :3], axis=1)
        return np.column_stack([mm, np.rad2deg(np.linalg.norm(error[:, 3:], axis=1))])

    def _poses(self, q: Array, rate: Array) -> Poses:
        """Return the relative poses at joints q (k, n) that change by `rate` (k, n)."""
        found = [Relative(self._cell, row) for row in q]
        return Poses(
            np.array([each.T_e1_e2.translation for each in found]).reshape(-1, 3),
            np.array([each.T_e1_e2.rotation for each in found]).reshape(-1, 3, 3),
            np.array([r.J_r @ v for r, v in zip(found, rate, strict=True)]).reshape(-1, 6),
        )

    def _nearest_samples(self, q: Array, given: Poses) -> Integers:
        """Return the sample nearest to each posture of a program (k,); they never go back.

        From one posture to the next a program goes along the path hardly farther than it moves.
        """
        every = np.full(len(q) - 1, WHOLE_POSE)
        reach = _AHEAD * self._steps(q, given, every) + _SLACK / self._scale[0]
        features, path = self._features(given), self._features(self._samples)
        counts = np.stack([self._rows > 0, self._rows == WHOLE_POSE, self._rows == SPIN_FREE], 1)
        weights = np.repeat(counts, [3, 9, 3], axis=1)
        at, found = 0, np.zeros(len(q), dtype=np.int64)
        for k in range(1, len(q)):
            far = np.searchsorted(self.length, self.length[at] + reach[k - 1], side="right")
            near = slice(at, max(int(far), at + 2))
            away = weights[near] * (path[near] - features[k]) ** 2
            at = found[k] = at + int(np.argmin(away.sum(axis=1)))
        return found

    def _features(self, poses: Poses) -> Array:
        """Return what tells poses apart (k, 15), in tolerances: position, rotation, spin axis."""
        to_position, to_turn = self._scale[0], self._scale[3]
        rotation = poses.rotation.reshape(-1, 9) * (to_turn / np.sqrt(2.0))
        axis = poses.rotation @ self._spin_axis * to_turn
        return np.hstack([poses.position * to_position, rotation, axis])

    def _steps(self, q: Array, poses: Poses, rows: Integers) -> Array:
        """Return the length of each step (k - 1,) [m]; 0 only where no joint moves."""
        which = np.arange(len(q))
        error, _ = pose_error(
            poses.at(which[1:]), poses.at(which[:-1]), rows, self._spin_axis, self._scale
        )
        metres = np.linalg.norm(error, axis=1) / self._scale[0]
        return np.asarray(np.hypot(metres, _IDLE * np.linalg.norm(np.diff(q, axis=0), axis=1)))

    def _compare(self, given: Poses, path: Poses, before: Integers) -> tuple[Array, Array]:
        """Return the error of poses and the rate of the path, by what counts after a sample."""
        return pose_error(given, path, self._rows[before], self._spin_axis, self._scale)

    def _error(self, given: Poses, where: Array) -> tuple[Array, Array]:
        """Return the error at places of the path and its rate along it, (k, 6) in tolerances."""
        path = self._poses(self._curve(where), self._curve(where, 1))
        before = np.searchsorted(self.length, where, side="right") - 1
        return self._compare(given, path, before)


def pose_error(
    given: Poses, path: Poses, rows: Integers, spin_axis: Array, scale: Array
) -> tuple[Array, Array]:
    """Return the error of poses against those of the path, and the rate of the path, (k, 6).

    What a task leaves free is 0: the turn about the spin axis, or every rotation.

    Args:
        given: The poses.
        path: Those they shall have.
        rows: What counts at each: 6, 5 or 3 components (k,).
        spin_axis: Axis in e2 about which the tool may turn.
        scale: Turns the components into shares of their tolerance (6,).
    """
    turn, rate = _turn(path.rotation, given.rotation), path.rate.copy()
    free = rows == SPIN_FREE
    axis = path.rotation[free] @ spin_axis
    turn[free] = _tilt(axis, given.rotation[free] @ spin_axis)
    spin = np.einsum("ij,ij->i", rate[free, 3:], axis)
    rate[free, 3:] -= spin[:, None] * axis
    turn[rows == POSITION_ONLY] = 0.0
    rate[rows == POSITION_ONLY, 3:] = 0.0
    return np.hstack([given.position - path.position, turn]) * scale, rate * scale


def _along(error: Array, rate: Array) -> Array:
    """Return how far along the path the nearest pose lies, by its tangent (k,) [m]."""
    speed = np.einsum("ij,ij->i", rate, rate)
    product = np.einsum("ij,ij->i", error, rate)
    return np.asarray(np.where(speed > _STILL, product, 0.0) / np.maximum(speed, _STILL))


def _turn(first: Array, second: Array) -> Array:
    """Return the rotation vectors (k, 3) that turn rotations into others, in outer axes."""
    return np.asarray(Rotation.from_matrix(second @ first.transpose(0, 2, 1)).as_rotvec())


def _tilt(first: Array, second: Array) -> Array:
    """Return the smallest rotation vectors (k, 3) that turn unit vectors into others."""
    across = np.cross(first, second)
    sine = np.linalg.norm(across, axis=1)
    angle = np.arctan2(sine, np.einsum("ij,ij->i", first, second))
    return np.asarray(across * (angle / np.maximum(sine, np.finfo(float).tiny))[:, None])
