"""Problem: the nonlinear programme over k points of a path, (eq. 19) and (eq. 20) as one record.

    min  sum_i a_i c(q_i) + theta_i . q_i + sum_i lambda_i (dq_i^T diag(m_i) dq_i)^2
    s.t. the pose rows of every point (eq. 17), further rows g >= 0 or g = 0,
         lower <= q_i <= upper (eq. 16)

The first sum is the index over the points (eq. 15), the last the fourth powers of steps (eq. 18),
with dq_i = q_{i+1} - q_i over the free points and, where they are given, over the links to the
fixed neighbours before the first and after the last point: none for (eq. 19), both for (eq. 20).

The arrays here are those that the compiled engine reads. Values and gradients in Python come from
Pinocchio (`dualarm_pin.reference`); they are what the engine is checked against.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dualarm_pin import reference
from dualarm_pin.arrays import checked
from dualarm_pin.chain import Chain, chain_of, quaternion_of
from dualarm_pin.errors import ShapeError
from dualarm_pin.indices import Index
from dualarm_pin.problem.bounds import Bounds, barrier_bounds
from dualarm_pin.problem.links import Links, Neighbours, metric_rows
from dualarm_pin.problem.points import Points, checked_rows, taken
from dualarm_pin.problem.spin import spin_frame, spin_of
from dualarm_pin.problem.terms import IndexTerms, index_terms, typical_size
from dualarm_pin.rows.row import Row
from dualarm_pin.rows.table import RowTable, extended, row_table

if TYPE_CHECKING:
    from dualarm_pin.cell import Cell

Array = NDArray[np.float64]
Integers = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Problem:
    """The programme over k points; made by `Problem.of`, changed by its methods.

    Attributes:
        cell: Two arms.
        index: What is minimised at each point.
        rows: What must hold beside the pose.
        spin_axis: Unit axis in e2 (3,) whose spin is free where a point has 5 pose rows.
        lower: Lower joint bounds (n,) [rad or m].
        upper: Upper joint bounds (n,) [rad or m].
        size: Typical size of the index on this cell: objectives near it are neither small nor
            large. 1 where that is true of 1 itself.
        chain: The joints from e1 to e2, e2 turned so that the spin axis is its z.
        points: Targets, directions, weights.
        links: Links between neighbours.
        neighbours: Fixed postures at both ends.
        terms: The index by value.
        bounds: The joint bounds, for a barrier.
        equalities: Rows that must be zero.
        inequalities: Rows that must be zero or more.
    """

    cell: Cell
    index: Index
    rows: tuple[Row, ...]
    spin_axis: Array
    lower: Array
    upper: Array
    size: float
    chain: Chain
    points: Points
    links: Links
    neighbours: Neighbours
    terms: IndexTerms
    bounds: Bounds
    equalities: RowTable
    inequalities: RowTable

    @classmethod
    def of(
        cls,
        cell: Cell,
        index: Index,
        position: ArrayLike,
        rotation: ArrayLike,
        *,
        lower: ArrayLike,
        upper: ArrayLike,
        pose_rows: ArrayLike | None = None,
        spin_axis: ArrayLike = (0.0, 0.0, 1.0),
        u: ArrayLike | None = None,
        link_weight: ArrayLike = 0.0,
        metric: ArrayLike = 1.0,
        index_weight: ArrayLike = 1.0,
        rows: Sequence[Row] = (),
    ) -> Problem:
        """State a problem over all points of a path, checked.

        Args:
            cell: Two arms.
            index: What is minimised.
            position: (k, 3) targets of e2 in e1 [m].
            rotation: (k, 3, 3) targets of e2 in e1, or one for all points.
            lower: (n,) rad or m; equal to `upper` for a joint that must not move.
            upper: (n,) rad or m.
            pose_rows: (k,) 6 (default), 5 or 3 pose rows of every point.
            spin_axis: (3,) axis in e2 whose spin is free where there are 5.
            u: (k, 6) directions in e1; zeros if the index needs none.
            link_weight: (k - 1,) or one number.
            metric: (k - 1, n), (n,) or one number: joint metric in the links.
            index_weight: (k,) or one number.
            rows: What must hold beside the pose.

        Raises:
            ShapeError: An array has another shape.
            InputError: A value is not finite, bounds cross, pose_rows is not 6, 5 or 3, or a row
                does not fit the cell or the path.
        """
        chain = chain_of(cell)
        n, k = int(chain.columns[0]), np.shape(position)[0] if np.ndim(position) == 2 else 0
        if not k:
            raise ShapeError(f"has shape {np.shape(position)}, not (k, 3)", field="position")
        axis, turn = spin_of(spin_axis)
        low, high = checked("lower", lower, (n,)), checked("upper", upper, (n,))
        barrier = barrier_bounds(low, high)
        given = np.broadcast_to(rotation, (k, 3, 3)) if np.ndim(rotation) == 2 else rotation
        wanted = checked("rotation", given, (k, 3, 3))
        turned = wanted @ turn
        links = checked("link_weight", link_weight, (k - 1,))
        points = Points(
            position=checked("position", position, (k, 3)),
            rotation=wanted,
            quaternion=np.array([quaternion_of(target) for target in turned]),
            target_axes=np.ascontiguousarray(turned.transpose(0, 2, 1)),
            pose_rows=checked_rows(pose_rows, k),
            u=np.zeros((k, 6)) if u is None else checked("u", u, (k, 6)),
            index_weight=checked("index_weight", index_weight, (k,)),
            linear=np.zeros((k, n)),
        )
        tables = [row_table(rows, cell, k, equality=sort, turn=turn) for sort in (True, False)]
        return cls(
            cell=cell,
            index=index,
            rows=tuple(rows),
            spin_axis=axis,
            lower=low,
            upper=high,
            size=typical_size(cell, index, points.u, low, high),
            chain=spin_frame(chain, turn),
            points=points,
            links=Links(np.append(links, 0.0), metric_rows(metric, k, n)),
            neighbours=Neighbours(np.zeros((2, n)), np.zeros(2)),
            terms=index_terms(index, barrier),
            bounds=barrier,
            equalities=tables[0],
            inequalities=tables[1],
        )

    @property
    def k(self) -> int:
        """Number of free points."""
        return len(self.points.position)

    @property
    def n(self) -> int:
        """Number of joints."""
        return len(self.lower)

    @property
    def m(self) -> int:
        """Room for equality rows at a point: six of the pose, and further ones."""
        return 6 + int(self.equalities.kind.shape[1])

    def objective(self, q: Array) -> float:
        """Return the objective at q (k, n), by Pinocchio."""
        return reference.objective(self, q)

    @cached_property
    def row_count(self) -> Integers:
        """Equality rows of each point (k,), pose rows first."""
        return np.asarray(self.points.pose_rows + self.equalities.size)

    def window(self, first: int, k: int, *, linked: bool = False) -> Problem:
        """Return the problem over k neighbouring points; a view, nothing is copied.

        A fixed neighbour counts where the path ends.

        Args:
            first: First point.
            k: How many.
            linked: Weigh the neighbours before and after the window as their links do; their
                postures come with the solve.
        """
        after = first + k
        weight = np.zeros(2)
        if first == 0:
            weight[0] = self.neighbours.weight[0]
        elif linked:
            weight[0] = self.links.weight[first - 1]
        if after == self.k:
            weight[1] = self.neighbours.weight[1]
        elif linked:
            weight[1] = self.links.weight[after - 1]
        return self._taken(
            slice(first, after), self.links.weight[first:after], weight, self.neighbours.posture
        )

    def subset(
        self,
        points: Sequence[int],
        link_weight: ArrayLike,
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
        chosen = list(points)
        first = 0 if before is None else 1
        count = first + len(chosen) - 1 + (after is not None)
        weights = checked("link_weight", link_weight, (count,))
        posture, weight = np.zeros((2, self.n)), np.zeros(2)
        if before is not None:
            posture[0], weight[0] = checked("before", before, (self.n,)), weights[0]
        if after is not None:
            posture[1], weight[1] = checked("after", after, (self.n,)), weights[-1]
        inner = np.append(weights[first : first + len(chosen) - 1], 0.0)
        return self._taken(chosen, inner, weight, posture)

    def with_points(self, **changes: ArrayLike) -> Problem:
        """Return the problem with other values of a field of `Points`, except the rotation.

        Raises:
            ShapeError: An array has another shape.
            InputError: A value is not finite.
        """
        arrays: dict[str, Any] = {}
        for name, value in changes.items():
            old = getattr(self.points, name)
            arrays[name] = checked(name, value, old.shape).astype(old.dtype)
        return replace(self, points=self.points._replace(**arrays))

    def with_bounds(self, lower: ArrayLike, upper: ArrayLike) -> Problem:
        """Return the problem with other joint bounds (n,).

        Raises:
            ShapeError: An array has another shape.
            InputError: A value is not finite, or bounds cross.
        """
        low, high = checked("lower", lower, (self.n,)), checked("upper", upper, (self.n,))
        bounds = barrier_bounds(low, high)
        terms = index_terms(self.index, bounds)
        return replace(self, lower=low, upper=high, bounds=bounds, terms=terms)

    def with_pairs(self, pairs: RowTable) -> Problem:
        """Return the problem with further inequality rows, which the engine alone knows.

        Nothing else is made anew, so they may change from one solve to the next.

        Args:
            pairs: Rows of kinds that have code of their own: a plane and a point, or two capsules.
        """
        return replace(self, inequalities=extended(self.inequalities, pairs))

    def scaled(self) -> Problem:
        """Return the problem with its objective divided by `size`, for a solver's tolerances."""
        if self.size == 1.0:
            return self
        factor = 1.0 / self.size
        return replace(
            self,
            size=1.0,
            points=self.points._replace(
                index_weight=self.points.index_weight * factor, linear=self.points.linear * factor
            ),
            links=self.links._replace(weight=self.links.weight * factor),
            neighbours=self.neighbours._replace(weight=self.neighbours.weight * factor),
        )

    def _taken(
        self, which: slice | list[int], links: Array, weight: Array, posture: Array
    ) -> Problem:
        return replace(
            self,
            points=taken(self.points, which),
            links=Links(links, self.links.metric[which]),
            neighbours=Neighbours(posture, weight),
            equalities=taken(self.equalities, which),
            inequalities=taken(self.inequalities, which),
        )
