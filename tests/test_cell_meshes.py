"""Mesh files read as Assimp reads them when they are sound, and refused when they are not."""

from __future__ import annotations

from pathlib import Path

import coal
import numpy as np
import pytest
from robot_table import needs_robots

from dualarm_pin.errors import InputError
from dualarm_pin.files.resources import urdf_folder
from dualarm_pin.meshes import hull, load
from dualarm_pin.meshes.formats import read_mesh
from dualarm_pin.meshes.load import load_mesh
from dualarm_pin.robot.packages import robot_data_share

UNIT = (1.0, 1.0, 1.0)
REAL = [
    "ur_description/meshes/ur5/visual/wrist3.dae",
    "ur_description/meshes/ur5/collision/wrist3.stl",
    "panda_description/meshes/visual/hand.dae",
    "baxter_description/meshes/wrist/W2.DAE",
    "go2_description/visuals/hip.dae",
]


def same_body(file: Path) -> None:
    points, triangles = read_mesh(file)
    theirs = np.array(coal.MeshLoader().load(str(file), np.ones(3)).vertices())
    ours = points[np.unique(triangles)]
    for bound in (np.min, np.max):
        np.testing.assert_allclose(bound(ours, axis=0), bound(theirs, axis=0), atol=1e-6)


@needs_robots
@pytest.mark.parametrize("name", REAL)
def test_agrees_with_assimp(name: str) -> None:
    file = robot_data_share() / "example-robot-data" / "robots" / name
    if not file.is_file():
        pytest.skip(f"this version of example-robot-data has no {name}")
    same_body(file)


def test_agrees_with_assimp_on_our_own_meshes() -> None:
    for file in sorted((urdf_folder() / "ns16" / "meshes").glob("*.stl")):
        same_body(file)


SQUARE = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
COLLADA = """\
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
  <asset><unit meter="0.01"/><up_axis>Y_UP</up_axis></asset>
  <library_geometries><geometry id="g"><mesh>
    <source id="s"><float_array id="f" count="12">0 0 0 1 0 0 1 1 0 0 1 0</float_array>
      <technique_common><accessor source="#f" count="4" stride="3"/></technique_common></source>
    <vertices id="v"><input semantic="POSITION" source="#s"/></vertices>
    <polylist count="1"><input semantic="VERTEX" source="#v" offset="1"/>
      <input semantic="NORMAL" source="#s" offset="0"/>
      <vcount>4</vcount><p>3 0 2 1 1 2 0 3</p></polylist>
  </mesh></geometry></library_geometries>
  <library_nodes>
    <node id="n"><scale>2 2 2</scale><instance_geometry url="#g"/></node>
  </library_nodes>
  <library_visual_scenes><visual_scene id="w">
    <node><translate>100 0 0</translate><rotate>0 0 1 90</rotate><instance_node url="#n"/></node>
  </visual_scene></library_visual_scenes>
  <scene><instance_visual_scene url="#w"/></scene>
</COLLADA>
"""


def test_collada_nodes_units_and_polygons(tmp_path: Path) -> None:
    file = tmp_path / "square.dae"
    file.write_text(COLLADA)
    points, triangles = read_mesh(file)
    expected = np.array([[0, 0, 0], [0, 2, 0], [-2, 2, 0], [-2, 0, 0]]) * 0.01 + [1, 0, 0]
    np.testing.assert_allclose(points, expected, atol=1e-15)
    np.testing.assert_array_equal(triangles, [[0, 1, 2], [0, 2, 3]])


def test_obj_polygons_and_indices_from_the_end(tmp_path: Path) -> None:
    file = tmp_path / "square.obj"
    file.write_text(f"# a square\n{SQUARE}vn 0 0 1\nf 1//1 2//1 3//1 -1//1\n")
    np.testing.assert_array_equal(read_mesh(file)[1], [[0, 1, 2], [0, 2, 3]])


