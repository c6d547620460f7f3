"""`dualarm-pin paper` with few starts: every row, figure and file, and the shape of the curves."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from dualarm_pin.answer.folder import load_result
from dualarm_pin.paper import CLEAR, Reproduction, notes, reproduce, write


@pytest.fixture(scope="module")
def reproduction() -> Reproduction:
    return reproduce(starts=4, seed=0)


def test_the_table_holds_every_method(reproduction: Reproduction) -> None:
    labels = list(reproduction.trajectories)
    assert labels[:3] == ["two-stage", "two-stage, polished", "whole path"]
    assert {f"pseudo-inverse, {v}" for v in ("free", "clamped", "qp")} <= set(labels)
    assert sum("random" in label for label in labels) == 3
    table = reproduction.table().splitlines()
    assert len(table) == len(labels) + 2
    assert "bounds [deg]" in table[0]


def test_the_methods_rank_as_they_must(reproduction: Reproduction) -> None:
    two_stage, polished, whole = list(reproduction.trajectories.values())[:3]
    assert two_stage.found
    assert polished.found
    assert whole.found
    assert whole.objective <= polished.objective + 1e-9 <= two_stage.objective + 1e-9


def test_the_pseudo_inverse_rises_through_the_fillet(reproduction: Reproduction) -> None:
    index = reproduction.trajectories["pseudo-inverse, free, best first"].index
    assert 1.3 < np.mean(index) < 1.7
    assert index[:13].max() < 0.5
    assert index[18] > 2.0
    assert any("leaves the bounds" in note for note in notes(reproduction))


def test_the_row_with_a_clearance_is_kept_with_the_task_that_asks_for_it(
    reproduction: Reproduction, tmp_path: Path
) -> None:
    apart = reproduction.trajectories[CLEAR].checked.apart
    assert apart is not None
    assert (apart.required, apart.kept, apart.level) == (0.05, True, "certified")
    assert reproduction.trajectories["whole path"].checked.apart is None
    write(reproduction, tmp_path)
    task, again = load_result(tmp_path / "results" / "whole-path-clearance-0.05")
    assert task.clearance is not None
    assert task.clearance.distance == 0.05
    assert again.found
    assert load_result(tmp_path / "results" / "whole-path")[0].clearance is None
    [note] = [note for note in notes(reproduction) if note.startswith(CLEAR)]
    assert "arm1/link_4 and arm1/link_6 (0.034 m)" in note


def test_every_file_is_written(reproduction: Reproduction, tmp_path: Path) -> None:
    written = write(reproduction, tmp_path)
    assert all(file.stat().st_size > 100 for file in written)
    names = {file.name for file in written}
    assert names == {"table.txt", "table.csv", "animation.html"} | {
        f"fig{n}.{kind}" for n in (3, 4, 5) for kind in ("png", "svg")
    }
    results = [json.loads(f.read_text()) for f in tmp_path.glob("results/*/result.json")]
    assert len(results) == len(reproduction.trajectories)
