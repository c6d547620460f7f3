"""Further answers, given ends and earlier results: each is an answer, checked, or is refused."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from paper_case import TASK

from dualarm_pin.answer.alternatives import kept, other_posture
from dualarm_pin.answer.folder import (
    load_result,
    save_result,
    with_alternatives,
)
from dualarm_pin.answer.trajectory import Trajectory
from dualarm_pin.answer.verify import verified
from dualarm_pin.cli import main
from dualarm_pin.errors import InputError
from dualarm_pin.path.paths import corner
from dualarm_pin.planners.earlier import resampled
from dualarm_pin.planners.methods import plan
from dualarm_pin.planners.whole_path import plan_global
from dualarm_pin.task import Task


@pytest.fixture(scope="module")
def task() -> Task:
    return Task.load(TASK)


@pytest.fixture(scope="module")
def best(task: Task) -> Trajectory:
    return plan_global(task, effort="quick", alternatives=2)


def with_points(task: Task, points: tuple[int, int, int]) -> Task:
    path = corner(0.15, 0.01, 0.3, points, rotation=np.diag([1.0, -1.0, -1.0]))
    return replace(task, path=path, Gamma=())


def test_an_alternative_is_an_answer_in_another_posture(task: Task, best: Trajectory) -> None:
    [other] = best.alternatives
    assert best.found
    assert other.trajectory.found
    assert other.trajectory.objective > best.objective
    assert other_posture(best.q, other.trajectory.q, task.cell.joints)
    assert other.trajectory.evidence.local is not None
    assert other.trajectory.evidence.local.minimum
    assert all(far > 0.3 for far in other.apart.values())


def test_full_turns_and_near_paths_are_no_other_posture(task: Task, best: Trajectory) -> None:
    joints, turned = task.cell.joints, best.q.copy()
    turned[:, 3] += 2.0 * np.pi
    assert not other_posture(best.q, turned, joints)
    assert not other_posture(best.q, best.q + 0.1, joints)
    assert other_posture(best.q, best.q + 0.4, joints)


def test_what_the_check_does_not_find_is_no_alternative(task: Task, best: Trajectory) -> None:
    away = best.q + 0.5  # not on the path
    made = lambda: verified(task, away, method="global", solver="engine")  # noqa: E731
    assert kept(best, [(away, made)], 2, task.cell.joints) == ()


def test_alternatives_stand_beside_the_result_and_go_with_it(
    task: Task, best: Trajectory, tmp_path: Path
) -> None:
    save_result(tmp_path, task, best)
    assert with_alternatives(tmp_path) == [tmp_path, tmp_path / "alternatives" / "2"]
    asked, read = load_result(tmp_path / "alternatives" / "2")
    assert asked.path.h == task.path.h
    np.testing.assert_array_equal(read.q, best.alternatives[0].trajectory.q)
    listed = json.loads((tmp_path / "result.json").read_text())["alternatives"]
    assert [each["folder"] for each in listed] == [".", "alternatives/2"]
    assert listed[1]["objective"] == pytest.approx(read.objective)
    assert listed[1]["apart"] == best.alternatives[0].apart
    (tmp_path / "motion.csv").write_text("of this one")
    (tmp_path / "motion.npz").write_bytes(b"of this one")
    (tmp_path / "sensitivity.json").write_text("{}")
    (tmp_path / "mine.txt").write_text("stays")
    save_result(tmp_path, task, replace(best, alternatives=()))
    names = {file.name for file in tmp_path.rglob("*")}
    assert names == {"task.yaml", "trajectory.csv", "trajectory.npz", "result.json", "mine.txt"}


def test_a_page_shows_the_alternatives_of_a_result(
    task: Task, best: Trajectory, tmp_path: Path
) -> None:
    save_result(tmp_path / "r", task, best)
    with pytest.raises(SystemExit) as ended:
        main(["view", str(tmp_path / "r"), "--html", str(tmp_path / "page.html")])
    assert ended.value.code == 0
    assert (tmp_path / "page.html").stat().st_size > 1e5


def test_a_path_begins_and_ends_where_it_is_told_to(task: Task, best: Trajectory) -> None:
    begin = best.alternatives[0].trajectory.q[0]
    told = replace(task, from_posture=begin)
    answer = plan_global(told, effort="quick")
    assert answer.found
    np.testing.assert_array_equal(answer.q[0], begin)
    assert answer.evidence.local is not None
    assert answer.evidence.local.minimum
    assert answer.evidence.local.objective == pytest.approx(answer.objective)
    assert answer.objective <= best.alternatives[0].trajectory.objective + 1e-6
    both = replace(task, from_posture=best.q[0], to_posture=best.q[-1])
    assert plan_global(both, effort="quick").objective == pytest.approx(best.objective, rel=1e-6)


def test_an_answer_with_another_first_posture_is_not_found(task: Task, best: Trajectory) -> None:
    told = replace(task, from_posture=best.alternatives[0].trajectory.q[0])
    answer = verified(told, best.q, method="global", solver="engine")
    assert not answer.found
    assert "from_posture is violated" in answer.message


def test_a_posture_off_the_path_or_its_bounds_is_refused(task: Task, best: Trajectory) -> None:
    q = best.q[0].copy()
    q[0] += 1e-3
    with pytest.raises(InputError, match=r"from_posture.* mm and .* deg from point 1"):
        replace(task, from_posture=q)
    with pytest.raises(InputError, match=r"to_posture.* mm and .* deg from point 31"):
        replace(task, to_posture=best.q[0])
    q[0] = 99.0
    with pytest.raises(InputError, match="beyond its bounds"):
        replace(task, from_posture=q)
    with pytest.raises(InputError, match=r"\(12\)"):
        replace(task, from_posture=q[:3])
    with pytest.raises(InputError, match="take global"):
        plan(replace(task, from_posture=best.q[0]), "two-stage")


def test_a_task_file_gives_a_posture_by_list_degrees_or_result(
    task: Task, best: Trajectory, tmp_path: Path
) -> None:
    save_result(tmp_path / "r", task, best)
    radians = [f"from_posture={best.q[0].tolist()}"]
    degrees = [f"from_posture={{deg: {np.rad2deg(best.q[0]).tolist()}}}"]
    result = [f"from_posture={{result: {tmp_path / 'r'}, point: 1}}"]
    for change in (radians, degrees, result):
        np.testing.assert_allclose(Task.load(TASK, change).from_posture, best.q[0], atol=1e-12)
    again = tmp_path / "again.yaml"
    again.write_text(Task.load(TASK, result).as_yaml())
    (tmp_path / "r" / "trajectory.npz").unlink()
    np.testing.assert_array_equal(Task.load(again).from_posture, best.q[0])
    for change, said in (
        ("{result: nowhere}", "trajectory.npz"),
        ("{deg: [1, 2]}", "12 joints are expected; given 2"),
        ("{}", "one of `deg` and `result`"),
    ):
        with pytest.raises(InputError, match=said):
            Task.load(TASK, [f"from_posture={change}"])


def test_an_earlier_result_is_a_start_and_wins_where_it_is_better(
    task: Task, best: Trajectory
) -> None:
    coarse = with_points(task, (7, 3, 7))
    np.testing.assert_allclose(resampled(coarse, best)[[0, -1]], best.q[[0, -1]])
    turned = replace(best, joints=best.joints[::-1], q=best.q[:, ::-1])
    np.testing.assert_array_equal(resampled(task, turned), resampled(task, best))
    cold = plan_global(task, effort="quick", seed=3)
    warm = plan_global(task, effort="quick", seed=3, warm=best)
    assert warm.objective <= min(cold.objective, best.objective) + 1e-6
    other = replace(best, joints=("arm1/other", *best.joints[1:]))
    with pytest.raises(InputError, match="arm1/joint_1, arm1/other"):
        plan_global(task, effort="quick", warm=other)
