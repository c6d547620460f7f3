"""The animation inside a notebook: there while the kernel runs, and in a saved copy without one."""

from __future__ import annotations

import html
import json
import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

from dualarm_pin.cell import Cell
from dualarm_pin.errors import InputError, UnknownNameError, nearest
from dualarm_pin.path import Path
from dualarm_pin.show.player import player_page
from dualarm_pin.show.scene import Run

LAYOUTS = ("one", "overlay", "side")
SWITCHES = "visual collision path frames direction force velocity ghosts hold".split()
"""What can be shown or hidden, as in web/player.js."""
_LEAST_HEIGHT = 100


@dataclass(frozen=True, eq=False)
class Player:
    """The two arms along the path, as the last expression of a notebook cell.

    The whole page is inside the output (about 1 MB with the NS16 pair), so a saved notebook shows
    it without a kernel, a server or a network. It is kept in a sandbox of its own: it cannot reach
    the notebook around it.

    Attributes:
        cell: The two arms.
        path: What e2 does in e1.
        runs: The motions, at least one; with several the page compares them.
        title: Title of the page, any text.
        height: Height in the notebook [pixel], 100 or more.
        show: Switches to turn on besides robots, path, frames and direction, of `SWITCHES`.
        at: Place on the path where it stands at first, 0 to 1.
        layout: How several runs stand: `one`, `overlay` or `side`.
    """

    cell: Cell
    path: Path
    runs: Sequence[Run]
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
            InputError: There is no run, or one is not finite.
            ShapeError: A run does not fit the cell or the path.
        """
        page = player_page(self.cell, self.path, self.runs, title=self.title).decode("utf-8")
        body, end = page.rsplit("</body>", 1)
        return f"{body}<script>\n{self._begin()}\n</script>\n</body>{end}"

    def _begin(self) -> str:
        """Return the script that brings the page to its first picture."""
        calls = [f"show({json.dumps(name)}, true)" for name in self.show]
        calls += [f"layout({json.dumps(self.layout)})"] if self.layout != "one" else []
        # Side by side the runs need the width of the panel.
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
