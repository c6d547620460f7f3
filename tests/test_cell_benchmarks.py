"""The cells that ship: each loads with all its bodies and reaches a pose face to face."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
from robot_table import needs_robots

from dualarm_pin.cell import Cell
from dualarm_pin.files.resources import urdf_folder
from dualarm_pin.relative import Relative

FOLDER = urdf_folder() / "cells"
# cell: joints of the two arms, distance of the tools [m] (their grippers need room)
CELLS = {
    "ns16_pair": (6, 6, 0.3),
    "abb_6640_1200": (6, 6, 0.3),
    "b01_ur5_pair": (6, 6, 0.3),
    "b02_panda_pair": (7, 7, 0.3),
    "b03_ur10_pair": (6, 6, 0.3),
    "b04_xarm7_side_by_side": (7, 7, 0.3),
    "b05_kinova_pair": (6, 6, 0.3),
    "b06_panda_ur5": (7, 6, 0.3),
    "b07_ur5_floor_ceiling": (6, 6, 0.3),
    "b08_baxter": (7, 7, 0.3),
    "b09_pr2": (7, 7, 0.2),
    "b10_tiago_pro": (7, 7, 0.4),
    "b11_g1": (7, 7, 0.12),
    "b12_so101_pair": (5, 5, 0.12),
}


def reach(cell: Cell, goal: pin.SE3, q: np.ndarray) -> np.ndarray | None:
    """Return q within the bounds with `T_e1_e2` at the goal, or None, by damped Newton steps."""
    for _ in range(60):
        at = Relative(cell, q)
        turn = pin.log3(goal.rotation @ at.T_e1_e2.rotation.T)
        error = np.r_[goal.translation - at.T_e1_e2.translation, turn]
        if np.linalg.norm(error) < 1e-9:
            return q
        inside = np.ones(cell.n, dtype=bool)
        for _ in range(4):
            J = at.J_r * inside
            step = J.T @ np.linalg.solve(J @ J.T + 1e-6 * np.eye(6), error)
            step *= min(1.0, 0.5 / max(np.abs(step).max(), 1e-12))
            outside = ((q + step < cell.lower) | (q + step > cell.upper)) & inside
            if not outside.any():
                break
            inside &= ~outside
        q = np.clip(q + step, cell.lower, cell.upper)
    return None


def test_the_table_names_every_cell_that_ships() -> None:
    assert {file.stem for file in FOLDER.glob("*.yaml")} == set(CELLS)


@pytest.mark.parametrize(
    "name",
    [pytest.param(name, marks=[] if name == "ns16_pair" else needs_robots) for name in CELLS],
)
def test_a_shipped_cell_reaches_a_pose_face_to_face_free_of_collision(name: str) -> None:
    first, second, gap = CELLS[name]
    cell = Cell.load(FOLDER / f"{name}.yaml")
    assert [joint.arm for joint in cell.joints] == ["arm1"] * first + ["arm2"] * second
    assert cell.missing_meshes == ()
    goal = pin.SE3(np.diag([1.0, -1.0, -1.0]), np.array([0.0, 0.0, gap]))
    rng = np.random.default_rng(0)
    for _ in range(60):
        q = reach(cell, goal, rng.uniform(cell.lower, cell.upper))
        if q is not None and cell.clearance(q, exact=True).distance > 0:
            break
    else:
        pytest.fail("no posture found")
    assert (q >= cell.lower).all()
    assert (q <= cell.upper).all()


def test_cell_files_find_their_robots_from_anywhere(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert Cell.load(FOLDER / "ns16_pair.yaml").n == 12
