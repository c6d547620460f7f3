"""What the files say of motion and mass is kept: speed, acceleration, effort, inertia."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
from robot_table import NAMES, arguments, needs_robots
from test_bad_robots import SOUND
from test_cell_files import PAIR, TORSO, TWIN, load, refusal
from test_cell_robots import BASE2, original, original_q

from dualarm_pin.cell import Cell
from dualarm_pin.cell.describe import describe
from dualarm_pin.cell.report_text import text_of
from dualarm_pin.files.resources import urdf_folder
from dualarm_pin.robot.packages import find_file


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    elbow = '<axis xyz="0 1 0"/>\n    <limit lower="-2" upper="2" effort="10" velocity="1"/>'
    assert elbow in SOUND
    strong = SOUND.replace(elbow, elbow.replace("10", "25.5").replace('"1"/>', '"1.5"/>'))
    (tmp_path / "small.urdf").write_text(strong)
    (tmp_path / "twin.urdf").write_text(TORSO)
    return tmp_path


def model_limits(cell: Cell) -> dict[str, tuple[float, float]]:
    """Return speed and effort that Pinocchio knows, by joint."""
    model = cell.model
    return {
        model.names[k]: (
            float(model.velocityLimit[model.joints[k].idx_v]),
            float(model.effortLimit[model.joints[k].idx_v]),
        )
        for k in range(1, model.njoints)
    }


def test_speed_and_effort_of_the_urdf_reach_joint_and_model(folder: Path) -> None:
    cell = load(folder, PAIR)
    assert [joint.velocity for joint in cell.joints] == [1, 1.5, 1] * 2
    assert [joint.effort for joint in cell.joints] == [10, 25.5, 10] * 2
    assert [joint.acceleration for joint in cell.joints] == [None] * 6
    assert model_limits(cell)["arm2/elbow"] == (1.5, 25.5)
    assert model_limits(cell)["arm1/slide"] == (1, 10)


def test_zero_and_missing_mean_unknown(folder: Path) -> None:
    text = (folder / "small.urdf").read_text()
    text = text.replace('effort="25.5" velocity="1.5"', 'effort="0"')
    (folder / "small.urdf").write_text(text)
    cell = load(folder, PAIR)
    elbow = cell.joints[1]
    assert (elbow.velocity, elbow.effort) == (None, None)
    assert model_limits(cell)["arm1/elbow"] == (0, 0)
    assert any("no speed limit known" in w and "arm1/elbow" in w for w in cell.warnings)


def test_the_cell_file_gives_speed_and_acceleration(folder: Path) -> None:
    text = PAIR.replace(
        "tip: tip}", "tip: tip, velocity_deg: {elbow: 90}, acceleration_deg_s2: {elbow: 180}}"
    )
    cell = load(folder, text + "acceleration: {slide: 2.5, arm2/elbow: 7}\n")
    assert [joint.acceleration for joint in cell.joints] == [
        None,
        pytest.approx(np.pi),
        2.5,
        None,
        7,
        2.5,
    ]
    assert cell.joints[1].velocity == pytest.approx(np.pi / 2)
    assert model_limits(cell)["arm1/elbow"][0] == pytest.approx(np.pi / 2)
    assert model_limits(cell)["arm2/elbow"][0] == 1.5


MISTAKES = {
    "negative": ("acceleration: {elbow: -1}\n", "acceleration.elbow", "greater than 0"),
    "zero": ("acceleration_deg_s2: {elbow: 0}\n", "acceleration_deg_s2.elbow", "greater than 0"),
    "NaN": ("acceleration: {elbow: .nan}\n", "acceleration.elbow", "finite"),
    "degrees of a slide": (
        "acceleration_deg_s2: {slide: 1}\n",
        "acceleration_deg_s2.slide",
        "metres under `acceleration`",
    ),
    "both units": (
        "acceleration: {elbow: 1}\nacceleration_deg_s2: {elbow: 1}\n",
        "acceleration_deg_s2.elbow",
        "`acceleration` says this already",
    ),
    "unknown joint": ("acceleration: {elbw: 1}\n", "acceleration.elbw", "did you mean 'elbow'"),
    "speed of a locked joint": (
        "velocity: {elbow: 1}\nlock: {elbow: 0}\n",
        "velocity.elbow",
        "is locked: speeds are for the joints of the two chains (shoulder, slide)",
    ),
    "acceleration of a locked joint": (
        "acceleration: {elbow: 1}\nlock: {elbow: 0}\n",
        "acceleration.elbow",
        "is locked: accelerations are for",
    ),
}


@pytest.mark.parametrize("mistake", MISTAKES)
def test_a_bad_limit_is_one_message_with_its_line(mistake: str, folder: Path) -> None:
    text, field, piece = MISTAKES[mistake]
    error = refusal(folder, PAIR + text)
    line = 4 + (text[: text.index(field.partition(".")[0] + ":")]).count("\n")
    assert (error.line, error.field) == (line, field)
    assert piece in error.message
    assert "\n" not in str(error)


def test_a_follower_slows_its_leader_down(folder: Path) -> None:
    cell = load(folder, TWIN)  # lc follows la at -0.5, each with a speed of 1
    assert cell.joints[0].velocity == 1
    assert model_limits(cell)["arm1/lc"] == (0.5, 1)
    fast = load(folder, TWIN + "velocity: {lc: 0.25}\nacceleration: {lc: 3, la: 10}\n")
    la = fast.joints[0]
    assert (la.velocity, la.acceleration) == (0.5, 6)
    assert model_limits(fast)["arm1/lc"] == (0.25, 1)
    assert any("arm1/la: slowed down to what 'lc', which follows" in w for w in fast.warnings)
    unknown = load(folder, TWIN + "acceleration: {lc: 3}\n")
    assert unknown.joints[0].acceleration == 6


def test_jerk_and_torque_come_from_the_cell_and_may_stand_inside_limits(folder: Path) -> None:
    beside = load(folder, PAIR + "jerk_deg_s3: {elbow: 180}\ntorque: {elbow: 7}\n")
    inside = load(folder, PAIR + "limits: {jerk_deg_s3: {elbow: 180}, torque: {elbow: 7}}\n")
    for cell in (beside, inside):
        assert [joint.jerk for joint in cell.joints] == [None, pytest.approx(np.pi), None] * 2
        assert [joint.effort for joint in cell.joints] == [10, 7, 10] * 2
        assert model_limits(cell)["arm1/elbow"][1] == 7
    both = "velocity_deg: {elbow: 9}\nlimits: {velocity_deg_s: {elbow: 9}}\n"
    assert "give one" in refusal(folder, PAIR + both).message


def test_the_table_says_which_limits_of_motion_are_missing(folder: Path) -> None:
    text = text_of(describe(load(folder, PAIR + "acceleration: {elbow: 1}\n")))
    assert "velocity_deg: known" in text
    assert "jerk_deg_s3: missing for all joints" in text
    missing = "acceleration_deg_s2: missing for arm1/shoulder, arm1/slide, arm2/shoulder"
    assert missing in text


def test_locked_joints_have_no_limits_and_their_masses_ride_along(folder: Path) -> None:
    heavy = (folder / "small.urdf").read_text()
    heavy = heavy.replace(
        '<link name="tip"/>',
        '<link name="tip"><inertial><mass value="3"/>'
        '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>',
    )
    (folder / "small.urdf").write_text(heavy)
    cell = load(folder, PAIR + "lock: {slide: 0.1, elbow: 0.3}\n")
    assert set(model_limits(cell)) == {"arm1/shoulder", "arm2/shoulder"}
    assert cell.model.inertias[1].mass == pytest.approx(5)


@needs_robots
@pytest.mark.parametrize("name", NAMES)
def test_mass_and_limits_are_those_that_pinocchio_reads(name: str) -> None:
    """The mass matrix and gravity of the original, without the rows of the joints that stand."""
    urdfs, options, _ = arguments(name)
    cell = Cell.from_urdf(*urdfs, base2=BASE2 if len(urdfs) == 2 else None, **options)
    q = np.random.default_rng(8).uniform(cell.lower, cell.upper)
    data = cell.data()
    M = pin.crba(cell.model, data, cell.model_q(q)).copy()
    M = np.triu(M) + np.triu(M, 1).T
    gravity = pin.computeGeneralizedGravity(cell.model, data, cell.model_q(q)).copy()
    for number in range(len(urdfs)):
        placed = cell._robots[number]
        arms = ("arm1", "arm2", "common") if len(urdfs) == 1 else (f"arm{number + 1}",)
        theirs = original(find_file(urdfs[number], urdf_folder()))
        full, there = original_q(theirs, cell, q, number, arms), theirs.createData()
        base = placed.base.rotation.T @ theirs.gravity.linear
        theirs.gravity.linear = base
        M_own = pin.crba(theirs, there, full).copy()
        M_own = np.triu(M_own) + np.triu(M_own, 1).T
        gravity_own = pin.computeGeneralizedGravity(theirs, there, full).copy()
        moving = [*placed.roles.columns, *placed.roles.followers]
        ours = [cell.model.joints[cell.model.getJointId(placed.joint(j))].idx_v for j in moving]
        own = [theirs.joints[theirs.getJointId(j)].idx_v for j in moving]
        scale = max(1.0, np.abs(M_own).max())
        np.testing.assert_allclose(
            M[np.ix_(ours, ours)], M_own[np.ix_(own, own)], atol=1e-10 * scale
        )
        np.testing.assert_allclose(gravity[ours], gravity_own[own], atol=1e-9 * scale)
        for limit in ("velocityLimit", "effortLimit"):
            for k, j, joint in zip(ours, own, moving, strict=True):
                value = getattr(theirs, limit)[j]
                if joint in placed.roles.columns and np.isfinite(value):
                    assert getattr(cell.model, limit)[k] == pytest.approx(value), joint


def test_check_shows_limits_and_says_what_is_missing(folder: Path) -> None:
    cell = load(folder, PAIR + "acceleration_deg_s2: {elbow: 180}\n")
    report = describe(cell)
    text = text_of(report)
    rows = {line.split()[0]: line.split()[1:] for line in text.splitlines() if line.strip()}
    assert rows["joint"][3:] == ["unit", "speed", "acceleration", "effort"]
    assert " ".join(rows["arm1/shoulder"][4:]) == "57.2958 deg/s unknown 10 N m"
    assert " ".join(rows["arm1/elbow"][4:]) == "85.9437 deg/s 180 deg/s^2 25.5 N m"
    assert " ".join(rows["arm1/slide"][4:]) == "1 m/s unknown 10 N"
    assert "Links without inertia (4):\n  arm1/fore\n  arm1/hand\n  arm2/fore\n  arm2/hand" in text
    data = json.loads(json.dumps(report.as_dict(), allow_nan=False))
    assert data["joints"][1]["effort"] == 25.5
    assert data["joints"][1]["acceleration"] == pytest.approx(np.pi)
    assert data["links_without_inertia"] == list(cell.links_without_inertia)


def test_a_moved_plain_frame_is_no_link_without_inertia(folder: Path) -> None:
    cell = load(folder, PAIR)
    assert cell.links_without_inertia == ("arm1/fore", "arm1/hand", "arm2/fore", "arm2/hand")
    bare = SOUND[: SOUND.index("<inertial>")] + SOUND[SOUND.index("</inertial>") + 11 :]
    (folder / "small.urdf").write_text(bare)
    assert len(load(folder, PAIR).links_without_inertia) == 6


def test_a_negative_moment_of_inertia_is_a_warning_with_its_line(folder: Path) -> None:
    text = SOUND.replace('ixx="0.1"', 'ixx="-0.1"')
    (folder / "small.urdf").write_text(text)
    line = text[: text.index("<inertia ")].count("\n") + 1
    warning = f"small.urdf:{line}: link 'upper': a moment of inertia is negative (ixx=-0.1)"
    assert any(warning in w for w in load(folder, PAIR).warnings)
