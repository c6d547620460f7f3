"""The parts that a cell is described by: joints, arms, clearance, files it was read from."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Literal, NamedTuple

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from dualarm_pin.arrays import Array

Pair = tuple[str, str]  # the names of two bodies
Owner = Literal["arm1", "arm2", "common"]
ARMS: tuple[Literal["arm1"], Literal["arm2"]] = ("arm1", "arm2")

MOTION_KEYS = {
    "velocity": "velocity_deg",
    "acceleration": "acceleration_deg_s2",
    "jerk": "jerk_deg_s3",
    "effort": "torque",
}
"""Limits of motion of a `Joint` to the keys of the cell file that state them."""


@dataclass(frozen=True)
class Joint:
    """One column of q.

    Attributes:
        name: `arm1/<name>`, `arm2/<name>` or `common/<name>`, the name as in the URDF.
        arm: Whose joint it is; `common` moves both arms (a torso).
        kind: `revolute` [rad] or `prismatic` [m].
        continuous: Turns without end; `lower` and `upper` are then where starts are drawn.
        lower: Lower bound [rad or m].
        upper: Upper bound [rad or m].
        velocity: Largest speed [rad/s or m/s], or None where it is not known.
        acceleration: Largest acceleration [rad/s^2 or m/s^2], or None where it is not known.
        effort: Largest torque or force [N m or N], or None where it is not known.
        jerk: Largest jerk [rad/s^3 or m/s^3], or None where it is not known.
    """

    name: str
    arm: Owner
    kind: Literal["revolute", "prismatic"]
    continuous: bool
    lower: float
    upper: float
    velocity: float | None
    acceleration: float | None
    effort: float | None
    jerk: float | None = None


@dataclass(frozen=True, eq=False)
class Controller:
    """Axes of the controller of one arm with k joints: (1 + coupling) (signs * q + offsets).

    Attributes:
        signs: 1 or -1 (k,).
        offsets: (k,) [rad or m].
        coupling: (k, k), row i holds what the other axes add to axis i; None for the one that the
            controller is known to have.
        prefix: Before the names of the joints in files for ROS; None for the usual one.
    """

    signs: Array
    offsets: Array
    coupling: Array | None
    prefix: str | None


@dataclass(frozen=True)
class Arm:
    """One arm: a chain of joints from its base to its tool frame.

    Attributes:
        name: `arm1` or `arm2`.
        file: The URDF, or None for a frame that stands still without a robot.
        root: Root link of that URDF.
        tip: Link that carries the tool.
        base: Pose of the root link in the world of the cell.
        tool: Pose of the tool frame in the tip link.
        joints: Names of its own joints, base to tip.
        controller: How its controller counts the axes.
    """

    name: str
    file: Path | None
    root: str
    tip: str
    base: pin.SE3
    tool: pin.SE3
    joints: tuple[str, ...]
    controller: Controller


class Clearance(NamedTuple):
    """Smallest distance between parts that must not touch.

    Attributes:
        distance: [m], negative in collision (then the depth of penetration).
        first: Link of the one part, `arm1/<link>`.
        second: Link of the other part.
    """

    distance: float
    first: str
    second: str


class SourceFile(NamedTuple):
    """A file the cell was read from, with its fingerprint."""

    path: Path
    sha256: str


def read_only(values: ArrayLike) -> Array:
    """Return a copy that cannot be written."""
    array = np.array(values, dtype=float)
    array.setflags(write=False)
    return array
