"""The command line as a user meets it: exit codes, one message for wrong input, files."""

from __future__ import annotations

import csv
import json
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from answers import answer
from commands import Run
from paper_case import CELL, TASK
from patience import LONG

from dualarm_pin.answer.folder import save_result
from dualarm_pin.motion import Motion
from dualarm_pin.task import Task


def started(*arguments: object, cwd: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "dualarm_pin", *map(str, arguments)],
        cwd=cwd,
        capture_output=True,
        text=True,
        timeout=LONG,
        check=False,
    )


def small_task(folder: Path, **changes: str) -> Path:
    """Write a task of five points, some of its lines changed."""
    lines = {
        "cell": str(CELL),
        "path": "{corner: {side: 0.15, fillet: 0.01, height: 0.3, points: [2, 1, 2]}, "
        "rotation: [[1, 0, 0], [0, -1, 0], [0, 0, -1]]}",
        "index": "{force: {direction: tangent}}",
        "smoothness": "3.0",
    } | changes
    file = folder / "small.yaml"
    file.write_text("\n".join(f"{k}: {v}" for k, v in lines.items() if v) + "\n")
    return file


def test_solve_writes_a_result_that_scripts_can_read(tmp_path: Path) -> None:
    done = started("solve", small_task(tmp_path), "--method", "local", "--out", "r", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "found by local" in done.stdout
    result = json.loads((tmp_path / "r" / "result.json").read_text())
    assert result["found"] is True
    assert result["method"] == "local"
    assert len(result["index"]) == 5
    assert result["joints"][0] == "arm1/joint_1"
    with (tmp_path / "r" / "trajectory.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 5
    assert list(rows[0])[:3] == ["point", "arc_length", "arm1/joint_1"]
    assert sorted(p.name for p in (tmp_path / "r").iterdir()) == [
        "result.json", "task.yaml", "trajectory.csv", "trajectory.npz",
    ]  # fmt: skip


def test_the_task_in_a_result_solves_again_to_the_same_answer(tmp_path: Path, run: Run) -> None:
    task = small_task(tmp_path)
    first = run("solve", task, "--method", "local", "--out", "a", "--set", "smoothness=7",
                "--set", "cell.arms.arm2.base.xyz=[2.45, 0, 0]", cwd=tmp_path)  # fmt: skip
    second = run("solve", "a/task.yaml", "--method", "local", "--out", "b", cwd=tmp_path)
    assert (first.returncode, second.returncode) == (0, 0), first.stderr + second.stderr
    read = [(tmp_path / r / "trajectory.csv").read_text() for r in "ab"]
    assert read[0] == read[1]
    other = run("solve", task, "--method", "local", "--out", "c", cwd=tmp_path)
    assert other.returncode == 0
    assert (tmp_path / "c" / "trajectory.csv").read_text() != read[0]


def test_an_unreachable_path_ends_with_1_and_its_result(tmp_path: Path, run: Run) -> None:
    task = small_task(tmp_path)
    done = run("solve", task, "--method", "local", "--set", "path.corner.height=4.5",
               "--out", "r", cwd=tmp_path)  # fmt: skip
    assert done.returncode == 1
    assert "point 1 of 5 has no solution" in done.stderr
    result = json.loads((tmp_path / "r" / "result.json").read_text())
    assert result["found"] is False
    assert "point 1" in result["message"]


BAD = {
    "unknown key": ({"smothness": "3"}, r"small.yaml:5: smothness: unknown key: did you mean 'smo"),
    "wrong type": ({"smoothness": "smooth"}, "small.yaml:4: smoothness"),
    "negative": ({"smoothness": "-1"}, "small.yaml:4: smoothness"),
    "missing cell": ({"cell": ""}, "cell: the path of a cell file is expected"),
    "cell file gone": ({"cell": "gone.yaml"}, "small.yaml:1: cell"),
    "unknown index": ({"index": "{forse: {}}"}, "small.yaml:3: index.forse: unknown key"),
    "two indices": (
        {"index": "{force: {}, velocity: {}}"},
        ":3: index: exactly one index",
    ),
    "zero direction": ({"index": "{force: {direction: [0, 0, 0]}}"}, "small.yaml:3: index.force"),
    "too few points": (
        {"path": "{corner: {side: 0.15, fillet: 0.01, height: 0.3, points: [1, 0, 0]}}"},
        "small.yaml:2: path",
    ),
    "no path": ({"path": ""}, "path: this key is missing"),
    "joint weights": ({"index": "{force: {joint_weights: [1, 2]}}"}, "weight for each of 12"),
    "Gamma": ({"two_stage": "{Gamma: [1, 4]}"}, "small.yaml:5: two_stage.Gamma: expected"),
    "not YAML": ({"path": "{corner: [}"}, "small.yaml:2: not valid YAML"),
}


@pytest.mark.parametrize(("changes", "message"), BAD.values(), ids=BAD)
def test_wrong_input_ends_with_2_and_one_message(
    tmp_path: Path, changes: dict[str, str], message: str, run: Run
) -> None:
    method = ("--method", "two-stage") if "two_stage" in changes else ()
    done = run("solve", small_task(tmp_path, **changes), *method, "--out", "r", cwd=tmp_path)
    assert done.returncode == 2, done.stdout + done.stderr
    assert message in done.stderr
    assert "Traceback" not in done.stderr
    assert not (tmp_path / "r").exists()


COMMANDS = {
    "no such file": (("solve", "gone.yaml"), "gone.yaml: no such file"),
    "no such method": (("solve", TASK, "--method", "best"), "method"),
    "no such solver": (
        ("solve", TASK, "--method", "local", "--solver", "clamp"),
        "did you mean 'clamped'",
    ),
    "no such option": (("solve", TASK, "--efort", "quick"), "efort"),
    "no such command": (("solv",), "solv"),
    "starts": (("solve", TASK, "--starts", "0"), "--starts: 1 to 1000000 is expected"),
    "seed": (("solve", TASK, "--seed", "-1"), "--seed: 0 to "),
    "bad --set": (("solve", TASK, "--set", "smoothness"), "give key=value"),
    "unknown --set": (("solve", TASK, "--set", "smothness=3"), "unknown key"),
    "cell --set": (("solve", TASK, "--set", "cell.arms.arm2.bsae.xyz=[1, 0, 0]"), "bsae"),
    "no result": (("view", "."), "give the folder that `solve --out` wrote"),
    "nothing to view": (("view",), "RESULTS requires an argument"),
    "out is a file": (("solve", TASK, "--method", "local", "--out", "file/x"), "cannot write here"),
}  # fmt: skip


@pytest.mark.parametrize(("arguments", "message"), COMMANDS.values(), ids=COMMANDS)
def test_a_wrong_command_ends_with_2_and_one_message(
    tmp_path: Path, arguments: tuple[object, ...], message: str, run: Run
) -> None:
    (tmp_path / "file").write_text("")
    done = run(*arguments, cwd=tmp_path)
    assert done.returncode == 2, done.stdout + done.stderr
    assert message in done.stderr
    assert "Traceback" not in done.stderr


def test_the_options_are_those_of_the_table_of_methods() -> None:
    from typing import get_args, get_type_hints

    from dualarm_pin.cli.solve import solve
    from dualarm_pin.planners.methods import EFFORTS, METHODS

    hints = get_type_hints(solve)
    named, nothing = get_args(hints["method"])
    assert get_args(named) == tuple(METHODS) and nothing is type(None)
    assert get_args(hints["effort"]) == EFFORTS


def test_version_and_help_end_with_0(tmp_path: Path, run: Run) -> None:
    assert run("--version", cwd=tmp_path).stdout.strip().count(".") == 2
    for command in ((), ("solve",), ("paper",), ("view",), ("check",), ("bench",)):
        done = run(*command, "--help", cwd=tmp_path)
        assert done.returncode == 0
        assert "Usage" in done.stdout


def test_check_says_what_was_understood(tmp_path: Path, run: Run) -> None:
    done = run("check", CELL, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "arm1/joint_1" in done.stdout
    done = run("check", TASK, "--json", cwd=tmp_path)
    facts = json.loads(done.stdout)
    assert facts["task"]["points"] == 31
    assert facts["task"]["first_point"] == "reached"


def test_ctrl_c_ends_at_once_without_a_traceback(tmp_path: Path) -> None:
    process = subprocess.Popen(
        [sys.executable, "-m", "dualarm_pin", "solve", str(TASK), "--method", "two-stage",
         "--out", "r"],
        cwd=tmp_path, stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
    )  # fmt: skip
    assert any("stage 1" in line for line in process.stderr)
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=LONG)
    assert "Traceback" not in err, err
    assert process.returncode in (0, 1, 130)
    if process.returncode == 0:  # what was finished became a whole, verified path
        assert json.loads((tmp_path / "r" / "result.json").read_text())["found"] is True


def test_motion_is_written_beside_a_result_and_refused_without_one(
    tmp_path: Path, run: Run
) -> None:
    out = tmp_path / "r"
    save_result(out, Task.load(TASK), answer())
    before = (out / "result.json").read_bytes()
    refused = run("motion", out, "--feed", 3, cwd=tmp_path)
    assert (refused.returncode, refused.stderr.count("\n")) == (2, 1)
    assert "largest is 0.0219" in refused.stderr
    assert (out / "result.json").read_bytes() == before
    assert not (out / "motion.csv").exists()
    done = run("motion", out, "--law", "time_optimal", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "time optimal" in done.stdout
    assert Motion.load(out).duration == pytest.approx(2.016, abs=0.01)
    missing = run("motion", tmp_path, cwd=tmp_path)
    assert (missing.returncode, missing.stderr.count("\n")) == (2, 1)


def test_solve_runs_the_motion_that_the_task_asks_for(tmp_path: Path, run: Run) -> None:
    path = "{corner: {side: 0.15, fillet: 0.01, height: 0.3, points: [9, 3, 9]}, "
    path += "rotation: [[1, 0, 0], [0, -1, 0], [0, 0, -1]]}"
    task = small_task(tmp_path, motion="{law: time_optimal, rate: 0.01}", path=path)
    done = run("solve", task, "--method", "local", "--out", "r", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    motion = Motion.load(tmp_path / "r")
    assert motion.law == "time_optimal"
    assert motion.time[1] <= 0.01
    missing = small_task(tmp_path, motion="{limits: [jerk]}")
    refused = run("solve", missing, "--method", "local", "--out", "s", cwd=tmp_path)
    assert refused.returncode == 2
    assert "jerk_deg_s3" in refused.stderr
    assert not (tmp_path / "s").exists()
