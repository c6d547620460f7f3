"""Paths that are apart from the first point on: walked with rows from postures that are.

One point alone has few minima, and of these half or more do not collide. A walk from such a one
that keeps its bodies apart at each step ends near a path that does not collide.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from dualarm_pin.arrays import Array, Integers
from dualarm_pin.engine.solve import Options, solve
from dualarm_pin.problem import Neighbours, Problem
from dualarm_pin.repair.basin import Basin
from dualarm_pin.repair.contacts import Contacts
from dualarm_pin.repair.survey import Survey
from dualarm_pin.repair.witness import REACH, asked_apart, witness_table
from dualarm_pin.search.anchored import anchor_points
from dualarm_pin.search.starts import generator
from dualarm_pin.search.turns import Turns
from dualarm_pin.solution import distinct
from dualarm_pin.solvers import interior_point as engine
from dualarm_pin.tolerance import TOLERANCE

_ALONE = Options(tolerance=1e-4, iterations=60)  # a start that needs more hardly ever converges
_LACKING = 0.1  # m: out of deeper collisions a single point hardly ever comes
_CLOSE = 4  # postures of an anchor that are moved apart alone: they may end below those that are
_PASSED = 0.1  # rad or m: nearer postures lead to one path
_TOGETHER = 2  # walks from each anchor, side by side
_AHEAD = 0.7  # share of the last step that the next is expected to repeat
_STEP = Options(tolerance=1e-4, iterations=25, mu0=1e-3, push=1e-3)  # a guess, refined later


class Walks:
    """Walks through a path, a few at a time.

    Args:
        survey: What measures, on the whole path.
        seed: Of the postures.
        postures: Postures drawn at each anchor.
        walks: Minima of each anchor that are walked from.
        jobs: Threads.
    """

    def __init__(
        self, survey: Survey, *, seed: int, postures: int, walks: int, jobs: int | None
    ) -> None:
        self.survey, self.left = survey, walks
        self._turns = Turns(survey.problem)
        self._draw = seed, postures, walks, jobs
        self._alone: list[tuple[int, list[Array]]] | None = None
        self._walked: list[Array] = []

    def next(self) -> list[tuple[float, Array]]:
        """Walk from the next best minima of each anchor.

        Returns:
            Objective and path (k, n) of each, nearly apart.
        """
        problem = self.survey.problem
        if self._alone is None:
            seed, postures, walks, jobs = self._draw
            self._alone = [
                (at, _apart_alone(self.survey, at, postures, walks, seed, jobs))
                for at in anchor_points(problem.k)
            ]
        chosen: list[tuple[int, Array]] = []
        for at, found in self._alone:
            fresh = [i for i, q in enumerate(found) if not self._passed(at, q)][:_TOGETHER]
            chosen += [(at, found[i]) for i in fresh]
            del found[: 1 + fresh[-1] if len(fresh) == _TOGETHER else len(found)]
        self.left = max((len(found) for _, found in self._alone), default=0)
        if not chosen:
            return []
        paths = walked(self.survey, [at for at, _ in chosen], np.array([q for _, q in chosen]))
        self._walked += list(paths)
        return [(_value(problem, path), path) for path in self._turns.folded(paths)]

    def _passed(self, at: int, q: Array) -> bool:
        """Tell whether a walk from another anchor came through a posture (n,)."""
        return any(np.abs(path[at] - q).max() < _PASSED for path in self._walked)


def _value(problem: Problem, q: Array) -> float:
    return solve(problem, q, Options(iterations=0, push=1e-9)).objective


def _apart_alone(
    survey: Survey, at: int, postures: int, most: int, seed: int, jobs: int | None
) -> list[Array]:
    """Return the best minima (n,) of one point alone whose bodies are apart, or nearly."""
    one = survey.problem.window(at, 1)
    turns, random = Turns(one), generator(seed, 60, at)
    starts = random.uniform(turns.lower, turns.upper, (postures, 1, one.n))
    ends = engine.solve_many(one, starts, jobs=jobs, options=_ALONE)
    survey.meter.solved(int(ends.iterations.sum()), 1, 0)
    ends = replace(ends, q=turns.folded(ends.q), converged=ends.status == 0)
    alone = distinct(ends).ends
    found: list[tuple[float, Array]] = []
    close: list[Array] = []
    for value, q in zip(alone.objective.tolist(), alone.q, strict=True):
        enough = _LACKING if len(close) < _CLOSE else TOLERANCE.clearance
        lack = survey.contacts(q, 0.0, enough=enough).worst
        if lack <= TOLERANCE.clearance:
            found.append((value, q[0]))
            if len(found) == most:
                break
        elif lack < _LACKING and len(close) < _CLOSE:
            close.append(q)
    basin = Basin(Survey(one, survey.pairs, survey.meter), between=False)
    for q in close:
        apart = basin.repaired(q)
        if apart is not None:
            found.append((apart.objective, apart.q[0]))
    return [q for _, q in sorted(found, key=lambda each: each[0])[:most]]


def walked(survey: Survey, anchors: list[int], postures: Array) -> Array:
    """Walk from postures (s, n) at points of their own to both ends of the path, side by side.

    The bodies are held apart at each step. Calls cost more than a point: so all steps of one
    number are made at once.
    """
    k, count = survey.problem.k, len(anchors)
    paths = np.tile(postures[:, None], (1, k, 1))
    which, way = np.repeat(np.arange(count), 2), np.tile([1, -1], count)
    for number in range(1, k):
        at = np.repeat(anchors, 2) + number * way
        left = (at >= 0) & (at < k)
        if not left.any():
            break
        s, i, step = which[left], at[left], way[left]
        before = paths[s, i - step]
        start = before.copy()
        if number > 1:
            start += _AHEAD * (before - paths[s, i - 2 * step])
        start = np.clip(start, survey.problem.lower, survey.problem.upper)
        paths[s, i] = _stepped_on(survey, i, start, before, np.minimum(i, i - step))
    return paths


def _stepped_on(survey: Survey, i: Integers, start: Array, before: Array, link: Integers) -> Array:
    """Return postures (s, n) of points i (s,), each linked to one neighbour by a link."""
    problem, count = survey.problem, len(i)
    contacts = survey.contacts(start, REACH)
    # Each point twice: the first is never solved, and the link to it is that to the neighbour.
    weight = np.zeros(2 * count - 1)
    weight[::2] = problem.links.weight[link]
    odd = contacts._replace(point=2 * contacts.point + 1)
    rows = witness_table(survey, odd, asked_apart(contacts), 2 * count)
    pairs = problem.subset(np.repeat(i, 2).tolist(), weight).with_pairs(rows)
    ends = engine.solve_many(
        pairs,
        start[:, None],
        options=_STEP,
        jobs=1,
        points=2 * np.arange(count) + 1,
        neighbours=np.stack([before, before], axis=1),
    )
    near = -(-len(contacts.point) // count)
    survey.meter.solved(int(ends.iterations.sum()), 1, near)
    return ends.q[:, 0]


def stepped(
    survey: Survey,
    i: int,
    start: Array,
    beside: Array,
    share: Array,
    reach: float = np.inf,
    extra: Array | None = None,
) -> tuple[Array, Contacts]:
    """Solve one point between its neighbours, with rows for what is near where it starts.

    Args:
        survey: What measures, on the whole path.
        i: Which point.
        start: (1, n) where it starts.
        beside: (2, n) postures of its neighbours.
        share: (2,) of its links to them, that counts.
        reach: How far it may move from its start [rad or m].
        extra: (p, 1) what is asked of each pair beyond what is required [m].

    Returns:
        Its posture (n,), and what was near at the start.
    """
    window = survey.problem.window(i, 1, linked=True)
    if reach < np.inf:
        lower, upper = np.maximum(window.lower, start[0] - reach), start[0] + reach
        window = window.with_bounds(lower, np.minimum(window.upper, upper))
    both = Neighbours(beside, window.neighbours.weight * share)
    contacts = survey.contacts(start, REACH, extra)
    rows = witness_table(survey, contacts, asked_apart(contacts), 1)
    end = solve(replace(window, neighbours=both).with_pairs(rows), start, _STEP)
    survey.meter.solved(end.iterations, 1, len(contacts.point))
    return end.q[0], contacts
