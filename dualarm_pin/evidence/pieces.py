"""The path in pieces that overlap by one point: where to cut, and the problem of each piece.

Both pieces at a cut get half of the shared point's index and linear term, and +theta . q on the
left, -theta . q on the right: for one path cut up, the parts sum to the objective, whatever theta
is. So for any theta the sum of the pieces' own minima is at most the objective of every path.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dualarm_pin.arrays import Array
from dualarm_pin.problem import Problem
from dualarm_pin.tolerance import TOLERANCE

Cuts = tuple[int, ...]

_UNCUT = 3  # paths of no more points are left whole
# Of the paper's 31 points, 3 pieces of 11 are bounded in 2 s with a gap of 0.001 %, 6 of 6 in 22 s.
_SIZE = 11
_MOST_PIECES = 12  # every cut adds n multipliers, and steps


@dataclass(frozen=True, eq=False)
class PathPiece:
    """One piece, with theta = 0.

    Attributes:
        points: Its points on the path.
        problem: Its problem, shared terms halved.
        left: Which cut it begins at, or None at the first point of the path.
        right: Which cut it ends at, or None.
    """

    points: range
    problem: Problem
    left: int | None
    right: int | None

    def tilted(self, theta: Array) -> Problem:
        """Return its problem with the multipliers theta (cuts, n)."""
        linear = self.problem.points.linear.copy()
        if self.left is not None:
            linear[0] -= theta[self.left]
        if self.right is not None:
            linear[-1] += theta[self.right]
        return self.problem.with_points(linear=linear)

    def slopes(self, q: Array, cuts: int) -> Array:
        """Return d(tilt)/d(theta) (s, cuts, n) at paths of the piece q (s, points, n)."""
        slope = np.zeros((len(q), cuts, self.problem.n))
        if self.left is not None:
            slope[:, self.left] -= q[:, 0]
        if self.right is not None:
            slope[:, self.right] += q[:, -1]
        return slope


def split(problem: Problem, cuts: Cuts) -> list[PathPiece]:
    """Cut a problem at some of its inner points.

    Args:
        problem: The problem.
        cuts: Points, from 0, increasing, neither the first nor the last.
    """
    ends = (0, *cuts, problem.k - 1)
    share = np.ones(problem.k)
    share[list(cuts)] = 0.5
    points = problem.points
    halved = problem.with_points(
        index_weight=points.index_weight * share, linear=points.linear * share[:, None]
    )
    pieces = []
    for number, (begin, end) in enumerate(itertools.pairwise(ends)):
        piece = halved.window(begin, end + 1 - begin)
        left = None if number == 0 else number - 1
        right = None if number == len(cuts) else number
        pieces.append(PathPiece(range(begin, end + 1), piece, left, right))
    return pieces


def cut_sets(problem: Problem) -> list[Cuts]:
    """Return the sets of cuts to try: pieces of about 11 points, then half and a quarter as many.

    Larger pieces give a higher bound where neighbours are strongly linked, but a search misses
    their minima more easily. A short path is tried whole last; one of three points or fewer is
    not cut at all.
    """
    k = problem.k
    if k <= _UNCUT:
        return [()]
    sharp = _sharp(problem)
    pieces = min(max(2, round((k - 1) / (_SIZE - 1))), _MOST_PIECES)
    found = [_place(sharp, number) for number in (pieces, pieces / 2.0, pieces / 4.0)]
    if k <= _SIZE:
        found.append(())
    return list(dict.fromkeys(found))


def _place(sharp: NDArray[np.bool_], wanted_pieces: float) -> Cuts:
    """Return evenly spread cuts, moved by up to half a piece, or dropped, to miss sharp points."""
    last = len(sharp) - 1
    pieces = max(2, math.ceil(wanted_pieces))
    length = last / pieces
    cuts: list[int] = []
    for number in range(1, pieces):
        wanted = number * length
        near = [i for i in range(1, last) if abs(i - wanted) <= length / 2.0 and not sharp[i]]
        near = [i for i in near if not cuts or i > cuts[-1]]
        if near:
            cuts.append(min(near, key=lambda i: abs(i - wanted)))
    return tuple(cuts) if cuts else (max(1, round(last / 2)),)


def _sharp(problem: Problem) -> NDArray[np.bool_]:
    """Tell which points (k,) lie where the direction or the rotation turns much."""
    turn = np.linalg.norm(np.diff(problem.points.u, axis=0), axis=1)
    turn += np.linalg.norm(np.diff(problem.points.rotation, axis=0), axis=(1, 2))
    bend = np.zeros(problem.k)
    bend[:-1] += turn
    bend[1:] += turn
    return np.asarray(bend > 2.0 * bend.mean() + TOLERANCE.coincident)
