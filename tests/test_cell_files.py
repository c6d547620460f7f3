"""Cell files: every way to state a cell, and every mistake with file, line and key."""

from __future__ import annotations

import math
import resource
import sys
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
from test_bad_robots import SOUND

from dualarm_pin.cell import Cell
from dualarm_pin.errors import InputError, MissingExtraError, MissingFileError, UnknownNameError
from dualarm_pin.relative import Relative

TORSO = """\
<robot name="twin">
  <link name="floor"/><link name="trunk"/><link name="head"/>
  <link name="l1"/><link name="l2"/><link name="l3"/><link name="lf"/>
  <link name="r1"/><link name="r2"/><link name="r3"/>
  <joint name="lift" type="prismatic"><parent link="floor"/><child link="trunk"/>
    <origin xyz="0 0 0.5"/><axis xyz="0 0 1"/>
    <limit lower="0.1" upper="0.4" effort="1" velocity="1"/></joint>
  <joint name="neck" type="continuous"><parent link="trunk"/><child link="head"/></joint>
  <joint name="la" type="revolute"><parent link="trunk"/><child link="l1"/>
    <origin xyz="0 0.2 0.5"/><axis xyz="0 1 0"/>
    <limit lower="-1" upper="2" effort="1" velocity="1"/></joint>
  <joint name="lb" type="continuous"><parent link="l1"/><child link="l2"/>
    <origin xyz="0 0 0.4"/><axis xyz="1 0 0"/></joint>
  <joint name="lc" type="revolute"><parent link="l2"/><child link="l3"/>
    <origin xyz="0 0 0.4"/><axis xyz="0 0 1"/>
    <limit lower="-1" upper="2" effort="1" velocity="1"/>
    <mimic joint="la" multiplier="-0.5" offset="0.3"/></joint>
  <joint name="lg" type="prismatic"><parent link="l3"/><child link="lf"/><axis xyz="0 1 0"/>
    <limit lower="0.01" upper="0.04" effort="1" velocity="1"/></joint>
  <joint name="ra" type="revolute"><parent link="trunk"/><child link="r1"/>
    <origin xyz="0 -0.2 0.5"/><axis xyz="0 1 0"/>
    <limit lower="-1" upper="2" effort="1" velocity="1"/></joint>
  <joint name="rb" type="revolute"><parent link="r1"/><child link="r2"/>
    <origin xyz="0 0 0.4"/><axis xyz="1 0 0"/>
    <limit lower="-1" upper="2" effort="1" velocity="1"/></joint>
  <joint name="rc" type="revolute"><parent link="r2"/><child link="r3"/>
    <origin xyz="0 0 0.4"/><axis xyz="0 0 1"/>
    <limit lower="-1" upper="2" effort="1" velocity="1"/></joint>
</robot>
"""
TWIN = "urdf: twin.urdf\narms:\n  arm1: {tip: l3}\n  arm2: {tip: r3}\n"
PAIR = """\
arms:
  arm1: {urdf: small.urdf, tip: tip}
  arm2: {urdf: small.urdf, tip: tip, base: {xyz: [1, 0, 0], rpy_deg: [0, 0, 90]}}
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "small.urdf").write_text(SOUND)
    (tmp_path / "twin.urdf").write_text(TORSO)
    return tmp_path


def load(folder: Path, text: str) -> Cell:
    file = folder / "cell.yaml"
    file.write_text(text, encoding="utf-8")
    return Cell.load(file)


def refusal(folder: Path, text: str) -> InputError:
    with pytest.raises(InputError) as caught:
        load(folder, text)
    assert caught.value.file == folder / "cell.yaml", caught.value
    return caught.value


def at(cell: Cell, q: list[float]) -> pin.SE3:
    return Relative(cell, q).T_e1_e2


def differences_agree(cell: Cell) -> None:
    from test_relative import derivative_difference, difference

    q = np.random.default_rng(5).uniform(cell.lower, cell.upper)
    np.testing.assert_allclose(Relative(cell, q).J_r, difference(cell, q), atol=1e-8)
    np.testing.assert_allclose(Relative(cell, q).dJ_r, derivative_difference(cell, q), atol=1e-8)


def test_base_placement_and_degrees(folder: Path) -> None:
    cell = load(folder, PAIR)
    T = at(cell, [0, 0, 0, 0, 0, 0])
    np.testing.assert_allclose(T.translation, [1, 0, 0], atol=1e-15)
    np.testing.assert_allclose(T.rotation, [[0, -1, 0], [1, 0, 0], [0, 0, 1]], atol=1e-15)
    assert cell.name == "cell"


@pytest.mark.parametrize(
    "rotation",
    [
        "rpy_deg: [0, 90, 0]",
        f"rpy: [0, {math.pi / 2}, 0]",
        "rotation: [[0, 0, 1], [0, 1, 0], [-1, 0, 0]]",
    ],
)
def test_a_tool_is_a_frame_in_the_tip(folder: Path, rotation: str) -> None:
    tool = PAIR.replace("tip: tip, base", f"tip: tip, tool: {{xyz: [0, 0, 0.2], {rotation}}}, base")
    T = at(load(folder, tool), [0, 0, 0, 0, 0, 0])
    np.testing.assert_allclose(T.translation, [1, 0, 0.2], atol=1e-15)
    turned = [[0, -1, 0], [1, 0, 0], [0, 0, 1]] @ np.array([[0, 0, 1], [0, 1, 0], [-1, 0, 0]])
    np.testing.assert_allclose(T.rotation, turned, atol=1e-15)


def test_common_joints_are_locked_inside_their_bounds(folder: Path) -> None:
    cell = load(folder, TWIN)
    assert cell.joint_names == ("arm1/la", "arm1/lb", "arm2/ra", "arm2/rb", "arm2/rc")
    assert cell.locked == {"common/lift": 0.1, "common/neck": 0.0, "arm1/lg": 0.01}


def test_a_common_joint_can_be_set_free(folder: Path) -> None:
    cell = load(folder, TWIN + "free: [lift]\n")
    assert cell.joint_names[-1] == "common/lift"
    assert (cell.lower[-1], cell.upper[-1]) == (0.1, 0.4)
    assert not cell.same_order  # Pinocchio has it first
    differences_agree(cell)
    q = (cell.lower + cell.upper) / 2
    assert not Relative(cell, q).J_r[:, -1].any()


def test_a_mimic_joint_in_a_chain_follows(folder: Path) -> None:
    cell = load(folder, TWIN)
    assert cell.n == 5
    assert cell.model.nv == 6
    q = np.array([0.4, 0.1, 0.2, 0.3, 0.5])
    full = dict(zip(list(cell.model.names)[1:], cell.model_q(q), strict=True))
    assert full["arm1/lc"] == pytest.approx(-0.5 * 0.4 + 0.3)
    assert full["arm2/rc"] == 0.5
    differences_agree(cell)


def test_a_follower_narrows_the_bounds_of_its_leader(folder: Path) -> None:
    tight = TORSO.replace(
        '<mimic joint="la" multiplier="-0.5"', '<mimic joint="la" multiplier="-2"'
    )
    (folder / "twin.urdf").write_text(tight)
    cell = load(folder, TWIN)
    assert cell.lower[0] == pytest.approx((2 - 0.3) / -2)
    assert cell.upper[0] == pytest.approx((-1 - 0.3) / -2)
    assert any("arm1/la: narrowed" in warning for warning in cell.warnings)


def test_a_continuous_joint_is_a_plain_angle(folder: Path) -> None:
    cell = load(folder, TWIN)
    joint = cell.joints[1]
    assert joint.continuous
    assert (joint.lower, joint.upper) == (-2 * math.pi, 2 * math.pi)
    assert cell.model.nq == cell.model.nv
    wider = load(folder, TWIN + "limits_deg: {lb: [-720, 720]}\n")
    assert wider.upper[1] == pytest.approx(4 * math.pi)
    assert not any("wider" in warning for warning in wider.warnings)


def test_locking_works_for_every_joint(folder: Path) -> None:
    cell = load(folder, TWIN + "lock: {lift: 0.3}\nlock_deg: {rc: 90, neck: 30}\n")
    assert cell.joint_names == ("arm1/la", "arm1/lb", "arm2/ra", "arm2/rb")
    assert cell.locked["common/lift"] == 0.3
    assert cell.locked["common/neck"] == pytest.approx(math.pi / 6)
    free = load(folder, TWIN)
    T = at(cell, [0.1, 0.2, 0.3, 0.4])
    same = at(free, [0.1, 0.2, 0.3, 0.4, math.pi / 2])
    np.testing.assert_allclose(T.homogeneous, same.homogeneous, atol=1e-14)
    differences_agree(cell)


def test_bounds_in_degrees_and_metres(folder: Path) -> None:
    cell = load(
        folder,
        PAIR
        + "limits_deg: {elbow: [-10, 20], arm2/shoulder: [0, 30]}\n"
        + "limits: {slide: [0.05, 0.1]}\n"
        + "velocity_deg: {elbow: 90}\n",
    )
    np.testing.assert_allclose(np.degrees(cell.lower[[1, 4]]), [-10, -10])
    np.testing.assert_allclose(np.degrees(cell.upper[[0, 3]]), [np.degrees(2), 30])
    np.testing.assert_allclose(cell.upper[[2, 5]], 0.1)
    assert cell.joints[1].velocity == pytest.approx(math.pi / 2)
    assert cell.warnings == ()


def test_wider_bounds_are_a_warning(folder: Path) -> None:
    cell = load(folder, PAIR + "limits_deg: {arm1/elbow: [-170, 20]}\n")
    assert cell.warnings == (
        "arm1/elbow: bounds -170..20 deg are wider than those of the URDF, -114.592..114.592 deg",
    )


def test_bounds_of_the_cell_replace_those_the_urdf_lacks(folder: Path) -> None:
    (folder / "small.urdf").write_text(SOUND.replace('lower="0" upper="0.2"', ""))
    cell = load(folder, PAIR + "limits: {slide: [0, 0.1]}\n")
    assert cell.upper[2] == 0.1
    assert any("arm1/slide: no usable bounds in the URDF" in w for w in cell.warnings)


def test_an_arm_without_a_robot_is_a_frame_that_stands_still(folder: Path) -> None:
    text = "arms:\n  arm1: {urdf: small.urdf, tip: tip}\n  arm2: {base: {xyz: [0.5, 0, 0.3]}}\n"
    cell = load(folder, text)
    assert cell.joint_names == ("arm1/shoulder", "arm1/elbow", "arm1/slide")
    np.testing.assert_allclose(at(cell, [0, 0, 0]).translation, [0.5, 0, 0.3 - 1.0])
    differences_agree(cell)
    assert cell.clearance(np.zeros(3)).distance > 0


def test_an_arm_whose_tip_is_its_root_stands_still(folder: Path) -> None:
    text = (
        "arms:\n  arm1: {urdf: small.urdf, tip: base, base: {xyz: [0.5, 0, 0.3]}}\n"
        "  arm2: {urdf: small.urdf, tip: tip}\n"
    )
    cell = load(folder, text)
    assert [joint.arm for joint in cell.joints] == ["arm2"] * 3
    differences_agree(cell)


@pytest.mark.parametrize(("tip", "dofs"), [("upper", 1), ("fore", 2), ("hand", 3)])
def test_short_arms(folder: Path, tip: str, dofs: int) -> None:
    text = PAIR.replace(
        "arm2: {urdf: small.urdf, tip: tip", f"arm2: {{urdf: small.urdf, tip: {tip}"
    )
    cell = load(folder, text)
    assert cell.n == 3 + dofs
    assert cell.model.nv == cell.n  # what hangs beyond the tip is locked
    differences_agree(cell)


def test_paths_are_relative_to_the_cell_file(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir("/")
    assert load(folder, PAIR).n == 6


def test_packages_are_found_without_the_environment(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    description = folder / "ws" / "my_robot" / "urdf"
    description.mkdir(parents=True)
    (description / "small.urdf").write_text(SOUND)
    named = PAIR.replace("small.urdf", "package://my_robot/urdf/small.urdf")
    for variable in ("ROS_PACKAGE_PATH", "AMENT_PREFIX_PATH"):
        monkeypatch.setenv(variable, str(folder / "ws"))
    error = refusal(folder, named)
    assert isinstance(error, MissingFileError)
    assert (error.line, error.field) == (2, "arms.arm1.urdf")
    assert "package_dirs" in error.message
    assert load(folder, named + "package_dirs: [ws]\n").n == 6
    assert load(folder, named + "package_dirs: [ws/my_robot]\n").n == 6
    near = folder / "ws" / "my_robot" / "cells"
    near.mkdir()
    assert load(near, named).n == 6  # through the parents of the file that names it


def test_without_the_extra_a_message_says_how_to_get_it(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from dualarm_pin.robot import packages

    monkeypatch.setattr(packages, "robot_data_share", lambda: None)
    text = PAIR.replace("small.urdf", "package://example-robot-data/robots/a/b.urdf")
    with pytest.raises(MissingExtraError, match=r"pip install 'dualarm-pin\[robots\]'"):
        load(folder, text)


SRDF = """\
<robot name="small">
  <group name="arm"><chain base_link="base" tip_link="tip"/></group>
  <group name="by_joints"><joint name="shoulder"/><joint name="slide"/></group>
  <disable_collisions link1="upper" link2="hand" reason="Never"/>
  <disable_collisions link1="upper" link2="hnd" reason="Never"/>
