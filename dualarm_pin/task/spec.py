"""What a task file may say."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import Field

from dualarm_pin.clearance.spec import ClearanceSpec
from dualarm_pin.files.call import CallSpec, Place
from dualarm_pin.files.numbers import Number, Point, Weight
from dualarm_pin.files.signature import Count
from dualarm_pin.files.source import Spec
from dualarm_pin.indices.spec import IndexSpec
from dualarm_pin.path.spec import PathSpec
from dualarm_pin.placement.spec import FreeSpec
from dualarm_pin.rows.spec import RowSpec
from dualarm_pin.task.motion_spec import MotionSpec
from dualarm_pin.task.posture_spec import PostureSpec


class SmoothnessSpec(Spec):
    """How much smooth motion counts against the index.

    Attributes:
        weight: lambda of (eq. 19).
        metric: How the joints count in a step: `equal`, `velocity` (by their speed limits), or a
            weight for each.
        per_arc_length: Whether lambda follows the arc length where points lie unevenly.
    """

    weight: Weight = 3.0
    metric: Literal["equal", "velocity"] | list[Weight] = "equal"
    per_arc_length: bool = False


class TwoStageSpec(Spec):
    """The paper's first stage; it binds the method two-stage alone.

    Attributes:
        Gamma: The points that it solves, from 1, the first and the last among them; or how many,
            such as `[1, 7, 13, 19, 25, 31]`.
        smoothness: lambda of (eq. 20).
    """

    Gamma: list[Point] | Count | None = None
    smoothness: Weight = 1.5


class TaskSpec(Spec):
    """A task file.

    Attributes:
        cell: A cell file, or a cell, such as `cell.yaml`.
        path: One curve, and how the tool is held along it.
        index: What is minimised at each point.
        smoothness: lambda of (eq. 19), or more about it.
        two_stage: The paper's first stage.
        constraints: What must hold at points of the path beside the pose.
        clearance: How far apart bodies must stay: a distance, more about it, or `off`.
        motion: How its answer runs in time, if that is asked.
        aim: The smallest index, or the largest feed of the tool along the path: `index`, `feed`.
        from_posture: Joints at the first point, in the order of `check` [rad or m], or from
            elsewhere, such as `{result: results/before}`.
        to_posture: Joints at the last point, such as `{deg: [0, 10, 90]}`.
        method: How to plan it where the caller does not say: a name, or `call`, such as `global`.
        solver: The solver of that method: a name, or `call`, such as `engine`.
        placement: What `dualarm-pin place` may change, if anything.
        module_dirs: Further folders in which the modules of `call` are found, such as `[./code]`.
    """

    cell: str | dict[str, Any]
    path: PathSpec
    index: IndexSpec = IndexSpec.model_validate("force")
    smoothness: Weight | SmoothnessSpec = 3.0
    two_stage: TwoStageSpec = TwoStageSpec()
    constraints: list[RowSpec] = Field(default_factory=list)
    clearance: ClearanceSpec = ClearanceSpec()
    motion: MotionSpec | None = None
    aim: Literal["index", "feed"] = "index"
    from_posture: list[Number] | PostureSpec | None = None
    to_posture: list[Number] | PostureSpec | None = None
    method: str | CallSpec | None = None
    solver: str | CallSpec | None = None
    placement: FreeSpec | None = None
    module_dirs: list[str] = Field(default_factory=list)

    @property
    def calls(self) -> dict[Place, CallSpec]:
        """Where it calls code of the user's own; a path's arguments are checked when it is made."""
        path = self.path.call and CallSpec(call=self.path.call.call)
        sections: dict[Place, object] = {("path",): path, ("index",): self.index.call}
        sections |= {("constraints", i): row.call for i, row in enumerate(self.constraints)}
        sections |= {("method",): self.method, ("solver",): self.solver}
        return {place: call for place, call in sections.items() if isinstance(call, CallSpec)}
