"""Plan the joint motion of two arms that share one task, best over the whole path.

    import dualarm_pin as dp

    task = dp.Task(dp.Cell.load("cell.yaml"), dp.paths.circle(0.1, points=49))
    best = dp.plan_global(task)

A name is imported when it is first used, so the import of the package costs next to nothing.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from dualarm_pin import clearance as clearance
    from dualarm_pin import indices as indices
    from dualarm_pin import rows as rows
    from dualarm_pin import show as show
    from dualarm_pin import solvers as solvers
    from dualarm_pin.answer.folder import load_result as load_result
    from dualarm_pin.answer.folder import save_result as save_result
    from dualarm_pin.answer.trajectory import Trajectory as Trajectory
    from dualarm_pin.answer.verify import verified as verified
    from dualarm_pin.answer.verify import verify as verify
    from dualarm_pin.cell import Cell as Cell
    from dualarm_pin.errors import DualArmError as DualArmError
    from dualarm_pin.evidence.examine import examine as examine
    from dualarm_pin.exports import export as export
    from dualarm_pin.files.resources import urdf_folder as urdf_folder
    from dualarm_pin.motion.make import make_motion as make_motion
    from dualarm_pin.path import Path as Path
    from dualarm_pin.path import paths as paths
    from dualarm_pin.planners.local import plan_local as plan_local
    from dualarm_pin.planners.methods import plan as plan
    from dualarm_pin.planners.placement import plan_placement as plan_placement
    from dualarm_pin.planners.two_stage import plan_two_stage as plan_two_stage
    from dualarm_pin.planners.whole_path import plan_global as plan_global
    from dualarm_pin.planners.whole_path import polish as polish
    from dualarm_pin.relative import Relative as Relative
    from dualarm_pin.task import Task as Task

__version__ = "0.1.0"

_MODULES = {
    "clearance": "clearance",
    "indices": "indices",
    "paths": "path.paths",
    "rows": "rows",
    "show": "show",
    "solvers": "solvers",
}
_HOMES = {
    "Cell": "cell",
    "Path": "path",
    "Relative": "relative",
    "Task": "task",
    "Trajectory": "answer.trajectory",
    "DualArmError": "errors",
    "examine": "evidence.examine",
    "export": "exports",
    "load_result": "answer.folder",
    "make_motion": "motion.make",
    "plan": "planners.methods",
    "plan_global": "planners.whole_path",
    "plan_local": "planners.local",
    "plan_placement": "planners.placement",
    "plan_two_stage": "planners.two_stage",
    "polish": "planners.whole_path",
    "save_result": "answer.folder",
    "urdf_folder": "files.resources",
    "verified": "answer.verify",
    "verify": "answer.verify",
}

__all__ = ["__version__", *_MODULES, *_HOMES]  # noqa: PLE0604 - the keys are strings


def __getattr__(name: str) -> Any:
    if name in _MODULES:
        value: Any = import_module(f"dualarm_pin.{_MODULES[name]}")
    elif name in _HOMES:
        value = getattr(import_module(f"dualarm_pin.{_HOMES[name]}"), name)
    else:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(__all__)
