"""A URDF as plain records: what remains of the file once every value has been checked."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Literal

from dualarm_pin.errors import InputError

Triple = tuple[float, float, float]
MOVING = ("revolute", "continuous", "prismatic")
MOMENTS = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
KINDS = ("fixed", *MOVING, "floating", "planar")


@dataclass(frozen=True)
class Shape:
    """One `<visual>` or `<collision>`.

    Attributes:
        kind: What it is.
        size: Box edges; cylinder and capsule radius and length; sphere radius; mesh scale [m].
        file: The mesh as the URDF names it, empty for a primitive.
        xyz: Position in the link [m].
        rpy: Roll, pitch and yaw in the link [rad].
        colour: Red, green, blue, alpha, or None.
        line: Line in the URDF.
    """

    kind: Literal["mesh", "box", "cylinder", "sphere", "capsule"]
    size: tuple[float, ...]
    file: str
    xyz: Triple
    rpy: Triple
    colour: tuple[float, ...] | None
    line: int


@dataclass(frozen=True)
class Inertial:
    """Mass [kg], pose of the centre of mass, and inertia, the `MOMENTS` [kg m^2]."""

    mass: float
    xyz: Triple
    rpy: Triple
    inertia: tuple[float, ...]


@dataclass(frozen=True)
class Link:
    """A rigid body."""

    name: str
    line: int
    inertial: Inertial | None
    visuals: tuple[Shape, ...]
    collisions: tuple[Shape, ...]
    unknown: tuple[str, ...]


@dataclass(frozen=True)
class Mimic:
    """value = multiplier * value of `joint` + offset."""

    joint: str
    multiplier: float
    offset: float


@dataclass(frozen=True)
class UrdfJoint:
    """A joint as the URDF states it.

    Attributes:
        name: As written.
        kind: One of `KINDS`.
        parent: Parent link.
        child: Child link.
        xyz: Origin in the parent link [m].
        rpy: Roll, pitch and yaw of the origin [rad].
        axis: Unit axis in the joint frame.
        lower: Lower bound [rad or m], or None where the URDF gives none.
        upper: Upper bound [rad or m], or None.
        velocity: Largest speed [rad/s or m/s], or None where it is missing or 0.
        effort: Largest torque or force [N m or N], or None where it is missing or 0.
        mimic: The joint it follows, or None.
        line: Line in the URDF.
    """

    name: str
    kind: str
    parent: str
    child: str
    xyz: Triple
    rpy: Triple
    axis: Triple
    lower: float | None
    upper: float | None
    velocity: float | None
    effort: float | None
    mimic: Mimic | None
    line: int

    @property
    def moves(self) -> bool:
        """Whether it has one degree of freedom."""
        return self.kind in MOVING

    def error(self, message: str, file: Path) -> InputError:
        """Return an error at this joint of `file`."""
        return InputError(message, file=file, line=self.line, field=f"joint {self.name!r}")


@dataclass(frozen=True)
class Robot:
    """A checked URDF: a tree of links.

    Attributes:
        name: Name of the robot.
        file: Where it was read from.
        root: The one link without a parent.
        links: By name.
        joints: By name, in file order.
        warnings: What is odd, though legal.
    """

    name: str
    file: Path
    root: str
    links: Mapping[str, Link]
    joints: Mapping[str, UrdfJoint]
    warnings: tuple[str, ...]

    @cached_property
    def above(self) -> Mapping[str, UrdfJoint]:
        """The joint above each link but the root."""
        return {joint.child: joint for joint in self.joints.values()}

    def chain(self, link: str) -> list[UrdfJoint]:
        """Return the joints from the root down to `link`, fixed ones included."""
        joints = []
        while link in self.above:
            joints.append(self.above[link])
            link = joints[-1].parent
        return joints[::-1]

    def leaves(self) -> list[str]:
        """Return the links that carry no other link: where tips usually are."""
        parents = {joint.parent for joint in self.joints.values()}
        return [name for name in self.links if name not in parents]
