"""The noun Cell: what it holds, and that no one can change it."""

from __future__ import annotations

import threading
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

from dualarm_pin.cell import Cell
from dualarm_pin.files.resources import urdf_folder

NS16 = urdf_folder() / "ns16" / "ns16.urdf"
FACING = pin.SE3(np.diag([-1.0, -1.0, 1.0]), np.array([2.5, 0.0, 0.0]))


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


def test_clearance_between_the_arms_leaves_out_each_arm_itself(cell: Cell) -> None:
    q = np.radians([0, 0, -90, 0, 30, 0] * 2)
    every, between = cell.clearance(q), cell.clearance(q, between_arms=True)
    assert every.first[:4] == every.second[:4]
    assert {between.first[:4], between.second[:4]} == {"arm1", "arm2"}
    assert between.distance > every.distance


def box(lower: tuple, upper: tuple) -> np.ndarray:
    """Return the 12 triangles (12, 3, 3) of a box."""
    corners = np.array([[(lower, upper)[i >> k & 1][k] for k in range(3)] for i in range(8)])
    faces = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    return np.array([corners[[a, b, c]] for f in faces for a, b, c in (f[:3], (f[0], *f[2:]))])


def write_stl(file: Path, triangles: np.ndarray) -> None:
    rows = np.zeros(len(triangles), dtype=[("floats", "<f4", 12), ("attribute", "<u2")])
    rows["floats"][:, 3:] = triangles.reshape(-1, 9)
    file.write_bytes(bytes(80) + len(triangles).to_bytes(4, "little") + rows.tobytes())


FORK = """\
<robot name="fork">
  <link name="base"/>
  <link name="part"><collision><geometry><mesh filename="{mesh}"/></geometry></collision></link>
  <joint name="slide" type="prismatic"><parent link="base"/><child link="part"/>
    <axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
</robot>
"""


def test_exact_clearance_sees_into_a_hollow_that_the_hull_fills(tmp_path: Path) -> None:
    fork = [box((-2, -1, -1), (2, 1, 0)), box((-2, -1, 0), (-1, 1, 2)), box((1, -1, 0), (2, 1, 2))]
    write_stl(tmp_path / "fork.stl", np.concatenate(fork))
    write_stl(tmp_path / "ball.stl", box((-0.5, -0.5, -0.5), (0.5, 0.5, 0.5)))
    for name in ("fork", "ball"):
        (tmp_path / f"{name}.urdf").write_text(FORK.format(mesh=f"{name}.stl"))
    cell = Cell.from_urdf(
        tmp_path / "fork.urdf",
        tmp_path / "ball.urdf",
        tips=("part", "part"),
        base2=pin.SE3(np.eye(3), np.array([0.0, 0.0, 1.0])),
    )
    inside, through = np.zeros(2), np.array([0.0, -0.8])
    assert cell.clearance(inside).distance < 0
    assert cell.clearance(inside, exact=True).distance == pytest.approx(0.5, abs=1e-6)
    assert cell.clearance(through, exact=True).distance < 0
    above = np.array([0.0, 2.0])
    hull, mesh = cell.clearance(above), cell.clearance(above, exact=True)
    assert hull.distance == pytest.approx(0.5, abs=1e-6)
    assert mesh.distance == pytest.approx(np.hypot(0.5, 0.5), abs=1e-6)


def test_threads_do_not_disturb_each_other(cell: Cell) -> None:
    postures = np.random.default_rng(0).uniform(cell.lower, cell.upper, (40, 12))
    alone = [cell.clearance(q).distance for q in postures]
    found: dict[int, list[float]] = {}

    def work(number: int) -> None:
        found[number] = [cell.clearance(q).distance for q in postures]

    threads = [threading.Thread(target=work, args=(k,)) for k in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for distances in found.values():
        np.testing.assert_allclose(distances, alone, atol=1e-9)
    assert len(found) == 4
