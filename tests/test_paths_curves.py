"""Generators against geometry: on the curve, unit tangents, arc length, rotations."""

from __future__ import annotations

import math

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dualarm_pin.errors import InputError
from dualarm_pin.path import paths

FACING = np.diag([1.0, -1.0, -1.0])
SQUARE = [[0, 0, 0], [0.2, 0, 0], [0.2, 0.2, 0], [0, 0.2, 0]]
RING = [[0.2, 0, 0.3], [0, 0.2, 0.35], [-0.2, 0, 0.3], [0, -0.2, 0.35]]
KNOTS = [[0, 0, 0.3], [0.1, 0.05, 0.3], [0.2, 0, 0.35], [0.25, 0.1, 0.3]]

SMOOTH = {
    "rounded corner": lambda **how: paths.corner(points=how.pop("points"), **how),
    "polyline": lambda **how: paths.polyline(SQUARE, fillet=0.03, **how),
    "closed polyline": lambda **how: paths.polyline(SQUARE, fillet=0.03, closed=True, **how),
    "circle": lambda **how: paths.circle(0.3, **how),
    "clockwise": lambda **how: paths.circle(0.3, turns=-1.5, start=1.0, **how),
    "arc": lambda **how: paths.arc(0.2, 0.3, 2.0, center=(0.1, -0.2), **how),
    "helix": lambda **how: paths.helix(0.06, 0.04, 2, **how),
    "raster": lambda **how: paths.raster(0.24, 0.16, 5, fillet=0.015, **how),
    "sine": lambda **how: paths.sine(0.2, height=0.4, **how),
    "figure eight": lambda **how: paths.figure_eight(0.04, **how),
    "dome spiral": lambda **how: paths.dome_spiral(0.15, **how),
    "tube seam": lambda **how: paths.tube_seam(0.05, 0.09, **how),
    "spline": lambda **how: paths.spline(KNOTS, **how),
    "closed spline": lambda **how: paths.spline(RING, closed=True, **how),
}
CLOSED = ("closed polyline", "circle", "figure eight", "tube seam", "closed spline")


@pytest.mark.parametrize("name", SMOOTH)
def test_geometry(name):
    """Tangent, arc length and spacing, all against the points of a fine sampling."""
    fine = SMOOTH[name](points=20001)
    steps = np.diff(fine.position, axis=0)
    chords = np.linalg.norm(steps, axis=1)
    assert np.sum(chords) == pytest.approx(fine.length, rel=1e-6)
    assert np.ptp(np.diff(fine.arc_length)) < 1e-9
    np.testing.assert_allclose(chords, fine.length / 20000, rtol=1e-5)
    middle = 0.5 * (fine.tangent[1:] + fine.tangent[:-1])
    np.testing.assert_allclose(steps / chords[:, None], middle, atol=2e-3)
    np.testing.assert_allclose(np.linalg.norm(fine.tangent, axis=1), 1.0, atol=1e-12)
    np.testing.assert_array_equal(fine.u, np.hstack([fine.tangent, np.zeros((20001, 3))]))
    coarse = SMOOTH[name](points=41)
    np.testing.assert_allclose(coarse.position, fine.position[::500], atol=1e-9)
    np.testing.assert_allclose(coarse.tangent, fine.tangent[::500], atol=1e-7)
    np.testing.assert_allclose(coarse.arc_length, fine.arc_length[::500], atol=1e-9)


