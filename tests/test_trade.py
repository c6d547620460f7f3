"""The trade between index and speed: more weight on time costs index and brings feed."""

from __future__ import annotations

from pathlib import Path

import pytest
from answers import answer
from paper_case import TASK

from dualarm_pin.answer.folder import load_result, save_result
from dualarm_pin.cli.trade import trade as command
from dualarm_pin.errors import InputError, MissingFileError
from dualarm_pin.motion import Motion
from dualarm_pin.planners.trade import trade
from dualarm_pin.task import Task


def test_each_weight_is_a_motion_one_can_open(tmp_path: Path) -> None:
    save_result(tmp_path / "r", Task.load(TASK), answer())
    slow, fast = reversed(list(trade(tmp_path / "r", [1.0, 1e5], tmp_path / "out")))
    assert slow.motion is not None
    assert fast.motion is not None
    assert fast.motion.summary.feed > 1.5 * slow.motion.summary.feed
    assert fast.mean_index > slow.mean_index
    for point in (slow, fast):
        task, trajectory = load_result(point.folder)
        assert trajectory.found
        assert trajectory.mean_index == pytest.approx(point.mean_index)
        assert (task.smoothness, task.per_arc_length) == (point.weight, True)
        assert Motion.load(point.folder).summary == point.motion.summary


def test_wrong_weights_and_folders_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="0 or more"):
        command(tmp_path, weights=(-1.0,))
    with pytest.raises(MissingFileError):
        command(tmp_path, weights=(1.0,))
