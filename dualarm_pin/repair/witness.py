"""Rows from contacts: the plane at the nearest point of one body, against points of the other.

A plane that has the first body on one side and all corners of the second on the other keeps them
apart wherever they move. The nearest point alone is enough for a small step; the corners that a
longer step brings through the plane are added to its rows (`cuts`).
"""

from __future__ import annotations

import numpy as np

from dualarm_pin.arrays import Array
from dualarm_pin.repair.bodies import in_segment, turned
from dualarm_pin.repair.contacts import Contacts
from dualarm_pin.repair.survey import Survey
from dualarm_pin.rows.table import PLANE_POINT, RowTable, pair_table

REACH = 0.06  # m beyond the required distance that have rows; what comes nearer is added later
# m asked beyond what is required, so that what is met nearly is enough: more of it until a path is
# apart for the first time, which saves rounds.
BACK_OFF, FIRST_BACK_OFF = 3e-4, 1e-3
AMPLE = 1e-3  # m more than is asked: what surely keeps it is not measured anew while a path moves
_MOST = 0.05  # m more than there is: the planes are right nearby only
_NEAR = 1e-6  # m: a corner so near a plane has a row, or needs none


def asked_apart(contacts: Contacts, back_off: float = BACK_OFF) -> Array:
    """Return how far apart to ask contacts to be in the next round (c,) [m]."""
    required = contacts.distance + contacts.lack
    return np.minimum(required + back_off, contacts.distance + _MOST)


def witness_table(survey: Survey, contacts: Contacts, apart: Array, k: int) -> RowTable:
    """Return a row for each contact that the chain can move, over k points.

    Args:
        survey: What measured them.
        contacts: Pairs that are near.
        apart: (c,) distance to ask of each [m].
        k: Points of the problem.
    """
    joints, joint = survey.joints, survey.pairs.joint[contacts.pair]
    movable = survey.on_chain[contacts.pair]
    near, (first, second) = contacts.take(movable), joint[movable].T
    normal = turned(joints, first, near.normal)
    offset = np.sum(normal * in_segment(joints, first, near.first), axis=1) + apart[movable]
    data = np.hstack([normal, offset[:, None], in_segment(joints, second, near.second)])
    segments = joints.segment[first], joints.segment[second]
    return pair_table(k, near.point, PLANE_POINT, *segments, data)


def cuts(
    survey: Survey, held: Contacts, end: Array, lacking: Contacts
) -> tuple[Contacts, Contacts]:
    """Return what else has to be held, so that the solve does not end there again.

    Args:
        survey: What measured the contacts.
        held: What was held.
        end: (k, n) where the solve ended.
        lacking: What lacks there.

    Returns:
        For each lacking pair the corner of its second body that is farthest through a plane held
        (c of them), and of others the contact at the end itself.
    """
    many = len(survey.pairs.number)
    bad = lacking.point * many + lacking.pair
    chosen = np.flatnonzero(np.isin(held.point * many + held.pair, bad) & ~held.exact)
    placed = survey.placements(end)
    found: dict[int, tuple[float, int, Array]] = {}
    for c in chosen.tolist():
        point, pair = int(held.point[c]), int(held.pair[c])
        first, second = (placed[point, joint] for joint in survey.pairs.joint[pair])
        normal = second[:3, :3].T @ first[:3, :3] @ held.normal[c]
        middle = first[:3, :3] @ held.first[c] + first[:3, 3] - second[:3, 3]
        points, radius = survey.pairs.hulls[pair]
        height = points @ normal - middle @ (second[:3, :3] @ normal)
        lowest = int(np.argmin(height))
        foot = points[lowest] - radius * normal
        key, deep = point * many + pair, float(height[lowest]) - radius
        known = held.second[chosen[held.point[chosen] * many + held.pair[chosen] == key]]
        if np.abs(known - foot).max(axis=1).min() > _NEAR and deep < found.get(key, (np.inf,))[0]:
            found[key] = deep, c, foot
    corners = held.take(np.array([c for _, c, _ in found.values()], dtype=np.int64))
    corners = corners._replace(second=np.array([f for *_, f in found.values()]).reshape(-1, 3))
    return corners, lacking.take(~np.isin(bad, np.array(list(found), dtype=np.int64)))


def on_planes(corners: Contacts, contacts: Contacts, many: int) -> Contacts:
    """Return corners against the planes of newer contacts of their pairs, where there are any.

    Args:
        corners: As `cuts` found them.
        contacts: At another path.
        many: Pairs that there are.
    """
    key, old = contacts.point * many + contacts.pair, corners.point * many + corners.pair
    order = np.argsort(key)
    at = order[np.minimum(np.searchsorted(key[order], old), len(key) - 1)] if len(key) else old[:0]
    if not len(key):
        return corners.take(at)
    there = (key[at] == old) & ~contacts.exact[at]
    return contacts.take(at[there])._replace(second=corners.second[there])
