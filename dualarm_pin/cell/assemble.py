"""From a specification to the parts of a cell: read, sort the joints, build the model."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
import pinocchio as pin

from dualarm_pin.arrays import Array
from dualarm_pin.cell.chains import Chains
from dualarm_pin.cell.controller import controller_of
from dualarm_pin.cell.joint_roles import roles_of
from dualarm_pin.cell.joint_settings import Blame, RobotSettings, find_joints, settings_of
from dualarm_pin.cell.merged_model import joint_map_of, merged_model
from dualarm_pin.cell.merged_urdf import TOOLS, WORLD
from dualarm_pin.cell.objects import PlacedObject, colliding_links, placed_objects
from dualarm_pin.cell.parts import ARMS, Arm, Joint, SourceFile, read_only
from dualarm_pin.cell.placed_robot import PlacedRobot
from dualarm_pin.cell.poses import placement_pose
from dualarm_pin.cell.read_robots import Loader, read_robots
from dualarm_pin.files.cell_spec import CellSpec


@dataclass(frozen=True, eq=False)
class CellParts:
    """What a `Cell` holds; see there."""

    name: str
    model: pin.Model
    e1: int
    e2: int
    joints: tuple[Joint, ...]
    joint_map: Array
    joint_offset: Array
    arms: tuple[Arm, Arm]
    warnings: tuple[str, ...]
    sources: tuple[SourceFile, ...]
    tool_axes: tuple[Array, Array]
    _robots: tuple[PlacedRobot, ...]
    _disabled: Mapping[int, frozenset[frozenset[str]]]
    _package_dirs: tuple[Path, ...]
    _objects: tuple[PlacedObject, ...]

    @cached_property
    def body_names(self) -> tuple[str, ...]:
        """Names of what may collide: links with a body, `arm1/<link>`, objects; loads nothing."""
        return (*colliding_links(self._robots), *(thing.name for thing in self._objects))

    @property
    def objects(self) -> tuple[PlacedObject, ...]:
        """What stands in the cell or is carried, beside the links of the URDFs."""
        return self._objects

    @property
    def one_urdf(self) -> bool:
        """Whether one URDF holds both arms."""
        return any(len(robot.chains.tips) > 1 for robot in self._robots)


def assemble(loader: Loader) -> CellParts:
    """Return the parts of the cell that a loader's specification asks for.

    Raises:
        InputError: The specification or a file it names is wrong.
    """
    spec, blame, name = loader.spec, loader.blame, loader.spec.name or loader.name
    chains, srdfs = read_robots(loader)
    settings = settings_of(chains, spec, blame)
    free = _free(chains, settings, spec, blame)
    robots: dict[str, PlacedRobot] = {}
    for key, one in chains.items():
        base = None if key == "both" else getattr(spec.arms, key).base
        roles = roles_of(settings[key], free)
        loader.warnings += roles.warnings
        robots[key] = PlacedRobot(one, roles, placement_pose(base))
    placed = tuple(robots.values())
    columns = _columns(placed)
    arms = (_arm(spec, robots, columns, "arm1", blame), _arm(spec, robots, columns, "arm2", blame))
    if not columns:
        raise blame("nothing moves: neither arm has a joint that is not locked", ("arms",))
    tools = {tool: _carrier(robots, arm) for tool, arm in zip(TOOLS, arms, strict=True)}
    model = merged_model(placed, tools, name)
    e1, e2 = (model.getFrameId(tool, pin.FrameType.BODY) for tool in TOOLS)
    joint_map, joint_offset = joint_map_of(model, placed, columns)
    unknown = [joint.name for joint in columns if joint.velocity is None]
    if unknown:
        which = "every joint" if len(unknown) == len(columns) else ", ".join(unknown)
        loader.warnings.append(f"no speed limit known (0 or missing in the URDF): {which}")
    return CellParts(
        name,
        model,
        e1,
        e2,
        columns,
        joint_map,
        joint_offset,
        arms,
        warnings=tuple(dict.fromkeys(loader.warnings)),
        sources=tuple(SourceFile(path, digest) for path, digest in loader.sources.items()),
        tool_axes=(_unit(spec.arms.arm1.tool_axis), _unit(spec.arms.arm2.tool_axis)),
        _robots=placed,
        _disabled={
            number: srdfs[key].disabled for number, key in enumerate(robots) if key in srdfs
        },
        _package_dirs=loader.package_dirs,
        _objects=placed_objects(loader, placed),
    )


def _free(
    chains: Mapping[str, Chains],
    settings: Mapping[str, RobotSettings],
    spec: CellSpec,
    blame: Blame,
) -> list[str]:
    names = []
    for name in spec.free:
        for key, joint in find_joints(chains, name, ("free",), blame):
            common = chains[key].moving.get("common", ())
            if joint not in common:
                shared = ", ".join(repr(j.name) for j in common) or "there are none"
                message = f"joint {name!r} is not common to both arms; common joints: {shared}"
                raise blame(message, ("free",))
            if joint.name in settings[key].lock:
                raise blame(f"joint {name!r} is locked too: choose one", ("free",))
            names.append(joint.name)
    return names


def _arm(
    spec: CellSpec,
    robots: Mapping[str, PlacedRobot],
    columns: Sequence[Joint],
    arm: str,
    blame: Blame,
) -> Arm:
    own = getattr(spec.arms, arm)
    tool = placement_pose(own.tool)
    joints = [joint for joint in columns if joint.arm == arm]
    controller = controller_of(own.controller, joints, blame, ("arms", arm, "controller"))
    placed = robots.get(arm, robots.get("both"))
    if placed is None:
        return Arm(arm, None, "", "", placement_pose(own.base), tool, (), controller)
    names = tuple(joint.name for joint in joints)
    robot, tip = placed.chains.robot, placed.chains.tips[arm]
    return Arm(arm, robot.file, robot.root, tip, placed.base, tool, names, controller)


def _carrier(robots: Mapping[str, PlacedRobot], arm: Arm) -> tuple[str, pin.SE3]:
    """Return the frame that carries the tool of an arm, and the pose of the tool in it."""
    placed = robots.get(arm.name, robots.get("both"))
    if placed is None:
        return WORLD, arm.base * arm.tool
    return placed.frames[arm.tip], arm.tool


def _columns(robots: Sequence[PlacedRobot]) -> tuple[Joint, ...]:
    every = [joint for placed in robots for joint in placed.roles.columns.values()]
    return tuple(joint for owner in (*ARMS, "common") for joint in every if joint.arm == owner)


def _unit(direction: Sequence[float]) -> Array:
    return read_only(np.array(direction) / np.linalg.norm(direction))
