"""Programs of whole results: what is checked, what is refused, and what is written."""

from __future__ import annotations

import dataclasses
import json
import re
import sys
import types
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from answers import answers, changed, task
from commands import Run
from hypothesis import given, settings
from hypothesis import strategies as st
from motion_cases import arm_urdf, line_result, motion_of, result_with_motion
from scripts import script_of
from test_cell_files import TORSO

import dualarm_pin as dp
from dualarm_pin.answer.folder import load_result, save_result
from dualarm_pin.cell import Cell
from dualarm_pin.cell.describe import describe
from dualarm_pin.cell.report_text import text_of
from dualarm_pin.errors import DualArmError, InputError, MissingFileError, UnknownNameError
from dualarm_pin.exports import FORMATS, Axes, Chord, Format, Points
from dualarm_pin.exports.convention import convention_of, ros_names
from dualarm_pin.exports.motion_path import MotionPath
from dualarm_pin.motion import Motion
from dualarm_pin.relative import Relative

SIX = [f"j{k}" for k in range(1, 7)]
PAIR = """\
arms:
  arm1: {urdf: arm.urdf, tip: TIP, controller: {FIRST}}
  arm2: {urdf: arm.urdf, tip: TIP, base: {xyz: [1, 0, 0]}, controller: {}}
"""


def pair(folder: Path, names: list[str], first: str = "", **how: Any) -> str:
    (folder / "arm.urdf").write_text(arm_urdf(names, **how))
    return PAIR.replace("TIP", f"l{len(names)}").replace("FIRST", first)