@pytest.mark.parametrize("name", SMOOTH)
@pytest.mark.parametrize("orientation", ["constant", "tangent", "normal", "normal_tangent"])
def test_rotations_are_rotations_and_do_as_they_say(name, orientation):
    try:
        path = SMOOTH[name](points=61, orientation=orientation)
    except InputError as error:
        assert orientation.startswith("normal")
        assert name in ("polyline", "closed polyline", "helix", "spline", "closed spline")
        assert "lies on none: use tangent" in str(error)
        return
    identity = np.broadcast_to(np.eye(3), (61, 3, 3))
    R = path.rotation
    np.testing.assert_allclose(R.transpose(0, 2, 1) @ R, identity, atol=1e-12)
    np.testing.assert_allclose(np.linalg.det(R), 1.0, atol=1e-12)
    if orientation == "constant":
        np.testing.assert_array_equal(R, np.broadcast_to(FACING, (61, 3, 3)))
    if orientation in ("tangent", "normal_tangent"):
        np.testing.assert_allclose(R[:, :, 0], path.tangent, atol=1e-12)
    if orientation == "normal":
        turn = np.array([pin.log3(r) for r in R @ FACING.T])
        # The shortest turn is about an axis at a right angle to the old and the new z.
        np.testing.assert_allclose(turn @ FACING[:, 2], 0.0, atol=1e-9)


@pytest.mark.parametrize("name", CLOSED)
def test_closed_curves_close(name):
    path = SMOOTH[name](points=49)
    np.testing.assert_allclose(path.position[0], path.position[-1], atol=1e-12)
    np.testing.assert_allclose(path.tangent[0], path.tangent[-1], atol=1e-9)
    np.testing.assert_allclose(path.rotation[0], path.rotation[-1], atol=1e-9)


def test_the_papers_corner_by_its_formulas():
    path = paths.corner()
    length, r, (h1, h2, h3) = 0.15, 0.01, (13, 5, 13)
    for i in range(1, 32):  # i, h1, h2, h3 as the paper writes them
        a = math.pi / 2 * (i - h1) / (h2 + 1)
        if i <= h1:
            x = [length, (length - r) * (i - 1) / (h1 - 1)]
            t = [0.0, 1.0, 0.0]
        elif i <= h1 + h2:
            x = [length - r + r * math.cos(a), length - r + r * math.sin(a)]
            t = [-math.sin(a), math.cos(a), 0.0]
        else:
            x = [(length - r) * (1 - (i - (h1 + h2 + 1)) / (h3 - 1)), length]
            t = [-1.0, 0.0, 0.0]
        np.testing.assert_allclose(path.position[i - 1], [*x, 0.3], rtol=1e-15, atol=1e-17)
        np.testing.assert_allclose(path.tangent[i - 1], t, rtol=1e-15, atol=1e-17)
    np.testing.assert_array_equal(path.rotation, np.broadcast_to(FACING, (31, 3, 3)))
    assert path.length == pytest.approx(2 * 0.14 + 0.01 * math.pi / 2, abs=1e-15)


def test_the_papers_points_lie_on_the_corner_of_lines_and_arc():
    paper, even = paths.corner(), paths.corner(points=30001)
    on = np.array([np.interp(paper.arc_length, even.arc_length, x) for x in even.position.T])
    np.testing.assert_allclose(on.T, paper.position, atol=1e-8)


def test_circle_of_61_points():
    path = paths.circle(0.3, points=61, height=0.3)
    a = np.linspace(0, 2 * np.pi, 61)
    expected = np.column_stack([0.3 * np.cos(a), 0.3 * np.sin(a), np.full(61, 0.3)])
    np.testing.assert_allclose(path.position, expected, atol=1e-15)


@settings(deadline=None)
@given(
    st.floats(0.01, 1), st.floats(-0.2, 0.2), st.floats(0.2, 3).map(lambda n: round(n, 2)),
    st.integers(2, 90),
)  # fmt: skip
def test_helix_by_its_equation(radius, pitch, turns, points):
    path = paths.helix(radius, pitch, turns, points=points, center=(0.1, 0.2), height=0.4)
    a = np.linspace(0, 2 * np.pi * turns, points)
    z = 0.4 + pitch * a / (2 * np.pi)
    x, y = 0.1 + radius * np.cos(a), 0.2 + radius * np.sin(a)
    np.testing.assert_allclose(path.position, np.column_stack([x, y, z]), atol=1e-9)
    assert path.length == pytest.approx(turns * math.hypot(2 * np.pi * radius, pitch))


