"""The animation inside a notebook: there while the kernel runs, and in a saved copy without one."""

from __future__ import annotations

import html
import json
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from dualarm_pin.cell import Cell
from dualarm_pin.errors import InputError, UnknownNameError, nearest
from dualarm_pin.path import Path
from dualarm_pin.viewer.player import player_page
from dualarm_pin.viewer.scene import Run

LAYOUTS = ("one", "overlay", "side")
SWITCHES = ("visual", "collision", "path", "frames", "direction", "force", "velocity", "ghosts",
            "hold")  # fmt: skip
"""What can be shown or hidden, as in web/player.js."""
_LEAST_HEIGHT = 100


@dataclass(frozen=True, eq=False)
class Shown:
    """A page that a notebook shows; make it with `show`.

    Attributes:
        page: The whole page.
        title: Its title.
        height: Its height in the notebook [pixel].
    """

    page: str
    title: str
    height: int

    def __repr__(self) -> str:
        size = len(self.page.encode("utf-8")) / 1e6
        return f"<{self.title}: a {size:.1f} MB page; the last line of a notebook cell shows it>"

    def _repr_html_(self) -> str:
        """Return the page in a frame of its own; it cannot reach the notebook around it."""
        return (
            f'<iframe srcdoc="{html.escape(self.page)}" title="{html.escape(self.title)}" '
            f'sandbox="allow-scripts allow-downloads" width="100%" height="{self.height}" '
            'style="border: 0; border-radius: 8px"></iframe>'
        )


def show(
    cell: Cell,
    path: Path,
    runs: Sequence[Run],
    *,
    title: str = "dualarm_pin",
    height: int = 480,
    switches: Sequence[str] = (),
    at: float = 0.0,
    layout: Literal["one", "overlay", "side"] = "one",
) -> Shown:
    """Show the two arms along the path, as the last expression of a notebook cell.

    The page is inside the output, about 1 MB with the NS16 pair: a saved notebook shows it without
    a kernel, a server or a network.

    Args:
        cell: The two arms.
        path: What e2 does in e1.
        runs: The motions, at least one; with several the page compares them.
        title: Title of the page, any text.
        height: Height in the notebook [pixel], 100 or more.
        switches: What of `SWITCHES` to turn on besides robots, path, frames and direction.
        at: Place on the path where it stands at first, from 0 to 1.
        layout: How several runs stand: `one`, `overlay` or `side`.

    Raises:
        UnknownNameError: There is no such switch or layout.
        InputError: `at` or `height` is out of range, there is no run, or one is not finite.
        ShapeError: A run does not fit the cell or the path.
    """
    for field, known, given in (("switches", SWITCHES, switches), ("layout", LAYOUTS, (layout,))):
        for name in given:
            if name not in known:
                hint = f"{nearest(name, known)} (allowed: {', '.join(known)})"
                raise UnknownNameError(f"there is no {name!r}: {hint}", field=field)
    if not 0.0 <= at <= 1.0:
        raise InputError(f"0 to 1 is expected; given {at}", field="at")
    if height < _LEAST_HEIGHT:
        raise InputError(f"{_LEAST_HEIGHT} or more is expected; given {height}", field="height")
    calls = [f"show({json.dumps(name)}, true)" for name in switches]
    calls += [f"layout({json.dumps(layout)})"] if layout != "one" else []
    calls += [f"seek({float(at)})"]
    begin = " ".join(f"dualarm.{call};" for call in calls)
    page = player_page(cell, path, runs, title=title).decode("utf-8")
    body, end = page.rsplit("</body>", 1)
    script = f"<script>\ndualarm.ready.then(() => {{ {begin} }});\n</script>\n"
    return Shown(f"{body}{script}</body>{end}", title, height)
