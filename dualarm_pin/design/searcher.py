"""A process of its own that searches, so that what follows in this one waits for nothing.

A thread would share Python's lock with what follows; a process shares the processors alone, and
gives way on them. It ends with this one, also when this one is killed: its pipe is then closed.
"""

from __future__ import annotations

import json
import multiprocessing
import os
import pickle
import signal
import subprocess
import sys
import threading
from contextlib import suppress
from multiprocessing.connection import Connection
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from dualarm_pin.answer.trajectory import Trajectory
from dualarm_pin.design.slopes import slopes_of
from dualarm_pin.planners.whole_path import plan_global

if TYPE_CHECKING:
    from dualarm_pin.task import Task

_GIVES_WAY = 10  # niceness of the searching process
_GROUP = Path("/proc/self/autogroup")  # Linux shares processors among sessions first
_PATIENCE = 5.0  # s for it to end when told to
# Not `multiprocessing`, which would run the user's script again in the process.
_PROGRAM = (
    "import json, sys; sys.path[:] = json.loads(sys.argv[2]); "
    "from dualarm_pin.design.searcher import serve; serve(int(sys.argv[1]))"
)


class Outcome(NamedTuple):
    """What a search came to.

    Attributes:
        trajectory: The answer, checked.
        slopes: Change of the objective per m and rad of base 2; None where they are not known.
    """

    trajectory: Trajectory
    slopes: dict[str, float] | None


def search(task: Task, seed: int, jobs: int) -> Outcome:
    """Search fully where things stand, in this process."""
    found = plan_global(task, effort="quick", seed=seed, jobs=jobs)
    return Outcome(found, slopes_of(task, found) if found.found else None)


class Searcher:
    """Searches one after another, in a process that is started with it.

    Args:
        seed: Seed of the searches.
        jobs: Threads of a search; all processors but one if None.
        process: Whether it has a process of its own.
    """

    def __init__(self, seed: int = 0, jobs: int | None = None, *, process: bool = True) -> None:
        # One processor is left to what follows.
        self._seed, self._jobs = seed, jobs or max(1, (os.cpu_count() or 1) - 1)
        self._one_at_a_time = threading.Lock()
        self._process: subprocess.Popen[bytes] | None = None
        self._pipe: Connection | None = None
        if process:
            self._start()

    def search(self, task: Task) -> Outcome:
        """Return what the search comes to; here, where the task cannot be sent to a process."""
        with self._one_at_a_time:
            try:
                asked = pickle.dumps((task, self._seed, self._jobs))
            except (pickle.PicklingError, AttributeError, TypeError):
                asked = b""
            if self._pipe is not None and asked:
                try:
                    self._pipe.send_bytes(asked)
                    answer: Outcome | Exception = self._pipe.recv()
                except (EOFError, OSError):  # it was ended from outside
                    self.close()
                else:
                    if isinstance(answer, Exception):
                        raise answer
                    return answer
            return search(task, self._seed, self._jobs)

    def close(self) -> None:
        """End the process."""
        process, self._process = self._process, None
        pipe, self._pipe = self._pipe, None
        if process is not None:
            process.terminate()
            try:
                process.wait(_PATIENCE)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
        if pipe is not None:
            pipe.close()

    def _start(self) -> None:
        self._pipe, other = multiprocessing.Pipe()
        self._process = subprocess.Popen(
            [sys.executable, "-c", _PROGRAM, str(other.fileno()), json.dumps(sys.path)],
            stdin=subprocess.DEVNULL,
            pass_fds=(other.fileno(),),
        )
        other.close()


def serve(number: int) -> None:
    """Answer over an open pipe until its other end is closed.

    Args:
        number: Of the file that is the pipe.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the program that was started
    os.nice(_GIVES_WAY)
    os.setsid()  # the browser is a session of its own, and what follows must not wait for a search
    with suppress(OSError):
        _GROUP.write_text(str(_GIVES_WAY))
    pipe = Connection(number)
    while True:
        try:
            asked = pipe.recv_bytes()
        except (EOFError, OSError):
            return
        answer: Outcome | Exception
        try:
            answer = search(*pickle.loads(asked))
        except Exception as error:  # the other end raises it
            answer = error
        try:
            pipe.send(answer)
        except OSError:
            return