@pytest.mark.parametrize(
    ("name", "text", "reason"),
    [
        ("a.obj", f"{SQUARE}f 1 2 7\n", "a corner that does not exist"),
        ("b.obj", f"{SQUARE}f 1 2 x\n", "invalid literal"),
        ("c.obj", SQUARE, "no triangles"),
        ("d.obj", SQUARE.replace("1", "1e30") + "f 1 2 3\n", "absurdly far"),
        ("e.obj", SQUARE.replace("1", "nan") + "f 1 2 3\n", "not finite"),
        ("f.dae", COLLADA.replace(" 0 3<", " 0<"), "reshape"),
        ("g.dae", COLLADA.replace(" 0 3<", " 0 8<"), "a corner that does not exist"),
        ("h.dae", COLLADA.replace("<vcount>4", "<vcount>7"), "do not add up"),
        ("i.dae", COLLADA.replace('url="#w"', 'url="#x"'), "'#x' does not exist"),
        ("j.dae", COLLADA.replace('url="#g"', 'url="#x"'), "shows no triangles"),
        (
            "k.dae",
            COLLADA.replace('<instance_geometry url="#g"/>', '<instance_node url="#n"/>' * 9),
            "too deeply",
        ),
        ("l.dae", COLLADA.replace("<COLLADA", "<!DOCTYPE a><COLLADA"), "DTD"),
        ("m.dae", "<a/>", "not the root of a Collada file"),
        ("n.ply", "ply\n", "convert it to STL, OBJ or DAE"),
    ],
)
def test_a_damaged_mesh_is_refused_with_its_reason(
    name: str, text: str, reason: str, tmp_path: Path
) -> None:
    file = tmp_path / name
    file.write_text(text)
    with pytest.raises(InputError, match=reason) as caught:
        load_mesh(file, UNIT, hull=True)
    assert caught.value.file == file


@pytest.mark.parametrize("flat", ["square", "line", "point"])
def test_bodies_without_volume_get_a_thin_one(flat: str, tmp_path: Path) -> None:
    """Coal crashes on them: a quad as a ground plane is an ordinary mesh."""
    text = {
        "square": SQUARE,
        "line": "v 0 0 0\nv 1 0 0\nv 2 0 0\n",
        "point": "v 3 1 1\nv 3 1 1\nv 3 1 1\n",
    }[flat]
    file = tmp_path / "flat.obj"
    file.write_text(f"{text}f 1 2 3\n")
    hull = load_mesh(file, UNIT, hull=True)
    ball = coal.Sphere(0.1)
    result = coal.DistanceResult()
    above = coal.Transform3s(np.eye(3), np.array([0.5, 0.2, 2.0]))
    distance = coal.distance(hull, coal.Transform3s(), ball, above, coal.DistanceRequest(), result)
    points = read_mesh(file)[0]
    nearest = {"square": 2.0, "line": np.hypot(0.2, 2.0)}.get(
        flat, np.linalg.norm(points[0] - [0.5, 0.2, 2.0])
    )
    assert distance == pytest.approx(nearest - 0.1, abs=2e-4)


def test_a_changed_file_is_read_again(tmp_path: Path) -> None:
    file = tmp_path / "square.obj"
    file.write_text(f"{SQUARE}f 1 2 3 4\n")
    first = load_mesh(file, UNIT, hull=False)
    assert load_mesh(file, UNIT, hull=False) is first
    file.write_text(f"{SQUARE}f 1 2 3\n")
    assert load_mesh(file, UNIT, hull=False).num_tris == 1


def test_a_mesh_with_more_triangles_than_load_in_ten_seconds_is_refused_with_advice(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = tmp_path / "square.obj"
    file.write_text(SQUARE + "f 1 2 3\nf 1 3 4\n")
    monkeypatch.setattr(load, "_MOST", 2)
    assert load_mesh(file, UNIT, True) is not None
    monkeypatch.setattr(load, "_MOST", 1)
    with pytest.raises(InputError, match=r"2 triangles are more than 1, .*: simplify the mesh"):
        load_mesh(file, UNIT, False)


def test_a_finely_cut_ball_is_too_round(monkeypatch: pytest.MonkeyPatch) -> None:
    """Every corner of it is on its hull, which no distance could be measured from."""
    around = np.random.default_rng(0).normal(size=(6000, 3))
    ball = around / np.linalg.norm(around, axis=1)[:, None]
    monkeypatch.setattr(hull, "_MANY", 5000)
    assert hull.too_round(ball)
    ball[:3500] *= 0.5
    assert not hull.too_round(ball)
