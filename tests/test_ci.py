"""In CI nothing is skipped: what a test needs is installed, or the run fails and says what."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

HERE = Path(__file__).parent
XFAIL = "import pytest\n@pytest.mark.xfail(strict=True)\ndef test():\n    assert False"
TESTS = {
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


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """What pytest says of all these tests, by the value of CI."""
    folder = tmp_path_factory.mktemp("ci")
    for name, test in (TESTS | {"xfail": (XFAIL, "")}).items():
        (folder / f"test_{name}.py").write_text(test[0])
    command = [sys.executable, "-m", "pytest", "-p", "conftest", "-p", "no:cacheprovider"]
    return {
        ci: subprocess.run(
            [*command, "-rA", "--continue-on-collection-errors", "."],
            cwd=folder,
            env=os.environ | {"CI": ci},
            capture_output=True,
            text=True,
            check=False,
        ).stdout
        for ci in ("", "true")
    }


@pytest.mark.parametrize("name", TESTS)
def test_a_skip_is_a_failure_in_ci(runs: dict[str, str], name: str) -> None:
    said = re.search(rf"^(FAILED|ERROR) test_{name}.py.*", runs["true"], re.M)
    assert said is not None, runs["true"]
    assert "nothing may be skipped" in said.group()
    assert TESTS[name][1] in runs["true"]


def test_elsewhere_it_is_a_skip_and_an_expected_failure_is_none(runs: dict[str, str]) -> None:
    assert re.search(r"= 4 skipped, 1 xfailed in", runs[""])
    assert re.search(r"= 2 failed, 1 xfailed, 2 errors in", runs["true"])


@pytest.mark.parametrize(("ci", "all_of_them"), [("", False), ("true", True), ("1", True)])
def test_slow_tests_run_in_ci(ci: str, all_of_them: bool) -> None:
    done = subprocess.run(
        ["make", "--dry-run", "test"],
        cwd=HERE.parent,
        env=os.environ | {"CI": ci},
        capture_output=True,
        text=True,
        check=True,
    )
    [command] = [line for line in done.stdout.splitlines() if "-m pytest" in line]
    assert ('-m "not slow"' not in command) is all_of_them
    assert "export CI=true" in (HERE.parent / ".ci" / "run").read_text()


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
