"""Task: what is asked. A cell, a path, an index and a smoothness: what a task file holds."""

from __future__ import annotations

import io
import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path as FilePath
from typing import Any

import numpy as np
from numpy.typing import NDArray
from ruamel.yaml import YAML

from dualarm_pin import indices
from dualarm_pin.cell import Cell
from dualarm_pin.errors import InputError, ShapeError
from dualarm_pin.files.source import Key, Source, check, plain
from dualarm_pin.files.task_spec import IndexSpec, SmoothnessSpec, TaskSpec, read_task
from dualarm_pin.indices import Index
from dualarm_pin.path import Path
from dualarm_pin.path.gamma import choose_Gamma
from dualarm_pin.path.load import load_path
from dualarm_pin.problem import Problem
from dualarm_pin.rows import Row

Array = NDArray[np.float64]
LEAST_POINTS = 2
_PATH_FILES = ("csv", "gcode", "apt")


@dataclass(frozen=True, eq=False)
class Task:
    """What is asked.

    Attributes:
        cell: Two arms.
        path: Relative poses and directions.
        index: What is minimised at each point.
        smoothness: lambda of (eq. 19) and (eq. 20).
        stage_1_smoothness: lambda of the paper's first stage.
        Gamma: Points of the paper's first stage, from 0; the first and the last are among them.
        metric: How the joints count in a step, diagonal (n,).
        per_arc_length: lambda follows the arc length: lambda (mean ds / ds)^4 for each link.
        rows: What must hold at points of the path beside the pose.
        name: Name for tables.
        record: The content of a complete task file, if the task came from one.
    """

    cell: Cell
    path: Path
    index: Index = field(default_factory=indices.force)
    smoothness: float = 3.0
    stage_1_smoothness: float = 1.5
    Gamma: tuple[int, ...] = ()
    metric: Array | None = None
    per_arc_length: bool = False
    rows: tuple[Row, ...] = ()
    name: str = "task"
    record: Mapping[str, Any] | None = None

    def __post_init__(self) -> None:
        h, n = self.path.h, self.cell.n
        if h < LEAST_POINTS:
            raise InputError(
                f"{h} point is too few: a path has at least {LEAST_POINTS}", field="path"
            )
        if not np.all(np.linalg.norm(self.path.u, axis=1) > 0):
            point = int(np.argmin(np.linalg.norm(self.path.u, axis=1))) + 1
            raise InputError(f"point {point}: the direction u is zero", field="path")
        metric = np.ones(n) if self.metric is None else np.asarray(self.metric, float)
        if metric.shape != (n,):
            raise ShapeError(f"expected a weight for each of {n} joints", field="smoothness.metric")
        weights = self.index.joint_weights
        if weights is not None and np.shape(weights) != (n,):
            raise ShapeError(
                f"expected a weight for each of {n} joints, given {np.shape(weights)}",
                field="index.joint_weights",
            )
        object.__setattr__(self, "metric", metric)
        if not self.Gamma:
            object.__setattr__(self, "Gamma", choose_Gamma(self.path, min(6, h)))
        elif self.Gamma[0] != 0 or self.Gamma[-1] != h - 1 or not _increasing(self.Gamma):
            raise InputError(
                f"expected increasing points from 1 to {h}, both among them; "
                f"given {[point + 1 for point in self.Gamma]}",
                field="two_stage.Gamma",
            )

    @classmethod
    def load(cls, file: str | FilePath, overrides: Sequence[str] = ()) -> Task:
        """Load a task file.

        Args:
            file: A YAML file.
            overrides: `key=value` changes with dotted keys; see `files.task_spec.read_task`.

        Raises:
            InputError: The file, the cell or what they name is wrong.
        """
        source, cell_source, keys = read_task(file, overrides)
        spec = check(source, TaskSpec)
        cell = Cell.from_source(cell_source, keys)
        try:
            return cls._from_spec(spec, source, cell, _cell_record(cell_source, keys))
        except InputError as error:
            if error.file is not None or error.field is None:
                raise
            field = [int(k) if k.isdigit() else k for k in error.field.split(".")]
            raise source.error(error.message, field) from error

    @classmethod
    def _from_spec(
        cls, spec: TaskSpec, source: Source, cell: Cell, cell_record: Mapping[str, Any]
    ) -> Task:
        path = load_path(spec.path, source.path.parent)
        direction = _direction(spec.index, path)
        if direction is not None:
            path = path.with_direction(direction)
        smooth = spec.smoothness
        if not isinstance(smooth, SmoothnessSpec):
            smooth = SmoothnessSpec(weight=smooth)
        Gamma = spec.two_stage.Gamma
        if Gamma is None or isinstance(Gamma, int):
            points = choose_Gamma(path, min(Gamma or 6, path.h))
        else:
            points = tuple(point - 1 for point in Gamma)
        return cls(
            cell=cell,
            path=path,
            index=_index(spec.index),
            smoothness=smooth.weight,
            stage_1_smoothness=spec.two_stage.smoothness,
            Gamma=points,
            metric=_metric(smooth, cell),
            per_arc_length=smooth.per_arc_length,
            name=source.path.stem,
            record=_absolute(plain(source.data), source.path.parent) | {"cell": cell_record},
        )

    def problem(self) -> Problem:
        """Return the problem over all points of the path (eq. 19)."""
        assert self.metric is not None  # set when the task was made
        return Problem.of(
            self.cell,
            self.index,
            self.path.position,
            self.path.rotation,
            lower=self.cell.lower,
            upper=self.cell.upper,
            pose_rows=self.path.rows,
            spin_axis=self.path.spin_axis,
            u=self.path.u,
            link_weight=self.link_weights(range(self.path.h), self.smoothness),
            metric=self.metric,
            rows=self.rows,
        )

    def link_weights(self, points: Sequence[int], smoothness: float) -> Array:
        """Return lambda of the links between consecutive `points` of the path (len - 1,)."""
        if not self.per_arc_length:
            return np.full(max(len(points) - 1, 0), smoothness)
        length = self.path.arc_length
        mean = (length[-1] - length[0]) / (self.path.h - 1)
        # A link much shorter than the mean would drown the rest of the objective.
        ds = np.maximum(np.diff(length[list(points)]), mean / 20.0)
        return np.asarray(smoothness * (mean / ds) ** 4)

    def with_smoothness(self, smoothness: float) -> Task:
        """Return the same task with another lambda."""
        return replace(self, smoothness=smoothness)

    def as_yaml(self) -> str:
        """Return a complete task file, or raise InputError for a task that was made in Python."""
        if self.record is None:
            raise InputError("a task made in Python has no file; save its trajectory alone")
        text = io.StringIO()
        writer = YAML(typ="safe", pure=True)
        writer.default_flow_style = None
        writer.dump(dict(self.record), text)
        return text.getvalue()


