"""From the `path:` section of a task file to a `Path`."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin

from dualarm_pin.arrays import rotations
from dualarm_pin.errors import InputError
from dualarm_pin.files.call import ModuleAndFunction, own_function
from dualarm_pin.files.cell_spec import PlacementSpec
from dualarm_pin.files.signature import ArgumentsSpec, spec_of
from dualarm_pin.files.source import Key, Source, check
from dualarm_pin.path.path import Path
from dualarm_pin.path.paths import GENERATORS
from dualarm_pin.path.spec import HoldSpec, PathSpec


class _HoldAndCall(HoldSpec, ArgumentsSpec):
    """What stands among the arguments of a generator of the user's own."""

    beside = (*HoldSpec.model_fields, "call")

    call: ModuleAndFunction


def load_path(spec: PathSpec, source: Source, keys: tuple[Key, ...] = ("path",)) -> Path:
    """Return the path that a task file asks for.

    Args:
        spec: The checked section.
        source: The file: where relative names of files start; allowed to run code if it calls any.
        keys: Where the section stands in it.

    Raises:
        InputError: The geometry or a file is wrong. The message names the field of the task file,
            such as path.corner.fillet, or the file of points and its line.
    """
    name = spec.generator
    if name == "call":
        return _own_path(spec, source, keys)
    section = getattr(spec, name)
    arguments = section.arguments
    if "file" in arguments:
        arguments["file"] = source.path.parent / arguments["file"]
    try:
        return GENERATORS[name](**arguments, **_hold(spec))
    except InputError as error:
        if error.file is not None:
            raise
        raise _placed(error, source, keys, name, type(section).model_fields) from error


def _own_path(spec: HoldSpec, source: Source, keys: tuple[Key, ...]) -> Path:
    """Return the path of a generator of the user's own, its keys checked like those of ours."""
    own = own_function(source, keys, {})
    given = check(source, spec_of(own.function, _HoldAndCall), keys)
    return own.result(Path, **given.arguments, **_hold(spec))


def _placed(
    error: InputError, source: Source, keys: tuple[Key, ...], name: str, known: Any
) -> InputError:
    """Return the error of a generator as one of the field of the task file."""
    place: list[Key] = [*keys]
    if error.field in HoldSpec.model_fields:
        place.append(str(error.field))
    else:
        place.append(name)
        if error.field:
            degrees = f"{error.field}_deg"
            place.append(degrees if degrees in known else error.field)
    located = source.error(error.message, place)
    return type(error)(error.message, file=located.file, line=located.line, field=located.field)


def _hold(spec: HoldSpec) -> dict[str, Any]:
    """Return how the tool is held, as far as the file says so."""
    how: dict[str, Any] = {
        key: getattr(spec, key)
        for key in ("rotation", "orientation", "free", "spin_axis")
        if key in spec.model_fields_set and getattr(spec, key) is not None
    }
    if spec.rpy_deg is not None:
        how["rotation"] = pin.rpy.rpyToMatrix(*np.radians(spec.rpy_deg))
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
