"""The relative path between its points: where e2 shall be at every place along it."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicHermiteSpline, CubicSpline
from scipy.spatial.transform import Rotation, RotationSpline

from dualarm_pin.arrays import Array
from dualarm_pin.path import Path
from dualarm_pin.path.path import WHOLE_POSE, Counts, through
from dualarm_pin.tolerance import TOLERANCE

Flags = NDArray[np.bool_]
# A turn on the spot by 1 rad counts as this much way [m], else it would take none.
_TURN_LENGTH = 0.1


class Poses(NamedTuple):
    """Poses of e2 in e1.

    Attributes:
        position: (m, 3) [m].
        rotation: (m, 3, 3).
        rows: (m,) constrained components, as `Path.rows`.
        tangent: (m, 3) unit tangents of the path.
    """

    position: Array
    rotation: Array
    rows: Counts
    tangent: Array


class RelativePath:
    """A path as a smooth curve over its arc length.

    Positions follow the tangents that the path brings, or a spline through its points if it has
    only those of their differences. Rotations follow a spline, and where the spin is free the
    tool axis alone does. A turn on the spot has a length too: there `place` goes on.

    Attributes:
        path: The path.
        place: Of its points (h,), strictly rising from 0 [m]; the arc length but for turns.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        step = np.diff(path.arc_length)
        still = step < TOLERANCE.coincident
        turn = path.rotation[:-1].transpose(0, 2, 1) @ path.rotation[1:]
        angle = Rotation.from_matrix(turn).magnitude()
        step = np.where(still, np.maximum(_TURN_LENGTH * angle, TOLERANCE.coincident), step)
        self.place: Array = np.concatenate([[0.0], np.cumsum(step)])
        self._position = self._position_curve(still)
        if (path.rows == WHOLE_POSE).any():
            self._rotation = RotationSpline(self.place, Rotation.from_matrix(path.rotation))
        self._axis = CubicSpline(self.place, path.rotation @ path.spin_axis)

    def _position_curve(self, still: Flags) -> CubicSpline | CubicHermiteSpline:
        path = self.path
        own = np.abs(path.tangent - through(path.position)).max() > TOLERANCE.parallel
        if not own and not still.any():
            return CubicSpline(
                self.place, path.position, bc_type="natural" if path.h < 4 else "not-a-knot"
            )
        stands = np.append(still, False) | np.append(False, still)
        return CubicHermiteSpline(self.place, path.position, path.tangent * ~stands[:, None])

    @property
    def length(self) -> float:
        """Where it ends [m]."""
        return float(self.place[-1])

    def arc_length(self, place: Array) -> Array:
        """Return the arc length (m,) [m] at places (m,)."""
        return np.interp(place, self.place, self.path.arc_length)

    def at(self, place: Array) -> Path:
        """Return the path of these places (m,), rising, as points; none may coincide."""
        poses = self.poses(place)
        return replace(
            self.path,
            u=self.direction(place),
            arc_length=self.arc_length(place) - self.arc_length(place[:1]),
            **poses._asdict(),
        )

    def poses(self, place: Array) -> Poses:
        """Return where e2 shall be at places (m,), which may crowd."""
        path = self.path
        link = np.clip(np.searchsorted(self.place, place, side="right") - 1, 0, path.h - 2)
        after = np.clip(np.searchsorted(self.place, place, side="left"), 0, path.h - 1)
        before = np.where(self.place[after] == place, after, link)
        rows = np.minimum(path.rows[before], path.rows[after])
        slope = self._position(place, 1)
        length = np.linalg.norm(slope, axis=1, keepdims=True)
        unit = slope / np.maximum(length, TOLERANCE.no_length)
        tangent = np.where(length > TOLERANCE.no_length, unit, path.tangent[link])
        return Poses(self._position(place), self._rotations(place, rows), rows, tangent)

    def direction(self, place: Array) -> Array:
        """Return the direction u (m, 6) at places (m,), straight between the points."""
        return np.stack([np.interp(place, self.place, u) for u in self.path.u.T], axis=1)

    def _rotations(self, place: Array, rows: Array) -> Array:
        if (rows == WHOLE_POSE).all():
            return np.asarray(self._rotation(place).as_matrix())
        axis = self._axis(place)
        axis /= np.linalg.norm(axis, axis=1, keepdims=True)
        link = np.clip(np.searchsorted(self.place, place, side="right") - 1, 0, self.path.h - 1)
        near = self.path.rotation[link]
        # The smallest turn of the point before that brings its axis to the wanted one.
        own = near @ self.path.spin_axis
        cross = np.cross(own, axis)
        sine, cosine = np.linalg.norm(cross, axis=1), np.sum(own * axis, axis=1)
        unit = cross / np.maximum(sine, TOLERANCE.no_length)[:, None]
        turn = Rotation.from_rotvec(unit * np.arctan2(sine, cosine)[:, None]).as_matrix()
        turned: Array = turn @ near
        whole = rows == WHOLE_POSE
        if whole.any():
            turned[whole] = self._rotation(place[whole]).as_matrix()
        return turned
