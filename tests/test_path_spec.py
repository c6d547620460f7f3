"""The `path:` section: every generator from YAML, and every mistake with its line and field."""

from __future__ import annotations

import math
from pathlib import Path as FilePath

import numpy as np
import pinocchio as pin
import pytest

from dualarm_pin.errors import InputError, MissingFileError
from dualarm_pin.files.resources import urdf_folder
from dualarm_pin.files.source import check, parse_yaml, read_yaml
from dualarm_pin.path import Path, paths
from dualarm_pin.path.load import load_path
from dualarm_pin.path.paths import GENERATORS
from dualarm_pin.path.spec import PathSpec

HERE = FilePath()


def load(section: str, folder: FilePath = HERE) -> Path:
    source = parse_yaml("path:\n" + section, folder / "task.yaml")
    return load_path(check(source, PathSpec, ["path"]), source)


SAME = {
    "corner: {}": paths.corner(),
    "corner: {side: 0.2, fillet: 0.02, height: 0.4, points: [5, 3, 4]}": paths.corner(
        0.2, 0.02, 0.4, (5, 3, 4)
    ),
    "corner: {points: 31}": paths.corner(points=31),
    "corner: {step: 0.01}": paths.corner(step=0.01),
    "polyline: {vertices: [[0, 0, 0], [1, 0, 0], [1, 1, 0]], fillet: 0.1, points: 9}": (
        paths.polyline([[0, 0, 0], [1, 0, 0], [1, 1, 0]], fillet=0.1, points=9)
    ),
    "circle: {radius: 0.3, points: 61}": paths.circle(0.3, points=61),
    "circle: {radius: 0.3, start_deg: 90, turns: -0.5, center: [1, 2], step: 0.1}": paths.circle(
        0.3, start=math.pi / 2, turns=-0.5, center=(1, 2), step=0.1
    ),
    "arc: {radius: 0.3, start_deg: 0, stop_deg: 180, points: 5}": paths.arc(
        0.3, 0, math.pi, points=5
    ),
    "helix: {radius: 0.06, pitch: 0.04, turns: 2, points: 61}": paths.helix(
        0.06, 0.04, 2, points=61
    ),
    "raster: {width: 0.24, depth: 0.16, rows: 5, points: 69}": paths.raster(
        0.24, 0.16, 5, points=69
    ),
    "sine: {length: 0.2, height: 0.4, points: 41}": paths.sine(0.2, height=0.4, points=41),
    "figure_eight: {radius: 0.04, points: 49}": paths.figure_eight(0.04, points=49),
    "dome_spiral: {radius: 0.15, inner_deg: 20, points: 61}": paths.dome_spiral(
        0.15, inner=math.radians(20), points=61
    ),
    "tube_seam: {radius: 0.05, tube_radius: 0.09, tilt_deg: 30, points: 49}": paths.tube_seam(
        0.05, 0.09, tilt=math.radians(30), points=49
    ),
    "spline: {through: [[0, 0, 0], [1, 0, 0], [1, 1, 0]], closed: true, points: 9}": paths.spline(
        [[0, 0, 0], [1, 0, 0], [1, 1, 0]], closed=True, points=9
    ),
}


def test_every_generator_is_tried():
    tried = {section.partition(":")[0] for section in SAME} | {"csv", "gcode", "apt"}
    assert tried == set(GENERATORS)


@pytest.mark.parametrize("section", SAME)
def test_yaml_says_the_same_as_python(section):
    path, expected = load("  " + section), SAME[section]
    assert path.h == expected.h
    for name in ("position", "rotation", "u", "tangent", "arc_length", "rows"):
        np.testing.assert_allclose(getattr(path, name), getattr(expected, name), atol=1e-15)


