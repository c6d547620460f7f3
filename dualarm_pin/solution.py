"""What local solves come to: one end, or the ends of many starts as arrays."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dualarm_pin.tolerance import TOLERANCE, Tolerance

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
Integers = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Multipliers:
    """Multipliers at the end of a solve, from which a nearby problem can be solved warm.

    Attributes:
        equalities: (k, m) of the equality rows, 0 beyond a point's own. The sign of the last
            three of a pose follows the sign of the running quaternion of the chain.
        lower: (k, n) of the lower bounds, at least 0.
        upper: (k, n) of the upper bounds, at least 0.
        inequalities: (k, r) of the inequality rows, at least 0.
    """

    equalities: Array
    lower: Array
    upper: Array
    inequalities: Array


@dataclass(frozen=True, eq=False)
class Solution:
    """The end of one start.

    Attributes:
        q: Joints (k, n), within the bounds.
        objective: Objective at q.
        residual: Largest violation of a row at q, recomputed.
        feasible: The residual is within tolerance and the bounds hold.
        converged: The solver met its own stop criterion of optimality, at a feasible point.
        message: Why the solver stopped.
        start: Number of the start within its law.
        law: Name of the law that drew the start.
        wall_s: Seconds.
        iterations: Iterations, or evaluations where the solver counts those.
        stationarity: Largest entry of the Lagrangian's gradient, if the solver knows it.
        saddle: Stationary, but some direction leads down.
        multipliers: Multipliers, if the solver knows them.
    """

    q: Array
    objective: float
    residual: float
    feasible: bool
    converged: bool
    message: str
    start: int = 0
    law: str = ""
    wall_s: float = 0.0
    iterations: int = 0
    stationarity: float | None = None
    saddle: bool = False
    multipliers: Multipliers | None = None


@dataclass(frozen=True, eq=False)
class Solutions:
    """The ends of s starts of one problem with k points and n joints.

    Attributes:
        q: Joints (s, k, n).
        objective: Objective at q (s,).
        residual: Largest violation of a row at q (s,), recomputed; infinite where not run.
        feasible: The residual is within tolerance and the bounds hold (s,).
        converged: The solver met its stop criterion, at a feasible point (s,).
        iterations: Iterations (s,).
        saddle: Stationary, but some direction leads down (s,).
        status: Index into `STATUS` (s,).
        size: Typical size of the index, see `Problem.size`.
        interrupted: Ctrl-C came before every start was run; those that were not are infeasible.
    """

    q: Array
    objective: Array
    residual: Array
    feasible: Flags
    converged: Flags
    iterations: Integers
    saddle: Flags
    status: Integers
    size: float = 1.0
    interrupted: bool = False

    def __len__(self) -> int:
        return len(self.objective)

    def __getitem__(self, item: int) -> Solution:
        """Return one end."""
        return Solution(
            q=self.q[item],
            objective=float(self.objective[item]),
            residual=float(self.residual[item]),
            feasible=bool(self.feasible[item]),
            converged=bool(self.converged[item]),
            message=STATUS[self.status[item]],
            start=item,
            iterations=int(self.iterations[item]),
            saddle=bool(self.saddle[item]),
        )

    @property
    def ran(self) -> Flags:
        """Which starts were run at all (s,): after Ctrl-C some were not, and count for nothing."""
        return np.isfinite(self.residual)

    def take(self, which: Integers | Flags | list[int]) -> Solutions:
        """Return some of the ends."""
        arrays: dict[str, Any] = {name: getattr(self, name)[which] for name in _ARRAYS}
        return Solutions(**arrays, size=self.size)

    @staticmethod
    def join(parts: list[Solutions]) -> Solutions:
        """Return several ends as one."""
        arrays: dict[str, Any] = {
            name: np.concatenate([getattr(part, name) for part in parts]) for name in _ARRAYS
        }
        return Solutions(**arrays, size=parts[0].size)

    @staticmethod
    def of(solutions: list[Solution]) -> Solutions:
        """Return ends that were found one by one; a feasible one counts as converged."""
        feasible = np.array([s.feasible for s in solutions], dtype=bool)
        return Solutions(
            q=np.array([s.q for s in solutions]),
            objective=np.array([s.objective for s in solutions]),
            residual=np.array([s.residual for s in solutions]),
            feasible=feasible,
            converged=feasible,
            iterations=np.array([s.iterations for s in solutions]),
            saddle=np.zeros(len(solutions), dtype=bool),
            status=np.where(feasible, 0, 2),
        )


STATUS = ("converged", "iteration limit", "infeasible", "stalled", "not run", "dropped")
_ARRAYS = [f.name for f in fields(Solutions) if f.name not in ("size", "interrupted")]


@dataclass(frozen=True, eq=False)
class Minima:
    """The distinct minima among ends, best first.

    Attributes:
        ends: One end of each minimum (m).
        hits: How many ends each minimum drew (m,).
        label: Minimum of every end (s,), -1 for those that did not converge.
    """

    ends: Solutions
    hits: Integers
    label: Integers

    def __len__(self) -> int:
        return len(self.hits)


def distinct(ends: Solutions, tolerance: Tolerance = TOLERANCE) -> Minima:
    """Sort converged ends into distinct minima; a saddle is none.

    Two ends are one minimum if no joint differs by 0.02 and the objectives agree to 1e-5. The
    joints decide, never the objective alone: mirror twins share an objective and are different
    starts for a longer path.
    """
    label = np.full(len(ends), -1, dtype=np.int64)
    order = np.flatnonzero(ends.converged & ~ends.saddle)
    order = order[np.argsort(ends.objective[order], kind="stable")]
    first: list[int] = []
    hits: list[int] = []
    flat = ends.q.reshape(len(ends), ends.q[0].size if len(ends) else 0)
    oldest = 0  # minima before this one are too good to be the same
    for end in order:
        value = ends.objective[end]
        near = tolerance.same_objective * max(ends.size, abs(value))
        while oldest < len(first) and value - ends.objective[first[oldest]] >= near:
            oldest += 1
        candidates = first[oldest:]
        if candidates:
            distance = np.abs(flat[candidates] - flat[end]).max(axis=1)
            nearest = int(np.argmin(distance))
            if distance[nearest] < tolerance.same_joint:
                label[end] = oldest + nearest
                hits[oldest + nearest] += 1
                continue
        label[end] = len(first)
        first.append(int(end))
        hits.append(1)
    return Minima(ends.take(np.array(first, dtype=np.int64)), np.array(hits, dtype=np.int64), label)


def same_path(a: Array, b: Array, tolerance: Tolerance = TOLERANCE) -> bool:
    """Tell whether two postures or paths of equal shape lie in one basin, by their joints."""
    return bool(np.max(np.abs(a - b)) < tolerance.same_joint)
