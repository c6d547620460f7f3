"""The part of `result.json` about the clearance rule; points are counted from 1."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict

from dualarm_pin.answer.evidence import Number
from dualarm_pin.answer.trajectory import Apart, Checked
from dualarm_pin.cell.parts import Pair


class _Spec(BaseModel):
    model_config = ConfigDict(extra="ignore", frozen=True)


class ApartFile(_Spec):
    """What the clearance rule comes to."""

    required: Number | None
    level: Literal["points", "samples", "certified"]
    kept: bool
    worst: str
    bound: Number | None = None


class LinesFile(_Spec):
    """The distances on the lines between the points."""

    distance: list[Number]
    place: list[Number]
    pairs: tuple[Pair, ...] = ()


def apart_json(checked: Checked) -> dict[str, Any] | None:
    """Return what the clearance rule comes to, or None without one."""
    apart, near = checked.apart, checked.clearance
    if apart is None or near is None:
        return None
    line = None if apart.between is None else int(np.argmin(apart.between))
    return {
        "required": apart.required,
        "level": apart.level,
        "kept": apart.kept,
        "worst": apart.worst,
        "smallest_at_points": near.least,
        "pair": near.closest,
        "point": int(np.argmin(near.distance)) + 1,
        "smallest_between_points": apart.least_between,
        "between_pair": None if line is None else apart.pairs[line],
        "between_after_point": None if line is None else line + 1,
        "bound": apart.bound,
    }


def lines_json(checked: Checked) -> dict[str, Any] | None:
    """Return the figures of each line between points, or None where none was looked at."""
    apart = checked.apart
    if apart is None or apart.between is None:
        return None
    return {"distance": apart.between, "place": apart.place, "pairs": apart.pairs}


def read_apart(content: ApartFile | None, lines: LinesFile | None) -> Apart | None:
    """Return what both say."""
    if content is None:
        return None
    return Apart(
        required=content.required,
        level=content.level,
        kept=content.kept,
        worst=content.worst,
        between=None if lines is None else np.array(lines.distance),
        place=None if lines is None else np.array(lines.place),
        pairs=() if lines is None else lines.pairs,
        bound=content.bound,
    )
