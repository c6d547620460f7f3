"""The noun Cell: what it holds, and that no one can change it."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

from dualarm_pin.cell import Cell
from dualarm_pin.files.resources import urdf_folder

NS16 = urdf_folder() / "ns16" / "ns16.urdf"
FACING = pin.SE3(np.diag([-1.0, -1.0, 1.0]), np.array([2.5, 0.0, 0.0]))


@pytest.fixture(scope="module")
def cell() -> Cell:
    return Cell.load(urdf_folder() / "cells" / "ns16_pair.yaml")


def test_columns_run_from_base_to_tip_of_each_arm(cell: Cell) -> None:
    names = [f"{arm}/joint_{k}" for arm in ("arm1", "arm2") for k in range(1, 7)]
    assert cell.joint_names == tuple(names)
    assert cell.model.nq == cell.model.nv == cell.n == 12
    np.testing.assert_array_equal(cell.joint_map, np.eye(12))
    assert not cell.joint_offset.any()


def test_bounds_are_those_of_the_file_and_read_only(cell: Cell) -> None:
    np.testing.assert_allclose(np.degrees(cell.lower[:6]), [-60, -45, -150, -90, -90, -90])
    np.testing.assert_allclose(np.degrees(cell.upper[6:]), [60, 90, 45, 90, 90, 90])
    np.testing.assert_array_equal(cell.model.lowerPositionLimit, cell.lower)
    for array in (cell.lower, cell.upper, cell.joint_map, cell.joint_offset):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1.0


def test_python_and_the_file_make_the_same_cell(cell: Cell) -> None:
    degrees = {
        f"joint_{k}": (lo, hi)
        for k, (lo, hi) in enumerate(
            [(-60, 60), (-45, 90), (-150, 45), (-90, 90), (-90, 90), (-90, 90)], start=1
        )
    }
    limits = {name: tuple(np.radians(pair)) for name, pair in degrees.items()}
    other = Cell.from_urdf(NS16, NS16, base2=FACING, limits=limits)
    q = np.random.default_rng(0).uniform(cell.lower, cell.upper)
    for c in (cell, other):
        pin.framesForwardKinematics(c.model, c.data(), q)
    for frame in ("e1", "e2"):
        a, b = (c.data().oMf[getattr(c, frame)] for c in (cell, other))
        np.testing.assert_allclose(a.homogeneous, b.homogeneous, atol=1e-14)
    np.testing.assert_allclose(other.lower, cell.lower)
    assert other.clearance(q).distance == pytest.approx(cell.clearance(q).distance, abs=1e-9)


def test_clearance_is_the_smallest_distance_over_the_pairs(cell: Cell) -> None:
    q = np.radians([0, 0, -90, 0, 30, 0] * 2)
    found = cell.clearance(q)
    data, scene = cell.model.createData(), cell.collision.createData()
    pin.computeDistances(cell.model, data, cell.collision, scene, q)
    smallest = min(result.min_distance for result in scene.distanceResults)
    assert found.distance == pytest.approx(smallest, abs=1e-12)  # Coal starts warm
    assert {found.first[:5], found.second[:5]} <= {"arm1/", "arm2/"}
    assert cell.missing_meshes == ()


def test_arms_that_run_into_each_other_have_negative_clearance() -> None:
    near = pin.SE3(np.diag([-1.0, -1.0, 1.0]), np.array([1.2, 0.0, 0.0]))
    cell = Cell.from_urdf(NS16, NS16, base2=near)
    found = cell.clearance(np.radians([0, 0, -90, 0, 0, 0] * 2))
    assert found.distance < 0
    assert {found.first[:5], found.second[:5]} == {"arm1/", "arm2/"}


def test_the_files_it_was_read_from_are_kept_with_fingerprints(cell: Cell) -> None:
    assert {source.path.name for source in cell.sources} == {"ns16_pair.yaml", "ns16.urdf"}
    assert all(len(source.sha256) == 64 for source in cell.sources)
