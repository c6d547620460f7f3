"""From hand to hand: how far apart the path holds two bodies, whatever the joints do.

Hands that follow a whole pose stand to each other as the path says. Where a body lies one joint
behind its hand, or the tool may spin, one value is left: it can be swept.
"""

from __future__ import annotations

import heapq
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
import pinocchio as pin

from dualarm_pin.arrays import Array
from dualarm_pin.chain import REVOLUTE, joint_axis
from dualarm_pin.clearance.extent import ball_of, corners_of
from dualarm_pin.path.path import SPIN_FREE, WHOLE_POSE

if TYPE_CHECKING:
    from dualarm_pin.cell import Cell
    from dualarm_pin.path import Path

_SWEPT = 25  # values of what is left free, for the range that is shown
_SHARP = 2e-4  # m; an interval that could be better by less than this is not cut further


@dataclass(frozen=True, eq=False)
class HandRoute:
    """The way from one body over its hand, the path and the other hand to another body.

    Attributes:
        cell: The two arms.
        path: The path.
        number: Which of the cell's pairs.
        swap: The first body of the pair belongs to arm2.
        joint: The one joint of the model on the way, 0 for none.
        spin: The tool may turn about its axis instead.
    """

    cell: Cell
    path: Path
    number: int
    swap: bool
    joint: int
    spin: bool

    @property
    def free(self) -> bool:
        """Whether one value is left free."""
        return self.spin or self.joint > 0

    @cached_property
    def values(self) -> Array:
        """Values of what is left free [rad or m], over its bounds; one if nothing is."""
        if self.spin:
            return np.linspace(-np.pi, np.pi, _SWEPT)
        if not self.joint:
            return np.zeros(1)
        cell, row = self.cell, self.cell.model.joints[self.joint].idx_v
        ends = np.array([cell.joint_map[row] @ q for q in (cell.lower, cell.upper)])
        low, high = np.sort(ends + cell.joint_offset[row])
        return np.linspace(float(low), float(high), _SWEPT)

    def distance(self, point: int, value: float, *, exact: bool = False) -> float:
        """Return the distance [m] at a point of the path, from 0; of convex hulls by default."""
        one, two = self._seen(value)
        poses = (one, self._across(point, value) * two)
        first, second = poses[::-1] if self.swap else poses
        return self.cell.distance_placed(self.number, first, second, exact=exact)

    def apart(self) -> Array:
        """Return a distance (h,) [m] that the bodies keep at the middle value, as two balls."""
        value = float(self.values[len(self.values) // 2])
        bodies = (self.cell.collision.geometryObjects[k].geometry for k in self._ends)
        (first, wide), (second, other) = map(ball_of, bodies)
        one, two = self._seen(value)
        there = self._turn(value) @ two.act(second)
        between = self.path.rotation @ there + self.path.position - one.act(first)
        gaps: Array = np.linalg.norm(between, axis=1) - wide - other
        return gaps

    def most(self, point: int, enough: float) -> float | None:
        """Return the largest distance [m] at a point, meshes as they are, if it is not enough.

        None where some value keeps the bodies more than `enough` apart. Otherwise that is proven:
        no interval between two values can hold more.
        """
        at = self.values
        seen = [self.distance(point, value, exact=True) for value in at]
        slope = self._slope if self.free else 0.0
        parts: list[tuple[float, float, float, float, float]] = []
        for x, y, a, b in zip(at, at[1:], seen, seen[1:], strict=False):
            heapq.heappush(parts, (-(a + b + slope * (y - x)) / 2.0, x, y, a, b))
        best = max(seen)
        while best <= enough and parts and -parts[0][0] > enough:
            bound, x, y, a, b = heapq.heappop(parts)
            if -bound < best + _SHARP:
                return None  # too close to say
            middle = (x + y) / 2.0
            c = self.distance(point, middle, exact=True)
            best = max(best, c)
            for left, right, one, two in ((x, middle, a, c), (middle, y, c, b)):
                bound = -(one + two + slope * (right - left)) / 2.0
                heapq.heappush(parts, (bound, left, right, one, two))
        return None if best > enough else best

    @cached_property
    def _ends(self) -> tuple[int, int]:
        """Which bodies: that of arm1, that of arm2."""
        pair = self.cell.collision.collisionPairs[self.number]
        return (pair.second, pair.first) if self.swap else (pair.first, pair.second)

    def _across(self, point: int, value: float) -> Any:
        """Return the pose of the second hand in the first."""
        return self.path.pose(point) * pin.SE3(self._turn(value), np.zeros(3))

    def _turn(self, value: float) -> Array:
        if not self.spin:
            return np.eye(3)
        turn: Array = pin.AngleAxis(float(value), self.path.spin_axis).toRotationMatrix()
        return turn

    def _seen(self, value: float) -> tuple[Any, Any]:
        """Return the poses of the two bodies, each in its hand."""
        if self.joint:
            return self._placed(value)
        return self._still

    @cached_property
    def _still(self) -> tuple[Any, Any]:
        return self._placed(0.0)

    def _placed(self, value: float) -> tuple[Any, Any]:
        cell, data = self.cell, self.cell.data()
        q = np.array(cell.model_q((cell.lower + cell.upper) / 2.0))
        if self.joint:
            q[cell.model.joints[self.joint].idx_q] = value
        pin.framesForwardKinematics(cell.model, data, q)
        bodies = (cell.collision.geometryObjects[k] for k in self._ends)
        one, two = (
            data.oMf[hand].actInv(data.oMi[body.parentJoint] * body.placement)
            for hand, body in zip((cell.e1, cell.e2), bodies, strict=True)
        )
        return one, two

    @cached_property
    def _slope(self) -> float:
        """How fast the distance can change, at most [m/rad or m/m]."""
        one, two = self._seen(float(self.values[0]))
        if self.spin:
            return self._radius(1, two, np.zeros(3), self.path.spin_axis)
        kind, axis = joint_axis(self.cell.model, self.joint)
        if kind != REVOLUTE:
            return 1.0
        hand = self.cell.e2 if self.joint in _support(self.cell, self.cell.e2) else self.cell.e1
        which = (self.cell.e1, self.cell.e2).index(hand)
        data = self.cell.data()
        seen = data.oMf[hand].actInv(data.oMi[self.joint])
        return self._radius(which, (one, two)[which], seen.translation, seen.rotation @ axis)

    def _radius(self, which: int, pose: Any, origin: Array, axis: Array) -> float:
        """Return how far the corners of a body lie from an axis, both seen from its hand [m]."""
        body = self.cell.collision.geometryObjects[self._ends[which]].geometry
        away = corners_of(body) @ pose.rotation.T + pose.translation - origin
        return float(np.linalg.norm(np.cross(away, axis), axis=1).max())


def hand_routes(cell: Cell, path: Path) -> Iterator[HandRoute]:
    """Yield the way from hand to hand for every pair of bodies that it leaves one value at most."""
    if np.min(path.rows) < SPIN_FREE:
        return
    spin = bool(np.min(path.rows) < WHOLE_POSE)
    hands = [_support(cell, hand) for hand in (cell.e1, cell.e2)]
    for number, pair in enumerate(cell.collision.collisionPairs):
        bodies = [cell.collision.geometryObjects[k] for k in (pair.first, pair.second)]
        joints = [_up(cell.model, body.parentJoint) for body in bodies]
        for swap in (False, True):
            ends = joints[::-1] if swap else joints
            moving = (ends[0] ^ hands[0]) | (ends[1] ^ hands[1])
            if len(moving) + spin <= 1:
                yield HandRoute(cell, path, number, swap, next(iter(moving), 0), spin)
                break


def _support(cell: Cell, frame: int) -> frozenset[int]:
    return _up(cell.model, cell.model.frames[frame].parentJoint)


def _up(model: Any, joint: int) -> frozenset[int]:
    """Return the joints between a joint and the world, itself among them."""
    return frozenset(model.supports[joint]) - {0}
