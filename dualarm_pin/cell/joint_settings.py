"""What a cell file asks of joints, found by name and turned into SI units."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

from dualarm_pin.cell.chains import Chains
from dualarm_pin.cell.parts import ARMS
from dualarm_pin.errors import InputError, UnknownNameError, nearest
from dualarm_pin.files.cell_spec import CellSpec, JointSettings
from dualarm_pin.robot.robot import UrdfJoint

Blame = Callable[[str, Sequence[str]], InputError]
"""Makes an error from a message and the keys of the cell file at fault."""
_DEG = math.pi / 180.0
# word: key of the cell file to its unit in rad or m
_WORDS = {
    "limits": {"limits": 1.0, "limits_deg": _DEG},
    "velocity": {"velocity": 1.0, "velocity_deg": _DEG},
    "acceleration": {"acceleration": 1.0, "acceleration_deg_s2": _DEG},
    "jerk": {"jerk": 1.0, "jerk_deg_s3": _DEG},
    "torque": {"torque": 1.0},
    "lock": {"lock": 1.0, "lock_deg": _DEG},
}


@dataclass
class RobotSettings:
    """Settings of the joints of one URDF, in SI units, by plain joint name.

    Attributes:
        chains: The URDF.
        blame: Makes an error of the cell file.
        limits: Lower and upper [rad or m].
        velocity: Largest speed [rad/s or m/s].
        acceleration: Largest acceleration [rad/s^2 or m/s^2].
        jerk: Largest jerk [rad/s^3 or m/s^3].
        torque: Largest torque or force [N m or N].
        lock: Value at which to lock [rad or m].
        place: Where in the cell file each (word, joint) stands.
    """

    chains: Chains
    blame: Blame
    limits: dict[str, tuple[float, float]] = field(default_factory=dict)
    velocity: dict[str, float] = field(default_factory=dict)
    acceleration: dict[str, float] = field(default_factory=dict)
    jerk: dict[str, float] = field(default_factory=dict)
    torque: dict[str, float] = field(default_factory=dict)
    lock: dict[str, float] = field(default_factory=dict)
    place: dict[tuple[str, str], tuple[str, ...]] = field(default_factory=dict)

    def error(self, message: str, word: str, joint: str) -> InputError:
        """Return an error where the file says `word` of a joint."""
        return self.blame(message, self.place[word, joint])

    def take(
        self, joint: UrdfJoint, word: str, value: float | tuple[float, float], place: Sequence[str]
    ) -> None:
        """Keep a value of the file, which stands at `place` = (..., key, joint)."""
        *level, key, _ = place
        owner, name = self.chains.joint_owner[joint.name], joint.name
        if level and owner not in ("common", level[-1]):
            raise self.blame(f"joint {name!r} belongs to {owner}: say this there", place)
        unit = _WORDS[word][key]
        if unit != 1.0 and joint.kind == "prismatic":
            raise self.blame(f"joint {name!r} is prismatic: give metres under `{word}`", place)
        earlier = self.place.get((word, name), ())
        if earlier and earlier[:-2] == tuple(level) and earlier != place:
            raise self.blame(f"`{earlier[-2]}` says this already: give one of them", place)
        self.place[word, name] = tuple(place)
        getattr(self, word)[name] = (
            tuple(unit * x for x in value) if isinstance(value, tuple) else unit * value
        )


def settings_of(
    robots: Mapping[str, Chains], spec: CellSpec, blame: Blame
) -> dict[str, RobotSettings]:
    """Return the settings for each URDF of the cell: `arm1` and `arm2`, or `both`.

    Raises:
        InputError: A joint does not exist, is fixed, or is given degrees though it is prismatic.
    """
    found = {name: RobotSettings(chains, blame) for name, chains in robots.items()}
    levels: list[tuple[tuple[str, ...], JointSettings, tuple[str, ...]]]
    levels = [((), spec, ("both", *ARMS))]
    levels += [(("arms", arm), getattr(spec.arms, arm), ("both", arm)) for arm in ARMS]
    for keys, level, whose in levels:
        within = {robot: chains for robot, chains in robots.items() if robot in whose}
        for word, units in _WORDS.items():
            for key in units:
                for name, value in getattr(level, key).items():
                    place = (*keys, key, name)
                    for robot, joint in find_joints(within, name, place, blame):
                        found[robot].take(joint, word, value, place)
    return found


def find_joints(
    robots: Mapping[str, Chains], name: str, place: Sequence[str], blame: Blame
) -> list[tuple[str, UrdfJoint]]:
    """Return every joint of the cell that `name` may mean: plain, or `arm1/<name>`.

    Raises:
        UnknownNameError: There is none.
    """
    joints = [
        (key, joint, chains.joint_owner[joint.name])
        for key, chains in robots.items()
        for joint in chains.robot.joints.values()
    ]
    found = [(key, joint) for key, joint, _ in joints if joint.name == name]
    found = found or [(key, joint) for key, joint, who in joints if f"{who}/{joint.name}" == name]
    if not found:
        known = dict.fromkeys(joint.name for _, joint, _ in joints if joint.moves)
        error = blame(f"no joint {name!r}: {nearest(name, known)}", place)
        raise UnknownNameError(error.message, file=error.file, line=error.line, field=error.field)
    for _, joint in found:
        if not joint.moves:
            raise blame(f"joint {name!r} is {joint.kind}: it takes no value", place)
    return found
