"""Calls into C++ whose true reason of failure goes only to the C-level stderr."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TypeVar

import pinocchio as pin

from dualarm_pin.errors import InputError

T = TypeVar("T")


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


def model_from_xml(xml: str, files: str | Path) -> pin.Model:
    """Build a Pinocchio model from URDF text.

    Args:
        xml: The document.
        files: What to name in a message.

    Raises:
        InputError: Pinocchio refuses it, with the reason it wrote to stderr.
    """
    with captured_stderr() as written:
        try:
            return pin.buildModelFromXML(xml)
        except (ValueError, RuntimeError) as error:
            reason = written() or str(error)
            raise InputError(f"Pinocchio refuses this robot: {reason}", file=files) from error
