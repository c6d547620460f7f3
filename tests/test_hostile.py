"""Hostile files: each ends in one message, in little time and memory, and before harm is done."""

from __future__ import annotations

import io
import subprocess
import sys
import tracemalloc
import zipfile
from pathlib import Path

import numpy as np
import pytest
from answers import answer
from paper_case import CELL, TASK
from patience import LONG

from dualarm_pin.answer.folder import load_trajectory, save_trajectory
from dualarm_pin.bench import suite as suites
from dualarm_pin.bench.suite import Suite
from dualarm_pin.errors import InputError, MissingFileError
from dualarm_pin.files import npz
from dualarm_pin.files.source import read_yaml
from dualarm_pin.planners.methods import plan
from dualarm_pin.robot.packages import find_file
from dualarm_pin.task import Task

BENCHMARKS = Path(__file__).resolve().parents[1] / "benchmarks"
sys.path.insert(0, str(BENCHMARKS))
from mutations import BOMB, KEY_BOMB, MERGE_BOMB


def test_broken_inputs_of_every_kind_are_refused_or_work() -> None:
    """The first seeds of the long run of `benchmarks/fuzz.py`."""
    done = subprocess.run(
        [sys.executable, "-W", "ignore", str(BENCHMARKS / "fuzz.py"), "--cases", "80"],
        capture_output=True, text=True, timeout=LONG, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-3000:]
    assert "80 cases, 0 failed" in done.stdout


YAML = {
    "aliases of aliases": (BOMB, "unfold to more than 1000000 values"),
    "aliases as keys": (KEY_BOMB, "a list or a mapping as a key"),
    "merged aliases": (MERGE_BOMB, "unfold to more than 1000000 values"),
    "a list as a key": ("a: 1\n? [a, b]\n: 2\n", "a list or a mapping as a key"),
    "a mapping as a key": ("a: {{b: 1}: 2}\n", "a list or a mapping as a key"),
    "in itself": ("a: &a [*a]\n", "nested more than 50 deep, or in itself"),
    "deep": ("a: " + "[" * 60 + "]" * 60, "nested more than 50 deep"),
    "deep by aliases": (
        "a0: &a0 []\n" + "".join(f"a{k}: &a{k} [*a{k - 1}]\n" for k in range(1, 60)),
        "nested more than 50 deep",
    ),
    "half a character": ('a: "\\ud800"\n', "half a character (a lone surrogate)"),
    "too large": ("#" + "a" * 1_000_000, "1000001 bytes is too large: 1000000 are allowed"),
    "a long number": ("a: " + "9" * 5000, "not valid YAML"),
}


@pytest.mark.parametrize("case", YAML)
def test_yaml_that_asks_for_too_much_is_refused_before_it_is_made(
    case: str, tmp_path: Path
) -> None:
    text, message = YAML[case]
    file = tmp_path / "a.yaml"
    file.write_text(text)
    tracemalloc.start()
    try:
        with pytest.raises(InputError) as caught:
            read_yaml(file)
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert str(caught.value).startswith(f"{file}")
    assert message in str(caught.value)
    assert peak < 20e6


NUMBERS = {
    "path.corner.points=1e12": "path.corner.points",
    "path.corner.points=1000000000000": "less than or equal to 100000",
    "path.corner.points=[1000000000000, 5, 13]": "less than or equal to 100000",
    "path.corner.side=1e12": "less than or equal to 1000000",
    "path.corner.height=-1e12": "greater than or equal to -1000000",
    "path={circle: {radius: 1e12, points: 9}}": "less than or equal to 1000000",
    "path={circle: {radius: 1, step: 1e-12}}": "more than 100000 points",
    "path={circle: {radius: 1, turns: 1e12, points: 9}}": "less than or equal to 1000000",
    "path={polyline: {vertices: [[0, 0, 0], [1e12, 0, 0]], points: 9}}": "equal to 1000000",
    "smoothness=1e300": "less than or equal to 1000000000000",
    "two_stage.Gamma=1000000000000": "less than or equal to 100000",
    "cell.arms.arm1.limits={joint_1: [-1e12, 1e12]}": "less than or equal to 1000000",
    "cell.arms.arm2.base.xyz=[1e300, 0, 0]": "less than or equal to 1000000",
    f"{'a.' * 60}a=1": "more than 50 keys in each other",
    "cell=/dev/zero": "is no plain file",
    f"cell={'a' * 5000}": "cannot be read",
    f"path={{csv: {'a' * 5000}}}": "cannot be read",
    f'cell.package_dirs=["{"a" * 5000}"]': "",
}


