"""What the `motion:` section of a task file may hold: how its answer runs in time."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from dualarm_pin.files.numbers import Number, Positive
from dualarm_pin.files.source import Spec


class ChordSpec(Spec):
    """How far the motion may leave the relative path between its samples.

    Attributes:
        mm: Largest distance [mm].
        deg: Largest angle [deg].
    """

    mm: Positive = 0.05
    deg: Positive = 0.01


class MotionSpec(Spec):
    """The `motion:` section.

    Attributes:
        law: The tool runs at one speed, with ramps at both ends, or as fast as limits allow.
        feed: Speed of the tool along the path [m/s], such as `0.05`; the largest for another law.
            As fast as
            limits allow if not given.
        chord: How far it may leave the path.
        rate: Largest time between samples [s].
        limits: Which limits of the joints to keep, such as `[velocity, acceleration]`; all that are
            known if not given.
        tool_force: Force that the tool exerts along the direction u of each point [N].
    """

    law: Literal["constant_feed", "time_optimal"] = "constant_feed"
    feed: Positive | None = None
    chord: ChordSpec = ChordSpec()
    rate: Annotated[float, Field(gt=0.0, le=1.0)] = 0.004
    limits: list[Literal["velocity", "acceleration", "jerk", "torque"]] | None = None
    tool_force: Number = 0.0
