"""The README tells the truth: its code runs, its commands exist, its files are there."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
TEXT = (ROOT / "README.md").read_text(encoding="utf-8")
CODE = re.findall(r"```python\n(.*?)```", TEXT, re.DOTALL)


def test_the_ten_lines_run_and_find_the_best_known_path(tmp_path: Path) -> None:
    assert len(CODE) == 2
    assert len([line for line in CODE[0].splitlines() if line.strip()]) <= 10
    done = subprocess.run(
        [sys.executable, "-c", CODE[0]], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    found, mean, objective, verdict = done.stdout.split()
    assert found == "True"
    assert float(mean) == pytest.approx(0.4063, abs=1e-4)
    assert float(objective) == pytest.approx(12.7309, abs=1e-4)
    assert verdict == "local_only"


def test_the_session_runs_and_its_motion_follows_the_base(tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-c", CODE[1]], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    moved, rest = map(float, done.stdout.split())
    assert moved == pytest.approx(11.49, abs=0.01)
    assert 0.0 < rest < moved


@pytest.mark.parametrize("target", sorted(set(re.findall(r"\]\((docs/[^)]+)\)", TEXT))))
def test_the_pictures_are_there(target: str) -> None:
    assert (ROOT / target).stat().st_size > 10_000


def test_the_make_commands_and_folders_exist() -> None:
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    for command in set(re.findall(r"^make (\w+)", TEXT, re.MULTILINE)):
        assert f"\n{command}:" in makefile
    for folder in ("urdf/cells", "urdf/tasks", "notebooks", "benchmarks"):
        assert (ROOT / folder).is_dir()


def test_the_commands_of_the_synopsis_are_those_of_the_program() -> None:
    from dualarm_pin.cli import app

    named = set(re.findall(r"^dualarm-pin (\w+)", TEXT, re.MULTILINE))
    assert named == {name for name in app if not name.startswith("-")}
