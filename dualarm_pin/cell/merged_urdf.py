"""One URDF document for the whole cell, in the plainest form Pinocchio can be given.

Names get a prefix, continuous joints a finite interval (so that nq == nv and q is plain angles),
and every joint that stands still becomes a fixed joint at its value. What Pinocchio then sees has
no mimic, no mesh, no clash of names and no value that has not been checked. Speed and effort of
0 are unknown, as in any URDF.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from xml.sax.saxutils import quoteattr

import numpy as np
import pinocchio as pin

from dualarm_pin.cell.joint_limits import TURN
from dualarm_pin.cell.placed_robot import PlacedRobot
from dualarm_pin.cell.poses import pose_of
from dualarm_pin.robot.robot import MOMENTS, Inertial, UrdfJoint

# No slash: never the name of a robot's link or joint.
WORLD, TOOLS = "cell", ("e1", "e2")
BASE, TOOL = "base", "tool:"  # joints: that of a robot by its number from 1, that of a tool


def merged_urdf(robots: Sequence[PlacedRobot], tools: Mapping[str, tuple[str, pin.SE3]]) -> str:
    """Return the URDF text; `tools`: tool frame to (frame that carries it, pose in that frame)."""
    lines = [f'<robot name="{WORLD}">', f'<link name="{WORLD}"/>']
    for number, placed in enumerate(robots, start=1):
        frames = placed.frames
        robot = placed.chains.robot
        for link in robot.links.values():
            lines += _link(frames[link.name], link.inertial)
        lines += _fixed(f"{BASE}{number}", WORLD, frames[robot.root], placed.base)
        for joint in robot.joints.values():
            lines += _joint(placed, joint, frames)
    for tool, (carrier, pose) in tools.items():
        lines.append(f"<link name={quoteattr(tool)}/>")
        lines += _fixed(f"{TOOL}{tool}", carrier, tool, pose)
    return "\n".join([*lines, "</robot>"])


def _link(name: str, inertial: Inertial | None) -> list[str]:
    if inertial is None:
        return [f"<link name={quoteattr(name)}/>"]
    inertia = " ".join(f'{k}="{v!r}"' for k, v in zip(MOMENTS, inertial.inertia, strict=True))
    return [
        f"<link name={quoteattr(name)}><inertial>",
        _origin(inertial.xyz, inertial.rpy),
        f'<mass value="{inertial.mass!r}"/><inertia {inertia}/></inertial></link>',
    ]


def _joint(placed: PlacedRobot, joint: UrdfJoint, frames: Mapping[str, str]) -> list[str]:
    roles = placed.roles
    name, parent, child = placed.joint(joint.name), frames[joint.parent], frames[joint.child]
    effort = joint.effort
    if joint.name in roles.columns:
        column = roles.columns[joint.name]
        lower, upper, speed = column.lower, column.upper, column.velocity
        effort = column.effort
    elif joint.name in roles.followers:
        leader, multiplier, offset = roles.followers[joint.name]
        column = roles.columns[leader]
        lower, upper = sorted(multiplier * end + offset for end in (column.lower, column.upper))
        speed = None if column.velocity is None else abs(multiplier) * column.velocity
    else:
        value = roles.values.get(joint.name, 0.0)
        if value == 0.0:
            return _fixed_text(name, parent, child, _origin(joint.xyz, joint.rpy))
        axis = np.array(joint.axis)
        moved = pin.SE3.Identity()
        if joint.kind == "prismatic":
            moved.translation = value * axis
        else:
            moved.rotation = pin.exp3(math.remainder(value, TURN) * axis)
        return _fixed(name, parent, child, pose_of(joint.xyz, joint.rpy) * moved)
    kind = "prismatic" if joint.kind == "prismatic" else "revolute"
    x, y, z = joint.axis
    return [
        f'<joint name={quoteattr(name)} type="{kind}">{_origin(joint.xyz, joint.rpy)}',
        f"<parent link={quoteattr(parent)}/><child link={quoteattr(child)}/>",
        f'<axis xyz="{x!r} {y!r} {z!r}"/>',
        f'<limit lower="{lower!r}" upper="{upper!r}" effort="{effort or 0.0!r}" '
        f'velocity="{speed or 0.0!r}"/></joint>',
    ]


def _fixed(name: str, parent: str, child: str, pose: pin.SE3) -> list[str]:
    xyz = [float(value) for value in pose.translation]
    rpy = [float(value) for value in pin.rpy.matrixToRpy(pose.rotation)]
    return _fixed_text(name, parent, child, _origin(xyz, rpy))


def _fixed_text(name: str, parent: str, child: str, origin: str) -> list[str]:
    return [
        f'<joint name={quoteattr(name)} type="fixed">{origin}'
        f"<parent link={quoteattr(parent)}/><child link={quoteattr(child)}/></joint>"
    ]


def _origin(xyz: Sequence[float], rpy: Sequence[float]) -> str:
    return f'<origin xyz="{" ".join(map(repr, xyz))}" rpy="{" ".join(map(repr, rpy))}"/>'
