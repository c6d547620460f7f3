"""The serial chain e1 -> base 1 -> base 2 -> e2 as plain arrays, read off a Pinocchio model.

The two arms are one chain: arm 1 is walked backwards (its axes change sign), arm 2 forwards.
Every element moves about or along its own z; whatever axis a joint has is folded into the fixed
placements between the elements. Joints that both arms hang on cancel and are left out.
"""

from __future__ import annotations

import weakref
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike, NDArray

from dualarm_pin.errors import InputError, ShapeError

if TYPE_CHECKING:
    from dualarm_pin.cell import Cell

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

VARIABLE, PARAMETER, CONSTANT = 0, 1, 2
REVOLUTE, PRISMATIC = 0, 1
_RIGID = 1e-9  # two poses of a frame in a segment differ by less if it moves with the segment


class Chain(NamedTuple):
    """Elements e = 0 .. E-1 between E+1 fixed placements; all arrays C-contiguous.

    Element e stands at scale[e] * x[source[e]] + offset[e], where x are the joint variables q
    (role VARIABLE) or the shared parameters (role PARAMETER); a CONSTANT stands at offset[e].
    Several elements may share one variable (mimic joints), and a variable may have none.

    Attributes:
        kind: (E,) REVOLUTE (radians about z) or PRISMATIC (metres along z).
        role: (E,) VARIABLE, PARAMETER or CONSTANT.
        source: (E,) column of q or of the parameters; 0 for a constant.
        scale: (E,).
        offset: (E,) rad or m.
        translation: (E+1, 3) m, fixed placement before element e; the last one leads to e2.
        quaternion: (E+1, 4) its rotation (w, x, y, z).
        parameters: (p,) values of the shared parameters.
        columns: (1,) number of variables n.
    """

    kind: Integers
    role: Integers
    source: Integers
    scale: Floats
    offset: Floats
    translation: Floats
    quaternion: Floats
    parameters: Floats
    columns: Integers


class Body(NamedTuple):
    """A frame that moves with one link of the chain.

    Attributes:
        segment: Number of elements between e1 and the link, 0 .. E.
        placement: Pose of the frame in the frame of that segment (`pin.SE3`).
    """

    segment: int
    placement: Any


class _Element(NamedTuple):
    placement: Any  # pin.SE3 from the element before
    kind: int
    axis: Floats
    role: int
    source: int
    scale: float
    offset: float


_CHAINS: weakref.WeakKeyDictionary[Cell, Chain] = weakref.WeakKeyDictionary()


def chain_of(cell: Cell) -> Chain:
    """Return the chain of a cell, read once."""
    if cell not in _CHAINS:
        _CHAINS[cell] = chain_from_model(
            cell.model, cell.e1, cell.e2, cell.joint_map, cell.joint_offset
        )
    return _CHAINS[cell]


def chain_from_model(
    model: Any,
    e1: int,
    e2: int,
    joint_map: ArrayLike | None = None,
    joint_offset: ArrayLike | None = None,
) -> Chain:
    """Read the chain between two frames off a Pinocchio model.

    Args:
        model: A pin.Model whose joints on the chain have one degree of freedom each.
        e1: Frame id of the first tool.
        e2: Frame id of the second tool.
        joint_map: (nv, n), joint values = joint_map @ q + joint_offset, ordered by `idx_v`;
            the identity if None.
        joint_offset: (nv,) rad or m; zeros if None.

    Raises:
        ShapeError: joint_map or joint_offset has another shape.
        InputError: A frame id does not exist, or a joint of the chain is neither revolute nor
            prismatic.
    """
    to_model, offset = _joint_values(model, joint_map, joint_offset)
    for name, frame in (("e1", e1), ("e2", e2)):
        if not 0 <= frame < model.nframes:
            raise InputError(f"frame id {frame} is not one of 0 .. {model.nframes - 1}", field=name)
    support1, support2 = _support(model, e1), _support(model, e2)
    common = len([1 for a, b in zip(support1, support2, strict=False) if a == b])
    elements: list[_Element] = []
    current = model.frames[e1].placement.inverse()
    for joint in reversed(support1[common:]):
        elements += _elements(model, joint, current, -1.0, to_model, offset)
        current = model.jointPlacements[joint].inverse()
    for joint in support2[common:]:
        placement = current * model.jointPlacements[joint]
        elements += _elements(model, joint, placement, 1.0, to_model, offset)
        current = pin.SE3.Identity()
    return _arrays(elements, current * model.frames[e2].placement, to_model.shape[1])


def segments(chain: Chain, q: ArrayLike) -> list[Any]:
    """Return the pose in e1 of every segment (`pin.SE3`, E+1 of them) at q (n,).

    Segment s lies behind s elements: 0 is the link that e1 is on, in the frame in which element 0
    moves, and E the link that e2 is on, in the frame of e2.
    """
    variables = np.asarray(q, dtype=np.float64)
    pose, found = pin.SE3.Identity(), []
    for e in range(len(chain.kind) + 1):
        if e > 0:
            pose = pose * _motion(chain, e - 1, variables)
        turn = pin.Quaternion(np.roll(chain.quaternion[e], -1))
        pose = pose * pin.SE3(turn, chain.translation[e])
        found.append(pose)
    return found


_BODIES: weakref.WeakKeyDictionary[Cell, dict[int, Body]] = weakref.WeakKeyDictionary()


def body_of(cell: Cell, frame: int) -> Body:
    """Find the link of the chain that a frame of the cell's model moves with.

    Args:
        cell: The two arms.
        frame: Frame id; 0 is the world.

    Raises:
        InputError: The frame moves with no link of the chain: a joint that moves both arms, or
            one that is off the chain, lies between.
    """
    known = _BODIES.setdefault(cell, {})  # each plane of each point of a path asks
    if frame not in known:
        known[frame] = _found_body(cell, frame)
    return known[frame]


