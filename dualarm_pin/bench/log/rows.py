"""The log of a batch: one JSON object a line, on disk as each run ends.

A line is written with one call and synchronised before the next; whatever kills the process, at
most the last line is cut, and it is removed when the log is opened again.
"""

from __future__ import annotations

import fcntl
import json
import os
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

from dualarm_pin.bench.columns import Row
from dualarm_pin.errors import InputError


class RowLog:
    """Rows by key, appended for good. Use as a context manager.

    Args:
        path: The file; it is made if there is none.

    Raises:
        InputError: The file cannot be written, another batch is writing it, or it is not a log.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._places: dict[str, tuple[int, int, int]] = {}  # start, length, number of the line
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            self._file = os.open(path, os.O_RDWR | os.O_CREAT | os.O_APPEND, 0o644)
        except OSError as error:
            raise InputError(f"cannot write here: {error.strerror}", file=path) from error
        try:
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            os.close(self._file)
            raise InputError(
                "another batch is writing into this folder: wait for it or give another --out",
                file=path,
            ) from error
        self._end = self._repair()
        _sync_folder(path.parent)

    def __enter__(self) -> RowLog:
        return self

    def __exit__(self, *error: object) -> None:
        os.close(self._file)

    def __contains__(self, key: str) -> bool:
        return key in self._places

    def __len__(self) -> int:
        return len(self._places)

    def append(self, rows: Sequence[Row]) -> None:
        """Write rows and wait until they are on the disk; a key that is there already is left."""
        lines = []
        for row in rows:
            line = json.dumps(row, separators=(",", ":"), allow_nan=False).encode() + b"\n"
            if row["key"] not in self._places:
                self._places[row["key"]] = (self._end, len(line), len(self._places) + 1)
                self._end += len(line)
                lines.append(line)
        data = b"".join(lines)
        while data:
            data = data[os.write(self._file, data) :]
        os.fsync(self._file)

    def rows(self, keys: Iterable[str]) -> Iterator[Row]:
        """Read the rows of some keys, in their order, one at a time."""
        for key in keys:
            start, length, _ = self._places[key]
            row: Row = json.loads(os.pread(self._file, length, start))
            yield row

    def refusal(self, key: str, field: str) -> InputError:
        """Return what to raise for a row that does not hold in a field what a run leaves there."""
        return self._not_a_row(self._places[key][2], field)

    def _repair(self) -> int:
        """Note where the rows stand, cut a last line that is not whole; return the end."""
        end = 0
        with self.path.open("rb") as file:
            for number, line in enumerate(file, 1):
                try:
                    if not line.endswith(b"\n"):
                        raise ValueError("cut line")
                    key = json.loads(line)["key"]
                except (ValueError, KeyError, TypeError) as error:
                    if file.read(1):
                        raise self._not_a_row(number) from error
                    break
                self._places.setdefault(str(key), (end, len(line), number))
                end += len(line)
        os.ftruncate(self._file, end)
        return end

    def _not_a_row(self, number: int, field: str | None = None) -> InputError:
        message = "not a row of a batch: give another --out, or remove this line"
        return InputError(message, file=self.path, line=number, field=field)


def _sync_folder(folder: Path) -> None:
    """Make a new file survive a loss of power."""
    handle = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
