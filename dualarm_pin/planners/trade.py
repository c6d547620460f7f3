"""The trade between index and speed: one answer led through weights of smoothness."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from dualarm_pin.answer.folder import load_result, save_result
from dualarm_pin.errors import InputError
from dualarm_pin.motion.make import make_motion
from dualarm_pin.motion.record import Motion
from dualarm_pin.planners.whole_path import polish
from dualarm_pin.solvers import interior_point as engine


@dataclass(frozen=True)
class TradePoint:
    """One weight and what it comes to.

    Attributes:
        weight: lambda of the links, whose metric is 1 / speed^2 and which follow the arc length.
        mean_index: Mean of the index.
        motion: Its motion at the largest constant feed; None where there is none.
        why: Why not, in one sentence.
        folder: Where result and motion are kept.
    """

    weight: float
    mean_index: float
    motion: Motion | None
    why: str
    folder: Path


def trade(
    result: Path, weights: Sequence[float], out: Path, *, allow_code: bool = False
) -> Iterator[TradePoint]:
    """Minimise index and weighted steps anew for each weight, the largest first, and keep it.

    Each starts from the end of the last, so that all lie in one family of paths.

    Args:
        result: A result folder to begin with.
        weights: lambdas.
        out: A folder is made in it for each weight.
        allow_code: Import and run functions that the task names with `call`.

    Raises:
        InputError: The result is damaged, a speed limit is unknown, or `out` cannot be written.
    """
    engine.ensure_compiled(lambda _: None)
    _, trajectory = load_result(result, allow_code=allow_code)
    q = trajectory.q
    for weight in sorted(weights, reverse=True):
        links = f"smoothness={{weight: {weight!r}, metric: velocity, per_arc_length: true}}"
        feed = ("motion.law=constant_feed", "motion.feed=null")
        task, _ = load_result(result, [links, *feed], allow_code=allow_code)
        answer = polish(task, q)
        q, folder = answer.q, out / f"lambda-{weight:g}"
        save_result(folder, task, answer)
        motion, why = None, ""
        try:
            motion = make_motion(task, answer)
            motion.write(folder)
        except InputError as error:
            why = str(error)
        yield TradePoint(weight, answer.mean_index, motion, why, folder)
