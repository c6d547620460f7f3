"""The pages of `dualarm-pin design`: each has a session of its own and knows of no other.

Only the newest few are kept: an older page is told to open again.
"""

from __future__ import annotations

import json
import threading
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from dualarm_pin.design.desk import Desk
from dualarm_pin.design.messages import Asked, Look, Move, asked
from dualarm_pin.design.picture import Pictures, index_along
from dualarm_pin.design.searcher import Searcher
from dualarm_pin.errors import InputError
from dualarm_pin.placement.asked import standing
from dualarm_pin.placement.parameters import BASE
from dualarm_pin.show.handler import TOKEN, Talk
from dualarm_pin.show.page import render_page
from dualarm_pin.show.scene import Scene

if TYPE_CHECKING:
    from dualarm_pin.task import Task

_PAGES = 8  # kept at once
_SCRIPTS = ("gizmo.js", "drawing.js", "design.js", "design_panel.js")


class Pages:
    """All pages of one server; a context manager, which ends the process that searches for them.

    Args:
        task: The task; its cell is where every page starts.
        folder: Where `save` writes.
        seed: Seed of the searches.
        jobs: Threads of a search.

    Attributes:
        talk: What answers the pages: give it, and `open` as the page, to `show.serve`.

    Raises:
        InputError: No start reaches the whole path where the cell stands.
    """

    def __init__(self, task: Task, folder: Path, *, seed: int = 0, jobs: int | None = None) -> None:
        self._task, self._folder, self._seed, self._jobs = task, folder, seed, jobs
        self._searcher = Searcher(seed, jobs)
        self._pages: dict[int, Pictures] = {}
        self._opened, self._lock = 0, threading.Lock()
        try:
            self._next: Desk | None = self._desk()  # which also says what is wrong before serving
        except BaseException:
            self._searcher.close()
            raise
        self.talk = Talk({"/move": self._move, "/look": self._look, "/save": self._save})

    def __enter__(self) -> Pages:
        return self

    def __exit__(self, *_: object) -> None:
        self._searcher.close()

    def open(self) -> bytes:
        """Begin a session and return its page."""
        with self._lock:
            desk, self._next = self._next or self._desk(), None
            number, self._opened = self._opened, self._opened + 1
            self._pages[number] = Pictures(desk)
            self._pages.pop(number - _PAGES, None)
        task, q = self._task, desk.answer.q
        scene = Scene()
        scene.add_motion("motion", task.cell, task.path, q, index_along(task, q))
        scene.head["design"] = {"page": number, "token": self.talk.token, "header": TOKEN}
        scene.head["design"] |= _described(desk, self._folder)
        return render_page(
            f"{task.cell.name}: {task.path.name}",
            scene.pack(),
            body="design.html",
            scripts=_SCRIPTS,
            styles=("design.css",),
            live=True,
        )

    def _desk(self) -> Desk:
        return Desk(self._task, self._searcher, seed=self._seed, jobs=self._jobs)

    def _page(self, number: int) -> Pictures:
        with self._lock:
            if number not in self._pages:
                raise InputError(
                    f"this page has been put away, only the newest {_PAGES} are kept: open it again"
                )
            return self._pages[number]

    def _move(self, body: bytes) -> bytes:
        wish = asked(Move, body)
        page = self._page(wish.page)
        page.desk.move(wish.state, search=wish.search, motion=wish.motion, hurried=wish.hurried)
        return page.frame()

    def _look(self, body: bytes) -> bytes:
        look = asked(Look, body)
        return self._page(look.page).frame(known=look.frame)

    def _save(self, body: bytes) -> bytes:
        self._page(asked(Asked, body).page).desk.save(self._folder)
        return json.dumps({"saved": str(self._folder)}).encode()


def _described(desk: Desk, folder: Path) -> dict[str, Any]:
    """Return what the page must know of the task to move and ask things."""
    task, answer = desk.session.task, desk.answer
    cell = task.cell
    return {
        "parameters": list(answer.change),
        "standing": {name: float(value) for name, value in standing(cell).items()},
        "base": cell.arms[1].base.homogeneous.tolist(),
        "rides": _rides(task) if f"{BASE}.x" in answer.change else None,
        "tool_axis": [float(x) for x in np.asarray(cell.tool_axes[1])],
        "smoothness": task.smoothness,
        "clearance": None if task.clearance is None else task.clearance.distance,
        "distances": bool(cell.pairs) and not cell.missing_meshes,
        "objective": float(answer.objective),
        "folder": str(folder),
    }


def _rides(task: Task) -> dict[str, list[Any]]:
    """Return what stands on base 2 and moves with it: joints, frames and bodies of the scene."""
    cell = task.cell
    base = cell.arms[1].base.copy()
    base.translation = base.translation + 1.0
    before, after = (Scene().cell_of(each) for each in (cell, cell.moved(base2=base)))
    return {
        kind: [
            k
            for k, (old, new) in enumerate(zip(before[kind], after[kind], strict=True))
            if old["p"] != new["p"]
        ]
        for kind in ("joints", "frames", "bodies")
    } | {"tips": [tip for tip in ("e1", "e2") if before[tip]["p"] != after[tip]["p"]]}
