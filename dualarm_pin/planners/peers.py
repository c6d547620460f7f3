"""What one gets elsewhere: CasADi with IPOPT or fatrop, and Pink. Each behind its extra.

`plan_casadi` solves the same whole-path problem (eq. 19) from random starts. `plan_pink` solves
another, local one: differential inverse kinematics with the relative pose as a task and the
manipulability of the second arm as a wish; it knows neither the index nor the smoothness of the
task, and is judged by them all the same.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from dualarm_pin.answer.evidence import Evidence, LawCount
from dualarm_pin.answer.notes import CasadiNotes, PinkNotes
from dualarm_pin.answer.provenance import Clock
from dualarm_pin.answer.trajectory import Trajectory
from dualarm_pin.answer.verify import verified
from dualarm_pin.arrays import Array
from dualarm_pin.errors import InputError, MissingExtraError
from dualarm_pin.planners.local import best_first_posture, follow, pose_between
from dualarm_pin.planners.unreachable import unreachable
from dualarm_pin.progress import SILENT, Progress
from dualarm_pin.search.starts import common_postures, generator
from dualarm_pin.solution import Solution, distinct, same_path
from dualarm_pin.solvers import casadi_ipopt
from dualarm_pin.solvers.solver import ends_of

if TYPE_CHECKING:
    from dualarm_pin.problem import Problem
    from dualarm_pin.task import Task


def plan_casadi(
    task: Task,
    *,
    plugin: str = "ipopt",
    starts: int = 10,
    seed: int = 0,
    progress: Progress = SILENT,
) -> Trajectory:
    """Solve (eq. 19) over the whole path with CasADi, from random postures common to all points.

    Args:
        task: What is asked.
        plugin: `ipopt` or `fatrop`.
        starts: Number of starts.
        seed: Seed of the starts.
        progress: Told where the work stands.

    Raises:
        MissingExtraError: CasADi is not installed.
        InputError: CasADi has no expression for the index.
    """
    clock = Clock.start()
    problem = task.problem()
    programme = casadi_ipopt.build(problem, plugin)
    drawn = common_postures(problem.lower, problem.upper, problem.k, starts, generator(seed, 20))
    progress.stage(f"CasADi, {plugin}", starts)
    found = []
    for start in drawn:
        found.append(programme.solve(start))
        progress.advance()
    feasible = [end for end in found if end.feasible]
    solver = f"casadi-{plugin}"
    if not feasible:
        return unreachable(task, problem, "casadi", solver, seed, clock)
    best = min(feasible, key=lambda end: end.objective)
    return verified(
        task,
        best.q,
        method="casadi",
        solver=solver,
        timing=clock.read(),
        seed=seed,
        evidence=Evidence(laws={"whole path": count_starts(found, best, problem.size)}),
        notes=CasadiNotes(build_s=programme.build_s, solve_s=tuple(end.wall_s for end in found)),
    )


def count_starts(found: Sequence[Solution], best: Solution, size: float = 1.0) -> LawCount:
    """Return what starts came to: minima, and hits of the best, told apart by their joints."""
    minima = distinct(ends_of(found, size))
    best_hits = minima.hits[[same_path(q, best.q) for q in minima.ends.q]]
    return LawCount(len(found), int(minima.hits.sum()), len(minima), int(best_hits.sum()))


def plan_pink(
    task: Task,
    *,
    starts: int = 20,
    seed: int = 0,
    substeps: int = 10,
    manipulability: float = 0.01,
    progress: Progress = SILENT,
) -> Trajectory:
    """Follow the path with Pink: `RelativeFrameTask` and `ManipulabilityTask` of the second arm.

    Every point is put onto the path exactly at the end of its interval, as for `plan_local`; Pink
    alone would stay a little off it.

    Args:
        task: What is asked.
        starts: Starts for the first point, whose best index is taken.
        seed: Seed of the starts.
        substeps: Steps an interval.
        manipulability: Cost of the manipulability task; 0 leaves it out.
        progress: Told where the work stands.

    Raises:
        MissingExtraError: Pink is not installed.
        InputError: The path leaves components free, or a joint is not revolute or is mapped.
    """
    clock = Clock.start()
    problem = task.problem()
    lead = _PinkLead(task, problem, manipulability, substeps)
    q_first = best_first_posture(problem, starts, seed)
    if q_first is None:
        return unreachable(task, problem, "pink", "relative-frame", seed, clock)
    progress.stage("Pink", problem.k - 1)
    q, gave_way = follow(problem, q_first, lead, progress)
    return verified(
        task,
        q,
        method="pink",
        solver="relative-frame",
        timing=clock.read(),
        seed=seed,
        notes=PinkNotes(manipulability=manipulability, infeasible_at=gave_way),
    )


class _PinkLead:
    """Pink's tasks for the two tool frames of a cell, as `follow` takes them."""

    def __init__(self, task: Task, problem: Problem, manipulability: float, substeps: int) -> None:
        try:
            import pink
            from pink import limits, tasks
        except ImportError as error:
            raise MissingExtraError(
                "this method needs Pink: pip install 'dualarm-pin[pink]'"
            ) from error
        cell = task.cell
        if not (task.path.rows == 6).all():
            raise InputError("Pink's relative task holds whole poses alone", field="path")
        if any(joint.kind != "revolute" for joint in cell.joints) or not cell.same_order:
            raise InputError("Pink's manipulability is for plain revolute joints", field="cell")
        self._pink: Any = pink
        self._problem, self._substeps = problem, substeps
        self._dt = 1.0 / (problem.k - 1) / substeps
        # Pink adds attributes to the model it is given: it gets one of its own.
        self._model = cell.model.copy()
        e1, e2 = (self._model.frames[frame].name for frame in (cell.e1, cell.e2))
        self._limits = [limits.ConfigurationLimit(self._model)]
        self._relative = tasks.RelativeFrameTask(e2, e1, position_cost=1.0, orientation_cost=1.0)
        self._tasks = [self._relative, tasks.DampingTask(cost=1e-3)]
        if manipulability > 0.0:
            # Pink counts the wish per step, not per second: 1/s would jump at the first step.
            wish = {"cost": manipulability, "manipulability_rate": self._dt}
            self._tasks.append(tasks.ManipulabilityTask(e2, self._model, **wish))

    def __call__(self, i: int, q: Array) -> tuple[Array, bool]:
        """Go from point i - 1 to point i; return the joints and whether a step was not solved."""
        import pinocchio as pin

        problem = self._problem
        at = np.clip(q, problem.lower, problem.upper)
        for s in range(1, self._substeps + 1):
            position, rotation = pose_between(problem, i, s / self._substeps)
            self._relative.set_target(pin.SE3(rotation, position))
            configuration = self._pink.Configuration(self._model, self._model.createData(), at)
            try:
                velocity = self._pink.solve_ik(
                    configuration, self._tasks, self._dt, solver="quadprog", limits=self._limits
                )
            except self._pink.PinkError:
                return at, True
            at = np.clip(at + velocity * self._dt, problem.lower, problem.upper)
        return at, False
