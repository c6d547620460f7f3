"""What came of an export: a program and what was found when its text was read back."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from dualarm_pin.errors import InputError
from dualarm_pin.exports.format import Chord
from dualarm_pin.files.write import reserved, write_files

REPORT = "export.json"


@dataclass(frozen=True)
class Exported:
    """A program and what was found when its text was read back.

    Attributes:
        format: Name of the format.
        texts: Text, or bytes, of each file by its name.
        sha256: Of the result that it was made of.
        points: Number of points of the program.
        samples: Number of samples of the motion.
        duration: [s].
        error: Largest distance from the relative path of the motion.
        tolerance: What is allowed.
        motion_error: Largest distance of the motion from the path of the task, as its own check
            found.
        cautions: What to know before a robot runs it.
        draft: What no source confirmed.
    """

    format: str
    texts: Mapping[str, str | bytes]
    sha256: str
    points: int
    samples: int
    duration: float
    error: Chord
    tolerance: Chord
    motion_error: Chord
    cautions: tuple[str, ...]
    draft: tuple[str, ...]

    @property
    def use(self) -> float:
        """The error as a share of the tolerance."""
        return max(self.error.mm / self.tolerance.mm, self.error.deg / self.tolerance.deg)

    @property
    def passed(self) -> bool:
        """Whether the error is within the tolerance; nothing is written otherwise."""
        return self.use <= 1.0

    @property
    def files(self) -> tuple[str, ...]:
        """Names of the files of the program."""
        return tuple(self.texts)

    def as_text(self) -> str:
        """Return what a user wants to know, in some lines."""
        lines = [
            f"{self.format}: {self.points} points of {self.samples} samples, {self.duration:.3f} s",
            f"read back: {self.error.as_text()} from the path of the motion, "
            f"allowed are {self.tolerance.as_text()}",
            f"the motion itself: {self.motion_error.as_text()} from the path of the task",
        ]
        lines += [f"CAUTION: {caution}" for caution in self.cautions]
        return "\n".join(lines + [f"DRAFT: {note}" for note in self.draft])

    def as_dict(self) -> dict[str, Any]:
        """Return what `export.json` holds."""
        return {
            "format": self.format,
            "files": list(self.files),
            "result_sha256": self.sha256,
            "points": self.points,
            "samples": self.samples,
            "duration": self.duration,
            "position_error": self.error.mm * 1e-3,
            "rotation_error": math.radians(self.error.deg),
            "position_tolerance": self.tolerance.mm * 1e-3,
            "rotation_tolerance": math.radians(self.tolerance.deg),
            "cautions": list(self.cautions),
            "draft": list(self.draft),
            "units": {"length": "m", "angle": "rad", "time": "s"},
        }

    def write(self, folder: Path) -> None:
        """Write the files and `export.json` into a folder: all of them or none.

        Raises:
            InputError: The folder holds something else, or cannot be written, or a file of a
                format of the user's own has no plain name.
        """
        for name in self.texts:
            if name != Path(name).name or name == REPORT:
                raise InputError(f"a plain name of a file is expected; given {name!r}", field="to")
        if folder.exists() and not folder.is_dir():
            raise InputError("a folder is expected; this is a file", file=folder)
        others = sorted(f.name for f in folder.glob("*") if f.name not in (*self.texts, REPORT))
        if others:
            message = f"there is something else here ({others[0]}): give an empty folder as --out"
            raise InputError(message, file=folder)
        report = json.dumps(self.as_dict(), indent=1) + "\n"
        contents = {**self.texts, REPORT: report}
        files = {n: c.encode() if isinstance(c, str) else c for n, c in contents.items()}
        with reserved(folder):
            write_files(folder, files)
