"""What `check` reports of a cell is what the cell is."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from test_bad_robots import SOUND

from dualarm_pin.cell import Cell
from dualarm_pin.cell.describe import describe
from dualarm_pin.cell.report import CellReport
from dualarm_pin.cell.report_text import text_of


@pytest.fixture(scope="module")
def report(cell: Cell) -> CellReport:
    return describe(cell)


def test_the_report_holds_arms_joints_rank_and_pairs(report: CellReport) -> None:
    first, second = report.arms
    assert (first.root, first.tip, first.joints) == ("base_link", "flange", 6)
    assert second.base_xyz == (2.5, 0.0, 0.0)
    assert second.base_rpy_deg == (0.0, 0.0, 180.0)
    assert 1.6 < first.reach < 2.1
    assert report.ranks == {6: 1.0}
    assert report.smallest_singular_value > 0.1
    assert report.collision.known
    assert report.collision.pairs > 100


def test_the_same_seed_gives_the_same_report(report: CellReport, cell: Cell) -> None:
    again, other = describe(cell), describe(cell, seed=1)
    assert again.ranks == report.ranks
    assert again.smallest_singular_value == report.smallest_singular_value
    assert other.smallest_singular_value != report.smallest_singular_value


def test_the_text_names_what_a_user_looks_for(report: CellReport) -> None:
    text = text_of(report)
    for piece in (
        "Cell ns16_pair: 12 joints",
        "base_link -> flange, 6 joints",
        "arm2/joint_3",
        "-150     45  deg",
        "base at (2.5, 0, 0) m, rpy (0, 0, 180) deg",
        "Rank of J_r over 50 random postures: 6 at 100%",
        "240 deg/s  900 deg/s^2   unknown",
        "torque: missing for all joints",
    ):
        assert piece in text


def test_the_dictionary_is_json(report: CellReport) -> None:
    data = json.loads(json.dumps(report.as_dict(), allow_nan=False))
    assert data["joints"][0]["name"] == "arm1/joint_1"
    assert data["ranks"] == {"6": 1.0}
    assert len(data["sources"]) == 2


def test_missing_meshes_and_locked_joints_are_shown(tmp_path: Path) -> None:
    text = SOUND.replace('<sphere radius="0.05"/>', '<mesh filename="none.stl"/>')
    (tmp_path / "small.urdf").write_text(text)
    file = tmp_path / "cell.yaml"
    file.write_text(
        "arms:\n  arm1: {urdf: small.urdf, tip: fore}\n  arm2: {base: {xyz: [1, 0, 0]}}\n"
    )
    report = describe(Cell.load(file))
    shown = text_of(report)
    assert report.collision.free_share is None
    assert "clearance is unknown: bodies are missing" in shown
    assert "arm1/upper: no such file: none.stl" in shown
    assert "arm1/slide = 0" in shown
    assert "arm2: a frame that stands still" in shown
    assert report.ranks == {2: 1.0}
    assert report.arms[1].reach is None
