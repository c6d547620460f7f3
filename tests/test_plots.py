"""Figures hold what they are given, say their units and are the same bytes every time."""

import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
from answers import answer, answers, changed, near
from ns16_pair import corner, pair

from dualarm_pin.errors import InputError, ShapeError
from dualarm_pin.show import plots


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
    ax = plots.figure_index(answers(), along=along).axes[0]
    for k, curve in enumerate(answers().values()):
        np.testing.assert_array_equal(ax.lines[2 * k].get_ydata(), curve.index)
        assert f"mean {curve.index.mean():.3g}" in ax.get_legend().get_texts()[k].get_text()
    assert ax.get_ylim()[0] == 0
    assert "[m²]" in ax.get_ylabel()
    assert ax.get_xlabel() == {"point": "path point", "arc_length": "arc length [m]"}[along]


def test_clearance_marks_collisions():
    values = np.linspace(0.1, -0.05, 31)
    for shift, below in ((0.0, True), (1.0, False)):
        shown = changed(answer(), clearance=near(values + shift))
        ax = plots.figure_clearance({"a": shown}).axes[0]
        np.testing.assert_array_equal(ax.lines[0].get_ydata(), values + shift)
        assert (ax.get_ylim()[0] < -0.05) == below
    with pytest.raises(InputError, match="a: its clearance is unknown"):
        plots.figure_clearance({"a": changed(answer(), clearance=None)})


def test_joints_show_bounds_in_degrees():
    figure = plots.figure_joints(pair(), answers())
    assert len([ax for ax in figure.axes if ax.get_visible()]) == 12
    ax = next(ax for ax in figure.axes if ax.get_title("left") == "arm2/joint_3 [deg]")
    np.testing.assert_allclose(ax.lines[1].get_ydata(), np.degrees(answers()["result 1"].q[:, 8]))
    heights = {round(float(line.get_ydata()[0]), 6) for line in ax.lines[3:]}
    assert heights == {-150.0, 45.0}


def test_steps_and_wrong_columns():
    ax = plots.figure_steps(pair(), answers()).axes[0]
    q = answer().q
    top = np.degrees(np.abs(np.diff(q, axis=0)).max())
    assert f"largest {top:.1f}°" in ax.get_legend().get_texts()[0].get_text()
    with pytest.raises(ShapeError, match=r"\(h, 12\) is expected for 'short'; given \(31, 5\)"):
        plots.figure_steps(pair(), {"short": replace(answer(), q=q[:, :5], joints=("a",) * 5)})


def test_saved_bytes_are_the_same_every_time(tmp_path):
    first = plots.save(plots.figure_index(answers()), tmp_path / "a" / "fig.4")
    again = plots.save(plots.figure_index(answers()), tmp_path / "b" / "fig.4")
    assert [file.name for file in first] == ["fig.4.svg", "fig.4.png"]
    for one, two in zip(first, again, strict=True):
        assert one.read_bytes() == two.read_bytes()


def test_pyplot_is_never_imported():
    code = "import sys, dualarm_pin.show.plots; assert 'matplotlib.pyplot' not in sys.modules"
    subprocess.run([sys.executable, "-c", code], check=True)
