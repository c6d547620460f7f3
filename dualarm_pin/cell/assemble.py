"""From a specification to a `Cell`: read, sort the joints, build the model."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import pinocchio as pin

from dualarm_pin.cell.joint_settings import Asked, Blame, find_joints, gather
from dualarm_pin.cell.cell import Cell, read_only
from dualarm_pin.cell.chains import Chains
from dualarm_pin.cell.merged_urdf import TOOLS, WORLD, Placed, document, pose_of
from dualarm_pin.cpp_messages import model_from_xml
from dualarm_pin.cell.parts import ARMS, Arm, Joint, SourceFile
from dualarm_pin.cell.read_robots import Loader, read_robots
from dualarm_pin.cell.joint_roles import settle
from dualarm_pin.files.cell_spec import CellSpec, PlacementSpec


def build(loader: Loader, name: str) -> Cell:
    """Build a cell.

    Args:
        loader: The specification and where it came from.
        name: Name of the cell.

    Raises:
        InputError: The specification or a file it names is wrong.
    """
    spec, blame = loader.spec, loader.blame
    chains, srdfs = read_robots(loader)
    asked = gather(chains, spec, blame)
    free = _free(chains, asked, spec, blame)
    robots: dict[str, Placed] = {}
    for key, one in chains.items():
        base = None if key == "both" else getattr(spec.arms, key).base
        settled = settle(one, asked[key], free, blame)
        loader.warnings += settled.warnings
        robots[key] = Placed(one, settled, _pose(base))
    arms = tuple(_arm(spec, robots, arm) for arm in ARMS)
    tools = {
        tool: _carrier(robots, arm, pose)
        for tool, arm, pose in zip(TOOLS, arms, _tools(spec), strict=True)
    }
    columns = _columns(robots)
    if not columns:
        raise blame("nothing moves: neither arm has a joint that is not locked", ("arms",))
    model = model_from_xml(document(list(robots.values()), tools), name)
    joint_map, joint_offset = _joint_map(model, robots, columns)
    unknown = [joint.name for joint in columns if joint.velocity is None]
    if unknown:
        which = "every joint" if len(unknown) == len(columns) else ", ".join(unknown)
        loader.warnings.append(f"no speed limit known (0 or missing in the URDF): {which}")
    axes = [np.array(getattr(spec.arms, arm).tool_axis) for arm in ARMS]
    return Cell(
        name=name,
        model=model,
        e1=model.getFrameId(TOOLS[0], pin.FrameType.BODY),
        e2=model.getFrameId(TOOLS[1], pin.FrameType.BODY),
        joints=tuple(columns),
        joint_map=read_only(joint_map),
        joint_offset=read_only(joint_offset),
        arms=(arms[0], arms[1]),
        warnings=tuple(dict.fromkeys(loader.warnings)),
        sources=tuple(SourceFile(path, digest) for path, digest in loader.sources.items()),
        tool_axes=(
            read_only(axes[0] / np.linalg.norm(axes[0])),
            read_only(axes[1] / np.linalg.norm(axes[1])),
        ),
        _robots=tuple(robots.values()),
        _disabled={
            number: srdfs[key].disabled for number, key in enumerate(robots) if key in srdfs
        },
        _package_dirs=loader.package_dirs,
    )


def _free(
    chains: Mapping[str, Chains], asked: Mapping[str, Asked], spec: CellSpec, blame: Blame
) -> list[str]:
    names = []
    for name in spec.free:
        for key, joint in find_joints(chains, name, ("free",), blame):
            common = chains[key].moving.get("common", ())
            if joint not in common:
                shared = ", ".join(repr(j.name) for j in common) or "there are none"
                raise blame(
                    f"joint {name!r} is not common to both arms; common joints: {shared}", ("free",)
                )
            if joint.name in asked[key].lock:
                raise blame(f"joint {name!r} is locked too: choose one", ("free",))
            names.append(joint.name)
    return names


def _tools(spec: CellSpec) -> list[pin.SE3]:
    return [_pose(getattr(spec.arms, arm).tool) for arm in ARMS]


def _arm(spec: CellSpec, robots: Mapping[str, Placed], arm: str) -> Arm:
    own = getattr(spec.arms, arm)
    placed = robots.get(arm, robots.get("both"))
    if placed is None:
        return Arm(arm, None, "", "", _pose(own.base), _pose(own.tool), ())
    joints = tuple(j.name for j in placed.settled.columns.values() if j.arm == arm)
    robot = placed.chains.robot
    return Arm(
        arm, robot.file, robot.root, placed.chains.tips[arm], placed.base, _pose(own.tool), joints
    )


def _carrier(robots: Mapping[str, Placed], arm: Arm, tool: pin.SE3) -> tuple[str, pin.SE3]:
    placed = robots.get(arm.name, robots.get("both"))
    if placed is None:
        return WORLD, arm.base * tool
    return placed.frames()[arm.tip], tool


def _columns(robots: Mapping[str, Placed]) -> list[Joint]:
    every = [joint for placed in robots.values() for joint in placed.settled.columns.values()]
    return [joint for owner in (*ARMS, "common") for joint in every if joint.arm == owner]


def _joint_map(
    model: pin.Model, robots: Mapping[str, Placed], columns: Sequence[Joint]
) -> tuple[np.ndarray, np.ndarray]:
    """Return how Pinocchio's q, in its own order and with followers, comes from q."""
    column = {joint.name: k for k, joint in enumerate(columns)}
    joint_map, offset = np.zeros((model.nv, len(columns))), np.zeros(model.nv)
    for placed in robots.values():
        for name in placed.settled.columns:
            full = placed.joint(name)
            joint_map[model.joints[model.getJointId(full)].idx_v, column[full]] = 1.0
        for name, (leader, multiplier, shift) in placed.settled.followers.items():
            row = model.joints[model.getJointId(placed.joint(name))].idx_v
            joint_map[row, column[placed.joint(leader)]] = multiplier
            offset[row] = shift
    return joint_map, offset


def _pose(placement: PlacementSpec | None) -> pin.SE3:
    if placement is None:
        return pin.SE3.Identity()
    if placement.rotation is not None:
        rotation = pin.Quaternion(np.array(placement.rotation)).normalized().toRotationMatrix()
        return pin.SE3(rotation, np.array(placement.xyz))
    rpy = placement.rpy or (0.0, 0.0, 0.0)
    if placement.rpy_deg is not None:
        rpy = tuple(np.deg2rad(placement.rpy_deg))
    return pose_of(placement.xyz, rpy)
