"""The animation as one file that opens from disk."""

from __future__ import annotations

import pathlib
from collections.abc import Sequence

from dualarm_pin.cell import Cell
from dualarm_pin.files.write import write_bytes
from dualarm_pin.path import Path
from dualarm_pin.show.page import render_page
from dualarm_pin.show.scene import Run, build_scene


def player_page(cell: Cell, path: Path, runs: Sequence[Run], *, title: str) -> bytes:
    """Return the page that `write_player` writes and `serve` shows.

    Raises:
        InputError: There is no run, or one is not finite.
        ShapeError: A run does not fit the cell or the path.
    """
    return render_page(title, build_scene(cell, path, runs).pack())


def write_player(
    file: pathlib.Path, cell: Cell, path: Path, runs: Sequence[Run], *, title: str
) -> None:
    """Write one HTML file with the robots in motion; it needs no network and no server.

    Args:
        file: Where it goes.
        cell: The two arms.
        path: What e2 does in e1.
        runs: The motions, at least one; with several the page compares them.
        title: Title of the page, any text.

    Raises:
        InputError: There is no run, one is not finite, or the file cannot be written.
        ShapeError: A run does not fit the cell or the path.
    """
    write_bytes(pathlib.Path(file), player_page(cell, path, runs, title=title))
