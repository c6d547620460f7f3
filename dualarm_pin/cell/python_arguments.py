"""The ways into a cell: a cell file, a specification, or URDFs named in Python."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import pinocchio as pin
from pydantic import ValidationError

from dualarm_pin.cell.assemble import build
from dualarm_pin.cell.cell import Cell, Pair
from dualarm_pin.cell.parts import ARMS
from dualarm_pin.cell.read_robots import Loader
from dualarm_pin.errors import InputError
from dualarm_pin.files.cell_spec import CellSpec
from dualarm_pin.files.source import Key, Source, check, read_yaml


def load_cell(file: Path) -> Cell:
    """Load a cell file; see `Cell.load`."""
    return cell_from_source(read_yaml(file))


def cell_from_source(source: Source, keys: Sequence[Key] = ()) -> Cell:
    """Build the cell that stands in a file that was read.

    Args:
        source: A cell file, or a task file with the cell inside.
        keys: Where in the file the cell stands.

    Raises:
        InputError: As for `Cell.load`.
    """
    spec = check(source, CellSpec, keys)

    def blame(message: str, where: Sequence[Key]) -> InputError:
        return source.error(message, [*keys, *where])

    loader = Loader(spec, source.path.resolve().parent, blame)
    loader.note(source.path.resolve(), source.path.read_bytes())
    return build(loader, spec.name or source.path.stem)


def build_cell(spec: CellSpec, folder: Path, name: str = "cell") -> Cell:
    """Build a cell from a specification.

    Args:
        spec: What a cell file would hold.
        folder: Where its relative paths start.
        name: Name of the cell if the specification has none.

    Raises:
        InputError: As for `Cell.load`.
    """

    def blame(message: str, keys: Sequence[str]) -> InputError:
        return InputError(message, field=".".join(map(str, keys)) or None)

    return build(Loader(spec, folder, blame), spec.name or name)


def cell_from_urdf(
    urdf1: str | Path,
    urdf2: str | Path | None,
    base1: pin.SE3 | None,
    base2: pin.SE3 | None,
    tips: tuple[str, str],
    tools: tuple[pin.SE3 | None, pin.SE3 | None],
    limits: Mapping[str, Pair] | None,
    lock: Mapping[str, float] | None,
    free: Sequence[str],
    srdf: str | Path | tuple[str | Path | None, str | Path | None] | None,
    package_dirs: Sequence[str | Path],
    name: str | None,
) -> Cell:
    """Build a cell from Python; see `Cell.from_urdf`."""
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
        spec = CellSpec.model_validate(whole)
    except ValidationError as error:
        first = error.errors()[0]
        message = first["msg"].removeprefix("Value error, ")
        raise InputError(message, field=".".join(map(str, first["loc"]))) from error
    return build_cell(spec, Path.cwd(), name or Path(urdf1).stem)


def _placement(pose: pin.SE3) -> dict[str, Any]:
    return {
        "xyz": tuple(map(float, pose.translation)),
        "rotation": tuple(tuple(map(float, row)) for row in pose.rotation),
    }
