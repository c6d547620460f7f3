"""The bodies of a cell, each kind loaded when it is first asked for."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import pinocchio as pin

from dualarm_pin.arrays import Array
from dualarm_pin.cell.build_bodies import Bodies, build_bodies
from dualarm_pin.cell.moved import Moves, moved_bodies
from dualarm_pin.cell.pairs import add_pairs
from dualarm_pin.cell.placed_robot import PlacedRobot


@dataclass(frozen=True, eq=False)
class CellBodies:
    """The bodies that the URDFs name.

    Attributes:
        model: Model of the cell.
        robots: Its placed URDFs.
        disabled: Number of a robot to the pairs of plain link names its SRDF disables.
        package_dirs: Further folders to search for meshes.
        postures: q of the model (m, nv), to find pairs that always collide.
    """

    model: pin.Model
    robots: tuple[PlacedRobot, ...]
    disabled: Mapping[int, frozenset[frozenset[str]]]
    package_dirs: tuple[Path, ...]
    postures: Array

    @property
    def hulls(self) -> Bodies:
        """Convex hulls and primitives, with the pairs to check."""
        return self._checked[0]

    @property
    def dropped(self) -> tuple[str, ...]:
        """Pairs that are not checked, and why."""
        return self._checked[1]

    @cached_property
    def meshes(self) -> Bodies:
        """Collision bodies with their meshes as they are, and the pairs of the hulls."""
        bodies = build_bodies(self.model, self.robots, "collision", self.package_dirs)
        for pair in self.hulls.model.collisionPairs:
            bodies.model.addCollisionPair(pair)
        return bodies

    @cached_property
    def visual(self) -> Bodies:
        """Bodies for the eye."""
        return build_bodies(self.model, self.robots, "visual", self.package_dirs)

    @cached_property
    def _checked(self) -> tuple[Bodies, tuple[str, ...]]:
        bodies = build_bodies(self.model, self.robots, "collision", self.package_dirs, True)
        return bodies, add_pairs(self.model, bodies, self.robots, self.disabled, self.postures)


@dataclass(frozen=True, eq=False)
class MovedBodies:
    """The same bodies with bases elsewhere: loaded once however often they move."""

    loaded: CellBodies
    moves: Moves

    @cached_property
    def hulls(self) -> Bodies:
        """See `CellBodies`."""
        return self._moved(self.loaded.hulls)

    @property
    def dropped(self) -> tuple[str, ...]:
        """See `CellBodies`."""
        return self.loaded.dropped

    @cached_property
    def meshes(self) -> Bodies:
        """See `CellBodies`."""
        return self._moved(self.loaded.meshes)

    @cached_property
    def visual(self) -> Bodies:
        """See `CellBodies`."""
        return self._moved(self.loaded.visual)

    def _moved(self, bodies: Bodies) -> Bodies:
        return moved_bodies(bodies, self.loaded.model, self.loaded.robots, self.moves)
