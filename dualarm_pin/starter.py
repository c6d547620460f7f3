"""A cell and a task to start from: two URDFs face to face, and a small circle that they reach."""

from __future__ import annotations

import math
import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pinocchio as pin
from pydantic import BaseModel

from dualarm_pin.arrays import Array
from dualarm_pin.cell import Cell
from dualarm_pin.cell.describe import describe
from dualarm_pin.cell.read_robots import Loader
from dualarm_pin.errors import InputError
from dualarm_pin.files.cell_spec import ArmSpec, ArmsSpec, CellSpec
from dualarm_pin.files.documented import documented
from dualarm_pin.files.resources import urdf_folder
from dualarm_pin.files.write import write_files
from dualarm_pin.path import Path as RelativePath
from dualarm_pin.path.generators.follow import Free
from dualarm_pin.path.paths import circle
from dualarm_pin.planners.unreachable import feasible_postures
from dualarm_pin.relative import Relative
from dualarm_pin.robot.packages import find_file
from dualarm_pin.robot.robot import Robot
from dualarm_pin.search.starts import generator
from dualarm_pin.task import Task

# Words in the names of links that carry a tool, the surest first.
_TIPS = ("tcp", "tool0", "tool", "flange", "tip", "ee", "hand", "gripper")
_FINGERS = ("finger", "knuckle", "thumb", "jaw", "pad")
_HANDS = ("gripper", "hand")  # what moves behind such a link is a finger, whatever its name
_APART = 0.6  # of the reach of both arms: they meet in the middle with the elbows bent
_RADIUS = 0.03  # of the mean reach: a small circle, so that most arms follow it
_POINTS = 25  # of the circle
_NEAR = 0.5  # of the mean reach: the tools are no farther apart, since one holds the part
_DRAWN = 1500  # random postures among which the best place of the circle is looked for
_CLEAR = 0.005  # m; a wrist always sits close to its own forearm
_TRIED = 12  # places that are checked at every third point
_TRIES = 30  # random postures from which a point is looked for


@dataclass(frozen=True)
class Starter:
    """What was understood, and the content of the files.

    Attributes:
        cell: The two arms.
        files: Content by name: `cell.yaml` and `task.yaml`.
        reached: Whether points all along the circle are reached.
    """

    cell: Cell
    files: dict[str, bytes]
    reached: bool

    def write(self, folder: Path) -> list[Path]:
        """Write the files into a folder and return them.

        Raises:
            InputError: It holds such files already, or cannot be written.
        """
        for name in self.files:
            if (folder / name).exists():
                raise InputError(
                    "this file is there already: name another folder", file=folder / name
                )
        write_files(folder, self.files)
        return [folder / name for name in self.files]


def start_from(urdfs: Sequence[str], folder: Path) -> Starter:
    """Make a cell and a task of two URDFs.

    Args:
        urdfs: URDF or xacro file of each arm; one does for both.
        folder: Where the files will stand: their names of URDFs start there.

    Raises:
        MissingFileError: There is no such file.
        InputError: A robot cannot be used.
    """
    first, second = (*urdfs, *urdfs)[:2]
    tips = likely_tip(_robot(first)), likely_tip(_robot(second))
    near = Cell.from_urdf(_found(first), _found(second), tips=tips)
    reach = [arm.reach or 1.0 for arm in describe(near).arms]
    apart = round(_APART * sum(reach), 2)
    turned = pin.rpy.rpyToMatrix(0.0, 0.0, math.pi)
    cell = near.moved(base2=pin.SE3(turned, np.array([apart, 0.0, 0.0])))
    radius = round(_RADIUS * sum(reach) / 2.0, 3)
    free: Free = "spin" if cell.n > 6 else "rotation"  # 5 or 3 of the 6 components are asked for
    place, reached = _reached_place(cell, radius, free)
    names = [_from(folder, _found(urdf)) for urdf in (first, second)]
    files = {
        "cell.yaml": _cell_text(names, tips, apart),
        "task.yaml": _task_text(radius, free, place),
    }
    return Starter(cell, {name: text.encode() for name, text in files.items()}, reached)


def likely_tip(robot: Robot) -> str:
    """Return the link that most likely carries the tool.

    Of the links behind the most joints it is the one whose name says so, else the first of them;
    fingers, what moves behind a hand, and what they carry do not count.

    Raises:
        InputError: No joint moves.
    """

    def finger(link: str) -> bool:
        chain = robot.chain(link)
        names = [link, *(joint.child for joint in chain)]
        hands = [joint.parent.lower() for joint in chain if joint.moves]
        return any(word in name.lower() for name in names for word in _FINGERS) or any(
            word in name for name in hands for word in _HANDS
        )

    moving = {link: sum(joint.moves for joint in robot.chain(link)) for link in robot.links}
    links = [link for link in robot.links if not finger(link)]
    if not any(moving[link] for link in links):
        links = list(robot.links)
    most = max(moving[link] for link in links)
    if not most:
        raise InputError("no joint of this robot moves: it is no arm", file=robot.file)

    def rank(link: str) -> tuple[int, int]:
        named = [k for k, word in enumerate(_TIPS) if word in link.lower().replace("-", "_")]
        return min(named, default=len(_TIPS)), len(robot.chain(link))

    return min((link for link in links if moving[link] == most), key=rank)


