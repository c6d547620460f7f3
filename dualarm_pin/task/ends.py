"""Given ends: a path whose first or last posture is known already, and what is left to plan."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from dualarm_pin.arrays import Array, finite
from dualarm_pin.errors import InputError
from dualarm_pin.problem import Problem
from dualarm_pin.relative import Relative
from dualarm_pin.rows.pose import pose_residual
from dualarm_pin.tolerance import TOLERANCE

if TYPE_CHECKING:
    from dualarm_pin.cell import Cell
    from dualarm_pin.path import Path


@dataclass(frozen=True, eq=False)
class FreePart:
    """The points of a path whose postures are not given; all of them, as a rule.

    Attributes:
        problem: The problem over these points; given postures are its fixed neighbours.
        before: Posture of the first point of the path (n,), if it is given.
        after: Posture of the last point (n,), if it is given.
        constant: What the given postures alone add to the objective.
    """

    problem: Problem
    before: Array | None
    after: Array | None
    constant: float = 0.0

    @classmethod
    def of(cls, whole: Problem, before: Array | None, after: Array | None) -> FreePart:
        """Return the free part of a problem over all points of a path."""
        if before is None and after is None:
            return cls(whole, None, None)
        points = range(whole.k)[before is not None : whole.k - (after is not None)]
        problem = whole.subset(points, whole.links.weight[:-1], before, after)
        alone = [(q, at) for q, at in ((before, 0), (after, whole.k - 1)) if q is not None]
        constant = sum(whole.subset([at], 0.0).objective(q[None]) for q, at in alone)
        return cls(problem, before, after, constant)

    @property
    def first(self) -> int:
        """Which point of the path the first free one is, from 0."""
        return int(self.before is not None)

    @property
    def given(self) -> bool:
        """Whether a posture is given."""
        return self.before is not None or self.after is not None

    def whole(self, q: Array) -> Array:
        """Return the whole path (h, n) of its free postures (k, n)."""
        ends = [[] if end is None else [end] for end in (self.before, self.after)]
        return np.array([*ends[0], *q, *ends[1]])

    def part(self, q: Array) -> Array:
        """Return the free postures (k, n) of a whole path (h, n)."""
        return np.asarray(q[self.first : self.first + self.problem.k])


def check_end(name: str, q: Array, cell: Cell, path: Path, point: int) -> Array:
    """Return a given posture (n,) of one end of a path.

    Raises:
        ShapeError: It does not have a value for each joint.
        InputError: It is not finite, leaves a bound, or does not lie on the path: by how much.
    """
    q = finite(np.asarray(q, dtype=float), name, (cell.n,))
    beyond = np.maximum(cell.lower - q, q - cell.upper)
    worst = int(np.argmax(beyond))
    if beyond[worst] > TOLERANCE.bound:
        raise InputError(
            f"{cell.joint_names[worst]} is {q[worst]:.6g}, {beyond[worst]:.2g} beyond its bounds "
            f"{cell.lower[worst]:.6g} to {cell.upper[worst]:.6g} (rad or m)",
            field=name,
        )
    residual, _ = pose_residual(
        Relative(cell, q),
        path.position[point],
        path.rotation[point],
        int(path.rows[point]),
        path.spin_axis,
    )
    off, turned = (float(np.linalg.norm(part)) for part in (residual[:3], residual[3:]))
    if off > TOLERANCE.position or turned > TOLERANCE.rotation:
        raise InputError(
            f"this posture does not lie on the path: e2 is {1e3 * off:.3g} mm and "
            f"{np.rad2deg(turned):.3g} deg from point {point + 1}; {TOLERANCE.position:g} m and "
            f"{TOLERANCE.rotation:g} rad are allowed",
            field=name,
        )
    return q
