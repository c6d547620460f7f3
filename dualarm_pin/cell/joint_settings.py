"""What a cell file asks of joints, found by name and turned into SI units."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

from dualarm_pin.cell.chains import Chains
from dualarm_pin.errors import InputError, UnknownNameError, nearest
from dualarm_pin.files.cell_spec import CellSpec, JointSettings
from dualarm_pin.robot.robot import UrdfJoint

Blame = Callable[[str, Sequence[str]], InputError]
_DEG = math.pi / 180.0
# word: key of the cell file to its unit in rad or m
_WORDS = {
    "limits": {"limits": 1.0, "limits_deg": _DEG},
    "velocity": {"velocity": 1.0, "velocity_deg": _DEG},
    "acceleration": {"acceleration": 1.0, "acceleration_deg_s2": _DEG},
    "lock": {"lock": 1.0, "lock_deg": _DEG},
}


@dataclass
class Settings:
    """Settings of the joints of one URDF, in SI units, by plain joint name.

    Attributes:
        bounds: Lower and upper [rad or m].
        velocity: Largest speed [rad/s or m/s].
        acceleration: Largest acceleration [rad/s^2 or m/s^2].
        lock: Value at which to lock [rad or m].
        place: Where in the cell file each (word, joint) stands.
    """

    bounds: dict[str, tuple[float, float]] = field(default_factory=dict)
    velocity: dict[str, float] = field(default_factory=dict)
    acceleration: dict[str, float] = field(default_factory=dict)
    lock: dict[str, float] = field(default_factory=dict)
    place: dict[tuple[str, str], tuple[str, ...]] = field(default_factory=dict)


def settings_of(robots: Mapping[str, Chains], spec: CellSpec, blame: Blame) -> dict[str, Settings]:
    """Return the settings for each robot.

    Args:
        robots: The URDFs of the cell: `arm1` and `arm2`, or `both`.
        spec: The cell file.
        blame: Makes an error from a message and the keys at fault.

    Raises:
        InputError: A joint does not exist, is fixed, or is given degrees though it is prismatic.
    """
    found = {name: Settings() for name in robots}
    levels: list[tuple[tuple[str, ...], JointSettings, dict[str, Chains]]] = [
        ((), spec, dict(robots)),
        (("arms", "arm1"), spec.arms.arm1, _of(robots, "arm1")),
        (("arms", "arm2"), spec.arms.arm2, _of(robots, "arm2")),
    ]
    for keys, level, within in levels:
        for word, units in _WORDS.items():
            for key, unit in units.items():
                for name, value in getattr(level, key).items():
                    place = (*keys, key, name)
                    for robot, joint in find_joints(within, name, place, blame):
                        _refuse_stranger(robots[robot], joint, keys, place, blame)
                        si = _si(value, joint, word, unit, place, blame)
                        _store(found[robot], word, joint.name, si, place, blame)
    return found


def _of(robots: Mapping[str, Chains], arm: str) -> dict[str, Chains]:
    return {key: chains for key, chains in robots.items() if key in (arm, "both")}


def _refuse_stranger(
    chains: Chains, joint: UrdfJoint, keys: Sequence[str], place: Sequence[str], blame: Blame
) -> None:
    owner = chains.joint_owner[joint.name]
    if keys and owner not in ("common", keys[-1]):
        raise blame(f"joint {joint.name!r} belongs to {owner}: say this there", place)


def find_joints(
    robots: Mapping[str, Chains], name: str, place: Sequence[str], blame: Blame
) -> list[tuple[str, UrdfJoint]]:
    """Return every joint of the cell that `name` may mean: plain, or `arm1/<name>`.

    Raises:
        UnknownNameError: There is none.
    """
    found = [
        (key, chains.robot.joints[name])
        for key, chains in robots.items()
        if name in chains.robot.joints
    ]
    owner, _, rest = name.partition("/")
    if not found:
        found = [
            (key, chains.robot.joints[rest])
            for key, chains in robots.items()
            if chains.joint_owner.get(rest) == owner
        ]
    if not found:
        known = [
            joint.name
            for chains in robots.values()
            for joint in chains.robot.joints.values()
            if joint.moves
        ]
        error = blame(f"no joint {name!r}: {nearest(name, dict.fromkeys(known))}", place)
        raise UnknownNameError(error.message, file=error.file, line=error.line, field=error.field)
    for _, joint in found:
        if not joint.moves:
            raise blame(f"joint {name!r} is {joint.kind}: it takes no value", place)
    return found


def _si(
    value: float | tuple[float, float],
    joint: UrdfJoint,
    word: str,
    unit: float,
    place: Sequence[str],
    blame: Blame,
) -> tuple[float, ...]:
    if unit != 1.0 and joint.kind == "prismatic":
        raise blame(f"joint {joint.name!r} is prismatic: give metres under `{word}`", place)
    values = value if isinstance(value, tuple) else (value,)
    return tuple(number * unit for number in values)


def _store(
    settings: Settings,
    word: str,
    joint: str,
    si: tuple[float, ...],
    place: tuple[str, ...],
    blame: Blame,
) -> None:
    earlier = settings.place.get((word, joint), ())
    if earlier[:-2] == place[:-2] and earlier != place and earlier:
        raise blame(f"`{earlier[-2]}` says this already: give one of them", place)
    settings.place[word, joint] = place
    if word == "limits":
        settings.bounds[joint] = (si[0], si[1])
    else:
        getattr(settings, word)[joint] = si[0]
