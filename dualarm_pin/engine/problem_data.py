"""Turn a stated problem into the engine's arrays, checked: what Python gives, numba takes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike, NDArray

from dualarm_pin.engine.chain import Chain, Floats, quaternion_of
from dualarm_pin.engine.index_calls import index_calls
from dualarm_pin.engine.layout import Points, Problem
from dualarm_pin.errors import InputError, ShapeError

if TYPE_CHECKING:
    from dualarm_pin.indices import Index

_FIXED_WIDTH = 1e-9  # bounds closer than this fix the variable at their middle


def problem_data(
    chain: Chain,
    index: Index,
    position: ArrayLike,
    rotation: ArrayLike,
    *,
    lower: ArrayLike,
    upper: ArrayLike,
    rows: ArrayLike | None = None,
    spin_axis: ArrayLike = (0.0, 0.0, 1.0),
    u: ArrayLike | None = None,
    link_weight: ArrayLike | None = None,
    metric: ArrayLike | None = None,
    index_weight: ArrayLike | None = None,
    linear: ArrayLike | None = None,
    before: ArrayLike | None = None,
    before_weight: float = 0.0,
    after: ArrayLike | None = None,
    after_weight: float = 0.0,
) -> Problem:
    """Return the arrays of min sum_i index_weight_i c(q_i) + linear_i . q_i + links.

    A link is weight * (dq^T diag(metric) dq)^2 (eq. 19 with its factor lambda); `before` and
    `after` are fixed postures linked to the first and the last point (eq. 20).

    Args:
        chain: From `chain_from_model`.
        index: What is minimised.
        position: (k, 3) m, targets of e2 in e1.
        rotation: (k, 3, 3) targets of e2 in e1.
        lower: (n,) rad or m; equal to `upper` for a variable that must not move.
        upper: (n,) rad or m.
        rows: (k,) pose rows of every point: 6 whole pose (default), 5 spin free, 3 position.
        spin_axis: (3,) axis in e2 whose spin is free where rows is 5.
        u: (k, 6) directions in e1; zeros if the index needs none.
        link_weight: (k-1,); zeros by default.
        metric: (n,) joint metric in the links, ones by default.
        index_weight: (k,), ones by default.
        linear: (k, n), zeros by default.
        before: (n,) fixed neighbour of the first point.
        before_weight: Weight of the link to it.
        after: (n,) fixed neighbour of the last point.
        after_weight: Weight of the link to it.

    Raises:
        ShapeError: An array has another shape.
        InputError: A value is not finite, bounds cross, or rows is not 6, 5 or 3.
    """
    n = int(chain.columns[0])
    position = np.ascontiguousarray(position, dtype=np.float64)
    if position.ndim != 2 or position.shape[1] != 3 or not len(position):
        raise ShapeError(f"has shape {position.shape}, not (k, 3)", field="position")
    k = len(position)
    position = _array("position", position, (k, 3))
    turned = _array("rotation", rotation, (k, 3, 3)) @ _axes_with_z(spin_axis)
    low, high, fixed, value = _bounds(_array("lower", lower, (n,)), _array("upper", upper, (n,)))
    half = 0.5 * (high - low)
    half[fixed] = np.inf
    kind, calls = index_calls(index)
    weights = _array("task_weights", index.task_weights, (6,), 1.0)
    if (weights < 0).any():
        raise InputError(f"has a negative weight: {weights.tolist()}", field="task_weights")
    return Problem(
        chain=_spin_frame(chain, spin_axis),
        points=Points(
            position=position,
            quaternion=np.array([quaternion_of(R) for R in turned]),
            target_axes=np.ascontiguousarray(turned.transpose(0, 2, 1)),
            rows=_rows(rows, k),
            u=_array("u", u, (k, 6)),
            index_weight=_array("index_weight", index_weight, (k,), 1.0),
            linear=_array("linear", linear, (k, n)),
            link_weight=np.append(_array("link_weight", link_weight, (k - 1,)), 0.0),
            end_weight=np.array(
                [
                    0.0 if before is None else float(before_weight),
                    0.0 if after is None else float(after_weight),
                ]
            ),
        ),
        index_kind=kind,
        calls=calls,
        task_scale=np.sqrt(weights),
        joint_weights=_array("joint_weights", index.joint_weights, (n,), 1.0),
        centre=0.5 * (low + high),
        centre_weight=index.joint_centre / half**2,
        lower=low,
        upper=high,
        fixed=fixed,
        fixed_value=value,
        metric=_array("metric", metric, (n,), 1.0),
        end=np.stack([_array("before", before, (n,)), _array("after", after, (n,))]),
        inequality=np.zeros((0, 12)),
    )


def _array(
    name: str, value: ArrayLike | None, shape: tuple[int, ...], default: float = 0.0
) -> Floats:
    """Return a C-contiguous finite array of that shape, a copy."""
    if value is None:
        return np.full(shape, default)
    array = np.array(value, dtype=np.float64, order="C")
    if array.shape != shape:
        raise ShapeError(f"has shape {array.shape}, not {shape}", field=name)
    if not np.isfinite(array).all():
        at = np.argwhere(~np.isfinite(array))[0].tolist()
        raise InputError(f"is not finite at {at}: {array[tuple(at)]}", field=name)
    return array


def _rows(rows: ArrayLike | None, k: int) -> NDArray[np.int64]:
    array = np.full(k, 6) if rows is None else np.array(rows, dtype=np.int64)
    if array.shape != (k,):
        raise ShapeError(f"has shape {array.shape}, not ({k},)", field="rows")
    if not np.isin(array, (6, 5, 3)).all():
        raise InputError(f"has {sorted(set(array.tolist()))}: allowed are 6, 5 and 3", field="rows")
    return array.astype(np.int64)


def _bounds(lower: Floats, upper: Floats) -> tuple[Floats, Floats, NDArray[np.int64], Floats]:
    """Return bounds for the barrier, and fixed columns with their values; those get value -+ 1."""
    if (lower > upper).any():
        at = int(np.argmax(lower > upper))
        raise InputError(
            f"column {at} has lower bound {lower[at]} above its upper bound {upper[at]}",
            field="lower",
        )
    fixed = np.flatnonzero(upper - lower < _FIXED_WIDTH)
    value = 0.5 * (lower[fixed] + upper[fixed])
    lower[fixed], upper[fixed] = value - 1.0, value + 1.0
    return lower, upper, fixed, value


def _axes_with_z(axis: ArrayLike) -> Floats:
    """Return a rotation whose z is the axis; the identity for z."""
    unit = _array("spin_axis", axis, (3,))
    length = np.linalg.norm(unit)
    if length < 1e-12:
        raise InputError("is the zero vector; give an axis in the e2 frame", field="spin_axis")
    turn = pin.Quaternion.FromTwoVectors(np.array([0.0, 0.0, 1.0]), unit / length)
    return np.asarray(turn.toRotationMatrix())


def _spin_frame(chain: Chain, axis: ArrayLike) -> Chain:
    """Return the chain with e2 turned so that its z is the spin axis."""
    last = pin.Quaternion(np.roll(chain.quaternion[-1], -1)).toRotationMatrix()
    quaternion = chain.quaternion.copy()
    quaternion[-1] = quaternion_of(last @ _axes_with_z(axis))
    return chain._replace(quaternion=quaternion)
