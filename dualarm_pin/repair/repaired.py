"""A path whose bodies were moved apart, and how it stands on the way there."""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass
from typing import NamedTuple

from dualarm_pin.arrays import Array
from dualarm_pin.problem import Problem
from dualarm_pin.repair.contacts import Contacts


@dataclass(frozen=True, eq=False)
class Repaired:
    """A path whose bodies are far enough apart at the postures looked at.

    Attributes:
        q: Joints (k, n).
        objective: Objective there.
        problem: The problem with the rows that hold it there.
        contacts: What these rows were made of.
        apart: (c,) how far apart they were asked to be [m].
        extra: (p, k) what was asked of pairs at points beyond what is required [m].
        before: The path as it came apart first, where it has settled since.
    """

    q: Array
    objective: float
    problem: Problem
    contacts: Contacts
    apart: Array
    extra: Array
    before: Repaired | None = None


class Standing(NamedTuple):
    """Where a path stands after a round.

    Attributes:
        value: Objective there.
        lack: The largest lack of its bodies [m].
        kept: They are far enough apart at the points, and the path is on its rows.
        found: The path, where it is apart between the points too.
    """

    value: float
    lack: float
    kept: bool
    found: Repaired | None = None


Steps = Generator[Standing, None, Repaired | None]


def ended(steps: Steps) -> Repaired | None:
    """Return what steps lead to."""
    while True:
        try:
            next(steps)
        except StopIteration as end:
            found: Repaired | None = end.value
            return found
