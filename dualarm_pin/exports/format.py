"""What a format is: a writer, the reader of what it wrote, and what both promise."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Literal, NamedTuple

from dualarm_pin.exports.program import Points, Program

Files = Mapping[str, str]
"""Text of each file of a program by its plain name."""


class Chord(NamedTuple):
    """How far a program may leave the relative path, or how far it does."""

    mm: float
    deg: float

    def as_text(self) -> str:
        """Return both for a sentence."""
        return f"{self.mm:.3g} mm and {self.deg:.3g} deg"


USUAL = Chord(0.05, 0.01)


@dataclass(frozen=True)
class Axes:
    """What the controller of one arm takes.

    Attributes:
        count: Number of its axes, all of them revolute.
        unit: Of the numbers in the file.
        coupling: What it adds to axis i, counted from 0: (i, j, factor) for factor * axis j; a
            cell file may say otherwise.
    """

    count: int
    unit: Literal["deg", "rad"]
    coupling: tuple[tuple[int, int, float], ...] = ()


@dataclass(frozen=True)
class Format:
    """A target of `export`. One of your own is one of these.

    Attributes:
        name: What it is called.
        write: Returns the files of a program.
        read: Returns the points that stand in such files; raises ValueError where it cannot.
        between: What the controller does between points: straight in the joints, or a polynomial
            of degree 5 through position, velocity and acceleration.
        tolerance: How far it may leave the relative path unless the user says otherwise.
        axes: What the controller of one arm takes; None for any joints in rad and m, those of the
            URDF.
        period: Points at equal times [s]; by default as few as the tolerance allows.
        every_sample: Keep every sample of the motion.
        longest_move: Largest time between two points [s].
        draft: What no source confirmed; it stands in the files too.
    """

    name: str
    write: Callable[[Program], Files]
    read: Callable[[Files], Points]
    between: Literal["linear", "quintic"] = "linear"
    tolerance: Chord = USUAL
    axes: Axes | None = None
    period: float | None = None
    every_sample: bool = False
    longest_move: float = 30.0
    draft: tuple[str, ...] = ()
