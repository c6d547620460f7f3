"""What a task file may say."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import Field

from dualarm_pin.clearance.spec import ClearanceSpec
from dualarm_pin.files.call import CallSpec, Place
from dualarm_pin.files.numbers import Point, Weight
from dualarm_pin.files.signature import Count
from dualarm_pin.files.source import Spec
from dualarm_pin.indices.spec import IndexSpec
from dualarm_pin.path.spec import PathSpec
from dualarm_pin.rows.spec import RowSpec
from dualarm_pin.task.motion_spec import MotionSpec


class SmoothnessSpec(Spec):
    """lambda of (eq. 19), how joints count in a step, and whether lambda follows the arc length."""

    weight: Weight = 3.0
    metric: Literal["equal", "velocity"] | list[Weight] = "equal"
    per_arc_length: bool = False


class TwoStageSpec(Spec):
    """The paper's first stage: points (from 1) and lambda."""

    Gamma: list[Point] | Count | None = None
    smoothness: Weight = 1.5


class TaskSpec(Spec):
    """A task file.

    Attributes:
        cell: A cell file, or a cell.
        path: One curve, and how the tool is held along it.
        index: What is minimised at each point.
        smoothness: lambda of (eq. 19), or more about it.
        two_stage: The paper's first stage.
        constraints: What must hold at points of the path beside the pose.
        clearance: How far apart bodies must stay: a distance, more about it, or `off`.
        motion: How its answer runs in time, if that is asked.
        method: How to plan it where the caller does not say: a name, or `call`.
        solver: The solver of that method: a name, or `call`.
        module_dirs: Further folders in which the modules of `call` are found.
    """

    cell: str | dict[str, Any]
    path: PathSpec
    index: IndexSpec = IndexSpec.model_validate("force")
    smoothness: Weight | SmoothnessSpec = 3.0
    two_stage: TwoStageSpec = TwoStageSpec()
    constraints: list[RowSpec] = Field(default_factory=list)
    clearance: ClearanceSpec = ClearanceSpec()
    motion: MotionSpec | None = None
    method: str | CallSpec | None = None
    solver: str | CallSpec | None = None
    module_dirs: list[str] = Field(default_factory=list)

    @property
    def calls(self) -> dict[Place, CallSpec]:
        """Where it calls code of the user's own; a path's arguments are checked when it is made."""
        path = self.path.call and CallSpec(call=self.path.call.call)
        sections: dict[Place, object] = {("path",): path, ("index",): self.index.call}
        sections |= {("constraints", i): row.call for i, row in enumerate(self.constraints)}
        sections |= {("method",): self.method, ("solver",): self.solver}
        return {place: call for place, call in sections.items() if isinstance(call, CallSpec)}