def _robot(urdf: str) -> Robot:
    spec = CellSpec(arms=ArmsSpec(arm1=ArmSpec(), arm2=ArmSpec()))
    robot, _ = Loader.of_python(spec, "new").read(ArmSpec(urdf=str(_found(urdf))))
    return robot


def _found(urdf: str) -> Path:
    return find_file(urdf, Path.cwd()).resolve()


def _from(folder: Path, file: Path) -> str:
    """Return the name of a file as seen from the folder, whole where they have little in common."""
    folder = folder.resolve()
    shared = os.path.commonpath([folder, file])
    return os.path.relpath(file, folder) if len(Path(shared).parts) > 2 else str(file)


def _reached_place(cell: Cell, radius: float, free: Free) -> tuple[pin.SE3, bool]:
    """Return a pose in e1 for the frame of the circle, and whether the circle is reached there."""
    best = pin.SE3.Identity()
    for number, place in enumerate(_places(cell, radius)):
        task = Task(cell, _circle(radius, free, place))
        problem, random = task.problem(), generator(0, 30)
        points = range(0, _POINTS, 3)
        if all(feasible_postures(problem, i, 1, random, _TRIES)[0] for i in points):
            return place, True
        best = place if number == 0 else best
    return best, False


def _circle(radius: float, free: Free, place: pin.SE3) -> RelativePath:
    return circle(radius, height=0.0, points=_POINTS, rotation=np.eye(3), free=free, frame=place)


def _places(cell: Cell, radius: float) -> Iterator[pin.SE3]:
    """Yield poses of the frame of the circle, the most agile posture of the arms first."""
    random = generator(0, 31)
    scored: list[tuple[float, int, Array]] = []
    for number in range(_DRAWN):
        # Far from the bounds, so that the circle does not run into them.
        q = cell.lower + (cell.upper - cell.lower) * random.uniform(0.2, 0.8, cell.n)
        relative = Relative(cell, q)
        if np.linalg.norm(relative.T_e1_e2.translation) > radius * _NEAR / _RADIUS:
            continue
        clearance = cell.clearance(q)
        if clearance is None or clearance.distance > _CLEAR:
            agile = float(np.linalg.svd(relative.J_r, compute_uv=False)[-1])
            facing = 0.5 - 0.5 * float(relative.T_e1_e2.rotation[2, 2])  # of the axes of the tools
            scored.append((-agile * facing, number, q))
    for _, _, q in sorted(scored, key=lambda each: each[:2])[:_TRIED]:
        at = Relative(cell, q).T_e1_e2 * pin.SE3(np.eye(3), np.array([-radius, 0.0, 0.0]))
        angles = np.round(np.degrees(pin.rpy.matrixToRpy(at.rotation)), 2)  # as it is written
        yield pin.SE3(pin.rpy.rpyToMatrix(*np.radians(angles)), np.round(at.translation, 4))


def _schema(kind: str) -> str:
    return f"# yaml-language-server: $schema={urdf_folder() / 'schema'}/{kind}.schema.json\n"


def _spare(model: type[BaseModel], names: Sequence[str], indent: str = "") -> str:
    """Return keys that may be given, as comments with what is said about them."""
    said = documented(model)
    return "".join(
        f"{indent}# {name}: {_flow(said[name].example)}   # {said[name].text}\n" for name in names
    )


def _flow(value: object) -> str:
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key}: {_flow(each)}" for key, each in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(_flow, value)) + "]"
    return str(value).lower() if isinstance(value, bool) else str(value)


def _quoted(text: str) -> str:
    return "'" + text.replace("'", "''") + "'"


def _cell_text(names: Sequence[str], tips: Sequence[str], apart: float) -> str:
    spare = _spare(ArmSpec, ("tool", "limits_deg", "srdf"), "    ")
    return (
        f"{_schema('cell')}# `dualarm-pin explain cell` says what may stand here.\n"
        "arms:\n"
        f"  arm1:\n    urdf: {_quoted(names[0])}\n    tip: {_quoted(tips[0])}\n{spare}"
        f"  arm2:\n    urdf: {_quoted(names[1])}\n    tip: {_quoted(tips[1])}\n"
        f"    base: {{xyz: [{apart:g}, 0, 0], rpy_deg: [0, 0, 180]}}   # of its root link\n{spare}"
        + _spare(CellSpec, ("package_dirs", "lock"))
    )


def _task_text(radius: float, free: str, place: pin.SE3) -> str:
    xyz = _flow([float(x) for x in np.round(place.translation, 4)])
    rpy = _flow([float(x) for x in np.round(np.degrees(pin.rpy.matrixToRpy(place.rotation)), 2)])
    return (
        f"{_schema('task')}# `dualarm-pin explain task` says what may stand here.\n"
        "cell: cell.yaml\n"
        "path:\n"
        f"  circle: {{radius: {radius:g}, height: 0, points: {_POINTS}}}"
        "   # or corner, polyline, csv, gcode...\n"
        "  rotation: [[1, 0, 0], [0, 1, 0], [0, 0, 1]]\n"
        f"  free: {free}   # none, spin about the tool, or rotation\n"
        "  # Where the circle lies, as seen from the tool of arm1:\n"
        f"  frame: {{xyz: {xyz}, rpy_deg: {rpy}}}\n"
        "index: {force: {direction: tangent}}   # what is minimised\n"
        "smoothness: 3.0   # how much smooth motion counts against it\n"
        "# constraints: [{above: {frame: arm1/tip, z: 0.1}}]\n"
        "# clearance: 0.02   # [m]\n"
    )
