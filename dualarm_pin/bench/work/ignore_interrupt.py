"""Loaded by local dask workers: Ctrl-C is for the parent, which ends them in order."""

from __future__ import annotations

import signal


def dask_setup(worker: object) -> None:
    """Leave Ctrl-C to the parent; called by dask in the main thread of a worker."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
