"""From a result with a motion to the program of a controller, checked before it is written."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path

from dualarm_pin import __version__
from dualarm_pin.errors import InputError
from dualarm_pin.exports.check import error_of
from dualarm_pin.exports.choose_points import choose_points
from dualarm_pin.exports.convention import Convention, arm_columns, convention_of, ros_names
from dualarm_pin.exports.exported import Exported
from dualarm_pin.exports.format import Chord, Format
from dualarm_pin.exports.formats import SCENE, format_of
from dualarm_pin.exports.motion_path import MotionPath
from dualarm_pin.exports.names import comment
from dualarm_pin.exports.program import Points, Program
from dualarm_pin.exports.result_motion import ResultMotion

# How much of the tolerance the choice of points uses, again with less where the check of the whole
# program finds more than the choice saw.
_SHARES = (0.8, 0.4, 0.2)
_HOPELESS = 3.0  # times the tolerance: more points do not help that


def export(
    result: str | Path,
    to: str | Format,
    out: str | Path,
    *,
    name: str | None = None,
    mm: float | None = None,
    deg: float | None = None,
    point: int | None = None,
    allow_code: bool = False,
) -> Exported:
    """Write the motion of a result as a program for a controller, or as a scene (`glb`).

    The text is read back and run through the kinematics first; nothing is written if it leaves the
    relative path of the motion by more than the tolerance. Of a scene the bodies are compared with
    where Pinocchio puts them.

    Args:
        result: A result folder with a motion.
        to: Name of a format, or one of the user's own.
        out: Folder of the program; empty, or with an earlier program of the same names.
        name: Name of the program; that of the result folder by default.
        mm: Largest distance from the relative path [mm]; that of the format by default.
        deg: Largest angle [deg].
        point: A point of the path, from 1: a scene that stands still there, not the motion.
        allow_code: Import and run what the task names with `call`.

    Raises:
        MissingFileError: There is no result, or it has no motion.
        UnknownNameError: There is no such format.
        InputError: The result is not found, its joints do not fit the format, there is no such
            point, or the folder holds something else.
        MissingExtraError: A scene needs trimesh, which is not installed.
        DualArmError: What was written cannot be read back.
    """
    called = name or Path(result).resolve().name
    if to == SCENE:
        from dualarm_pin.exports.glb.make import USUAL, export_scene

        allowed = _tolerance(USUAL, mm, deg)
        where = Path(result), Path(out)
        return export_scene(
            *where, name=called, tolerance=allowed, point=point, allow_code=allow_code
        )
    target = format_of(to)
    if point is not None:
        raise InputError(
            f"a posture goes to {SCENE} alone; {target.name} is a motion", field="point"
        )
    tolerance = _tolerance(target.tolerance, mm, deg)
    source = ResultMotion.load(Path(result), allow_code=allow_code)
    cell, motion = source.task.cell, source.motion
    convention = convention_of(cell, target)
    path = MotionPath(cell, motion.q, source.task.path, motion.arc_length, tolerance)
    for share in _SHARES:
        chosen = choose_points(motion, path, target, share)
        program = _program(source, target, tolerance, convention, chosen, called)
        texts = target.write(program)
        exported = Exported(
            format=target.name,
            texts=texts,
            sha256=source.sha256,
            points=len(chosen),
            samples=len(motion.time),
            duration=float(program.time[-1]),
            error=error_of(texts, program, target, convention, path),
            tolerance=tolerance,
            motion_error=Chord(motion.summary.path_error_mm, motion.summary.path_error_deg),
            cautions=source.cautions,
            draft=target.draft,
        )
        if exported.passed:
            exported.write(Path(out))
        if exported.passed or exported.use > _HOPELESS:
            break
    return exported


def _tolerance(usual: Chord, mm: float | None, deg: float | None) -> Chord:
    for field, value in (("mm", mm), ("deg", deg)):
        if value is not None and not (math.isfinite(value) and value > 0.0):
            raise InputError(f"a number above 0 is expected; given {value}", field=field)
    return Chord(usual.mm if mm is None else mm, usual.deg if deg is None else deg)


def _program(
    source: ResultMotion,
    target: Format,
    tolerance: Chord,
    convention: Convention,
    chosen: Points,
    name: str,
) -> Program:
    cell = source.task.cell
    values = convention.values(chosen.values)
    points = Points(values, chosen.time, chosen.velocity, chosen.acceleration)
    head = _head(source, target, tolerance, points, name)
    return Program(
        name=name,
        comment=tuple(part for line in head for part in comment(line)),
        joints=cell.joint_names,
        ros_joints=ros_names(cell),
        arms=arm_columns(cell),
        points=points,
    )


def _head(
    source: ResultMotion, target: Format, tolerance: Chord, points: Points, name: str
) -> Iterator[str]:
    cell = source.task.cell
    yield f"dualarm_pin {__version__}, {target.name}: {name}"
    yield f"cell {cell.name}"
    yield f"result sha256 {source.sha256}"
    yield f"{len(points)} points in {points.duration:.3f} s"
    blending = ", blending at points aside" if target.between == "linear" else ""
    yield f"within {tolerance.as_text()} of the relative path{blending}"
    for arm, part in arm_columns(cell).items():
        yield f"{arm}: {', '.join(joint.partition('/')[2] for joint in cell.joint_names[part])}"
    yield from (f"CAUTION: {caution}" for caution in source.cautions)
    yield from (f"DRAFT: {note}" for note in target.draft)
