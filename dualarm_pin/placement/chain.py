"""A chain with elements for shared parameters, and rows that know where they went."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from dualarm_pin.chain import (
    CONSTANT,
    PARAMETER,
    REVOLUTE,
    VARIABLE,
    Chain,
    body_of,
    chain_of,
    quaternion_of,
    turn_z_to,
)
from dualarm_pin.placement.parameters import BASE, ELEMENTS, TOOL, WORKPIECE

if TYPE_CHECKING:
    from dualarm_pin.cell import Cell

Array = NDArray[np.float64]
Integers = NDArray[np.int64]


class Insertion(NamedTuple):
    """Elements that go in before one element of a chain.

    Attributes:
        at: That element; E for the end.
        frame: Frame in which they move, seen from the segment that ends there (`pin.SE3`).
        names: Their parameters, in order.
    """

    at: int
    frame: Any
    names: tuple[str, ...]

    @property
    def elements(self) -> int:
        """How many elements: the parameters, and a constant that keeps the segment before them."""
        return len(self.names) + 1


def insertions(cell: Cell, chain: Chain, names: tuple[str, ...]) -> tuple[Insertion, ...]:
    """Return where the elements of parameters go in, in the order of the chain.

    Args:
        cell: The two arms.
        chain: Its chain, e2 turned as a problem wants it.
        names: Parameters, in the order of `ELEMENTS`.
    """
    end = len(chain.kind)
    groups = {
        group: tuple(name for name in names if name.startswith(f"{group}."))
        for group in (WORKPIECE, BASE, TOOL)
    }
    found = []
    if groups[WORKPIECE]:
        found.append(Insertion(0, _fixed(chain, 0).inverse(), groups[WORKPIECE]))
    if groups[BASE]:
        world = body_of(cell, 0)
        stands = pin.SE3(np.eye(3), cell.arms[1].base.translation)
        found.append(Insertion(world.segment, world.placement * stands, groups[BASE]))
    if groups[TOOL]:
        # The tool points along an axis of e2, which the problem may have turned.
        turned = _fixed(chain_of(cell), end).rotation.T @ _fixed(chain, end).rotation
        frame = pin.SE3(turned.T @ turn_z_to(cell.tool_axes[1]), np.zeros(3))
        found.append(Insertion(end, frame, groups[TOOL]))
    return tuple(found)


def with_elements(
    chain: Chain, places: tuple[Insertion, ...], values: Array | None = None
) -> Chain:
    """Return the chain with an element for every parameter.

    Where all of them are zero it stands as before.

    Args:
        chain: The chain.
        places: Where elements go in.
        values: (p,) where the parameters stand; if None each is a variable, after the joints.
    """
    n = int(chain.columns[0]) if values is None else 0
    role = VARIABLE if values is None else PARAMETER
    fixed = [_fixed(chain, e) for e in range(len(chain.kind) + 1)]
    turns = list(chain.quaternion)
    rows = {name: list(getattr(chain, name)) for name in _PER_ELEMENT}
    column = last = n + sum(len(place.names) for place in places)
    for place in reversed(places):  # from the end, so that earlier positions stay
        column -= len(place.names)
        before, new = place.frame, [fixed[place.at]]
        elements = [_element(REVOLUTE, CONSTANT, 0, 0.0)]
        for k, name in enumerate(place.names):
            kind, axis = ELEMENTS[name]
            turned = pin.SE3(turn_z_to(axis), np.zeros(3))
            new.append(before * turned)
            before = turned.inverse()
            elements.append(_element(kind, role, column + k, 1.0))
        new.append(before * place.frame.inverse())
        fixed[place.at : place.at + 1] = new
        turns[place.at : place.at + 1] = _same_sign(new, turns[place.at])
        for name in _PER_ELEMENT:
            rows[name][place.at : place.at] = [element[name] for element in elements]
    return Chain(
        **{name: np.array(rows[name], dtype=getattr(chain, name).dtype) for name in rows},
        translation=np.array([pose.translation for pose in fixed]),
        quaternion=np.array(turns),
        parameters=np.zeros(0) if values is None else values.copy(),
        columns=np.array([last]) if values is None else chain.columns,
    )


def moved_segments(
    segments: Integers, frames: Integers, cell: Cell, places: tuple[Insertion, ...]
) -> Integers:
    """Return the segments of the bodies of rows in the chain with elements.

    A segment is parted where elements go in; what stands on arm 2's side of them moves along.

    Args:
        segments: Segment of every body in the old chain.
        frames: Its frame id in the model.
        cell: The two arms.
        places: Where elements went in.
    """
    moved = segments.copy()
    for place in places:
        behind = segments > place.at
        at = segments == place.at
        if place.names[0].startswith(WORKPIECE):
            behind |= at
        elif place.names[0].startswith(TOOL):
            behind |= at & (frames == cell.e2)
        else:
            behind |= at & np.isin(frames, _standing_on_base2(cell))
        moved[behind] += place.elements
    return moved


def _standing_on_base2(cell: Cell) -> list[int]:
    """Return the frames that move when arm 2's base does, all joints at rest."""
    base = cell.arms[1].base
    there = cell.moved(base2=pin.SE3(base.rotation, base.translation + 1.0)).model
    pairs = zip(cell.model.frames, there.frames, strict=True)
    return [
        k
        for k, (a, b) in enumerate(pairs)
        if a.parentJoint == 0 and not a.placement.isApprox(b.placement)
    ]


def _same_sign(poses: list[Any], whole: Array) -> list[Array]:
    """Return quaternions whose product is `whole`, not its negative: multipliers follow it."""
    turns = [quaternion_of(pose.rotation) for pose in poses]
    product = pin.Quaternion.Identity()
    for turn in turns:
        product = product * pin.Quaternion(np.roll(turn, -1))
    if np.roll(product.coeffs(), 1) @ whole < 0.0:
        turns[-1] = -turns[-1]
    return turns


_PER_ELEMENT = ("kind", "role", "source", "scale", "offset")


def _element(kind: int, role: int, source: int, scale: float) -> dict[str, float]:
    return dict(zip(_PER_ELEMENT, (kind, role, source, scale, 0.0), strict=True))


def _fixed(chain: Chain, e: int) -> Any:
    """Return the fixed placement before element e (`pin.SE3`)."""
    return pin.SE3(pin.Quaternion(np.roll(chain.quaternion[e], -1)), chain.translation[e])
