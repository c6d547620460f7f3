"""The files of a motion beside its result: `motion.csv`, `motion.npz`, `motion` in result.json.

Scripts rely on their keys and columns. result.json is written last.
"""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import TypeAdapter, ValidationError
from pydantic_core import from_json, to_json

from dualarm_pin.answer.folder import load_trajectory
from dualarm_pin.arrays import Array
from dualarm_pin.errors import InputError, MissingFileError
from dualarm_pin.files.npz import npz_bytes, read_npz
from dualarm_pin.files.write import write_files
from dualarm_pin.motion.summary import Law, MotionSummary

_AXES = {"time": 1, "arc_length": 1, "q": 2, "velocity": 2, "acceleration": 2}
_LAW: TypeAdapter[Law] = TypeAdapter(Law)


def write_motion(
    folder: Path, joints: tuple[str, ...], arrays: Mapping[str, Array], content: dict[str, Any]
) -> None:
    """Write a motion into the folder of its result; each file appears whole or not at all.

    Args:
        folder: A result folder.
        joints: Names of the columns.
        arrays: `time`, `arc_length`, `q`, `velocity`, `acceleration` and, if known, `torque`.
        content: What `motion` of result.json shall hold.

    Raises:
        MissingFileError: The folder holds no result.
        InputError: The result has other joints, or the folder cannot be written.
    """
    if load_trajectory(folder).joints != joints:
        raise InputError("the motion has other joints than this result", file=folder)
    result = _result(folder)
    result["motion"] = from_json(to_json(content, inf_nan_mode="null"))
    files = {
        "motion.csv": _csv(joints, arrays).encode(),
        "motion.npz": npz_bytes(arrays, joints),
        "result.json": (json.dumps(result, indent=1) + "\n").encode(),
    }
    write_files(folder, files)


def read_motion(folder: Path) -> tuple[Law, tuple[str, ...], dict[str, Array], MotionSummary]:
    """Read law, joints, arrays and summary of the motion of a result folder.

    Raises:
        MissingFileError: It holds no result, or no motion was made of it.
        InputError: Its files are damaged.
    """
    trajectory, content = load_trajectory(folder), _result(folder).get("motion")
    file = folder / "result.json"
    if not isinstance(content, dict):
        message = "it has no motion: make one with `dualarm-pin motion`"
        raise MissingFileError(message, file=file)
    try:
        law = _LAW.validate_python(content.get("law"))
        # A reader takes longer to make than to use, and few read a motion.
        summary = TypeAdapter(MotionSummary).validate_json(json.dumps(content), strict=True)
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        field = ".".join(map(str, ("motion", *first["loc"])))
        raise InputError(f"not a motion: {first['msg']}", file=file, field=field) from error
    axes = _AXES | ({"torque": 2} if content.get("has_torque") else {})
    arrays = read_npz(folder / "motion.npz", axes, what="a motion")
    return law, trajectory.joints, arrays, summary


def has_motion(folder: Path) -> bool:
    """Tell whether a result folder holds a motion.

    Raises:
        MissingFileError: It holds no result.
        InputError: Its result is damaged.
    """
    load_trajectory(folder)
    return isinstance(_result(folder).get("motion"), dict)


def _result(folder: Path) -> dict[str, Any]:
    text = (folder / "result.json").read_text(encoding="utf-8")
    content: dict[str, Any] = json.loads(text)
    return content


def _csv(joints: tuple[str, ...], arrays: Mapping[str, Array]) -> str:
    further = [kind for kind in ("velocity", "acceleration", "torque") if kind in arrays]
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    names = ["time", "arc_length", *joints]
    writer.writerow(names + [f"{kind} {joint}" for kind in further for joint in joints])
    columns = [arrays[name] for name in ("time", "arc_length", "q", *further)]
    writer.writerows(np.column_stack(columns).tolist())
    return text.getvalue()
