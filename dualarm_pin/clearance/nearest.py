"""Which two bodies are nearest along a motion, and where on them: for pictures."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin

from dualarm_pin.arrays import Array, Integers
from dualarm_pin.clearance.rule import keeps

if TYPE_CHECKING:
    from dualarm_pin.cell import Cell

INNER = 3  # places between two points that are looked at, as the check does


@dataclass(frozen=True, eq=False)
class Nearest:
    """The nearest two bodies at m places of a motion, the points of its path among them.

    Attributes:
        pair: Which of `Cell.pairs` (m,).
        distance: Its distance (m,) [m].
        first: Nearest point of the first body, in the frame of its joint (m, 3) [m].
        second: The same of the second body (m, 3) [m].
        lacking: Bodies that are nearer to another than is asked for, at each place.
    """

    pair: Integers
    distance: Array
    first: Array
    second: Array
    lacking: tuple[tuple[str, ...], ...]


def nearest_along(cell: Cell, q: Array, required: Array, *, inner: int = INNER) -> Nearest | None:
    """Return what is nearest on straight lines between postures.

    Bodies of different arms, objects and what stands still count; links of one arm, which are
    always near each other, only where they lack what is asked for.

    Args:
        cell: The two arms.
        q: Postures (h, n) [rad or m].
        required: What each of `Cell.pairs` must keep (p,) [m]; -inf leaves a pair out.
        inner: Places between two postures that are looked at.

    Returns:
        None where no pair counts.
    """
    counts = np.flatnonzero(required > -np.inf)
    apart = cell.apart_by_nature
    if not np.any(apart[counts]):
        return None
    at = np.arange((len(q) - 1) * (inner + 1) + 1) / (inner + 1)
    line = np.minimum(at.astype(int), len(q) - 2)
    places = q[line] + (at - line)[:, None] * (q[line + 1] - q[line])
    geometry, data, scene = cell.collision, cell.model.createData(), cell.collision.createData()
    pair, distance = np.zeros(len(places), dtype=np.int64), np.zeros(len(places))
    ends = np.zeros((2, len(places), 3))
    lacking: list[tuple[str, ...]] = []
    for i, posture in enumerate(places):
        pin.computeDistances(cell.model, data, geometry, scene, cell.model_q(posture))
        seen = np.array([result.min_distance for result in scene.distanceResults])
        near = counts[seen[counts] < np.maximum(required[counts], 0.0)]
        for k in near:
            seen[k] = cell.distance(posture, int(k), exact=True)
        short = [k for k in near if not keeps(float(seen[k]), float(required[k]))]
        lacking.append(tuple(sorted({body for k in short for body in cell.pairs[k]})))
        chosen = counts[apart[counts] | np.isin(counts, short)]
        k = int(chosen[np.argmin(seen[chosen])])
        pair[i], distance[i] = k, seen[k]
        result, bodies = scene.distanceResults[k], geometry.collisionPairs[k]
        for end, (body, point) in enumerate(
            zip(
                (bodies.first, bodies.second),
                (result.getNearestPoint1(), result.getNearestPoint2()),
                strict=True,
            )
        ):
            joint = geometry.geometryObjects[body].parentJoint
            ends[end, i] = data.oMi[joint].actInv(np.array(point))
    return Nearest(pair, distance, ends[0], ends[1], tuple(lacking))
