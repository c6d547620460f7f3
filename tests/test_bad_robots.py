"""Robots that are wrong are refused with the true reason; those that are merely odd work.

One table: each case changes the text of a small sound robot, and states either what the message
must name (file, line of the change, joint or link, reason) or that the cell works.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from dualarm_pin.cell import Cell
from dualarm_pin.errors import InputError, MissingFileError, UnknownNameError
from dualarm_pin.relative import Relative

SOUND = """\
<?xml version="1.0" encoding="utf-8"?>
<robot name="small">
  <link name="base"/>
  <link name="upper">
    <inertial>
      <mass value="2.0"/>
      <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/>
    </inertial>
    <collision><origin xyz="0 0 0.2"/><geometry><sphere radius="0.05"/></geometry></collision>
  </link>
  <link name="fore">
    <collision><origin xyz="0 0 0.2"/><geometry><box size="0.1 0.1 0.1"/></geometry></collision>
  </link>
  <link name="hand">
    <collision><geometry><cylinder radius="0.02" length="0.1"/></geometry></collision>
  </link>
  <link name="tip"/>
  <joint name="shoulder" type="revolute">
    <parent link="base"/><child link="upper"/>
    <origin xyz="0 0 0.1" rpy="0 0 0"/><axis xyz="0 0 1"/>
    <limit lower="-2" upper="2" effort="10" velocity="1"/>
  </joint>
  <joint name="elbow" type="revolute">
    <parent link="upper"/><child link="fore"/>
    <origin xyz="0 0 0.4"/><axis xyz="0 1 0"/>
    <limit lower="-2" upper="2" effort="10" velocity="1"/>
  </joint>
  <joint name="slide" type="prismatic">
    <parent link="fore"/><child link="hand"/>
    <origin xyz="0 0 0.4"/><axis xyz="0 0 1"/>
    <limit lower="0" upper="0.2" effort="10" velocity="1"/>
  </joint>
  <joint name="flange" type="fixed">
    <parent link="hand"/><child link="tip"/><origin xyz="0 0 0.1"/>
  </joint>
