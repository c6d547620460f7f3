"""Trajectory: the answer of a planner, with what was checked at each point and where it came from.

Everything that draws, writes or compares takes a task and its trajectory, and reads what stands
here. `verify` makes it, `folder` keeps it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal

import numpy as np

from dualarm_pin.answer.evidence import Evidence
from dualarm_pin.answer.provenance import Timing
from dualarm_pin.arrays import Array, finite
from dualarm_pin.cell.parts import Pair
from dualarm_pin.errors import ShapeError

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

    from dualarm_pin.answer.alternatives import Alternative


@dataclass(frozen=True, eq=False)
class Distances:
    """The smallest distance at each point, and between which two links it lies.

    Attributes:
        distance: Smallest distance (h,) [m]; zero or less where the links touch.
        pairs: The two links at each point; () in results of versions that did not keep them.
    """

    distance: Array
    pairs: tuple[Pair, ...] = ()

    def __post_init__(self) -> None:
        if len(self.pairs) not in (0, len(self.distance)):
            raise ShapeError(
                f"a pair for each of {len(self.distance)} points is expected; "
                f"given {len(self.pairs)}",
                field="pairs",
            )

    @property
    def least(self) -> float:
        """The smallest distance on the path [m]."""
        return float(np.min(self.distance))

    @property
    def closest(self) -> Pair | None:
        """The two links between which it lies; None if they were not kept."""
        return self.pairs[int(np.argmin(self.distance))] if self.pairs else None

    @property
    def touch(self) -> bool:
        """Whether links touch somewhere: contact counts as collision."""
        return self.least <= 0.0


@dataclass(frozen=True, eq=False)
class RowValues:
    """What a row comes to at the points at which it holds.

    Attributes:
        name: Name of the row.
        units: Unit of its value.
        equality: It must be zero, not zero or more.
        points: Points at which it holds, from 0.
        value: Its value at these points.
    """

    name: str
    units: str
    equality: bool
    points: tuple[int, ...]
    value: Array

    def __post_init__(self) -> None:
        if np.shape(self.value) != (len(self.points),) or not self.points:
            raise ShapeError("a value for each of its points is expected", field=self.name)

    @property
    def violation(self) -> float:
        """How far the row is from holding where it is worst; 0 where it holds."""
        lacking = np.abs(self.value) if self.equality else -self.value
        return max(0.0, float(np.max(lacking)))

    @property
    def worst(self) -> int:
        """The point, from 0, at which it is nearest to not holding, or farthest from it."""
        return self.points[int(np.argmax(np.abs(self.value) if self.equality else -self.value))]


@dataclass(frozen=True, eq=False)
class Apart:
    """What the clearance rule of a task comes to on a motion.

    Attributes:
        required: What is asked of every pair [m]; None where single pairs alone are asked about.
        level: How far it was looked: at the points, at samples between them, or everywhere by a
            certificate.
        kept: Every pair keeps what is asked of it, as far as that.
        worst: Where least is left of what is asked, or most lacks, as a sentence.
        between: Smallest distance that was seen on the line in the joints after each point
            (h - 1,) [m]; None at the level of points.
        place: Where on that line, 0 to 1 (h - 1,).
        pairs: Between which bodies.
        bound: No distance of the motion is below this [m]; None without a certificate.
    """

    required: float | None
    level: Literal["points", "samples", "certified"]
    kept: bool
    worst: str
    between: Array | None = None
    place: Array | None = None
    pairs: tuple[Pair, ...] = ()
    bound: float | None = None

    def __post_init__(self) -> None:
        parts = [part for part in (self.between, self.place, self.pairs) if part is not None]
        lengths = {len(part) for part in parts}
        if self.between is not None and len(lengths) > 1:
            raise ShapeError(
                f"figures of as many lines are expected; given {lengths}", field="apart"
            )

    @property
    def least_between(self) -> float | None:
        """The smallest distance that was seen between the points [m]."""
        return None if self.between is None else float(np.min(self.between))


@dataclass(frozen=True, eq=False)
class Checked:
    """What the joints of a path come to, point by point, as `verify` computed it with Pinocchio.

    Attributes:
        index: Index at each point (h,).
        objective: Objective (eq. 19) over all points; of the smooth index, where one is minimised.
        position_error: Distance to the wanted position (h,) [m].
        rotation_error: Angle to the wanted rotation, or between tool axes with the spin free,
            or 0 where only the position is asked for (h,) [rad].
        bound_violation: Largest violation of a bound at each point (h,) [rad or m].
        singular_value: Smallest singular value of J_r at each point (h,).
        clearance: Over all pairs that must not touch; None if geometry is missing.
        arm_clearance: Between the two arms: a wrist always sits close to its own forearm, so this
            one tells more. None if geometry is missing.
        found: All errors are within tolerance, and bodies keep the distances asked for.
        rows: What the rows of the task come to.
        smoothing_error: Largest distance of `index` from a smooth index that was minimised in its
            place, 0 where it was minimised itself [unit of the index].
        apart: What the clearance rule of the task comes to; `clearance` and `arm_clearance` are
            then of the pairs that it asks about. None without one.
    """

    index: Array
    objective: float
    position_error: Array
    rotation_error: Array
    bound_violation: Array
    singular_value: Array
    clearance: Distances | None
    arm_clearance: Distances | None
    found: bool
    rows: tuple[RowValues, ...] = ()
    smoothing_error: float = 0.0
    apart: Apart | None = None


@dataclass(frozen=True, eq=False)
class Trajectory:
    """Joint motion along the whole path, as checked with Pinocchio.

    Attributes:
        q: Joints (h, n) in column order [rad or m].
        joints: Names of the columns, `arm1/<name>` and `arm2/<name>`.
        arc_length: Arc length of each point (h,) [m].
        checked: What our own check found at each point.
        method: Name of the planner.
        solver: Name of the solver.
        evidence: What is known about the optimum.
        timing: Seconds.
        seed: Seed of the starts.
        versions: Versions of the libraries that made the result.
        message: In one sentence: why it was not found, or what to know about it.
        notes: What the method says of its own work, a record of `answer.notes` or of its own.
        alternatives: Further answers that differ in posture, best first, where they were asked for.

    Raises:
        ShapeError: The arrays do not belong together.
        InputError: A joint or an arc length is not finite.
    """

    q: Array
    joints: tuple[str, ...]
    arc_length: Array
    checked: Checked
    method: str
    solver: str
    evidence: Evidence = field(default_factory=Evidence)
    timing: Timing = field(default_factory=Timing)
    seed: int | None = None
    versions: Mapping[str, str] = field(default_factory=dict)
    message: str = ""
    notes: DataclassInstance | None = None
    alternatives: tuple[Alternative, ...] = ()

    def __post_init__(self) -> None:
        h = len(self.q)
        if np.size(self.q) == 0:
            raise ShapeError("a trajectory has at least one point and one joint", field="q")
        finite(self.q, "q", (h, len(self.joints)))
        finite(self.arc_length, "arc_length", (h,))
        for name, value in vars(self.checked).items():
            if name == "apart" and value is not None and value.between is not None:
                finite(value.between, "between", (h - 1,))
            if name in ("rows", "apart"):
                continue
            array = value.distance if isinstance(value, Distances) else value
            if np.ndim(array) > 0 and np.shape(array) != (h,):
                raise ShapeError(f"({h},) is expected; given {np.shape(array)}", field=name)

    @property
    def found(self) -> bool:
        """Whether every point passed our own check of pose and bounds."""
        return self.checked.found

    @property
    def index(self) -> Array:
        """Index at each point (h,)."""
        return self.checked.index

    @property
    def objective(self) -> float:
        """Objective (eq. 19) over all points."""
        return self.checked.objective

    @property
    def mean_index(self) -> float:
        """Plain mean of the index over the points, as the paper reports it."""
        return float(np.mean(self.index))

    @property
    def arc_mean_index(self) -> float:
        """Mean of the index over the arc length, by trapezoids."""
        s = self.arc_length
        length = float(s[-1] - s[0])
        return float(np.trapezoid(self.index, s)) / length if length > 0 else self.mean_index

    @property
    def max_index(self) -> float:
        """Largest index on the path."""
        return float(np.max(self.index))

    @property
    def max_position_error(self) -> float:
        """Largest position error [m]."""
        return float(np.max(self.checked.position_error))

    @property
    def max_rotation_error(self) -> float:
        """Largest rotation error [rad]."""
        return float(np.max(self.checked.rotation_error))

    @property
    def max_bound_violation(self) -> float:
        """Largest violation of a bound [rad or m]."""
        return float(np.max(self.checked.bound_violation))

    @property
    def max_row_violation(self) -> float:
        """Largest violation of a row of the task, 0 if all hold, in the unit of the row."""
        return max((row.violation for row in self.checked.rows), default=0.0)

    @property
    def max_joint_step(self) -> float:
        """Largest step of one joint between neighbours [rad or m]."""
        return float(np.max(np.abs(np.diff(self.q, axis=0)))) if len(self.q) > 1 else 0.0

    @property
    def min_clearance(self) -> float | None:
        """Smallest distance of the pairs that must not touch [m]; None if geometry is missing."""
        return None if self.checked.clearance is None else self.checked.clearance.least

    @property
    def arm_clearance(self) -> float | None:
        """Smallest distance between the two arms on the path [m]; None if unknown."""
        return None if self.checked.arm_clearance is None else self.checked.arm_clearance.least