def test_raster_meets_every_corner():
    path = paths.raster(0.24, 0.16, 5, points=69)
    assert path.length == pytest.approx(5 * 0.24 + 4 * 0.04)
    np.testing.assert_allclose(np.diff(path.arc_length), 0.02, atol=1e-12)
    for corner in ([0.12, -0.08, 0.3], [0.12, -0.04, 0.3], [-0.12, -0.04, 0.3], [0.12, 0.08, 0.3]):
        assert np.linalg.norm(path.position - corner, axis=1).min() < 1e-12
    at = np.argmin(np.linalg.norm(path.position - [0.12, -0.08, 0.3], axis=1))
    np.testing.assert_allclose(path.tangent[at], [math.sqrt(0.5), math.sqrt(0.5), 0], atol=1e-12)


@pytest.mark.parametrize("points", [11, 12, 17, 40])
def test_corners_are_points_for_any_number_of_points(points):
    path = paths.raster(0.24, 0.16, 5, points=points)
    assert path.h == points
    turns = np.abs(np.diff(path.position[:, 0])) > 1e-12, np.abs(np.diff(path.position[:, 1])) > 0
    assert not np.any(turns[0] & turns[1])  # no chord cuts a corner


def test_sine_and_eight_by_their_equations():
    sine = paths.sine(0.2, amplitude=0.01, periods=4, points=41)
    wave = 0.01 * np.sin(2 * np.pi * 4 * (sine.position[:, 0] / 0.2 + 0.5))
    np.testing.assert_allclose(sine.position[:, 1], wave, atol=1e-9)
    assert np.ptp(sine.position[:, 0]) == pytest.approx(0.2)
    eight = paths.figure_eight(0.04, points=49)
    x, y = eight.position[:, 0], eight.position[:, 1]
    np.testing.assert_allclose(x**4, 0.04**2 * (x**2 - y**2), atol=1e-12)
    assert x.max() == pytest.approx(0.04, abs=1e-4)


def test_dome_spiral_lies_on_the_dome_and_the_tool_stands_on_it():
    path = paths.dome_spiral(0.15, turns=3, points=61)
    out = path.position - [0, 0, 0.2]
    np.testing.assert_allclose(np.linalg.norm(out, axis=1), 0.15, atol=1e-12)
    np.testing.assert_allclose(path.rotation[:, :, 2], -out / 0.15, atol=1e-9)
    np.testing.assert_allclose(np.sum(path.tangent * out, axis=1), 0.0, atol=1e-12)
    polar = np.degrees(np.arccos(out[:, 2] / 0.15))
    assert polar[0] == pytest.approx(10)
    assert polar[-1] == pytest.approx(45)


@pytest.mark.parametrize("tilt", [0.0, 30.0, 45.0, 90.0])
def test_tube_seam_lies_on_both_tubes_and_the_tool_leans(tilt):
    path = paths.tube_seam(0.05, 0.09, tilt=math.radians(tilt), points=49, height=0.25)
    x, y, z = path.position.T
    np.testing.assert_allclose(np.hypot(x, y), 0.05, atol=1e-12)
    np.testing.assert_allclose(np.hypot(y, z - 0.25), 0.09, atol=1e-12)
    z_tool = path.rotation[:, :, 2]
    np.testing.assert_allclose(np.sum(z_tool * path.tangent, axis=1), 0.0, atol=1e-12)
    outward = np.column_stack([x, y, np.zeros(49)]) / 0.05
    np.testing.assert_allclose(
        np.sum(-z_tool * outward, axis=1), np.sin(np.radians(tilt)), atol=1e-12
    )
    assert np.all(-z_tool[:, 2] > -1e-12)  # it comes from above


