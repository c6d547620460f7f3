"""What C++ libraries write to the C-level stderr: often the only true reason of a failure."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager


@contextmanager
def captured_stderr() -> Iterator[Callable[[], str]]:
    """Redirect file descriptor 2 to a file; the value gives what was written so far."""
    with tempfile.TemporaryFile() as sink:
        try:
            saved = os.dup(2)
        except OSError:  # no stderr at all, as under some services
            yield lambda: ""
            return

        def written() -> str:
            sink.seek(0)
            return sink.read().decode("utf-8", "replace").strip()

        os.dup2(sink.fileno(), 2)
        try:
            yield written
        finally:
            os.dup2(saved, 2)
            os.close(saved)
