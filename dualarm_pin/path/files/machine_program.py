"""What machine programs have in common: text, and moves of which a stretch is the path."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path as FilePath

from dualarm_pin.errors import InputError
from dualarm_pin.files.read import read_file
from dualarm_pin.path.generators.piece import Piece

INCH = 0.0254  # m
MILLIMETRE = 0.001  # m
_LARGEST = 20_000_000  # bytes: some hundred thousand points


@dataclass(frozen=True, eq=False)
class Move:
    """One move of the tool.

    Attributes:
        line: Line of the program, from 1.
        piece: Where it goes.
        rapid: It only travels (G0, RAPID).
    """

    line: int
    piece: Piece
    rapid: bool


def read_text(file: str | FilePath) -> str:
    """Return a text file; what is not UTF-8, such as an accent in a comment, is replaced.

    Raises:
        MissingFileError: There is no such file, or it cannot be read.
        InputError: It is too large.
    """
    raw = read_file(FilePath(file), _LARGEST, "check the name")
    return raw.decode("utf-8-sig", errors="replace")


def choose(
    moves: Sequence[Move], *, rapids: bool, stretch: int | None, file: str | FilePath
) -> list[Move]:
    """Return the moves that are the path.

    Args:
        moves: All moves of the program.
        rapids: Travel belongs to the path too.
        stretch: Which of the stretches between travels, from 1.
        file: For messages.

    Raises:
        InputError: There is no move, there are several stretches and none is chosen, or the chosen
            one does not exist.
    """
    stretches: list[list[Move]] = []
    apart = True
    for move in moves:
        if move.rapid and not rapids:
            apart = True
            continue
        if apart:
            stretches.append([])
        stretches[-1].append(move)
        apart = False
    if not stretches:
        raise InputError("the program has no cutting move", file=file)
    if stretch is None and len(stretches) > 1:
        starts = ", ".join(str(part[0].line) for part in stretches[:8])
        raise InputError(
            f"travel moves cut the path into {len(stretches)} stretches, which start in lines "
            f"{starts}: choose one with `stretch`, or set `rapids: true`",
            file=file,
            line=stretches[1][0].line,
        )
    if stretch is not None and not 1 <= stretch <= len(stretches):
        message = f"there are {len(stretches)} stretches; given {stretch}"
        raise InputError(message, file=file, field="stretch")
    return stretches[(stretch or 1) - 1]
