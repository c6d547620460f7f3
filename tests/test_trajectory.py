"""Result files: what is written is read back, whole, and what is broken is refused."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from dualarm_pin.answer.trajectory import Evidence, LawCount, Timing, Trajectory
from dualarm_pin.errors import InputError, MissingFileError

REQUIRED = (
    "found method solver objective mean_index arc_mean_index max_index index max_position_error "
    "max_rotation_error max_bound_violation max_joint_step min_clearance evidence timing seed "
    "versions joints units"
).split()


def example(**changes: object) -> Trajectory:
    values = {
        "q": np.array([[0.1, -0.2], [0.3, 0.4], [0.5, 1 / 3]]),
        "joints": ("arm1/a", "arm2/b,c"),
        "arc_length": np.array([0.0, 0.5, 2.0]),
        "index": np.array([1.0, 2.0, 6.0]),
        "found": True,
        "method": "global",
        "solver": "engine",
        "objective": 9.5,
        "arc_mean_index": 3.375,
        "max_position_error": 1e-12,
        "max_rotation_error": 2e-12,
        "max_bound_violation": 0.0,
        "max_joint_step": 0.6,
        "evidence": Evidence("best_known", {"whole path": LawCount(300, 290, 80, 4)}, 0.0099),
        "timing": Timing(1.0, 2.0, 0.0),
        "seed": 7,
        "versions": {"pin": "4"},
    }
    return Trajectory(**(values | changes))  # type: ignore[arg-type]


def test_a_saved_trajectory_reads_back_equal(tmp_path: Path) -> None:
    saved = example(clearance=np.array([0.3, 0.2, 0.1]), min_clearance=0.1)
    saved.save(tmp_path)
    read = Trajectory.load(tmp_path)
    np.testing.assert_array_equal(read.q, saved.q)
    assert read.as_dict() == saved.as_dict()
    assert read.evidence.laws["whole path"].best_hits == 4


def test_result_json_holds_every_key_scripts_rely_on(tmp_path: Path) -> None:
    example().save(tmp_path)
    result = json.loads((tmp_path / "result.json").read_text())
    assert not [key for key in REQUIRED if key not in result]
    assert result["mean_index"] == 3.0
    assert result["max_index"] == 6.0
    assert set(result["evidence"]) >= {
        "verdict", "laws", "missed_share_95", "stationarity", "curvature_min", "active_bounds",
        "lower_bound", "gap",
    }  # fmt: skip


def test_what_is_not_finite_is_null_never_nan(tmp_path: Path) -> None:
    example(objective=float("nan")).save(tmp_path)
    text = (tmp_path / "result.json").read_text()
    assert "NaN" not in text
    assert json.loads(text)["objective"] is None


def test_the_csv_has_the_documented_header_and_exact_numbers(tmp_path: Path) -> None:
    import csv

    trajectory = example()
    trajectory.save(tmp_path)
    with (tmp_path / "trajectory.csv").open(newline="") as file:
        header, *rows = list(csv.reader(file))
    assert header == ["point", "arc_length", "arm1/a", "arm2/b,c", "index"]
    np.testing.assert_array_equal(np.array(rows, float)[:, 2:4], trajectory.q)
    assert [row[0] for row in rows] == ["1", "2", "3"]


def test_the_npz_holds_no_pickle(tmp_path: Path) -> None:
    example().save(tmp_path)
    with np.load(tmp_path / "trajectory.npz", allow_pickle=False) as arrays:
        assert set(arrays) == {"q", "index", "arc_length", "joints"}


def test_nothing_half_written_is_left_when_writing_fails(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*args: object, **kwargs: object) -> None:
        raise RuntimeError("disk")

    monkeypatch.setattr(np, "savez", fail)
    with pytest.raises(RuntimeError):
        example().save(tmp_path)
    assert sorted(p.name for p in tmp_path.iterdir()) == ["trajectory.csv"]


def test_a_folder_without_a_result_is_refused(tmp_path: Path) -> None:
    with pytest.raises(MissingFileError, match=r"result\.json: no result here"):
        Trajectory.load(tmp_path)


@pytest.mark.parametrize("text", ["{", "[]", "{}", '{"evidence": 3}'])
def test_a_broken_result_is_refused_with_its_name(tmp_path: Path, text: str) -> None:
    example().save(tmp_path)
    (tmp_path / "result.json").write_text(text)
    with pytest.raises(InputError, match=r"result\.json"):
        Trajectory.load(tmp_path)


def test_a_broken_npz_is_refused_with_its_name(tmp_path: Path) -> None:
    example().save(tmp_path)
    (tmp_path / "trajectory.npz").write_bytes(b"PK not an archive")
    with pytest.raises(InputError, match=r"trajectory\.npz"):
        Trajectory.load(tmp_path)
