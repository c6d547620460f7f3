"""Put joints onto the path: a damped Gauss-Newton step a time, inside the bounds."""

from __future__ import annotations

import numpy as np

from dualarm_pin.arrays import Array
from dualarm_pin.problem import Problem
from dualarm_pin.reference import equalities, inequalities
from dualarm_pin.relative import Relative
from dualarm_pin.tolerance import TOLERANCE

# Marquardt (1963): the damping falls after a good step and grows after a bad one. The factors are
# habit, not tuned; below the least it is lost in rounding, above the most the step is too.
_FIRST, _LEAST, _MOST = 1e-3, 1e-14, 1e8
_EASED, _STIFFENED = 0.1, 8.0
_STIFF_FROM = 1e-8  # a bad step sets the damping to no less, or it would take many to be felt


def project_point(
    problem: Problem, i: int, q: Array, tolerance: float = TOLERANCE.on_path, iterations: int = 60
) -> tuple[Array, float]:
    """Move q towards the wanted pose of point i, keeping the bounds.

    Levenberg-Marquardt on the rows, inequalities by what they lack; joints that push against a
    bound are held there.

    Args:
        problem: The problem.
        i: Which of its points.
        q: Joints (n,).
        tolerance: Largest residual to stop at.
        iterations: Most steps.

    Returns:
        The joints (n,), and the largest residual there.
    """
    q = np.clip(q, problem.lower, problem.upper)
    residual, J = _lacking(problem, i, q)
    damping = _FIRST
    for _ in range(iterations):
        if np.max(np.abs(residual)) <= tolerance:
            break
        downhill = -J.T @ residual
        held = ((q <= problem.lower) & (downhill < 0)) | ((q >= problem.upper) & (downhill > 0))
        Jf = J * ~held
        pull = np.linalg.solve(Jf @ Jf.T + damping * np.eye(len(residual)), residual)
        trial = np.clip(q - Jf.T @ pull, problem.lower, problem.upper)
        trial_residual, trial_J = _lacking(problem, i, trial)
        if trial_residual @ trial_residual < residual @ residual:
            q, residual, J = trial, trial_residual, trial_J
            damping = max(damping * _EASED, _LEAST)
        elif damping > _MOST:
            break
        else:
            damping = max(damping * _STIFFENED, _STIFF_FROM)
    return q, float(np.max(np.abs(residual)))


def project(
    problem: Problem, q: Array, tolerance: float = TOLERANCE.on_path, iterations: int = 60
) -> tuple[Array, float]:
    """Move every point of q (k, n) to its pose; return it with the largest residual left.

    Where neighbours share one posture the next point goes on from the one just found, so that a
    common posture ends in one branch of the path and not in several.
    """
    projected: list[Array] = []
    worst = 0.0
    for i, q_i in enumerate(q):
        shared = i > 0 and np.array_equal(q_i, q[i - 1])
        found, residual = project_point(
            problem, i, projected[-1] if shared else q_i, tolerance, iterations
        )
        projected.append(found)
        worst = max(worst, residual)
    return np.array(projected), worst


def _lacking(problem: Problem, i: int, q: Array) -> tuple[Array, Array]:
    """Return what the rows of point i lack (m_i + r_i,) and its Jacobian."""
    relative = Relative(problem.cell, q)
    residual, J = equalities(problem, i, relative)
    if not problem.inequalities.size[i]:
        return residual, J
    gap, slopes = inequalities(problem, i, relative)
    short = gap < 0.0
    return np.append(residual, gap * short), np.vstack([J, slopes * short[:, None]])
