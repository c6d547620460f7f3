"""Problem: the nonlinear programme over k points of a path, (19) and (20) as one code.

    min  sum_i a_i c(q_i) + theta_i . q_i + sum_i lambda_i (dq_i^T diag(m) dq_i)^2
    s.t. the pose rows of every point,  lower <= q_i <= upper

with dq_i = q_{i+1} - q_i over the free points and, where they are given, over the links to the
fixed neighbours before the first and after the last point: none for (19), both for (20).

Values and gradients here come from Pinocchio, one point at a time. They are the reference, and
what a solver that asks Python for values gets; the engine has compiled ones of its own.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from dualarm_pin.constraints import pose_residual
from dualarm_pin.errors import ShapeError
from dualarm_pin.indices import Index
from dualarm_pin.relative import Relative

if TYPE_CHECKING:
    from collections.abc import Sequence

    from dualarm_pin.cell import Cell

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Problem:
    """The programme over k points.

    Attributes:
        cell: Two arms.
        index: What is minimised at each point.
        position: Wanted position of e2 in e1 (k, 3) [m].
        rotation: Wanted rotation of e2 in e1 (k, 3, 3).
        rows: Pose rows at each point (k,): 6, 5 (spin about `spin_axis` free) or 3 (position).
        spin_axis: Unit axis in e2 (3,).
        u: Directions (k, 6) in e1 axes.
        lower: Lower joint bounds (n,) [rad or m].
        upper: Upper joint bounds (n,) [rad or m].
        link_weight: lambda of each link between neighbours (k - 1,).
        metric: Diagonal m of the link metric (n,).
        index_weight: a_i, weight of the index at each point (k,).
        linear: theta_i, linear term at each point (k, n), or None.
        before: Fixed neighbour before the first point (n,), or None.
        before_weight: lambda of that link.
        after: Fixed neighbour after the last point (n,), or None.
        after_weight: lambda of that link.
    """

    cell: Cell
    index: Index
    position: Array
    rotation: Array
    rows: NDArray[np.int64]
    spin_axis: Array
    u: Array
    lower: Array
    upper: Array
    link_weight: Array
    metric: Array
    index_weight: Array
    linear: Array | None = None
    before: Array | None = None
    before_weight: float = 0.0
    after: Array | None = None
    after_weight: float = 0.0

    def __post_init__(self) -> None:
        k, n = self.k, self.n
        expected: dict[str, tuple[int, ...]] = {
            "rotation": (k, 3, 3),
            "rows": (k,),
            "spin_axis": (3,),
            "u": (k, 6),
            "upper": (n,),
            "link_weight": (k - 1,),
            "metric": (n,),
            "index_weight": (k,),
        }
        expected |= {
            name: shape
            for name, shape in (("linear", (k, n)), ("before", (n,)), ("after", (n,)))
            if getattr(self, name) is not None
        }
        for name, shape in expected.items():
            given = np.shape(getattr(self, name))
            if given != shape:
                raise ShapeError(f"expected shape {shape}, given {given}", field=name)

    @property
    def k(self) -> int:
        """Number of free points."""
        return len(self.position)

    @property
    def n(self) -> int:
        """Number of joints."""
        return len(self.lower)

    def subset(
        self,
        points: Sequence[int],
        link_weight: Array | float,
        before: Array | None = None,
        after: Array | None = None,
    ) -> Problem:
        """Return the problem over some of the points, such as Gamma or Delta.

        Args:
            points: Which points, in order.
            link_weight: lambda of the links in order: to `before` if it is given, between the
                points, to `after` if it is given; or one number for all.
            before: Fixed neighbour before the first (n,), or None.
            after: Fixed neighbour after the last (n,), or None.
        """
        points = list(points)
        first = 0 if before is None else 1
        links = first + len(points) - 1 + (after is not None)
        weights = np.broadcast_to(np.asarray(link_weight, float), (links,))
        return replace(
            self,
            position=self.position[points],
            rotation=self.rotation[points],
            rows=self.rows[points],
            u=self.u[points],
            index_weight=self.index_weight[points],
            linear=None if self.linear is None else self.linear[points],
            link_weight=weights[first : first + len(points) - 1].copy(),
            before=before,
            before_weight=0.0 if before is None else float(weights[0]),
            after=after,
            after_weight=0.0 if after is None else float(weights[-1]),
        )

    def objective(self, q: Array) -> float:
        """Return the objective at q (k, n)."""
        value = sum(
            weight * index_value(self.index, Relative(self.cell, q_i), u, q_i, self.bounds)
            for weight, q_i, u in zip(self.index_weight, q, self.u, strict=True)
        )
        return float(value) + self.coupling(q)[0]

    def objective_and_gradient(self, q: Array) -> tuple[float, Array]:
        """Return the objective at q (k, n) and its gradient (k, n)."""
        value, gradient = self.coupling(q)
        for i, (weight, q_i) in enumerate(zip(self.index_weight, q, strict=True)):
            c, dc = index_gradient(
                self.index, Relative(self.cell, q_i), self.u[i], q_i, self.bounds
            )
            value += weight * c
            gradient[i] += weight * dc
        return value, gradient

    @property
    def bounds(self) -> tuple[Array, Array]:
        """Lower and upper joint bounds (n,)."""
        return self.lower, self.upper

    def coupling(self, q: Array) -> tuple[float, Array]:
        """Return the linear and link terms at q (k, n), and their gradient (k, n)."""
        parts = [q]
        weights = [self.link_weight]
        if self.before is not None:
            parts, weights = [self.before[None], *parts], [np.array([self.before_weight]), *weights]
        if self.after is not None:
            parts, weights = [*parts, self.after[None]], [*weights, np.array([self.after_weight])]
        step = np.diff(np.concatenate(parts), axis=0)
        weight = np.concatenate(weights)
        squared = np.sum(self.metric * step**2, axis=1)
        slope = (4.0 * weight * squared)[:, None] * self.metric * step
        first = 0 if self.before is None else 1
        gradient = np.zeros_like(q)
        gradient += np.concatenate([np.zeros((1 - first, q.shape[1])), slope])[: len(q)]
        gradient -= np.concatenate([slope[first:], np.zeros((1, q.shape[1]))])[: len(q)]
        value = float(np.sum(weight * squared**2))
        if self.linear is not None:
            value += float(np.sum(self.linear * q))
            gradient += self.linear
        return value, gradient

    def residual(self, q: Array) -> Array:
        """Return the pose residuals of all points, one after another."""
        return np.concatenate(
            [self.point_residual(i, Relative(self.cell, q_i)) for i, q_i in enumerate(q)]
        )

    def point_residual(self, i: int, relative: Relative) -> Array:
        """Return the pose residual (rows_i,) of point i: position [m], then rotation."""
        return pose_residual(
            relative, self.position[i], self.rotation[i], int(self.rows[i]), self.spin_axis
        )[0]

    def point_jacobian(self, i: int, relative: Relative) -> tuple[Array, Array]:
        """Return the pose residual (rows_i,) of point i and its Jacobian (rows_i, n)."""
        return pose_residual(
            relative, self.position[i], self.rotation[i], int(self.rows[i]), self.spin_axis
        )


def index_matrix(index: Index, J: Array) -> Array:
    """Return A = Wt^(1/2) J W J^T Wt^(1/2) (6, 6) of (8)."""
    rows = J if index.task_weights is None else np.sqrt(index.task_weights)[:, None] * J
    weighted = rows if index.joint_weights is None else rows * index.joint_weights
    return rows @ weighted.T


def index_value(
    index: Index, relative: Relative, u: Array, q: Array, bounds: tuple[Array, Array]
) -> float:
    """Return c at one point, the additive joint-centre term included.

    Args:
        index: The index.
        relative: The pair of arms at q.
        u: Direction (6,) in e1 axes.
        q: Joints (n,).
        bounds: Lower and upper bounds (n,), whose middle is the joint centre.
    """
    value = float(index.phi(index_matrix(index, relative.J_r), u))
    return value + _joint_centre(index, q, bounds)[0]


def index_gradient(
    index: Index, relative: Relative, u: Array, q: Array, bounds: tuple[Array, Array]
) -> tuple[float, Array]:
    """Return c at one point and dc/dq (n,); the arguments are those of `index_value`."""
    J = relative.J_r
    A = index_matrix(index, J)
    slope = index.gradient(A, u)
    if index.task_weights is not None:
        root = np.sqrt(index.task_weights)
        slope = root[:, None] * slope * root
    P = slope @ J if index.joint_weights is None else slope @ J * index.joint_weights
    # dc/dq_l = tr(slope dA_l) = 2 sum_k W_k (slope J_k) . dJ_k/dq_l
    gradient = 2.0 * (P.ravel() @ relative.dJ_r.reshape(P.size, -1))
    extra, slope_extra = _joint_centre(index, q, bounds)
    return float(index.phi(A, u)) + extra, gradient + slope_extra


def _joint_centre(index: Index, q: Array, bounds: tuple[Array, Array]) -> tuple[float, Array]:
    if index.joint_centre == 0.0:
        return 0.0, np.zeros_like(q)
    half = np.maximum((bounds[1] - bounds[0]) / 2.0, 1e-12)
    offset = (q - (bounds[0] + bounds[1]) / 2.0) / half
    return index.joint_centre * float(offset @ offset), 2.0 * index.joint_centre * offset / half
