"""What a search for a placement may change: free parameters, their boxes, areas to keep out of."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from dualarm_pin.errors import InputError
from dualarm_pin.placement.parameters import BASE, Free, checked

if TYPE_CHECKING:
    from dualarm_pin.cell import Cell

Array = NDArray[np.float64]
Box = tuple[float, float]


@dataclass(frozen=True)
class Area:
    """A rectangle of the floor, in the world, in which the origin of base 2 must not stand."""

    x: Box
    y: Box


@dataclass(frozen=True)
class Asked:
    """Free parameters in the order of the chain, counted from where the cell stands.

    Attributes:
        free: The parameters and their boxes.
        keep_out: Areas of the floor.
        origin: Where base 2 stands on the floor (x, y) before any change [m].
    """

    free: tuple[Free, ...]
    keep_out: tuple[Area, ...]
    origin: Box

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the parameters."""
        return tuple(each.name for each in self.free)

    @property
    def lower(self) -> Array:
        """Lower ends of the boxes (p,)."""
        return np.array([each.lower for each in self.free])

    @property
    def upper(self) -> Array:
        """Upper ends (p,)."""
        return np.array([each.upper for each in self.free])

    def change(self, values: Array) -> dict[str, float]:
        """Return the values (p,) by name."""
        return dict(zip(self.names, map(float, values), strict=True))

    def floor(self, values: Array) -> tuple[float, float]:
        """Return where base 2 then stands on the floor (x, y) [m]."""
        change = self.change(values)
        x, y = self.origin
        return x + change.get(f"{BASE}.x", 0.0), y + change.get(f"{BASE}.y", 0.0)

    def kept_out(self, values: Array) -> bool:
        """Tell whether the values (p,) put base 2 strictly inside an area."""
        return self.inside_area(*self.floor(values))

    def inside_area(self, x: float, y: float) -> bool:
        """Tell whether a place on the floor [m] lies strictly inside an area."""
        return any(a.x[0] < x < a.x[1] and a.y[0] < y < a.y[1] for a in self.keep_out)

    def room_around(self, values: Array) -> tuple[Free, ...]:
        """Return the parameters in a box that holds the values (p,) and meets no area.

        Of the sides of an area the values lie beyond, the box ends at the farthest one. The union
        of such boxes over all values is everything outside the areas.
        """
        free = {each.name: each for each in self.free}
        at = dict(zip(("x", "y"), self.floor(values), strict=True))
        origin = dict(zip(("x", "y"), self.origin, strict=True))
        for area in self.keep_out:
            gaps = {}
            for axis, (low, high) in (("x", area.x), ("y", area.y)):
                gaps[axis, "upper"], gaps[axis, "lower"] = low - at[axis], at[axis] - high
            axis, side = max(gaps, key=lambda key: gaps[key])
            name = f"{BASE}.{axis}"
            if name not in free:
                continue
            each, edge = free[name], getattr(area, axis)[side == "lower"] - origin[axis]
            inside = max(each.lower, edge) if side == "lower" else min(each.upper, edge)
            free[name] = replace(each, **{side: inside})
        return tuple(free.values())


def asked(
    cell: Cell,
    boxes: Mapping[str, Box],
    *,
    keep_out: tuple[Area, ...] = (),
    weights: Mapping[str, float] | None = None,
) -> Asked:
    """Return what may change, checked against a cell.

    Args:
        cell: The two arms.
        boxes: From and to of every free parameter [m or rad]: those of base 2 in the world, those
            of the workpiece and of the tool from where they are. See `parameters.ELEMENTS`.
        keep_out: Areas of the floor.
        weights: Of (change)^2 in the objective, by parameter.

    Raises:
        UnknownNameError: There is no such parameter.
        InputError: Nothing is free, a box is crossed, the cell does not have a parameter, or no
            place is left outside the areas.
    """
    if not boxes:
        raise InputError("nothing is free: name a parameter and its box", field="placement")
    weights = weights or {}
    stands = standing(cell)
    free = checked(
        tuple(_from_here(name, box, stands, weights.get(name, 0.0)) for name, box in boxes.items()),
        cell,
    )
    for name in weights:
        if name not in boxes:
            raise InputError("has a weight and is not free", field=f"placement.{name}")
    found = Asked(free, keep_out, (stands[f"{BASE}.x"], stands[f"{BASE}.y"]))
    for area in keep_out:
        if area.x[0] >= area.x[1] or area.y[0] >= area.y[1]:
            raise InputError("a corner is not below the other", field="placement.keep_out")
    draw = np.random.default_rng(0).uniform(found.lower, found.upper, (2000, len(free)))
    if all(found.kept_out(values) for values in draw):
        raise InputError(
            "the areas leave no place for base 2 inside its box", field="placement.keep_out"
        )
    return found


def standing(cell: Cell) -> dict[str, float]:
    """Return where base 2 stands, by parameter; the others are counted from 0."""
    base = cell.arms[1].base
    place = dict(zip((f"{BASE}.x", f"{BASE}.y", f"{BASE}.z"), base.translation, strict=True))
    return {**place, f"{BASE}.yaw": float(pin.rpy.matrixToRpy(base.rotation)[2])}


def _from_here(name: str, box: Box, stands: Mapping[str, float], weight: float) -> Free:
    here = stands.get(name, 0.0)
    if name == f"{BASE}.yaw" and np.isfinite(box).all():
        turns = np.round((0.5 * (box[0] + box[1]) - here) / (2.0 * np.pi))
        here += 2.0 * np.pi * turns
    return Free(name, box[0] - here, box[1] - here, weight)
