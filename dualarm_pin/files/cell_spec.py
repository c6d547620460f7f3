"""What a cell file may hold: two arms, where they stand, their tools and their bounds."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self, get_args

import numpy as np
import pinocchio as pin
from pydantic import AfterValidator, Field, model_validator

from dualarm_pin.arrays import rotations
from dualarm_pin.files.numbers import Number, Positive, Vector
from dualarm_pin.files.source import Spec

ShapeKind = Literal["box", "sphere", "cylinder", "capsule", "mesh"]
SHAPES: tuple[ShapeKind, ...] = get_args(ShapeKind)


def _ascending(pair: tuple[float, float]) -> tuple[float, float]:
    if not pair[0] < pair[1]:
        raise ValueError(f"lower bound {pair[0]:g} is not below upper bound {pair[1]:g}")
    return pair


def _unit(vector: Vector) -> Vector:
    if sum(x * x for x in vector) < 1e-12:
        raise ValueError("a direction must not be zero")
    return vector


Bounds = Annotated[tuple[Number, Number], AfterValidator(_ascending)]
Direction = Annotated[Vector, AfterValidator(_unit)]


MOTION_LIMITS = {
    "velocity_deg_s": "velocity_deg",
    "acceleration_deg_s2": "acceleration_deg_s2",
    "jerk_deg_s3": "jerk_deg_s3",
    "torque": "torque",
}
"""Keys inside `limits` to the keys beside it that say the same."""


class PlacementSpec(Spec):
    """A pose: `xyz` [m] and at most one of `rpy` [rad], `rpy_deg`, `rotation` (three rows)."""

    xyz: Vector = (0.0, 0.0, 0.0)
    rpy: Vector | None = None
    rpy_deg: Vector | None = None
    rotation: tuple[Vector, Vector, Vector] | None = None

    @model_validator(mode="after")
    def _one_rotation(self) -> Self:
        given = [k for k in ("rpy", "rpy_deg", "rotation") if getattr(self, k) is not None]
        if len(given) > 1:
            raise ValueError(f"{' and '.join(given)} say the same thing: give one of them")
        if self.rotation is not None:
            rotations(self.rotation, (1, 3, 3))
        return self

    @property
    def pose(self) -> pin.SE3:
        """The pose, its rotation moved to the nearest exact one."""
        rpy = np.deg2rad(self.rpy_deg) if self.rpy_deg else self.rpy or (0.0, 0.0, 0.0)
        rotation = pin.rpy.rpyToMatrix(*map(float, rpy))
        if self.rotation is not None:
            rotation = rotations(self.rotation, (1, 3, 3))[0]
        return pin.SE3(rotation, np.array(self.xyz))


class JointSettings(Spec):
    """What may be said about joints, by name: bounds, what motion allows, values at which to lock.

    Degrees are for revolute joints only; without `_deg` the unit is rad or m, and seconds. What
    motion allows may also stand inside `limits`: {velocity_deg_s, acceleration_deg_s2,
    jerk_deg_s3, torque}, each by joint.
    """

    limits: dict[str, Bounds] = Field(default_factory=dict)
    limits_deg: dict[str, Bounds] = Field(default_factory=dict)
    velocity: dict[str, Positive] = Field(default_factory=dict)
    velocity_deg: dict[str, Positive] = Field(default_factory=dict)
    acceleration: dict[str, Positive] = Field(default_factory=dict)
    acceleration_deg_s2: dict[str, Positive] = Field(default_factory=dict)
    jerk: dict[str, Positive] = Field(default_factory=dict)
    jerk_deg_s3: dict[str, Positive] = Field(default_factory=dict)
    torque: dict[str, Positive] = Field(default_factory=dict)
    lock: dict[str, Number] = Field(default_factory=dict)
    lock_deg: dict[str, Number] = Field(default_factory=dict)

    @model_validator(mode="before")
    @classmethod
    def _all_in_limits(cls, data: Any) -> Any:
        """Read what motion allows where it stands inside `limits`."""
        limits = data.get("limits") if isinstance(data, dict) else None
        inside = MOTION_LIMITS.keys() & limits.keys() if isinstance(limits, dict) else set()
        if not isinstance(limits, dict) or not inside:
            return data
        data = {**data, "limits": {k: v for k, v in limits.items() if k not in inside}}
        for key in sorted(inside):
            if MOTION_LIMITS[key] in data:
                raise ValueError(f"`{key}` in `limits` and `{MOTION_LIMITS[key]}`: give one")
            data[MOTION_LIMITS[key]] = limits[key]
        return data


class ArmSpec(JointSettings):
    """One arm. Without a URDF here or above it is a frame that stands still at `base`.

    Attributes:
        urdf: URDF or xacro file of this arm alone.
        srdf: SRDF of that file: pairs that need no collision check, groups.
        xacro: Arguments of the xacro file.
        tip: Link that carries the tool.
        group: A group of the SRDF instead of a tip: the tip is the end of its chain.
        base: Pose of the root link in the cell.
        tool: Pose of the tool frame (TCP) in the tip link.
        tool_axis: Direction of the tool in the tool frame, for reports and pictures.
    """

    urdf: str | None = None
    srdf: str | None = None
    xacro: dict[str, str | bool | float] = Field(default_factory=dict)
    tip: str | None = None
    group: str | None = None
    base: PlacementSpec | None = None
    tool: PlacementSpec = PlacementSpec()
    tool_axis: Direction = (0.0, 0.0, 1.0)


class ArmsSpec(Spec):
    """The two arms; the path is followed by arm2 as seen from arm1."""

    arm1: ArmSpec
    arm2: ArmSpec


class RoundSpec(Spec):
    """A cylinder or capsule along z about its middle; the length of a capsule is without ends."""

    radius: Positive
    length: Positive


class ObjectSpec(Spec):
    """Something that stands in the cell or is carried: exactly one shape, in metres.

    Attributes:
        box: Lengths of its edges along x, y and z.
        sphere: Radius.
        cylinder: Radius and length.
        capsule: Radius and length.
        mesh: A file.
        scale: Factor of a mesh: 0.001 for a file in millimetres.
        on: What carries it: `world`, the tool frame of an arm, `arm1`, or a link, `arm1/<link>`.
        at: Pose of its middle, or of the mesh, in that frame.
        allow: Bodies that it may touch.
    """

    box: tuple[Positive, Positive, Positive] | None = None
    sphere: Positive | None = None
    cylinder: RoundSpec | None = None
    capsule: RoundSpec | None = None
    mesh: str | None = None
    scale: Positive = 1.0
    on: str = "world"
    at: PlacementSpec = PlacementSpec()
    allow: list[str] = Field(default_factory=list)

    @model_validator(mode="after")
    def _one_shape(self) -> Self:
        given = [kind for kind in SHAPES if getattr(self, kind) is not None]
        if len(given) != 1:
            shown = ", ".join(given) or "none"
            raise ValueError(f"exactly one shape is expected: {', '.join(SHAPES)}; given {shown}")
        if "scale" in self.model_fields_set and self.mesh is None:
            raise ValueError("`scale` belongs to a mesh")
        return self

    @property
    def kind(self) -> ShapeKind:
        """Which shape it is."""
        return next(kind for kind in SHAPES if getattr(self, kind) is not None)


class CellSpec(JointSettings):
    """A whole cell file.

    Attributes:
        name: Name of the cell; that of the file if not given.
        urdf: One URDF or xacro file that holds both arms.
        srdf: Its SRDF.
        xacro: Arguments of the xacro file.
        arms: The two arms.
        free: Common joints (a torso) that the planner may move; all others are locked.
        package_dirs: Further folders to search for packages and meshes.
        objects: What stands in the cell or is carried, by name.
    """

    name: str | None = None
    urdf: str | None = None
    srdf: str | None = None
    xacro: dict[str, str | bool | float] = Field(default_factory=dict)
    arms: ArmsSpec
    free: list[str] = Field(default_factory=list)
    package_dirs: list[str] = Field(default_factory=list)
    objects: dict[str, ObjectSpec] = Field(default_factory=dict)
