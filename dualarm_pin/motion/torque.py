"""Torques of the joints: gravity, inertia and what the tool presses with, by Pinocchio."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from dualarm_pin.arrays import Array
from dualarm_pin.cell import Cell
from dualarm_pin.relative import Relative


@dataclass(frozen=True, eq=False)
class Torques:
    """What the drives of a cell have to hold.

    A tool that presses on the work with a force f along u loads both arms: J_r^T f u.

    Attributes:
        cell: The two arms.
        force: Force of the tool along u [N].
        masses: Whether all moving links have inertias; without them only the force counts.
    """

    cell: Cell
    force: float

    @property
    def masses(self) -> bool:
        """Whether every moving joint carries a mass."""
        return not self.cell.massless_joints

    @property
    def known(self) -> bool:
        """Whether there is anything to compute."""
        return self.masses or self.force != 0.0

    @property
    def note(self) -> str:
        """What the torques are made of, in words."""
        if self.masses:
            light = len(self.cell.links_without_inertia)
            bare = f"; links without inertia count as massless: {light}" if light else ""
            return f"gravity, inertia{' and tool force' if self.force else ''}{bare}"
        lacking = self.cell.massless_joints
        more = f" and {len(lacking) - 1} more joints" if len(lacking) > 1 else ""
        which = f"the masses that {lacking[0]}{more} move are not in the URDF"
        return f"static part of the tool force alone: {which}" if self.force else which

    def static(self, q: Array, u: Array) -> Array:
        """Return the torques (m, n) at rest at q (m, n) with the tool pressing along u (m, 6)."""
        return self.moving(q, np.zeros_like(q), np.zeros_like(q)) + self.pressing(q, u)

    def pressing(self, q: Array, u: Array) -> Array:
        """Return the part of the tool force (m, n)."""
        if not self.force:
            return np.zeros_like(q)
        turned = [self.force * Relative(self.cell, q[i]).J_r.T @ u[i] for i in range(len(q))]
        return np.array(turned)

    def moving(self, q: Array, velocity: Array, acceleration: Array) -> Array:
        """Return the torques (m, n) of masses: gravity, inertia, Coriolis; zeros without any."""
        if not self.masses:
            return np.zeros_like(q)
        cell, model, data = self.cell, self.cell.model, self.cell.data()
        to_model = cell.joint_map.T
        all_q, all_v = q @ to_model + cell.joint_offset, velocity @ to_model
        rows = zip(all_q, all_v, acceleration @ to_model, strict=True)
        found = np.array([pin.rnea(model, data, *row) for row in rows])
        return np.asarray(found @ cell.joint_map)
