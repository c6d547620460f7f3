"""From a task file to what a `Task` is made of."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path as FilePath
from typing import Any

import numpy as np

from dualarm_pin.arrays import Array
from dualarm_pin.cell import Cell
from dualarm_pin.cell.known_limits import known_limits
from dualarm_pin.clearance.spec import load_clearance
from dualarm_pin.errors import InputError
from dualarm_pin.files.call import own_functions
from dualarm_pin.files.read_task import read_task
from dualarm_pin.files.source import Source, check
from dualarm_pin.indices.spec import IndexSpec, load_index
from dualarm_pin.path import Path
from dualarm_pin.path.gamma import choose_Gamma
from dualarm_pin.path.load import load_path
from dualarm_pin.placement.spec import load_placement
from dualarm_pin.rows.spec import load_rows
from dualarm_pin.task.posture_spec import load_posture
from dualarm_pin.task.record import task_record
from dualarm_pin.task.spec import SmoothnessSpec, TaskSpec


def parts_of_task(
    file: str | FilePath, overrides: Sequence[str] = (), *, allow_code: bool = False
) -> tuple[Source, dict[str, Any]]:
    """Read a task file.

    Args:
        file: A YAML file.
        overrides: `key=value` changes with dotted keys.
        allow_code: Import and run the functions that the file names with `call`.

    Returns:
        The file, and the arguments of `Task` by name.

    Raises:
        InputError: As `Task.load`.
    """
    source, cell_source, keys = read_task(file, overrides)
    spec = check(source, TaskSpec)
    own = own_functions(source, spec.calls, allow_code=allow_code)
    cell = Cell.from_source(cell_source, keys)
    record = task_record(source, cell_source, keys, own.values())
    with source.blamed():
        path = load_path(spec.path, source, own.get(("path",)))
        index = load_index(spec.index, own.get(("index",)))
        if spec.index.kind == "torque" and index.joint_weights is None:
            index = replace(index, joint_weights=known_limits(cell.joints, "effort") ** -2.0)
        row_functions = [own.get(("constraints", i)) for i in range(len(spec.constraints))]
        rows = load_rows(spec.constraints, row_functions, cell, path.h)
        smooth = spec.smoothness
        if not isinstance(smooth, SmoothnessSpec):
            smooth = SmoothnessSpec(weight=smooth)
        parts = {
            "cell": cell,
            "path": _directed(path, spec.index),
            "index": index,
            "smoothness": smooth.weight,
            "stage_1_smoothness": spec.two_stage.smoothness,
            "metric": _metric(smooth, cell),
            "per_arc_length": smooth.per_arc_length,
            "rows": rows,
            "clearance": load_clearance(spec.clearance, cell),
            "motion": spec.motion,
            "aim": spec.aim,
            "placement": load_placement(spec.placement, cell),
            "name": source.path.stem,
            "record": record,
            "source": source,
            "Gamma": _Gamma(spec.two_stage.Gamma, path),
        }
        for key, given in (("from_posture", spec.from_posture), ("to_posture", spec.to_posture)):
            try:
                folder, last = source.path.parent, key == "from_posture"
                parts[key] = posture = load_posture(given, cell, folder, last=last)
            except InputError as error:
                if error.file is not None:
                    raise
                field = ".".join(filter(None, (key, error.field)))
                raise type(error)(error.message, field=field) from error
            if posture is not None:
                record[key] = posture.tolist()  # the same even where that result is gone
        for key, named in (("method", spec.method), ("solver", spec.solver)):
            function = own.get((key,))
            parts[key] = named if function is None else function.instance()
    return source, parts


def _Gamma(given: Sequence[int] | int | None, path: Path) -> tuple[int, ...]:
    """Return the points of the first stage from 0, of those that the file counts from 1."""
    if given is None or isinstance(given, int):
        return choose_Gamma(path, min(given or 6, path.h))
    return tuple(point - 1 for point in given)


def _directed(path: Path, spec: IndexSpec) -> Path:
    """Return the path with the direction that the index asks for; `path` leaves its own.

    They differ where a file of points brings directions of its own.
    """
    given = spec.direction
    if given == "path":
        return path
    if given == "tangent":
        return path.with_direction(np.hstack([path.tangent, np.zeros((path.h, 3))]))
    u = np.zeros(6)
    u[: len(given)] = given
    length = float(np.linalg.norm(u))
    if length == 0.0:
        field = ".".join(("index", *spec.place, "direction"))
        raise InputError("the direction is zero", field=field)
    return path.with_direction(u / length)


def _metric(smooth: SmoothnessSpec, cell: Cell) -> Array:
    """Return the diagonal of the link metric (n,): 1/limit^2 where speed counts."""
    if isinstance(smooth.metric, list):
        return np.array(smooth.metric, dtype=float)
    if smooth.metric == "equal":
        return np.ones(cell.n)
    limits = known_limits(cell.joints, "velocity", "; or give the metric as a list of weights")
    return np.asarray((np.mean(limits) / limits) ** 2)
