"""A path held by capsules that are as far apart as the bodies were where both were measured.

The direction between two capsules turns smoothly where nearest points of bodies jump, so a path
that lacks little is mended by two solves, and says what it will cost to come apart.
"""

from __future__ import annotations

from collections.abc import Callable, Generator

import numpy as np

from dualarm_pin.arrays import Array
from dualarm_pin.problem import Problem
from dualarm_pin.repair.bodies import capsule_rows
from dualarm_pin.repair.contacts import Contacts
from dualarm_pin.repair.repaired import Standing
from dualarm_pin.repair.survey import Survey
from dualarm_pin.repair.witness import AMPLE, FIRST_BACK_OFF, asked_apart, witness_table
from dualarm_pin.rows.table import RowTable, extended
from dualarm_pin.solution import Solution

_SOLVES = 2  # the next ones change little
_REACH = 0.04  # m beyond the required distance that have rows
_ROUGHLY, _PROGRESS = 1e-3, 0.8  # m: what lacks less, or shrinks less, is left to planes
# What is left after a solve is not measured: of a small lack [m] next to nothing, else a part.
_SMALL, _LEFT = 0.02, 0.5


def fitted_path(
    survey: Survey, solved: Callable[[Problem, Array], Solution], q: Array
) -> Generator[Standing, None, Array]:
    """Yield where a path (k, n) stands after each solve, and return where they lead.

    Args:
        survey: What measures.
        solved: Solves a problem from a path.
        q: The path.
    """
    lack = np.inf
    for _ in range(_SOLVES):
        contacts = survey.contacts(q, _REACH, ample=AMPLE)
        if contacts.worst <= _ROUGHLY or contacts.worst > _PROGRESS * lack:
            break
        lack = contacts.worst
        end = solved(survey.problem.with_pairs(_rows(survey, contacts, q)), q)
        if not end.feasible:
            yield Standing(end.objective, lack, False)
            break
        q = end.q
        yield Standing(end.objective, 0.0 if lack < _SMALL else _LEFT * lack, False)
    return q


def _rows(survey: Survey, contacts: Contacts, q: Array) -> RowTable:
    """Return a row for each contact at a path: of capsules, or of a plane where there are none."""
    pairs, joints = survey.pairs, survey.joints
    covered = survey.covered[contacts.pair]
    near, other = contacts.take(covered), contacts.take(~covered)
    fatter = -near.lack - survey.capsule_gaps(q)[near.point, near.pair]
    rows = capsule_rows(pairs, joints, len(q), near.point, near.pair, fatter - FIRST_BACK_OFF)
    return extended(rows, witness_table(survey, other, asked_apart(other), len(q)))
