"""From the `path:` section of a task file to a `Path`."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path as FilePath
from typing import Any

import numpy as np
import pinocchio as pin

from dualarm_pin.arrays import rotations
from dualarm_pin.errors import InputError
from dualarm_pin.files.cell_spec import PlacementSpec
from dualarm_pin.files.path_spec import PathSpec
from dualarm_pin.files.source import Spec
from dualarm_pin.path import Path, generators
from dualarm_pin.path.files.apt import read_apt
from dualarm_pin.path.files.csv_file import read_csv
from dualarm_pin.path.files.gcode import read_gcode

_GENERATORS: dict[str, Callable[..., Path]] = {
    "corner": generators.corner,
    "polyline": generators.polyline,
    "circle": generators.circle,
    "arc": generators.arc,
    "helix": generators.helix,
    "raster": generators.raster,
    "sine": generators.sine,
    "figure_eight": generators.figure_eight,
    "dome_spiral": generators.dome_spiral,
    "tube_seam": generators.tube_seam,
    "spline": generators.spline,
}

_FILES: dict[str, Callable[..., Path]] = {"csv": read_csv, "gcode": read_gcode, "apt": read_apt}
_DEGREES = {angle: f"{angle}_deg" for angle in ("start", "stop", "inner", "outer", "tilt")}


def load_path(spec: PathSpec, folder: FilePath) -> Path:
    """Return the path that a task file asks for.

    Args:
        spec: The checked section.
        folder: Where relative file names start: the folder of the task file.

    Raises:
        InputError: The geometry or a file is wrong. The message names the field of the task file,
            such as path.corner.fillet, or the file of points and its line.
    """
    name = spec.generator
    section = getattr(spec, name)
    try:
        if name in _FILES:
            arguments = _arguments(section)
            file = folder / arguments.pop("file")
            return _FILES[name](file, **arguments, **_hold(spec))
        return _GENERATORS[name](**_arguments(section), **_hold(spec))
    except InputError as error:
        if error.file is not None:
            raise
        raise type(error)(error.message, field=_place(error.field, name)) from error


def _place(field: str | None, generator: str) -> str:
    """Return where a field stands in the task file."""
    if field in ("rotation", "orientation", "free", "spin_axis", "frame"):
        return f"path.{field}"
    return f"path.{generator}" + (f".{_DEGREES.get(field, field)}" if field else "")


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


def _frame(spec: PlacementSpec) -> pin.SE3:
    rotation = pin.rpy.rpyToMatrix(*(spec.rpy or (0.0, 0.0, 0.0)))
    if spec.rpy_deg is not None:
        rotation = pin.rpy.rpyToMatrix(*np.radians(spec.rpy_deg))
    if spec.rotation is not None:
        rotation = rotations(spec.rotation, (1, 3, 3))[0]
    return pin.SE3(rotation, np.array(spec.xyz))


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