</robot>
"""


def test_an_srdf_removes_pairs_and_names_tips(folder: Path) -> None:
    (folder / "small.srdf").write_text(SRDF)
    plain = load(folder, PAIR)
    described = load(folder, PAIR.replace("tip: tip", "group: arm, srdf: small.srdf"))

    def pairs(cell: Cell) -> set[frozenset[str]]:
        names = [item.name for item in cell.collision.geometryObjects]
        return {
            frozenset((names[pair.first], names[pair.second]))
            for pair in cell.collision.collisionPairs
        }

    gone = pairs(plain) - pairs(described)
    assert gone == {frozenset((f"{a}/upper_0", f"{a}/hand_0")) for a in ("arm1", "arm2")}
    assert pairs(described) < pairs(plain)
    assert any("no link 'hnd': did you mean 'hand'" in w for w in described.warnings)
    assert described.arms[0].tip == "tip"
    by_joints = load(folder, PAIR.replace("tip: tip", "group: by_joints, srdf: small.srdf"))
    assert by_joints.arms[0].tip == "hand"


BAD_SRDF = {
    "not XML": ("robot\n", "small.srdf:1: not valid XML"),
    "another format": ("<a/>", "small.srdf:1: this is not an SRDF"),
    "a link missing": (
        '<robot><disable_collisions link1="upper"/></robot>',
        "'link2' of <disable_collisions> is missing",
    ),
    "of another robot": (
        '<robot><disable_collisions link1="a" link2="b"/></robot>',
        "none of its 1 pairs exists in small.urdf",
    ),
    "a DTD": ("<!DOCTYPE a><robot/>", "DTD"),
}


@pytest.mark.parametrize("case", BAD_SRDF)
def test_a_bad_srdf_is_refused(case: str, folder: Path) -> None:
    text, reason = BAD_SRDF[case]
    (folder / "small.srdf").write_text(text)
    with pytest.raises(InputError) as caught:
        load(folder, PAIR.replace("tip: tip}", "tip: tip, srdf: small.srdf}"))
    assert reason in str(caught.value)
    assert caught.value.file == folder / "small.srdf"


def test_an_unknown_group_names_the_nearest(folder: Path) -> None:
    (folder / "small.srdf").write_text(SRDF)
    with pytest.raises(UnknownNameError, match=r"no group 'arn'.*did you mean 'arm'"):
        load(folder, PAIR.replace("tip: tip}", "group: arn, srdf: small.srdf}"))


def test_one_srdf_serves_the_same_urdf_twice(folder: Path) -> None:
    (folder / "small.srdf").write_text(SRDF)
    file, srdf = folder / "small.urdf", folder / "small.srdf"
    bare = Cell.from_urdf(file, file, tips=("tip", "tip"))
    cell = Cell.from_urdf(file, file, tips=("tip", "tip"), srdf=srdf)
    assert len(bare.collision.collisionPairs) - len(cell.collision.collisionPairs) == 2


def test_adjacent_links_and_links_fixed_to_each_other_are_not_checked(folder: Path) -> None:
    cell = load(folder, PAIR)
    names = [item.name for item in cell.collision.geometryObjects]
    pairs = {(names[pair.first], names[pair.second]) for pair in cell.collision.collisionPairs}
    assert ("arm1/upper_0", "arm1/fore_0") not in pairs
    assert ("arm1/upper_0", "arm1/hand_0") in pairs
    across = {(a, b) for a, b in pairs if a[:4] != b[:4]}
    assert len(across) == 9


def test_pairs_that_always_touch_are_dropped_and_named(folder: Path) -> None:
    fat = SOUND.replace('<sphere radius="0.05"/>', '<sphere radius="0.9"/>')
    (folder / "small.urdf").write_text(fat)
    cell = load(folder, PAIR.replace("[1, 0, 0]", "[5, 0, 0]"))
    assert cell.dropped_pairs == tuple(
        f"{arm}/hand and {arm}/upper touch in nearly every posture: not checked"
        for arm in ("arm1", "arm2")
    )
    assert cell.clearance(np.zeros(6)).distance > 1


INCLUDES = """\
<robot name="small" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:include filename="parts/all.xacro"/>
</robot>
"""


def test_xacro_is_expanded(folder: Path) -> None:
    pytest.importorskip("xacrodoc")
    text = SOUND.replace(
        '<robot name="small">',
        '<robot name="small" xmlns:xacro="http://www.ros.org/wiki/xacro">'
        '<xacro:arg name="reach" default="0.4"/>'
        '<xacro:property name="reach" value="$(arg reach)"/>',
    ).replace('xyz="0 0 0.4"', 'xyz="0 0 ${2 * reach}"')
    (folder / "small.urdf.xacro").write_text(text)
    named = PAIR.replace("small.urdf", "small.urdf.xacro")
    moved = named.replace("tip: tip, base", "tip: tip, xacro: {reach: 0.5}, base")
    q = np.zeros(6)
    assert at(load(folder, named), q).translation[2] == pytest.approx(0)
    assert at(load(folder, moved), q).translation[2] == pytest.approx(4 * 0.1)
    (folder / "parts").mkdir()
    more = text.replace("<link", '<xacro:include filename="more.xacro"/><link', 1)
    (folder / "parts" / "all.xacro").write_text(more)
    (folder / "parts" / "more.xacro").write_text('<robot name="more"/>')
    (folder / "include.xacro").write_text(INCLUDES)
    included = moved.replace("small.urdf.xacro", "include.xacro")
    assert at(load(folder, included), q).translation[2] == pytest.approx(4 * 0.1)
    broken = text.replace("${2 * reach}", "${2 * rech}")
    (folder / "small.urdf.xacro").write_text(broken)
    with pytest.raises(InputError, match=r"small\.urdf\.xacro: xacro cannot expand.*rech"):
        load(folder, named)


@pytest.mark.parametrize(
    ("expression", "what"),
    [
        ("$(eval __builtins__)", "__builtins__"),
        ("${(lambda: ().__class__.__base__.__subclasses__())()}", "lambda"),
        ("${[x for x in (1, 2)]}", "listcomp"),
        ("${'%s'.format(1)}", "a call of format"),
        ("${python.type(1)}", "a call of type"),
        ("${9 ** 9 ** 9}", "a power above 64"),
        ("${1 &lt;&lt; 9}", "<<"),
        ("${factorial(10 ** 7)}", "a call of factorial"),
        ("$(env HOME)", "not read"),
        ("${xacro.load_yaml('/dev/zero')}", "is no file"),
    ],
)
def test_xacro_runs_no_code(folder: Path, expression: str, what: str) -> None:
    pytest.importorskip("xacrodoc")
    (folder / "arm.xacro").write_text(
        SOUND.replace(
            '<robot name="small">',
            '<robot name="small" xmlns:xacro="http://www.ros.org/wiki/xacro">'
            f'<xacro:property name="a" value="{expression}"/><link name="${{a}}"/>',
        )
    )
    with pytest.raises(InputError, match=r"arm\.xacro: xacro cannot expand") as caught:
        load(folder, PAIR.replace("small.urdf", "arm.xacro"))
    assert what in str(caught.value)


ENDLESS = {
    "a macro that calls itself": '<xacro:macro name="m"><xacro:m/></xacro:macro><xacro:m/>',
    "macros that call ten others": "".join(
        f'<xacro:macro name="m{k}">{f"<xacro:m{k + 1}/>" * 10}</xacro:macro>' for k in range(12)
    )
    + '<xacro:macro name="m12"><link name="a"/></xacro:macro><xacro:m0/>',
    "a text that is doubled": '<xacro:property name="a0" value="aaaaaaaaaa"/>'
    + "".join(f'<xacro:property name="a{k + 1}" value="${{a{k}}}${{a{k}}}"/>' for k in range(40))
    + '<link name="${a40}"/>',
    "a text times a number": "<link name=\"${'a' * 1000000 * 100000}\"/>",
    "a loop of includes": '<xacro:include filename="$(dirname)/arm.xacro"/>',
}


@pytest.mark.parametrize("case", ENDLESS)
def test_xacro_without_end_is_refused(
    case: str, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("xacrodoc")
    monkeypatch.setattr("dualarm_pin.robot.xacro.SECONDS", 2)
    head = '<robot name="small" xmlns:xacro="http://www.ros.org/wiki/xacro">'
    (folder / "arm.xacro").write_text(SOUND.replace('<robot name="small">', head + ENDLESS[case]))
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    with pytest.raises(InputError, match=r"arm\.xacro: xacro cannot expand this file: ") as caught:
        load(folder, PAIR.replace("small.urdf", "arm.xacro"))
    assert "does a macro call itself" in str(caught.value)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    assert after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime < 5.0


@pytest.mark.parametrize(
    ("child", "reason"),
    [
        (
            "import no_such_library",
            "failed: ModuleNotFoundError: No module named",
        ),
        ("print('a note of a library')", "failed: it says nothing"),
        ("import os, signal; os.kill(os.getpid(), signal.SIGSEGV)", "failed: Segmentation fault"),
        ("raise MemoryError('no room')", "or 2 GB: does a macro call itself"),
        ("import os, signal; os.kill(os.getpid(), signal.SIGXCPU)", "20 s of processor time"),
    ],
)
def test_a_process_of_xacro_that_fails_is_not_taken_for_one_that_takes_too_much(
    folder: Path, monkeypatch: pytest.MonkeyPatch, child: str, reason: str
) -> None:
    pytest.importorskip("xacrodoc")
    (folder / "arm.xacro").write_text(SOUND)
    monkeypatch.setattr("dualarm_pin.robot.xacro._CHILD", child)
    with pytest.raises(InputError) as caught:
        load(folder, PAIR.replace("small.urdf", "arm.xacro"))
    assert reason in str(caught.value)


def test_xacro_takes_arithmetic_and_harmless_functions(folder: Path) -> None:
    pytest.importorskip("xacrodoc")
    (folder / "sizes.yaml").write_text("arm: {length: 0.4}\n")
    text = SOUND.replace(
        '<robot name="small">',
        '<robot name="small" xmlns:xacro="http://www.ros.org/wiki/xacro">'
        f"""<xacro:property name="sizes" value="${{xacro.load_yaml('{folder}/sizes.yaml')}}"/>""",
    ).replace('xyz="0 0 0.4"', """xyz="0 0 ${sizes['arm']['length'] * max(cos(0), -1.0) ** 2}\"""")
    (folder / "arm.xacro").write_text(text)
    cell = load(folder, PAIR.replace("small.urdf", "arm.xacro"))
    plain = load(folder, PAIR)
    q = np.full(6, 0.1)
    np.testing.assert_array_equal(at(cell, q).translation, at(plain, q).translation)


