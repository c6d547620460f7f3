"""The animation: as one file that opens from disk, and inside a notebook."""

from __future__ import annotations

import html
import json
import math
import pathlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Literal

import numpy as np

from dualarm_pin.answer.trajectory import Trajectory
from dualarm_pin.arrays import Array
from dualarm_pin.cell import Cell
from dualarm_pin.errors import InputError, UnknownNameError, nearest
from dualarm_pin.files.write import write_bytes
from dualarm_pin.path import Path
from dualarm_pin.show.page import render_page
from dualarm_pin.show.scene import Scene

if TYPE_CHECKING:
    from dualarm_pin.task import Task

LAYOUTS = ("one", "overlay", "side")
SWITCHES = "visual collision path frames direction force velocity distance ghosts hold".split()
"""What can be shown or hidden, as in web/player.js."""
_LEAST_HEIGHT = 100  # pixels; below it the controls cover the robots


def player_page(task: Task, answers: Mapping[str, Trajectory], *, title: str) -> bytes:
    """Return the page that `write_player` writes and `serve` shows.

    Raises:
        InputError: There is no answer.
        ShapeError: An answer does not fit the task.
    """
    if not answers:
        raise InputError("there is no answer to show", field="answers")
    scene = Scene()
    for label, trajectory in answers.items():
        scene.add(label, task, trajectory)
    return render_page(title, scene.pack())


def write_player(
    file: str | pathlib.Path, task: Task, answers: Mapping[str, Trajectory], *, title: str
) -> None:
    """Write one HTML file with the robots in motion; it needs no network and no server.

    Args:
        file: Where it goes.
        task: What was asked.
        answers: Its answers by label, at least one; with several the page compares them.
        title: Title of the page, any text.

    Raises:
        InputError: There is no answer, or the file cannot be written.
        ShapeError: An answer does not fit the task.
    """
    write_bytes(pathlib.Path(file), player_page(task, answers, title=title))


def posture_page(label: str, cell: Cell, q: Array, path: Path | None = None) -> bytes:
    """Return a page with a cell that stands still, beside a path if there is one.

    Args:
        label: What the posture is called.
        cell: The two arms.
        q: Joints (n,) [rad or m].
        path: What e2 should do in e1.
    """
    if path is None:  # the page needs one: this is too short to be seen
        path = Path([[0.0, 0.0, 0.1], [0.0, 0.01, 0.1]], np.eye(3), name=cell.name)
    scene = Scene()
    scene.add_motion(label, cell, path, np.tile(q, (path.h, 1)), np.zeros(path.h))
    return render_page(cell.name, scene.pack())


@dataclass(frozen=True, eq=False)
class Player:
    """The two arms along the path, as the last expression of a notebook cell.

    The whole page is inside the output (about 1 MB with the NS16 pair), so a saved notebook shows
    it without a kernel, a server or a network. It is kept in a sandbox of its own: it cannot reach
    the notebook around it.

    Attributes:
        task: What was asked.
        answers: Its answers by label, at least one; with several the page compares them.
        title: Title of the page, any text.
        height: Height in the notebook [pixel], 100 or more.
        show: Switches to turn on besides robots, path, frames and direction, of `SWITCHES`.
        at: Place on the path where it stands at first, 0 to 1.
        layout: How several answers stand: `one`, `overlay` or `side`.
    """

    task: Task
    answers: Mapping[str, Trajectory]
    title: str = "dualarm_pin"
    height: int = 480
    show: Sequence[str] = ()
    at: float = 0.0
    layout: Literal["one", "overlay", "side"] = "one"

    def __post_init__(self) -> None:
        for field, known, given in (
            ("show", SWITCHES, self.show),
            ("layout", LAYOUTS, [self.layout]),
        ):
            for name in given:
                if name not in known:
                    raise UnknownNameError(f"no {name!r}: {nearest(name, known)}", field=field)
        if not (math.isfinite(self.at) and 0.0 <= self.at <= 1.0):
            raise InputError(f"0 to 1 is expected; given {self.at}", field="at")
        if self.height < _LEAST_HEIGHT:
            raise InputError(
                f"{_LEAST_HEIGHT} or more is expected; given {self.height}", field="height"
            )

    def __repr__(self) -> str:
        size = len(self.page.encode("utf-8")) / 1e6
        return f"<{self.title}: a {size:.1f} MB page; the last line of a notebook cell shows it>"

    @cached_property
    def page(self) -> str:
        """The page by itself, as text.

        Raises:
            InputError: There is no answer.
            ShapeError: An answer does not fit the task.
        """
        page = player_page(self.task, self.answers, title=self.title).decode("utf-8")
        body, end = page.rsplit("</body>", 1)
        return f"{body}<script>\n{self._begin()}\n</script>\n</body>{end}"

    def _begin(self) -> str:
        """Return the script that brings the page to its first picture."""
        calls = [f"show({json.dumps(name)}, true)" for name in self.show]
        calls += [f"layout({json.dumps(self.layout)})"] if self.layout != "one" else []
        # Side by side the answers need the width of the panel.
        calls += ["player.panel.open = false"] if self.layout == "side" else []
        calls += [f"seek({self.at})"] if self.at else []
        return "dualarm.ready.then(() => {" + " ".join(f"dualarm.{c};" for c in calls) + "});"

    def _repr_html_(self) -> str:
        """Return the page in a frame; notebooks call this."""
        return (
            f'<iframe srcdoc="{html.escape(self.page)}" title="{html.escape(self.title)}" '
            f'sandbox="allow-scripts allow-downloads" width="100%" height="{self.height}" '
            'style="border: 1px solid rgba(128, 128, 128, .4); border-radius: 8px"></iframe>'
        )
