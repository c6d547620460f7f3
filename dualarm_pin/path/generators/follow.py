"""From points on a curve to a path: how the tool is held and which components are free."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, TypeAlias, TypedDict, get_args

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from dualarm_pin.arrays import Array, rotations
from dualarm_pin.errors import InputError, nearest
from dualarm_pin.path.generators.curve import Samples, sample
from dualarm_pin.path.generators.piece import Piece
from dualarm_pin.path.path import POSITION_ONLY, SPIN_FREE, WHOLE_POSE, Path
from dualarm_pin.tolerance import TOLERANCE

Orientation: TypeAlias = Literal["constant", "tangent", "normal", "normal_tangent"]
Free: TypeAlias = Literal["none", "spin", "rotation"]

FACING: tuple[tuple[float, ...], ...] = ((1.0, 0.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, -1.0))
"""The paper's rotation: the tools face each other, z of e2 against z of e1."""

ROWS: dict[Free, int] = {"none": WHOLE_POSE, "spin": SPIN_FREE, "rotation": POSITION_ONLY}

# 1 + cosine of two directions; nearer, the smallest turn between them is lost in rounding.
_OPPOSITE = 1e-9


class Hold(TypedDict, total=False):
    """How the tool is held along a curve: what every generator takes.

    Attributes:
        rotation: Axes of the tool frame e2 in e1, shape (3, 3); the paper's by default.
        orientation: What the tool does along the curve:
            "constant": it keeps `rotation`;
            "tangent": x along the curve, z as near to the z of `rotation` as that allows;
            "normal": z into the surface, by the shortest turn from `rotation`;
            "normal_tangent": z into the surface, x along the curve.
        free: "none", "spin" (about `spin_axis`) or "rotation" (position only); one for all points
            or one for each.
        spin_axis: Axis in e2, shape (3,); its z by default.
        frame: Pose in e1 of the frame in which curve and tool are drawn; moves the whole path.
        name: What the path is called.
    """

    rotation: ArrayLike
    orientation: Orientation
    free: Free | Sequence[Free]
    spin_axis: ArrayLike
    frame: pin.SE3
    name: str


class Follow(Hold, total=False):
    """`Hold`, and how many points there are.

    Attributes:
        points: Number of points, both ends included; or
        step: Largest distance of neighbours along the curve [m].
    """

    points: int | None
    step: float | None


def follow(pieces: Sequence[Piece], default_name: str, how: Follow) -> Path:
    """Return the path along a curve, evenly by arc length between its corners.

    Raises:
        InputError: Something in `how` is wrong; the field says what.
    """
    samples = sample(pieces, points=how.get("points"), step=how.get("step"))
    return hold(samples, default_name, how)


def hold(
    samples: Samples,
    default_name: str,
    how: Hold,
    *,
    rotation: Array | None = None,
    u: Array | None = None,
) -> Path:
    """Return the path through points on a curve.

    Args:
        samples: The points.
        default_name: Name where `how` gives none.
        how: How the tool is held.
        rotation: The rotations where they are known already, shape (h, 3, 3).
        u: The directions where they are not the tangents, shape (h, 6).

    Raises:
        InputError: Something in `how` is wrong; the field says what.
    """
    if rotation is None:
        R = rotations(how.get("rotation", FACING), (1, 3, 3))[0]
        rotation = _orient(samples, R, how.get("orientation", "constant"))
    path = Path(
        samples.position,
        rotation,
        u=u,
        rows=rows(how.get("free", "none"), len(samples.position)),
        spin_axis=how.get("spin_axis", (0.0, 0.0, 1.0)),
        tangent=samples.tangent,
        arc_length=samples.arc_length,
        name=how.get("name", default_name),
    )
    frame = how.get("frame")
    return path if frame is None else path.moved(frame)


def rows(free: Free | Sequence[Free], h: int) -> list[int]:
    """Return the constrained components of each of `h` points.

    Raises:
        InputError: Another word, or a list of another length.
    """
    words = [free] * h if isinstance(free, str) else list(free)
    if len(words) != h:
        message = f"one word, or one for each of the {h} points; given {len(words)}"
        raise InputError(message, field="free")
    for i, word in enumerate(words):
        if word not in ROWS:
            raise InputError(f"point {i + 1}: {word!r}: {nearest(word, ROWS)}", field="free")
    return [ROWS[word] for word in words]


def _orient(samples: Samples, R: Array, orientation: Orientation) -> Array:
    """Return the axes of the tool at each point, shape (h, 3, 3)."""
    h = len(samples.position)
    if orientation == "constant":
        return np.broadcast_to(R, (h, 3, 3)).copy()
    if orientation == "tangent":
        return _axes(samples.tangent, np.broadcast_to(R[:, 2], (h, 3)))
    if orientation not in ("normal", "normal_tangent"):
        message = f"{orientation!r} is unknown: {nearest(orientation, get_args(Orientation))}"
        raise InputError(message, field="orientation")
    if samples.normal is None:
        message = f"{orientation!r} needs a surface, and this curve lies on none: use tangent"
        raise InputError(message, field="orientation")
    z = -samples.normal
    if orientation == "normal_tangent":
        along = samples.tangent - np.sum(samples.tangent * z, axis=1, keepdims=True) * z
        return _axes(along / np.linalg.norm(along, axis=1, keepdims=True), z)
    return _shortest(np.asarray(R[:, 2]), z) @ R


def _axes(x: Array, z: Array) -> Array:
    """Return rotations whose x is `x` and whose z is as near to `z` as that allows."""
    y = np.cross(z, x)
    length = np.linalg.norm(y, axis=1)
    parallel = np.flatnonzero(length < TOLERANCE.parallel)
    if len(parallel):
        raise InputError(
            f"point {parallel[0] + 1}: the curve runs along the tool's z: its x cannot follow it; "
            "give another `rotation`",
            field="orientation",
        )
    y = y / length[:, None]
    return np.stack([x, y, np.cross(x, y)], axis=2)


def _shortest(start: Array, stop: Array) -> Array:
    """Return the rotations by the smallest angle from unit `start` (3,) to each unit `stop`."""
    cosine = stop @ start
    opposite = np.flatnonzero(cosine < -1.0 + _OPPOSITE)
    if len(opposite):
        raise InputError(
            f"point {opposite[0] + 1}: the surface faces the tool from behind, so the turn from "
            "`rotation` is not unique; give another `rotation`",
            field="orientation",
        )
    skew = np.cross(np.cross(start, stop)[:, None], np.eye(3)).transpose(0, 2, 1)
    return np.asarray(np.eye(3) + skew + skew @ skew / (1.0 + cosine)[:, None, None])
