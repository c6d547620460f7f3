"""The paper's pair of NS16, its corner path, and motions to look at: made with Pinocchio alone."""

import json
import pathlib
from functools import cache
from types import SimpleNamespace

import numpy as np
import pinocchio as pin

from dualarm_pin.files.resources import urdf_folder
from dualarm_pin.path import Path

TABLE_I = np.radians([[-60, -45, -150, -90, -90, -90], [60, 90, 45, 90, 90, 90]])


@cache
def pair() -> SimpleNamespace:
    folder = urdf_folder() / "ns16"
    urdf = str(folder / "ns16.urdf")
    base2 = pin.SE3(np.diag([-1.0, -1.0, 1.0]), np.array([2.5, 0, 0]))

    def arm(prefix, kind):
        model = pin.buildModelFromUrdf(urdf)
        geometry = pin.buildGeomFromUrdf(model, urdf, kind, package_dirs=[str(folder)])
        for k in range(1, model.njoints):
            model.names[k] = prefix + model.names[k]
        for frame in model.frames:
            frame.name = prefix + frame.name
        for item in geometry.geometryObjects:
            item.name = prefix + item.name
            if kind == pin.GeometryType.COLLISION:
                item.geometry.buildConvexHull(False, "Qt")
                item.geometry = item.geometry.convex
        return model, geometry

    def both(kind):
        (m1, g1), (m2, g2) = arm("arm1/", kind), arm("arm2/", kind)
        return pin.appendModel(m1, m2, g1, g2, 0, base2)

    model, visual = both(pin.GeometryType.VISUAL)
    _, collision = both(pin.GeometryType.COLLISION)
    lower, upper = np.tile(TABLE_I, 2)
    names = tuple(model.names[k] for k in range(1, model.njoints))
    joints = tuple(
        SimpleNamespace(name=n, arm=n[:4], kind="revolute", continuous=False, lower=a, upper=b)
        for n, a, b in zip(names, lower, upper, strict=True)
    )
    return SimpleNamespace(
        name="ns16_pair", model=model, visual=visual, collision=collision,
        e1=model.getFrameId("arm1/flange"), e2=model.getFrameId("arm2/flange"),
        joints=joints, joint_names=names, lower=lower, upper=upper, n=12, sources=(), warnings=(),
        joint_map=np.eye(12), joint_offset=np.zeros(12), missing_meshes=(),
    )  # fmt: skip


def corner(side=0.15, radius=0.01, counts=(13, 5, 13)) -> Path:
    a, b, c = counts
    straight, turn = side - radius, np.pi / 2 * np.arange(1, b + 1) / (b + 1)
    x = np.concatenate(
        [np.full(a, side), straight + radius * np.cos(turn), straight * np.linspace(1, 0, c)]
    )
    y = np.concatenate(
        [straight * np.linspace(0, 1, a), straight + radius * np.sin(turn), np.full(c, side)]
    )
    tangent = np.zeros((a + b + c, 3))
    tangent[:a, 1], tangent[a + b :, 0] = 1, -1
    tangent[a : a + b, 0], tangent[a : a + b, 1] = -np.sin(turn), np.cos(turn)
    position = np.column_stack([x, y, np.full(len(x), 0.3)])
    return Path(position, np.diag([1.0, -1, -1]), tangent=tangent, name="corner")


def relative(cell, q):
    """Return T_e1_e2 and J_r (6, n) in e1 axes."""
    data = cell.model.createData()
    pin.computeJointJacobians(cell.model, data, q)
    pin.updateFramePlacements(cell.model, data)
    tip1, tip2 = data.oMf[cell.e1], data.oMf[cell.e2]
    T = tip1.inverse() * tip2
    J1 = pin.getFrameJacobian(cell.model, data, cell.e1, pin.LOCAL)
    J2 = pin.getFrameJacobian(cell.model, data, cell.e2, pin.LOCAL)
    body = J2 - T.inverse().toActionMatrix() @ J1
    return T, np.vstack([T.rotation @ body[:3], T.rotation @ body[3:]])


@cache
def motions():
    """Return three local optima of the corner (objectives 12.73, 14.54 and about 40).

    Each is q (31, 12), which meets the path to 1e-7, and its index (31,).
    """
    cell, path = pair(), corner()
    listed = json.loads((pathlib.Path(__file__).parent / "data" / "ns16_motions.json").read_text())
    return tuple(
        (q, np.array([_index(cell, x, t) for x, t in zip(q, path.tangent, strict=True)]))
        for q in np.array(listed)
    )


def _index(cell, q, tangent):
    return float(np.sum((relative(cell, q)[1][:3].T @ tangent) ** 2))