def _found_body(cell: Cell, frame: int) -> Body:
    chain = chain_of(cell)
    draw = np.random.default_rng(0).uniform(-1.0, 1.0, (3, cell.n))
    seen = [_seen_from_segments(cell, chain, frame, q) for q in draw]
    for segment, first in enumerate(seen[0]):
        others = (other[segment].homogeneous - first.homogeneous for other in seen[1:])
        if all(np.abs(away).max() < _RIGID for away in others):
            return Body(segment, first)
    raise InputError(
        "moves with a joint that is not between the two tools, such as a common torso that was "
        "set free: lock that joint",
        field=cell.model.frames[frame].name,
    )


def _seen_from_segments(cell: Cell, chain: Chain, frame: int, q: Floats) -> list[Any]:
    model, data = cell.model, cell.data()
    pin.forwardKinematics(model, data, cell.model_q(q))
    in_e1 = pin.updateFramePlacement(model, data, cell.e1).actInv(
        pin.updateFramePlacement(model, data, frame)
    )
    return [segment.actInv(in_e1) for segment in segments(chain, q)]


def _motion(chain: Chain, e: int, q: Floats) -> Any:
    """Return what element e does to its frame at q (`pin.SE3`)."""
    value = chain.offset[e]
    if chain.role[e] != CONSTANT:
        values = q if chain.role[e] == VARIABLE else chain.parameters
        value += chain.scale[e] * values[chain.source[e]]
    if chain.kind[e] == REVOLUTE:
        return pin.SE3(pin.utils.rotate("z", float(value)), np.zeros(3))
    return pin.SE3(np.eye(3), np.array([0.0, 0.0, value]))


def quaternion_of(rotation: ArrayLike) -> Floats:
    """Return the unit quaternion (w, x, y, z) of a (3, 3) rotation matrix."""
    return np.roll(pin.Quaternion(np.asarray(rotation, dtype=np.float64)).coeffs(), 1)


def _joint_values(
    model: Any, joint_map: ArrayLike | None, joint_offset: ArrayLike | None
) -> tuple[Floats, Floats]:
    to_model = np.eye(model.nv) if joint_map is None else np.asarray(joint_map, dtype=np.float64)
    offset = (
        np.zeros(model.nv) if joint_offset is None else np.asarray(joint_offset, dtype=np.float64)
    )
    if to_model.ndim != 2 or to_model.shape[0] != model.nv:
        raise ShapeError(f"has shape {to_model.shape}, not ({model.nv}, n)", field="joint_map")
    if offset.shape != (model.nv,):
        raise ShapeError(f"has shape {offset.shape}, not ({model.nv},)", field="joint_offset")
    return to_model, offset


def _support(model: Any, frame: int) -> list[int]:
    """Return the joints from the root to a frame."""
    joint, joints = model.frames[frame].parentJoint, []
    while joint > 0:
        joints.append(joint)
        joint = model.parents[joint]
    return joints[::-1]


def _elements(
    model: Any, joint: int, placement: Any, sign: float, to_model: Floats, offset: Floats
) -> list[_Element]:
    """Return the elements of one joint: one per variable it follows, or one constant."""
    kind, axis = joint_axis(model, joint)
    row = model.joints[joint].idx_v
    start = float(offset[row])
    variables = np.flatnonzero(to_model[row])
    if not len(variables):
        return [_Element(placement, kind, sign * axis, CONSTANT, 0, 0.0, start)]
    elements = []
    for variable in variables:
        scale = float(to_model[row, variable])
        elements.append(
            _Element(placement, kind, sign * axis, VARIABLE, int(variable), scale, start)
        )
        placement, start = pin.SE3.Identity(), 0.0
    return elements


def joint_axis(model: Any, joint: int) -> tuple[int, Floats]:
    """Return kind and unit axis of a joint in its own frame."""
    joint_model = model.joints[joint]
    if joint_model.nv == 1:
        data = joint_model.createData()
        joint_model.calc(data, pin.neutral(model))
        subspace = np.asarray(data.S).reshape(6)
        linear, angular = subspace[:3], subspace[3:]
        if not linear.any():
            return REVOLUTE, angular
        if not angular.any():
            return PRISMATIC, linear
    raise InputError(
        f"is of type {joint_model.shortname()}: the engine takes revolute and prismatic joints; "
        "lock it or replace it by single joints",
        field=f"joint {model.names[joint]}",
    )


def _arrays(elements: list[_Element], last: Any, columns: int) -> Chain:
    """Turn every element's frame so that its axis is z, and pack the arrays."""
    placements, before = [], pin.SE3.Identity()
    for element in elements:
        turned = pin.SE3(turn_z_to(element.axis), np.zeros(3))
        placements.append(before.inverse() * element.placement * turned)
        before = turned
    placements.append(before.inverse() * last)
    return Chain(
        kind=np.array([e.kind for e in elements], dtype=np.int64),
        role=np.array([e.role for e in elements], dtype=np.int64),
        source=np.array([e.source for e in elements], dtype=np.int64),
        scale=np.array([e.scale for e in elements], dtype=np.float64),
        offset=np.array([e.offset for e in elements], dtype=np.float64),
        translation=np.array([p.translation for p in placements]),
        quaternion=np.array([quaternion_of(p.rotation) for p in placements]),
        parameters=np.zeros(0),
        columns=np.array([columns]),
    )


def turn_z_to(axis: Floats) -> Floats:
    """Return a rotation that takes z to a unit axis."""
    turn = pin.Quaternion.FromTwoVectors(np.array([0.0, 0.0, 1.0]), axis)
    return np.asarray(turn.toRotationMatrix())
