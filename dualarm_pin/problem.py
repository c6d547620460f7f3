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
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike, NDArray

from dualarm_pin import reference
from dualarm_pin.arrays import checked
from dualarm_pin.chain import Chain, chain_of, quaternion_of
from dualarm_pin.errors import InputError, ShapeError
from dualarm_pin.indices import Index
from dualarm_pin.relative import Relative
from dualarm_pin.rows.row import Row
from dualarm_pin.rows.table import RowTable, extended, row_table
from dualarm_pin.tolerance import TOLERANCE

if TYPE_CHECKING:
    from dualarm_pin.cell import Cell

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
R = TypeVar("R", bound=NamedTuple)
FORCE, CALLED = 0, 1

_SIZES = 9  # postures: enough for a median within a factor of two
_NEAR_ONE = 50.0  # the tolerances of the solvers were tried on indices from 1/50 to 50


class Points(NamedTuple):
    """What differs from point to point; the first axis of every array counts points.

    Attributes:
        position: (k, 3) wanted position of e2 in e1 [m].
        rotation: (k, 3, 3) wanted rotation of e2 in e1.
        quaternion: (k, 4) the same (w, x, y, z), e2 turned so that the spin axis is its z.
        target_axes: (k, 3, 3) the transposed rotation, e2 turned likewise.
        pose_rows: (k,) 6 whole pose, 5 spin free, 3 position.
        u: (k, 6) directions in e1 axes.
        index_weight: (k,) a_i.
        linear: (k, n) theta_i.
    """

    position: Array
    rotation: Array
    quaternion: Array
    target_axes: Array
    pose_rows: Integers
    u: Array
    index_weight: Array
    linear: Array


class Links(NamedTuple):
    """The link after each point; that after the last one leads nowhere.

    Attributes:
        weight: (k,) lambda_i.
        metric: (k, n) diagonal m_i; the fixed neighbours take that of the nearest link.
    """

    weight: Array
    metric: Array

    def metric_of(self, i: int) -> Array:
        """Return the metric (n,) of the link from point i to i + 1; -1 is that before the first."""
        return np.asarray(self.metric[min(max(i, 0), max(len(self.metric) - 2, 0))])


class Neighbours(NamedTuple):
    """Fixed postures before the first point and after the last.

    Attributes:
        posture: (2, n).
        weight: (2,) lambda of the links to them, 0 for none.
    """

    posture: Array
    weight: Array


class IndexTerms(NamedTuple):
    """The index by value.

    Attributes:
        kind: FORCE is part of the engine; every other index is CALLED, compiled by itself.
        task_scale: (6,) square roots of the task weights.
        joint_weights: (n,) diagonal of W.
        centre: (n,) middle of the bounds.
        centre_weight: (n,) weight of (q - centre)^2, with the index.
    """

    kind: int
    task_scale: Array
    joint_weights: Array
    centre: Array
    centre_weight: Array


class Bounds(NamedTuple):
    """Bounds for a barrier: a fixed variable gets a harmless interval around its value.

    Attributes:
        lower: (n,) rad or m.
        upper: (n,).
        fixed: (f,) columns that must not move.
        fixed_value: (f,) where they stand; nan: where the start has them.
    """

    lower: Array
    upper: Array
    fixed: Integers
    fixed_value: Array


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
        axis, turn = _spin(spin_axis)
        low, high = checked("lower", lower, (n,)), checked("upper", upper, (n,))
        barrier = _barrier_bounds(low, high)
        given = np.broadcast_to(rotation, (k, 3, 3)) if np.ndim(rotation) == 2 else rotation
        wanted = checked("rotation", given, (k, 3, 3))
        turned = wanted @ turn
        links = checked("link_weight", link_weight, (k - 1,))
        points = Points(
            position=checked("position", position, (k, 3)),
            rotation=wanted,
            quaternion=np.array([quaternion_of(target) for target in turned]),
            target_axes=np.ascontiguousarray(turned.transpose(0, 2, 1)),
            pose_rows=_pose_rows(pose_rows, k),
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
            size=_typical_size(cell, index, points.u, low, high),
            chain=_spin_frame(chain, turn),
            points=points,
            links=Links(np.append(links, 0.0), _metric(metric, k, n)),
            neighbours=Neighbours(np.zeros((2, n)), np.zeros(2)),
            terms=_index_terms(index, barrier),
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
        bounds = _barrier_bounds(low, high)
        terms = _index_terms(self.index, bounds)
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
            points=_take(self.points, which),
            links=Links(links, self.links.metric[which]),
            neighbours=Neighbours(posture, weight),
            equalities=_take(self.equalities, which),
            inequalities=_take(self.inequalities, which),
        )


