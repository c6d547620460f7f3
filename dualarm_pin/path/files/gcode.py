"""Paths from G-code: straight lines and arcs in three axes (RS-274).

A reader of our own: the parsers on PyPI only cut lines into words, skip what they do not know, and
have no modal moves (gcodeparser) or no line numbers (pygcode); here an unknown word is an error.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field
from pathlib import Path as FilePath
from typing import Unpack

import numpy as np

from dualarm_pin.arrays import Array, finite
from dualarm_pin.errors import InputError
from dualarm_pin.path import Path
from dualarm_pin.path.files.machine_program import INCH, MILLIMETRE, Move, choose, read_text
from dualarm_pin.path.generators.arguments import Point3
from dualarm_pin.path.generators.follow import Follow, follow
from dualarm_pin.path.generators.piece import Piece, arc_piece, line_piece
from dualarm_pin.tolerance import TOLERANCE

_WORD = re.compile(r"\s*([A-Za-z])\s*([+-]?(?:\d+\.?\d*|\.\d+))")
_COMMENT = re.compile(r"\([^()]*\)|;.*")

_MOTION = {"G0", "G1", "G2", "G3"}
_PLANES = {"G17": (0, 1, 2), "G18": (2, 0, 1), "G19": (1, 2, 0)}
_UNITS = {"G20": INCH, "G21": MILLIMETRE}
_OFFSETS = {f"G{n}" for n in range(54, 60)}
# Dwell, cutter and length compensation off, length offset (the programmed point is the tip),
# cycle off, exact stop, path control, feed and speed modes, arc centres relative, R point.
_NO_MOTION = {"G4", "G40", "G43", "G49", "G61", "G61.1", "G64", "G80", "G91.1"} | {
    f"G{n}" for n in range(93, 100)
}
_SILENT = set("FSTNMHDPQEO")
_CALLS = {96.0, 97.0, 98.0, 99.0}
_EXPONENT = re.compile(r"\d[eE][+-]?\d")
_ARC_RADIUS = 5e-5  # start and end radius may differ by the last digit written [m]
_ARC_SHARE = 1e-3  # ... and by this share of the radius, as controllers allow


def read_gcode(
    file: str | FilePath,
    *,
    work_offset: Point3 = (0.0, 0.0, 0.0),
    rapids: bool = False,
    stretch: int | None = None,
    **how: Unpack[Follow],
) -> Path:
    """Return the path of a G-code program.

    G1, G2 and G3 are the path; G0 only with `rapids`. Known: G17 to G19, G20 and G21 (millimetres
    unless said), G90 and G91, arcs by I, J, K from the start or by R, helical arcs, one of G54 to
    G59; feed, speed, tool and M words say nothing about the path (M2 and M30 end it). Everything
    else that moves the tool is refused. An axis that was never given stands at 0.

    Args:
        file: The program, such as `part.nc`.
        work_offset: Origin of the program's coordinates in e1 (or in `frame`), shape (3,) [m].
        rapids: G0 belongs to the path.
        stretch: Which of the stretches between rapids, from 1, such as `1`; needed if there are
            several.
        **how: See `Follow`.

    Raises:
        MissingFileError: There is no such file.
        InputError: A word is unknown or unsupported, an arc is impossible, there is no cutting
            move, or there are several stretches; names file and line.
    """
    machine = _Machine(file, finite(work_offset, "work_offset", (3,)))
    for number, text in enumerate(read_text(file).splitlines(), 1):
        if machine.ended:
            break
        machine.block(number, text)
    moves = choose(machine.moves, rapids=rapids, stretch=stretch, file=file)
    return follow([move.piece for move in moves], FilePath(file).stem, how)


@dataclass
class _Machine:
    """The modal state of a control while it reads a program."""

    file: str | FilePath
    offset: Array
    at: Array = field(default_factory=lambda: np.zeros(3))
    motion: str = ""
    plane: tuple[int, int, int] = _PLANES["G17"]
    unit: float = MILLIMETRE
    relative: bool = False
    system: str = ""
    ended: bool = False
    moves: list[Move] = field(default_factory=list)

    def block(self, number: int, text: str) -> None:
        """Take in one line."""
        self.number = number
        values: dict[str, float] = {}
        words = self._words(text)
        codes = [f"G{value:g}" for letter, value in words if letter == "G"]
        if len(_MOTION & set(codes)) > 1:
            raise self._error(f"two motions in one block: {' '.join(codes)}")
        for letter, value in words:
            if letter == "G":
                self._mode(f"G{value:g}")
            elif letter == "M":
                if value in _CALLS:
                    raise self._error(f"M{value:g} is not supported: write subprograms out")
                self.ended |= value in (2.0, 30.0)
            elif letter in "XYZIJKR":
                if letter in values:
                    raise self._error(f"{letter} is given twice in one block")
                values[letter] = value * self.unit
            elif letter == "P" and self.motion in ("G2", "G3") and value != 1.0:
                raise self._error("an arc of several turns (P) is not supported: repeat the block")
            elif letter in "ABCUVW":
                raise self._error(
                    f"the axis {letter} is not supported: G-code is read in three axes; give the "
                    "orientation in a CSV or APT file"
                )
            elif letter not in _SILENT:
                raise self._error(f"the word {letter}{value:g} is unknown")
        # On some controls the X of a dwell is its time.
        if values and "G4" not in codes:
            self._move(values)

    def _words(self, text: str) -> list[tuple[str, float]]:
        rest = _COMMENT.sub(" ", text).strip().removeprefix("/")
        words: list[tuple[str, float]] = []
        if rest == "%":
            return words
        if _EXPONENT.search(rest):
            raise self._error("a number such as 1e-5 is not G-code; put a space before a word E")
        while rest:
            match = _WORD.match(rest)
            if match is None:
                message = f"cannot read {rest[:20]!r}: words such as X1.5 are expected; variables"
                raise self._error(message + " and expressions are not supported")
            if len(match[2]) > 30:
                raise self._error(f"{match[2][:20]}... is too long for a number")
            words.append((match[1].upper(), float(match[2])))
            rest = rest[match.end() :].strip()
        # The units of a block hold for all of it, wherever they stand.
        return sorted(words, key=lambda word: word[0] != "G")

    def _mode(self, code: str) -> None:
        if code in _MOTION:
            self.motion = code
        elif code in _PLANES:
            self.plane = _PLANES[code]
        elif code in _UNITS:
            self.unit = _UNITS[code]
        elif code in ("G90", "G91"):
            self.relative = code == "G91"
        elif code in _OFFSETS:
            if self.system not in ("", code):
                message = f"{code} after {self.system}: only one work offset is supported"
                raise self._error(message)
            self.system = code
        elif code not in _NO_MOTION:
            known = "G0 to G4, G17 to G21, G40, G43, G49, G54 to G59, G61, G64, G80, G90 to G99"
            raise self._error(f"{code} is not supported; known: {known}")

    def _move(self, values: dict[str, float]) -> None:
        if not self.motion:
            raise self._error("a position without a motion: G0, G1, G2 or G3 must come first")
        stop = self.at.copy()
        for axis, letter in enumerate("XYZ"):
            if letter in values:
                stop[axis] = values[letter] + (self.at[axis] if self.relative else 0.0)
        if self.motion in ("G2", "G3"):
            piece = self._arc(stop, values)
        elif values.keys() & set("IJKR"):
            raise self._error(f"I, J, K and R belong to an arc, not to {self.motion}")
        elif np.linalg.norm(stop - self.at) <= TOLERANCE.coincident:
            return
        else:
            piece = line_piece(self.at + self.offset, stop + self.offset)
        self.moves.append(Move(self.number, piece, rapid=self.motion == "G0"))
        self.at = stop

    def _arc(self, stop: Array, values: dict[str, float]) -> Piece:
        """Return the arc from here to `stop` in the plane of its first two axes."""
        first, second, third = self.plane
        sign = 1.0 if self.motion == "G3" else -1.0
        way = stop - self.at
        rise = np.zeros(3)
        rise[third] = way[third]
        center = self.at + self._to_center(way - rise, values, sign)
        x = self.at - center
        end = stop - rise - center
        if abs(np.linalg.norm(x) - np.linalg.norm(end)) > _ARC_RADIUS + _ARC_SHARE * np.linalg.norm(
            x
        ):
            raise self._error(
                f"the arc starts {np.linalg.norm(x):.5g} m from its centre and ends "
                f"{np.linalg.norm(end):.5g} m from it: check I, J, K"
            )
        turn = math.atan2(end[second], end[first]) - math.atan2(x[second], x[first])
        # An arc that ends where it starts is a whole circle.
        turn = (sign * turn - 1e-9) % (2 * math.pi) + 1e-9
        y = np.zeros(3)
        y[first], y[second] = -sign * x[second], sign * x[first]
        return arc_piece(center + self.offset, x, y, turn, rise=rise)

    def _to_center(self, way: Array, values: dict[str, float], sign: float) -> Array:
        """Return the vector from the start to the centre, in the plane of the arc."""
        first, second, third = self.plane
        letters = "IJK"
        if "R" not in values:
            if letters[third] in values or not values.keys() & {letters[first], letters[second]}:
                wanted = f"{letters[first]} and {letters[second]}"
                raise self._error(f"an arc in this plane needs {wanted}, or R")
            middle = np.zeros(3)
            middle[first] = values.get(letters[first], 0.0)
            middle[second] = values.get(letters[second], 0.0)
            if np.linalg.norm(middle) <= TOLERANCE.coincident:
                raise self._error("the arc has no radius")
            return middle
        if values.keys() & set(letters):
            raise self._error("an arc takes its centre or R, not both")
        radius, chord = values["R"], float(np.linalg.norm(way))
        if chord <= TOLERANCE.coincident:
            raise self._error("a whole circle needs its centre: R cannot say where it is")
        if abs(radius) < 0.5 * chord - _ARC_RADIUS:
            message = f"a radius of {abs(radius):.5g} m cannot span {chord:.5g} m"
            raise self._error(message)
        height = math.sqrt(max(radius**2 - 0.25 * chord**2, 0.0))
        left = np.zeros(3)
        left[first], left[second] = -way[second] / chord, way[first] / chord
        # A negative R takes the arc of more than half a turn.
        return np.asarray(0.5 * way + sign * math.copysign(height, radius) * left)

    def _error(self, message: str) -> InputError:
        return InputError(message, file=self.file, line=self.number)
