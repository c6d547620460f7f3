"""The animation of a GLB file: where each joint is when."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin

from dualarm_pin.arrays import Array
from dualarm_pin.exports.glb.nodes import Nodes

_FLOAT = 5126  # glTF's number for 32 bits
_MOVES = 1e-9  # m, or entries of a rotation: a joint that changes less stands still


def animate(
    buffers: dict[Any, bytes],
    tree: dict[str, Any],
    nodes: Nodes,
    time: Array,
    local: list[list[pin.SE3]],
) -> None:
    """Add an animation: turn and position of each joint that moves, straight between samples.

    Args:
        buffers: Numbers of the file by name, in order; some are added.
        tree: What the file says of them.
        nodes: The cell.
        time: Times of the samples (m,) [s].
        local: Pose of each joint in the one that carries it, at each sample.
    """

    def put(values: Array, kind: str) -> int:
        key = f"animation {len(buffers)}"
        single = values.astype("<f4")
        buffers[key] = single.tobytes()
        tree["accessors"][key] = {
            "bufferView": len(buffers) - 1, "componentType": _FLOAT, "type": kind,
            "count": len(single),
            "min": np.atleast_1d(single.min(axis=0)).tolist(),
            "max": np.atleast_1d(single.max(axis=0)).tolist(),
        }  # fmt: skip
        return len(tree["accessors"]) - 1

    places = {node["name"]: index for index, node in enumerate(tree["nodes"])}
    samplers: list[dict[str, Any]] = []
    channels: list[dict[str, Any]] = []
    times = put(time, "SCALAR")
    for joint, name in enumerate(nodes.joints):
        poses = np.array([pin.SE3ToXYZQUAT(row[joint]) for row in local])  # quaternion last
        turns, rest = _continuous(poses[:, 3:]), poses[0]
        node = tree["nodes"][places[name]]
        moving = {"rotation": (turns, "VEC4"), "translation": (poses[:, :3], "VEC3")}
        moving = {path: each for path, each in moving.items() if np.ptp(each[0], 0).max() > _MOVES}
        if moving:  # glTF allows no matrix there
            node.pop("matrix", None)
            node |= {"rotation": turns[0].tolist(), "translation": rest[:3].tolist()}
        for path, (values, kind) in moving.items():
            channels.append(
                {"sampler": len(samplers), "target": {"node": places[name], "path": path}}
            )
            samplers.append(
                {"input": times, "output": put(values, kind), "interpolation": "LINEAR"}
            )
    if channels:
        tree["animations"] = [{"name": "motion", "samplers": samplers, "channels": channels}]


def _continuous(quaternions: Array) -> Array:
    """Return quaternions (m, 4) with the signs for which neighbours are near."""
    signs = np.ones((len(quaternions), 1))
    for k in range(1, len(quaternions)):
        apart = float(quaternions[k] @ quaternions[k - 1]) < 0.0
        signs[k] = -signs[k - 1] if apart else signs[k - 1]
    return np.asarray(signs * quaternions)
