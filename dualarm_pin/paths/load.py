"""From the `path:` section of a task file to a `Path`."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from pathlib import Path as FilePath
from typing import Any

import numpy as np
import pinocchio as pin

from dualarm_pin.errors import InputError
from dualarm_pin.files.path_spec import FrameSpec, PathSpec
from dualarm_pin.files.source import Key, Source, Spec
from dualarm_pin.path import Path
from dualarm_pin.paths import planar, polyline, spatial, surface

_GENERATORS: dict[str, Callable[..., Path]] = {
    "corner": planar.corner,
    "polyline": polyline.polyline,
    "circle": planar.circle,
    "arc": planar.arc_path,
    "helix": spatial.helix,
    "raster": planar.raster,
    "sine": planar.sine,
    "figure_eight": planar.figure_eight,
    "dome_spiral": surface.dome_spiral,
    "tube_seam": surface.tube_seam,
    "spline": spatial.spline,
}

_DEGREES = {angle: f"{angle}_deg" for angle in ("start", "stop", "inner", "outer", "tilt")}


def load_path(
    spec: PathSpec, folder: FilePath, source: Source | None = None, keys: Sequence[Key] = ("path",)
) -> Path:
    """Return the path that a task file asks for.

    Args:
        spec: The checked section.
        folder: Where relative file names start: the folder of the task file.
        source: The task file, so that messages name its lines.
        keys: Where in that file the section stands.

    Raises:
        InputError: The geometry or a file is wrong; names file, line and field.
    """
    name = spec.generator
    try:
        return _make(name, getattr(spec, name), _hold(spec), folder)
    except InputError as error:
        if error.file is not None:
            raise
        raise _placed(error, source, keys, name) from error


def _make(name: str, section: Any, how: dict[str, Any], folder: FilePath) -> Path:
    return _GENERATORS[name](**_arguments(section), **how)


def _hold(spec: PathSpec) -> dict[str, Any]:
    how: dict[str, Any] = {"free": spec.free, "spin_axis": spec.spin_axis}
    if spec.rotation is not None:
        how["rotation"] = spec.rotation
    if spec.rpy_deg is not None:
        how["rotation"] = pin.rpy.rpyToMatrix(*np.radians(spec.rpy_deg))
    if spec.orientation is not None:
        how["orientation"] = spec.orientation
    if spec.frame is not None:
        how["frame"] = _frame(spec.frame)
    return how


def _frame(spec: FrameSpec) -> pin.SE3:
    return pin.SE3(pin.rpy.rpyToMatrix(*np.radians(spec.rpy_deg)), np.array(spec.xyz))


def _arguments(section: Spec) -> dict[str, Any]:
    """Return the keys of a section as arguments: `x_deg` [deg] becomes `x` [rad]."""
    given: dict[str, Any] = {}
    for key in sorted(section.model_fields_set):
        value = getattr(section, key)
        if key.endswith("_deg"):
            given[key.removesuffix("_deg")] = math.radians(value)
        else:
            given[key] = value
    return given


def _placed(
    error: InputError, source: Source | None, keys: Sequence[Key], generator: str
) -> InputError:
    """Return the error with the place in the task file at which its field stands."""
    field = error.field or ""
    where: list[Key] = [*keys, generator]
    if field in ("rotation", "orientation", "free", "spin_axis", "frame"):
        where = [*keys, field]
    elif field:
        where.append(_DEGREES.get(field, field))
    if source is None:
        return type(error)(error.message, field=".".join(str(key) for key in where))
    placed = source.error(error.message, where)
    return type(error)(placed.message, file=placed.file, line=placed.line, field=placed.field)
