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
        self._middle, self._room = middle, room

    def folded(self, q: Array) -> Array:
        """Return paths (s, k, n), every wide joint shifted by full turns to the middle."""
        if not len(q):
            return q
        away = 0.5 * (q.min(axis=1) + q.max(axis=1)) - self._middle
        return np.asarray(q - TURN * self._turns(away)[:, None, :])

    def joined(
        self, path: Array, window: Array, first: int, beside: Array
    ) -> tuple[Array, Array, Array]:
        """Return a path, a window to be put into it and the postures beside that window, turned.

        Where the window ends a full turn from where the path goes on, the path behind it is turned
        rather than the window unwound: it takes the same postures. Joints without the room for
        that stay as they are.

        Args:
            path: (k, n).
            window: (w, n), that goes in from point `first` on.
            first: Its first point.
            beside: Postures (2, n) before and behind the window.
        """
        if not self.wide.any():
            return path, window, beside
        last, behind = first + len(window), np.zeros(len(self.wide))
        if first:
            window = window - TURN * self._turns(window[0] - beside[0])
        if last < len(path):
            behind = self._turns(window[-1] - beside[1])
        whole = np.concatenate([path[:first], window, path[last:] + TURN * behind])
        behind[np.ptp(whole, axis=0) > self._room] = 0.0
        whole[last:] = path[last:] + TURN * behind
        away = TURN * self._turns(0.5 * (whole.min(axis=0) + whole.max(axis=0)) - self._middle)
        rest = path - away
        rest[last:] += TURN * behind
        return rest, window - away, np.stack([beside[0] - away, beside[1] + TURN * behind - away])

    def nearest(self, difference: Array) -> Array:
        """Return differences (..., n) of postures, wide joints without full turns."""
        return np.asarray(difference - TURN * self._turns(difference))

    def unwound(self, q: Array) -> Array | None:
        """Return a path (k, n) without jumps by full turns, or None where the room is too small."""
        steps = np.diff(q, axis=0)
        path = q.copy()
        path[1:] += np.cumsum(self.nearest(steps) - steps, axis=0)
        if np.any(np.ptp(path, axis=0)[self.wide] > self._room[self.wide]):
            return None
        return np.asarray(self.folded(path[None])[0])

    def widened(self, problem: Problem) -> Problem:
        """Return the problem with a turn more at both ends of every wide joint, for walks."""
        room = np.where(self.wide, TURN, 0.0)
        return problem.with_bounds(problem.lower - room, problem.upper + room)

    def _turns(self, difference: Array) -> Array:
        """Return how many full turns differences (..., n) hold, of wide joints."""
        return np.where(self.wide, np.round(difference / TURN), 0.0)