</robot>
"""
ELBOW = '<origin xyz="0 0 0.4"/><axis xyz="0 1 0"/>\n    <limit lower="-2" upper="2"'
MESH = '<geometry><sphere radius="0.05"/></geometry>'


def swap(old: str, new: str) -> str:
    assert SOUND.count(old) == 1, f"{old!r} must stand once in the sound robot"
    return SOUND.replace(old, new)


def line_of(text: str, needle: str) -> int:
    return text[: text.index(needle)].count("\n") + 1


def limits(new: str) -> str:
    return swap(ELBOW, f'<origin xyz="0 0 0.4"/><axis xyz="0 1 0"/>\n    <limit {new}')


def axis(new: str) -> str:
    return swap(ELBOW, ELBOW.replace('<axis xyz="0 1 0"/>', new))


# case: text or bytes, what the message names, a piece of the line it must point at (None: no line)
REFUSED: dict[str, tuple[str | bytes, tuple[str, ...], str | None]] = {
    "not XML": ("arm: 6 joints\n", ("not valid XML",), "arm"),
    "empty": ("", ("the file is empty",), None),
    "blank": ("  \n \n", ("the file is empty",), None),
    "truncated": (SOUND[: SOUND.index("</joint>", 1200) + 1], ("not valid XML",), None),
    "wrong encoding": (SOUND.replace("small", "kl\xe4in").encode("latin-1"), ("UTF-8",), None),
    "unknown encoding": (SOUND.replace("utf-8", "utf-99"), ("not valid XML", "utf-99"), None),
    "bytes": (bytes(range(256)) * 4, ("not valid XML",), None),
    "DTD": (
        SOUND.replace("<robot name", '<!DOCTYPE robot SYSTEM "x.dtd">\n<robot name', 1),
        ("DTD", "remove it"),
        "<!DOCTYPE",
    ),
    "entities": (
        SOUND.replace(
            "<robot name",
            '<!DOCTYPE r [<!ENTITY a "aaaa"><!ENTITY b "&a;&a;&a;&a;">]>\n<robot id="&b;" name',
            1,
        ),
        ("DTD", "entities"),
        "<!DOCTYPE",
    ),
    "file entity": (
        SOUND.replace(
            "<robot name", '<!DOCTYPE r [<!ENTITY a SYSTEM "file:///etc/passwd">]><robot name', 1
        ),
        ("DTD",),
        "<!DOCTYPE",
    ),
    "SDF": ('<sdf version="1.9"><model name="a"/></sdf>', ("this is SDF, not URDF",), "<sdf"),
    "MJCF": ('<mujoco model="a"/>', ("MJCF", "not URDF"), "<mujoco"),
    "other XML": ("<note/>", ("<note> is not the root of a URDF",), "<note"),
    "no links": ('<robot name="a">\n</robot>', ("no links",), "<robot"),
    "two roots": (
        swap('<link name="tip"/>', '<link name="tip"/>\n<link name="stray"/>'),
        ("2 root links", "'base', 'stray'"),
        '<link name="stray"/>',
    ),
    "loop": (
        swap('<parent link="base"/>', '<parent link="hand"/>'),
        ("a loop", "'shoulder'", "below its own child"),
        'name="shoulder"',
    ),
    "own parent": (
        swap('<parent link="base"/>', '<parent link="upper"/>'),
        ("a loop", "'shoulder'", "its own child"),
        'name="shoulder"',
    ),
    "two parents": (
        swap('<child link="tip"/>', '<child link="fore"/>'),
        ("'fore' is already the child of joint 'elbow'", "tree"),
        'name="flange"',
    ),
    "duplicate link": (
        swap('<link name="tip"/>', '<link name="tip"/><link name="base" />'),
        ("link 'base'", "a second link", "line 3"),
        '<link name="tip"/>',
    ),
    "duplicate joint": (
        swap('name="elbow"', 'name="shoulder" '),
        ("joint 'shoulder'", "a second joint", "line 18"),
        'name="shoulder"  type',
    ),
    "undefined link": (
        swap('<child link="fore"/>', '<child link="four"/>'),
        ("joint 'elbow'", "'four' is not defined", "did you mean 'fore'"),
        '<child link="four"/>',
    ),
    "no child": (
        swap('<child link="fore"/>', ""),
        ("joint 'elbow'", "<child link=...> is missing"),
        'name="elbow"',
    ),
    "child without link": (
        swap('<child link="fore"/>', "<child/>"),
        ("joint 'elbow'", "'link' of <child> is missing"),
        "<child/>",
    ),
    "unknown joint type": (
        swap('name="elbow" type="revolute"', 'name="elbow" type="revolve"'),
        ("joint 'elbow'", "unknown joint type 'revolve'", "did you mean 'revolute'"),
        'name="elbow"',
    ),
    "no joint type": (
        swap('name="elbow" type="revolute"', 'name="elbow"'),
        ("joint 'elbow'", "'type' of <joint> is missing"),
        'name="elbow"',
    ),
    "joint without name": (
        swap('name="elbow" type', "type"),
        ("'name' of <joint> is missing",),
        '<joint type="revolute"',
    ),
    "empty link name": (
        swap('<link name="tip"/>', '<link name=" "/>'),
        ("'name' of <link> is empty",),
        '<link name=" "/>',
    ),
    "zero axis": (axis('<axis xyz="0 0 0"/>'), ("joint 'elbow'", "no direction"), 'xyz="0 0 0"'),
    "axis of two": (axis('<axis xyz="0 1"/>'), ("joint 'elbow'", "3 numbers"), '<axis xyz="0 1"'),
    "axis with NaN": (axis('<axis xyz="0 nan 1"/>'), ("joint 'elbow'", "finite"), "nan"),
    "no limit": (
        swap(ELBOW + ' effort="10" velocity="1"/>', '<origin xyz="0 0 0.4"/>'),
        ("joint 'elbow'", "no usable bounds", "limits_deg"),
        'name="elbow"',
    ),
    "no bounds": (limits(""), ("joint 'elbow'", "no usable bounds"), 'name="elbow"'),
    "no range": (
        limits('lower="1" upper="1"'),
        ("joint 'elbow'", "no range", "lower = upper = 1"),
        'name="elbow"',
    ),
    "inverted bounds": (
        limits('lower="2" upper="-2"'),
        ("joint 'elbow'", "lower=2 is above upper=-2"),
        '<limit lower="2" upper="-2"',
    ),
    "NaN bound": (
        limits('lower="nan" upper="2"'),
        ("joint 'elbow'", "'nan' is not a number", "finite"),
        'lower="nan"',
    ),
    "infinite bound": (
        limits('lower="-inf" upper="2"'),
        ("joint 'elbow'", "'-inf' is not a number", "finite"),
        "-inf",
    ),
    "overflowing bound": (
        limits('lower="-1e999" upper="2"'),
        ("joint 'elbow'", "-1e999", "finite"),
        "-1e999",
    ),
    "decimal comma": (limits('lower="-1,5" upper="2"'), ("decimal point",), "-1,5"),
    "huge bounds of a slide": (
        swap('lower="0" upper="0.2"', 'lower="-1e9" upper="1e9"'),
        ("joint 'slide'", "no usable bounds", "`limits`"),
        'name="slide"',
    ),
    "mass in words": (
        swap('<mass value="2.0"/>', '<mass value="two"/>'),
        ("link 'upper'", "'two' is not a number"),
        '<mass value="two"/>',
    ),
    "negative effort": (
        limits('lower="-2" upper="2" effort="-1" velocity="1"/><limit'),
        ("joint 'elbow'", "effort=-1 is negative"),
        'effort="-1"',
    ),
    "negative velocity": (
        limits('lower="-2" upper="2" effort="1" velocity="-1"/><limit'),
        ("joint 'elbow'", "velocity=-1 is negative"),
        'velocity="-1"',
    ),
    "far away": (
        swap('xyz="0 0 0.1" rpy="0 0 0"', 'xyz="0 0 1e30" rpy="0 0 0"'),
        ("joint 'shoulder'", "absurdly large"),
        "1e30",
    ),
    "negative size": (
        swap('radius="0.05"', 'radius="-0.05"'),
        ("link 'upper'", "<sphere> has no valid size"),
        'radius="-0.05"',
    ),
    "xacro element": (
        SOUND.replace(
            '<robot name="small">', '<robot name="small" xmlns:xacro="http://ros.org/wiki/xacro">'
        ).replace('<link name="tip"/>', '<xacro:arm side="left"/>'),
        ("<xacro:arm> is xacro", ".xacro"),
        "<xacro:arm",
    ),
    "xacro without namespace": (
        swap('<link name="tip"/>', '<xacro:arm side="left"/>'),
        ("<xacro:arm> is xacro", ".xacro"),
        "<xacro:arm",
    ),
    "xacro value": (
        limits('lower="${-pi}" upper="2"'),
        ("joint 'elbow'", "'${-pi}' is xacro", ".xacro"),
        "${-pi}",
    ),
    "floating base": (
        swap('name="shoulder" type="revolute"', 'name="shoulder" type="floating"'),
        ("joint 'shoulder'", "is floating", "fixed base"),
        'name="shoulder"',
    ),
    "planar base": (
        swap('name="shoulder" type="revolute"', 'name="shoulder" type="planar"'),
        ("joint 'shoulder'", "is planar", "fixed base"),
        'name="shoulder"',
    ),
    "mimics a stranger": (
        limits('lower="-2" upper="2" effort="1" velocity="1"/><mimic joint="x"/><limit'),
        ("joint 'elbow'", "mimics joint 'x', which does not exist"),
        'name="elbow"',
    ),
    "mimics itself": (
        limits('lower="-2" upper="2" effort="1" velocity="1"/><mimic joint="elbow"/><limit'),
        ("joint 'elbow'", "mimics itself"),
        'name="elbow"',
    ),
}


def test_a_tree_too_deep_for_pinocchio_is_refused(tmp_path: Path) -> None:
    joints = [
        f'<link name="n{k}"/><joint name="m{k}" type="fixed"><parent link="n{k - 1}"/>'
        f'<child link="n{k}"/></joint>'
        for k in range(1, 502)
    ]
    text = SOUND.replace("</robot>", '<link name="n0"/>' + "".join(joints[::-1]) + "</robot>")
    hung = text.replace("</robot>", JOIN + "</robot>")
    with pytest.raises(InputError, match=r"joint 'm496': more than 500 joints"):
        pair(write(tmp_path, hung))


JOIN = '<joint name="j" type="fixed"><parent link="tip"/><child link="n0"/></joint>'


def write(folder: Path, text: str | bytes) -> Path:
    file = folder / "small.urdf"
    file.write_bytes(text.encode() if isinstance(text, str) else text)
    return file


def pair(file: Path, tip: str = "tip") -> Cell:
    return Cell.from_urdf(file, file, tips=(tip, tip))


@pytest.mark.parametrize("case", REFUSED)
def test_is_refused_with_file_line_name_and_reason(case: str, tmp_path: Path) -> None:
    text, pieces, at = REFUSED[case]
    file = write(tmp_path, text)
    with pytest.raises(InputError) as caught:
        pair(file)
    message = str(caught.value)
    assert message.startswith(str(file)), message
    for piece in pieces:
        assert piece in message
    if at is not None:
        assert caught.value.line == line_of(str(text), at), message


WORKS: dict[str, str] = {
    "as it is": SOUND,
    "no axis means x": axis(""),
    "axis of any length": axis('<axis xyz="0 3 4"/>'),
    "lower missing means 0": limits('upper="2"'),
    "huge bounds of a revolute joint": limits('lower="-1e16" upper="1e16"'),
    "no effort": limits('lower="-2" upper="2" velocity="1"/><limit'),
    "link and joint of one name": swap('name="elbow"', 'name="fore"'),
    "names with slashes": SOUND.replace('"fore"', '"/arm/fore"').replace('"elbow"', '"/elbow"'),
    "names with spaces and signs": SOUND.replace('"fore"', '"für &amp; wider &lt;1&gt;"'),
    "missing mesh": swap(MESH, '<geometry><mesh filename="package://none/a.stl"/></geometry>'),
    "negative mass": swap('<mass value="2.0"/>', '<mass value="-2.0"/>'),
    "no inertia": swap('<inertia ixx="0.1"', '<inertia ixx_="0.1"'),
    "undeclared prefix": swap('<link name="tip"/>', '<link name="tip"/><sensor:gazebo a="1"/>'),
    "foreign elements": swap('<link name="tip"/>', '<link name="tip"/><gazebo/><transmission/>'),
    "no robot name": SOUND.replace(' name="small"', ""),
    "a default namespace": SOUND.replace("<robot ", '<robot xmlns="http://www.ros.org" '),
    "a comment on a DTD": SOUND.replace("<robot ", "<!-- no <!DOCTYPE --><robot "),
    "an unknown shape": swap(MESH, "<geometry><torus radius='1'/></geometry>"),
    "a collision without shape": swap(MESH, ""),
}


@pytest.mark.parametrize("case", WORKS)
def test_is_odd_but_works(case: str, tmp_path: Path) -> None:
    cell = pair(write(tmp_path, WORKS[case]))
    assert cell.n == 6
    at = Relative(cell, (cell.lower + cell.upper) / 2)
    assert np.isfinite(at.J_r).all()
    assert (cell.lower < cell.upper).all()


def test_a_missing_axis_is_x(tmp_path: Path) -> None:
    bare = pair(write(tmp_path, WORKS["no axis means x"]))
    q = np.full(6, 0.1)
    J_r = Relative(bare, q).J_r
    stated = pair(write(tmp_path, axis('<axis xyz="1 0 0"/>')))
    np.testing.assert_array_equal(J_r, Relative(stated, q).J_r)


def test_endless_bounds_become_a_finite_interval_with_a_warning(tmp_path: Path) -> None:
    cell = pair(write(tmp_path, WORKS["huge bounds of a revolute joint"]))
    assert cell.joints[1].continuous
    assert cell.upper[1] == pytest.approx(2 * np.pi)
    assert any("arm1/elbow: its bounds are absurdly wide" in w for w in cell.warnings)


def test_a_negative_mass_is_a_warning_and_no_inertia(tmp_path: Path) -> None:
    cell = pair(write(tmp_path, WORKS["negative mass"]))
    line = line_of(SOUND, "<inertial>")
    warning = f"small.urdf:{line}: link 'upper': mass -2 kg is negative"
    assert sum(w.startswith(warning) for w in cell.warnings) == 1
    assert "arm1/upper" in cell.links_without_inertia


MESHES: dict[str, bytes] = {
    "empty": b"",
    "text": b"this is not a mesh\n",
    "bytes": bytes(range(256)) * 8,
    "truncated": b"\0" * 80 + (1000).to_bytes(4, "little") + b"\0" * 200,
    "lying": b"\0" * 80 + (2**32 - 1).to_bytes(4, "little") + b"\0" * 200,
    "no triangles": b"\0" * 84,
    "NaN": b"\0" * 80 + (4).to_bytes(4, "little") + b"\xff" * 200,
    "ascii cut": b"solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0",
}


@pytest.mark.parametrize("suffix", ["stl", "dae", "obj", "xyz"])
@pytest.mark.parametrize("case", MESHES)
def test_a_corrupt_mesh_leaves_the_clearance_unknown(
    case: str, suffix: str, tmp_path: Path
) -> None:
    mesh = tmp_path / f"part.{suffix}"
    mesh.write_bytes(MESHES[case])
    shape = f'<geometry><mesh filename="{mesh.name}"/></geometry>'
    cell = pair(write(tmp_path, swap(MESH, shape)))
    assert cell.clearance(np.zeros(6)) is None
    assert len(cell.missing_meshes) == 2
    assert cell.missing_meshes[0].startswith("arm1/upper: ")
    assert mesh.name in cell.missing_meshes[0]


def test_a_missing_mesh_is_named_with_the_places_searched(tmp_path: Path) -> None:
    cell = pair(write(tmp_path, WORKS["missing mesh"]))
    assert cell.clearance(np.zeros(6)) is None
    assert "package://none/a.stl" in cell.missing_meshes[0]
    assert "package_dirs" in cell.missing_meshes[0]


def test_no_such_tip_names_the_nearest_link(tmp_path: Path) -> None:
    file = write(tmp_path, SOUND)
    with pytest.raises(UnknownNameError, match="no link 'hnd': did you mean 'hand'"):
        pair(file, "hnd")
    with pytest.raises(UnknownNameError, match="links at the ends: tip"):
        pair(file, "zzzzzzz")
    with pytest.raises(UnknownNameError, match=r"'elbow' is a joint.*its link is 'fore'"):
        pair(file, "elbow")


def test_both_tips_on_one_arm(tmp_path: Path) -> None:
    file = write(tmp_path, SOUND)
    for tips in (("tip", "fore"), ("fore", "tip"), ("tip", "tip"), ("hand", "tip")):
        with pytest.raises(InputError, match="both tips lie on one arm"):
            Cell.from_urdf(file, tips=tips)


def test_no_such_file(tmp_path: Path) -> None:
    with pytest.raises(MissingFileError, match=r"no such file.*none\.urdf"):
        pair(tmp_path / "none.urdf")
    with pytest.raises(MissingFileError):
        pair(tmp_path)
