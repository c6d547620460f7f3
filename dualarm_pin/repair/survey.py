"""How near the bodies come along a path, and where: convex hulls and meshes by Coal.

Capsules around the bodies say which pairs can be near at all; only those are measured.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pinocchio as pin

from dualarm_pin.arrays import Array
from dualarm_pin.engine.evaluation import gaps
from dualarm_pin.problem import Problem
from dualarm_pin.repair.bodies import OFF_CHAIN, Pairs, capsule_table, joints_on_chain
from dualarm_pin.repair.contacts import Contacts, Found
from dualarm_pin.repair.known import Recent
from dualarm_pin.repair.meshes import Meshes
from dualarm_pin.repair.meter import Meter
from dualarm_pin.rows.table import RowTable
from dualarm_pin.solution import Flags
from dualarm_pin.solvers.interior_point import compare

_CLEAR = 0.01  # m: meshes that keep so much more have no rows until they come nearer
# m: where hulls keep no more than that beyond what is asked, their meshes may be far apart.
_TIGHT = 1e-3
_SURE = 1e-6  # m: nearer points say nothing of a direction


class Survey:
    """Measures the pairs of a problem; it keeps Coal's room between calls, so one thread only.

    Attributes:
        problem: The problem.
        pairs: Pairs of which a distance is asked.
        joints: Where their joints are on the chain.
        on_chain: (p,) pairs that rows can hold: neither body moves both arms.
        covered: (p,) those of them whose capsules fit their bodies.
        meter: Counts what is measured.
    """

    def __init__(self, problem: Problem, pairs: Pairs, meter: Meter | None = None) -> None:
        compare(problem)  # without the rows of pairs, that the engine alone knows
        self.problem, self.pairs = problem, pairs
        self.meter = Meter(problem) if meter is None else meter
        self.joints = joints_on_chain(problem)
        self.on_chain: Flags = (self.joints.segment[pairs.joint] != OFF_CHAIN).all(axis=1)
        self.covered = self.on_chain & pairs.tight
        cell = problem.cell
        boxes = np.array([box_around(points, radius) for points, radius in pairs.hulls])
        self._recent = Recent(boxes.reshape(-1, 8, 3))
        self._model, self._data = cell.model, cell.model.createData()
        self._geometry = cell.collision
        self._scene = self._geometry.createData()
        self._meshes = Meshes(problem, pairs, boxes, self._data)
        self._number = pairs.number.tolist()
        every = np.ones((problem.k, len(pairs.number)), dtype=bool)
        table = self.capsule_table(every, np.zeros(len(pairs.number)))
        self._capsules = replace(problem, inequalities=table)

    def contacts(
        self,
        q: Array,
        reach: float,
        extra: Array | None = None,
        *,
        enough: float = np.inf,
        ample: float = np.inf,
    ) -> Contacts:
        """Return the pairs that are nearer than what is required of them and `reach` more.

        Args:
            q: Postures (m, n) [rad or m].
            reach: [m].
            extra: (p, m) what is required of each pair at each posture beyond that [m].
            enough: Where more lacks, `extra` aside, nothing further is measured [m].
            ample: A pair that surely keeps so much more than is asked is not measured anew [m]:
                its contact is the last one, or of meshes that measured at the nearest pose, and
                what it surely keeps stands for the distance.
        """
        room = reach if extra is None else reach + extra.T
        return self.measured(q, self.capsule_gaps(q) < room, reach, extra, enough, ample)

    def measured(
        self,
        q: Array,
        which: Flags,
        reach: float = np.inf,
        extra: Array | None = None,
        enough: float = np.inf,
        ample: float = np.inf,
    ) -> Contacts:
        """Return those of some pairs that are nearer than what is required and `reach` more.

        Args:
            q: Postures (m, n) [rad or m].
            which: (m, p) pairs to be measured.
            reach: [m].
            extra: As of `contacts`.
            enough: As of `contacts`.
            ample: As of `contacts`.
        """
        found: list[Found] = []
        placed, asked = self.placements(q), np.tile(self.pairs.required, (len(q), 1))
        if extra is not None:
            asked = asked + extra.T
        point, pairs = np.nonzero(which)
        first, second = (placed[point, self.pairs.joint[pairs, side]] for side in (0, 1))
        poses = _relative(first, second)
        bound, recorded, corners = self._recent.least(poses, len(q), point, pairs)
        close = bound < asked[point, pairs] + reach
        known = recorded & (bound >= asked[point, pairs] + ample)
        near, old = np.flatnonzero(close & ~known), np.flatnonzero(close & known)
        self.meter.measured(len(q), len(near))
        distances: list[float] = []
        at, geometry, scene = -1, self._geometry, self._scene
        for c, i, pair in zip(near, point[near].tolist(), pairs[near].tolist(), strict=True):
            if i != at:
                at = i
                pin.forwardKinematics(self._model, self._data, self.problem.cell.model_q(q[i]))
                pin.updateGeometryPlacements(self._model, self._data, geometry, scene)
                self._meshes.moved()
            number, required = self._number[pair], float(asked[i, pair])
            result = pin.computeDistance(geometry, scene, number)
            hulls = result.min_distance
            distances.append(hulls)
            if hulls >= required + reach:
                continue
            ends = result.getNearestPoint1(), result.getNearestPoint2()
            contact = Found(i, pair, hulls, False, *ends, result.normal)
            if hulls < required + _TIGHT:
                most, surely = required + min(reach, _CLEAR), required + ample
                nearer, closest = self._meshes.keep(pair, poses[c], hulls, most, surely, self.meter)
                distances[-1] = max(hulls, nearer)
                if nearer >= most:
                    continue
                # Meshes that meet have no depth: then the hulls say it.
                if closest is not None and closest.distance > max(_SURE, hulls + _SURE):
                    one, two = self._meshes.ends(pair, closest)
                    contact = Found(i, pair, closest.distance, True, one, two, one)
            found.append(contact)
            if self.pairs.required[pair] - contact.distance > enough:
                break
        met = near[: len(distances)]
        self._recent.keep(corners[met], len(q), point[met], pairs[met], distances)
        fresh = self._record(found, placed, extra)
        self._recent.record(len(q), fresh)
        required_old = asked[point[old], pairs[old]]
        return fresh.joined(
            self._recent.recorded(len(q), point[old], pairs[old], bound[old], required_old)
        )

    def placements(self, q: Array) -> Array:
        """Return the poses (m, j, 4, 4) of the joints at postures (m, n)."""
        placed = np.zeros((len(q), self._model.njoints, 4, 4))
        for i, x in enumerate(q):
            pin.forwardKinematics(self._model, self._data, self.problem.cell.model_q(x))
            placed[i] = [place.homogeneous for place in self._data.oMi]
        return placed

    def capsule_table(self, active: Flags, reduced: Array) -> RowTable:
        """Return rows that keep capsules apart; see `bodies.capsule_table`."""
        return capsule_table(self.pairs, self.joints, active, reduced)

    def capsule_gaps(self, q: Array) -> Array:
        """Return the distance of the capsules minus what is required (m, p) at q (m, n) [m].

        It is never above that of the bodies.
        """
        k, found = self.problem.k, [np.zeros((0, len(self.pairs.number)))]
        for first in range(0, len(q), k):
            part = q[first : first + k]
            found.append(gaps(self._capsules.window(0, len(part)), part))
        result = np.concatenate(found)
        return np.where(self.on_chain, result, -np.inf)

    def _record(
        self,
        found: list[Found],
        placed: Array,
        extra: Array | None,
    ) -> Contacts:
        point = np.array([contact[0] for contact in found], dtype=np.int64)
        pair = np.array([contact[1] for contact in found], dtype=np.int64)
        distance = np.array([contact[2] for contact in found])
        world = np.array([contact[4:] for contact in found]).reshape(-1, 3, 3)
        first, second = (placed[point, self.pairs.joint[pair, side]] for side in (0, 1))
        # Coal gives no normal for meshes; apart, it is the direction between the nearest points.
        between = world[:, 1] - world[:, 0]
        length = np.linalg.norm(between, axis=1)
        apart = distance > _SURE
        world[apart, 2] = between[apart] / length[apart, None]
        required = self.pairs.required[pair]
        if extra is not None:
            required = required + extra[pair, point]
        return Contacts(
            point,
            pair,
            distance,
            required - distance,
            _in_joint(first, world[:, 0] - first[:, :3, 3]),
            _in_joint(second, world[:, 1] - second[:, :3, 3]),
            _in_joint(first, world[:, 2]),
            np.array([contact[3] for contact in found], dtype=bool),
        )


def _in_joint(placed: Array, direction: Array) -> Array:
    """Return directions of the world (c, 3) in axes of joints with poses (c, 4, 4)."""
    return np.asarray(np.einsum("cji,cj->ci", placed[:, :3, :3], direction))


def _relative(first: Array, second: Array) -> Array:
    """Return poses (c, 4, 4) of second bodies in first ones."""
    turned = np.swapaxes(first[..., :3, :3], -1, -2)
    found = np.zeros(first.shape)
    found[..., :3, :3] = turned @ second[..., :3, :3]
    found[..., :3, 3:] = turned @ (second[..., :3, 3:] - first[..., :3, 3:])
    return found


def box_around(points: Array, radius: float) -> Array:
    """Return the corners (8, 3) of a box around points and a radius."""
    low, high = points.min(axis=0) - radius, points.max(axis=0) + radius
    return np.array([np.where(upper, high, low) for upper in np.ndindex(2, 2, 2)])