def _increasing(points: Sequence[int]) -> bool:
    return all(a < b for a, b in itertools.pairwise(points))


def _direction(spec: IndexSpec, path: Path) -> Array | None:
    """Return the direction that the index asks for, (6,) or (h, 6); None leaves that of the path.

    They differ where a file of points brings directions of its own.
    """
    given = getattr(getattr(spec, spec.given[0]), "direction", "path")
    if given == "path":
        return None
    if given == "tangent":
        return np.hstack([path.tangent, np.zeros((path.h, 3))])
    u = np.zeros(6)
    u[: len(given)] = given
    length = float(np.linalg.norm(u))
    if length == 0.0:
        raise InputError("the direction is zero", field=f"index.{spec.given[0]}.direction")
    return u / length


def _index(spec: IndexSpec) -> Index:
    name = spec.given[0]
    options = getattr(spec, name)
    index: Index = getattr(indices, name)(
        task_weights=_array(options.task_weights), joint_weights=_array(options.joint_weights)
    )
    return replace(index, joint_centre=spec.joint_centre)


def _array(values: Sequence[float] | None) -> Array | None:
    return None if values is None else np.array(values, dtype=float)


def _metric(smooth: SmoothnessSpec, cell: Cell) -> Array:
    """Return the diagonal of the link metric (n,): 1/limit^2 where speed counts."""
    if isinstance(smooth.metric, list):
        return np.array(smooth.metric, dtype=float)
    if smooth.metric == "equal":
        return np.ones(cell.n)
    unknown = [joint.name for joint in cell.joints if not joint.velocity]
    if unknown:
        raise InputError(
            f"the velocity limit of {', '.join(unknown)} is unknown: give the metric as a list "
            "of weights",
            field="smoothness.metric",
        )
    limits = np.array([joint.velocity for joint in cell.joints], dtype=float)
    return np.asarray((np.mean(limits) / limits) ** 2)


def _absolute(record: Mapping[str, Any], folder: FilePath) -> dict[str, Any]:
    """Return a task whose path file is found from any folder."""
    path = {
        key: _found_anywhere(value, folder) if key in _PATH_FILES else value
        for key, value in record["path"].items()
    }
    return {**record, "path": path}


def _cell_record(source: Source, keys: Sequence[Key]) -> dict[str, Any]:
    """Return a cell whose files are found from any folder."""
    data = source.data
    for key in keys:
        data = data[key]
    record: dict[str, Any] = plain(data)
    folder = source.path.parent
    for part in (record, *record["arms"].values()):
        for key in ("urdf", "srdf"):
            if isinstance(part, dict) and part.get(key) is not None:
                part[key] = _found_anywhere(part[key], folder)
    if record.get("package_dirs"):
        record["package_dirs"] = [_found_anywhere(d, folder) for d in record["package_dirs"]]
    record.setdefault("name", source.path.stem)
    return record


def _found_anywhere(file: Any, folder: FilePath) -> Any:
    """Return a file name that does not depend on the folder it was written in."""
    if isinstance(file, dict):  # a path file with options
        return {k: _found_anywhere(v, folder) if k == "file" else v for k, v in file.items()}
    if not isinstance(file, str) or file.startswith("package://"):
        return file
    return str((folder / file).resolve())
