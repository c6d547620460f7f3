"""The process that does the runs of one worker: `python -m dualarm_pin.bench.work.child FD`.

It answers every run it receives with `loaded` and then with the outcome. It can hang or die in
compiled code; its `Runner` watches it.
"""

from __future__ import annotations

import ctypes
import os
import signal
import sys
import threading
import time
from multiprocessing.connection import Connection

_PR_SET_PDEATHSIG = 1  # linux/prctl.h


def main(handle: int) -> None:
    """Serve runs until the other end of the connection is closed."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the parent
    _die_with_parent()
    _hush()
    from dualarm_pin.bench.work.one_run import perform

    with Connection(handle) as connection:
        while True:
            try:
                run, keep = connection.recv()
            except EOFError:
                return
            connection.send(perform(run, keep, lambda: connection.send("loaded")))


def _die_with_parent() -> None:
    """End this process when its parent is gone, even from inside compiled code."""
    parent = os.getppid()
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)

    def watch() -> None:
        while os.getppid() == parent:
            time.sleep(1.0)
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


def _hush() -> None:
    """Send what methods print to nowhere; stderr is a file that the runner reads."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    os.close(nowhere)


if __name__ == "__main__":
    main(int(sys.argv[1]))
