"""The data of one problem as contiguous arrays.

All values are run-time data: another robot, index, path, bound or weight compiles nothing.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dualarm_pin.engine.by_reference import by_reference
from dualarm_pin.engine.chain import Chain, Floats, Integers
from dualarm_pin.engine.compiled import compiled

# index_kind: the fast path, or phi and its derivatives by address (the number goes with the call)
FORCE, VELOCITY, YOSHIKAWA, CONDITION, SMALLEST, CUSTOM = 0, 1, 2, 3, 4, 5


@by_reference
class Points(NamedTuple):
    """What differs from point to point.

    The pose is resolved in axes of e2 turned so that the spin axis is their z.

    Attributes:
        position: (k, 3) m, target of e2 in e1.
        quaternion: (k, 4) target (w, x, y, z).
        target_axes: (k, 3, 3) transposed target rotation.
        rows: (k,) 6, 5 or 3 pose rows.
        u: (k, 6) directions in e1.
        index_weight: (k,).
        linear: (k, n).
        link_weight: (k,) of the link after each point; the last one is not used.
        end_weight: (2,) weights of the links to the fixed ends, 0 for none.
    """

    position: Floats
    quaternion: Floats
    target_axes: Floats
    rows: Integers
    u: Floats
    index_weight: Floats
    linear: Floats
    link_weight: Floats
    end_weight: Floats


@by_reference
class Problem(NamedTuple):
    """min sum_i index_weight_i c(q_i) + linear_i . q_i + links, s.t. pose rows and bounds.

    A link between neighbours is weight * (dq^T diag(metric) dq)^2; the ends are links to fixed
    postures before the first and after the last point.

    Attributes:
        chain: The chain from e1 to e2.
        points: Targets, directions and weights.
        index_kind: FORCE to CUSTOM.
        calls: (3,) addresses of phi, gradient and curvature (0 for FORCE).
        task_scale: (6,) square roots of the task weights.
        joint_weights: (n,) diagonal of W.
        centre: (n,) middle of the bounds.
        centre_weight: (n,) weight of (q - centre)^2, with the index.
        lower: (n,) rad or m; a fixed variable has a harmless interval around its value.
        upper: (n,).
        fixed: (f,) columns that must not move.
        fixed_value: (f,) where they stand.
        metric: (n,).
        end: (2, n) fixed neighbours before and after.
        inequality: (r, 12) inequality rows of every point: none yet.
    """

    chain: Chain
    points: Points
    index_kind: int
    calls: Integers
    task_scale: Floats
    joint_weights: Floats
    centre: Floats
    centre_weight: Floats
    lower: Floats
    upper: Floats
    fixed: Integers
    fixed_value: Floats
    metric: Floats
    end: Floats
    inequality: Floats


def room_for_window(points: Points, k: int) -> Points:
    """Return points of the same kind with room for k of them."""
    room = {
        name: np.zeros((k, *array.shape[1:]), dtype=array.dtype)
        for name, array in points._asdict().items()
    }
    return Points(**(room | {"end_weight": np.zeros(2)}))


@compiled
def load_window(whole: Points, first: int, window: Points) -> None:
    """Fill a window with neighbouring points; a fixed end counts where the path ends."""
    count, total = window.position.shape[0], whole.position.shape[0]
    for i in range(count):
        at = first + i
        for c in range(3):
            window.position[i, c] = whole.position[at, c]
            for r in range(3):
                window.target_axes[i, c, r] = whole.target_axes[at, c, r]
        for c in range(4):
            window.quaternion[i, c] = whole.quaternion[at, c]
        for c in range(6):
            window.u[i, c] = whole.u[at, c]
        for c in range(whole.linear.shape[1]):
            window.linear[i, c] = whole.linear[at, c]
        window.rows[i] = whole.rows[at]
        window.index_weight[i] = whole.index_weight[at]
        window.link_weight[i] = whole.link_weight[at]
    window.end_weight[0] = whole.end_weight[0] if first == 0 else 0.0
    window.end_weight[1] = whole.end_weight[1] if first + count == total else 0.0
