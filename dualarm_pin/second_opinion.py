"""A second opinion on where the tips are: yourdfpy, an extra, reads the same URDF files."""

from __future__ import annotations

import io
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin

from dualarm_pin.arrays import Array
from dualarm_pin.cell import Cell
from dualarm_pin.cell.merged_urdf import merged_urdf
from dualarm_pin.cell.placed_robot import PlacedRobot
from dualarm_pin.errors import InputError, MissingExtraError

AGREE = 1e-9  # m, or entries of a rotation matrix: what rounding on a long chain leaves
_POSTURES = 100


@dataclass(frozen=True)
class Agreement:
    """How far two readings of the same files are apart.

    Attributes:
        postures: Random postures within the bounds.
        apart: Largest difference of a tip in any entry of its pose [m or 1], by the file as
            yourdfpy reads it, or `merged` for our own text of the whole cell.
    """

    postures: int
    apart: dict[str, float]

    @property
    def agrees(self) -> bool:
        """Whether all of them are the same within rounding."""
        return all(value <= AGREE for value in self.apart.values())

    def __str__(self) -> str:
        worst = max(self.apart.values())
        how = "agrees with" if self.agrees else "DIFFERS from"
        where = "" if self.agrees else f", worst in {max(self.apart, key=self.apart.__getitem__)}"
        return (
            f"yourdfpy {how} this reading of the cell: both tips within {worst:.1e} (m or 1) in "
            f"{self.postures} postures{where}"
        )


def compare(cell: Cell, seed: int = 0, postures: int = _POSTURES) -> Agreement:
    """Compare both tips of a cell with what yourdfpy makes of the same files, and of our text.

    It reads no xacro: of such a robot our text alone is compared.

    Raises:
        MissingExtraError: yourdfpy is not installed.
        InputError: yourdfpy cannot read a file that we could.
    """
    robots = cell._robots
    merged = _read(io.BytesIO(merged_urdf(robots, {}).encode()), robots[0].chains.robot.file)
    files = [placed.chains.robot.file for placed in robots]
    theirs = {file: _read(str(file), file) for file in files if file.suffix != ".xacro"}
    apart = dict.fromkeys([*map(str, theirs), "merged"], 0.0)
    data = cell.data()
    for q in np.random.default_rng(seed).uniform(cell.lower, cell.upper, (postures, cell.n)):
        model_q = cell.model_q(q)
        pin.framesForwardKinematics(cell.model, data, model_q)
        every = dict(zip(list(cell.model.names)[1:], map(float, model_q), strict=True))
        for number, arm in enumerate(cell.arms):
            placed = robots[number % len(robots)]
            file = placed.chains.robot.file
            frame = placed.frames[arm.tip]
            ours = data.oMf[cell.model.getFrameId(frame, pin.FrameType.BODY)].homogeneous
            poses = {"merged": _pose(merged, every, frame)}
            if file in theirs:
                own = _pose(theirs[file], _values(placed, every), arm.tip)
                poses[str(file)] = placed.base.homogeneous @ own
            for name, there in poses.items():
                apart[name] = max(apart[name], float(np.abs(there - ours).max()))
    return Agreement(postures, apart)


def _values(placed: PlacedRobot, every: dict[str, float]) -> dict[str, float]:
    """Return the value of each joint of a robot by its own name."""
    columns = {joint: every[placed.joint(joint)] for joint in placed.roles.columns}
    return {**placed.roles.values, **columns}


def _pose(robot: Any, values: dict[str, float], link: str) -> Array:
    """Return the pose (4, 4) of a link in the root link; yourdfpy moves mimic joints itself."""
    robot.update_cfg({name: values[name] for name in robot.actuated_joint_names})
    return np.asarray(robot.get_transform(link, robot.base_link))


def _read(source: Any, file: Path) -> Any:
    try:
        import yourdfpy
    except ImportError as error:
        raise MissingExtraError(
            "check --deep needs yourdfpy: pip install 'dualarm-pin[deep]'"
        ) from error
    try:
        return yourdfpy.URDF.load(
            source, load_meshes=False, build_scene_graph=True, load_collision_meshes=False
        )
    except Exception as error:  # it raises whatever its parsers do
        raise InputError(f"yourdfpy cannot read this file: {error}", file=file) from error
