"""A problem with shared columns as the compiled engine reads it, with room for its border."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Annotated, NamedTuple

import numpy as np

from dualarm_pin.chain import Floats
from dualarm_pin.engine.workspace import Workspace, allocate, sizes_of
from dualarm_pin.placement.shared import SharedProblem
from dualarm_pin.problem import Problem


class Border(NamedTuple):
    """Room for what the p shared columns add to the system of k points and n joints."""

    V: Annotated[Floats, "p k n"]  # change of the joints by each shared value
    Y: Annotated[Floats, "p k m"]  # change of the multipliers of the equality rows
    S: Annotated[Floats, "p p"]  # Schur complement
    room: Annotated[Floats, "p p"]
    dp: Annotated[Floats, "p"]  # right-hand side and step
    shift: Annotated[Floats, "1"]  # that of the factors at hand
    step: Annotated[Floats, "k n"]  # step of the joints while the shared values stand
    inner: Workspace  # room for the columns of the joints


@dataclass(frozen=True, eq=False)
class ArrowProblem(SharedProblem):
    """The same problem, and its parts.

    Attributes:
        alone: The joints alone: widths of the links and fixed columns, nothing else is read.
        held: The problem with the shared columns fixed.
        border: Room.
    """

    alone: Problem
    held: Problem
    border: Border


def arrow_problem(problem: SharedProblem, rows: tuple[int, int, int]) -> ArrowProblem:
    """Return a problem with room.

    Args:
        problem: A problem with shared columns.
        rows: Equality rows, inequality rows a point at most, and different rows.
    """
    p = problem.shared
    n, elements = problem.n - p, len(problem.chain.kind)
    sizes = sizes_of(problem.k, elements, n, *rows) | {"p": p}
    parts = {part.name: getattr(problem, part.name) for part in fields(problem)}
    return ArrowProblem(
        **parts,
        alone=_of_joints(problem, n),
        held=problem.standing,
        border=allocate(Border, sizes),
    )


def _of_joints(problem: SharedProblem, n: int) -> Problem:
    parts = {part.name: getattr(problem, part.name) for part in fields(Problem)}
    metric = np.ascontiguousarray(problem.links.metric[:, :n])
    return Problem(**(parts | {"links": problem.links._replace(metric=metric)}))
