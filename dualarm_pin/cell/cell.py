"""The noun `Cell`: two arms in one Pinocchio model, immutable."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from dualarm_pin.cell.assemble import assemble
from dualarm_pin.cell.bodies import CellBodies
from dualarm_pin.cell.geometry import CellGeometry
from dualarm_pin.cell.moved import base_moves, moved_model
from dualarm_pin.cell.parts import ARMS, read_only
from dualarm_pin.cell.poses import checked_pose
from dualarm_pin.cell.python_arguments import checked_spec, file_name, placement, thing
from dualarm_pin.cell.read_robots import Loader
from dualarm_pin.errors import InputError
from dualarm_pin.files.source import Key, Source, read_yaml


@dataclass(frozen=True, eq=False, repr=False)
class Cell(CellGeometry):
    """Two arms that share one task, loaded and checked.

    Every joint off the two chains stands still, so q holds only what a planner moves: the joints
    of arm1 base to tip, those of arm2, then common joints that were set free. Bodies and collision
    pairs are loaded on first use. The object is never changed, and can be pickled.

    Attributes:
        name: Name of the cell.
        model: Both arms as one Pinocchio model, nq == nv (continuous joints are plain angles).
        e1: Frame id of the tool of arm1.
        e2: Frame id of the tool of arm2.
        joints: The columns of q (n).
        joint_map: (nv, n); Pinocchio's q is joint_map @ q + joint_offset.
        joint_offset: (nv,) [rad or m]; not 0 only where a mimic joint has an offset.
        arms: The two arms.
        warnings: What is odd, though it works.
        sources: The files it was read from, with their fingerprints.
        tool_axes: Unit direction of each tool in its tool frame, for reports and pictures.
    """

    _loaded: Cell | None = None  # what a moved cell was before

    @classmethod
    def load(cls, file: str | Path) -> Cell:
        """Load a cell file.

        Raises:
            MissingFileError: The file, or one it names, does not exist.
            InputError: Something in it is wrong; the message says where and what is allowed.
            MissingExtraError: It needs a library that is not installed.
        """
        return cls.from_source(read_yaml(file))

    @classmethod
    def from_source(cls, source: Source, keys: Sequence[Key] = ()) -> Cell:
        """Build the cell that stands in a file that was read.

        Args:
            source: A cell file, or a task file with the cell inside.
            keys: Where in the file the cell stands.

        Raises:
            InputError: As for `load`.
        """
        loader = Loader.of_file(source, keys)
        return cls._made(loader)

    @classmethod
    def from_urdf(
        cls,
        urdf1: str | Path,
        urdf2: str | Path | None = None,
        *,
        base1: pin.SE3 | None = None,
        base2: pin.SE3 | None = None,
        tips: tuple[str, str] = ("flange", "flange"),
        tools: tuple[pin.SE3 | None, pin.SE3 | None] = (None, None),
        limits: Mapping[str, tuple[float, float]] | None = None,
        lock: Mapping[str, float] | None = None,
        free: Sequence[str] = (),
        srdf: str | Path | tuple[str | Path | None, str | Path | None] | None = None,
        package_dirs: Sequence[str | Path] = (),
        objects: Mapping[str, Mapping[str, Any]] | None = None,
        name: str | None = None,
    ) -> Cell:
        """Build a cell from one URDF that holds both arms, or from two.

        Args:
            urdf1: URDF of the first arm, or of both.
            urdf2: URDF of the second arm; the same file again is fine.
            base1: Pose of the first root link, identity by default.
            base2: Pose of the second root link; only with `urdf2`.
            tips: Links that carry the tools.
            tools: Poses of the tool frames in the tips.
            limits: Bounds [rad or m] by joint, `joint` for both arms or `arm1/joint`.
            lock: Values [rad or m] at which joints stand still.
            free: Common joints that may move.
            srdf: SRDF of `urdf1` (and of `urdf2` if that is the same file), or one for each.
            package_dirs: Further folders to search for packages and meshes.
            objects: Things in the cell as a cell file states them, by name; `at` may be a
                `pin.SE3`.
            name: Name of the cell.

        Raises:
            MissingFileError: A file does not exist.
            InputError: Something is wrong; the message says where and what is allowed.
        """
        first, second = srdf if isinstance(srdf, tuple) else (srdf, None)
        if urdf2 is not None and not isinstance(srdf, tuple) and str(urdf1) == str(urdf2):
            second = first
        arms: dict[str, dict[str, Any]] = {}
        for arm, tip, tool, base in zip(ARMS, tips, tools, (base1, base2), strict=True):
            arms[arm] = {"tip": tip, "tool": placement(tool)}
            if base is not None:
                arms[arm]["base"] = placement(base)
        robot1 = {"urdf": str(urdf1), "srdf": file_name(first)}
        if urdf2 is not None:
            arms["arm1"] |= robot1
            arms["arm2"] |= {"urdf": str(urdf2), "srdf": file_name(second)}
        whole = {
            "arms": arms,
            "limits": {key: tuple(pair) for key, pair in (limits or {}).items()},
            "lock": dict(lock or {}),
            "free": list(free),
            "package_dirs": [str(entry) for entry in package_dirs],
            "objects": {key: thing(given) for key, given in (objects or {}).items()},
        }
        spec = checked_spec(whole if urdf2 is not None else whole | robot1)
        return cls._made(Loader.of_python(spec, name or Path(urdf1).stem))

    @classmethod
    def _made(cls, loader: Loader) -> Cell:
        cell = cls(**vars(assemble(loader)))
        if loader.spec.objects:  # their meshes and places are the user's: errors come at once
            try:
                _ = cell.collision
            except InputError as error:
                raise loader.blame(error.message, (error.field or "").split(".")) from error
        return cell

    def moved(self, *, base1: pin.SE3 | None = None, base2: pin.SE3 | None = None) -> Cell:
        """Return this cell with its bases elsewhere; no file is read, and bodies are shared.

        Args:
            base1: Pose of the root link of arm1 in the cell; where it stands if None.
            base2: The same for arm2.

        Raises:
            ShapeError: A base is no `pin.SE3`.
            InputError: It is not finite, or one URDF holds both arms: they have no base to move.
        """
        bases = {arm.name: arm.base for arm in self.arms}
        for arm, field, base in zip(ARMS, ("base1", "base2"), (base1, base2), strict=True):
            if base is None:
                continue
            if any(len(robot.chains.tips) > 1 for robot in self._robots):
                message = f"one URDF holds both arms of {self.name}: neither has a base to move"
                raise InputError(f"{message}; give each arm a URDF of its own", field=field)
            bases[arm] = checked_pose(base, field)
        loaded = self._loaded or self  # moves start from what was loaded: nothing adds up
        first, second = (replace(arm, base=bases[arm.name]) for arm in loaded.arms)
        moves = base_moves(loaded.arms, (first, second))
        return replace(
            loaded,
            model=moved_model(loaded.model, loaded._robots, moves),
            arms=(first, second),
            _robots=tuple(
                replace(robot, base=bases[min(robot.chains.tips)]) for robot in loaded._robots
            ),
            _loaded=loaded,
        )

    def __repr__(self) -> str:
        return f"Cell({self.name!r}, {self.n} joints)"

    @cached_property
    def joint_names(self) -> tuple[str, ...]:
        """Names in column order."""
        return tuple(joint.name for joint in self.joints)

    @cached_property
    def lower(self) -> NDArray[np.float64]:
        """Lower bounds (n,) [rad or m], read-only."""
        return read_only([joint.lower for joint in self.joints])

    @cached_property
    def upper(self) -> NDArray[np.float64]:
        """Upper bounds (n,) [rad or m], read-only."""
        return read_only([joint.upper for joint in self.joints])

    @property
    def locked(self) -> dict[str, float]:
        """Joints that stand still, `arm1/<name>`, and where [rad or m]."""
        return {
            placed.joint(name): value
            for placed in self._robots
            for name, value in placed.roles.values.items()
        }

    @property
    def links_without_inertia(self) -> tuple[str, ...]:
        """Moving links, `arm1/<link>`, whose mass no URDF states; plain frames are not counted."""
        return tuple(link for placed in self._robots for link in placed.links_without_inertia())

    @property
    def massless_joints(self) -> tuple[str, ...]:
        """Joints of the model that carry no mass at all, up to the next joint."""
        inertias = self.model.inertias
        names = self.model.names
        return tuple(names[j] for j in range(1, self.model.njoints) if not inertias[j].mass > 0.0)

    @cached_property
    def _bodies(self) -> CellBodies:
        if self._loaded is not None:
            bodies, moves = self._loaded._bodies, base_moves(self._loaded.arms, self.arms)
            return replace(bodies, loaded=bodies, moves=moves)
        # The same postures on every machine: which pairs are dropped must not depend on luck.
        draw = np.random.default_rng(0).uniform(self.lower, self.upper, (100, self.n))
        postures = draw @ self.joint_map.T + self.joint_offset
        return CellBodies(
            self.model, self._robots, self._objects, self._disabled, self._package_dirs, postures
        )

    def __getstate__(self) -> dict[str, Any]:
        """Leave the bodies behind: a worker loads them when it needs them."""
        return {item.name: getattr(self, item.name) for item in fields(self)}
