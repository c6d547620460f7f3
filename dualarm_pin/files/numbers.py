"""Numbers in files: every count and every length has a largest value, and its message says so.

What is beyond is a slip of the pen, or meant to keep a machine busy for ever.
"""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from dualarm_pin.errors import InputError

LARGEST = 1e6  # no length [m], angle [deg] or speed of a robot is meant beyond it
HEAVIEST = 1e12  # weights compare unlike units, so they may be large
MOST_POINTS = 100_000  # of a path: one solve of so many takes about ten seconds
MOST_STARTS = 1_000_000  # days of work
MOST_JOBS = 1024  # threads or processes of one machine
LARGEST_SEED = 2**63 - 1  # the largest whole number of most file formats

Number = Annotated[float, Field(ge=-LARGEST, le=LARGEST)]
Whole = Annotated[int, Field(ge=-LARGEST, le=LARGEST)]
Vector = tuple[Number, Number, Number]
Positive = Annotated[float, Field(gt=0.0, le=LARGEST)]
Weight = Annotated[float, Field(ge=0.0, le=HEAVIEST)]
Point = Annotated[int, Field(ge=1, le=MOST_POINTS)]
"""A point of the path, from 1."""
Starts = Annotated[int, Field(ge=1, le=MOST_STARTS)]
Seed = Annotated[int, Field(ge=0, le=LARGEST_SEED)]
Seconds = Annotated[float, Field(gt=0.0, le=1e7)]


def check_counts(
    starts: int | None = None, seed: int | None = None, jobs: int | None = None
) -> None:
    """Refuse options of a command that are out of range.

    Raises:
        InputError: The field is the option.
    """
    for name, number, least, most in (
        ("starts", starts, 1, MOST_STARTS),
        ("seed", seed, 0, LARGEST_SEED),
        ("jobs", jobs, 1, MOST_JOBS),
    ):
        if number is not None and not least <= number <= most:
            raise InputError(f"{least} to {most} is expected; given {number}", field=f"--{name}")
