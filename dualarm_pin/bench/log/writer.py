"""Writer: puts what ended on disk in a thread of its own, so that no worker waits for the disk."""

from __future__ import annotations

import queue
import threading
from collections.abc import Callable, Sequence

from dualarm_pin.bench.kept_trajectories import Keeper
from dualarm_pin.bench.log.rows import RowLog
from dualarm_pin.bench.work.dispatch import Ended

_MOST_WAITING = 500  # runs; a disk that is slower than the runs slows them down


class Writer:
    """Writes trajectories, then rows; all that waits goes to the disk together.

    Use as a context manager: leaving it waits until everything is written.

    Args:
        log: Where rows go.
        keeper: Where trajectories go.
        written: Told what was written, from the thread.
    """

    def __init__(
        self, log: RowLog, keeper: Keeper, written: Callable[[Sequence[Ended]], None]
    ) -> None:
        self._log, self._keeper, self._written = log, keeper, written
        self._waiting: queue.Queue[Ended | None] = queue.Queue(_MOST_WAITING)
        self._error: Exception | None = None
        self._thread = threading.Thread(target=self._work, name="writer")

    def __enter__(self) -> Writer:
        self._thread.start()
        return self

    def __exit__(self, kind: object, *error: object) -> None:
        self._waiting.put(None)
        self._thread.join()
        if self._error is not None and kind is None:
            raise self._error

    def put(self, ended: Sequence[Ended]) -> None:
        """Hand over what ended.

        Raises:
            InputError: What was handed over before could not be written.
        """
        for item in ended:
            if self._error is not None:
                raise self._error
            self._waiting.put(item)

    def _work(self) -> None:
        more = True
        while more:
            items = [self._waiting.get()]
            while not self._waiting.empty():
                items.append(self._waiting.get())
            more = None not in items
            ended = [item for item in items if item is not None]
            if self._error is not None or not ended:
                continue  # after an error the rest is taken and dropped: nobody must wait
            try:
                self._write(ended)
            except Exception as error:
                self._error = error

    def _write(self, ended: Sequence[Ended]) -> None:
        for run, outcome in ended:
            # Before the row: a row on disk means that its trajectory was considered.
            self._keeper.consider(run, outcome)
        self._log.append([outcome.row(run) for run, outcome in ended])
        self._written(ended)
