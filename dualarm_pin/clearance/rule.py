"""How far apart the bodies of a cell must stay."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any

from dualarm_pin.cell.parts import Pair
from dualarm_pin.errors import InputError, UnknownNameError, nearest
from dualarm_pin.files.numbers import LARGEST
from dualarm_pin.tolerance import TOLERANCE


@dataclass(frozen=True)
class ClearanceRule:
    """What a task asks of the distances between bodies; None in its place asks nothing.

    Attributes:
        distance: What every pair must keep [m], 0 for no collision; None for nothing.
        pairs: What single pairs must keep instead [m], None for nothing; two bodies each, as the
            cell names them (`arm1/<link>` or the name of an object), in any order.
        between_points: It must hold between the points of the path too.
        spare_fixed: `distance` is not asked of pairs whose distance the path itself fixes, such as
            a tool at work on its part.

    Raises:
        InputError: A distance is negative or not finite, or a pair names one body twice.
    """

    distance: float | None = 0.0
    pairs: Mapping[Pair, float | None] = field(default_factory=dict)
    between_points: bool = True
    spare_fixed: bool = False

    def __post_init__(self) -> None:
        if self.distance is not None:
            checked_distance(self.distance, "clearance.required")
        for (first, second), distance in self.pairs.items():
            place = f"clearance.pairs.{first} {second}"
            if first == second:
                raise InputError("names one body twice: give two", field=place)
            if (second, first) in self.pairs:
                raise InputError("stands twice, in both orders: give it once", field=place)
            if distance is not None:
                checked_distance(distance, place)
        object.__setattr__(self, "pairs", MappingProxyType(dict(self.pairs)))

    def required(self, pair: Pair, *, fixed: bool = False) -> float | None:
        """Return the distance that a pair must keep [m], or None if it is not asked for.

        Args:
            pair: Two bodies, in any order.
            fixed: The path itself fixes their distance.
        """
        for key in (pair, pair[::-1]):
            if key in self.pairs:
                return self.pairs[key]
        return None if fixed and self.spare_fixed else self.distance

    def check_names(self, bodies: Iterable[str]) -> None:
        """Refuse a pair of which the cell has not both bodies.

        Raises:
            UnknownNameError: The message names the nearest body.
        """
        known = tuple(bodies)
        for first, second in self.pairs:
            for body in (first, second):
                if body not in known:
                    message = f"no body {body!r} in this cell: {nearest(body, known)}"
                    raise UnknownNameError(message, field=f"clearance.pairs.{first} {second}")

    def __reduce__(self) -> tuple[type[ClearanceRule], tuple[object, ...]]:
        """A read-only mapping cannot be sent to another process, its content can."""
        return ClearanceRule, (
            self.distance,
            dict(self.pairs),
            self.between_points,
            self.spare_fixed,
        )


def keeps(distance: float, required: float) -> bool:
    """Tell whether a distance is enough; contact counts as a collision."""
    return distance > 0.0 and distance >= required - TOLERANCE.clearance


def checked_distance(value: Any, place: str | None = None) -> float:
    """Return a distance [m] that may be asked for.

    Raises:
        InputError: It is not a number, not finite or negative.
    """
    if isinstance(value, bool) or not isinstance(value, int | float) or not 0.0 <= value <= LARGEST:
        message = f"a distance in metres, 0 or more, or off is expected; given {value!r}"
        raise InputError(message, field=place)
    return float(value)


UNSAID = ClearanceRule(spare_fixed=True)  # of a task that says nothing
