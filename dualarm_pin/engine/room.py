"""Room to solve in: of this thread and for this shape of problem, and what a solve finds there."""

from __future__ import annotations

import threading
from dataclasses import replace
from typing import NamedTuple, TypeVar

from dualarm_pin.arrays import checked
from dualarm_pin.engine.jit.functions import INDEX, addresses, row_signatures
from dualarm_pin.engine.kernels.address import index_address
from dualarm_pin.engine.workspace import Scratch, Workspace, new_workspace
from dualarm_pin.problem import CALLED, Problem
from dualarm_pin.rows import table
from dualarm_pin.solution import Multipliers

R = TypeVar("R", bound=NamedTuple)
_ROOMS = threading.local()


def workspace_for(problem: Problem, path: Problem | None = None) -> Workspace:
    """Return room for this thread and this shape of problem, kept from one batch to the next.

    One point alone has room of its own: walks and whole paths take turns.

    Args:
        problem: What is solved.
        path: The path whose points, with their rows, are put into the problem one by one.
    """
    shape = (problem.k, len(problem.chain.kind), problem.n, *widths(problem))
    rooms: dict[bool, tuple[object, Workspace]] = _ROOMS.__dict__.setdefault("rooms", {})
    known, work = rooms.get(problem.k == 1, (None, None))
    if work is None or known != shape:
        work = new_room(problem)
        rooms[problem.k == 1] = shape, work
    set_calls(path or problem, work.scratch)
    return work


def own_window(path: Problem, k: int) -> Problem:
    """Return the first k points as a problem with arrays of its own: compiled code writes there."""
    window = path.window(0, k)
    return replace(
        window,
        points=_copied(window.points),
        links=_copied(window.links),
        neighbours=_copied(window.neighbours),
        equalities=_copied(window.equalities),
        inequalities=_copied(window.inequalities),
    )


def _copied(record: R) -> R:
    return type(record)(*(array.copy() for array in record))


def new_room(problem: Problem) -> Workspace:
    """Return room of its own for a problem."""
    work = new_workspace(problem.k, len(problem.chain.kind), problem.n, *widths(problem))
    set_calls(problem, work.scratch)
    return work


def widths(problem: Problem) -> tuple[int, int, int]:
    """Return how many equality rows, inequality rows and further rows room is made for."""
    return problem.m, problem.inequalities.kind.shape[1], len(problem.rows)


def set_calls(problem: Problem, scratch: Scratch) -> None:
    """Put the addresses of the index and the rows that have no kernel of their own."""
    index = problem.index
    if problem.terms.kind == CALLED:
        scratch.index_call[0] = index_address(problem, scratch)
        if not index.kernel:
            functions = (index.phi, index.gradient, index.curvature)
            scratch.index_calls[:] = addresses(index.name, functions, INDEX)
    called = {
        int(source)
        for rows in (problem.equalities, problem.inequalities)
        for source in rows.source[rows.kind == table.CALLED]
    }
    for number in called:
        row = problem.rows[number]
        assert row.slope is not None  # set when the row was made
        assert row.bend is not None
        signatures = row_signatures(len(row.parameters))
        scratch.row_calls[number] = addresses(row.name, (row.phi, row.slope, row.bend), signatures)


def load_multipliers(warm: Multipliers, work: Workspace, size: float) -> None:
    """Put multipliers into the room as those of the scaled problem."""
    at = work.at
    for name, room, value in (
        ("equalities", at.y, warm.equalities),
        ("lower", at.lower, warm.lower),
        ("upper", at.upper, warm.upper),
        ("inequalities", at.push, warm.inequalities),
    ):
        room[:] = checked(f"warm.{name}", value, room.shape) / size
