"""The bodies of a cell, each kind loaded when it is first asked for."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Literal

import pinocchio as pin

from dualarm_pin.arrays import Array
from dualarm_pin.cell.build_bodies import Bodies, build_bodies
from dualarm_pin.cell.moved import Moves, moved_bodies
from dualarm_pin.cell.objects import PlacedObject
from dualarm_pin.cell.overlaps import refuse_overlaps
from dualarm_pin.cell.pairs import add_pairs
from dualarm_pin.cell.placed_robot import PlacedRobot


@dataclass(frozen=True, eq=False)
class CellBodies:
    """The bodies that the URDFs name.

    Attributes:
        model: Model of the cell.
        robots: Its placed URDFs.
        objects: What stands in the cell or is carried.
        disabled: Number of a robot to the pairs of plain link names its SRDF disables.
        package_dirs: Further folders to search for meshes.
        postures: q of the model (m, nv), to find pairs that always collide.
        loaded: For bases elsewhere: the bodies as loaded, once however often they move.
        moves: How the bases moved since.
    """

    model: pin.Model
    robots: tuple[PlacedRobot, ...]
    objects: tuple[PlacedObject, ...]
    disabled: Mapping[int, frozenset[frozenset[str]]]
    package_dirs: tuple[Path, ...]
    postures: Array
    loaded: CellBodies | None = None
    moves: Moves = field(default_factory=dict)

    @cached_property
    def hulls(self) -> Bodies:
        """Convex hulls and primitives, with the pairs to check."""
        return self._moved(self.loaded.hulls) if self.loaded else self._checked[0]

    @property
    def dropped(self) -> tuple[str, ...]:
        """Pairs that are not checked, and why."""
        return self.loaded.dropped if self.loaded else self._checked[1]

    @cached_property
    def meshes(self) -> Bodies:
        """Collision bodies with their meshes as they are, and the pairs of the hulls."""
        if self.loaded:
            return self._moved(self.loaded.meshes)
        bodies = self._built("collision")
        for pair in self.hulls.model.collisionPairs:
            bodies.model.addCollisionPair(pair)
        return bodies

    @cached_property
    def visual(self) -> Bodies:
        """Bodies for the eye."""
        if self.loaded:
            return self._moved(self.loaded.visual)
        return self._built("visual")

    @cached_property
    def _checked(self) -> tuple[Bodies, tuple[str, ...]]:
        bodies = self._built("collision", hulls=True)
        refuse_overlaps(bodies, self.objects)
        return bodies, add_pairs(
            self.model, bodies, self.robots, self.objects, self.disabled, self.postures
        )

    def _built(self, kind: Literal["visual", "collision"], *, hulls: bool = False) -> Bodies:
        return build_bodies(self.model, self.robots, kind, self.package_dirs, hulls, self.objects)

    def _moved(self, bodies: Bodies) -> Bodies:
        return moved_bodies(bodies, self.model, self.robots, self.moves)
