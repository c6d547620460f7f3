"""The motion with the largest constant feed: the aim is speed along the path, not the index."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from dualarm_pin.answer.notes import FeedNotes
from dualarm_pin.answer.provenance import Clock
from dualarm_pin.answer.trajectory import Trajectory
from dualarm_pin.answer.verify import verified
from dualarm_pin.arrays import Array
from dualarm_pin.errors import InputError
from dualarm_pin.feed.programme import FeedProgramme
from dualarm_pin.feed.starts import fast_paths
from dualarm_pin.motion.limits import limits_of
from dualarm_pin.planners.forbidden import forbidden
from dualarm_pin.planners.unreachable import unreachable
from dualarm_pin.progress import SILENT, Progress
from dualarm_pin.solvers import interior_point as engine
from dualarm_pin.task.motion_spec import MotionSpec

if TYPE_CHECKING:
    from dualarm_pin.task import Task


@dataclass(frozen=True)
class FeedBudget:
    """How far a search for speed may go.

    Attributes:
        starts: Postures drawn.
        refined: Paths that are refined, the fastest of all.
        rounds: Linear programmes of each at most.
    """

    starts: int
    refined: int
    rounds: int


_LOOKS = 9  # postures of a path at which it is looked for contact; the check sees them all
BUDGETS: dict[str, FeedBudget] = {
    "quick": FeedBudget(300, 1, 8),
    "normal": FeedBudget(900, 2, 25),
    "thorough": FeedBudget(4000, 8, 40),
}


def plan_feed(
    task: Task,
    *,
    effort: str = "normal",
    starts: int | None = None,
    seed: int = 0,
    jobs: int | None = None,
    progress: Progress = SILENT,
) -> Trajectory:
    """Plan the path on which the tool can run fastest at a constant feed.

    Speed and acceleration limits decide; torque and jerk are kept by the motion that is made of
    the answer. It is the best of what was refined, without a bound.

    Args:
        task: What is asked; its `motion` says which limits count.
        effort: `quick`, `normal` or `thorough`.
        starts: Postures drawn; those of the effort by default.
        seed: Seed of the starts: the same answer for any number of threads.
        jobs: Threads; None takes the processors there are.
        progress: Told where the work stands.

    Returns:
        The fastest path; after Ctrl-C the fastest so far. `found` is False where no start reached
        every point.

    Raises:
        InputError: A limit is not known.
    """
    budget, spec = BUDGETS[effort], task.motion or MotionSpec()
    limits = limits_of(task.cell, spec.limits)
    clock = Clock.start()
    never = forbidden(task, "feed", "engine", seed, clock)
    if never is not None:
        return never
    compile_s = engine.ensure_compiled(progress.line)
    drawn = starts or budget.starts
    progress.stage("starts for speed")
    paths = fast_paths(task, limits, drawn, seed=seed, jobs=jobs)
    if not len(paths):
        return unreachable(task, task.problem(), "feed", "engine", seed, clock)
    programme = FeedProgramme(task, limits, spec.chord)
    progress.stage("fastest paths refined", budget.refined)
    best: tuple[Array, float] | None = None
    interrupted, tried, best_is_clear = False, 0, False
    try:
        for q in sorted(paths, key=lambda path: not _clear(task, path)):  # clear ones first
            try:
                found = programme.refine(q, budget.rounds)
            except InputError:  # no smooth curve through these postures: the next ones
                continue
            tried += 1
            progress.advance()
            clear = _clear(task, found[0])
            if best is None or (clear, found[1]) > (best_is_clear, best[1]):
                best, best_is_clear = found, clear
            if tried == budget.refined:
                break
    except KeyboardInterrupt:
        if best is None:
            raise
        interrupted = True
    q, feed = best or (paths[0], 0.0)
    kinds = " and ".join(kind for kind in limits.kinds if kind in ("velocity", "acceleration"))
    return verified(
        task,
        q,
        method="feed",
        solver="engine",
        timing=clock.read(compile_s),
        seed=seed,
        message=f"{feed:.4g} m/s are allowed by {kinds} along the path, ramps left aside"
        if best
        else "",
        notes=FeedNotes(effort, feed, drawn, tried, interrupted),
    )


def _clear(task: Task, q: Array) -> bool:
    """Tell whether no two bodies are seen to touch along a path (h, n), or nothing is known."""
    looks = np.unique(np.linspace(0, len(q) - 1, _LOOKS).astype(int))
    found = [task.cell.clearance(q[i]) for i in looks]
    return all(near is None or near.distance > 0.0 for near in found)
