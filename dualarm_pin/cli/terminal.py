"""Progress on a terminal: a bar with time left; plain lines where there is no terminal."""

from __future__ import annotations

import sys
from types import TracebackType

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeRemainingColumn
from rich.progress import Progress as Bars

from dualarm_pin.progress import Progress


class TerminalProgress(Progress):
    """Shows stages on stderr, so that stdout holds the answer alone. Use as a context manager."""

    def __init__(self) -> None:
        self._console = Console(stderr=True, highlight=False)
        self._live = sys.stderr.isatty()
        self._bars = Bars(
            TextColumn("{task.description}", markup=False),
            BarColumn(),
            MofNCompleteColumn(),
            TimeRemainingColumn(),
            console=self._console,
            transient=True,
        )
        self._stage = ""
        self._task = None if not self._live else self._bars.add_task("", visible=False)

    def __enter__(self) -> TerminalProgress:
        if self._live:
            self._bars.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self._live:
            self._bars.stop()

    def stage(self, text: str, total: int | None = None) -> None:
        """Begin a stage of `total` steps, or of unknown length."""
        self._stage = text
        if self._task is None:
            self.line(text)
        else:
            self._bars.reset(self._task, total=total, description=text, visible=True)

    def advance(self, steps: int = 1) -> None:
        """Count steps of the stage."""
        if self._task is not None:
            self._bars.advance(self._task, steps)

    def note(self, text: str) -> None:
        """Show beside the stage what is known so far; nothing where there is no terminal."""
        if self._task is not None:
            self._bars.update(self._task, description=f"{self._stage}, {text}")

    def line(self, text: str) -> None:
        """Say one line that stays."""
        self._console.print(text, markup=False, soft_wrap=True)
