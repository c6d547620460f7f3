"""What was understood of a cell: the answer to `dualarm-pin check`."""

from __future__ import annotations

import math
from collections import Counter

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from dualarm_pin.cell.cell import Cell
from dualarm_pin.cell.objects import PlacedObject
from dualarm_pin.cell.parts import Arm
from dualarm_pin.cell.report import ArmReport, CellReport, CollisionReport, ObjectReport
from dualarm_pin.relative import Relative
from dualarm_pin.tolerance import TOLERANCE

# Random postures: a rank that is rarer than one in 50 is of no use, and the reach of an arm comes
# out a few per cent short of its true one.
_POSTURES = 50
_REACH_SAMPLES = 1000
_DEG = 180.0 / math.pi


def describe(cell: Cell, seed: int = 0) -> CellReport:
    """Look at a cell.

    Args:
        cell: The cell.
        seed: Of the random postures.
    """
    rng = np.random.default_rng(np.random.SeedSequence(seed))
    postures = rng.uniform(cell.lower, cell.upper, (_POSTURES, cell.n))
    values = [np.linalg.svd(Relative(cell, q).J_r, compute_uv=False) for q in postures]
    ranks = Counter(int((s > TOLERANCE.singular).sum()) for s in values)
    samples = rng.uniform(cell.lower, cell.upper, (_REACH_SAMPLES, cell.n))
    return CellReport(
        name=cell.name,
        arms=(_arm(cell, 0, samples), _arm(cell, 1, samples)),
        joints=cell.joints,
        locked=cell.locked,
        ranks={rank: ranks[rank] / _POSTURES for rank in sorted(ranks, reverse=True)},
        smallest_singular_value=float(np.median([s[5] if len(s) > 5 else 0.0 for s in values])),
        postures=_POSTURES,
        objects=tuple(_object(cell, thing) for thing in cell.objects),
        collision=_collision(cell, postures),
        links_without_inertia=cell.links_without_inertia,
        warnings=cell.warnings,
        sources={str(source.path): source.sha256 for source in cell.sources},
    )


def _arm(cell: Cell, number: int, samples: NDArray[np.float64]) -> ArmReport:
    arm = cell.arms[number]
    return ArmReport(
        name=arm.name,
        urdf=None if arm.file is None else str(arm.file),
        root=arm.root,
        tip=arm.tip,
        joints=len(arm.joints),
        base_xyz=_rounded(arm.base.translation),
        base_rpy_deg=_rounded(pin.rpy.matrixToRpy(arm.base.rotation) * _DEG),
        tool_xyz=_rounded(arm.tool.translation),
        tool_rpy_deg=_rounded(pin.rpy.matrixToRpy(arm.tool.rotation) * _DEG),
        tool_axis=_rounded(arm.tool.rotation @ cell.tool_axes[number]),
        reach=_reach(cell, arm, (cell.e1, cell.e2)[number], samples),
    )


def _reach(cell: Cell, arm: Arm, tool: int, samples: NDArray[np.float64]) -> float | None:
    if not arm.joints:
        return None
    first = cell.model.getJointId(arm.joints[0])
    data, largest = cell.data(), 0.0
    for q in samples:
        pin.forwardKinematics(cell.model, data, cell.model_q(q))
        hand = pin.updateFramePlacement(cell.model, data, tool).translation
        largest = max(largest, float(np.linalg.norm(hand - data.oMi[first].translation)))
    return round(largest, 3)


def _object(cell: Cell, thing: PlacedObject) -> ObjectReport:
    [item] = [each for each in cell.collision.geometryObjects if each.name == thing.name]
    item.geometry.computeLocalAABB()
    box = item.geometry.aabb_local
    return ObjectReport(
        name=thing.name,
        what=thing.text,
        on=thing.on,
        xyz=_rounded(thing.pose.translation),
        rpy_deg=_rounded(pin.rpy.matrixToRpy(thing.pose.rotation) * _DEG),
        size=tuple(round(float(length), 6) for length in np.array(box.max_) - np.array(box.min_)),
        pairs=sum(thing.name in pair for pair in cell.pairs),
        allowed=tuple(sorted(thing.allowed)),
    )


def _collision(cell: Cell, postures: NDArray[np.float64]) -> CollisionReport:
    found = [cell.clearance(q) for q in postures]
    distances = [clearance.distance for clearance in found if clearance is not None]
    return CollisionReport(
        known=bool(distances),
        bodies=len(cell.collision.geometryObjects),
        pairs=len(cell.collision.collisionPairs),
        dropped=cell.dropped_pairs,
        missing=cell.missing_meshes,
        free_share=float(np.mean(np.array(distances) > 0)) if distances else None,
    )


def _rounded(vector: NDArray[np.float64]) -> tuple[float, ...]:
    return tuple(round(float(value), 9) + 0.0 for value in vector)
