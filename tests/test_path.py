"""The path noun: what it holds, what it refuses, and the points of the first stage."""

from __future__ import annotations

import dataclasses
import itertools

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dualarm_pin.errors import InputError, ShapeError
from dualarm_pin.path import Path
from dualarm_pin.path.gamma import choose_Gamma
from dualarm_pin.path.path import through
from dualarm_pin.path.paths import circle, corner, helix

LINE = np.array([[0.0, 0, 0], [0.1, 0, 0], [0.3, 0, 0]])


def test_defaults_are_tangent_whole_pose_and_z():
    path = Path(LINE, np.eye(3))
    assert path.h == 3
    np.testing.assert_allclose(path.u, [[1, 0, 0, 0, 0, 0]] * 3, atol=1e-15)
    np.testing.assert_array_equal(path.rows, [6, 6, 6])
    np.testing.assert_array_equal(path.spin_axis, [0, 0, 1])
    np.testing.assert_allclose(path.arc_length, [0, 0.1, 0.3])
    assert path.length == pytest.approx(0.3)


def test_arrays_are_read_only_and_copied():
    given = LINE.copy()
    path = Path(given, np.eye(3))
    given[0] = 9.0
    assert path.position[0, 0] == 0.0
    for field in dataclasses.fields(path):
        value = getattr(path, field.name)
        if isinstance(value, np.ndarray):
            with pytest.raises(ValueError, match="read-only"):
                value[0] = 1
    with pytest.raises(dataclasses.FrozenInstanceError):
        path.name = "other"


def test_pose_is_a_copy():
    path = Path(LINE, np.eye(3))
    pose = path.pose(1)
    assert pose.isApprox(pin.SE3(np.eye(3), LINE[1]))
    pose.translation[0] = 5.0
    assert path.position[1, 0] == 0.1


@pytest.mark.parametrize(
    ("u", "expected"),
    [
        ([0, 0, 1], [0, 0, 1, 0, 0, 0]),
        ([0, 0, 0, 0, 0, 2], [0, 0, 0, 0, 0, 2]),
        ([[0, 1, 0]] * 3, [0, 1, 0, 0, 0, 0]),
        ([[0, 1, 0, 1, 0, 0]] * 3, [0, 1, 0, 1, 0, 0]),
    ],
)
def test_with_direction(u, expected):
    path = Path(LINE, np.eye(3)).with_direction(u)
    np.testing.assert_array_equal(path.u, [expected] * 3)


def test_subset_keeps_tangents_and_counts_arc_length_from_its_first_point():
    path = corner()
    part = path.subset([6, 12, 18])
    np.testing.assert_array_equal(part.position, path.position[[6, 12, 18]])
    np.testing.assert_array_equal(part.tangent, path.tangent[[6, 12, 18]])
    assert part.arc_length[0] == 0.0
    assert part.length == pytest.approx(path.arc_length[18] - path.arc_length[6])
    for wrong in ([3], [3, 3], [5, 2], [0, 31], [-1, 4]):
        with pytest.raises(InputError, match="rising indices below 31"):
            path.subset(wrong)


@settings(deadline=None)
@given(
    st.lists(st.floats(-3, 3), min_size=6, max_size=6),
    st.lists(st.floats(-3, 3), min_size=6, max_size=6),
)
def test_moving_is_a_group_action(first, second):
    path = helix(0.06, 0.04, 2, points=9, orientation="tangent")
    A, B = pin.exp6(np.array(first)), pin.exp6(np.array(second))
    one, two = path.moved(A * B), path.moved(B).moved(A)
    for name in ("position", "rotation", "u", "tangent", "arc_length"):
        np.testing.assert_allclose(getattr(one, name), getattr(two, name), atol=1e-9)
    assert one.pose(4).isApprox(A * B * path.pose(4), 1e-9)


def test_a_tool_that_turns_where_it_stands_is_a_path():
    turned = pin.rpy.rpyToMatrix(0, 0, 0.5)
    position = LINE[[0, 1, 1, 2]]
    path = Path(position, [np.eye(3), np.eye(3), turned, turned])
    np.testing.assert_allclose(path.tangent, [[1, 0, 0]] * 4, atol=1e-15)
    np.testing.assert_allclose(path.arc_length, [0, 0.1, 0.1, 0.3])


def test_tangents_by_differences_are_of_second_order():
    errors = []
    for points in (21, 41):
        path = circle(0.3, points=points)
        estimate = through(path.position)
        estimate /= np.linalg.norm(estimate, axis=1, keepdims=True)
        errors.append(np.abs(estimate - path.tangent).max())
    assert errors[1] < 0.3 * errors[0]


def test_a_path_straight_back_takes_the_direction_in_which_it_leaves():
    there_and_back = np.array([[0.0, 0, 0], [1, 0, 0], [0, 0, 0]])
    path = Path(there_and_back, np.eye(3))
    np.testing.assert_allclose(path.tangent[1], [-1, 0, 0])