def _take(record: R, which: slice | list[int]) -> R:
    """Return a record of arrays over some of its points: views for a slice."""
    return type(record)(*(array[which] for array in record))


def _metric(given: ArrayLike, k: int, n: int) -> Array:
    """Return the metric of the link after each point (k, n)."""
    shape = (k - 1, n) if np.ndim(given) == 2 else (n,)
    rows = np.broadcast_to(checked("metric", given, shape), (k - 1, n))
    last = rows[-1:] if k > 1 else np.ones((1, n))
    return np.ascontiguousarray(np.vstack([rows, last]))


def _spin(axis: ArrayLike) -> tuple[Array, Array]:
    """Return the unit axis (3,) and a rotation (3, 3) whose z it is; the identity for z."""
    given = checked("spin_axis", axis, (3,))
    length = np.linalg.norm(given)
    if length < TOLERANCE.no_length:
        raise InputError("is the zero vector; give an axis in the e2 frame", field="spin_axis")
    given = given / length
    turn = pin.Quaternion.FromTwoVectors(np.array([0.0, 0.0, 1.0]), given)
    return given, np.asarray(turn.toRotationMatrix())


def _spin_frame(chain: Chain, turn: Array) -> Chain:
    """Return the chain with e2 turned."""
    last = pin.Quaternion(np.roll(chain.quaternion[-1], -1)).toRotationMatrix()
    quaternion = chain.quaternion.copy()
    quaternion[-1] = quaternion_of(last @ turn)
    return chain._replace(quaternion=quaternion)


def _pose_rows(given: ArrayLike | None, k: int) -> Integers:
    array = np.full(k, 6) if given is None else np.array(given, dtype=np.int64)
    if array.shape != (k,):
        raise ShapeError(f"has shape {array.shape}, not ({k},)", field="pose_rows")
    if not np.isin(array, (6, 5, 3)).all():
        found = sorted(set(array.tolist()))
        raise InputError(f"has {found}: allowed are 6, 5 and 3", field="pose_rows")
    return array.astype(np.int64)


def _barrier_bounds(lower: Array, upper: Array) -> Bounds:
    if (lower > upper).any():
        at = int(np.argmax(lower > upper))
        raise InputError(
            f"column {at} has lower bound {lower[at]} above its upper bound {upper[at]}",
            field="lower",
        )
    fixed = np.flatnonzero(upper - lower < TOLERANCE.fixed_joint)
    value = 0.5 * (lower[fixed] + upper[fixed])
    low, high = lower.copy(), upper.copy()
    low[fixed], high[fixed] = value - 1.0, value + 1.0
    return Bounds(low, high, fixed, value)


def _index_terms(index: Index, bounds: Bounds) -> IndexTerms:
    n = len(bounds.lower)
    weights = np.ones(6) if index.task_weights is None else index.task_weights
    joints = 1.0 if index.joint_weights is None else index.joint_weights
    half = 0.5 * (bounds.upper - bounds.lower)
    half[bounds.fixed] = np.inf
    return IndexTerms(
        kind=FORCE if index.kernel == "force" else CALLED,
        task_scale=np.sqrt(weights),
        joint_weights=checked("joint_weights", joints, (n,)),
        centre=0.5 * (bounds.lower + bounds.upper),
        centre_weight=index.joint_centre / half**2,
    )


def _typical_size(cell: Any, index: Index, u: Array, lower: Array, upper: Array) -> float:
    """Return the median of |c| over a few postures, or 1 where that is near enough.

    A solver's tolerances are absolute: an index of size 1e-3 would stop early, one of 1e4 would
    never be done.
    """
    draw = np.random.default_rng(0).uniform(lower, upper, (_SIZES, len(lower)))
    at = np.linspace(0, len(u) - 1, _SIZES).astype(int)
    values = [
        reference.index_value(index, Relative(cell, q), u[i], q, (lower, upper))
        for q, i in zip(draw, at, strict=True)
    ]
    finite = np.abs([value for value in values if np.isfinite(value)])
    size = float(np.median(finite)) if len(finite) else 1.0
    near_enough = 1.0 / _NEAR_ONE <= size <= _NEAR_ONE
    return 1.0 if near_enough or not size > 0.0 else size
