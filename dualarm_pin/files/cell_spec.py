"""What a cell file may hold: two arms, where they stand, their tools and their bounds."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self, get_args

import numpy as np
import pinocchio as pin
from pydantic import AfterValidator, Field, WithJsonSchema, model_validator

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
_LIMITS = {  # JSON schema: bounds by joint, and beside them what motion allows
    "type": "object",
    "properties": {
        key: {"type": "object", "additionalProperties": {"type": "number", "exclusiveMinimum": 0}}
        for key in MOTION_LIMITS
    },
    "additionalProperties": {
        "type": "array",
        "items": {"type": "number"},
        "minItems": 2,
        "maxItems": 2,
    },
}


class PlacementSpec(Spec):
    """A pose: a position, and at most one of three ways to give a rotation.

    Attributes:
        xyz: Position [m], such as `[1.3, 0, 0]`.
        rpy: Roll, pitch and yaw about the fixed axes [rad], such as `[0, 0, 3.14159]`.
        rpy_deg: Roll, pitch and yaw about the fixed axes [deg], such as `[0, 0, 180]`.
        rotation: Rotation matrix as three rows, such as `[[0, -1, 0], [1, 0, 0], [0, 0, 1]]`.
    """

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

    Attributes:
        limits: Lower and upper bound by joint [rad or m], such as `{slide: [0, 0.2]}`.
        limits_deg: Lower and upper bound by revolute joint [deg], such as `{joint_1: [-60, 60]}`.
        velocity: Largest speed by joint [rad/s or m/s], such as `{joint_1: 2.0}`.
        velocity_deg: Largest speed by revolute joint [deg/s], such as `{joint_1: 120}`.
        acceleration: Largest acceleration by joint [rad/s^2 or m/s^2], such as `{joint_1: 8.0}`.
        acceleration_deg_s2: Largest acceleration by revolute joint [deg/s^2], such as
            `{joint_1: 400}`.
        jerk: Largest jerk by joint [rad/s^3 or m/s^3], such as `{joint_1: 80.0}`.
        jerk_deg_s3: Largest jerk by revolute joint [deg/s^3], such as `{joint_1: 4000}`.
        torque: Largest torque or force by joint [N m or N], such as `{joint_1: 300}`.
        lock: Value of joints that stand still [rad or m], such as `{head_pan: 0.0}`.
        lock_deg: Value of revolute joints that stand still [deg], such as `{head_pan: 30}`.
    """

    limits: Annotated[dict[str, Bounds], WithJsonSchema(_LIMITS)] = Field(default_factory=dict)
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


class ControllerSpec(Spec):
    """How the controller of an arm counts its axes, by joint name of the URDF.

    axis = sign * joint + offset, and then factor * axis of every joint that is coupled to it.

    Attributes:
        signs: 1 or -1, such as `{joint_2: -1}`; 1 where nothing is said.
        offsets_deg: Offsets of revolute joints [deg], such as `{joint_3: 90}`; 0 where nothing is
            said.
        coupling: Joint to other joints and factors, such as `{joint_3: {joint_2: -1}}`; that of
            the controller where nothing is said, which couples the third axis of a FANUC.
        prefix: Before the names of the joints in files for ROS, such as `left_`; that of the arm
            where both come from one URDF, else nothing.
    """

    signs: dict[str, Literal[-1, 1]] = Field(default_factory=dict)
    offsets_deg: dict[str, Number] = Field(default_factory=dict)
    coupling: dict[str, dict[str, Number]] | None = None
    prefix: str | None = None


class ArmSpec(JointSettings):
    """One arm. Without a URDF here or above it is a frame that stands still at `base`.

    Attributes:
        urdf: URDF or xacro file of this arm alone, such as `robot.urdf`.
        srdf: SRDF of that file: pairs that need no collision check, groups, such as `robot.srdf`.
        xacro: Arguments of the xacro file, such as `{reach: 0.5}`.
        tip: Link that carries the tool, such as `tool0`.
        group: A group of the SRDF instead of a tip: the tip is the end of its chain, such as
            `manipulator`.
        base: Pose of the root link in the cell.
        tool: Pose of the tool frame (TCP) in the tip link.
        tool_axis: Direction of the tool in the tool frame, for reports and pictures.
        controller: How its controller counts the axes, for programs, such as
            `{signs: {joint_2: -1}}`.
    """

    urdf: str | None = None
    srdf: str | None = None
    xacro: dict[str, str | bool | float] = Field(default_factory=dict)
    tip: str | None = None
    group: str | None = None
    base: PlacementSpec | None = None
    tool: PlacementSpec = PlacementSpec()
    tool_axis: Direction = (0.0, 0.0, 1.0)
    controller: ControllerSpec = ControllerSpec()


class ArmsSpec(Spec):
    """The two arms; the path is followed by arm2 as seen from arm1.

    Attributes:
        arm1: The arm in whose tool frame e1 the path is drawn.
        arm2: The arm whose tool frame e2 follows it.
    """

    arm1: ArmSpec
    arm2: ArmSpec


class RoundSpec(Spec):
    """A cylinder or capsule along z about its middle.

    Attributes:
        radius: Radius [m], such as `0.03`.
        length: Length [m], that of a capsule without its ends, such as `0.2`.
    """

    radius: Positive
    length: Positive


class ObjectSpec(Spec):
    """Something that stands in the cell or is carried: exactly one shape, in metres.

    Attributes:
        box: Lengths of its edges along x, y and z, such as `[0.6, 1.2, 0.05]`.
        sphere: Radius, such as `0.1`.
        cylinder: Radius and length, such as `{radius: 0.03, length: 0.2}`.
        capsule: Radius and length, such as `{radius: 0.03, length: 0.2}`.
        mesh: A file, such as `part.stl`.
        scale: Factor of a mesh: 0.001 for a file in millimetres, such as `0.001`.
        on: What carries it: `world`, the tool frame of an arm, `arm1`, or a link, such as
            `arm1/link_3`.
        at: Pose of its middle, or of the mesh, in that frame, such as `{xyz: [1.25, 0, 0.2]}`.
        allow: Bodies that it may touch, such as `[arm1/link_6]`.
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
        name: Name of the cell, such as `two arms`; that of the file if not given.
        urdf: One URDF or xacro file that holds both arms, such as `both.urdf`.
        srdf: Its SRDF, such as `both.srdf`.
        xacro: Arguments of the xacro file, such as `{reach: 0.5}`.
        arms: The two arms.
        free: Common joints (a torso) that the planner may move, such as `[torso_lift]`; all others
            are locked.
        package_dirs: Further folders to search for packages and meshes, such as `[./meshes]`.
        objects: What stands in the cell or is carried, by name, such as
            `{table: {box: [0.6, 1.2, 0.05], at: {xyz: [1.25, 0, 0.225]}}}`.
    """

    name: str | None = None
    urdf: str | None = None
    srdf: str | None = None
    xacro: dict[str, str | bool | float] = Field(default_factory=dict)
    arms: ArmsSpec
    free: list[str] = Field(default_factory=list)
    package_dirs: list[str] = Field(default_factory=list)
    objects: dict[str, ObjectSpec] = Field(default_factory=dict)
