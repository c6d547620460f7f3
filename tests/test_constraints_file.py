"""Constraints of a task file: from file to result, and every mistake in one message."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from paper_case import TASK, world_pose

from dualarm_pin.answer.folder import load_result
from dualarm_pin.cli import main
from dualarm_pin.errors import InputError
from dualarm_pin.planners.whole_path import plan_global
from dualarm_pin.task import Task


def load(constraints: str) -> Task:
    return Task.load(TASK, [f"constraints={constraints}"])


def test_from_the_file_to_the_result_and_back(tmp_path: Path) -> None:
    change = "constraints=[{above: {frame: arm1/tip, z: 0.6}}]"
    asked = ["solve", str(TASK), "--effort", "quick", "--out", str(tmp_path), "--set", change]
    with pytest.raises(SystemExit) as done:
        main(asked)
    assert done.value.code == 0
    result = json.loads((tmp_path / "result.json").read_text())
    assert result["objective"] == pytest.approx(14.8799, abs=2e-4)
    assert result["max_constraint_violation"] <= 1e-6
    (row,) = result["checked"]["constraints"]
    assert row["name"] == "arm1/tip above 0.6 m"
    assert row["points"] == list(range(1, 32))
    assert min(row["value"]) == pytest.approx(0.0, abs=1e-6)
    task, trajectory = load_result(tmp_path)
    assert [row.name for row in task.rows] == ["arm1/tip above 0.6 m"]
    assert trajectory.checked.rows[0].violation <= 1e-6
    lowest = min(world_pose(task, "arm1/tip", q).translation[2] for q in trajectory.q)
    assert lowest == pytest.approx(0.6, abs=1e-6)


BOX = "{inside: {frame: arm1/tip, box: {x: [0.7, 0.8], y: [-0.1, 0.1], z: [0.6, 0.9]}}}"


@pytest.mark.parametrize(
    ("constraints", "objective"),
    [(BOX, 24.274559), (f"{BOX}, {{above: {{frame: arm2/tip, z: 0.9}}}}", 24.275231)],
)
def test_the_best_motion_in_a_narrow_box(constraints: str, objective: float) -> None:
    """As IPOPT has it to 1e-9; with 3e-6 m more on every side it would be 5e-4 less."""
    answer = plan_global(load(f"[{constraints}]"), effort="quick", seed=0)
    assert answer.found
    assert answer.objective == pytest.approx(objective, abs=2e-6)
    assert answer.max_row_violation <= 1e-9


def test_a_motion_that_breaks_a_constraint_is_not_found() -> None:
    from dualarm_pin.answer.verify import verified

    free = plan_global(Task.load(TASK), effort="quick", seed=0)
    held = verified(load("[{above: {frame: arm1/tip, z: 0.6}}]"), free.q, method="m", solver="s")
    assert free.found
    assert not held.found
    assert held.max_row_violation > 0.01
    assert "arm1/tip above 0.6 m is violated by" in held.message


def test_every_kind_and_its_points() -> None:
    task = load(
        "[{below: {frame: arm2/tip, z: 2}}, {half_space: {frame: arm2/tip, normal: [0, 2, 0], "
        "offset: -1, of: arm1/tip, point: [0, 0, 0.1]}, points: [1, 31]}]"
    )
    assert [row.points for row in task.rows] == [None, (0, 30)]
    assert task.rows[1].parameters.tolist() == [0.0, 1.0, 0.0, -1.0, 0.0, 0.0, 0.1]
    assert task.problem().inequalities.size.tolist() == [2, *[1] * 29, 2]


WRONG = {
    "no such frame": (
        "[{above: {frame: arm1/tipp, z: 0.6}}]",
        r"constraints\.0\.above: no frame 'arm1/tipp'.*did you mean 'arm1/tip'",
    ),
    "no such kind": (
        "[{abov: {frame: arm1/tip, z: 0.6}}]",
        r"constraints\.0\.abov: unknown key: did you mean 'above'",
    ),
    "two kinds": (
        "[{above: {frame: arm1/tip, z: 0}, below: {frame: arm1/tip, z: 1}}]",
        "exactly one row is expected; given above, below; known: above, below, half_space, "
        "inside, axis_within, joint_range, call",
    ),
    "no height": ("[{above: {frame: arm1/tip}}]", r"constraints\.0\.above\.z: this key is missing"),
    "not a number": (
        "[{above: {frame: arm1/tip, z: .nan}}]",
        r"constraints\.0\.above\.z: Input should be a finite number",
    ),
    "no such point": (
        "[{above: {frame: arm1/tip, z: 0.1}, points: [99]}]",
        "point 99 does not exist: the path has points 1 to 31",
    ),
    "no direction": (
        "[{half_space: {frame: arm1/tip, normal: [0, 0, 0], offset: 1}}]",
        r"constraints\.0\.half_space\.normal: the axis has no length",
    ),
    "a box upside down": (
        "[{inside: {frame: arm1/tip, box: {x: [0, 1], z: [0.9, 0.6]}}}]",
        r"constraints\.0\.inside\.box: z: the least, 0.9 m, must be below the most, 0.6 m",
    ),
    "a box without an axis": (
        "[{inside: {frame: arm1/tip, box: {w: [0, 1]}}}]",
        r"constraints\.0\.inside\.box.*'x', 'y' or 'z'",
    ),
    "an empty box": ("[{inside: {frame: arm1/tip, box: {}}}]", "along x, y or z"),
    "too narrow an angle": (
        "[{axis_within: {frame: arm1/tip, axis: [0, 0, 1], of: [0, 0, 1], deg: 0}}]",
        r"constraints\.0\.axis_within\.deg: an angle from 0.1 to 179.9 deg is expected; given 0",
    ),
    "no such joint": (
        "[{joint_range: {joint: arm1/joint5, deg: [0, 1]}}]",
        r"constraints\.0\.joint_range\.joint: no joint 'arm1/joint5'.*mean 'arm1/joint_5'",
    ),
    "an empty range": (
        "[{joint_range: {joint: arm1/joint_5, deg: [1, -1]}}]",
        r"constraints\.0\.joint_range\.deg: the least must be below the most; given \[1, -1\]",
    ),
    "no range": ("[{joint_range: {joint: arm1/joint_5}}]", "give one of deg and to"),
    "no such point, inside the row": (
        "[{joint_range: {joint: arm1/joint_5, deg: [0, 1], points: [99]}}]",
        "point 99 does not exist: the path has points 1 to 31",
    ),
    "not a list": ("{above: 1}", "constraints: a list is expected"),
}


@pytest.mark.parametrize(("constraints", "message"), WRONG.values(), ids=WRONG)
def test_a_mistake_names_file_and_field(constraints: str, message: str) -> None:
    with pytest.raises(InputError, match=message) as error:
        load(constraints)
    assert str(TASK) in str(error.value)
