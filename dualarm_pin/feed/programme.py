"""Refinement: the feed itself is maximised over the spline of the joints.

One linear programme after another: least t = 1 / feed over changes of the spline's coefficients,
with |q'| <= t limit and |q''| <= t^2 limit (linear about the present t) at places in every link,
the pose rows at every point, the bounds, and a region in which this is trusted. What counts is the
curve that is put onto the path between its points; the programme has its slopes from the spline.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import sparse
from scipy.interpolate import BSpline, make_interp_spline
from scipy.optimize import linprog

from dualarm_pin.arrays import Array
from dualarm_pin.errors import InputError
from dualarm_pin.feed.slowness import Slowness
from dualarm_pin.motion.joint_curve import JointCurve, joint_curve
from dualarm_pin.motion.limits import Limits
from dualarm_pin.problem import Problem
from dualarm_pin.reference import equalities
from dualarm_pin.relative import Relative
from dualarm_pin.solvers.projection import project
from dualarm_pin.task import Task
from dualarm_pin.task.motion_spec import ChordSpec
from dualarm_pin.tolerance import TOLERANCE

# The usual rules of a trust region [rad or m]: from a tenth, wider where the programme foretold
# what came, narrower where it did not; below the last nothing is gained any more.
_FIRST, _LEAST = 0.1, 2e-4
_WIDER, _NARROWER, _REFUSED = 1.6, 0.6, 0.35
_FORETOLD, _MISJUDGED = 0.7, 0.3
_GAIN = 3e-4  # relative gain of a round below which two in a row end it
_PER_INTERVAL = 4  # places in an interval of a curve at which its feed is judged
_CORRECTIONS = 2  # programmes a step: the second knows how the pose rows curve
_NEAR = 0.85  # rows that cannot come nearer to the largest use than this are left out


@dataclass(frozen=True, eq=False)
class _State:
    """A path, its curve, and what it asks of the joints at a feed of 1 m/s.

    Attributes:
        q: Joints (h, n).
        curve: Joints along the path.
        uses: Signed shares of speed and acceleration, each (m, n).
        slow: 1 / feed [s/m].
    """

    q: Array
    curve: JointCurve
    uses: tuple[Array, Array]
    slow: float


class FeedProgramme:
    """Maximises the feed of paths of one task.

    Args:
        task: Cell and path.
        limits: What the joints can do.
        chord: How far curves may leave the path.
    """

    def __init__(self, task: Task, limits: Limits, chord: ChordSpec) -> None:
        self.task, self.chord = task, chord
        self.problem: Problem = task.problem()
        self.slowness: Slowness | None = None
        self.limits = limits

    def refine(self, q: Array, rounds: int) -> tuple[Array, float]:
        """Return faster joints (h, n) on the path than q, if there are any, and their feed [m/s].

        Raises:
            InputError: q has no smooth curve on the path.
        """
        state = self._state(q)
        region, idle = _FIRST, 0
        for _ in range(rounds):
            found = self._step(state, region)
            if found is None:
                region *= _REFUSED
            else:
                moved, foretold = found
                ratio = (state.slow - moved.slow) / max(state.slow - foretold, 1e-300)
                gain = 1.0 - moved.slow / state.slow
                if gain <= 0.0:
                    region *= _REFUSED
                else:
                    region *= _WIDER if ratio > _FORETOLD else 1.0
                    region *= _NARROWER if ratio < _MISJUDGED else 1.0
                    idle = idle + 1 if gain < _GAIN else 0
                    state = moved
            if region < _LEAST or idle == 2:
                break
        return state.q, 1.0 / state.slow

    def _state(self, q: Array) -> _State:
        curve = joint_curve(self.task, q, self.chord)
        if self.slowness is None:
            self.slowness = Slowness(curve.relative.place, self.limits)
        s = self.slowness.between
        uses = self.slowness.uses(curve.at(s, 1), curve.at(s, 2))
        dense = curve.places(_PER_INTERVAL)
        everywhere = self.slowness.uses(curve.at(dense, 1), curve.at(dense, 2))
        return _State(q, curve, uses, self.slowness.worst(everywhere))

    def _step(self, state: _State, region: float) -> tuple[_State, float] | None:
        """Return the state after one programme, and the 1 / feed that it foretold; None if none."""
        assert self.slowness is not None
        place, n = self.slowness.place, self.problem.n
        ends = state.curve.at(place[[0, -1]], 2)
        spline = make_interp_spline(place, state.q, bc_type=([(2, ends[0])], [(2, ends[1])]))
        basis = BSpline(spline.t, np.eye(len(spline.c)), 3)
        values = sparse.csr_matrix(basis(place))
        # The ends bend as what is beside them, but for what keeps them on the path.
        bends = sparse.csr_matrix(basis(place[[0, -1]], 2) - basis(place[[1, -2]], 2))
        jacobians, residual = self._pose_rows(state.q)
        equal = sparse.vstack(
            [
                sparse.vstack([sparse.kron(values[i], J) for i, J in enumerate(jacobians)]),
                sparse.kron(bends, sparse.eye(n)),
            ]
        )
        rows, room = self._limit_rows(state, basis, region)
        lower = np.minimum(np.maximum(self.problem.lower - spline.c, -region), 0.0)
        upper = np.maximum(np.minimum(self.problem.upper - spline.c, region), 0.0)
        limits = np.vstack([np.column_stack([lower.ravel(), upper.ravel()]), [0.0, state.slow]])
        variables = lower.size + 1
        moved, foretold = state.q, state.slow
        for _ in range(_CORRECTIONS):
            done = linprog(
                np.append(np.zeros(variables - 1), 1.0),
                A_ub=rows,
                b_ub=room,
                A_eq=sparse.hstack([equal, sparse.csr_matrix((equal.shape[0], 1))]),
                b_eq=np.append(-np.concatenate(residual), np.zeros(2 * n)),
                bounds=limits,
                method="highs-ipm",
            )
            if done.x is None:
                return None
            change = values @ done.x[:-1].reshape(-1, n)
            moved, foretold = state.q + change, float(done.x[-1])
            # What the rows curve on the way is taken in before the limits are met again.
            _, curved = self._pose_rows(moved)
            residual = [r - J @ d for r, J, d in zip(curved, jacobians, change, strict=True)]
        moved, off = project(self.problem, moved, TOLERANCE.exact)
        if off > TOLERANCE.on_path:
            return None
        try:
            return self._state(moved), foretold
        except InputError:  # the curve has become too wild to lie on the path
            return None

    def _pose_rows(self, q: Array) -> tuple[list[Array], list[Array]]:
        """Return the Jacobian and the residual of the rows of every point."""
        found = [equalities(self.problem, i, Relative(self.task.cell, q[i])) for i in range(len(q))]
        return [J for _, J in found], [residual for residual, _ in found]

    def _limit_rows(
        self, state: _State, basis: BSpline, region: float
    ) -> tuple[sparse.spmatrix, Array]:
        """Return the rows of the limits that may count within the region."""
        assert self.slowness is not None
        n, s, slow = self.problem.n, self.slowness.between, state.slow
        parts, rooms = [], []
        orders = (1, 2) if self.slowness.accelerated else (1,)
        for order in orders:
            limit = self.limits.velocity if order == 1 else self.limits.acceleration
            slopes = sparse.csr_matrix(basis(s, order))
            reach = np.abs(slopes).sum(axis=1).reshape(-1, 1) * region / limit
            use = state.uses[order - 1]
            for sign in (1.0, -1.0):
                k, j = np.nonzero(np.asarray(sign * use + reach > _NEAR * slow**order))
                taken = slopes[k].tocoo()
                which = j[taken.row]
                columns = taken.col * n + which
                row = sparse.csr_matrix(
                    (sign * taken.data / limit[which], (taken.row, columns)),
                    shape=(len(k), basis.c.shape[0] * n),
                )
                # use + change <= t^order, about the present t
                grown = np.full((len(k), 1), -order * slow ** (order - 1))
                parts.append(sparse.hstack([row, sparse.csr_matrix(grown)]))
                rooms.append((1 - order) * slow**order - sign * use[k, j])
        return sparse.vstack(parts).tocsr(), np.concatenate(rooms)
