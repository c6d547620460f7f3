"""A cell and a task to start from: found tips, files that load, a circle that is reached."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from ruamel.yaml import YAML
from test_bad_robots import SOUND

from dualarm_pin.cli import main
from dualarm_pin.errors import InputError
from dualarm_pin.files.resources import urdf_folder
from dualarm_pin.planners.methods import plan
from dualarm_pin.robot.read_urdf import parse_urdf
from dualarm_pin.starter import likely_tip
from dualarm_pin.task import Task

NS16 = urdf_folder() / "ns16" / "ns16.urdf"
FINGERS = SOUND.replace(
    "</robot>",
    '<link name="finger"/><joint name="grip" type="prismatic"><parent link="tip"/>'
    '<child link="finger"/><limit lower="0" upper="0.02" effort="1" velocity="1"/></joint></robot>',
)


JAW = FINGERS.replace('"tip"', '"gripper_flange"').replace('"finger"', '"mover"')


@pytest.mark.parametrize("text", [SOUND, FINGERS])
def test_the_tip_is_the_link_that_carries_the_tool(text: str) -> None:
    robot = parse_urdf(text.encode(), Path("small.urdf"))
    assert likely_tip(robot) == "tip"


def test_what_moves_behind_a_gripper_is_a_finger() -> None:
    assert likely_tip(parse_urdf(JAW.encode(), Path("small.urdf"))) == "gripper_flange"
    all_hand = SOUND.replace('<link name="', '<link name="hand_')
    for word in ("parent", "child"):
        all_hand = all_hand.replace(f'<{word} link="', f'<{word} link="hand_')
    assert likely_tip(parse_urdf(all_hand.encode(), Path("small.urdf"))) == "hand_tip"


def test_a_robot_without_moving_joints_is_refused() -> None:
    robot = parse_urdf(b'<robot name="a"><link name="base"/></robot>', Path("a.urdf"))
    with pytest.raises(InputError, match=r"a\.urdf: no joint of this robot moves"):
        likely_tip(robot)


def test_new_writes_commented_files_that_solve(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as end:
        main(["new", str(tmp_path / "start"), str(NS16)])
    assert end.value.code == 0
    said = capsys.readouterr().out
    assert "arm2/joint_6" in said
    assert "out of reach" not in said
    assert f"next: dualarm-pin solve {tmp_path / 'start' / 'task.yaml'}" in said
    for name in ("cell", "task"):
        text = (tmp_path / "start" / f"{name}.yaml").read_text()
        line = text.splitlines()[0]
        schema = Path(line.removeprefix("# yaml-language-server: $schema="))
        assert schema.is_file()
        assert text.count("#") > 4
    cell = YAML(typ="safe", pure=True).load(tmp_path / "start" / "cell.yaml")
    assert cell["arms"]["arm1"]["tip"] == "flange"
    task = Task.load(tmp_path / "start" / "task.yaml")
    answer = plan(task, effort="quick", seed=0)
    assert answer.found
    assert np.linalg.norm(task.path.position, axis=1).max() < 1.5  # near the other tool
    with pytest.raises(SystemExit) as end:  # nothing is overwritten
        main(["new", str(tmp_path / "start"), str(NS16)])
    assert end.value.code == 2
    assert "cell.yaml: this file is there already" in capsys.readouterr().err