def test_xacro_finds_packages_by_our_own_rule(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("xacrodoc")
    package = folder / "ws" / "parts"
    package.mkdir(parents=True)
    (package / "body.xacro").write_text(SOUND)
    (folder / "arm.xacro").write_text(
        '<robot name="a" xmlns:xacro="http://www.ros.org/wiki/xacro">'
        '<xacro:include filename="$(find parts)/body.xacro"/></robot>'
    )
    named = PAIR.replace("small.urdf", "arm.xacro")
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(folder / "ws"))
    with pytest.raises(InputError, match=r"arm\.xacro: xacro cannot.*no package 'parts'"):
        load(folder, named)
    assert load(folder, named + "package_dirs: [ws]\n").n == 6


def test_without_xacrodoc_a_message_says_how_to_get_it(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "xacrodoc", None)
    (folder / "arm.xacro").write_text(SOUND)
    with pytest.raises(MissingExtraError, match=r"pip install 'dualarm-pin\[xacro\]'"):
        load(folder, PAIR.replace("small.urdf", "arm.xacro"))


def test_a_package_folder_that_does_not_exist_is_a_warning(folder: Path) -> None:
    cell = load(folder, PAIR + "package_dirs: [nowhere]\n")
    assert any("nowhere is no folder" in warning for warning in cell.warnings)


