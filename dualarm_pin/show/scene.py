"""What a page shows: robots, path and answers, as data for its script."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np
import pinocchio as pin

from dualarm_pin.answer.trajectory import Trajectory
from dualarm_pin.arrays import Array
from dualarm_pin.cell import Cell
from dualarm_pin.clearance.asked import asked_of
from dualarm_pin.clearance.nearest import nearest_along
from dualarm_pin.clearance.rule import UNSAID
from dualarm_pin.errors import ShapeError
from dualarm_pin.meshes.triangles import triangles_of
from dualarm_pin.path import Path
from dualarm_pin.show.packing import Blob

if TYPE_CHECKING:
    from dualarm_pin.task import Task

_PLAIN = (0.72, 0.74, 0.77, 1.0)  # where the URDF names no colour


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

    def add(self, label: str, task: Task, trajectory: Trajectory) -> dict[str, Any]:
        """Add an answer; its cell and path are stored once however often they come.

        Args:
            label: Its name on the page, any text.
            task: What was asked.
            trajectory: The answer.

        Returns:
            The description of the run, to which a caller may add keys.

        Raises:
            ShapeError: The answer does not fit the cell or the path.
        """
        run = self.add_motion(label, task.cell, task.path, trajectory.q, trajectory.index)
        run["near"] = self._near(task, trajectory)
        return run

    def add_motion(
        self, label: str, cell: Cell, path: Path, q: Array, index: Array
    ) -> dict[str, Any]:
        """Add joints q (h, n) and their index (h,) that nobody checked, such as one posture.

        Raises:
            ShapeError: They do not fit the cell or the path.
        """
        for name, array, shape in (("q", q, (path.h, cell.n)), ("index", index, (path.h,))):
            if np.shape(array) != shape:
                raise ShapeError(
                    f"run {label!r}: {shape} is expected; given {np.shape(array)}", field=name
                )
        described = {
            "label": label,
            "cell": self._once("cells", cell, self.cell_of),
            "path": self._once("paths", path, self._path),
            "q": self.blob.add(q),
            "index": self.blob.add(index),
        }
        self.head["runs"].append(described)
        return described

    def _near(self, task: Task, trajectory: Trajectory) -> dict[str, Any] | None:
        """Return what is nearest along the motion; None where no two bodies can be compared.

        Bodies in each other are seen where nothing is asked too.
        """
        cell, asked = task.cell, asked_of(task)
        if cell.missing_meshes or trajectory.checked.clearance is None or len(trajectory.q) < 2:
            return None
        shown = asked if asked.any else asked_of(replace(task, clearance=UNSAID))
        found = nearest_along(cell, trajectory.q, shown.required)
        if found is None:
            return None
        numbers, which = np.unique(found.pair, return_inverse=True)
        bodies, ends = cell.collision.geometryObjects, cell.collision.collisionPairs
        return {
            "required": task.clearance.distance if task.clearance and asked.any else None,
            "distance": self.blob.add(found.distance),
            "first": self.blob.add(found.first),
            "second": self.blob.add(found.second),
            "which": which.tolist(),
            "pairs": [
                {
                    "names": list(cell.pairs[k]),
                    "joints": [
                        int(bodies[each].parentJoint) for each in (ends[k].first, ends[k].second)
                    ],
                }
                for k in map(int, numbers)
            ],
            "lacking": [list(bodies) for bodies in found.lacking],
        }

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

    def cell_of(self, cell: Cell) -> dict[str, Any]:
        """Return the description of a cell; its meshes are stored once."""
        model = cell.model
        frames = [f for f in model.frames if f.type == pin.FrameType.BODY]
        e1, e2 = model.frames[cell.e1], model.frames[cell.e2]
        return {
            "name": cell.name,
            "columns": [
                {"name": j.name, "kind": j.kind, "lower": j.lower, "upper": j.upper}
                for j in cell.joints
            ],
            "joints": _joints(cell),
            "frames": [_placed(f.name, f.parentJoint, f.placement) for f in frames],
            "e1": _placed("e1", e1.parentJoint, e1.placement),
            "e2": _placed("e2", e2.parentJoint, e2.placement),
            "bodies": [
                _placed(item.name, item.parentJoint, item.placement)
                | {"mesh": mesh, "kind": kind, "colour": colour_of(item), "of": _body_name(item)}
                for kind, geometry in (("visual", cell.visual), ("collision", cell.collision))
                for item in geometry.geometryObjects
                if (mesh := self._mesh(item, kind)) is not None
            ],
        }

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
    p, r = np.split(pin.SE3ToXYZQUAT(placement), [3])  # quaternion x, y, z, w
    return {"name": name, "joint": int(joint), "p": p.tolist(), "r": r.tolist()}


def _body_name(item: pin.GeometryObject) -> str:
    """Return the link or object that a shape belongs to: shapes of links are numbered."""
    name = str(item.name)
    return name.rsplit("_", 1)[0] if "/" in name else name


def colour_of(item: pin.GeometryObject) -> list[float]:
    """Return red, green, blue and opacity of a body, 0 to 1, as a screen counts them."""
    return [round(float(c), 4) for c in (item.meshColor if item.overrideMaterial else _PLAIN)]
