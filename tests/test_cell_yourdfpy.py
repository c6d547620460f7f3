"""A second opinion on where the tips are: yourdfpy reads the same files, and the merged text."""

from __future__ import annotations

import io
import sys
from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest
import yourdfpy
from robot_table import NAMES, arguments, needs_robots

from dualarm_pin.cell import Cell
from dualarm_pin.cell.merged_urdf import merged_urdf
from dualarm_pin.errors import MissingExtraError
from dualarm_pin.files.resources import urdf_folder
from dualarm_pin.robot.packages import find_file
from dualarm_pin.second_opinion import compare

pytestmark = needs_robots
BASE2 = pin.SE3(pin.rpy.rpyToMatrix(0.1, -0.2, 3.0), np.array([1.2, 0.3, 0.1]))


def load(name: str) -> Cell:
    urdfs, options, _ = arguments(name)
    return Cell.from_urdf(*urdfs, base2=BASE2 if len(urdfs) == 2 else None, **options)


def read(source: object) -> yourdfpy.URDF:
    """Return a robot as yourdfpy reads it, without its meshes."""
    return yourdfpy.URDF.load(
        source, load_meshes=False, build_scene_graph=True, load_collision_meshes=False
    )


def pose(robot: yourdfpy.URDF, values: dict[str, float], link: str) -> np.ndarray:
    """Return the pose of a link in the root link, with yourdfpy moving mimic joints itself."""
    robot.update_cfg({name: values[name] for name in robot.actuated_joint_names})
    return robot.get_transform(link, robot.base_link)


@pytest.mark.parametrize("name", NAMES)
def test_yourdfpy_puts_both_tips_there_too(name: str) -> None:
    cell = load(name)
    urdfs = arguments(name)[0]
    files = [find_file(urdf, urdf_folder()) for urdf in urdfs]
    theirs = [read(str(file)) for file in dict.fromkeys(files)]
    merged = read(io.BytesIO(merged_urdf(cell._robots, {}).encode()))
    data = cell.data()
    for q in np.random.default_rng(7).uniform(cell.lower, cell.upper, (5, cell.n)):
        model_q = cell.model_q(q)
        pin.framesForwardKinematics(cell.model, data, model_q)
        every = dict(zip(list(cell.model.names)[1:], map(float, model_q), strict=True))
        for number, arm in enumerate(cell.arms):
            placed = cell._robots[number % len(cell._robots)]
            frame = placed.frames[arm.tip]
            ours = data.oMf[cell.model.getFrameId(frame, pin.FrameType.BODY)].homogeneous
            np.testing.assert_allclose(pose(merged, every, frame), ours, rtol=0, atol=1e-12)
            values = dict(placed.roles.values)
            values |= {joint: every[placed.joint(joint)] for joint in placed.roles.columns}
            own = pose(theirs[number % len(theirs)], values, arm.tip)
            there = (placed.base.homogeneous @ own) if len(urdfs) == 2 else own
            np.testing.assert_allclose(there, ours, rtol=0, atol=1e-12)


@pytest.mark.parametrize("name", NAMES[:2])
def test_a_deep_check_agrees_and_sees_a_base_that_is_elsewhere(name: str) -> None:
    cell = load(name)
    found = compare(cell, postures=5)
    assert found.agrees
    shifted = pin.SE3(BASE2.rotation, BASE2.translation + 1e-6)
    robots = [
        replace(robot, base=shifted if at else robot.base) for at, robot in enumerate(cell._robots)
    ]
    if len(robots) == 2:
        object.__setattr__(cell, "_robots", tuple(robots))
        differing = compare(cell, postures=5)
        assert not differing.agrees
        assert "DIFFERS" in str(differing)


def test_a_deep_check_without_yourdfpy_says_which_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "yourdfpy", None)
    with pytest.raises(MissingExtraError, match=r"dualarm-pin\[deep\]"):
        compare(Cell.load(urdf_folder() / "cells" / "ns16_pair.yaml"))
