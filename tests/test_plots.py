"""Figures hold what they are given, say their units and are the same bytes every time."""

import subprocess
import sys

import numpy as np
import pytest
from ns16_pair import corner, motions, pair

from dualarm_pin.errors import ShapeError
from dualarm_pin.show import plots


def curves():
    s = corner().arc_length
    return [plots.Curve(f"method {k}", c, s) for k, (_, c) in enumerate(motions())]


def moves():
    return [plots.Motion(f"method {k}", q) for k, (q, _) in enumerate(motions())]


def test_path_is_drawn_flat_with_the_points_of_the_first_stage():
    path = corner()
    ax = plots.figure_path(path, [0, 6, 12, 18, 24, 30]).axes[0]
    np.testing.assert_array_equal(ax.lines[0].get_xydata(), path.position[:, :2])
    np.testing.assert_array_equal(ax.lines[2].get_xydata()[3], path.position[18, :2])
    assert ax.get_xlabel().endswith("[m]")
    assert [text.get_text() for text in ax.texts] == ["1", "7", "13", "19", "25", "31"]


def test_path_in_space_has_three_axes():
    path = corner()
    bent = path.position + np.linspace(0, 0.1, path.h)[:, None] * [0, 0, 1]
    assert plots.figure_path(type(path)(bent, path.rotation)).axes[0].name == "3d"


@pytest.mark.parametrize("along", ["point", "arc_length"])
def test_index_shows_every_curve_and_its_mean(along):
    ax = plots.figure_index(curves(), along=along).axes[0]
    for k, curve in enumerate(curves()):
        np.testing.assert_array_equal(ax.lines[2 * k].get_ydata(), curve.index)
        assert f"mean {curve.index.mean():.3g}" in ax.get_legend().get_texts()[k].get_text()
    assert ax.get_ylim()[0] == 0
    assert "[m²]" in ax.get_ylabel()
    assert ax.get_xlabel() == {"point": "path point", "arc_length": "arc length [m]"}[along]


def test_arc_length_must_fit():
    with pytest.raises(ShapeError, match=r"arc_length of 'a' must have one value per point \(5\)"):
        plots.figure_index([plots.Curve("a", np.ones(5))], along="arc_length")


def test_clearance_marks_collisions():
    values = np.linspace(0.1, -0.05, 8)
    assert plots.figure_clearance([plots.Curve("a", values)]).axes[0].get_ylim()[0] < -0.05
    assert plots.figure_clearance([plots.Curve("a", values + 1)]).axes[0].get_ylim()[0] == 0


def test_joints_show_bounds_in_degrees():
    figure = plots.figure_joints(pair(), moves())
    assert len([ax for ax in figure.axes if ax.get_visible()]) == 12
    ax = next(ax for ax in figure.axes if ax.get_title("left") == "arm2/joint_3 [deg]")
    np.testing.assert_allclose(ax.lines[1].get_ydata(), np.degrees(moves()[1].q[:, 8]))
    heights = {round(float(line.get_ydata()[0]), 6) for line in ax.lines[3:]}
    assert heights == {-150.0, 45.0}


def test_steps_and_wrong_columns():
    ax = plots.figure_steps(pair(), moves()).axes[0]
    q = moves()[0].q
    top = np.degrees(np.abs(np.diff(q, axis=0)).max())
    assert f"largest {top:.1f}°" in ax.get_legend().get_texts()[0].get_text()
    with pytest.raises(ShapeError, match=r"\(h, 12\) is expected for 'short'; given \(31, 5\)"):
        plots.figure_steps(pair(), [plots.Motion("short", q[:, :5])])


def test_saved_bytes_are_the_same_every_time(tmp_path):
    first = plots.save(plots.figure_index(curves()), tmp_path / "a" / "fig.4")
    again = plots.save(plots.figure_index(curves()), tmp_path / "b" / "fig.4")
    assert [file.name for file in first] == ["fig.4.svg", "fig.4.png"]
    for one, two in zip(first, again, strict=True):
        assert one.read_bytes() == two.read_bytes()


def test_pyplot_is_never_imported():
    code = "import sys, dualarm_pin.show.plots; assert 'matplotlib.pyplot' not in sys.modules"
    subprocess.run([sys.executable, "-c", code], check=True)
