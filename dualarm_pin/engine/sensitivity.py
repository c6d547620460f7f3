"""How the best objective and the best joints change with shared parameters."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dualarm_pin.chain import Floats
from dualarm_pin.engine import entries
from dualarm_pin.engine.arrow_problem import arrow_problem
from dualarm_pin.engine.room import load_multipliers, new_room, widths
from dualarm_pin.errors import InputError
from dualarm_pin.placement.parameters import Free
from dualarm_pin.placement.shared import SharedProblem, share
from dualarm_pin.problem import Problem
from dualarm_pin.solution import Multipliers, Solution
from dualarm_pin.tolerance import TOLERANCE


@dataclass(frozen=True, eq=False)
class Sensitivity:
    """Derivatives of the optimal value V and of the optimal joints q* by p parameters.

    Attributes:
        names: The parameters (p).
        gradient: dV/dp (p,), per m or rad (envelope theorem).
        curvature: d2V/dp2 (p, p); nan where `regular` is False.
        joints: dq*/dp (p, k, n); nan likewise.
        regular: The joints are at a strict minimum, so that V has a second derivative.
    """

    names: tuple[str, ...]
    gradient: Floats
    curvature: Floats
    joints: Floats
    regular: bool

    def predicted(self, change: Floats) -> float:
        """Return the change of V for a change of the parameters (p,), to second order."""
        return float(self.gradient @ change + 0.5 * change @ self.curvature @ change)


def sensitivity(problem: Problem, best: Solution, free: tuple[Free, ...]) -> Sensitivity:
    """Differentiate a minimum by parameters; their boxes do not matter, their weights count.

    Args:
        problem: The problem that was solved, without shared columns.
        best: Its solution, with multipliers.
        free: Parameters, as `parameters.checked` returns them.

    Raises:
        InputError: The solution has no multipliers.
    """
    if best.multipliers is None:
        raise InputError("has no multipliers: solve with the compiled engine", field="best")
    shared = share(problem, free).scaled()
    assert isinstance(shared, SharedProblem)  # scaling keeps the class
    n, size = problem.n, problem.size
    work = new_room(shared)
    work.at.q[:] = shared.posture(best.q)
    load_multipliers(_beside(best.multipliers, shared.shared), work, size)
    whole = arrow_problem(shared, widths(shared))
    regular = bool(entries.differentiate(whole, work, TOLERANCE.bound))
    at, border = work.at, whole.border
    gradient = (
        work.gradient[:, n:].sum(axis=0)
        + np.einsum("ire,ir->e", work.jacobian[:, :, n:], at.y)
        - np.einsum("ire,ir->e", work.row_jacobian[:, :, n:], at.push)
    )
    lost = 1.0 if regular else np.nan
    return Sensitivity(
        names=tuple(each.name for each in free),
        gradient=size * gradient,
        curvature=size * lost * border.S,
        joints=lost * border.V,
        regular=regular,
    )


def _beside(found: Multipliers, columns: int) -> Multipliers:
    """Return multipliers with none for the bounds of shared columns."""
    zero = np.zeros((len(found.lower), columns))
    return Multipliers(
        found.equalities,
        np.hstack([found.lower, zero]),
        np.hstack([found.upper, zero]),
        found.inequalities,
    )
