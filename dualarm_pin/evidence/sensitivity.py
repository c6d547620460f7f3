"""What errors of the cell cost, which joint limits cost most, which points are the bottleneck."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from dualarm_pin.answer.verify import verify
from dualarm_pin.errors import InputError
from dualarm_pin.placement.parameters import ELEMENTS, checked
from dualarm_pin.problem import Problem
from dualarm_pin.solution import Solution
from dualarm_pin.solvers import interior_point as engine
from dualarm_pin.task.moved import moved_task
from dualarm_pin.tolerance import TOLERANCE

if TYPE_CHECKING:
    from dualarm_pin.task import Task

Array = NDArray[np.float64]
_ERROR = 1e-3  # 1 mm or 1 mrad: what the table is about
_MORE = {"revolute": float(np.deg2rad(10.0)), "prismatic": 0.1}  # by which a limit is opened
_AHEAD = 1.0  # box of a parameter: derivatives do not depend on it
_WORST, _LIMITS = 5, 6  # points and limits that the tables name


@dataclass(frozen=True)
class ParameterCost:
    """What an error of 1 mm or 1 mrad of one parameter costs.

    Attributes:
        name: `base2.x`, ...: see `placement.parameters.ELEMENTS`.
        position_error: Largest position error on the path with the joints kept [m].
        rotation_error: Largest rotation error [rad].
        slope: Change of the objective with the motion planned again, to first order, of +1.
        predicted: Objective then, by slope and curvature; None where there is no curvature.
        solved: Objective after planning again from this motion; None if it was not asked for.
    """

    name: str
    position_error: float
    rotation_error: float
    slope: float
    predicted: float | None
    solved: float | None


@dataclass(frozen=True)
class LimitCost:
    """What a joint limit costs.

    Attributes:
        joint: Name of the joint.
        side: `lower` or `upper`.
        slope: Decrease of the objective per rad or m of more range, to first order.
        points: Points of the path at which the limit holds.
        predicted: Objective with 10 degrees (or 0.1 m) more, to first order: too low as a rule.
        solved: Objective after planning again from this motion; None if it was not asked for.
    """

    joint: str
    side: str
    slope: float
    points: int
    predicted: float
    solved: float | None


@dataclass(frozen=True)
class PointCost:
    """A point of the path, from 1, and what it holds of the objective.

    Attributes:
        point: The point, counted from 1.
        index: Index there.
        share: Share of the sum of the index.
        limits: Joints at a limit there.
    """

    point: int
    index: float
    share: float
    limits: tuple[str, ...]


@dataclass(frozen=True)
class Costs:
    """What `cell_costs` found.

    Attributes:
        objective: Objective of the minimum at the motion, which all figures are of.
        parameters: By parameter, in the order of the chain.
        limits: The costliest limits, most first.
        points: The points with the largest index, largest first.
        given: Objective of the motion itself; None if it was not kept.
        clearance: Whether distances are asked for, which the figures leave out.
    """

    objective: float
    parameters: tuple[ParameterCost, ...]
    limits: tuple[LimitCost, ...]
    points: tuple[PointCost, ...]
    given: float | None = None
    clearance: bool = False

    @property
    def elsewhere(self) -> bool:
        """Whether the motion itself is not at that minimum."""
        level = TOLERANCE.same_objective * max(1.0, abs(self.objective))
        return self.given is not None and abs(self.given - self.objective) > level


def cell_costs(task: Task, q: Array, *, solve_again: bool = False) -> Costs:
    """Return what errors, limits and points cost at a minimum.

    Args:
        task: The task.
        q: Its motion (h, n), nearly a minimum.
        solve_again: Also plan again from this motion where a figure is a prediction.

    Raises:
        InputError: The motion is at no minimum of the task: nothing can be predicted from it.
    """
    from dualarm_pin.engine.sensitivity import sensitivity

    problem = task.problem()
    best = _polished(problem, q)
    names = [name for name in ELEMENTS if _has(task, name)]
    free = checked({name: (-_AHEAD, _AHEAD) for name in names}, task.cell)
    found = sensitivity(problem, best, free)
    bends = np.diag(found.curvature)
    parameters = tuple(
        _parameter(task, best, name, float(slope), float(bend), solve_again)
        for name, slope, bend in zip(names, found.gradient, bends, strict=True)
    )
    return Costs(
        objective=best.objective,
        parameters=parameters,
        limits=_limits(task, problem, best, solve_again),
        points=_points(task, problem, best),
        given=problem.objective(q),
        clearance=task.clearance is not None,
    )


def _polished(problem: Problem, q: Array) -> Solution:
    from dualarm_pin.engine.solve import Options

    end = engine.solve(problem, q, Options(tolerance=TOLERANCE.polish, mu0=1e-4, push=1e-6))
    if not end.converged:
        raise InputError(
            f"the motion is at no minimum of its task ({end.message}): `dualarm-pin solve` the "
            "task first",
            field="trajectory",
        )
    return end


def _has(task: Task, name: str) -> bool:
    try:
        checked({name: (-_AHEAD, _AHEAD)}, task.cell)
    except InputError:
        return False
    return True


def _parameter(
    task: Task, best: Solution, name: str, slope: float, bend: float, solve_again: bool
) -> ParameterCost:
    moved = moved_task(task, {name: _ERROR})
    kept = verify(moved, best.q, clearance=False)
    ahead = best.objective + slope * _ERROR + 0.5 * bend * _ERROR**2
    return ParameterCost(
        name=name,
        position_error=float(kept.position_error.max()),
        rotation_error=float(kept.rotation_error.max()),
        slope=slope,
        predicted=ahead if np.isfinite(ahead) else None,
        solved=_again(moved.problem(), best) if solve_again else None,
    )


def _again(problem: Problem, best: Solution) -> float | None:
    """Return the objective after planning again from a motion, or None where that fails."""
    from dualarm_pin.engine.solve import Options

    end = engine.solve(problem, best.q, Options(tolerance=1e-9, mu0=1e-3, push=1e-4))
    return end.objective if end.converged else None


def _limits(
    task: Task, problem: Problem, best: Solution, solve_again: bool
) -> tuple[LimitCost, ...]:
    assert best.multipliers is not None  # the engine knows them
    found = []
    for side, forces in (("lower", best.multipliers.lower), ("upper", best.multipliers.upper)):
        for k, joint in enumerate(task.cell.joints):
            slope = float(forces[:, k].sum())
            bound = problem.lower[k] if side == "lower" else problem.upper[k]
            points = int(np.sum(np.abs(best.q[:, k] - bound) < TOLERANCE.active))
            if not points or slope < TOLERANCE.active:
                continue
            more = _MORE[joint.kind]
            wider = {"lower": problem.lower.copy(), "upper": problem.upper.copy()}
            wider[side][k] += -more if side == "lower" else more
            solved = _again(problem.with_bounds(**wider), best) if solve_again else None
            predicted = best.objective - slope * more
            found.append(LimitCost(joint.name, side, slope, points, predicted, solved))
    found.sort(key=lambda cost: -cost.slope)
    return tuple(found[:_LIMITS])


def _points(task: Task, problem: Problem, best: Solution) -> tuple[PointCost, ...]:
    index = verify(task, best.q, clearance=False).index
    total = float(np.sum(index))
    order = np.argsort(-index, kind="stable")[:_WORST]
    return tuple(
        PointCost(
            point=int(i) + 1,
            index=float(index[i]),
            share=float(index[i]) / total if total else 0.0,
            limits=tuple(
                joint
                for k, joint in enumerate(task.cell.joint_names)
                if min(best.q[i, k] - problem.lower[k], problem.upper[k] - best.q[i, k])
                < TOLERANCE.active
            ),
        )
        for i in order
    )