def test_how_the_tool_is_held():
    path = load(
        "  circle: {radius: 0.3, points: 3}\n"
        "  rpy_deg: [180, 0, 90]\n"
        "  free: [none, spin, rotation]\n"
        "  spin_axis: [0, 1, 0]\n"
        "  frame: {xyz: [0, 0, 1], rpy_deg: [0, 0, 90]}\n"
    )
    np.testing.assert_array_equal(path.rows, [6, 5, 3])
    np.testing.assert_array_equal(path.spin_axis, [0, 1, 0])
    np.testing.assert_allclose(path.position[0], [0, 0.3, 1.3], atol=1e-12)
    expected = pin.rpy.rpyToMatrix(math.pi, 0, math.pi)
    np.testing.assert_allclose(path.rotation[0], expected, atol=1e-12)
    tangent = load("  circle: {radius: 0.3, points: 3}\n  orientation: tangent\n")
    np.testing.assert_allclose(tangent.rotation[0][:, 0], [0, 1, 0], atol=1e-12)
    turned = "  frame: {rotation: [[0, -1, 0], [1, 0, 0], [0, 0, 1]]}"
    same = "  frame: {rpy: [0, 0, 1.5707963267948966]}"
    for line in (turned, same):
        moved = load("  circle: {radius: 0.3, points: 3}\n" + line)
        np.testing.assert_allclose(moved.position[0], [0, 0.3, 0.3], atol=1e-12)


def test_files_are_found_beside_the_task(tmp_path):
    (tmp_path / "p.csv").write_text("x,y,z,qw,qx,qy,qz\n0,0,0,1,0,0,0\n1,0,0,1,0,0,0\n")
    (tmp_path / "p.nc").write_text("G1 X10\n")
    (tmp_path / "p.apt").write_text("GOTO/0,0,0\nGOTO/10,0,0\n")
    assert load("  csv: p.csv", tmp_path).h == 2
    assert load("  csv: {file: p.csv, points: 5, smooth: true}", tmp_path).h == 5
    assert load("  apt: p.apt", tmp_path).h == 2
    assert load("  apt: {file: p.apt, step: 0.005}", tmp_path).h == 3
    gcode = "  gcode: {file: p.nc, points: 3, work_offset: [0, 0, 0.3]}"
    np.testing.assert_allclose(load(gcode, tmp_path).position[2], [0.01, 0, 0.3])
    with pytest.raises(MissingFileError, match=r"q\.csv: no such file"):
        load("  csv: q.csv", tmp_path)
    with pytest.raises(InputError, match=r"p\.csv:1: the file gives the rotation"):
        load("  csv: p.csv\n  rpy_deg: [0, 0, 0]", tmp_path)


