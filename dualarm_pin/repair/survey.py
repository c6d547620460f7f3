"""How near the bodies come along a path, and where: convex hulls and meshes by Coal.

Capsules around the bodies say which pairs can be near at all; only those are measured.
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from dualarm_pin.arrays import Array
from dualarm_pin.chain import Integers
from dualarm_pin.engine.solve import gaps
from dualarm_pin.problem import Problem
from dualarm_pin.repair.bodies import OFF_CHAIN, Pairs, capsule_table, joints_on_chain
from dualarm_pin.rows.table import RowTable
from dualarm_pin.solution import Flags
from dualarm_pin.tolerance import TOLERANCE

_SURE = 1e-6  # m: nearer points say nothing of a direction


class Contacts(NamedTuple):
    """Pairs that come near at points of a path; c of them.

    Attributes:
        point: (c,) where.
        pair: (c,) which of the pairs that were asked for.
        distance: (c,) [m], negative in collision.
        lack: (c,) what is missing to the distance that is required [m].
        first: (c, 3) nearest point of the first body, in the frame of its joint [m].
        second: (c, 3) nearest point of the second body, in the frame of its joint [m].
        normal: (c, 3) unit vector from the first to the second body, in the frame of the first.
    """

    point: Integers
    pair: Integers
    distance: Array
    lack: Array
    first: Array
    second: Array
    normal: Array

    def take(self, which: Flags) -> Contacts:
        """Return some of the contacts."""
        return Contacts._make([array[which] for array in self])

    @property
    def kept(self) -> Flags:
        """Which contacts keep what is required, within the tolerance (c,)."""
        enough = self.lack <= TOLERANCE.clearance
        return np.asarray((self.distance > 0.0) & enough)

    @property
    def worst(self) -> float:
        """The largest lack [m]; minus infinity where no pair is near."""
        return float(np.max(self.lack, initial=-np.inf))


class Survey:
    """Measures the pairs of a problem; it keeps Coal's room between calls, so one thread only.

    Attributes:
        problem: The problem.
        pairs: Pairs of which a distance is asked.
        joints: Where their joints are on the chain.
    """

    def __init__(self, problem: Problem, pairs: Pairs) -> None:
        self.problem, self.pairs = problem, pairs
        self.joints = joints_on_chain(problem)
        cell = problem.cell
        self._model, self._data = cell.model, cell.model.createData()
        self._geometry = cell.collision
        self._scene = self._geometry.createData()
        self._meshes = cell.collision_meshes
        self._exact = self._meshes.createData()
        for pair in range(len(self._geometry.collisionPairs)):
            self._scene.deactivateCollisionPair(pair)
        every = np.ones((problem.k, len(pairs.number)), dtype=bool)
        table = self.capsule_table(every, np.zeros(len(pairs.number)))
        self._capsules = replace(problem, inequalities=table)

    def contacts(self, q: Array, reach: float, extra: Array | None = None) -> Contacts:
        """Return the pairs that are nearer than what is required of them and `reach` more.

        Args:
            q: Postures (m, n) [rad or m].
            reach: [m].
            extra: (p, m) what is required of each pair at each posture beyond that [m].
        """
        near = np.flatnonzero((self.capsule_gaps(q) < reach).any(axis=0))
        numbers, required = self.pairs.number[near], self.pairs.required[near] + reach
        found: list[tuple[int, int, float, Array, Array, Array]] = []
        placed = np.zeros((len(q), self._model.njoints, 4, 4))
        for number in numbers:
            self._scene.activateCollisionPair(int(number))
        watched = list(zip(near.tolist(), numbers.tolist(), required.tolist(), strict=True))
        for i, x in enumerate(q) if len(near) else ():
            pin.forwardKinematics(self._model, self._data, self.problem.cell.model_q(x))
            pin.updateGeometryPlacements(self._model, self._data, self._geometry, self._scene)
            pin.computeDistances(self._geometry, self._scene)
            placed[i] = [place.homogeneous for place in self._data.oMi]
            results = self._scene.distanceResults
            for pair, number, enough in watched:
                result = results[number]
                if result.min_distance < enough:
                    if result.min_distance < enough - reach:
                        result = self._as_meshes(number, result)
                    ends = result.getNearestPoint1(), result.getNearestPoint2()
                    found.append((i, pair, result.min_distance, *ends, result.normal))
        for number in numbers:
            self._scene.deactivateCollisionPair(int(number))
        return self._record(found, placed, extra)

    def _as_meshes(self, number: int, hulls: pin.DistanceResult) -> pin.DistanceResult:
        """Return the distance of the meshes as they are, or of the hulls where these meet."""
        pin.updateGeometryPlacements(self._model, self._data, self._meshes, self._exact)
        exact = pin.computeDistance(self._meshes, self._exact, number)
        return exact if exact.min_distance > _SURE else hulls

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
            whole = np.concatenate([part, np.repeat(part[-1:], k - len(part), axis=0)])
            found.append(gaps(self._capsules, whole)[: len(part)])
        result = np.concatenate(found)
        on_chain = (self.joints.segment[self.pairs.joint] != OFF_CHAIN).all(axis=1)
        return np.where(on_chain, result, -np.inf)

    def _record(
        self,
        found: list[tuple[int, int, float, Array, Array, Array]],
        placed: Array,
        extra: Array | None,
    ) -> Contacts:
        point = np.array([contact[0] for contact in found], dtype=np.int64)
        pair = np.array([contact[1] for contact in found], dtype=np.int64)
        distance = np.array([contact[2] for contact in found])
        world = np.array([contact[3:] for contact in found]).reshape(-1, 3, 3)
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
        )


def _in_joint(placed: Array, direction: Array) -> Array:
    """Return directions of the world (c, 3) in axes of joints with poses (c, 4, 4)."""
    return np.asarray(np.einsum("cji,cj->ci", placed[:, :3, :3], direction))
