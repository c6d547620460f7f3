"""Distances of meshes as they are; measuring is dear, so what was measured nearby stands for it."""

from __future__ import annotations

import coal
import numpy as np
import pinocchio as pin

from dualarm_pin.arrays import Array
from dualarm_pin.cell.solids import Solids
from dualarm_pin.problem import Problem
from dualarm_pin.repair.bodies import Pairs
from dualarm_pin.repair.known import Known, Measured
from dualarm_pin.repair.meter import Meter


class Meshes:
    """The meshes of some pairs of a cell.

    Args:
        problem: Whose cell has them.
        pairs: The pairs.
        boxes: Corners (p, 8, 3) of boxes around the second bodies, in their joints' frames [m].
        data: Pinocchio's, in which the postures of the cell are computed.
    """

    def __init__(self, problem: Problem, pairs: Pairs, boxes: Array, data: pin.Data) -> None:
        self._model, self._data = problem.cell.model, data
        self._bodies = problem.cell.collision_meshes
        self._scene, self._solids = self._bodies.createData(), Solids(self._bodies)
        self._number, self._joint = pairs.number.tolist(), pairs.joint.tolist()
        self._known = [Known(box) for box in boxes]
        self._placed = False

    def moved(self) -> None:
        """Take note that the data hold another posture."""
        self._placed = False

    def keep(
        self, pair: int, pose: Array, hulls: float, most: float, ample: float, meter: Meter
    ) -> tuple[float, Measured | None]:
        """Return a distance that a pair keeps, and what was measured, if it is less than `most`.

        Args:
            pair: Which.
            pose: (4, 4) of the second body in the first.
            hulls: The distance of their hulls [m].
            most: Meshes so far apart are not looked at more closely [m].
            ample: What surely keeps so much is not measured anew [m].
            meter: Counts what is measured.
        """
        least, met, last, same = self._known[pair].least(pose)
        if last is not None and same:
            return last.distance, last
        if met or least >= most:
            return least, None
        if last is not None and least >= ample:
            return least, last._replace(distance=least)
        if not self._placed:
            pin.updateGeometryPlacements(self._model, self._data, self._bodies, self._scene)
            self._placed = True
        # A body that was outside another cannot be in it before the two have met.
        outside = np.inf if least > 0.0 else hulls
        nearer = self._solids.distance(self._number[pair], self._scene, outside, most)
        meter.meshes(self._solids.triangles(self._number[pair]))
        return float(nearer.min_distance), self._remember(pair, pose, nearer, most)

    def ends(self, pair: int, measured: Measured) -> list[Array]:
        """Return the nearest points of a pair, as measured, in the world of the posture [m]."""
        return [
            np.asarray(self._data.oMi[joint].act(point))
            for joint, point in zip(self._joint[pair], measured[1:], strict=True)
        ]

    def _remember(
        self, pair: int, pose: Array, nearer: coal.DistanceResult, most: float
    ) -> Measured | None:
        """Keep what was measured between meshes; return it where they are nearer than `most`."""
        distance, measured = float(nearer.min_distance), None
        if distance < most:
            ends = nearer.getNearestPoint1(), nearer.getNearestPoint2()
            points = [
                self._data.oMi[joint].actInv(np.array(point))
                for joint, point in zip(self._joint[pair], ends, strict=True)
            ]
            measured = Measured(distance, *points)
        self._known[pair].add(pose, distance, measured)
        return measured
