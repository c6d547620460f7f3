"""A problem over a path whose last columns are shared by all points."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from dualarm_pin.placement.chain import Insertion, insertions, moved_segments, with_elements
from dualarm_pin.placement.parameters import Free
from dualarm_pin.problem import Problem
from dualarm_pin.rows.table import RowTable

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class SharedProblem(Problem):
    """A problem whose last columns have one value for all points; made by `share`.

    In a posture of every point the shared columns follow the joints, and all points agree on them.
    They are counted from where the cell stands, and no link weighs them.

    Attributes:
        shared: How many.
    """

    shared: int

    @property
    def joints(self) -> int:
        """Number of columns before the shared ones."""
        return self.n - self.shared

    @cached_property
    def standing(self) -> SharedProblem:
        """The same problem with the shared columns where a start has them."""
        values = np.full(self.shared, np.nan)
        bounds = self.bounds._replace(
            fixed=np.append(self.bounds.fixed, np.arange(self.joints, self.n)),
            fixed_value=np.append(self.bounds.fixed_value, values),
        )
        return replace(self, bounds=bounds)

    def posture(self, q: Array, values: Array | float = 0.0) -> Array:
        """Return joints (..., k, n) with the shared values (..., p) beside them."""
        given = np.broadcast_to(values, (*q.shape[:-2], self.shared))
        beside = np.repeat(given[..., None, :], q.shape[-2], axis=-2)
        return np.concatenate([q, beside], axis=-1)


def share(problem: Problem, free: tuple[Free, ...]) -> SharedProblem:
    """Return a problem with free parameters, checked by `parameters.checked`, as shared columns."""
    p = len(free)
    names = tuple(each.name for each in free)
    places = insertions(problem.cell, problem.chain, names)
    lower = np.array([each.lower for each in free])
    upper = np.array([each.upper for each in free])
    weight = np.array([each.weight for each in free])
    total = max(float(problem.points.index_weight.sum()), np.finfo(float).tiny)
    terms, bounds = problem.terms, problem.bounds
    parts = {part.name: getattr(problem, part.name) for part in fields(Problem)}
    return SharedProblem(
        **parts
        | {
            "lower": np.append(problem.lower, lower),
            "upper": np.append(problem.upper, upper),
            "chain": with_elements(problem.chain, places),
            "points": problem.points._replace(linear=_wide(problem.points.linear, p)),
            "links": problem.links._replace(metric=_wide(problem.links.metric, p)),
            "neighbours": problem.neighbours._replace(posture=_wide(problem.neighbours.posture, p)),
            "terms": terms._replace(
                joint_weights=np.append(terms.joint_weights, np.zeros(p)),
                centre=np.append(terms.centre, np.zeros(p)),
                centre_weight=np.append(terms.centre_weight, weight / total),
            ),
            "bounds": bounds._replace(
                lower=np.append(bounds.lower, lower), upper=np.append(bounds.upper, upper)
            ),
            "equalities": _moved(problem.equalities, problem, places),
            "inequalities": _moved(problem.inequalities, problem, places),
        },
        shared=p,
    )


def placed(problem: Problem, free: tuple[Free, ...], values: Array) -> Problem:
    """Return the problem with its parameters (p,) standing elsewhere; its cell stays as it is.

    The values are `chain.parameters`: they can be changed in place, and nothing is built again.
    """
    places = insertions(problem.cell, problem.chain, tuple(each.name for each in free))
    return replace(
        problem,
        chain=with_elements(problem.chain, places, values),
        equalities=_moved(problem.equalities, problem, places),
        inequalities=_moved(problem.inequalities, problem, places),
    )


def _moved(table: RowTable, problem: Problem, places: tuple[Insertion, ...]) -> RowTable:
    if not table.kind.shape[1]:
        return table
    frames = np.array([row.frames(problem.cell) for row in problem.rows])[table.source]
    return table._replace(
        first=moved_segments(table.first, frames[..., 0], problem.cell, places),
        second=moved_segments(table.second, frames[..., 1], problem.cell, places),
    )


def _wide(array: Array, columns: int) -> Array:
    return np.hstack([array, np.zeros((len(array), columns))])