def test_tools_and_bases_from_python(folder: Path) -> None:
    file = folder / "small.urdf"
    turn = pin.SE3(pin.rpy.rpyToMatrix(0.3, -0.4, 2.0), np.array([1.0, 2.0, 3.0]))
    tool = pin.SE3(pin.rpy.rpyToMatrix(-1.0, 0.2, 0.1), np.array([0.1, 0.2, 0.3]))
    bare = Cell.from_urdf(file, file, tips=("tip", "tip"))
    dressed = Cell.from_urdf(
        file, file, tips=("tip", "tip"), base1=turn, base2=turn, tools=(tool, tool)
    )
    q = [0.1, 0.2, 0.1, -0.3, 0.5, 0.15]
    expected = tool.inverse() * at(bare, q) * tool
    np.testing.assert_allclose(at(dressed, q).homogeneous, expected.homogeneous, atol=1e-14)
    assert dressed.arms[0].base.isApprox(turn, 1e-14)


# what is wrong: the file, the line, the field, pieces of the message
MISTAKES: dict[str, tuple[str, int | None, str, tuple[str, ...]]] = {
    "unknown key": (PAIR + "lokc: {}\n", 4, "lokc", ("unknown key", "did you mean 'lock'")),
    "unknown key of an arm": (
        PAIR.replace("tip: tip}", "tipp: tip}"),
        2,
        "arms.arm1.tipp",
        ("unknown key", "did you mean 'tip'"),
    ),
    "one arm": ("arms:\n  arm1: {urdf: small.urdf, tip: tip}\n", 1, "arms.arm2", ("is missing",)),
    "no robot": ("arms: {arm1: {}, arm2: {}}\n", 1, "arms", ("no robot",)),
    "no tip": (
        PAIR.replace("urdf: small.urdf, tip: tip}", "urdf: small.urdf}"),
        2,
        "arms.arm1.tip",
        ("give the link that carries the tool", "tip"),
    ),
    "tip is a number": (PAIR.replace("tip: tip}", "tip: 3}"), 2, "arms.arm1.tip", ("text",)),
    "unknown tip": (
        PAIR.replace("tip: tip}", "tip: hnad}"),
        2,
        "arms.arm1.tip",
        ("no link 'hnad'", "did you mean 'hand'"),
    ),
    "no such URDF": (
        PAIR.replace("{urdf: small.urdf, tip: tip}", "{urdf: smal.urdf, tip: tip}"),
        2,
        "arms.arm1.urdf",
        ("no such file", "smal.urdf"),
    ),
    "unknown joint": (
        PAIR + "limits_deg: {elbw: [0, 1]}\n",
        4,
        "limits_deg.elbw",
        ("no joint 'elbw'", "did you mean 'elbow'"),
    ),
    "unknown joint of an arm": (
        PAIR.replace("tip: tip}", "tip: tip, limits: {arm2/elbow: [0, 1]}}"),
        2,
        "arms.arm1.limits.arm2/elbow",
        ("no joint 'arm2/elbow'",),
    ),
    "crossed bounds": (
        PAIR + "limits_deg:\n  elbow: [10, -10]\n",
        5,
        "limits_deg.elbow",
        ("lower bound 10 is not below upper bound -10",),
    ),
    "three bounds": (PAIR + "limits: {elbow: [1, 2, 3]}\n", 4, "limits.elbow", ("given",)),
    "NaN bound": (PAIR + "limits: {elbow: [.nan, 2]}\n", 4, "limits.elbow.0", ("finite",)),
    "degrees of a slide": (
        PAIR + "limits_deg: {slide: [0, 1]}\n",
        4,
        "limits_deg.slide",
        ("prismatic", "metres under `limits`"),
    ),
    "both units": (
        PAIR + "limits_deg: {elbow: [0, 1]}\nlimits: {elbow: [0, 1]}\n",
        4,
        "limits_deg.elbow",
        ("`limits` says this already",),
    ),
    "a fixed joint": (PAIR + "lock: {flange: 0}\n", 4, "lock.flange", ("is fixed",)),
    "lock outside the bounds": (
        PAIR + "lock: {slide: 0.5}\n",
        4,
        "lock.slide",
        ("cannot be locked at 0.5", "0..0.2 m"),
    ),
    "bounds of a locked joint": (
        PAIR + "lock: {slide: 0.1}\nlimits: {slide: [0, 0.1]}\n",
        5,
        "limits.slide",
        ("is locked",),
    ),
    "everything locked": (
        PAIR + "lock: {slide: 0, elbow: 0, shoulder: 0}\n",
        1,
        "arms",
        ("nothing moves",),
    ),
    "free joint of an arm": (TWIN + "free: [la]\n", 5, "free", ("not common", "'lift'")),
    "free and locked": (
        TWIN + "free: [lift]\nlock: {lift: 0.2}\n",
        5,
        "free",
        ("'lift' is locked too",),
    ),
    "both tips on one arm": (
        TWIN.replace("tip: r3", "tip: l1"),
        2,
        "arms",
        ("both tips lie on one arm",),
    ),
    "base of a common URDF": (
        TWIN.replace("tip: r3", "tip: r3, base: {}"),
        4,
        "arms.arm2.base",
        ("holds both arms already",),
    ),
    "tip without a robot": (
        PAIR.replace("urdf: small.urdf, tip: tip}", "tip: tip}"),
        2,
        "arms.arm1.tip",
        ("`tip` needs a robot",),
    ),
    "two rotations": (
        PAIR.replace("rpy_deg: [0, 0, 90]", "rpy_deg: [0, 0, 90], rpy: [0, 0, 1]"),
        3,
        "arms.arm2.base",
        ("rpy and rpy_deg say the same thing",),
    ),
    "no rotation": (
        PAIR.replace("rpy_deg: [0, 0, 90]", "rotation: [[1, 0, 0], [0, 1, 0], [0, 0, 2]]"),
        3,
        "arms.arm2.base",
        ("not a rotation: R^T R differs",),
    ),
    "a reflection": (
        PAIR.replace("rpy_deg: [0, 0, 90]", "rotation: [[1, 0, 0], [0, 1, 0], [0, 0, -1]]"),
        3,
        "arms.arm2.base",
        ("mirror",),
    ),
    "two coordinates": (
        PAIR.replace("xyz: [1, 0, 0]", "xyz: [1, 0]"),
        3,
        "arms.arm2.base.xyz",
        ("too few values; given [1, 0]",),
    ),
    "group without SRDF": (
        PAIR.replace("tip: tip}", "group: arm}"),
        2,
        "arms.arm1.group",
        ("needs an `srdf`",),
    ),
    "SRDF without URDF": (PAIR + "srdf: small.srdf\n", 4, "srdf", ("belongs to a `urdf`",)),
    "speed zero": (PAIR + "velocity: {elbow: 0}\n", 4, "velocity.elbow", ("greater than 0",)),
}


@pytest.mark.parametrize("mistake", MISTAKES)
def test_a_mistake_names_file_line_and_field(mistake: str, folder: Path) -> None:
    text, line, field, pieces = MISTAKES[mistake]
    error = refusal(folder, text)
    if line is not None:
        assert (error.line, error.field) == (line, field), error
    for piece in pieces:
        assert piece in error.message


def test_mistakes_in_python_name_the_argument(folder: Path) -> None:
    file = folder / "small.urdf"
    with pytest.raises(UnknownNameError, match=r"limits\.elbw: no joint 'elbw'"):
        Cell.from_urdf(file, file, tips=("tip", "tip"), limits={"elbw": (0, 1)})
    with pytest.raises(InputError, match=r"limits\.elbow.*not below"):
        Cell.from_urdf(file, file, tips=("tip", "tip"), limits={"elbow": (1, 0)})
    with pytest.raises(InputError, match=r"arms\.arm2\.base: .*holds both arms"):
        Cell.from_urdf(folder / "twin.urdf", base2=pin.SE3.Identity(), tips=("l3", "r3"))
