"""Paths from APT (cutter location files): `GOTO/x,y,z[,i,j,k]`."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path as FilePath
from typing import Unpack

import numpy as np

from dualarm_pin.arrays import Array
from dualarm_pin.errors import InputError, nearest
from dualarm_pin.path import Path
from dualarm_pin.path.files.machine_program import INCH, MILLIMETRE, Move, choose, read_text
from dualarm_pin.path.generators.curve import at_arc_length, knots_of, sample
from dualarm_pin.path.generators.follow import Hold, hold
from dualarm_pin.path.generators.piece import Piece, line_piece
from dualarm_pin.tolerance import TOLERANCE

_UNITS = {"MM": MILLIMETRE, "MILLIMETERS": MILLIMETRE, "INCH": INCH, "INCHES": INCH}
# Words that say nothing about where the tool goes.
_SILENT = """AIR AUXFUN CLEARP COOLNT CUTTER DELAY END FEDRAT FINI INSERT LETTER LOAD LOADTL MACHIN
MCHTOL MODE MULTAX OPSTOP PARTNO PPRINT PPFUN PREFUN REWIND SELCTL SEQNO SPINDL STOP TITLES TOOLNO
TOOL TLAXIS TRANS $""".split()
_KNOWN = ["GOTO", "FROM", "RAPID", "UNITS"]


def read_apt(
    file: str | FilePath,
    *,
    points: int | None = None,
    step: float | None = None,
    rapids: bool = False,
    stretch: int | None = None,
    **how: Unpack[Hold],
) -> Path:
    """Return the path of an APT program: its GOTO points, or points on the lines between them.

    i, j, k is the axis from the tool tip to its shank; where it is given, `orientation` is "normal"
    unless said, so z of e2 points the other way. It holds until another one is given.

    Args:
        file: The program, such as `part.apt`; millimetres unless it says UNITS/INCHES.
        points: Resample to so many points, such as `61`; or
        step: resample with this largest distance [m], such as `0.005`. With neither the GOTO points
            are the path.
        rapids: Moves after RAPID belong to the path.
        stretch: Which of the stretches between rapids, from 1, such as `1`; needed if there are
            several.
        **how: See `Hold`.

    Raises:
        MissingFileError: There is no such file.
        InputError: A word that may move the tool is not supported, numbers are missing or not
            finite, an axis has not unit length; names file and line.
    """
    moves, tilted = _moves(file)
    pieces = [m.piece for m in choose(moves, rapids=rapids, stretch=stretch, file=file)]
    if points is None and step is None:
        samples = at_arc_length(pieces, knots_of(pieces))
    else:
        samples = sample(pieces, points=points, step=step)
    default: Hold = {"orientation": "normal"} if tilted else {}
    return hold(samples, FilePath(file).stem, {**default, **how})


def _moves(file: str | FilePath) -> tuple[list[Move], bool]:
    """Return the moves, and whether any tool axis is given."""
    at: Array | None = None
    axis, unit = np.array([0.0, 0.0, 1.0]), MILLIMETRE
    moves: list[Move] = []
    rapid = tilted = False
    for number, word, text in _statements(read_text(file)):
        if word == "RAPID":
            rapid = True
        elif word == "UNITS":
            if text.upper() not in _UNITS:
                message = f"UNITS/{text}: {nearest(text.upper(), _UNITS)}"
                raise InputError(message, file=file, line=number)
            unit = _UNITS[text.upper()]
        elif word in ("GOTO", "FROM"):
            values = _numbers(text, file, number)
            stop, before = unit * values[:3], axis
            if len(values) == 6:
                axis, tilted = _checked_axis(values[3:], file, number), True
            if at is not None and word == "GOTO":
                if np.linalg.norm(stop - at) > TOLERANCE.coincident:
                    moves.append(Move(number, _line(at, stop, before, axis), rapid))
                elif np.ptp([before, axis], axis=0).max() > TOLERANCE.coincident:
                    spot = "the tool turns on the spot: a path from APT needs a distance between"
                    raise InputError(f"{spot} its points", file=file, line=number)
            at = stop
            # RAPID holds for one move.
            rapid = False
        elif word not in _SILENT:
            message = f"{word} is not supported: {nearest(word, _KNOWN)}; write the motion as GOTO"
            raise InputError(message, file=file, line=number)
    return moves, tilted


def _statements(text: str) -> Iterator[tuple[int, str, str]]:
    """Yield line, major word and the rest of each statement; `$` at the end of a line joins it."""
    waiting, start = "", 0
    for number, raw in enumerate(text.splitlines(), 1):
        part = raw.split("$$", 1)[0].strip()
        start = start if waiting else number
        if part.endswith("$"):
            waiting += part[:-1].strip() + " "
            continue
        statement, waiting = (waiting + part).strip(), ""
        if statement:
            word, _, rest = statement.partition("/")
            # Words without a slash may carry text: PARTNO the part.
            yield start, word.split()[0].upper() if word.split() else "/", rest.strip()


def _numbers(text: str, file: str | FilePath, line_number: int) -> Array:
    parts = re.split(r"\s*,\s*", text)
    try:
        values = np.array([float(part) for part in parts])
    except ValueError:
        values = np.empty(0)
    if len(values) not in (3, 6) or not np.isfinite(values).all():
        message = f"three or six finite numbers are expected after GOTO/; given {text[:60]!r}"
        raise InputError(message, file=file, line=line_number)
    return values


def _checked_axis(axis: Array, file: str | FilePath, line_number: int) -> Array:
    length = float(np.linalg.norm(axis))
    if abs(length - 1.0) > TOLERANCE.unit:
        message = f"the tool axis i,j,k has length {length:.6g}, and 1 is expected"
        raise InputError(message, file=file, line=line_number)
    return axis / length


def _line(start: Array, stop: Array, axis: Array, next_axis: Array) -> Piece:
    def turning(t: Array) -> Array:
        axes = axis + t[:, None] * (next_axis - axis)
        return np.asarray(axes / np.linalg.norm(axes, axis=1, keepdims=True))

    return replace(line_piece(start, stop), normal=turning)