def test_spline_passes_through_its_points():
    path = paths.spline(KNOTS, points=5001)
    for knot in KNOTS:
        assert np.linalg.norm(path.position - knot, axis=1).min() < 1e-4
    np.testing.assert_allclose(path.position[[0, -1]], np.array(KNOTS)[[0, -1]], atol=1e-12)
    two = paths.spline(KNOTS[:2], points=5)
    np.testing.assert_allclose(two.position, np.linspace(KNOTS[0], KNOTS[1], 5), atol=1e-12)


def test_fillets_touch_their_sides():
    path = paths.polyline(SQUARE, fillet=0.05, closed=True, points=4001)
    assert path.length == pytest.approx(4 * 0.1 + 2 * np.pi * 0.05)
    assert path.position.min() > -1e-12
    assert path.position.max() < 0.2 + 1e-12
    inner = paths.polyline(SQUARE, fillet=0.1, closed=True, points=400)  # four arcs, no line
    np.testing.assert_allclose(np.hypot(*(inner.position[:, :2] - 0.1).T), 0.1, atol=1e-12)


@settings(max_examples=40, deadline=None)
@given(st.lists(st.tuples(*[st.floats(-1, 1)] * 3), min_size=3, max_size=6), st.floats(1e-3, 0.3))
def test_any_fillet_fits_or_the_largest_is_named(vertices, fillet):
    apart = np.linalg.norm(np.diff(vertices, axis=0), axis=1)
    if apart.min() < 1e-3:
        return
    try:
        path = paths.polyline(vertices, fillet=fillet, points=400)
    except InputError as error:
        assert "the largest that fits everywhere is" in str(error)
        return
    turns = np.sum(path.tangent[1:] * path.tangent[:-1], axis=1)
    step = path.length / 399
    assert np.arccos(np.clip(turns, -1, 1)).max() <= step / fillet + 1e-6


@settings(deadline=None)
@given(st.floats(0.004, 0.5))
def test_step_is_the_largest_distance(step):
    path = paths.polyline(SQUARE, step=step)
    gaps = np.diff(path.arc_length)
    assert gaps.max() <= step * (1 + 1e-8)
    assert len(gaps) == 3 * math.ceil(0.2 / step - 1e-9)


def test_frame_moves_the_whole_path():
    frame = pin.SE3(pin.rpy.rpyToMatrix(0.1, 0.2, 0.3), np.array([0.4, 0.5, 0.6]))
    plain, moved = paths.circle(0.1, points=9), paths.circle(0.1, points=9, frame=frame)
    for i in range(9):
        assert moved.pose(i).isApprox(frame * plain.pose(i))
    np.testing.assert_allclose(moved.tangent, plain.tangent @ frame.rotation.T)


def test_free_components():
    path = paths.circle(
        0.1, points=4, free=["none", "spin", "rotation", "spin"], spin_axis=[2, 0, 0]
    )
    np.testing.assert_array_equal(path.rows, [6, 5, 3, 5])
    np.testing.assert_array_equal(path.spin_axis, [1, 0, 0])
    np.testing.assert_array_equal(paths.circle(0.1, points=3, free="spin").rows, [5, 5, 5])


