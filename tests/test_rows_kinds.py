"""Boxes, axes and joint ranges: what they mean on a robot, and their derivatives."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

from dualarm_pin.cell import Cell
from dualarm_pin.errors import InputError
from dualarm_pin.files.resources import urdf_folder
from dualarm_pin.relative import relative_motion
from dualarm_pin.rows import Row, axis_within, half_space, inside, joint_range
from dualarm_pin.rows.row import DifferenceBend, DifferenceSlope, frame_id

AXIS, OF = (0.3, -0.5, 0.8), (0.1, 1.0, -2.0)


def every(cell: Cell) -> tuple[Row, ...]:
    ranges = (
        joint_range(cell, f"arm{a}/joint_{j}", to=(-0.3, 0.4)) for a in (1, 2) for j in (1, 5)
    )
    return (axis_within("arm2/tip", AXIS, OF, 25.0), *(row for two in ranges for row in two))


def postures(cell: Cell, count: int = 20) -> np.ndarray:
    return np.random.default_rng(3).uniform(cell.lower, cell.upper, (count, cell.n))


def test_slopes_and_bends_are_the_differences_of_the_value(cell: Cell) -> None:
    """Along twists of any kind, at rotations up to 1 rad off those of the joint itself."""
    random = np.random.default_rng(1)
    for row, q in zip(every(cell), postures(cell), strict=False):
        T = relative_motion(cell, *row.frames(cell), q)[0]
        for _ in range(5):
            R = pin.exp3(random.uniform(-0.6, 0.6, 3)) @ T.rotation
            given = (R, random.normal(size=3), row.parameters)
            assert row.slope is not None
            assert row.bend is not None
            np.testing.assert_allclose(
                row.slope(*given), DifferenceSlope(row.phi)(*given), atol=1e-6
            )
            np.testing.assert_allclose(row.bend(*given), DifferenceBend(row.phi)(*given), atol=1e-6)


def test_casadi_has_the_same_values(cell: Cell) -> None:
    ca = pytest.importorskip("casadi")
    for row in every(cell):
        for _ in range(5):
            T = pin.SE3.Random()
            value = float(ca.DM(row.expression(ca, ca.DM(T.rotation), ca.DM(T.translation))))
            assert value == pytest.approx(row.phi(T.rotation, T.translation, row.parameters))


def test_an_axis_within_an_angle_is_that_angle(cell: Cell) -> None:
    row = axis_within("arm2/tip", AXIS, OF, 25.0)
    for q in postures(cell):
        seen = relative_motion(cell, 0, frame_id(cell, "arm2/tip", ""), q)[0].rotation @ AXIS
        cosine = seen @ OF / np.linalg.norm(AXIS) / np.linalg.norm(OF)
        assert row.at(cell, q)[0] == pytest.approx(cosine - np.cos(np.radians(25.0)))


def test_a_joint_range_is_the_distance_to_its_ends_wherever_the_joint_is(cell: Cell) -> None:
    for number, name in enumerate(cell.joint_names):
        lower, upper = joint_range(cell, name, deg=(-20.0, 35.0))
        for q in postures(cell):
            value, slope = lower.at(cell, q)
            assert value == pytest.approx(q[number] - np.radians(-20.0), abs=1e-9)
            np.testing.assert_allclose(slope, np.eye(cell.n)[number], atol=1e-9)
            assert upper.at(cell, q)[0] == pytest.approx(np.radians(35.0) - q[number], abs=1e-9)


def test_a_sliding_joint_has_a_range_in_metres(tmp_path) -> None:
    (tmp_path / "slide.urdf").write_text("""<robot name="s"><link name="a"/><link name="b"/>
      <link name="c"/><joint name="j" type="prismatic"><parent link="a"/><child link="b"/>
      <origin xyz="1 2 3" rpy="0.3 -0.2 0.5"/><axis xyz="1 2 -2"/>
      <limit lower="-1" upper="1" effort="1" velocity="1"/></joint><joint name="k"
      type="revolute"><parent link="b"/><child link="c"/><axis xyz="0 0 1"/>
      <limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>""")
    cell = Cell.from_urdf(tmp_path / "slide.urdf", tmp_path / "slide.urdf", tips=("c", "c"))
    lower, upper = joint_range(cell, "arm2/j", to=(-0.2, 0.6))
    for q in postures(cell, 5):
        assert lower.at(cell, q)[0] == pytest.approx(q[2] + 0.2)
        assert upper.at(cell, q)[0] == pytest.approx(0.6 - q[2])
    with pytest.raises(InputError, match="arm2/j slides: give `to` in metres"):
        joint_range(cell, "arm2/j", deg=(0, 1))


def test_a_joint_that_turns_further_than_once_is_refused() -> None:
    """One pose has several values of it: a row on the pose would let -350 deg pass for 10."""
    wide = urdf_folder() / "ns16" / "ns16.urdf"
    limits = {"arm1/joint_6": (-6.2, 6.2)}
    cell = Cell.from_urdf(wide, wide, limits=limits)
    with pytest.raises(InputError, match="arm1/joint_6 may turn further than once"):
        joint_range(cell, "arm1/joint_6", deg=(-10, 10))


def test_a_box_is_a_plane_for_each_end() -> None:
    box = {"x": (0.7, 0.8), "z": (0.6, None)}
    rows = inside("arm1/tip", box, points=[0])  # type: ignore[arg-type]
    assert [row.name for row in rows] == [
        "arm1/tip x at least 0.7 m", "arm1/tip x at most 0.8 m", "arm1/tip z at least 0.6 m",
    ]  # fmt: skip
    assert all(row.phi is half_space("world", (0, 0, 1), 0).phi for row in rows)
    values = [row.phi(np.eye(3), np.array([0.75, 9.0, 0.5]), row.parameters) for row in rows]
    assert values == pytest.approx([0.05, 0.05, -0.1])
    assert all(row.points == (0,) for row in rows)


def test_the_engine_compiles_them_and_solves_with_them(task, recwarn) -> None:
    """A joint kept in a range at two points, a tool upright within an angle at all of them."""
    from dataclasses import replace

    from ns16_pair import motions

    from dualarm_pin.engine.solve import solve

    q = motions()[0][0]
    free = q[[4, 20], 4]
    ends = joint_range(
        task.cell, "arm1/joint_5", to=(free.max() - 1.0, free.min() - 0.05), points=[4, 20]
    )
    tool = relative_motion(task.cell, 0, task.cell.e2, q[0])[0].rotation[:, 2]
    upright = axis_within("arm2/tip", (0, 0, 1), tuple(tool), 20.0)
    problem = replace(task, rows=(*ends, upright)).problem()
    found = solve(problem, q)
    assert found.converged
    assert found.q[[4, 20], 4].max() == pytest.approx(free.min() - 0.05, abs=1e-6)
    for each in found.q:
        axis = relative_motion(task.cell, 0, task.cell.e2, each)[0].rotation[:, 2]
        assert axis @ tool >= np.cos(np.radians(20.0)) - 1e-6
    assert not [w for w in recwarn if "hundred times slower" in str(w.message)]
