"""One page's session: it follows what is moved, and searches behind it.

A search works on a copy of where things stood, elsewhere; following goes on meanwhile.
"""

from __future__ import annotations

import threading
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from dualarm_pin.arrays import Array
from dualarm_pin.design.answer import Answer
from dualarm_pin.design.messages import State
from dualarm_pin.design.searcher import Outcome, Searcher
from dualarm_pin.design.session import Session
from dualarm_pin.design.standing import stands
from dualarm_pin.errors import InputError, UnknownNameError, nearest
from dualarm_pin.show.placement import save_with_cell
from dualarm_pin.task.changed import changed_task

if TYPE_CHECKING:
    from dualarm_pin.task import Task

_KEPT = 500  # motions found, that undo and variants begin from


@dataclass(frozen=True, eq=False)
class Found:
    """What a full search came to.

    Attributes:
        number: Number of the motion in this session, from 0; -1 where none was found.
        state: Where things stood.
        task: The task there.
        outcome: The answer, checked, and the slopes there.
    """

    number: int
    state: State
    task: Task
    outcome: Outcome


class Desk:
    """A session, what its last search found, and the thread that waits for the search.

    Args:
        task: The task; its cell is where the session starts.
        searcher: What searches; in this process if None.
        seed: Seed of the first motions.
        jobs: Threads for these.

    Attributes:
        session: The session; only under `lock`.
        state: Where things stand.
        found: What the last search found, anywhere; None before it ends.
        lock: Held while the session is used.
        frame: Number of what there is to show: another one after every change.

    Raises:
        InputError: No start reaches the whole path where the cell stands.
    """

    def __init__(
        self,
        task: Task,
        searcher: Searcher | None = None,
        *,
        seed: int = 0,
        jobs: int | None = None,
    ) -> None:
        self.session = Session(task, seed=seed, jobs=jobs)
        self.state = State(smoothness=task.smoothness)
        self.found: Found | None = None
        self.lock, self.frame = threading.RLock(), 0
        self._searcher = searcher or Searcher(seed, jobs, process=False)
        self._asked = (task.smoothness, dict[str, tuple[float, float]]())
        self._last = self.session.answer.q
        self._motions: dict[int, Array] = {}
        self._number = 0
        self._wanted, self._thread = False, None

    _thread: threading.Thread | None

    @property
    def answer(self) -> Answer:
        """The best motion known where things stand."""
        return self.session.answer

    @property
    def searching(self) -> bool:
        """Whether a search runs, or will."""
        return self._thread is not None

    @property
    def here(self) -> Found | None:
        """What was found where things stand now, if the search has been here."""
        return self.found if self.found is not None and self.found.state == self.state else None

    def move(
        self,
        state: State,
        *,
        search: bool = False,
        motion: int | None = None,
        hurried: bool = False,
    ) -> None:
        """Follow to another state.

        Args:
            state: Where everything stands.
            search: Whether the full search runs there; it also runs where the session asks.
            motion: Number of a motion that was found before and may be good here.
            hurried: Follow the best motion and one of the others in turn, not all of them.

        Raises:
            InputError: The cell has no such parameter or joint, or a value is no value for it.
        """
        with self.lock:
            self.frame += 1
            self._go(state, hurried)
            if motion in self._motions:
                self.session.consider(self._motions[motion][None])
            if not self.answer.valid:
                # What was followed has ended; where it was last valid is worth another try.
                self.session.consider(self._last[None])
            if self.answer.valid:
                self._last = self.answer.q
            if search or self.answer.search_due:
                self._search()

    def task_here(self) -> Task:
        """Return the task where things stand."""
        return changed_task(self.session.moved_task(), clearance=self.state.clearance)

    def save(self, folder: Path) -> None:
        """Write cell, task and result; only what a search has found here can be saved.

        Raises:
            InputError: Nothing is found here yet, or the folder cannot be written.
        """
        with self.lock:
            found = self.here
        if found is None or not found.outcome.trajectory.found:
            raise InputError("nothing is found here yet: wait for the search", field="save")
        save_with_cell(folder, found.task, found.outcome.trajectory)

    def wait(self, seconds: float) -> None:
        """Wait until no search runs, at most so long."""
        thread = self._thread
        if thread is not None:
            thread.join(seconds)

    def _go(self, state: State, hurried: bool) -> None:
        cell, known = self.session.task.cell, self.answer.change
        for name in state.change:
            if name not in known:
                raise UnknownNameError(
                    f"this cell has no parameter {name!r}; {nearest(name, known, 9)}", field="move"
                )
        asked = (state.smoothness, dict(state.limits))
        if asked != self._asked:
            bounds = zip(cell.lower.tolist(), cell.upper.tolist(), strict=True)
            limits = dict(zip(cell.joint_names, bounds, strict=True))
            self.session.set(smoothness=state.smoothness, limits=limits | state.limits)
            self._asked = asked
        if state.change != self.state.change:
            places = {name: stands(cell, name) + state.change.get(name, 0.0) for name in known}
            named = {name.replace(".", "_", 1): value for name, value in places.items()}
            self.session.move(hurried=hurried, **named)
        self.state = state

    def _search(self) -> None:
        self._wanted = True
        if self._thread is None:
            self._thread = threading.Thread(target=self._searches, daemon=True)
            self._thread.start()

    def _searches(self) -> None:
        try:
            while True:
                with self.lock:
                    if not self._wanted:
                        self._thread = None
                        return
                    self._wanted = False
                    state, task = self.state, self.task_here()
                outcome = self._searcher.search(task)
                with self.lock:
                    self._keep(state, task, outcome)
        except BaseException:
            self._thread = None  # the next change may search again
            raise

    def _keep(self, state: State, task: Task, outcome: Outcome) -> None:
        number, found = -1, outcome.trajectory
        if found.found:
            number, self._number = self._number, self._number + 1
            self._motions[number] = np.array(found.q)
            self._motions.pop(number - _KEPT, None)
            self.session.consider(found.q[None])
            if self.answer.valid:
                self._last = self.answer.q
        self.found = Found(number, state, task, outcome)
        self.frame += 1
