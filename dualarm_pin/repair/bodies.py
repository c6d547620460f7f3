"""The pairs of bodies that must stay apart, as the chain of a problem sees them."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import pinocchio as pin

from dualarm_pin.arrays import Array
from dualarm_pin.cell.parts import Pair
from dualarm_pin.chain import Integers, body_of, segments
from dualarm_pin.errors import InputError
from dualarm_pin.problem import Problem
from dualarm_pin.repair.covers import cover, hull_of
from dualarm_pin.rows.table import CAPSULES, RowTable, pair_table
from dualarm_pin.solution import Flags
from dualarm_pin.tolerance import TOLERANCE

if TYPE_CHECKING:
    from dualarm_pin.cell import Cell

OFF_CHAIN = -1


class Joints(NamedTuple):
    """Where the joints of a model are on the chain; 0 is the world.

    Attributes:
        segment: (j,) segment that moves with each, or OFF_CHAIN.
        rotation: (j, 3, 3) of the joint's frame in that of the segment.
        translation: (j, 3) [m].
    """

    segment: Integers
    rotation: Array
    translation: Array


class Pairs(NamedTuple):
    """Pairs of which a distance is asked.

    Attributes:
        number: (p,) which of the cell's collision pairs.
        names: The two bodies of each.
        required: (p,) distance that they must keep [m]; the tolerance where they must not touch.
        joint: (p, 2) joints that their bodies move with.
        ends: (p, 2, 2, 3) segments of the capsules around them, in the frames of these joints [m].
        radius: (p, 2) of the capsules [m].
        tight: (p,) whether the capsules say something about the bodies.
        loose: (p,) whether the bodies move with different arms, or one of them stands.
        hulls: Points and a radius whose hull holds the second body, in the frame of its joint [m].
    """

    number: Integers
    names: tuple[Pair, ...]
    required: Array
    joint: Integers
    ends: Array
    radius: Array
    tight: Array
    loose: Flags
    hulls: tuple[tuple[Array, float], ...]


def asked_pairs(cell: Cell, required: Array) -> Pairs:
    """Return the pairs of a cell of which a distance is asked.

    Args:
        cell: The two arms.
        required: Distance that each of the cell's pairs must keep (p,) [m]; -inf for nothing.
    """
    geometry, names = cell.collision, cell.pairs
    covers = [cover(thing) for thing in geometry.geometryObjects]
    hulls = [hull_of(thing) for thing in geometry.geometryObjects]
    joints = [int(thing.parentJoint) for thing in geometry.geometryObjects]
    chosen = np.flatnonzero(required > -np.inf)
    bodies = [(pair.first, pair.second) for pair in geometry.collisionPairs]
    both = [bodies[k] for k in chosen]
    return Pairs(
        number=chosen,
        names=tuple(names[k] for k in chosen),
        # A distance may be missed by the tolerance but for contact, which is never accepted.
        required=np.maximum(required[chosen], TOLERANCE.clearance),
        joint=np.array([[joints[b] for b in pair] for pair in both], np.int64).reshape(-1, 2),
        ends=np.array([[covers[b].ends for b in pair] for pair in both]).reshape(-1, 2, 2, 3),
        radius=np.array([[covers[b].radius for b in pair] for pair in both]).reshape(-1, 2),
        tight=np.array([all(covers[b].tight for b in pair) for pair in both], dtype=bool),
        loose=cell.apart_by_nature[chosen],
        hulls=tuple(hulls[second] for _, second in both),
    )


def joints_on_chain(problem: Problem) -> Joints:
    """Return where the joints of the cell's model are on the chain that a problem ends in."""
    cell, count = problem.cell, problem.cell.model.njoints
    found = Joints(
        np.full(count, OFF_CHAIN, dtype=np.int64), np.zeros((count, 3, 3)), np.zeros((count, 3))
    )
    q = np.zeros(cell.n)
    places = segments(problem.chain, q)
    model, data = cell.model, cell.model.createData()  # not the room that `body_of` works in
    pin.forwardKinematics(model, data, cell.model_q(q))
    e1 = pin.SE3(pin.updateFramePlacement(model, data, cell.e1))
    frames = {int(model.frames[f].parentJoint): f for f in range(model.nframes)}
    for joint in range(count):
        try:
            segment = body_of(cell, 0 if joint == 0 else frames[joint]).segment
        except InputError:  # it moves both arms: no row can hold it
            continue
        placement = places[segment].actInv(e1.actInv(data.oMi[joint]))
        found.segment[joint] = segment
        found.rotation[joint], found.translation[joint] = placement.rotation, placement.translation
    return found


def in_segment(joints: Joints, joint: Integers, position: Array) -> Array:
    """Return positions (c, 3) given in frames of joints (c,), in the frames of their segments."""
    return np.asarray(joints.translation[joint] + turned(joints, joint, position))


def turned(joints: Joints, joint: Integers, direction: Array) -> Array:
    """Return directions (c, 3) given in frames of joints (c,), in axes of their segments."""
    return np.asarray(np.einsum("cij,cj->ci", joints.rotation[joint], direction))


def capsule_table(pairs: Pairs, joints: Joints, active: Flags, reduced: Array) -> RowTable:
    """Return rows that keep capsules of pairs apart.

    Args:
        pairs: The pairs.
        joints: Where their joints are on the chain.
        active: (k, p) which pair has a row at which point.
        reduced: (p,) taken off what their segments must keep [m].
    """
    point, pair = np.nonzero(active)
    return capsule_rows(pairs, joints, len(active), point, pair, reduced[pair])


def capsule_rows(
    pairs: Pairs, joints: Joints, k: int, point: Integers, pair: Integers, reduced: Array
) -> RowTable:
    """Return one row for each of c capsules.

    Args:
        pairs: The pairs.
        joints: Where their joints are on the chain.
        k: Points of the problem.
        point: (c,) where each row holds, ascending.
        pair: (c,) of which pair.
        reduced: (c,) taken off what their segments must keep [m].
    """
    joint = pairs.joint[pair]
    ends = [
        in_segment(joints, joint[:, side], pairs.ends[pair, side, end])
        for side in (0, 1)
        for end in (0, 1)
    ]
    apart = np.maximum(pairs.radius[pair].sum(axis=1) + pairs.required[pair] - reduced, 0.0)
    first, second = np.maximum(joints.segment[joint], 0).T
    data = np.hstack([*ends, apart[:, None]])
    return pair_table(k, point, CAPSULES, first, second, data)
