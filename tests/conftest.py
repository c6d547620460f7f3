"""What all tests share: the paper's task, a path for child processes, and no skip in CI."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from commands import Run

    from dualarm_pin.cell import Cell
    from dualarm_pin.problem import Problem
    from dualarm_pin.task import Task

# Planners of `bench_fakes` are named in suites and loaded by processes that tests start.
os.environ["PYTHONPATH"] = os.pathsep.join(
    filter(None, (str(Path(__file__).parent), os.environ.get("PYTHONPATH")))
)

INSTALL = {
    "chromium": "apt-get install chromium, or set DUALARM_PIN_CHROMIUM",
    "robot": "pip install 'dualarm-pin[robots]'",
    "distributed": "pip install 'dualarm-pin[bench]'",
    "pyarrow": "pip install 'dualarm-pin[bench]'",
}


@pytest.fixture(scope="session")
def task() -> Task:
    """The paper's task: 31 points of a corner, lambda 3. Loaded once a process."""
    import paper_case

    return paper_case.task()


@pytest.fixture(scope="session")
def cell() -> Cell:
    """The paper's two NS16."""
    import paper_case

    return paper_case.task().cell


@pytest.fixture(scope="session")
def problem() -> Problem:
    """The paper's programme over all 31 points."""
    import paper_case

    return paper_case.problem()


@pytest.fixture
def run(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Run:
    """Run `dualarm-pin` with arguments from the folder `cwd`; what it does not catch is raised."""
    from commands import Done

    from dualarm_pin.cli import main

    def run(*arguments: object, cwd: Path) -> Done:
        monkeypatch.chdir(cwd)
        capsys.readouterr()
        with pytest.raises(SystemExit) as end:
            main([str(each) for each in arguments])
        return Done(int(end.value.code or 0), *capsys.readouterr())

    return run


def no_skip_in_ci(report: pytest.TestReport | pytest.CollectReport) -> None:
    """Turn a skip into a failure where CI=true: there a test that did not run proves nothing."""
    in_ci = os.environ.get("CI", "").lower() in ("1", "true")
    if not in_ci or not report.skipped or hasattr(report, "wasxfail"):
        return
    reason = report.longrepr[-1] if isinstance(report.longrepr, tuple) else str(report.longrepr)
    hints = [hint for word, hint in INSTALL.items() if word in reason.lower()]
    how = hints[0] if hints else "pip install 'dualarm-pin[dev]'"
    report.outcome = "failed"
    report.longrepr = f"with CI=true nothing may be skipped ({reason}): {how}"


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item, call):  # type: ignore[no-untyped-def]
    report = yield
    no_skip_in_ci(report)
    return report


@pytest.hookimpl(wrapper=True)
def pytest_make_collect_report(collector):  # type: ignore[no-untyped-def]
    report = yield
    no_skip_in_ci(report)
    return report
