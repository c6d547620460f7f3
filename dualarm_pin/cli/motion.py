"""`dualarm-pin motion`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter

from dualarm_pin.cli import DONE


def motion(
    result: Path,
    /,
    *,
    law: Literal["constant_feed", "time_optimal"] | None = None,
    feed: float | None = None,
    set_: Annotated[tuple[str, ...], Parameter(name="--set", negative=())] = (),
    allow_code: Annotated[bool, Parameter(negative=())] = False,
) -> int:
    """Make the motion in time of a result and write it beside it.

    Args:
        result: A folder that `solve --out` wrote.
        law: One speed of the tool with ramps at both ends, or as fast as all limits allow; that of
            the task by default, else constant_feed.
        feed: Speed of the tool along the path, for time_optimal the largest [m/s]; as fast as
            limits allow by default.
        set_: Change a field of the task or cell: key=value, such as motion.rate=0.008 or
            cell.acceleration_deg_s2={joint_1: 300}.
        allow_code: Import and run the functions that the task names with `call`.
    """
    from dualarm_pin.answer.folder import load_result
    from dualarm_pin.files.write import reserved
    from dualarm_pin.motion.make import make_motion
    from dualarm_pin.motion.text import motion_text

    changes = [*set_]
    if law is not None:
        changes.append(f"motion.law={law}")
    if feed is not None:
        changes.append(f"motion.feed={feed!r}")
    task, trajectory = load_result(result, changes, allow_code=allow_code)
    with reserved(result):
        made = make_motion(task, trajectory)
        made.write(result)
    print(motion_text(made))
    print(f"written to {result}")
    return DONE
