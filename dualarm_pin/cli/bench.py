"""`dualarm-pin bench`."""

from __future__ import annotations

import shlex
import sys
import time
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from dualarm_pin.cli import DONE, INTERRUPTED
from dualarm_pin.cli.terminal import TerminalProgress

GATE_FAILED = 1  # exit code
_BETWEEN_LINES = 10.0  # seconds


def bench(
    suite: Path,
    *,
    out: Path | None = None,
    jobs: int | None = None,
    cluster: str | None = None,
    resume: bool = False,
    allow_code: Annotated[bool, Parameter(negative=())] = False,
) -> int:
    """Run a suite of tasks, methods and seeds, and write one table and one report.

    Exit code 0: there is a row for every run, failed ones included; 1: a gate of the suite does
    not hold; 2: the suite is wrong.

    Args:
        suite: A suite file (YAML).
        out: Folder of the table; results/SUITE by default.
        jobs: Worker processes on this machine; all processors by default.
        cluster: Address of a dask scheduler that exists, instead of workers on this machine.
        resume: Continue the folder: runs that have a row are not repeated.
        allow_code: Import and run the functions that the suite and its tasks name with `call`.
    """
    from dualarm_pin.bench.batch import run_suite
    from dualarm_pin.bench.report.page import write_report
    from dualarm_pin.bench.suite import Suite
    from dualarm_pin.errors import InputError
    from dualarm_pin.files.numbers import check_counts

    check_counts(jobs=jobs)
    if jobs is not None and cluster is not None:
        raise InputError("belongs to local workers, not to --cluster", field="--jobs")
    asked = Suite.load(suite, allow_code=allow_code)
    folder = out or Path("results") / suite.stem
    with BatchProgress() as progress:
        try:
            batch = run_suite(
                asked, folder, jobs=jobs, address=cluster, resume=resume, progress=progress
            )
        except KeyboardInterrupt:
            progress.line(f"stopped: what ended is in {folder}, continue with --resume")
            return INTERRUPTED
        progress.stage("writing the report")
        write_report(asked, batch, command(suite, folder, jobs, cluster, allow_code))
    counts = ", ".join(f"{count} {status}" for status, count in batch.counts.most_common())
    print(f"{len(batch.rows)} runs: {counts}")
    for gate, failure in batch.gates:
        about = f" ({gate.spec.of} of {gate.spec.method} on {gate.spec.task})"
        print(f"gate {'FAILED' if failure else 'holds'}: {gate.text}{about}")
        if failure is not None:
            print(f"dualarm-pin: gate {gate.text!r}: {failure}", file=sys.stderr)
    print(f"written to {folder}: results.csv, results.parquet, report.html")
    return DONE if batch.passed else GATE_FAILED


def command(
    suite: Path, folder: Path, jobs: int | None, cluster: str | None, allow_code: bool
) -> str:
    """Return the exact command that makes a batch again; into a new folder, or with --resume."""
    words = ["dualarm-pin", "bench", str(suite), "--out", str(folder)]
    words += ["--jobs", str(jobs)] if jobs is not None else []
    words += ["--cluster", cluster] if cluster is not None else []
    words += ["--allow-code"] if allow_code else []
    return shlex.join(words)


class BatchProgress(TerminalProgress):
    """Plain lines with the time left where there is no terminal; a bar where there is one."""

    def __init__(self) -> None:
        super().__init__()
        self._total: int | None = None
        self._done = 0
        self._begun = self._said = time.monotonic()

    def stage(self, text: str, total: int | None = None) -> None:
        """Begin a stage of `total` steps, or of unknown length."""
        super().stage(text if total is None else f"{total} {text}", total)
        self._total, self._done = total, 0
        self._begun = self._said = time.monotonic()

    def advance(self, steps: int = 1) -> None:
        """Count steps of the stage."""
        super().advance(steps)
        self._done += steps
        now = time.monotonic()
        if self._live or not self._total or now - self._said < _BETWEEN_LINES:
            return
        self._said = now
        left = (now - self._begun) / self._done * (self._total - self._done)
        self.line(f"{self._done} of {self._total}, about {duration(left)} left")


def duration(seconds: float) -> str:
    """Return a time in words."""
    if seconds < 90.0:
        return f"{seconds:.0f} s"
    return f"{seconds / 60.0:.0f} min" if seconds < 5400.0 else f"{seconds / 3600.0:.1f} h"
