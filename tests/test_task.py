"""Task files: everything a file can say reaches the task, and `--set` changes any of it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from paper_case import TASK

from dualarm_pin.cell import Cell
from dualarm_pin.errors import InputError, ShapeError
from dualarm_pin.files.resources import urdf_folder
from dualarm_pin.indices import INDICES, force
from dualarm_pin.path.paths import corner
from dualarm_pin.planners.two_stage import plan_two_stage
from dualarm_pin.task import Task


def test_the_paper_s_task_is_the_paper_s(task: Task) -> None:
    assert (task.path.h, task.cell.n) == (31, 12)
    assert task.Gamma == (0, 6, 12, 18, 24, 30)
    assert (task.smoothness, task.stage_1_smoothness) == (3.0, 1.5)
    np.testing.assert_allclose(np.degrees(task.cell.lower[:3]), [-60, -45, -150])
    np.testing.assert_array_equal(task.path.u[:, :3], task.path.tangent)
    assert not task.path.u[:, 3:].any()


@pytest.mark.parametrize("name", INDICES)
def test_every_index_of_a_file_is_made(name: str) -> None:
    weights = f"task_weights: [1, 1, 1, 0.1, 0.1, 0.1], joint_weights: {[1.0] * 11 + [2.0]}"
    task = Task.load(TASK, [f"index={{{name}: {{{weights}}}, joint_centre: 0.2}}"])
    assert task.index.joint_centre == 0.2
    assert task.index.task_weights is not None
    assert task.index.task_weights[3] == 0.1
    assert task.index.joint_weights is not None
    assert task.index.joint_weights[11] == 2.0
    assert name.split("_", maxsplit=1)[0] in task.index.name.replace("-", "_")


def test_set_reaches_into_task_and_cell() -> None:
    task = Task.load(
        TASK,
        ["smoothness=7", "path.corner.side=0.2", "cell.arms.arm2.base.xyz=[2.3, 0.1, 0]",
         "cell.arms.arm1.limits_deg.joint_1=[-10, 20]", "two_stage.Gamma=4"],
    )  # fmt: skip
    assert task.smoothness == 7.0
    assert task.path.position[0, 0] == 0.2
    assert np.degrees(task.cell.upper[0]) == pytest.approx(20)
    assert task.cell.arms[1].base.translation[0] == 2.3
    assert len(task.Gamma) == 4


def test_a_complete_task_file_is_read_from_any_folder(tmp_path: Path) -> None:
    task = Task.load(TASK, ["cell.arms.arm2.base.xyz=[2.4, 0, 0]", "smoothness=4"])
    (tmp_path / "task.yaml").write_text(task.as_yaml())
    again = Task.load(tmp_path / "task.yaml")
    assert again.smoothness == 4.0
    assert again.cell.arms[1].base.translation[0] == 2.4
    np.testing.assert_array_equal(again.path.position, task.path.position)
    further = Task.load(tmp_path / "task.yaml", ["cell.arms.arm2.base.xyz=[2.6, 0, 0]"])
    assert further.cell.arms[1].base.translation[0] == 2.6


def test_a_direction_may_be_a_vector_of_any_length() -> None:
    task = Task.load(TASK, ["index={force: {direction: [0, 0, 5]}}"])
    np.testing.assert_array_equal(task.path.u, np.tile([0, 0, 1, 0, 0, 0], (31, 1)))


def test_a_tangent_stays_a_tangent_where_the_file_gives_directions(tmp_path: Path) -> None:
    rows = ["x,y,z,qw,qx,qy,qz,ux,uy,uz"]
    rows += [f"{0.1 * i},0,0.3,0,1,0,0,0,0,1" for i in range(4)]
    (tmp_path / "p.csv").write_text("\n".join(rows) + "\n")
    file = tmp_path / "t.yaml"
    text = f"cell: {urdf_folder() / 'cells' / 'ns16_pair.yaml'}\npath: {{csv: p.csv}}\n"
    file.write_text(text)
    assert Task.load(file).path.u[0].tolist() == [0, 0, 1, 0, 0, 0]
    file.write_text(text + "index: {force: {direction: tangent}}\n")
    np.testing.assert_allclose(Task.load(file).path.u[0], [1, 0, 0, 0, 0, 0], atol=1e-12)


def test_lambda_follows_the_arc_length_where_asked() -> None:
    task = Task.load(TASK, ["smoothness={weight: 3, per_arc_length: true}"])
    weights = task.problem().links.weight[:-1]
    ds = np.diff(task.path.arc_length)
    np.testing.assert_allclose(weights * ds**4, np.full(30, 3 * ds.mean() ** 4), rtol=1e-9)
    assert Task.load(TASK).problem().links.weight[:-1].tolist() == [3.0] * 30


def test_the_speed_limits_may_be_the_metric_if_they_are_known() -> None:
    with pytest.raises(InputError, match=r"no velocity limit is known for arm1/joint_1"):
        Task.load(TASK, ["smoothness={metric: velocity}", "cell.velocity_deg={}"])
    speeds = ", ".join(f"joint_{i}: {100 * i}" for i in range(1, 7))
    task = Task.load(TASK, ["smoothness={metric: velocity}", f"cell.velocity_deg={{{speeds}}}"])
    assert task.metric is not None
    assert task.metric[0] / task.metric[5] == pytest.approx(36)


def test_a_task_in_python_checks_its_parts(cell: Cell) -> None:
    path = corner(points=(3, 1, 3), rotation=np.diag([1.0, -1.0, -1.0]))
    assert Task(cell, path).Gamma[0] == 0
    with pytest.raises(InputError, match="increasing points from 1 to 7"):
        plan_two_stage(Task(cell, path, Gamma=(0, 3)))
    with pytest.raises(ShapeError, match="each of 12 joints"):
        Task(cell, path, force(joint_weights=np.ones(3)))
    with pytest.raises(ShapeError, match="each of 12 joints"):
        Task(cell, path, metric=np.ones(3))
    with pytest.raises(InputError, match="made in Python"):
        Task(cell, path).as_yaml()


def test_the_section_of_a_method_binds_that_method_alone() -> None:
    task = Task.load(TASK, ["path.corner.points=301"])  # the file names 31 points for two-stage
    assert task.path.h == 301
    with pytest.raises(InputError, match=r"two_stage\.Gamma: .*increasing points from 1 to 301"):
        plan_two_stage(task, starts=1)
