"""Runner: a child process that does runs, watched from a worker.

The child lives on from run to run, so a run costs no process; it is killed when a run exceeds its
time limit, even inside compiled code, and replaced when it died.
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import tempfile
import threading
from multiprocessing.connection import Connection, Pipe
from typing import IO, Any

from dualarm_pin.bench.run import BenchRun, RunOutcome

LOADING = 300.0  # seconds to load a task and to compile, beside the time limit of the run
DEATHS = 2  # a run that kills its process so often is set aside
_ONE_THREAD = (
    "OMP_NUM_THREADS",
    "OPENBLAS_NUM_THREADS",
    "MKL_NUM_THREADS",
    "NUMBA_NUM_THREADS",
    "VECLIB_MAXIMUM_THREADS",
)
_threads = threading.local()


def dask_setup(worker: object) -> None:
    """Leave Ctrl-C to the parent, which ends workers in order; called by dask in a local one."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)


def run_watched(run: BenchRun, keep: bool) -> RunOutcome:
    """Do a run in the child process of this thread; what a `dask` worker calls."""
    if not hasattr(_threads, "runner"):
        _threads.runner = Runner()
    runner: Runner = _threads.runner
    return runner.run(run, keep)


class Runner:
    """Owner of one child process, which is started when it is first needed."""

    def __init__(self) -> None:
        self._child: subprocess.Popen[bytes] | None = None
        self._connection: Connection[Any, Any] | None = None
        self._errors: IO[bytes] = tempfile.TemporaryFile()  # noqa: SIM115 - lives as long as this

    def run(self, run: BenchRun, keep: bool) -> RunOutcome:
        """Do a run; one that dies gets a second chance in a new process."""
        reason = ""
        for _ in range(DEATHS):
            try:
                return self._once(run, keep)
            except (EOFError, OSError):  # the child is gone
                reason = self._autopsy()
        return RunOutcome("crashed", f"its process died {DEATHS} times; the last time: {reason}")

    def close(self) -> None:
        """End the child."""
        if self._child is not None:
            self._child.kill()
            self._child.wait()
            self._child = None
        if self._connection is not None:
            self._connection.close()
            self._connection = None

    def __del__(self) -> None:
        self.close()

    def _once(self, run: BenchRun, keep: bool) -> RunOutcome:
        connection = self._connection = self._connection or self._start()
        connection.send((run, keep))
        for stage, seconds in (("loading the task", LOADING), ("the run", run.time_limit)):
            if not connection.poll(seconds):
                self.close()
                return RunOutcome("timed_out", f"{stage} took longer than {seconds:g} s")
            answer = connection.recv()
            if isinstance(answer, RunOutcome):
                return answer
        raise EOFError  # a child that answers out of turn is as good as dead

    def _start(self) -> Connection[Any, Any]:
        here, there = Pipe()
        self._errors.seek(0)
        self._errors.truncate()
        self._child = subprocess.Popen(
            [sys.executable, "-m", "dualarm_pin.bench.work.child", str(there.fileno())],
            env=os.environ | dict.fromkeys(_ONE_THREAD, "1"),
            pass_fds=[there.fileno()],
            stdin=subprocess.DEVNULL,
            stderr=self._errors,
        )
        there.close()
        return here

    def _autopsy(self) -> str:
        """Return why the child died."""
        child = self._child
        if child is None:
            return "it could not be started"
        try:
            code = child.wait(timeout=5.0)
        except subprocess.TimeoutExpired:
            code = None
        self.close()
        self._errors.seek(0)
        lines = self._errors.read()[-2000:].decode(errors="replace").strip().splitlines()
        said = f" ({lines[-1].strip()})" if lines else ""
        if code is None:
            return f"it stopped answering{said}"
        return (signal.Signals(-code).name if code < 0 else f"exit code {code}") + said
