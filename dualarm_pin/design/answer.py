"""What a session knows where things stand."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from dualarm_pin.arrays import Array


@dataclass(frozen=True, eq=False)
class Answer:
    """The best motion known where things stand.

    Attributes:
        q: Joints (h, n); those that were last valid where `valid` is False.
        objective: Objective of q where it was valid.
        valid: Whether q holds where things stand now.
        why: Why not, in one sentence.
        basin: Number of the minimum that is shown; another number is another way of moving.
        pool: Objectives of the minima that are followed, best first.
        change: Parameters, from where the task's cell stands [m or rad].
        search_due: Why a global search should be run; empty if none is due.
    """

    q: Array
    objective: float
    valid: bool
    why: str
    basin: int
    pool: tuple[float, ...]
    change: Mapping[str, float]
    search_due: str
