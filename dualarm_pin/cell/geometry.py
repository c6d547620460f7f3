"""What a cell knows of its bodies: pairs, distances, shapes; loaded when first asked for."""

from __future__ import annotations

import threading
import weakref
from functools import cached_property
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike, NDArray

from dualarm_pin.arrays import Array
from dualarm_pin.cell.assemble import CellParts
from dualarm_pin.cell.bodies import CellBodies
from dualarm_pin.cell.clearance import all_distances, measured, placed, smallest
from dualarm_pin.cell.parts import ARMS, Clearance, Pair
from dualarm_pin.errors import ShapeError


class CellGeometry(CellParts):
    """The part of `Cell` that deals with bodies; a cell that nothing was asked of loads none."""

    @cached_property
    def _bodies(self) -> CellBodies:
        raise NotImplementedError

    @property
    def n(self) -> int:
        """Number of columns of q."""
        return len(self.joints)

    @cached_property
    def same_order(self) -> bool:
        """Whether Pinocchio's q is q itself: `joint_map` is the identity, without offset."""
        nv, n = self.joint_map.shape
        return nv == n and np.array_equal(self.joint_map, np.eye(n)) and not self.joint_offset.any()

    def model_q(self, q: ArrayLike) -> NDArray[np.float64]:
        """Return Pinocchio's q (nv,) for q (n,).

        Raises:
            ShapeError: q does not have n values.
        """
        q = np.asarray(q, dtype=float)
        if q.shape != (self.n,):
            raise ShapeError(f"q has shape {q.shape}; {self.name} has {self.n} joints: ({self.n},)")
        return q if self.same_order else self.joint_map @ q + self.joint_offset

    @property
    def collision(self) -> pin.GeometryModel:
        """Convex hulls and primitives, with the pairs to check."""
        return self._bodies.hulls.model

    @property
    def collision_meshes(self) -> pin.GeometryModel:
        """The same bodies and pairs, with the meshes as they are."""
        return self._bodies.meshes.model

    @property
    def visual(self) -> pin.GeometryModel:
        """Bodies for the eye."""
        return self._bodies.visual.model

    @property
    def missing_meshes(self) -> tuple[str, ...]:
        """Collision bodies that could not be loaded, and why; clearance is then unknown."""
        return self._bodies.hulls.missing

    @property
    def missing_visuals(self) -> tuple[str, ...]:
        """Bodies for the eye that could not be loaded, and why."""
        return self._bodies.visual.missing

    @property
    def dropped_pairs(self) -> tuple[str, ...]:
        """Pairs that are not checked because they touch in nearly every posture."""
        return self._bodies.dropped

    def clearance(
        self, q: ArrayLike, *, between_arms: bool = False, exact: bool = False
    ) -> Clearance | None:
        """Return the smallest distance at q (n,), or None where it is not known.

        It is known if every collision body could be loaded and there is a pair to compare.

        Args:
            q: Joints (n,) [rad or m].
            between_arms: Only between the arms, not within one.
            exact: With the meshes as they are. By default their convex hulls are taken, which
                never say more than there is and are a hundred times faster.

        Raises:
            ShapeError: q does not have n values.
        """
        q = self.model_q(q)
        hulls = self._bodies.hulls
        if hulls.missing:
            return None
        meshes = self._bodies.meshes if exact else None
        return smallest(self.model, hulls, q, scratch_of(self), between_arms, meshes)

    def data(self) -> pin.Data:
        """Return scratch data of this thread; whatever it holds is overwritten by the next call."""
        return scratch_of(self)["data"]

    @cached_property
    def pairs(self) -> tuple[Pair, ...]:
        """The two bodies of each collision pair; those of several shapes stand more than once."""
        links, ends = self._bodies.hulls.links, self.collision.collisionPairs
        return tuple((links[pair.first], links[pair.second]) for pair in ends)

    @cached_property
    def apart_by_nature(self) -> NDArray[np.bool_]:
        """Which of `pairs` (p,) are not of two bodies that move with the same arm."""
        owners, ends = self._bodies.hulls.owners, self.collision.collisionPairs
        return np.array([owners[p.first] != owners[p.second] for p in ends], dtype=bool)

    @cached_property
    def between_arms(self) -> NDArray[np.bool_]:
        """Which of `pairs` (p,) are of one body that moves with arm1 and one with arm2."""
        owners, ends = self._bodies.hulls.owners, self.collision.collisionPairs
        return np.array(
            [{owners[p.first], owners[p.second]} == set(ARMS) for p in ends], dtype=bool
        )

    def distances(self, q: ArrayLike) -> Array:
        """Return the distance of every pair at q (n,), meshes as convex hulls.

        Returns:
            (p,) [m] in the order of `pairs`, negative in collision.

        Raises:
            ShapeError: q does not have n values.
        """
        return all_distances(self.model, self._bodies.hulls, self.model_q(q), scratch_of(self))

    def distance(self, q: ArrayLike, pair: int, *, exact: bool = False) -> float:
        """Return the distance [m] of one pair at q (n,), meshes as convex hulls by default.

        Args:
            q: Joints (n,) [rad or m].
            pair: Which of `pairs`.
            exact: With the meshes as they are.

        Raises:
            ShapeError: q does not have n values.
        """
        bodies = self._bodies
        meshes = bodies.meshes if exact else None
        return measured(self.model, bodies.hulls, self.model_q(q), scratch_of(self), pair, meshes)

    def distance_placed(
        self, pair: int, first: pin.SE3, second: pin.SE3, *, exact: bool = False
    ) -> float:
        """Return the distance [m] of a pair of bodies put anywhere, as convex hulls by default.

        Args:
            pair: Which of `pairs`.
            first: Pose of its first body in any frame.
            second: Pose of the second in the same frame.
            exact: With the meshes as they are.
        """
        bodies = self._bodies
        meshes = bodies.meshes if exact else None
        return placed(bodies.hulls, scratch_of(self), pair, (first, second), meshes)


_THREAD = threading.local()


def scratch_of(cell: CellGeometry) -> dict[str, Any]:
    """Return the work space of this thread for a cell."""
    try:
        scratch: dict[str, Any] = _THREAD.of[cell]
    except (AttributeError, KeyError):
        if not hasattr(_THREAD, "of"):
            _THREAD.of = weakref.WeakKeyDictionary()
        scratch = _THREAD.of[cell] = {"data": cell.model.createData()}
    return scratch
