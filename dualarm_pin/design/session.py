"""A session: base, workpiece, tool, weights and limits change, and the motion follows.

session = dualarm_pin.design.Session(task)
session.move(base2=pin.SE3(...))      # or move(base2_x=..., workpiece_yaw=...)
session.answer.objective, session.answer.q
session.replan(posture, remaining=30)
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike, NDArray

from dualarm_pin.arrays import checked as checked_array
from dualarm_pin.design.pool import Pool, global_minima
from dualarm_pin.design.standing import change_to, parameters_of, stands
from dualarm_pin.engine.solve import Options, solve
from dualarm_pin.errors import InputError, UnknownNameError, nearest
from dualarm_pin.placement.parameters import BASE
from dualarm_pin.placement.shared import placed
from dualarm_pin.problem import Neighbours
from dualarm_pin.solution import Multipliers, Solution
from dualarm_pin.solvers import interior_point as engine
from dualarm_pin.task.changed import changed_task
from dualarm_pin.task.moved import moved_task
from dualarm_pin.tolerance import TOLERANCE

if TYPE_CHECKING:
    from dualarm_pin.problem import Problem
    from dualarm_pin.task import Task

Array = NDArray[np.float64]

_CLOSE = 0.02  # of the best value: two members this near may change rank
_FAR, _FAR_TURN = 0.02, np.deg2rad(5.0)  # m and rad since the last search


@dataclass(frozen=True, eq=False)
class Answer:
    """The best motion known where things stand.

    Attributes:
        q: Joints (h, n); those that were last valid where `valid` is False.
        objective: Objective of q where it was valid.
        valid: Whether q holds where things stand now.
        why: Why not, in one sentence.
        basin: Number of the minimum that is shown; another number is another way of moving.
        pool: Objectives of the minima that are followed, best first.
        change: Parameters, from where the task's cell stands [m or rad].
        search_due: Why a global search should be run; empty if none is due.
    """

    q: Array
    objective: float
    valid: bool
    why: str
    basin: int
    pool: tuple[float, ...]
    change: Mapping[str, float]
    search_due: str


class Session:
    """The motion of a task while its cell is changed.

    Args:
        task: The task; its cell is where the session starts.
        size: Minima that are followed at once.
        seed: Seed of the searches.
        jobs: Threads of a search.

    Attributes:
        task: The task as given, with what `set` changed; see `moved_task`.
        answer: The best motion known.
        callbacks: Called with every new answer.

    Raises:
        InputError: No start reaches the whole path where the cell stands.
    """

    _problem: Problem

    def __init__(
        self, task: Task, *, size: int = 5, seed: int = 0, jobs: int | None = None
    ) -> None:
        self.task, self.callbacks = task, list[Callable[[Answer], Any]]()
        self._seed, self._jobs, self._searches = seed, jobs, 0
        self._free = parameters_of(task.cell)
        self._names = tuple(each.name for each in self._free)
        self._values = np.zeros(len(self._free))
        self._searched_at = self._values.copy()
        bounds = zip(task.cell.lower.tolist(), task.cell.upper.tolist(), strict=True)
        self._limits: list[tuple[float, float]] = list(bounds)
        self._pool = Pool(size)
        self._state()
        self._pool.add(self._problem, self._found())
        if not self._pool.members:
            raise InputError(
                "no start reaches the whole path where the cell stands: begin where `dualarm-pin "
                "solve` finds a motion",
                field="task",
            )
        self._active = self._bounds_held()
        self.answer = self._answered("")

    def move(self, base2: pin.SE3 | None = None, **change: float) -> Answer:
        """Move something and follow with the motion.

        Args:
            base2: Pose of base 2 in the cell; turned about the vertical at most.
            **change: Parameters with `_` for `.`, such as `base2_x=2.4` (in the world),
                `base2_yaw=3.1`, `workpiece_z=0.02`, `tool2_length=0.05` (from where they were).

        Raises:
            UnknownNameError: The cell has no such parameter.
            InputError: A value is not finite, or the base is tilted.
        """
        values = dict(zip(self._names, self._values.tolist(), strict=True))
        if base2 is not None:
            self._known(f"{BASE}.x")
            values |= change_to(self.task.cell.arms[1].base, base2)
        for given, value in change.items():
            name = given.replace("_", ".", 1)
            self._known(name)
            if not np.isfinite(value):
                raise InputError(f"is {value}, not a finite number", field=given)
            values[name] = float(value) - stands(self.task.cell, name)
        return self._go(np.array([values[name] for name in self._names]))

    def set(
        self,
        *,
        smoothness: float | None = None,
        limits: Mapping[str, tuple[float, float]] | None = None,
    ) -> Answer:
        """Change what is asked and follow with the motion.

        Args:
            smoothness: lambda of (eq. 19).
            limits: Bounds by joint, `arm1/joint_1: (-1, 1)` [rad or m].

        Raises:
            UnknownNameError: There is no such joint.
            InputError: A number is wrong.
        """
        if smoothness is not None and not 0.0 <= smoothness < np.inf:
            raise InputError(f"is {smoothness}, must be 0 or more", field="smoothness")
        held = list(self._limits)
        for joint, (low, high) in (limits or {}).items():
            if joint not in self.task.cell.joint_names:
                hint = nearest(joint, self.task.cell.joint_names)
                raise UnknownNameError(f"there is no joint {joint!r}; {hint}", field="limits")
            if not (np.isfinite([low, high]).all() and low < high):
                raise InputError(f"from {low} to {high} is no range", field=f"limits.{joint}")
            held[self.task.cell.joint_names.index(joint)] = (low, high)
        self._limits = held
        if smoothness is not None:
            self.task = self.task.with_smoothness(smoothness)
        self._state()
        return self._go(self._values)

    def search(self) -> Answer:
        """Search again over all starts where things stand, and show what it finds."""
        self._pool.add(self._problem, self._found())
        self._active = self._bounds_held()
        self.answer = self._answered("")
        return self._told()

    def consider(self, paths: ArrayLike) -> Answer:
        """Follow motions that are known from elsewhere too, and show the best.

        Args:
            paths: Joints (s, h, n), anywhere near a minimum where things stand.

        Raises:
            ShapeError: They have another shape.
        """
        h, n = self._problem.k, self._problem.n
        given = checked_array("paths", paths, (len(np.atleast_1d(paths)), h, n))
        self._pool.add(self._problem, given)
        self._active = self._bounds_held()
        self.answer = self._answered("")
        return self._told()

    def replan(self, posture: ArrayLike, remaining: int) -> Solution:
        """Plan the rest of the path again from a measured posture.

        Args:
            posture: (n,) where the joints are [rad or m]; it stays, and its step to the next
                point counts.
            remaining: Points of the path that are left, from its end.

        Raises:
            ShapeError: The posture has another shape.
            InputError: `remaining` is not 1 .. h, or nothing is planned yet where things stand.
        """
        h = self._problem.k
        if not 1 <= remaining <= h:
            raise InputError(f"is {remaining}; the path has 1 to {h} points", field="remaining")
        if not self.answer.valid:
            raise InputError(f"no motion is valid here: {self.answer.why}", field="posture")
        here = checked_array("posture", posture, (self._problem.n,))
        first = h - remaining
        rest = self._problem.window(first, remaining, linked=True)
        ends = np.vstack([here, here])
        rest = replace(rest, neighbours=Neighbours(ends, rest.neighbours.weight))
        best = self._pool.members[0].solution
        assert best.multipliers is not None  # the engine knows them
        known = best.multipliers
        warm = Multipliers(
            *(
                array[first:]
                for array in (known.equalities, known.lower, known.upper, known.inequalities)
            )
        )
        end = solve(rest, best.q[first:], _REPLAN, warm=warm)
        return end if end.converged else solve(rest, best.q[first:], _REPLAN_AGAIN)

    def moved_task(self) -> Task:
        """Return the task where things stand, to be planned, saved or written."""
        names, own = self.task.cell.joint_names, (self.task.cell.lower, self.task.cell.upper)
        limits = {
            name: limit
            for name, limit, low, high in zip(names, self._limits, *own, strict=True)
            if limit != (low, high)
        }
        moved = moved_task(self.task, dict(zip(self._names, self._values, strict=True)))
        return changed_task(moved, smoothness=self.task.smoothness, limits=limits)

    def _state(self) -> None:
        """State the problem; afterwards only `chain.parameters` changes."""
        problem = self.task.problem()
        engine.compare(problem)
        lower, upper = np.array(self._limits).T
        self._problem = placed(problem.with_bounds(lower, upper), self._free, self._values)

    def _found(self) -> Array:
        self._searches += 1
        self._searched_at = self._values.copy()
        return global_minima(self._problem, self._seed, self._searches, self._jobs)

    def _go(self, values: Array) -> Answer:
        self._values = values
        self._problem.chain.parameters[:] = values
        self._pool.follow(self._problem)
        self.answer = self._answered(self._search_due())
        return self._told()

    def _told(self) -> Answer:
        for call in self.callbacks:
            call(self.answer)
        return self.answer

    def _answered(self, due: str) -> Answer:
        change = dict(zip(self._names, self._values.tolist(), strict=True))
        members = self._pool.members
        if not members:
            old = self.answer
            why = "none of the motions that were followed reaches the whole path here: search again"
            return replace(old, valid=False, why=why, pool=(), change=change, search_due=due or why)
        best = members[0]
        return Answer(
            q=best.solution.q,
            objective=best.solution.objective,
            valid=True,
            why="",
            basin=best.number,
            pool=tuple(member.solution.objective for member in members),
            change=change,
            search_due=due,
        )

    def _search_due(self) -> str:
        members = self._pool.members
        if self._pool.lost or not members:
            return "a motion that was followed has ended"
        best = members[0].solution.objective
        if len(members) > 1 and members[1].solution.objective - best < _CLOSE * abs(best):
            return "two motions are nearly as good"
        held = self._bounds_held()
        if not np.array_equal(held, self._active):
            self._active = held
            return "another joint limit holds"
        away = np.abs(self._values - self._searched_at)
        turns = np.array([name.endswith(".yaw") for name in self._names])
        if (away[turns] > _FAR_TURN).any() or (away[~turns] > _FAR).any():
            return "far from where the last search was"
        return ""

    def _bounds_held(self) -> NDArray[np.bool_]:
        if not self._pool.members:
            return np.zeros(0, dtype=bool)
        q = self._pool.members[0].solution.q
        room = np.minimum(q - self._problem.lower, self._problem.upper - q)
        return np.asarray((room < TOLERANCE.active).any(axis=0))

    def _known(self, name: str) -> None:
        if name not in self._names:
            raise UnknownNameError(
                f"this cell has no parameter {name!r}; {nearest(name, self._names, 9)}",
                field="move",
            )


_REPLAN = Options.warm(tolerance=1e-6, iterations=60)
_REPLAN_AGAIN = Options(iterations=150, mu0=1e-2, push=1e-3)
