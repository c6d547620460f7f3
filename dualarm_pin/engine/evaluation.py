"""The problem at given postures: values, rows and derivatives, as the engine computes them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from dualarm_pin.arrays import checked
from dualarm_pin.chain import Floats
from dualarm_pin.engine import entries
from dualarm_pin.engine.room import new_room, set_calls
from dualarm_pin.engine.workspace import new_scratch
from dualarm_pin.problem import Problem


@dataclass(frozen=True, eq=False)
class Evaluation:
    """Values and derivatives at q (k, n), as the engine computes them.

    Attributes:
        objective: The problem's objective.
        values: (k,) per point: weighted index and linear term, no links.
        residual: (k, m) equality rows.
        jacobian: (k, m, n) of these.
        gap: (k, r) inequality rows.
        row_jacobian: (k, r, n) of these.
        gradient: (k, n) of the objective.
        hessian: (k, n, n) diagonal blocks of the Hessian of objective + y . residual - push . gap.
        link: (k, n) diag(metric) dq of the link after each point.
        stiffness: (k,) of that link: the block (i+1, i) of the Hessian is
            -(stiffness_i diag(metric) + 8 link_weight_i link_i link_i^T).
        J_r: (k, 6, n) relative Jacobian [linear; angular] of e2 with respect to e1, in e1.
    """

    objective: float
    values: Floats
    residual: Floats
    jacobian: Floats
    gap: Floats
    row_jacobian: Floats
    gradient: Floats
    hessian: Floats
    link: Floats
    stiffness: Floats
    J_r: Floats


def evaluate(
    problem: Problem, q: ArrayLike, y: ArrayLike = 0.0, push: ArrayLike = 0.0
) -> Evaluation:
    """Evaluate the problem at q (k, n) with multipliers y (k, m) and push (k, r) of its rows.

    Raises:
        ShapeError: An array has another shape.
        InputError: A value is not finite.
    """
    work = new_room(problem)
    at = work.at
    at.q[:] = checked("q", q, at.q.shape)
    at.y[:] = checked("y", y, at.y.shape)
    at.push[:] = checked("push", push, at.push.shape)
    values, J_r = np.zeros(problem.k), np.zeros((problem.k, 6, problem.n))
    total = entries.evaluate(problem, work, values, J_r)
    return Evaluation(
        objective=total,
        values=values,
        residual=work.residual,
        jacobian=work.jacobian,
        gap=work.gap,
        row_jacobian=work.row_jacobian,
        gradient=work.gradient,
        hessian=work.hessian,
        link=work.link,
        stiffness=work.stiffness,
        J_r=J_r,
    )


def gaps(problem: Problem, q: ArrayLike) -> Floats:
    """Return the inequality rows (k, r) at q (k, n), without derivatives; 0 beyond a point's own.

    Raises:
        ShapeError: q has another shape.
        InputError: A value is not finite.
    """
    postures = checked("q", q, (problem.k, problem.n))
    values = np.zeros(problem.inequalities.kind.shape)
    scratch = new_scratch(len(problem.chain.kind), problem.n, len(problem.rows))
    set_calls(problem, scratch)
    entries.gaps(problem, scratch, postures, values)
    return values
