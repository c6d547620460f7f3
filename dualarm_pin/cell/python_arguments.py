"""What a cell file would hold, from the arguments of `Cell.from_urdf`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import pinocchio as pin
from pydantic import ValidationError

from dualarm_pin.cell.parts import ARMS
from dualarm_pin.errors import InputError
from dualarm_pin.files.cell_spec import CellSpec


def spec_from_python(
    urdf1: str | Path,
    urdf2: str | Path | None,
    base1: pin.SE3 | None,
    base2: pin.SE3 | None,
    tips: tuple[str, str],
    tools: tuple[pin.SE3 | None, pin.SE3 | None],
    limits: Mapping[str, tuple[float, float]] | None,
    lock: Mapping[str, float] | None,
    free: Sequence[str],
    srdf: str | Path | tuple[str | Path | None, str | Path | None] | None,
    package_dirs: Sequence[str | Path],
) -> CellSpec:
    """Return the specification; the arguments are those of `Cell.from_urdf`.

    Raises:
        InputError: An argument is wrong.
    """
    arms: dict[str, dict[str, Any]] = {}
    for arm, tip, tool, base in zip(ARMS, tips, tools, (base1, base2), strict=True):
        arms[arm] = {"tip": tip}
        if tool is not None:
            arms[arm]["tool"] = _placement(tool)
        if base is not None:
            arms[arm]["base"] = _placement(base)
    whole: dict[str, Any] = {
        "arms": arms,
        "limits": {key: tuple(pair) for key, pair in (limits or {}).items()},
        "lock": dict(lock or {}),
        "free": list(free),
        "package_dirs": [str(entry) for entry in package_dirs],
    }
    twice = urdf2 is not None and str(urdf1) == str(urdf2)
    srdfs = srdf if isinstance(srdf, tuple) else (srdf, srdf if twice else None)
    if urdf2 is None:
        whole["urdf"] = str(urdf1)
        whole["srdf"] = None if srdfs[0] is None else str(srdfs[0])
    else:
        for arm, urdf, file in zip(ARMS, (urdf1, urdf2), srdfs, strict=True):
            arms[arm]["urdf"] = str(urdf)
            arms[arm]["srdf"] = None if file is None else str(file)
    try:
        return CellSpec.model_validate(whole)
    except ValidationError as error:
        first = error.errors()[0]
        message = first["msg"].removeprefix("Value error, ")
        raise InputError(message, field=".".join(map(str, first["loc"]))) from error


def _placement(pose: pin.SE3) -> dict[str, Any]:
    return {
        "xyz": tuple(map(float, pose.translation)),
        "rotation": tuple(tuple(map(float, row)) for row in pose.rotation),
    }
