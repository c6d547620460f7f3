"""What the clearance rule of a task comes to on its cell and path, before any joints are chosen."""

from __future__ import annotations

import weakref
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from dualarm_pin.arrays import Array
from dualarm_pin.cell.parts import Pair
from dualarm_pin.clearance.hands import HandRoute, hand_routes
from dualarm_pin.clearance.rule import ClearanceRule, keeps
from dualarm_pin.tolerance import TOLERANCE

if TYPE_CHECKING:
    from dualarm_pin.cell import Cell
    from dualarm_pin.task import Task

_POSTURES = 200  # random ones; a distance that none of them reaches is not asked of an arm's links
_SPARED = 1e-3  # m; what a free spin may change in a distance that counts as fixed


@dataclass(frozen=True, eq=False)
class FixedPair:
    """Two bodies whose distance the path itself fixes.

    Attributes:
        pair: The two bodies.
        distance: How far apart they are at each point (h,) [m].
    """

    pair: Pair
    distance: Array

    @property
    def text(self) -> str:
        """Between which distances they stay, as a sentence without its end."""
        low, high = np.min(self.distance), np.max(self.distance)
        return f"{' and '.join(self.pair)} stay within {low:.3f} to {high:.3f} m on this path"


@dataclass(frozen=True)
class ForbiddenPair:
    """A distance that is asked for and that no motion of the joints can keep.

    Attributes:
        pair: The two bodies.
        required: What is asked for [m].
        point: A point of the path, from 0, where it cannot be kept.
        distance: The most that is possible there [m].
        text: The whole finding as a sentence.
    """

    pair: Pair
    required: float
    point: int
    distance: float
    text: str


@dataclass(frozen=True, eq=False)
class Asked:
    """What is asked of the pairs of a cell.

    Attributes:
        required: Distance that each pair of `Cell.pairs` must keep (p,) [m]; -inf for nothing.
            (0,) where nothing is asked of any pair, or bodies are missing.
        fixed: Pairs whose distance the path itself fixes.
        lowered: Pairs of bodies of one arm that come nowhere as far apart as is asked of every
            pair: they are asked not to touch; and the most they reach [m].
        forbidden: What no motion of the joints can keep: the task has no answer.
    """

    required: Array
    fixed: tuple[FixedPair, ...] = ()
    lowered: tuple[tuple[Pair, float], ...] = ()
    forbidden: tuple[ForbiddenPair, ...] = ()

    @property
    def any(self) -> bool:
        """Whether anything is asked of any pair."""
        return bool(np.any(self.required > -np.inf))


_ASKED: weakref.WeakKeyDictionary[Task, Asked] = weakref.WeakKeyDictionary()


def asked_of(task: Task) -> Asked:
    """Return what the clearance rule of a task asks for; nothing where bodies are missing."""
    if task not in _ASKED:
        _ASKED[task] = _asked(task)
    return _ASKED[task]


def _asked(task: Task) -> Asked:
    cell, rule = task.cell, task.clearance
    if rule is None or cell.missing_meshes or not cell.pairs:
        return Asked(np.zeros(0))
    routes = tuple(hand_routes(cell, task.path))
    fixed = fixed_pairs(routes)
    held = {each.pair for each in fixed}
    required = np.array([_or_less(rule.required(p, fixed=p in held)) for p in cell.pairs])
    lowered = _out_of_reach(cell, rule, required)
    for pair, most in lowered:
        required[[each == pair for each in cell.pairs]] = 0.0 if most > 0.0 else -np.inf
    return Asked(required, fixed, lowered, tuple(_forbidden(routes, required)))


def fixed_pairs(routes: Iterable[HandRoute]) -> tuple[FixedPair, ...]:
    """Return the pairs whose distance the path fixes; of several shapes the nearest ones count."""
    found: dict[Pair, Array] = {}
    loose: set[Pair] = set()
    for route in routes:
        pair = route.cell.pairs[route.number]
        if route.joint or pair in loose:
            continue
        held = _held(route)
        if held is None:
            loose.add(pair)
        else:
            found[pair] = np.minimum(found.get(pair, np.inf), held)
    return tuple(FixedPair(pair, d) for pair, d in found.items() if pair not in loose)


def _held(route: HandRoute) -> Array | None:
    """Return the distance (h,) [m] that a path fixes, None at the first point where it does not."""
    nearest = np.empty(route.path.h)
    for i in range(route.path.h):
        seen = [route.distance(i, value) for value in route.values]
        nearest[i] = min(seen)
        if max(seen) - nearest[i] > _SPARED:
            return None
    return nearest


def _or_less(required: float | None) -> float:
    return -np.inf if required is None else required


def _out_of_reach(
    cell: Cell, rule: ClearanceRule, required: Array
) -> tuple[tuple[Pair, float], ...]:
    """Return the pairs of one arm that never are as far apart as is asked of every pair.

    What an arm carries belongs to it.
    """
    if not rule.distance:
        return ()
    own = ~cell.apart_by_nature & (required == rule.distance)
    own &= [(pair not in rule.pairs and pair[::-1] not in rule.pairs) for pair in cell.pairs]
    draw = np.random.default_rng(0).uniform(cell.lower, cell.upper, (_POSTURES, cell.n))
    most = np.max([cell.distances(q) for q in draw], axis=0)
    found: dict[Pair, float] = {}
    for k in np.flatnonzero(own & (most < rule.distance)):
        found[cell.pairs[k]] = min(found.get(cell.pairs[k], np.inf), float(most[k]))
    return tuple(found.items())


def _forbidden(routes: Sequence[HandRoute], required: Array) -> tuple[ForbiddenPair, ...]:
    """Return for each pair the worst point at which the path forbids what is asked."""
    worst: dict[Pair, ForbiddenPair] = {}
    for route in routes:
        pair, wanted = route.cell.pairs[route.number], float(required[route.number])
        if wanted == -np.inf:
            continue
        enough = max(wanted - TOLERANCE.clearance, 0.0)
        middle = float(route.values[len(route.values) // 2])
        near = np.flatnonzero(route.apart() <= wanted)
        seen = np.array([route.distance(i, middle) for i in near.tolist()])
        order = np.argsort(seen)
        for distance, i in zip(seen[order].tolist(), near[order].tolist(), strict=True):
            if keeps(distance, wanted):
                break
            most = route.most(i, enough)
            if most is not None:
                if pair not in worst or most < worst[pair].distance:
                    worst[pair] = ForbiddenPair(
                        pair, wanted, i, most, _finding(route, wanted, i, most)
                    )
                break
    return tuple(worst.values())


def _finding(route: HandRoute, required: float, point: int, most: float) -> str:
    who, where = " and ".join(route.cell.pairs[route.number]), f"at point {point + 1}"
    never = f"the {required:g} m asked for cannot be kept by any joint motion"
    if route.free:
        return f"{who} are at most {most:.3f} m apart {where} of this path: {never}"
    seen = [route.distance(i, 0.0, exact=True) for i in range(route.path.h)]
    return (
        f"{who} stay within {min(seen):.3f} to {max(seen):.3f} m on this path, {most:.3f} m "
        f"{where}: {never}"
    )
