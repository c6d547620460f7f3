"""What a page shows: robots, path and runs, as data for its script."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pinocchio as pin

from dualarm_pin.arrays import Array
from dualarm_pin.cell import Cell
from dualarm_pin.errors import InputError, ShapeError
from dualarm_pin.meshes.triangles import triangles_of
from dualarm_pin.path import Path
from dualarm_pin.show.binary import Blob

_PLAIN = (0.72, 0.74, 0.77, 1.0)  # where the URDF names no colour


@dataclass(frozen=True, eq=False)
class Run:
    """One motion to look at.

    Attributes:
        label: Its name on the page.
        q: Joints in the columns of the cell, shape (h, n) [rad or m].
        index: Index at each path point, shape (h,).
    """

    label: str
    q: Array
    index: Array


@dataclass(eq=False)
class Scene:
    """A growing page: cells, paths and runs that share their meshes.

    Attributes:
        blob: The arrays.
        head: The description that the script reads.
    """

    blob: Blob = field(default_factory=Blob)
    head: dict[str, Any] = field(
        default_factory=lambda: {"meshes": [], "cells": [], "paths": [], "runs": []}
    )
    _meshes: dict[tuple[object, ...], int | None] = field(default_factory=dict)
    _known: dict[int, tuple[object, int]] = field(default_factory=dict)

    def add_run(self, cell: Cell, path: Path, run: Run) -> dict[str, Any]:
        """Add one run; its cell and path are stored once however often they come.

        Returns:
            The description of the run, to which a caller may add keys.

        Raises:
            ShapeError: The run does not fit the cell or the path.
            InputError: The run holds a value that is not a finite number.
        """
        q, index = np.asarray(run.q, dtype=float), np.asarray(run.index, dtype=float)
        for name, array, shape in (("q", q, (path.h, cell.n)), ("index", index, (path.h,))):
            if array.shape != shape:
                raise ShapeError(
                    f"run {run.label!r}: {shape} is expected; given {array.shape}", field=name
                )
        if not np.isfinite(q).all():
            raise InputError(f"run {run.label!r} has joints that are not finite", field="q")
        described = {
            "label": run.label,
            "cell": self._once("cells", cell, self._cell),
            "path": self._once("paths", path, self._path),
            "q": self.blob.add(q),
            "index": self.blob.add(index),
        }
        self.head["runs"].append(described)
        return described

    def pack(self) -> bytes:
        """Return everything as the bytes that the script unpacks."""
        return self.blob.pack(self.head)

    def _once(self, kind: str, thing: Any, describe: Any) -> int:
        # The thing itself is kept, so that its id cannot be given to another one.
        if id(thing) not in self._known:
            self.head[kind].append(describe(thing))
            self._known[id(thing)] = (thing, len(self.head[kind]) - 1)
        return self._known[id(thing)][1]

    def _path(self, path: Path) -> dict[str, Any]:
        return {
            "name": path.name,
            "position": self.blob.add(path.position),
            "u": self.blob.add(path.u),
            "arc_length": self.blob.add(path.arc_length),
        }

    def _cell(self, cell: Cell) -> dict[str, Any]:
        model = cell.model
        frames = [f for f in model.frames if f.type == pin.FrameType.BODY]
        bodies = [
            body
            for kind, geometry in (("visual", cell.visual), ("collision", cell.collision))
            for item in geometry.geometryObjects
            if (body := self._body(item, kind)) is not None
        ]
        return {
            "name": cell.name,
            "columns": [
                {"name": j.name, "kind": j.kind, "lower": j.lower, "upper": j.upper}
                for j in cell.joints
            ],
            "joints": _joints(cell),
            "frames": [_placed(f.name, f.parentJoint, f.placement) for f in frames],
            "e1": _placed("e1", model.frames[cell.e1].parentJoint, model.frames[cell.e1].placement),
            "e2": _placed("e2", model.frames[cell.e2].parentJoint, model.frames[cell.e2].placement),
            "bodies": bodies,
        }

    def _body(self, item: pin.GeometryObject, kind: str) -> dict[str, Any] | None:
        mesh = self._mesh(item, kind)
        if mesh is None:
            return None
        colour = item.meshColor if item.overrideMaterial else _PLAIN
        placed = _placed(item.name, item.parentJoint, item.placement)
        return placed | {"mesh": mesh, "kind": kind, "colour": [round(float(c), 4) for c in colour]}

    def _mesh(self, item: pin.GeometryObject, kind: str) -> int | None:
        key: tuple[object, ...] = (kind, item.meshPath, *map(float, item.meshScale))
        if not item.meshPath:
            key = (item.name, len(self._meshes))
        if key not in self._meshes:
            surface = triangles_of(item.geometry)
            self._meshes[key] = None if surface is None else len(self.head["meshes"])
            if surface is not None:
                wide = "u2" if len(surface.corners) < 65536 else "u4"
                self.head["meshes"].append(
                    {
                        "corners": self.blob.add(surface.corners, "u2"),
                        "faces": self.blob.add(surface.faces, wide),
                        "origin": surface.origin.tolist(),
                        "step": surface.step.tolist(),
                    }
                )
        return self._meshes[key]


def build_scene(cell: Cell, path: Path, runs: Sequence[Run]) -> Scene:
    """Return the scene of several runs of one cell along one path.

    Raises:
        InputError: There is no run, or one is not finite.
        ShapeError: A run does not fit the cell or the path.
    """
    if not runs:
        raise InputError("there is no run to show", field="runs")
    scene = Scene()
    for run in runs:
        scene.add_run(cell, path, run)
    return scene


def _joints(cell: Cell) -> list[dict[str, Any]]:
    model = cell.model
    data = model.createData()
    pin.computeJointJacobians(model, data, pin.neutral(model))
    joints = []
    for j in range(1, model.njoints):
        v = model.joints[j].idx_v
        motion = pin.getJointJacobian(model, data, j, pin.ReferenceFrame.LOCAL)[:, v]
        turns = bool(np.any(motion[3:]))
        columns = np.flatnonzero(cell.joint_map[v])
        joints.append(
            _placed(model.names[j], int(model.parents[j]), model.jointPlacements[j])
            | {
                "turns": turns,
                "axis": (motion[3:] if turns else motion[:3]).tolist(),
                "map": [[int(c), float(cell.joint_map[v, c])] for c in columns],
                "offset": float(cell.joint_offset[v]),
            }
        )
    return joints


def _placed(name: str, joint: int, placement: pin.SE3) -> dict[str, Any]:
    quaternion = pin.Quaternion(placement.rotation).coeffs()  # x, y, z, w
    return {
        "name": name,
        "joint": int(joint),
        "p": placement.translation.tolist(),
        "r": quaternion.tolist(),
    }
