"""Notes: what each method says of its own work, beside the answer. In result.json under `extra`.

A method of the user's own may bring a record of its own; it is written, and left out when read.
Points are counted from 1.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from _typeshed import DataclassInstance


@dataclass(frozen=True)
class GlobalNotes:
    """Of the whole path at once: the effort, and whether Ctrl-C or a time limit cut it short.

    `from_earlier`: the answer came from an earlier result; None where that was not looked at.
    """

    effort: str
    interrupted: bool
    from_earlier: bool | None = None


@dataclass(frozen=True)
class FeedNotes:
    """Of the largest feed: what joint speed and acceleration allow [m/s], and the work."""

    effort: str
    steady_feed: float
    starts: int
    refined: int
    interrupted: bool


@dataclass(frozen=True)
class PolishNotes:
    """Of one solve from given joints: whether it did better than those."""

    improved: bool


@dataclass(frozen=True)
class TwoStageNotes:
    """Of the paper's method: stage 1 over Gamma, how many of its minima were carried on."""

    Gamma: tuple[int, ...]
    stage_1_objective: float
    basins: int
    interrupted: bool


@dataclass(frozen=True)
class LocalNotes:
    """Of the pseudo-inverse: gain k0 of (eq. 13), points where it was damped or left the path."""

    k0: float
    damped_at: tuple[int, ...]
    infeasible_at: tuple[int, ...]


@dataclass(frozen=True)
class CasadiNotes:
    """Of CasADi: seconds to build the programme, and of each solve."""

    build_s: float
    solve_s: tuple[float, ...]


@dataclass(frozen=True)
class PinkNotes:
    """Of Pink: cost of its manipulability task, points where it found no step."""

    manipulability: float
    infeasible_at: tuple[int, ...]


@dataclass(frozen=True)
class PlacementNotes:
    """Of a search for a placement: what was changed, what does not matter, how far it went.

    Attributes:
        change: Change of each parameter from where the cell stood [m or rad].
        flat: Directions along which the objective does not change, in words.
        at_bound: Parameters that ended at an end of their box.
        rounds: Rounds of the search.
        rounds_here: Those that ended in this placement.
        starts: Random places drawn.
    """

    change: dict[str, float]
    flat: tuple[str, ...]
    at_bound: tuple[str, ...]
    rounds: int
    rounds_here: int
    starts: int


NOTES: Final[dict[str, type[DataclassInstance]]] = {
    "global": GlobalNotes,
    "feed": FeedNotes,
    "polish": PolishNotes,
    "two-stage": TwoStageNotes,
    "local": LocalNotes,
    "placement": PlacementNotes,
    "casadi": CasadiNotes,
    "pink": PinkNotes,
}
"""The notes of each method, by its name in result.json."""
