"""From a result to a GLB file that was read back and compared with Pinocchio before it is kept."""

from __future__ import annotations

import importlib.util
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin

from dualarm_pin.answer.folder import load_result
from dualarm_pin.arrays import Array
from dualarm_pin.errors import InputError, MissingExtraError
from dualarm_pin.exports.choose_points import points_of
from dualarm_pin.exports.exported import Exported
from dualarm_pin.exports.format import Chord
from dualarm_pin.exports.glb.nodes import Nodes
from dualarm_pin.exports.interpolate import quintic_of
from dualarm_pin.exports.names import identifier
from dualarm_pin.exports.result_motion import ResultMotion, sha256_of
from dualarm_pin.motion.store import has_motion

# A picture: between samples 4 ms apart its joints are straight, those of a fast motion are not.
USUAL = Chord(0.5, 0.05)
_TIMES = 201  # at which nodes are compared, most of them between samples
_LONGEST = 40  # letters of the name


@dataclass(frozen=True)
class ExportedScene(Exported):
    """A GLB file and what was found when it was read back.

    Attributes:
        bodies: Number of its bodies.
        point: The point of the path at which they stand, from 1; None for a motion.
    """

    bodies: int = 0
    point: int | None = None

    def as_text(self) -> str:
        """Return what a user wants to know, in some lines."""
        how = f"{self.points} keys of {self.duration:.3f} s"
        if self.point is not None:
            how = f"they stand at point {self.point}"
        lines = [
            f"{self.format}: {self.bodies} bodies, {how}",
            f"read back: a body is {self.error.as_text()} from where Pinocchio puts it, "
            f"allowed are {self.tolerance.as_text()}",
        ]
        return "\n".join(lines + [f"CAUTION: {caution}" for caution in self.cautions])

    def as_dict(self) -> dict[str, Any]:
        """Return what `export.json` holds."""
        return super().as_dict() | {"bodies": self.bodies, "point": self.point}


def export_scene(
    result: Path, out: Path, *, name: str, tolerance: Chord, point: int | None, allow_code: bool
) -> ExportedScene:
    """Write the motion of a result, or its posture at a point, as a GLB file.

    Args:
        result: A result folder; with a motion if no point is named.
        out: Folder of the file.
        name: Name of the file.
        tolerance: How far a body may be from where Pinocchio puts it.
        point: A point of the path, from 1.
        allow_code: Import and run what the task names with `call`.

    Raises:
        MissingExtraError: trimesh is not installed.
        MissingFileError: There is no result.
        InputError: It has no motion or no such point, or the folder holds something else.
    """
    if importlib.util.find_spec("trimesh") is None:
        message = "a GLB file needs trimesh, which is not installed: pip install 'dualarm-pin[glb]'"
        raise MissingExtraError(message)
    from dualarm_pin.exports.glb.write import glb_bytes

    if point is None and not has_motion(result):
        message = (
            f"it has no motion: make one with `dualarm-pin motion {result}`, or give the point of "
            "the path at which the arms shall stand with --point"
        )
        raise InputError(message, file=result / "result.json")
    if point is None:
        source = ResultMotion.load(result, allow_code=allow_code)
        cell, motion, cautions = source.task.cell, source.motion, source.cautions
        q, time, at = motion.q, motion.time, quintic_of(points_of(motion))
        found = Chord(motion.summary.path_error_mm, motion.summary.path_error_deg)
    else:
        task, answer = load_result(result, allow_code=allow_code)
        if not 1 <= point <= len(answer.q):
            message = f"a point from 1 to {len(answer.q)} is expected; given {point}"
            raise InputError(message, field="point")
        cell, q, time = task.cell, answer.q[point - 1 : point], None
        cautions = () if answer.found else (f"this is no solution: {answer.message}",)
        found = Chord(1e3 * answer.max_position_error, float(np.rad2deg(answer.max_rotation_error)))
    nodes = Nodes.of(cell)
    data = glb_bytes(nodes, q, time)
    exported = ExportedScene(
        format="glb",
        texts={f"{identifier(name, _LONGEST)}.glb": data},
        sha256=sha256_of(result),
        points=len(q),
        samples=len(q),
        duration=0.0 if time is None else float(time[-1]),
        error=_error(nodes, data, (lambda _: q[0]) if time is None else at),
        tolerance=tolerance,
        motion_error=found,
        cautions=cautions,
        draft=(),
        bodies=sum(body.shape is not None for body in nodes.bodies),
        point=point,
    )
    if exported.passed:
        exported.write(out)
    return exported


def _error(nodes: Nodes, data: bytes, q_at: Callable[[float], Array]) -> Chord:
    """Return how far the nodes of a file are from where Pinocchio puts them [mm, deg]."""
    from dualarm_pin.exports.glb.read import ReadGlb

    read = ReadGlb.of(data)
    end = read.time[-1] if len(read.time) else 0.0
    worst = np.zeros(2)
    for time in np.linspace(0.0, end, _TIMES if end else 1):
        read.pose(time)
        joints = nodes.joint_poses(q_at(time))
        for body in nodes.bodies:
            off = (joints[body.joint] * body.placement).actInv(pin.SE3(read.node(body.name)))
            distance, turn = np.linalg.norm(off.translation), np.linalg.norm(pin.log3(off.rotation))
            worst = np.maximum(worst, [1e3 * distance, np.rad2deg(turn)])
    return Chord(*worst.tolist())