C = "  circle: {radius: 0.1, points: 5}\n"
REFUSED = [
    ("  cornr: {}", "task.yaml:2: path.cornr: unknown key: did you mean 'corner'"),
    ("  free: none", "task.yaml:1: path: exactly one curve is expected; given none; known: corner"),
    (C + "  corner: {}", "path: exactly one curve is expected; given corner, circle"),
    (C + "  rotatoin: 1", "task.yaml:3: path.rotatoin: unknown key: did you mean 'rotation'"),
    ("  circle: {radus: 0.1, points: 5}", "path.circle.radus: unknown key: did you mean 'radius'"),
    ("  circle: {points: 5}", "task.yaml:2: path.circle.radius: this key is missing"),
    ("  circle:\n    radius: x\n    points: 5", "task.yaml:3: path.circle.radius: .*given 'x'"),
    ("  circle:\n    radius: -1\n    points: 5", "task.yaml:3: path.circle.radius: a number above"),
    ("  circle: {radius: .nan, points: 5}", "path.circle.radius: .*finite number; given nan"),
    ("  circle: {radius: 1, points: 5, step: 1}", "path.circle: give one of .*both are given"),
    ("  circle: {radius: 1}", "path.circle: give one of points and step: neither is given"),
    ("  circle: {radius: 1, points: 1}", "path.circle.points: .*greater than or equal to 2"),
    ("  circle: {radius: 1, step: 0}", "path.circle.step: .*greater than 0; given 0"),
    ("  circle: {radius: 1, points: 5, center: [0]}", "path.circle.center"),
    ("  arc: {radius: 1, start_deg: 5, stop_deg: 5, points: 5}", "path.arc.stop_deg: the arc has"),
    ("  corner: {points: [13, 5]}", r"path.corner.points: three numbers.*given \[13, 5\]"),
    ("  corner: {fillet: 0.2}", "path.corner.fillet: a radius above 0 and below the side 0.15"),
    ("  corner: {points: 31, step: 0.1}", "path.corner: give points or step: both are given"),
    (
        "  tube_seam: {radius: 0.1, tube_radius: 0.2, tilt_deg: 120, points: 5}",
        "path.tube_seam.tilt_deg: an angle within 90 degrees is expected; given 120",
    ),
    ("  csv: {file: a.csv, points: 5, step: 1}", "path.csv: give points or step, or neither"),
    ("  gcode: {file: a.nc}", "path.gcode: give one of points and step: neither"),
    (C + "  rotation: [[1, 0, 0], [0, 1, 0], [0, 0, 2]]", "task.yaml:3: path.rotation: .*by 3;"),
    (C + "  rotation: [[1, 0, 0], [0, 1, 0], [0, 0, -1]]", "path.rotation: the matrix is a mirror"),
    (C + "  rotation: [[1, 0], [0, 1]]", "task.yaml:3: path.rotation"),
    (
        C + "  rotation: [[1, 0, 0], [0, 1, 0], [0, 0, 1]]\n  rpy_deg: [0, 0, 0]",
        "path: give rotation or rpy_deg: both are given",
    ),
    (C + "  orientation: tangents", "task.yaml:3: path.orientation: .*given 'tangents'"),
    ("  helix: {radius: 1, pitch: 1, turns: 1, points: 5}\n  orientation: normal",
     "task.yaml:3: path.orientation: 'normal' needs a surface"),
    (C + "  free: [spin, none]", "path.free: one word, or one for each of the 5 points; given 2"),
    (C + "  free: spinning", "task.yaml:3: path.free"),
    (C + "  spin_axis: [0, 0, 0]", "task.yaml:3: path.spin_axis: the axis has no length"),
    ("  csv: {file: a.csv, point: 5}", "path.csv.point: unknown key: did you mean 'points'"),
    ("  csv: [a.csv]", "task.yaml:2: path.csv: "),
    ("  csv: 5", "task.yaml:2: path.csv: "),
    (C + "  free: [none, spinn, none, none, none]", "task.yaml:3: path.free.*'none', 'spin' or"),
    ("  corner: {points: [13, x, 13]}", "task.yaml:2: path.corner.points.*given 'x'"),
    ("  polyline: {vertices: [[0, 0, 0], [1, 0]], points: 5}", "path.polyline.vertices.1"),
    ("  polyline: {vertices: [[0, 0, 0]], points: 5}", "path.polyline.vertices: 2 points or more"),
    (C + "  frame: {xyz: [0, 0]}", "task.yaml:3: path.frame.xyz"),
]  # fmt: skip


@pytest.mark.parametrize(("section", "message"), REFUSED)
def test_refused(section, message):
    source = parse_yaml("path:\n" + section, "task.yaml")
    with pytest.raises(InputError, match=message):
        load_path(check(source, PathSpec, ["path"]), source)


POINTS = {
    "paper_corner": 31, "circle": 61, "b01": 31, "b02": 49, "b03": 69, "b04": 61, "b05": 49,
    "b06": 61, "b07": 61, "b08": 31, "b09": 39, "b10": 41, "b11": 33, "b12": 49,
}  # fmt: skip


@pytest.mark.parametrize("name", POINTS)
def test_paths_of_the_tasks_that_ship_with_the_package(name):
    file = urdf_folder() / "tasks" / f"{name}.yaml"
    source = read_yaml(file)
    path = load_path(check(source, PathSpec, ["path"]), source)
    assert path.h == POINTS[name]
    assert np.all(path.rows == 6)
    z = path.rotation[:, 2, 2]
    assert np.all(z < 0)  # the tool looks at e1
    assert np.diff(path.arc_length).max() < 0.05
