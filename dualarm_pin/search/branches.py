"""Other branches of a posture: three joints in a row that give the same motion in another way.

Two joints with the one between them square to both, as a wrist or a shoulder has them, give every
rotation twice; three parallel ones, as a shoulder, an elbow and a wrist in one plane, reach every
place of the plane twice. Where axes miss each other by an offset the other branch is merely near,
and a solve of the point finds it.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from dualarm_pin.chain import REVOLUTE, VARIABLE, segments
from dualarm_pin.problem import Problem
from dualarm_pin.search.turns import TURN

Array = NDArray[np.float64]
_SQUARE = 0.02  # cosine between axes that count as square, and its distance from 1 if as parallel
_CUT = 0.3  # rad: a branch farther outside the bounds is not looked at
_SHORT = 1e-3  # m: two parallel axes nearer than this are one


class Branches:
    """The triples of joints of a problem that have a second branch.

    Attributes:
        middles: Element in the middle of each triple.
    """

    def __init__(self, problem: Problem) -> None:
        self.problem, chain = problem, problem.chain
        single = np.bincount(chain.source[chain.role == VARIABLE], minlength=problem.n) == 1
        moves = (chain.kind == REVOLUTE) & (chain.role == VARIABLE) & (chain.scale != 0.0)
        free = moves & single[chain.source] & (problem.lower < problem.upper)[chain.source]
        somewhere = 0.5 * (problem.lower + problem.upper)
        inner = (e for e in range(1, len(free) - 1) if free[e - 1 : e + 2].all())
        self.middles = [e for e in inner if self._delta(somewhere, e) is not None]

    def other(self, q: Array, random: np.random.Generator) -> Array | None:
        """Return q (n,) with the other branch of a triple that is drawn, or None without any.

        A branch that a bound cuts off by far is none.
        """
        for e in random.permutation(self.middles):
            moved = self._moved(q, int(e))
            if moved is not None:
                return moved
        return None

    def _moved(self, q: Array, e: int) -> Array | None:
        problem, chain, moved = self.problem, self.problem.chain, q.copy()
        delta = self._delta(q, e)
        if delta is None:
            return None
        for at, angle in zip(range(e - 1, e + 2), delta, strict=True):
            j = chain.source[at]
            wanted = q[j] + angle / chain.scale[at] + TURN * np.arange(-2, 3)
            inside = np.clip(wanted, problem.lower[j], problem.upper[j])
            cut = np.abs(wanted - inside)
            best = np.lexsort((np.abs(wanted - q[j]), np.round(cut, 6)))[0]
            if cut[best] > _CUT:
                return None
            moved[j] = inside[best]
        return moved

    def _delta(self, q: Array, e: int) -> tuple[float, float, float] | None:
        """Return by how much elements e - 1, e, e + 1 turn, or None without a second branch."""
        poses = segments(self.problem.chain, q)[e - 1 : e + 2]
        before, axis, after = (pose.rotation[:, 2] for pose in poses)
        cosines = np.array([before @ axis, after @ axis])
        if np.all(np.abs(cosines) < _SQUARE):
            return np.pi, 2.0 * _angle(after, before, axis), np.pi
        if np.any(np.abs(cosines) < 1.0 - _SQUARE):
            return None
        first = poses[1].translation - poses[0].translation
        second = poses[2].translation - poses[1].translation
        first, second = first - (first @ axis) * axis, second - (second @ axis) * axis
        if min(np.linalg.norm(first), np.linalg.norm(second)) < _SHORT:
            return None
        turn = 2.0 * _angle(second, first, axis)
        turned = np.cos(turn) * second + np.sin(turn) * np.cross(axis, second)
        back = _angle(first + turned, first + second, axis)
        return back * np.sign(cosines[0]), turn, -(back + turn) * np.sign(cosines[1])


def _angle(one: Array, other: Array, axis: Array) -> float:
    """Return the angle about a unit axis that turns one vector into the direction of another."""
    flat = one @ other - (one @ axis) * (other @ axis)
    return float(np.arctan2(axis @ np.cross(one, other), flat))