@pytest.fixture(scope="module")
def paper(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The paper's task with a motion of a thousand samples."""
    folder = tmp_path_factory.mktemp("paper") / "result"
    result_with_motion(folder, task(), answers()["result 0"], samples=1001)
    return folder


@pytest.mark.parametrize("name", FORMATS)
def test_a_program_of_the_paper_stays_on_its_path(name: str, paper: Path, tmp_path: Path) -> None:
    exported = dp.export(paper, name, tmp_path)
    assert exported.passed
    fine = name in ("ros2", "moveit", "csv")
    assert exported.tolerance == (Chord(0.01, 0.001) if fine else Chord(0.05, 0.01))
    assert exported.error.mm <= exported.tolerance.mm
    assert exported.error.deg <= exported.tolerance.deg
    assert name in ("csv", "urscript") or exported.points < exported.samples / 5
    assert {file.name for file in tmp_path.iterdir()} == {*exported.files, "export.json"}
    report = json.loads((tmp_path / "export.json").read_text())
    assert report["position_error"] == pytest.approx(exported.error.mm * 1e-3)
    main = (tmp_path / exported.files[0]).read_text()
    assert report["result_sha256"][:20] in re.sub(r" ;\n *\d+:!", "", main)
    for note in FORMATS[name].draft:
        assert note.split()[0] in main  # the remarks of a FANUC are short
        assert "DRAFT" in main


def test_the_error_is_the_distance_from_the_nearest_pose_of_the_path(paper: Path) -> None:
    loaded, _ = load_result(paper)
    motion = Motion.load(paper)
    no_turns = Chord(0.05, 1e6)  # then the nearest pose is the nearest position
    path = MotionPath(loaded.cell, motion.q, loaded.path, motion.arc_length, no_turns)
    share = np.linspace(0.0, 1.0, 61)[:, None]
    line = (1 - share) * motion.q[280] + share * motion.q[340]
    found = path.deviation(np.vstack([motion.q[:280], line, motion.q[341:]]))[280:341]

    def places(q: np.ndarray) -> np.ndarray:
        return np.array([Relative(loaded.cell, row).T_e1_e2.translation for row in q])

    dense = motion_of(answers()["result 0"], duration=4.0, samples=40001)
    near = places(dense.q[11000:13800])
    nearest = [1e3 * np.linalg.norm(near - x, axis=1).min() for x in places(line)]
    assert max(nearest) > 0.1
    assert found[:, 0] == pytest.approx(nearest, abs=0.002)


def shifted(target: Format, change: Any) -> Format:
    """Return a format whose writer is wrong."""

    def write(program: Any) -> Mapping[str, str]:
        values = program.points.values.copy()
        points = dataclasses.replace(program.points, values=change(values))
        return target.write(dataclasses.replace(program, points=points))

    return dataclasses.replace(target, name="mine", write=write)


def one_degree(values: np.ndarray) -> np.ndarray:
    values[len(values) // 2, 7] += 0.1
    return values


def mirrored(values: np.ndarray) -> np.ndarray:
    values[:, 2] *= -1.0
    return values


@pytest.mark.parametrize("change", [one_degree, mirrored, lambda values: values[::-1]])
@pytest.mark.parametrize("name", ["ros2", "fanuc"])
def test_a_writer_that_is_wrong_writes_nothing(
    change: Any, name: str, paper: Path, tmp_path: Path
) -> None:
    exported = dp.export(paper, shifted(FORMATS[name], change), tmp_path / "out")
    assert not exported.passed
    assert not (tmp_path / "out").exists()


def test_a_reader_that_fails_or_loses_points_is_an_error(paper: Path, tmp_path: Path) -> None:
    target = FORMATS["rapid"]

    def half(files: Mapping[str, str]) -> Any:
        points = target.read(files)
        return dataclasses.replace(points, values=points.values[::2], time=points.time[::2])

    def slow(files: Mapping[str, str]) -> Any:
        points = target.read(files)
        return dataclasses.replace(points, time=1.01 * points.time)

    for read, message in ((half, "other points"), (slow, "other times"), (len, "returns a int")):
        with pytest.raises(DualArmError, match=message):
            dp.export(paper, dataclasses.replace(target, read=read), tmp_path / "b")
    assert not (tmp_path / "b").exists()


@pytest.mark.parametrize("free", ["", "spin", "rotation"])
def test_what_the_task_leaves_free_does_not_count(free: str, tmp_path: Path) -> None:
    result = line_result(tmp_path, pair(tmp_path, SIX), free=free)
    exported = dp.export(result, "rapid", tmp_path / "out")
    assert exported.passed
    assert (exported.error.deg == 0.0) == (free == "rotation")


def test_joints_of_every_kind_and_name_go_to_ros_and_tables(tmp_path: Path) -> None:
    names = ["on", "a: b", 'q"\\', "Ünï", "slide", "6", "x y"]
    result = line_result(tmp_path, pair(tmp_path, names, prismatic=["slide"]))
    for name in ("ros2", "moveit", "csv"):
        assert dp.export(result, name, tmp_path / name).passed
    import yaml  # what ROS reads it with

    goal = yaml.safe_load((tmp_path / "ros2" / "both.goal.yaml").read_text())
    expected = [f"{arm}_{name}" for arm in ("arm1", "arm2") for name in names]
    assert goal["trajectory"]["joint_names"] == expected
    with pytest.raises(InputError, match=r"arm1/slide: is prismatic.*ros2, moveit or csv"):
        dp.export(result, "rapid", tmp_path / "rapid")


def test_seven_joints_have_no_axes_in_a_program_of_six(tmp_path: Path) -> None:
    result = line_result(tmp_path, pair(tmp_path, [*SIX, "j7"]))
    for name in ("rapid", "fanuc", "krl", "urscript", "pdl2"):
        with pytest.raises(InputError, match=rf"arm1: 7 joints move; a {name} program has 6"):
            dp.export(result, name, tmp_path / name)
    assert dp.export(result, "ros2", tmp_path / "ros2").passed


def test_a_lift_that_both_arms_share_goes_to_ros_alone(tmp_path: Path) -> None:
    (tmp_path / "twin.urdf").write_text(TORSO)
    cell = "urdf: twin.urdf\narms:\n  arm1: {tip: l3}\n  arm2: {tip: r3}\nfree: [lift]\n"
    result = line_result(tmp_path, cell, turn=0.1)
    assert dp.export(result, "ros2", tmp_path / "ros2").passed
    goal = (tmp_path / "ros2" / "both.goal.yaml").read_text()
    assert '["la", "lb", "ra", "rb", "rc", "lift"]' in goal
    with pytest.raises(InputError, match="common/lift: moves both arms"):
        dp.export(result, "krl", tmp_path / "krl")


def test_an_arm_that_stands_still_gets_no_program(tmp_path: Path) -> None:
    (tmp_path / "arm.urdf").write_text(arm_urdf(SIX))
    cell = "arms:\n  arm1: {base: {xyz: [1, 0, 0]}}\n  arm2: {urdf: arm.urdf, tip: l6}\n"
    result = line_result(tmp_path, cell)
    exported = dp.export(result, "rapid", tmp_path / "out")
    assert exported.files == ("da_result_T_ROB2.mod",)


numbers = st.floats(-3.0, 3.0)


@settings(max_examples=30, deadline=None)
@given(
    q=st.lists(numbers, min_size=12, max_size=12),
    signs=st.lists(st.sampled_from([-1, 1]), min_size=6, max_size=6),
    offsets=st.lists(st.floats(-180, 180), min_size=6, max_size=6),
    factor=numbers,
)
def test_signs_offsets_and_couplings_have_a_way_back(
    q: list[float], signs: list[int], offsets: list[float], factor: float, fork: Path
) -> None:
    said = {
        "signs": dict(zip(SIX, signs, strict=True)),
        "offsets_deg": dict(zip(SIX, offsets, strict=True)),
        "coupling": {"j5": {"j4": factor}, "j6": {"j5": 0.5}},
    }
    cell = Cell.load(written(fork, json.dumps(said)[1:-1]))
    convention = convention_of(cell, FORMATS["urscript"])
    values = convention.values(np.array([q]))
    axes = np.array(signs) * q[:6] + np.deg2rad(offsets)
    assert values[0, :4] == pytest.approx(axes[:4])
    assert values[0, 4] == pytest.approx(axes[4] + factor * axes[3])
    assert values[0, 5] == pytest.approx(axes[5] + 0.5 * axes[4])
    assert values[0, 6:] == pytest.approx(q[6:])
    assert convention.joints(values)[0] == pytest.approx(q, abs=1e-9)


@pytest.fixture(scope="module")
def fork(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("fork")
    pair(folder, SIX)
    return folder


def written(folder: Path, first: str) -> Path:
    (folder / "cell.yaml").write_text(PAIR.replace("TIP", "l6").replace("FIRST", first))
    return folder / "cell.yaml"


def test_the_third_axis_of_a_fanuc_is_counted_from_the_horizontal(fork: Path) -> None:
    q = np.deg2rad(np.arange(1.0, 13.0) ** 2)[None]
    cell = Cell.load(written(fork, ""))
    values = convention_of(cell, FORMATS["fanuc"]).values(q)[0]
    assert values[:6] == pytest.approx([1, 4, 9 - 4, 16, 25, 36])
    assert values[6:] == pytest.approx([49, 64, 81 - 64, 100, 121, 144])
    said = Cell.load(written(fork, "coupling: {}"))
    assert convention_of(said, FORMATS["fanuc"]).values(q)[0, 2] == pytest.approx(9)


@pytest.mark.parametrize(
    ("first", "message"),
    [
        (
            "signs: {j9: 1}",
            r"cell.yaml:2: arms.arm1.controller.signs.j9: .*no joint 'j9': known: j1",
        ),
        ("signs: {j1: 2}", r"arms.arm1.controller.signs.j1"),
        ("coupling: {j1: {k: 1}}", r"arms.arm1.controller.coupling.*no joint 'k'"),
        ("coupling: {j1: {j1: -1}}", r"controller.coupling: the joints do not follow"),
        ("prefix: arm2_", r"two joints would be called 'arm2_j1'"),
        ("sings: {}", "unknown key: did you mean 'signs'"),
    ],
)
def test_a_mistake_about_a_controller_names_its_place(fork: Path, first: str, message: str) -> None:
    with pytest.raises(InputError) as raised:
        ros_names(Cell.load(written(fork, first)))
    assert re.search(message, str(raised.value))


def test_check_shows_what_a_cell_file_says_of_a_controller(fork: Path) -> None:
    said = "signs: {j2: -1}, offsets_deg: {j3: 90}, coupling: {j3: {j2: -1}}, prefix: left_"
    cell = Cell.load(written(fork, said))
    first, second = describe(cell).arms
    assert first.controller == {
        "signs": {"j2": -1}, "offsets_deg": {"j3": 90.0}, "coupling": {"j3": {"j2": -1.0}},
        "prefix": "left_",
    }  # fmt: skip
    assert second.controller == {}
    assert "controller signs: {'j2': -1}" in text_of(describe(cell))


def test_a_program_of_links_that_touch_says_so(tmp_path: Path) -> None:
    folder = tmp_path / "result"
    motion = result_with_motion(folder, task(), answers()["result 0"], samples=1001)
    for clearance, word in ((-0.01, "links touch"), (None, "unknown"), (0.1, "")):
        summary = dataclasses.replace(motion.summary, least_clearance=clearance)
        dataclasses.replace(motion, summary=summary).write(folder)
        exported = dp.export(folder, "rapid", tmp_path / "out")
        text = (tmp_path / "out" / exported.files[0]).read_text()
        assert ("CAUTION" in text) == ("CAUTION" in exported.as_text()) == bool(word)
        assert word in text


def test_prismatic_joints_take_no_offset(tmp_path: Path) -> None:
    cell = pair(tmp_path, SIX, "offsets_deg: {j2: 5}", prismatic=["j2"])
    (tmp_path / "cell.yaml").write_text(cell)
    with pytest.raises(InputError, match="'j2' is prismatic: it takes no offset"):
        Cell.load(tmp_path / "cell.yaml")


def test_signs_of_the_cell_file_stand_in_the_program(tmp_path: Path) -> None:
    result = line_result(tmp_path, pair(tmp_path, SIX, "signs: {j1: -1}, prefix: left_"))
    q = np.rad2deg(Motion.load(result).q[0])
    dp.export(result, "rapid", tmp_path / "rapid")
    text = (tmp_path / "rapid" / "da_result_T_ROB1.mod").read_text()
    assert f"MoveAbsJ [[{-q[0]:.5f},{q[1]:.5f}," in text
    dp.export(result, "ros2", tmp_path / "ros2")
    goal = (tmp_path / "ros2" / "both.goal.yaml").read_text()
    assert '"left_j1"' in goal
    assert '"arm2_j1"' in goal


def test_an_own_format_is_one_record(paper: Path, tmp_path: Path) -> None:
    def write(program: Any) -> dict[str, str]:
        points = zip(program.time.tolist(), program.points.values.tolist(), strict=True)
        return {"mine.json": json.dumps(list(points))}

    def read(files: Mapping[str, str]) -> Points:
        time, values = zip(*json.loads(files["mine.json"]), strict=True)
        return Points(np.array(values), np.array(time))

    mine = Format("mine", write, read, axes=Axes(6, "deg"), tolerance=Chord(0.2, 0.02))
    exported = dp.export(paper, mine, tmp_path / "out")
    assert exported.passed
    with pytest.raises(InputError, match=r"plain name.*'\.\./mine.json'"):
        outside = dataclasses.replace(
            mine,
            write=lambda program: {"../mine.json": write(program)["mine.json"]},
            read=lambda files: read({"mine.json": files["../mine.json"]}),
        )
        dp.export(paper, outside, tmp_path / "other")
    assert {file.name for file in tmp_path.iterdir()} == {"out"}
    assert 0.02 < exported.error.mm <= 0.2


def test_fewer_points_for_a_wider_tolerance(paper: Path, tmp_path: Path) -> None:
    usual = dp.export(paper, "rapid", tmp_path / "a")
    wide = dp.export(paper, "rapid", tmp_path / "b", mm=0.5, deg=0.1)
    assert wide.passed
    assert wide.points < usual.points
    assert wide.error.mm > usual.error.mm


def test_a_tolerance_below_the_samples_of_the_motion_is_not_met(
    paper: Path, tmp_path: Path, run: Run
) -> None:
    done = run("export", paper, "--to", "rapid", "--out", "out", "--mm", "1e-4", cwd=tmp_path)
    assert done.returncode == 1
    assert "read back: " in done.stdout
    assert "nothing is written" in done.stderr
    assert not (tmp_path / "out").exists()


def test_the_command_writes_a_program_again_and_nothing_over_other_files(
    paper: Path, tmp_path: Path, run: Run
) -> None:
    dp.export(paper, "csv", tmp_path / "out")
    done = run("export", paper, "--to", "csv", "--out", "out", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "written: out/motion.csv" in done.stdout
    done = run("export", paper, "--to", "rapid", "--out", "out", cwd=tmp_path)
    assert done.returncode == 2
    assert "out: there is something else here (motion.csv)" in done.stderr


def test_wrong_input_is_one_message(paper: Path, tmp_path: Path) -> None:
    with pytest.raises(UnknownNameError, match=r"--to: no format 'rapit': did you mean 'rapid'"):
        dp.export(paper, "rapit", tmp_path)
    with pytest.raises(UnknownNameError, match=r"known: ros2, moveit, .*, csv"):
        dp.export(paper, "step", tmp_path)
    with pytest.raises(MissingFileError, match="give the folder that"):
        dp.export(tmp_path, "csv", tmp_path)
    with pytest.raises(InputError, match="mm: a number above 0"):
        dp.export(paper, "csv", tmp_path, mm=0.0)
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="file: a folder is expected"):
        dp.export(paper, "csv", tmp_path / "file")
    bare = tmp_path / "bare"
    save_result(bare, task(), answers()["result 0"])
    with pytest.raises(MissingFileError, match="dualarm-pin motion"):
        dp.export(bare, "csv", tmp_path / "out")
    other = tmp_path / "other"
    result_with_motion(other, task(), answers()["result 1"])
    motion_of(answers()["result 0"], duration=4.0, samples=101).write(other)
    with pytest.raises(InputError, match="does not pass by the points"):
        dp.export(other, "csv", tmp_path / "out")
    lost = tmp_path / "lost"
    result_with_motion(lost, task(), changed(answers()["result 0"], found=False))
    with pytest.raises(InputError, match="found: it is no solution"):
        dp.export(lost, "csv", tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_a_motion_that_does_not_end_at_rest_is_no_goal(paper: Path, tmp_path: Path) -> None:
    folder = tmp_path / "moving"
    motion = result_with_motion(folder, task(), answers()["result 0"], samples=401)
    velocity = motion.velocity.copy()
    velocity[-1, 3] = 0.1
    dataclasses.replace(motion, velocity=velocity).write(folder)
    with pytest.raises(InputError, match=r"arm1/joint_4: the motion ends at 0.1"):
        dp.export(folder, "ros2", tmp_path / "out")


class Recorder:
    """Stands for a module or a message of ROS."""

    def __init__(self, **fields: Any) -> None:
        vars(self).update(fields)


def test_the_sender_sends_what_stands_in_the_file(
    paper: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Any
) -> None:
    dp.export(paper, "ros2", tmp_path)
    sent: list[Any] = []

    def future(value: Any) -> Any:
        return Recorder(result=lambda: value)

    class Client:
        def __init__(self, node: Any, kind: Any, action: str) -> None:
            sent.append(action)

        def wait_for_server(self, timeout_sec: float) -> bool:
            return True

        def send_goal_async(self, goal: Any) -> Any:
            sent.append(goal)
            outcome = Recorder(result=Recorder(error_code=0, error_string=""))
            return future(Recorder(accepted=True, get_result_async=lambda: future(outcome)))

    def goal() -> Any:
        return Recorder(trajectory=Recorder(joint_names=[], points=[]))

    action = types.SimpleNamespace(Goal=goal, Result=types.SimpleNamespace(SUCCESSFUL=0))
    node = Recorder(destroy_node=lambda: None)
    modules = {
        "rclpy": {"init": lambda: None, "shutdown": lambda: None, "create_node": lambda _: node,
                  "spin_until_future_complete": lambda node, future: None},
        "rclpy.action": {"ActionClient": Client},
        "builtin_interfaces": {}, "builtin_interfaces.msg": {"Duration": Recorder},
        "control_msgs": {}, "control_msgs.action": {"FollowJointTrajectory": action},
        "trajectory_msgs": {}, "trajectory_msgs.msg": {"JointTrajectoryPoint": Recorder},
    }  # fmt: skip
    for name, content in modules.items():
        module = types.ModuleType(name)
        vars(module).update(content)
        monkeypatch.setitem(sys.modules, name, module)
    sender = script_of(tmp_path / "send_goal.py")
    assert sender.main(str(tmp_path / "both.goal.yaml")) == 0
    assert sent[0] == "/both_arms_controller/follow_joint_trajectory"
    assert sent[1].trajectory.joint_names[0] == "arm1_joint_1"
    motion, points = Motion.load(paper), sent[1].trajectory.points
    assert points[0].positions == pytest.approx(motion.q[0], abs=1e-9)
    assert points[-1].velocities == [0.0] * 12
    last = points[-1].time_from_start
    assert last.sec + last.nanosec * 1e-9 == pytest.approx(4.0)
    assert sent[1].goal_time_tolerance.nanosec == 500_000_000
