"""What errors of the cell, limits and points cost: the paper's task, predicted and solved again."""

from __future__ import annotations

import json
from dataclasses import replace

import pytest
from paper_case import TASK
from test_report import cells, head_of

from dualarm_pin.answer.folder import save_result
from dualarm_pin.cli import main
from dualarm_pin.errors import InputError
from dualarm_pin.evidence.sensitivity import cell_costs
from dualarm_pin.planners.whole_path import plan_global
from dualarm_pin.show.sensitivity import rows_of, text_of
from dualarm_pin.task import Task


@pytest.fixture(scope="module")
def motion(task):
    return plan_global(task, effort="quick")


@pytest.fixture(scope="module")
def costs(task, motion):
    return cell_costs(task, motion.q, solve_again=True)


def test_an_error_costs_what_pinocchio_and_planning_again_say(costs):
    by_name = {cost.name: cost for cost in costs.parameters}
    base = by_name["base2.x"]
    assert base.slope == pytest.approx(11.86074, abs=1e-4)
    assert base.position_error == pytest.approx(1e-3, abs=1e-9)
    assert by_name["base2.yaw"].position_error == pytest.approx(1.65e-3, abs=1e-5)
    assert by_name["base2.yaw"].rotation_error == pytest.approx(1e-3, abs=1e-9)
    for cost in costs.parameters:
        assert cost.predicted == pytest.approx(cost.solved, abs=1e-6), cost.name


def test_the_costliest_limit_is_named_with_what_ten_degrees_more_give(costs):
    worst = costs.limits[0]
    assert (worst.joint, worst.side) == ("arm1/joint_5", "upper")
    assert worst.slope == pytest.approx(22.133, abs=1e-3)
    assert worst.solved == pytest.approx(10.0429, abs=1e-3)
    solved = {cost.joint: cost.solved for cost in costs.limits}
    assert solved["arm2/joint_5"] == pytest.approx(12.307, abs=1e-3)
    assert solved["arm2/joint_4"] == pytest.approx(12.652, abs=1e-3)


def test_the_bottleneck_is_the_point_with_the_largest_index(costs, motion):
    assert costs.points[0].point == motion.checked.index.argmax() + 1
    assert costs.points[0].index == pytest.approx(motion.max_index, abs=1e-6)
    assert "arm1/joint_5" in costs.points[0].limits


def test_it_is_said_where_the_motion_itself_is_at_no_minimum(task, motion, costs):
    assert not costs.elsewhere
    assert text_of(costs).splitlines()[0] == "objective 12.73089"
    bent = motion.q.copy()
    bent[:, 0] += 0.02
    off = cell_costs(task, bent)
    assert off.objective == pytest.approx(costs.objective, rel=1e-6)
    assert off.given == pytest.approx(task.problem().objective(bent))
    assert f"the motion itself has {off.given:.7g}: all figures" in text_of(off).splitlines()[0]
    held = replace(off, clearance=True)
    assert "held there by the distances asked for" in rows_of([held])[0][1][0].splitlines()[0]


def test_a_motion_off_the_path_predicts_nothing(task):
    far = (task.cell.lower + 0.9 * (task.cell.upper - task.cell.lower))[None].repeat(31, axis=0)
    with pytest.raises(InputError, match="at no minimum"):
        cell_costs(task, far)


def test_the_command_prints_three_tables_and_keeps_them(motion, tmp_path, capsys):
    save_result(tmp_path, Task.load(TASK), motion)
    with pytest.raises(SystemExit) as end:
        main(["sensitivity", str(tmp_path)])
    assert end.value.code == 0
    said = capsys.readouterr().out
    assert "base2.x        1 mm: joints kept 1.000 mm" in said
    assert "arm1/joint_5 upper: 22.13 per rad" in said
    kept = json.loads((tmp_path / "sensitivity.json").read_text())
    assert kept["limits"][0]["joint"] == "arm1/joint_5"
    page = tmp_path / "page.html"
    with pytest.raises(SystemExit) as end:
        main(["view", str(tmp_path), "--html", str(page)])
    assert end.value.code == 0
    shown = cells(head_of(page.read_bytes()), "Sensitivity", "joint limits")
    assert shown[0].startswith("arm1/joint_5 upper: 22.13 per rad")
    (tmp_path / "sensitivity.json").write_text('{"objective": "<script>"}')
    with pytest.raises(SystemExit) as end:
        main(["view", str(tmp_path), "--html", str(page)])
    assert end.value.code == 2
    assert "not written by this program" in capsys.readouterr().err