@pytest.mark.parametrize("change", NUMBERS)
def test_a_number_or_name_that_is_too_much_says_what_is_allowed(change: str) -> None:
    if not NUMBERS[change]:
        assert any("is no folder" in warning for warning in Task.load(TASK, [change]).cell.warnings)
        return
    with pytest.raises(InputError) as caught:
        Task.load(TASK, [change])
    assert NUMBERS[change] in str(caught.value)


@pytest.mark.parametrize(
    ("option", "allowed"),
    [
        ("starts", "1 to 1000000 is expected"),
        ("jobs", "1 to 1024 is expected"),
        ("seed", f"0 to {2**63 - 1} is expected"),
    ],
)
def test_an_option_that_is_too_much_says_what_is_allowed(
    option: str, allowed: str, task: Task
) -> None:
    with pytest.raises(InputError, match=f"--{option}: {allowed}"):
        plan(task, **{option: 10**400})


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        ("seeds: 1000000\n", r"seeds: 1000000 runs: 100000 are allowed"),
        ("seeds: 1000000000000\n", r"seeds: .*less than or equal to 1000000"),
        (
            "overrides: {grid: {a: {first: 0, last: 1, count: 1000}, "
            "b: {first: 0, last: 1, count: 1000}}}\n",
            r"overrides: 1000000 variants of 'paper_corner': 10000 are allowed",
        ),
    ],
)
def test_runs_are_counted_before_they_are_made(
    lines: str, message: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(suites, "_runs", lambda *_: pytest.fail("they were made"))
    file = tmp_path / "suite.yaml"
    file.write_text(f"tasks: [{TASK}]\nmethods: [local]\n{lines}")
    with pytest.raises(InputError, match=message):
        Suite.load(file)


def test_a_zip_bomb_is_refused_before_it_is_unpacked(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    save_trajectory(tmp_path, answer())
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("q.npy", bytes(25_000_000))
    assert len(data.getvalue()) < 30_000
    monkeypatch.setattr(npz, "_LARGEST", 20_000_000)
    (tmp_path / "trajectory.npz").write_bytes(data.getvalue())
    monkeypatch.setattr(np, "load", lambda *_, **__: pytest.fail("it was unpacked"))
    with pytest.raises(InputError, match="its arrays take 25000000 bytes, 20000000 are allowed"):
        load_trajectory(tmp_path)


@pytest.mark.parametrize(
    "name",
    ["package://parts/../secret.urdf", "package://../secret.urdf", "package://parts//../secret.urdf",
     "package://parts/a/../../secret.urdf", "model://parts/../secret.urdf",
     "package://parts/../parts/../secret.urdf"],
)  # fmt: skip
def test_a_package_is_not_left_by_its_names(name: str, tmp_path: Path) -> None:
    (tmp_path / "secret.urdf").write_text("secret")
    inside = tmp_path / "parts" / "a"
    inside.mkdir(parents=True)
    (inside / "b.urdf").write_text("b")
    with pytest.raises(MissingFileError, match="leaves the folder of its package"):
        find_file(name, tmp_path, [tmp_path])
    assert find_file("package://parts/a/../a/b.urdf", tmp_path) == inside / "b.urdf"
    with pytest.raises(MissingFileError, match="no such file"):  # an absolute rest stays inside
        find_file(f"package://parts/{tmp_path}/secret.urdf", tmp_path, [tmp_path])


@pytest.mark.parametrize("key", ["null", "true", "1.5", "2001-01-01", '""'])
def test_a_key_that_is_no_word_is_an_unknown_key(key: str, tmp_path: Path) -> None:
    file = tmp_path / "task.yaml"
    path = "{circle: {radius: 0.1, points: 9}}"
    file.write_text(f"cell: {CELL}\npath: {path}\n{key}: 1\n")
    with pytest.raises(InputError, match="unknown key"):
        Task.load(file)


def test_a_module_name_that_is_too_long_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "task.yaml"
    path = "{circle: {radius: 0.1, points: 9}}"
    file.write_text(f"cell: {CELL}\npath: {path}\nindex: {{call: '{'a' * 5000}:f'}}\n")
    with pytest.raises(InputError, match="it would import the module"):
        Task.load(file)


def test_a_message_about_half_a_character_can_be_written() -> None:
    said = str(InputError("not known", field="pairs.\udfff"))
    assert said.encode("utf-8") == b"pairs.\\udfff: not known"
