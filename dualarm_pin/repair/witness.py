"""Rows from contacts: the plane at the nearest point of one body, against that of the other."""

from __future__ import annotations

import numpy as np

from dualarm_pin.arrays import Array
from dualarm_pin.repair.bodies import OFF_CHAIN, in_segment, turned
from dualarm_pin.repair.survey import Contacts, Survey
from dualarm_pin.rows.table import PLANE_POINT, RowTable, pair_table

REACH = 0.15  # m beyond the required distance that have rows: a margin of 0.05 loses starts
BACK_OFF = 3e-4  # m asked beyond what is required, so that what is met nearly is enough
_MOST = 0.05  # m more than there is: the planes are right nearby only


def asked_apart(contacts: Contacts) -> Array:
    """Return how far apart to ask contacts to be in the next round (c,) [m]."""
    required = contacts.distance + contacts.lack
    return np.minimum(required + BACK_OFF, contacts.distance + _MOST)


def witness_table(survey: Survey, contacts: Contacts, apart: Array, k: int) -> RowTable:
    """Return a row for each contact that the chain can move, over k points.

    Args:
        survey: What measured them.
        contacts: Pairs that are near.
        apart: (c,) distance to ask of each [m].
        k: Points of the problem.
    """
    joints, joint = survey.joints, survey.pairs.joint[contacts.pair]
    movable = (joints.segment[joint] != OFF_CHAIN).all(axis=1)
    near, (first, second) = contacts.take(movable), joint[movable].T
    normal = turned(joints, first, near.normal)
    offset = np.sum(normal * in_segment(joints, first, near.first), axis=1) + apart[movable]
    data = np.hstack([normal, offset[:, None], in_segment(joints, second, near.second)])
    segments = joints.segment[first], joints.segment[second]
    return pair_table(k, near.point, PLANE_POINT, *segments, data)
