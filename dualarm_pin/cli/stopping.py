"""SIGTERM ends a command as Ctrl-C does: what was finished is kept, and nothing is left half."""

from __future__ import annotations

import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any

_SOON = 0.02  # seconds: by then the destructor or callback that swallowed it is over


@contextmanager
def stoppable() -> Iterator[list[int]]:
    """Turn SIGTERM into a KeyboardInterrupt; give the list that tells whether one came.

    An interrupt that comes inside a destructor or a callback of C code cannot be raised there, and
    Python only prints it. It is sent again, so that the command ends all the same. What an object
    that it left half-made then says of itself is not the user's.
    """
    received: list[int] = []
    came: list[int] = []

    def stop(number: int, _frame: FrameType | None) -> None:
        came.append(number)
        if number == signal.SIGTERM:
            received.append(number)
        raise KeyboardInterrupt

    def again(_number: int, _frame: FrameType | None) -> None:
        signal.raise_signal(signal.SIGTERM if received else signal.SIGINT)

    def swallowed(unraisable: Any) -> None:
        if issubclass(unraisable.exc_type, KeyboardInterrupt):
            signal.setitimer(signal.ITIMER_REAL, _SOON)
        elif not came:
            said(unraisable)

    if threading.current_thread() is not threading.main_thread():
        yield received  # only the main thread may set handlers
        return
    handlers = {signal.SIGTERM: stop, signal.SIGALRM: again}
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        handlers[signal.SIGINT] = stop
    before = {kind: signal.signal(kind, handler) for kind, handler in handlers.items()}
    said, sys.unraisablehook = sys.unraisablehook, swallowed
    try:
        yield received
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        sys.unraisablehook = said
        for kind, handler in before.items():
            signal.signal(kind, handler)
