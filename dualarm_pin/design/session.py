"""A session: base, workpiece, tool, weights and limits change, and the motion follows.

session = dualarm_pin.design.Session(task)
session.move(base2=pin.SE3(...))      # or move(base2_x=..., workpiece_yaw=...)
session.answer.objective, session.answer.q
session.replan(posture, remaining=30)
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from dualarm_pin.arrays import Array
from dualarm_pin.arrays import checked as checked_array
from dualarm_pin.design.answer import Answer
from dualarm_pin.design.limits import Limits
from dualarm_pin.design.occasion import Occasion
from dualarm_pin.design.pool import Pool, global_minima
from dualarm_pin.design.rest import rest_of_path
from dualarm_pin.design.standing import change_to, parameters_of, stands
from dualarm_pin.errors import InputError, UnknownNameError, nearest
from dualarm_pin.placement.parameters import BASE
from dualarm_pin.placement.shared import placed
from dualarm_pin.solution import Solution
from dualarm_pin.solvers import interior_point as engine
from dualarm_pin.task.changed import changed_task
from dualarm_pin.task.moved import moved_task

if TYPE_CHECKING:
    from dualarm_pin.problem import Problem
    from dualarm_pin.task import Task


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
        self._limits, self._occasion = Limits(task.cell), Occasion(self._names)
        self._pool = Pool(size)
        self._state()
        self._pool.add(self._problem, self._found())
        if not self._pool.members:
            raise InputError(
                "no start reaches the whole path where the cell stands: begin where `dualarm-pin "
                "solve` finds a motion",
                field="task",
            )
        self._occasion.seen(self._pool, self._problem)
        self.answer = self._answered("")

    def move(
        self, base2: pin.SE3 | None = None, *, hurried: bool = False, **change: float
    ) -> Answer:
        """Move something and follow with the motion.

        Args:
            base2: Pose of base 2 in the cell; turned about the vertical at most.
            hurried: Follow the best motion and one of the others in turn, not all of them.
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
        return self._go(np.array([values[name] for name in self._names]), hurried=hurried)

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
        self._limits = self._limits.changed(limits or {})
        if smoothness is not None:
            self.task = self.task.with_smoothness(smoothness)
        self._state()
        return self._go(self._values)

    def search(self) -> Answer:
        """Search again over all starts where things stand, and show what it finds."""
        return self._with(self._found())

    def consider(self, paths: ArrayLike) -> Answer:
        """Follow motions that are known from elsewhere too, and show the best.

        Args:
            paths: Joints (s, h, n), anywhere near a minimum where things stand.

        Raises:
            ShapeError: They have another shape.
        """
        h, n = self._problem.k, self._problem.n
        given = checked_array("paths", paths, (len(np.atleast_1d(paths)), h, n))
        return self._with(given)

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
        return rest_of_path(self._problem, self._pool.members[0].solution, here, remaining)

    def moved_task(self) -> Task:
        """Return the task where things stand, to be planned, saved or written."""
        moved = moved_task(self.task, dict(zip(self._names, self._values, strict=True)))
        return changed_task(moved, smoothness=self.task.smoothness, limits=self._limits.new)

    def _state(self) -> None:
        """State the problem; afterwards only `chain.parameters` changes."""
        problem = self.task.problem()
        engine.compare(problem)
        self._problem = placed(problem.with_bounds(*self._limits.bounds), self._free, self._values)

    def _found(self) -> Array:
        self._searches += 1
        self._occasion.searched(self._values)
        return global_minima(self._problem, self._seed, self._searches, self._jobs)

    def _go(self, values: Array, *, hurried: bool = False) -> Answer:
        self._values = values
        self._problem.chain.parameters[:] = values
        self._pool.follow(self._problem, whole=not hurried)
        self.answer = self._answered(self._occasion.due(self._pool, self._problem, values))
        return self._told()

    def _with(self, paths: Array) -> Answer:
        self._pool.add(self._problem, paths)
        self._occasion.seen(self._pool, self._problem)
        self.answer = self._answered("")
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

    def _known(self, name: str) -> None:
        if name not in self._names:
            raise UnknownNameError(
                f"this cell has no parameter {name!r}; {nearest(name, self._names, 9)}",
                field="move",
            )
