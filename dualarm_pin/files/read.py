"""Find and read a file that somebody named: a plain one, of a size that is meant seriously."""

from __future__ import annotations

import stat
from pathlib import Path

from dualarm_pin.errors import InputError, MissingFileError


def is_file(path: Path) -> bool:
    """Return whether there is such a plain file; a name that no file system takes is none."""
    try:
        return path.is_file()
    except (OSError, ValueError):
        return False


def is_folder(path: Path) -> bool:
    """Return whether there is such a folder; a name that no file system takes is none."""
    try:
        return path.is_dir()
    except (OSError, ValueError):
        return False


def read_file(path: Path, largest: int, hint: str) -> bytes:
    """Return what a file holds.

    Args:
        path: The file.
        largest: Bytes that are allowed.
        hint: What to do if it cannot be read.

    Raises:
        MissingFileError: There is none, it is a folder, a pipe or a device, or cannot be read.
        InputError: It is too large.
    """
    try:
        state = path.stat()
        if not stat.S_ISREG(state.st_mode):  # a pipe would block, a device never end
            what = "is a directory" if stat.S_ISDIR(state.st_mode) else "is no plain file"
            raise MissingFileError(f"{what}: {hint}", file=path)
        size, raw = state.st_size, b""
        if size <= largest:
            with path.open("rb") as file:
                raw = file.read(largest + 1)
            size = max(size, len(raw))
    except FileNotFoundError as error:
        if isinstance(error, MissingFileError):
            raise
        raise MissingFileError(f"no such file: {hint}", file=path) from error
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise MissingFileError(f"cannot be read ({reason}): {hint}", file=path) from error
    if size > largest:
        raise InputError(f"{size} bytes is too large: {largest} are allowed", file=path)
    return raw
