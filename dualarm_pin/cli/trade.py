"""`dualarm-pin trade`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from dualarm_pin.cli import DONE
from dualarm_pin.errors import InputError


def trade(
    result: Path,
    /,
    *,
    weights: tuple[float, ...] = (1e6, 1e4, 1e2, 1.0, 1e-2),
    out: Path | None = None,
    allow_code: Annotated[bool, Parameter(negative=())] = False,
) -> int:
    """Show what speed costs in the index: a motion for each weight of smoothness.

    Args:
        result: A folder that `solve --out` wrote.
        weights: lambda of the links, which stand for time: 1 / speed limit^2, by arc length.
        out: Folder of the results; RESULT_DIR/trade by default.
        allow_code: Import and run the functions that the task names with `call`.
    """
    from dualarm_pin.planners.trade import trade as points

    if not weights or not all(0.0 <= weight < float("inf") for weight in weights):
        raise InputError("finite weights of 0 or more are expected", field="--weights")
    folder = out or result / "trade"
    print("lambda       mean index   feed [m/s]   folder")
    for point in points(result, weights, folder, allow_code=allow_code):
        feed = point.why if point.motion is None else f"{point.motion.summary.feed:<12.5g}"
        print(f"{point.weight:<12g} {point.mean_index:<12.5g} {feed} {point.folder}", flush=True)
    print(f"see them with: dualarm-pin view {folder}/*")
    return DONE
