"""Dips: what lacks between two points of a path is asked of both of them."""

from __future__ import annotations

import numpy as np

from dualarm_pin.arrays import Array
from dualarm_pin.repair.survey import Survey

INNER = 3  # postures looked at between two points
DIP = 1.1  # times what lacks between two points is asked of both
ENOUGH = 4e-4  # m: what lacks less is within the tolerance, with some room
_SLACK = 1e-4  # m: what lacks less leaves room for what is between the postures looked at


def inner_postures(q: Array) -> Array:
    """Return the postures between the points of a path (k, n): `INNER` on each straight way."""
    share = np.arange(1, INNER + 1) / (INNER + 1)
    between = q[:-1, None] + share[:, None] * np.diff(q, axis=0)[:, None]
    return between.reshape(-1, q.shape[1])


def add_dips(survey: Survey, q: Array, extra: Array) -> float:
    """Add what lacks between the points to both ends (p, k).

    Returns:
        The most that does [m]; infinite where bodies meet.
    """
    contacts = survey.contacts(inner_postures(q), 0.0)
    meet = contacts.distance <= 0.0
    lacking = contacts.take((contacts.lack > _SLACK) | meet)
    dips = np.zeros((len(extra), len(q) - 1))
    np.maximum.at(
        dips, (lacking.pair, lacking.point // INNER), DIP * np.maximum(lacking.lack, _SLACK)
    )
    extra[:, :-1] += dips
    extra[:, 1:] += dips
    return np.inf if meet.any() else contacts.worst


def with_room(extra: Array, pair: int, line: int, lack: float) -> Array:
    """Return what is asked beyond what is required (p, k), with more room on one line.

    Args:
        extra: What was asked so far [m].
        pair: Which pair needs room.
        line: After which point; before the first one for -1.
        lack: What is missing there [m].
    """
    more = extra.copy()
    more[pair, max(line, 0) : max(line, 0) + 2] += DIP * max(lack, ENOUGH)
    return more
