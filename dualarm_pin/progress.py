"""How long work tells where it stands: nothing by default, a bar on the command line."""

from __future__ import annotations


class Progress:
    """Told by planners what they do; this one is silent."""

    def stage(self, text: str, total: int | None = None) -> None:
        """Begin a stage of `total` steps, or of unknown length."""

    def advance(self, steps: int = 1) -> None:
        """Count steps of the stage."""

    def note(self, text: str) -> None:
        """Show beside the stage what is known so far."""

    def line(self, text: str) -> None:
        """Say one line that stays."""


SILENT = Progress()
