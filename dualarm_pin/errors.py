"""What can go wrong, each error also the built-in that a caller would expect.

A message names the place (file, line, field), what was given, what is allowed and what to do.
"Not converged" is a result with its evidence, never an exception.
"""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from pathlib import Path


class DualArmError(Exception):
    """Base of every error this package raises on purpose."""


class InputError(DualArmError, ValueError):
    """The input is wrong: the command line ends with exit code 2.

    Attributes:
        message: What is wrong, what is allowed, what to do.
        file: The file at fault, if any.
        line: Line in that file, from 1.
        field: Dotted name of the field, joint or link at fault.
    """

    def __init__(
        self,
        message: str,
        *,
        file: str | Path | None = None,
        line: int | None = None,
        field: str | None = None,
    ) -> None:
        self.message, self.file, self.line, self.field = message, file, line, field
        super().__init__(message)

    def __str__(self) -> str:
        place = "" if self.file is None else str(self.file)
        if self.line is not None:
            place += f":{self.line}"
        said = ": ".join(part for part in (place, self.field, self.message) if part)
        return said.encode("utf-8", "backslashreplace").decode()  # half a character has no bytes


class MissingFileError(InputError, FileNotFoundError):
    """A file that the input names does not exist or cannot be read."""


class UnknownNameError(InputError, KeyError):
    """A joint, link, tip, key or method that does not exist."""


class ShapeError(InputError):
    """An array has another shape than the documented one."""


class MissingExtraError(DualArmError, ImportError):
    """An optional library is needed; the message names the extra that brings it."""


class EngineError(DualArmError, RuntimeError):
    """The compiled engine does not agree with Pinocchio: an error of this program."""


class WorkerError(DualArmError, RuntimeError):
    """A process that did part of the work died."""


def nearest(name: str, known: Iterable[str], limit: int = 8) -> str:
    """Return a hint for a message: the nearest known name, or a short list of all.

    Args:
        name: What was given.
        known: What exists.
        limit: How many names to list when none is near.
    """
    names = [str(k) for k in known]
    close = difflib.get_close_matches(str(name), names, n=1, cutoff=0.6)
    if close:
        return f"did you mean {close[0]!r}?"
    if not names:
        return "there are none"
    more = f" and {len(names) - limit} more" if len(names) > limit else ""
    return "known: " + ", ".join(names[:limit]) + more