REFUSED = [
    (lambda: paths.circle(-0.1, points=9), r"radius: a number above 0 .* is expected; given -0.1"),
    (lambda: paths.circle(math.nan, points=9), r"radius: a number above 0 .*; given nan"),
    (lambda: paths.circle(0.1, turns=0, points=9), "turns: a number other than 0"),
    (lambda: paths.circle(0.1, center=(0, 0, 0), points=9), r"center: shape \(2\) is expected"),
    (lambda: paths.circle(0.1, height=math.inf, points=9), "height: the values are not finite"),
    (lambda: paths.circle(0.1, points=9, step=0.1), "points: give one of .*: both are given"),
    (lambda: paths.circle(0.1), "points: give one of .*: neither is given"),
    (lambda: paths.circle(0.1, points=1), "points: .*0 corners needs 2 points or more; given 1"),
    (lambda: paths.circle(0.1, step=-1.0), "step: a length above 0 is expected; given -1"),
    (lambda: paths.circle(0.1, step=math.nan), "step: a length above 0 is expected; given nan"),
    (lambda: paths.circle(1e308, points=9), r"radius: a number above 0 \(and up to 1e\+06\)"),
    (lambda: paths.circle(0.1, step=1e-12), "step: .* gives more than 100000 points"),
    (lambda: paths.dome_spiral(0.1, turns=1e5, points=9), "more turns or periods than any path"),
    (lambda: paths.raster(0.2, 0.1, 4, points=5), "points: .* 6 corners needs 8 points or more"),
    (lambda: paths.raster(0.2, 0.1, 1, points=5), "rows: 2 to 10000 rows are expected; given 1"),
    (lambda: paths.raster(0.2, 0.1, 5, fillet=0.02, points=50), "largest that fits .* 0.0125 m"),
    (lambda: paths.arc(0.1, 1.0, 1.0, points=5), "stop: the arc has no length"),
    (lambda: paths.sine(0.2, periods=0, points=5), "periods: a number above 0"),
    (lambda: paths.corner(side=0), "side: a number above 0"),
    (lambda: paths.corner(fillet=0.2), "fillet: a radius above 0 and below the side 0.15"),
    (lambda: paths.corner(points=[13, 5]), r"points: three numbers, .* given \[13, 5\]"),
    (lambda: paths.corner(points=[1, 5, 13]), r"points: three numbers, at least \[2, 0, 2\]"),
    (lambda: paths.corner(points=[9, 5, 9], step=0.1), "points: .* both are given"),
    (lambda: paths.dome_spiral(0.1, inner=1, outer=0.5, points=9), "outer: 0 <= inner < outer"),
    (lambda: paths.tube_seam(0.1, 0.1, points=9), "radius: a branch thinner than the tube"),
    (lambda: paths.tube_seam(0.1, 0.2, tilt=2, points=9), "tilt: an angle within 90 degrees"),
    (lambda: paths.polyline([[0, 0, 0]], points=9), "vertices: 2 points or more .*; given 1"),
    (lambda: paths.polyline([[0, 0, 0]] * 2, points=9), "vertices: points 1 and 2 coincide"),
    (lambda: paths.polyline(SQUARE, fillet=-1, points=9), "fillet: a radius of 0 or more"),
    (lambda: paths.polyline(SQUARE, fillet=0.15, points=9), "between vertex 2 and the next, 0.2 m"),
    (lambda: paths.polyline([[0, 0], [1, 1]], points=9), r"vertices: shape \(h, 3\) is expected"),
    (lambda: paths.spline(KNOTS[:2], closed=True, points=9), "through: a closed curve needs 3"),
    (lambda: paths.spline([[0, 0, np.nan]] * 3, points=9), "through: point 1 is not finite"),
    (lambda: paths.circle(0.1, points=3, free="spinn"), "free: point 1: .* did you mean 'spin'"),
    (lambda: paths.circle(0.1, points=3, free=["spin"]), "free: one word, or one for each of"),
    (lambda: paths.circle(0.1, points=3, orientation="normals"), "did you mean 'normal'"),
    (lambda: paths.circle(0.1, points=3, rotation=np.ones((3, 3))), "rotation: the matrix is not"),
    (lambda: paths.circle(0.1, points=3, rotation=np.eye(2)), "rotation: shape"),
    (
        lambda: paths.polyline([[0, 0, 0], [0, 0, 1]], points=3, orientation="tangent"),
        "orientation: point 1: the curve runs along the tool's z",
    ),
    (
        lambda: paths.dome_spiral(0.1, inner=0, points=9, rotation=np.eye(3)),
        "orientation: point 1: the surface faces the tool from behind",
    ),
]  # fmt: skip


@pytest.mark.parametrize(("make", "message"), REFUSED)
def test_refused(make, message):
    with pytest.raises(InputError, match=message):
        make()
