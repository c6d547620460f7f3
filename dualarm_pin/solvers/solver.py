"""Solver: what takes a `Problem` and a start and returns a `Solution`; every planner takes one.

A function does: `def solve(problem, start) -> Solution`. So does an object that can be called; with
a `name` it is called that in results, and with `solve_many` it is handed all starts at once.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Protocol, TypedDict, Unpack, cast

import numpy as np

from dualarm_pin.arrays import Array
from dualarm_pin.errors import InputError
from dualarm_pin.reference import violation
from dualarm_pin.solution import Solution, Solutions
from dualarm_pin.tolerance import TOLERANCE

if TYPE_CHECKING:
    from dualarm_pin.problem import Problem


class Solver(Protocol):
    """Minimises a problem from one start. Give an instance, or a function of this shape."""

    def __call__(self, problem: Problem, start: Array, /) -> Solution:
        """Return where the start (k, n) ends, judged by residuals of its own: see `judged`."""


class ManyOptions(TypedDict, total=False):
    """How many starts are solved at once.

    Attributes:
        jobs: Threads; None takes the processors there are.
        points: For each start the one point of the path that it solves alone (s,).
        iterations: Most iterations of a start; None leaves it to the solver.
    """

    jobs: int | None
    points: Sequence[int] | None
    iterations: int | None


class ManyStarts(Solver, Protocol):
    """A solver that is faster with many starts at hand."""

    def solve_many(self, problem: Problem, starts: Array, **how: Unpack[ManyOptions]) -> Solutions:
        """Return the ends of starts (s, k, n), or (s, 1, n) with `points`; alike for any jobs."""


def judged(
    problem: Problem,
    q: Array,
    *,
    converged: bool,
    message: str = "",
    iterations: int = 0,
    wall_s: float = 0.0,
) -> Solution:
    """Return the solution at joints q (k, n), its objective and residual computed with Pinocchio.

    Args:
        problem: The problem.
        q: Where the solver ended; cut at the bounds.
        converged: What the solver says of itself; it counts only where q is on the path.
        message: Why it stopped.
        iterations: Iterations.
        wall_s: Seconds.
    """
    q = np.clip(q, problem.lower, problem.upper)
    residual = violation(problem, q)
    feasible = bool(residual <= TOLERANCE.position / 10.0)
    return Solution(
        q=q,
        objective=problem.objective(q),
        residual=residual,
        feasible=feasible,
        converged=feasible and converged,
        message=message,
        wall_s=wall_s,
        iterations=iterations,
    )


def solve_many(
    solver: Solver, problem: Problem, starts: Array, **how: Unpack[ManyOptions]
) -> Solutions:
    """Return the ends of many starts: all at once where the solver can, else start by start.

    The arguments are those of `ManyStarts.solve_many`. After Ctrl-C the ends are those that were
    finished, the rest infeasible and `interrupted` set.
    """
    if hasattr(solver, "solve_many"):
        return cast(ManyStarts, solver).solve_many(problem, starts, **how)
    points = how.get("points")
    parts = [problem] * len(starts)
    if points is not None:
        alone = {point: problem.subset([point], 0.0) for point in set(points)}
        parts = [alone[point] for point in points]
    solutions: list[Solution] = []
    try:
        for part, start in zip(parts, starts, strict=True):
            solutions.append(solve_one(solver, part, start))
    except KeyboardInterrupt:
        left = [cut_off(start) for start in starts[len(solutions) :]]
        return ends_of([*solutions, *left], problem.size, interrupted=True)
    return ends_of(solutions, problem.size)


def solve_one(solver: Solver, problem: Problem, start: Array) -> Solution:
    """Return the end of one start, and insist that it is a solution.

    Raises:
        InputError: The solver returned something else, or joints of another shape.
    """
    end = solver(problem, start)
    if not isinstance(end, Solution) or np.shape(end.q) != np.shape(start):
        given = f"q of shape {np.shape(end.q)}" if isinstance(end, Solution) else f"{end!r:.80}"
        message = f"a Solution with q of shape {np.shape(start)} is expected; it returned {given}"
        raise error_about(solver, message)
    return end


def ends_of(
    solutions: Sequence[Solution], size: float = 1.0, *, interrupted: bool = False
) -> Solutions:
    """Return solutions of one problem as arrays; those count as converged that say so."""
    ends = Solutions.of(list(solutions))
    return replace(
        ends,
        converged=np.array([s.converged and s.feasible for s in solutions], dtype=bool),
        saddle=np.array([s.saddle for s in solutions], dtype=bool),
        size=size,
        interrupted=interrupted,
    )


def cut_off(start: Array) -> Solution:
    """Return what stands for a start that Ctrl-C cut off."""
    return Solution(start, np.inf, np.inf, feasible=False, converged=False, message="interrupted")


def name_of(function: object) -> str:
    """Return what a solver or planner is called in results; a name is itself."""
    if isinstance(function, str):
        return function
    return str(
        getattr(function, "name", None) or getattr(function, "__name__", type(function).__name__)
    )


def error_about(function: object, message: str) -> InputError:
    """Return an error about a function of the user's own; it names the file that gave it."""
    located = getattr(function, "error", None)
    return located(message) if callable(located) else InputError(message, field=name_of(function))
