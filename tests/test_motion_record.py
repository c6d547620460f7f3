"""A motion beside its result: what is written is what is read, and broken files are refused."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from answers import answer

from dualarm_pin.answer.folder import load_trajectory, save_trajectory
from dualarm_pin.errors import InputError, MissingFileError
from dualarm_pin.motion import Motion
from dualarm_pin.motion.summary import LimitUse, MotionSummary, TorqueUse

SUMMARY = MotionSummary(
    duration=2.0, feed=0.1, largest_feed=0.2, mean_feed=0.05, path_error_mm=1e-6,
    path_error_deg=1e-7, chord_error_mm=0.01, chord_error_deg=0.001,
    kinds=("velocity", "torque"), stretch=1.01, jerk="",
    limits=(LimitUse("velocity", "arm1/joint_1", 2.0, 0.5, 1.0),),
    torques=(TorqueUse("arm1/joint_1", 3.0, 1.0, 0.3, None, 12.0),),
)  # fmt: skip


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    save_trajectory(tmp_path, answer())
    return tmp_path


def motion(torque: bool = True) -> Motion:
    joints, m = answer().joints, 7
    values = np.random.default_rng(0).normal(size=(4, m, len(joints)))
    line = np.linspace(0.0, 1.0, m)
    return Motion(
        "time_optimal", joints, 2.0 * line, 0.3 * line, *values[:3],
        torque=values[3] if torque else None, summary=SUMMARY,
    )  # fmt: skip


@pytest.mark.parametrize("torque", [True, False])
def test_a_motion_reads_back_as_it_was_written(folder: Path, torque: bool) -> None:
    written = motion(torque)
    written.write(folder)
    read = Motion.load(folder)
    assert (read.law, read.joints, read.summary) == (written.law, written.joints, SUMMARY)
    assert read.arrays.keys() == written.arrays.keys()
    assert all(np.array_equal(read.arrays[name], array) for name, array in written.arrays.items())
    assert ("torque" in read.arrays) == torque


def test_the_result_stays_as_it_was_beside_its_motion(folder: Path) -> None:
    before = json.loads((folder / "result.json").read_text())
    motion().write(folder)
    after = json.loads((folder / "result.json").read_text())
    assert after.pop("motion")["duration"] == 2.0
    assert after == before
    assert np.array_equal(load_trajectory(folder).q, answer().q)


def test_the_table_names_every_column(folder: Path) -> None:
    motion().write(folder)
    header, *rows = (folder / "motion.csv").read_text().splitlines()
    names = header.split(",")
    table = np.array([row.split(",") for row in rows], dtype=float)
    assert names[:3] == ["time", "arc_length", "arm1/joint_1"]
    column = names.index("torque arm2/joint_6")
    assert np.array_equal(table[:, column], motion().torque[:, -1])


def test_a_result_without_a_motion_says_how_to_make_one(folder: Path) -> None:
    with pytest.raises(MissingFileError, match="dualarm-pin motion"):
        Motion.load(folder)


def test_a_folder_without_a_result_takes_no_motion(tmp_path: Path) -> None:
    with pytest.raises(MissingFileError):
        motion().write(tmp_path)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("damage", ["truncate", "time", "summary", "law", "gone"])
def test_damaged_files_are_refused(folder: Path, damage: str) -> None:
    motion().write(folder)
    archive, result = folder / "motion.npz", folder / "result.json"
    content = json.loads(result.read_text())
    if damage == "truncate":
        archive.write_bytes(archive.read_bytes()[:200])
    elif damage == "time":
        np.savez(archive, **{**motion().arrays, "time": np.zeros(7)})
    elif damage == "summary":
        content["motion"]["duration"] = "long"
    elif damage == "law":
        content["motion"]["law"] = "warp"
    else:
        archive.unlink()
    result.write_text(json.dumps(content))
    with pytest.raises(InputError):
        Motion.load(folder)
