"""One URDF document for the whole cell, in the plainest form Pinocchio can be given.

Names get a prefix, continuous joints a finite interval (so that nq == nv and q is plain angles),
and every joint that stands still becomes a fixed joint at its value. What Pinocchio then sees has
no mimic, no mesh, no clash of names and no value that has not been checked.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from xml.sax.saxutils import quoteattr

import numpy as np
import pinocchio as pin

from dualarm_pin.cell.chains import Chains
from dualarm_pin.cell.joint_roles import TURN, Settled
from dualarm_pin.robot.robot import Inertial, UrdfJoint

WORLD, TOOLS = "cell", ("e1", "e2")  # no slash: never the name of a robot's link


@dataclass(frozen=True)
class Placed:
    """A URDF with its decided joints and its place in the cell."""

    chains: Chains
    settled: Settled
    base: pin.SE3

    def joint(self, name: str) -> str:
        """Return the full name of a joint."""
        return f"{self.chains.joint_owner[name]}/{name}"

    def link(self, name: str) -> str:
        """Return the full name of a link, as shown to users."""
        return f"{self.chains.owner[name]}/{name}"

    def frames(self) -> dict[str, str]:
        """Return the name of each link in Pinocchio: another one where a joint has the same."""
        robot = self.chains.robot
        taken = {self.joint(joint) for joint in robot.joints} | {self.link(k) for k in robot.links}
        names = {}
        for link in robot.links:
            full = self.link(link)
            if link in robot.joints and self.joint(link) == full:
                while full in taken:
                    full += ":link"
                taken.add(full)
            names[link] = full
        return names


def document(robots: Sequence[Placed], tools: Mapping[str, tuple[str, pin.SE3]]) -> str:
    """Return the URDF text of the cell.

    Args:
        robots: The placed URDFs.
        tools: Tool frame to (frame that carries it, pose in that frame).
    """
    lines = [f'<robot name="{WORLD}">', f'<link name="{WORLD}"/>']
    for number, placed in enumerate(robots, start=1):
        frames = placed.frames()
        robot = placed.chains.robot
        for link in robot.links.values():
            lines += _link(frames[link.name], link.inertial)
        lines += _fixed(f"base{number}", WORLD, frames[robot.root], placed.base)
        for joint in robot.joints.values():
            lines += _joint(placed, joint, frames)
    for tool, (carrier, pose) in tools.items():
        lines.append(f"<link name={quoteattr(tool)}/>")
        lines += _fixed(f"tool:{tool}", carrier, tool, pose)
    return "\n".join([*lines, "</robot>"])


def pose_of(xyz: Sequence[float], rpy: Sequence[float]) -> pin.SE3:
    """Return the pose of a URDF origin."""
    return pin.SE3(pin.rpy.rpyToMatrix(*map(float, rpy)), np.array(xyz, dtype=float))


def _link(name: str, inertial: Inertial | None) -> list[str]:
    if inertial is None:
        return [f"<link name={quoteattr(name)}/>"]
    keys = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
    inertia = " ".join(f'{k}="{v!r}"' for k, v in zip(keys, inertial.inertia, strict=True))
    return [
        f"<link name={quoteattr(name)}><inertial>",
        _origin(inertial.xyz, inertial.rpy),
        f'<mass value="{inertial.mass!r}"/><inertia {inertia}/></inertial></link>',
    ]


def _joint(placed: Placed, joint: UrdfJoint, frames: Mapping[str, str]) -> list[str]:
    settled = placed.settled
    name, parent, child = placed.joint(joint.name), frames[joint.parent], frames[joint.child]
    if joint.name in settled.columns:
        column = settled.columns[joint.name]
        lower, upper = column.lower, column.upper
    elif joint.name in settled.followers:
        leader, multiplier, offset = settled.followers[joint.name]
        ends = settled.columns[leader].lower, settled.columns[leader].upper
        lower, upper = sorted(multiplier * end + offset for end in ends)
    else:
        value = settled.values.get(joint.name, 0.0)
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
        f'<limit lower="{lower!r}" upper="{upper!r}" effort="0" velocity="0"/></joint>',
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
