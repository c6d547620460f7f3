"""Task: what is asked. A cell, a path, an index and a smoothness: what a task file holds."""

from __future__ import annotations

import io
from collections.abc import Callable, Mapping, Sequence
from contextlib import nullcontext
from dataclasses import dataclass, field, replace
from pathlib import Path as FilePath
from typing import Any, Literal

import numpy as np
from ruamel.yaml import YAML

from dualarm_pin import indices
from dualarm_pin.arrays import Array
from dualarm_pin.cell import Cell
from dualarm_pin.clearance.rule import UNSAID, ClearanceRule
from dualarm_pin.errors import InputError, ShapeError
from dualarm_pin.files.numbers import MOST_POINTS
from dualarm_pin.files.source import Source
from dualarm_pin.indices import Index
from dualarm_pin.path import Path
from dualarm_pin.path.gamma import choose_Gamma
from dualarm_pin.placement.asked import Asked
from dualarm_pin.problem import Problem
from dualarm_pin.rows import Row
from dualarm_pin.solvers.solver import Solver
from dualarm_pin.task.ends import FreePart, check_end
from dualarm_pin.task.load import parts_of_task
from dualarm_pin.task.motion_spec import MotionSpec

LEAST_POINTS = 2  # one alone is no path


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
        clearance: How far apart bodies must stay: by default no pair may touch whose distance the
            path does not fix itself; None asks nothing.
        motion: How its answer runs in time, if that is asked.
        aim: The smallest index, or the largest feed of the tool along the path.
        method: How to plan it where the caller does not say: a name, or a function (task, seed=...)
            that returns a `Trajectory`; None for the whole path at once.
        solver: The solver of that method where the caller does not say: a name, or a `Solver`.
        placement: What `plan_placement` may change, if anything.
        from_posture: Joints at the first point (n,) [rad or m], if they are given.
        to_posture: Joints at the last point (n,), if they are given.
        name: Name for tables.
        record: The content of a complete task file, if the task came from one.
        source: The file that it came from, for messages that name its lines.
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
    clearance: ClearanceRule | None = UNSAID
    motion: MotionSpec | None = None
    aim: Literal["index", "feed"] = "index"
    method: str | Callable[..., Any] | None = None
    solver: str | Solver | None = None
    placement: Asked | None = None
    from_posture: Array | None = None
    to_posture: Array | None = None
    name: str = "task"
    record: Mapping[str, Any] | None = None
    source: Source | None = None

    def __post_init__(self) -> None:
        h, n = self.path.h, self.cell.n
        if h < LEAST_POINTS:
            raise InputError(
                f"{h} point is too few: a path has at least {LEAST_POINTS}", field="path"
            )
        if h > MOST_POINTS:
            raise InputError(
                f"{h} points are too many: a path has at most {MOST_POINTS}; give `points` or "
                "`step` to take fewer",
                field="path",
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
        if self.clearance is not None:
            self.clearance.check_names(self.cell.body_names)
        self._check_ends()
        if not self.Gamma:
            object.__setattr__(self, "Gamma", choose_Gamma(self.path, min(6, h)))

    def _check_ends(self) -> None:
        ends = {"from_posture": 0, "to_posture": self.path.h - 1}
        given = {name: point for name, point in ends.items() if getattr(self, name) is not None}
        if len(given) == self.path.h:
            raise InputError("every posture of the path is given: nothing is left to plan")
        for name, point in given.items():
            q = check_end(name, getattr(self, name), self.cell, self.path, point)
            object.__setattr__(self, name, q)

    @classmethod
    def load(
        cls, file: str | FilePath, overrides: Sequence[str] = (), *, allow_code: bool = False
    ) -> Task:
        """Load a task file.

        Args:
            file: A YAML file.
            overrides: `key=value` changes with dotted keys; see `files.read_task`.
            allow_code: Import and run the functions that the file names with `call`.

        Raises:
            InputError: The file, the cell or what they name is wrong, or it names code of its own
                and that is not allowed.
        """
        source, parts = parts_of_task(file, overrides, allow_code=allow_code)
        with source.blamed():
            return cls(**parts)

    def check_first_stage(self) -> None:
        """Refuse points of the first stage that are not on the path; other methods need none.

        Raises:
            InputError: They do not rise from the first to the last point.
        """
        h = self.path.h
        if (self.Gamma[0], self.Gamma[-1]) == (0, h - 1) and np.all(np.diff(self.Gamma) > 0):
            return
        given = [point + 1 for point in self.Gamma]
        message = f"expected increasing points from 1 to {h}, both among them; given {given}"
        with self.source.blamed() if self.source is not None else nullcontext():
            raise InputError(message, field="two_stage.Gamma")

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

    def free(self) -> FreePart:
        """Return what is left to plan where the first or the last posture is given."""
        return FreePart.of(self.problem(), self.from_posture, self.to_posture)

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
