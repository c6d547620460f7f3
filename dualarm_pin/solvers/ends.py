"""Ends: what many starts of one problem came to, as arrays."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dualarm_pin.tolerance import TOLERANCE, Tolerance

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
Labels = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Ends:
    """The ends of s starts of one problem with k points and n joints.

    Attributes:
        q: Joints (s, k, n).
        objective: Objective at q (s,).
        residual: Largest pose residual at q (s,), recomputed.
        feasible: The residual is within tolerance and the bounds hold (s,).
        converged: The solver met its stop criterion, at a feasible point (s,).
        iterations: Iterations (s,).
        interrupted: Ctrl-C came before every start was run; those that were not are infeasible.
    """

    q: Array
    objective: Array
    residual: Array
    feasible: Flags
    converged: Flags
    iterations: Labels
    interrupted: bool = False

    def __len__(self) -> int:
        return len(self.objective)

    @property
    def ran(self) -> Flags:
        """Which starts were run at all (s,): after Ctrl-C some were not, and count for nothing."""
        return np.isfinite(self.residual)

    def take(self, which: Labels | Flags | list[int]) -> Ends:
        """Return some of the ends."""
        return Ends(
            self.q[which],
            self.objective[which],
            self.residual[which],
            self.feasible[which],
            self.converged[which],
            self.iterations[which],
        )

    @staticmethod
    def join(parts: list[Ends]) -> Ends:
        """Return several ends as one."""
        return Ends(
            np.concatenate([part.q for part in parts]),
            np.concatenate([part.objective for part in parts]),
            np.concatenate([part.residual for part in parts]),
            np.concatenate([part.feasible for part in parts]),
            np.concatenate([part.converged for part in parts]),
            np.concatenate([part.iterations for part in parts]),
        )


@dataclass(frozen=True, eq=False)
class Minima:
    """The distinct minima among ends, best first.

    Attributes:
        ends: One end of each minimum (m).
        hits: How many ends each minimum drew (m,).
        label: Minimum of every end (s,), -1 for those that did not converge.
    """

    ends: Ends
    hits: Labels
    label: Labels

    def __len__(self) -> int:
        return len(self.hits)


def distinct(ends: Ends, tolerance: Tolerance = TOLERANCE) -> Minima:
    """Sort converged ends into distinct minima.

    Two ends are one minimum if no joint differs by 0.02 and the objectives agree to 1e-5. The
    joints decide, never the objective alone: mirror twins share an objective and are different
    starts for a longer path.
    """
    label = np.full(len(ends), -1, dtype=np.int64)
    order = np.flatnonzero(ends.converged)
    order = order[np.argsort(ends.objective[order], kind="stable")]
    first: list[int] = []
    hits: list[int] = []
    flat = ends.q.reshape(len(ends), -1)
    oldest = 0  # minima before this one are too good to be the same
    for end in order:
        value = ends.objective[end]
        near = tolerance.same_objective * max(1.0, abs(value))
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
