"""What the path itself decides about distances is known, and said, before any search."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from ns16_pair import motions
from paper_case import TASK

from dualarm_pin.clearance.asked import Asked, asked_of
from dualarm_pin.clearance.hands import hand_routes
from dualarm_pin.cli import main
from dualarm_pin.task import Task

WRISTS = ("arm1/link_6", "arm2/link_6")
NEXT = ("arm1/link_5", "arm2/link_6")


def ask(clearance: str, *changes: str) -> tuple[Task, Asked]:
    task = Task.load(TASK, [f"clearance={clearance}", *changes])
    return task, asked_of(task)


def test_a_fixed_distance_is_the_distance_on_any_motion() -> None:
    task, asked = ask("0.05")
    [wrists] = asked.fixed
    assert wrists.pair == WRISTS
    number = task.cell.pairs.index(WRISTS)
    for q, _ in motions()[:2]:
        seen = [task.cell.distances(each)[number] for each in q]
        np.testing.assert_allclose(wrists.distance, seen, atol=2e-6)
    assert "stay within 0.308 to 0.325 m on this path" in wrists.text


def test_a_task_that_says_nothing_spares_what_the_path_fixes_and_only_that() -> None:
    task, asked = ask("{}")
    spared = {pair for pair, r in zip(task.cell.pairs, asked.required, strict=True) if r < 0}
    assert spared == {WRISTS}
    assert set(asked.required) == {0.0, -np.inf}
    assert not ask("off")[1].any


def test_what_links_of_one_arm_never_reach_is_not_asked_of_them_unless_they_are_named() -> None:
    task, asked = ask("0.05")
    assert dict(asked.lowered) == pytest.approx(
        {(f"{arm}/link_4", f"{arm}/link_6"): 0.0342 for arm in ("arm1", "arm2")}, abs=2e-4
    )
    number = task.cell.pairs.index(("arm1/link_4", "arm1/link_6"))
    assert asked.required[number] == 0.0
    named = '{required: 0.05, pairs: {"arm1/link_4 arm1/link_6": 0.04}}'
    assert ask(named)[1].required[number] == 0.04


def test_what_an_arm_carries_counts_as_its_own_body() -> None:
    """Nothing but the hand lies between them: no motion would do, and no search would find one."""
    part = "cell.objects={part: {box: [0.1, 0.1, 0.1], on: arm1, at: {xyz: [0, 0, 0.06]}}}"
    task, asked = ask("0.05", part)
    assert dict(asked.lowered)[("arm1/link_5", "part")] == pytest.approx(0.047, abs=5e-4)
    assert asked.required[task.cell.pairs.index(("arm1/link_5", "part"))] == 0.0
    assert asked.required[task.cell.pairs.index(("arm2/link_5", "part"))] == 0.05


@pytest.mark.parametrize(("asks", "pairs"), [(0.31, 1), (0.3, 0), (0.35, 3)])
def test_what_the_path_forbids_is_named(asks: float, pairs: int) -> None:
    forbidden = {each.pair: each for each in ask(str(asks))[1].forbidden}
    assert len(forbidden) == pairs
    if pairs:
        assert forbidden[WRISTS].point == 0
        assert forbidden[WRISTS].distance == pytest.approx(0.308, abs=5e-4)
        assert f"the {asks:g} m asked for cannot be kept by any joint motion" in (
            forbidden[WRISTS].text
        )


def test_one_joint_behind_the_hand_no_value_of_it_has_more_than_what_is_called_the_most() -> None:
    """Without the proof between the looked-at values a narrow peak would be called impossible."""
    task, _ = ask("0.05", "cell.arms.arm1.limits_deg.joint_6=[-180, 180]")
    number = task.cell.pairs.index(NEXT)
    [route] = [each for each in hand_routes(task.cell, task.path) if each.number == number]
    assert task.cell.model.names[route.joint] == "arm1/joint_6"
    dense = [route.distance(3, v) for v in np.linspace(-np.pi, np.pi, 2001)]
    assert route.most(3, max(dense) + 1e-3) == pytest.approx(max(dense), abs=1e-4)
    assert route.most(3, max(dense) - 1e-3) is None


def test_a_free_spin_fixes_nothing_but_bodies_that_are_round_about_it() -> None:
    """The wrist of the NS16 is round about its flange; beside it the spin axis moves it."""
    down = "rotation: [[1, 0, 0], [0, -1, 0], [0, 0, -1]]"
    circle = f"path={{circle: {{radius: 0.1, points: 5, height: 0.3}}, {down}, free: spin}}"
    free = (circle, "two_stage.Gamma=2")
    for beside, fixed in ((0.0, {WRISTS}), (0.2, set())):
        task, asked = ask("0.0", *free, f"cell.arms.arm2.tool.xyz=[{beside}, 0, 0]")
        assert task.path.rows.tolist() == [5] * 5
        assert {each.pair for each in asked.fixed} == fixed
        assert {each.pair for each in ask("0.6", *free)[1].forbidden} >= {WRISTS}


def test_solve_says_so_at_once_and_ends_with_1(tmp_path: Path, capsys) -> None:
    asked = ["solve", str(TASK), "--set", "clearance=0.31", "--out", str(tmp_path)]
    with pytest.raises(SystemExit) as done:
        main(asked)
    assert done.value.code == 1
    result = json.loads((tmp_path / "result.json").read_text())
    assert not result["found"]
    assert result["message"].startswith("arm1/link_6 and arm2/link_6 stay within 0.308 to 0.325 m")
    assert "clearance.pairs" in result["message"]