def test_rotations_are_moved_to_the_nearest_exact_one():
    rough = np.round(pin.rpy.rpyToMatrix(0.3, -0.7, 1.1), 6)
    path = Path(LINE, rough)
    np.testing.assert_allclose(path.rotation[0].T @ path.rotation[0], np.eye(3), atol=1e-15)
    np.testing.assert_allclose(path.rotation[0], rough, atol=2e-6)


NAN = LINE.copy()
NAN[1, 2] = np.nan
TWICE = LINE[[0, 1, 1, 2]]


@pytest.mark.parametrize(
    ("position", "rotation", "options", "error", "message"),
    [
        (NAN, np.eye(3), {}, InputError, r"position: point 2 is not finite: \[0.1, 0.0, nan\]"),
        (LINE + np.inf, np.eye(3), {}, InputError, "position: point 1 is not finite"),
        (LINE[:1], np.eye(3), {}, InputError, "position: a path needs 2 points or more; given 1"),
        (TWICE, np.eye(3), {}, InputError, "position: points 2 and 3 coincide: remove one"),
        (LINE[[0, 0]], [np.eye(3), -np.diag([1, 1, -1])], {}, InputError, "all points coincide"),
        (LINE[:, :2], np.eye(3), {}, ShapeError, r"shape \(h, 3\) is expected; given \(3, 2\)"),
        ([[0, 0], [1]], np.eye(3), {}, ShapeError, "position: an array of numbers is expected"),
        (LINE, np.zeros((2, 3, 3)), {}, ShapeError, r"rotation: shape \(3, 3, 3\) is expected"),
        (LINE, 1.1 * np.eye(3), {}, InputError, "rotation: point 1: .* identity by 0.21; allowed"),
        (LINE, -np.eye(3), {}, InputError, "rotation: point 1: the matrix is a mirror"),
        (LINE, np.eye(3), {"u": [0, 0, 0]}, InputError, r"u: point 1 \(and 2 more\) is zero"),
        (LINE, np.eye(3), {"u": np.zeros(4)}, ShapeError, r"u: shape \(3, 6\) is expected"),
        (LINE, np.eye(3), {"u": [0, np.nan, 0]}, InputError, "u: point 1 is not finite"),
        (LINE, np.eye(3), {"u": "up"}, ShapeError, "u: an array of numbers is expected"),
        (LINE, np.eye(3), {"rows": 4}, InputError, r"rows: 6, 5 or 3 is expected; given \[4\]"),
        (LINE, np.eye(3), {"rows": [6, 5]}, ShapeError, r"rows: one value or shape \(3,\)"),
        (LINE, np.eye(3), {"spin_axis": [0, 0, 0]}, InputError, "spin_axis: the axis has no len"),
        (LINE, np.eye(3), {"spin_axis": [0, 1]}, ShapeError, r"spin_axis: shape \(3\)"),
        (LINE, np.eye(3), {"tangent": LINE}, InputError, "tangent: point 1 is zero"),
        (LINE, np.eye(3), {"arc_length": [0, 2, 1]}, InputError, "arc lengths must rise from 0"),
    ],
)
def test_refused(position, rotation, options, error, message):
    with pytest.raises(error, match=message):
        Path(position, rotation, **options)


def test_one_zero_direction_is_named():
    u = np.ones((3, 6))
    u[1] = 0.0
    with pytest.raises(InputError, match="u: point 2 is zero"):
        Path(LINE, np.eye(3), u=u)


def test_the_papers_Gamma_comes_out_for_the_papers_corner():
    assert [i + 1 for i in choose_Gamma(corner(), 6)] == [1, 7, 13, 19, 25, 31]


def test_Gamma_is_denser_where_the_path_turns():
    path = corner(points=None, step=0.002)
    chosen = choose_Gamma(path, 12)
    s = path.arc_length[list(chosen)]
    in_fillet = np.count_nonzero((s >= 0.13) & (s <= 0.166))
    assert in_fillet / 12 > 2 * 0.036 / path.length


def test_Gamma_is_denser_where_u_turns():
    position = np.linspace([0, 0, 0], [1, 0, 0], 101)
    angle = np.clip((np.linspace(0, 1, 101) - 0.5) * 10, 0, 1) * np.pi
    u = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(101)])
    chosen = np.array(choose_Gamma(Path(position, np.eye(3), u=u), 14))
    assert np.count_nonzero((chosen >= 50) & (chosen <= 60)) >= 4


def test_Gamma_of_a_circle_is_even():
    assert choose_Gamma(circle(0.3, points=61), 6) == (0, 12, 24, 36, 48, 60)


@settings(deadline=None)
@given(st.integers(2, 31))
def test_Gamma_always_holds_both_ends(count):
    chosen = choose_Gamma(corner(), count)
    assert len(chosen) == count
    assert (chosen[0], chosen[-1]) == (0, 30)
    assert all(a < b for a, b in itertools.pairwise(chosen))


@pytest.mark.parametrize("count", [1, 32])
def test_Gamma_refuses_another_count(count):
    with pytest.raises(InputError, match=f"2 to 31 points are expected; given {count}"):
        choose_Gamma(corner(), count)
