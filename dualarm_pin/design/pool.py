"""The best distinct minima of one problem, solved again from where they were at every change.

Basins change rank while a base is moved; one basin alone may even end. A few of them together
follow the best value much longer.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from dualarm_pin.engine.interior_point.solve_one import CONVERGED
from dualarm_pin.engine.solve import Options, solve, solve_many
from dualarm_pin.problem import Problem
from dualarm_pin.search.starts import generator
from dualarm_pin.solution import Solution, distinct, same_path
from dualarm_pin.tolerance import TOLERANCE

Array = NDArray[np.float64]

_WARM = Options.warm(iterations=60)
_AGAIN = Options(iterations=100, mu0=1e-2, push=1e-3)  # where a warm solve failed
_TURN = 2  # members followed in a hurry: the best, and one of the others in turn
_POSTURES, _REFINED = 200, 10  # at each of three points; the best of them over the whole path
_ROUGH = Options(tolerance=1e-4, iterations=60)
_KEY = 50  # of the generator


@dataclass(frozen=True, eq=False)
class Member:
    """One minimum.

    Attributes:
        number: Its number since the session began; it keeps it while it is followed.
        solution: Joints, objective and multipliers.
        change: The last change that it followed.
    """

    number: int
    solution: Solution
    change: int


class Pool:
    """At most `size` minima, best first."""

    def __init__(self, size: int) -> None:
        self.size = size
        self.members: tuple[Member, ...] = ()
        self.lost = 0  # members that did not survive the last change
        self._numbered = self._changes = 0

    def follow(self, problem: Problem, *, whole: bool = True) -> None:
        """Solve members again where things stand now; drop what fails or meets another.

        Args:
            problem: Where things stand.
            whole: Every member; else the best, the one that has waited longest, and those that
                were better where they were last seen: the best is always of now.
        """
        before, ends = len(self.members), list[Member]()
        self._changes += 1
        waiting = list(self.members)  # best first
        if not whole and waiting:
            waiting.sort(key=lambda member: (member is not self.members[0], member.change))
        for count, member in enumerate(waiting):
            best = min((end.solution.objective for end in ends), default=np.inf)
            if whole or count < _TURN or member.solution.objective < best:
                ends += self._followed(problem, member)
            else:
                ends.append(member)
        self._keep(ends)
        self.lost = before - len(self.members)

    def _followed(self, problem: Problem, member: Member) -> list[Member]:
        """Return a member where things stand now; nothing where it has ended."""
        old = member.solution
        new = solve(problem, old.q, _WARM, warm=old.multipliers)
        if not new.converged:
            new = solve(problem, old.q, _AGAIN)
        return [Member(member.number, new, self._changes)] if new.converged else []

    def add(self, problem: Problem, paths: Array) -> None:
        """Add minima found elsewhere, as joints (s, k, n)."""
        members = list(self.members)
        for q in paths:
            if any(same_path(q, member.solution.q) for member in members):
                continue
            end = solve(problem, q, Options(mu0=1e-4, push=1e-6))
            if end.converged and not end.saddle:
                self._numbered += 1
                members.append(Member(self._numbered, end, self._changes))
        self._keep(members)

    def _keep(self, members: list[Member]) -> None:
        members.sort(key=lambda member: member.solution.objective)
        kept: list[Member] = []
        for member in members:
            known = any(same_path(member.solution.q, other.solution.q) for other in kept)
            if not known and len(kept) < self.size:
                kept.append(member)
        self.members = tuple(kept)


def global_minima(problem: Problem, seed: int, number: int, jobs: int | None) -> Array:
    """Search from single points over the whole path; return distinct minima (s, k, n), best first.

    Args:
        problem: Where things stand.
        seed: Seed of the session.
        number: Number of the search within it.
        jobs: Threads.
    """
    points = sorted({0, (problem.k - 1) // 2, problem.k - 1})
    random, starts = generator(seed, _KEY, number), []
    for point in points:
        draw = random.uniform(problem.lower, problem.upper, (_POSTURES, 1, problem.n))
        ends = solve_many(problem, draw, _ROUGH, jobs=jobs, points=np.full(_POSTURES, point))
        known = distinct(replace(ends, converged=ends.status == CONVERGED)).ends.q[:_REFINED]
        starts.append(np.repeat(known, problem.k, axis=1))
    ends = solve_many(problem, np.concatenate(starts), jobs=jobs)
    found = distinct(ends).ends
    level = TOLERANCE.same_objective * max(1.0, float(np.abs(found.objective).min(initial=1.0)))
    worth = found.objective < np.min(found.objective, initial=np.inf) * 2.0 + level
    return np.asarray(found.q[worth])
