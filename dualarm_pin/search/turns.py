"""Full turns: a joint whose range is wider than one turn takes the same posture several times.

Two paths that differ by a full turn of such a joint are one path; `folded` picks the one that lies
nearest to the middle of the range. It is never nearer to a bound than the path given.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from dualarm_pin.chain import REVOLUTE, VARIABLE
from dualarm_pin.problem import Problem
from dualarm_pin.tolerance import TOLERANCE

Array = NDArray[np.float64]
TURN = 2.0 * np.pi


class Turns:
    """Which joints of a problem are wide, and what follows from it.

    Attributes:
        wide: Whether a joint may turn by more than a full turn, and nothing but its sine and
            cosine counts (n,).
        lower: Lower end of one turn of the wide joints about their middle, and of the range of
            the others (n,).
        upper: Upper end of it (n,).
    """

    def __init__(self, problem: Problem) -> None:
        chain, index = problem.chain, problem.index
        middle, room = 0.5 * (problem.lower + problem.upper), problem.upper - problem.lower
        whole = np.zeros(problem.n, dtype=bool)
        moves = chain.role == VARIABLE
        whole[chain.source[moves]] = True
        turns = (chain.kind == REVOLUTE) & (np.abs(chain.scale) == 1.0)
        whole[chain.source[moves & ~turns]] = False
        self.wide = whole & (room > TURN + TOLERANCE.fixed_joint) & (index.joint_centre == 0.0)
        if problem.neighbours.weight.any():  # a posture that is given is not another by full turns
            self.wide = np.zeros(problem.n, dtype=bool)
        self.lower = np.where(self.wide, middle - np.pi, problem.lower)
        self.upper = np.where(self.wide, middle + np.pi, problem.upper)
        self._middle = middle

    def folded(self, q: Array) -> Array:
        """Return paths (s, k, n), every wide joint shifted by full turns to the middle."""
        if not len(q):
            return q
        away = 0.5 * (q.min(axis=1) + q.max(axis=1)) - self._middle
        turns = np.where(self.wide, np.round(away / TURN), 0.0)
        return np.asarray(q - TURN * turns[:, None, :])

    def widened(self, problem: Problem) -> Problem:
        """Return the problem with a turn more at both ends of every wide joint, for walks."""
        room = np.where(self.wide, TURN, 0.0)
        return problem.with_bounds(problem.lower - room, problem.upper + room)
