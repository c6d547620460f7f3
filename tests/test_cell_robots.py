"""Every robot of the tables loads as a cell, and is the robot that Pinocchio itself loads."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest
from robot_table import NAMES, SINGLE, TWIN, arguments, needs_robots
from test_relative import derivative_difference, difference

from dualarm_pin.cell import Cell
from dualarm_pin.files.resources import urdf_folder
from dualarm_pin.relative import Relative
from dualarm_pin.robot.packages import find_file, robot_data_share

pytestmark = needs_robots
BASE2 = pin.SE3(pin.rpy.rpyToMatrix(0.1, -0.2, 3.0), np.array([1.2, 0.3, 0.1]))


def load(name: str) -> Cell:
    urdfs, options, _ = arguments(name)
    return Cell.from_urdf(*urdfs, base2=BASE2 if len(urdfs) == 2 else None, **options)


@pytest.mark.parametrize("name", NAMES)
def test_loads_with_exact_jacobian_and_derivative(name: str) -> None:
    cell = load(name)
    assert cell.n == arguments(name)[2]
    assert cell.model.nq == cell.model.nv
    assert np.isfinite(cell.lower).all()
    assert (cell.lower < cell.upper).all()
    rng = np.random.default_rng(0)
    for _ in range(3):
        q = rng.uniform(cell.lower, cell.upper)
        at = Relative(cell, q)
        np.testing.assert_allclose(at.J_r, difference(cell, q), atol=1e-8)
        np.testing.assert_allclose(at.dJ_r, derivative_difference(cell, q), atol=1e-8)


def original(file: str) -> pin.Model:
    """Return the URDF as Pinocchio reads it by itself: nothing locked, nothing renamed."""
    return pin.buildModelFromUrdf(str(file))


def original_q(
    model: pin.Model, cell: Cell, q: np.ndarray, robot: int, prefixes: tuple
) -> np.ndarray:
    """Return the same posture in the original model, joint by joint."""
    placed = cell._robots[robot]
    values = dict(placed.roles.values)
    values |= {
        name.partition("/")[2]: value
        for name, value in zip(cell.joint_names, q, strict=True)
        if name.partition("/")[0] in prefixes
    }
    full = pin.neutral(model)
    for index in range(1, model.njoints):
        joint, value = model.joints[index], values[model.names[index]]
        if joint.nq == 2:
            full[joint.idx_q : joint.idx_q + 2] = np.cos(value), np.sin(value)
        else:
            full[joint.idx_q] = value
    return full


@pytest.mark.parametrize("name", NAMES)
def test_every_link_stands_where_pinocchio_puts_it(name: str) -> None:
    cell = load(name)
    q = np.random.default_rng(3).uniform(cell.lower, cell.upper)
    data = cell.data()
    pin.framesForwardKinematics(cell.model, data, cell.model_q(q))
    urdfs = arguments(name)[0]
    for number in range(len(urdfs)):
        file = find_file(urdfs[number], urdf_folder())
        model = original(file)
        arms = ("arm1", "arm2", "common") if len(urdfs) == 1 else (f"arm{number + 1}",)
        theirs = model.createData()
        pin.framesForwardKinematics(model, theirs, original_q(model, cell, q, number, arms))
        base = BASE2 if number else pin.SE3.Identity()
        placed = cell._robots[number]
        for link, frame in placed.frames.items():
            ours = data.oMf[cell.model.getFrameId(frame, pin.FrameType.BODY)]
            there = base * theirs.oMf[model.getFrameId(link, pin.FrameType.BODY)]
            np.testing.assert_allclose(ours.homogeneous, there.homogeneous, atol=1e-12)


@pytest.mark.parametrize("name", ["ur5", "z1", "baxter", "pr2", "icub", "romeo_small"])
def test_bodies_stand_where_pinocchio_puts_them(name: str) -> None:
    cell = load(name)
    q = np.random.default_rng(4).uniform(cell.lower, cell.upper)
    urdfs = arguments(name)[0]
    model = original(find_file(urdfs[0], urdf_folder()))
    file = str(find_file(urdfs[0], urdf_folder()))
    kind = pin.GeometryType.COLLISION
    geometry = pin.buildGeomFromUrdf(model, file, kind, package_dirs=[str(robot_data_share())])
    arms = ("arm1", "common", "arm2") if len(urdfs) == 1 else ("arm1",)
    theirs, their_scene = model.createData(), geometry.createData()
    full = original_q(model, cell, q, 0, arms)
    pin.updateGeometryPlacements(model, theirs, geometry, their_scene, full)
    ours, scene = cell.model.createData(), cell.collision.createData()
    pin.updateGeometryPlacements(cell.model, ours, cell.collision, scene, q)
    placed = cell._robots[0]
    known = {
        f"{placed.link(model.frames[item.parentFrame].name)}_{item.name.rpartition('_')[2]}": pose
        for item, pose in zip(geometry.geometryObjects, their_scene.oMg, strict=True)
    }
    compared = 0
    for item, pose in zip(cell.collision.geometryObjects, scene.oMg, strict=True):
        if item.name in known:
            compared += 1
            np.testing.assert_allclose(pose.homogeneous, known[item.name].homogeneous, atol=1e-12)
    assert compared == len(known)


@pytest.mark.parametrize("name", ["panda", "ur5", "baxter", "tiago_pro"])
def test_clearance_of_a_robot_with_meshes_is_known(name: str) -> None:
    cell = load(name)
    q = (cell.lower + cell.upper) / 2
    assert cell.missing_meshes == ()
    assert np.isfinite(cell.clearance(q).distance)


def test_a_robot_without_collision_bodies_has_unknown_clearance() -> None:
    assert load("human").clearance(np.zeros(16)) is None


def test_the_tables_name_each_robot_once() -> None:
    assert len(set(NAMES)) == len(NAMES) == len(SINGLE) + len(TWIN)
