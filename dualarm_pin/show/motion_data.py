"""What a page shows of a motion: time and shares of the limits at every point of the path."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from dualarm_pin.arrays import Array
from dualarm_pin.cell import Cell
from dualarm_pin.motion.record import Motion
from dualarm_pin.path import Path
from dualarm_pin.relative import relative_motion
from dualarm_pin.show.packing import Blob

_UNKNOWN = np.nan


def motion_data(blob: Blob, cell: Cell, path: Path, q: Array, motion: Motion) -> dict[str, Any]:
    """Return the description of a motion along a path of h points.

    Shares are the largest between the middles of the links before and after each point.

    Args:
        blob: Where the arrays go.
        cell: The two arms.
        path: The path.
        q: Joints at its points (h, n).
        motion: The motion along it.
    """
    at = np.interp(path.arc_length, motion.arc_length, motion.time)
    middle = 0.5 * (path.arc_length[1:] + path.arc_length[:-1])
    owner = np.searchsorted(middle, motion.arc_length)
    speeds = _limits(cell, "velocity")
    shares = {"speed_share": np.abs(motion.velocity) / speeds}
    if motion.torque is not None:
        shares["torque_share"] = np.abs(motion.torque) / _limits(cell, "effort")
    return {
        "law": motion.law.replace("_", " "),
        "duration": motion.duration,
        "feed": motion.summary.feed,
        "time": blob.add(at),
        "held_by": list(motion.summary.held_by) or [""] * path.h,
        **{name: blob.add(_largest(share, owner, path.h)) for name, share in shares.items()},
    }


def tip_traces(blob: Blob, cell: Cell, q: Array) -> list[Any]:
    """Return where both tips are in the world (h, 3) [m], e1 first."""
    places = [
        [relative_motion(cell, 0, frame, q_i)[0].translation for q_i in q]
        for frame in (cell.e1, cell.e2)
    ]
    return [blob.add(np.array(place)) for place in places]


def _limits(cell: Cell, word: str) -> Array:
    return np.array([getattr(joint, word) or _UNKNOWN for joint in cell.joints], dtype=float)


def _largest(values: Array, owner: NDArray[np.intp], h: int) -> Array:
    """Return the largest value (h, k) of the samples that each point owns; the last if none."""
    found = np.full((h, values.shape[1]), -np.inf)
    np.maximum.at(found, owner, values)
    for i in range(1, h):
        if np.isneginf(found[i]).all():
            found[i] = found[i - 1]
    return found
