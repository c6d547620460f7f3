"""In CI nothing is skipped: what a test needs is installed, or the run fails and says what."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

HERE = Path(__file__).parent
SKIPS = {
    "browser": (
        "from browser import chromium\nimport browser\nbrowser.CHROMIUM = None\n"
        "def test():\n    chromium()",
        "apt-get install chromium",
    ),
    "robot": (
        "import robot_table, pytest\n"
        "@pytest.mark.skipif(True, reason=robot_table.needs_robots.kwargs['reason'])\n"
        "def test():\n    pass",
        "pip install 'dualarm-pin[robots]'",
    ),
    "dask": (
        "import sys, pytest\nsys.modules['distributed'] = None\n"
        "pytest.importorskip('distributed')\ndef test():\n    pass",
        "pip install 'dualarm-pin[bench]'",
    ),
    "another": ("import pytest\ndef test():\n    pytest.skip('a whim')", "dualarm-pin[dev]"),
}


def run(folder: Path, test: str, ci: str) -> subprocess.CompletedProcess[str]:
    (folder / "test_it.py").write_text(test)
    return subprocess.run(
        [sys.executable, "-m", "pytest", "-p", "conftest", "-p", "no:cacheprovider", "-rs", "."],
        cwd=folder,
        env=os.environ | {"CI": ci},
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.mark.parametrize(("test", "hint"), SKIPS.values(), ids=SKIPS)
def test_a_skip_is_a_failure_with_ci_alone(tmp_path: Path, test: str, hint: str) -> None:
    here = run(tmp_path, test, "")
    assert here.returncode in (0, 5), here.stdout
    assert "1 skipped" in here.stdout
    there = run(tmp_path, test, "true")
    assert there.returncode not in (0, 5), there.stdout
    assert "nothing may be skipped" in there.stdout
    assert hint in there.stdout


def test_an_expected_failure_is_no_skip(tmp_path: Path) -> None:
    test = "import pytest\n@pytest.mark.xfail(strict=True)\ndef test():\n    assert False"
    assert run(tmp_path, test, "true").returncode == 0


def test_ci_without_a_browser_fails_before_any_test(tmp_path: Path) -> None:
    (tmp_path / "dirname").symlink_to(str(shutil.which("dirname")))
    done = subprocess.run(
        [str(shutil.which("bash")), str(HERE.parent / ".ci" / "run")],
        env={"PATH": str(tmp_path)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 1
    assert "chromium is missing and could not be installed" in done.stderr
    assert "make" not in done.stderr
