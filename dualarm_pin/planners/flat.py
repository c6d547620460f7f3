"""Which free parameters of a placement change nothing, and which stand at an end of their box."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from dualarm_pin.arrays import Array
from dualarm_pin.placement.asked import Asked
from dualarm_pin.planners.placed_motions import Place
from dualarm_pin.problem import Problem
from dualarm_pin.tolerance import TOLERANCE

_FLAT = 1e-5  # of max(1, objective): what a whole box of a flat direction may change it by
_AT_BOUND = 1e-4  # of its box: a parameter this near to an end stands there


def at_bound(place: Place, may: Asked) -> tuple[str, ...]:
    """Return the names of the parameters that stand at an end of their box."""
    found = []
    for each in may.free:
        near = _AT_BOUND * (each.upper - each.lower)
        value = place.change[each.name]
        if min(value - each.lower, each.upper - value) < near:
            found.append(each.name)
    return tuple(found)


def flat_directions(problem: Problem, best: Place, may: Asked) -> tuple[str, ...]:
    """Return the directions of the free parameters along which V has no curvature, in words.

    V has no slope either at a minimum, along parameters that stand inside their boxes.
    """
    from dualarm_pin.engine.sensitivity import sensitivity
    from dualarm_pin.engine.solve import Options, solve

    held = at_bound(best, may)
    inside = tuple(replace(each, weight=0.0) for each in may.free if each.name not in held)
    rough = solve(problem, best.q, Options(tolerance=TOLERANCE.polish, mu0=1e-4, push=1e-6))
    if not inside or not rough.converged:
        return ()
    found = sensitivity(problem, rough, inside)
    if not found.regular:
        return ()
    width = np.array([each.upper - each.lower for each in inside])
    bends, directions = np.linalg.eigh(found.curvature * np.outer(width, width))
    least = _FLAT * max(1.0, abs(best.objective))
    return tuple(
        _in_words(found.names, width * direction)
        for bend, direction in zip(bends, directions.T, strict=True)
        if abs(bend) < least
    )


def _in_words(names: tuple[str, ...], direction: Array) -> str:
    """Return a direction as changes of parameters, the largest of them 1."""
    direction = direction / direction[np.argmax(np.abs(direction))]
    parts = [
        f"{name} {share:+.3g}"
        for name, share in zip(names, direction, strict=True)
        if f"{share:.3f}" not in ("0.000", "-0.000")
    ]
    return " with ".join(parts)
