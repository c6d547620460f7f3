"""A GLB file read back: trimesh's tree of nodes, and the animation that it leaves out."""

from __future__ import annotations

import io
import json
import struct
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import trimesh
from scipy.interpolate import interp1d
from scipy.spatial.transform import Rotation, Slerp

from dualarm_pin.arrays import Array
from dualarm_pin.exports.glb.nodes import ROOT

_WIDTHS = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}


@dataclass(frozen=True, eq=False)
class ReadGlb:
    """A file that was read back.

    Attributes:
        scene: The tree as trimesh reads it.
        time: Times of the animation (m,) [s]; empty for a posture.
        turns: Rotation at a time of each node that turns.
        shifts: Position at a time of each node that is shifted.
    """

    scene: trimesh.Scene
    time: Array
    turns: Mapping[str, Callable[[float], Rotation]]
    shifts: Mapping[str, Callable[[float], Array]]

    @classmethod
    def of(cls, data: bytes) -> ReadGlb:
        """Read a file.

        Raises:
            ValueError: It is no GLB file of ours.
        """
        scene = trimesh.load_scene(io.BytesIO(data), file_type="glb")
        tree, binary = _chunks(data)
        read = cls(scene, np.zeros(0), turns := {}, shifts := {})
        for animation in tree.get("animations", ()):
            for channel in animation["channels"]:
                sampler, target = animation["samplers"][channel["sampler"]], channel["target"]
                if sampler["interpolation"] != "LINEAR":
                    raise ValueError(f"interpolation {sampler['interpolation']}")
                time = _values(tree, binary, sampler["input"])[:, 0]
                values = _values(tree, binary, sampler["output"])
                node = tree["nodes"][target["node"]]["name"]
                if target["path"] == "rotation":
                    turns[node] = Slerp(time, Rotation.from_quat(values))
                else:
                    shifts[node] = interp1d(time, values, axis=0)
                read = replace(read, time=time)
        return read

    def pose(self, time: float) -> None:
        """Let the scene stand as the animation has it at a time [s]."""
        time = min(time, self.time[-1]) if len(self.time) else 0.0
        for node in {*self.turns, *self.shifts}:
            parent = self.scene.graph.transforms.parents[node]
            matrix = np.array(self.scene.graph.get(node, parent)[0])
            if node in self.turns:
                matrix[:3, :3] = self.turns[node](time).as_matrix()
            if node in self.shifts:
                matrix[:3, 3] = self.shifts[node](time)
            self.scene.graph.update(frame_to=node, frame_from=parent, matrix=matrix)

    def node(self, name: str) -> Array:
        """Return the pose (4, 4) of a node in the cell."""
        return np.asarray(self.scene.graph.get(name, ROOT)[0])


def _chunks(data: bytes) -> tuple[dict[str, Any], bytes]:
    """Return the JSON and the numbers of a file."""
    length, _ = struct.unpack_from("<II", data, 12)
    tree: dict[str, Any] = json.loads(data[20 : 20 + length])
    return tree, data[28 + length :]


def _values(tree: Mapping[str, Any], binary: bytes, accessor: int) -> Array:
    about = tree["accessors"][accessor]
    start = tree["bufferViews"][about["bufferView"]].get("byteOffset", 0)
    width = _WIDTHS[about["type"]]
    single = np.frombuffer(binary, "<f4", about["count"] * width, start)
    return single.reshape(-1, width).astype(float)
