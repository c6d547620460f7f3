"""A cell as a tree of nodes: joints below joints, bodies below the joint that carries them."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from dualarm_pin.arrays import Array
from dualarm_pin.cell import Cell

ROOT = "cell"
TIPS = ("e1", "e2")
# glTF has y up and z towards the eye; a cell has z up.
UP = pin.SE3(pin.rpy.rpyToMatrix(-np.pi / 2, 0.0, 0.0), np.zeros(3))


@dataclass(frozen=True, eq=False)
class Body:
    """A node that a joint carries: a shape, or a tip.

    Attributes:
        name: Name of its node.
        joint: Joint of the model that carries it; 0 for what stands still.
        placement: Its pose at that joint.
        shape: What is drawn there; None for a tip.
    """

    name: str
    joint: int
    placement: pin.SE3
    shape: pin.GeometryObject | None


@dataclass(frozen=True, eq=False)
class Nodes:
    """The nodes of a cell, their names unlike each other.

    Attributes:
        cell: The two arms.
        joints: Node of each joint of the model; that of joint 0 is the root.
        bodies: What the joints carry, the two tips last.
    """

    cell: Cell
    joints: tuple[str, ...]
    bodies: tuple[Body, ...]

    @classmethod
    def of(cls, cell: Cell) -> Nodes:
        """Return the nodes of a cell: its bodies for the eye, or those for collisions."""
        shapes = list(cell.visual.geometryObjects) or list(cell.collision.geometryObjects)
        frames = [cell.model.frames[frame] for frame in (cell.e1, cell.e2)]
        names = iter(_unlike([ROOT, *cell.model.names[1:], *(s.name for s in shapes), *TIPS]))
        joints = tuple(next(names) for _ in cell.model.names)
        bodies = [Body(next(names), int(s.parentJoint), pin.SE3(s.placement), s) for s in shapes]
        bodies += [
            Body(next(names), int(f.parentJoint), pin.SE3(f.placement), None) for f in frames
        ]
        return cls(cell, joints, tuple(bodies))

    def joint_poses(self, q: Array) -> list[pin.SE3]:
        """Return the pose of each joint in the cell at q (n,)."""
        data = self.cell.data()
        pin.forwardKinematics(self.cell.model, data, self.cell.model_q(q))
        return [pin.SE3(pose) for pose in data.oMi]

    def local_poses(self, q: Array) -> list[pin.SE3]:
        """Return the pose of each joint in the one that carries it, at q (n,)."""
        poses, parents = self.joint_poses(q), self.cell.model.parents
        return [poses[parents[j]].actInv(pose) if j else pose for j, pose in enumerate(poses)]


def _unlike(names: Iterable[str]) -> Iterable[str]:
    """Return names, with a mark behind each that another has before it."""
    taken: set[str] = set()
    for name in names:
        while name in taken:
            name += "'"
        taken.add(name)
        yield name
