"""From the `path:` section of a task file to a `Path`."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin

from dualarm_pin.errors import InputError
from dualarm_pin.files.call import ModuleAndFunction, OwnFunction
from dualarm_pin.files.signature import ArgumentsSpec, spec_of
from dualarm_pin.files.source import Key, Source, check
from dualarm_pin.path.path import Path
from dualarm_pin.path.paths import GENERATORS
from dualarm_pin.path.spec import HoldSpec, PathSpec


class _HoldAndCall(HoldSpec, ArgumentsSpec):
    """What stands among the arguments of a generator of the user's own."""

    beside = (*HoldSpec.model_fields, "call")

    call: ModuleAndFunction


def load_path(
    spec: PathSpec, source: Source, own: OwnFunction | None = None, *, place: str = "path"
) -> Path:
    """Return the path that a task file asks for.

    Args:
        spec: The checked section.
        source: The file: where relative names of files start.
        own: The generator of the user's own that the section calls, if it calls one.
        place: Where the section stands in the file.

    Raises:
        InputError: The geometry or a file is wrong. The message names the field of the task file,
            such as path.corner.fillet, or the file of points and its line.
    """
    hold = _hold(spec)
    if own is not None:  # its keys are checked like those of ours
        given = check(source, spec_of(own.function, _HoldAndCall), [place])
        return own.result(Path, **given.arguments, **hold)
    arguments = spec.given.arguments
    if "file" in arguments:
        arguments["file"] = source.path.parent / arguments["file"]
    try:
        return GENERATORS[spec.kind](**arguments, **hold)
    except InputError as error:
        if error.file is not None:
            raise
        keys: list[Key] = [place]
        if error.field in HoldSpec.model_fields:
            keys.append(error.field)
        else:
            keys.append(spec.kind)
            degrees = f"{error.field}_deg"
            known = type(spec.given).model_fields
            keys += [degrees if degrees in known else error.field] if error.field else []
        located = source.error(error.message, keys)
        raise type(error)(
            error.message, file=located.file, line=located.line, field=located.field
        ) from error


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
        how["frame"] = spec.frame.pose
    return how
