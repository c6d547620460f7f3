"""What a cell file would hold, from what Python gives."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pinocchio as pin
from pydantic import ValidationError

from dualarm_pin.errors import InputError
from dualarm_pin.files.cell_spec import CellSpec


def checked_spec(whole: dict[str, Any]) -> CellSpec:
    """Return the specification that plain data stand for.

    Raises:
        InputError: Something in it is wrong; the first mistake, with its field.
    """
    try:
        return CellSpec.model_validate(whole)
    except ValidationError as error:
        first = error.errors()[0]
        message = first["msg"].removeprefix("Value error, ")
        raise InputError(message, field=".".join(map(str, first["loc"]))) from error


def file_name(file: str | Path | None) -> str | None:
    """Return a file as a cell file names it."""
    return None if file is None else str(file)


def thing(given: Mapping[str, Any]) -> dict[str, Any]:
    """Return an object as a cell file states it."""
    at = given.get("at")
    plain = {key: str(value) if isinstance(value, Path) else value for key, value in given.items()}
    return plain | ({"at": placement(at)} if isinstance(at, pin.SE3) else {})


def placement(pose: pin.SE3 | None) -> dict[str, Any]:
    """Return a pose as a cell file states it, identity where there is none."""
    pose = pin.SE3.Identity() if pose is None else pose
    return {"xyz": pose.translation.tolist(), "rotation": pose.rotation.tolist()}
