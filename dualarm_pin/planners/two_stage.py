"""The paper's method: first the points Gamma, then the points between them, with NLopt.

Stage 1 minimises (eq. 19) over Gamma from many starts. Its ranking is not the final one, so
several distinct minima (basins) are carried on. Stage 2 minimises (eq. 20) over at most `inner`
points of each gap between fixed neighbours, the linear interpolation being start 0, and recurs
until every point of the path is in.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from dualarm_pin.answer.evidence import Evidence, LawCount
from dualarm_pin.answer.notes import TwoStageNotes
from dualarm_pin.answer.provenance import Clock
from dualarm_pin.answer.trajectory import Trajectory
from dualarm_pin.answer.verify import verified
from dualarm_pin.planners.unreachable import unreachable
from dualarm_pin.problem import Problem
from dualarm_pin.progress import SILENT, Progress
from dualarm_pin.search.starts import common_postures, generator
from dualarm_pin.search.workers import Workers
from dualarm_pin.solution import Solution, Solutions, distinct
from dualarm_pin.solvers.shipped import SLSQP
from dualarm_pin.solvers.solver import Solver, cut_off, name_of, solve_one

if TYPE_CHECKING:
    from dualarm_pin.task import Task

Array = NDArray[np.float64]
Known = dict[int, Array]  # joints (n,) by point of the path


@dataclass(frozen=True)
class _Gap:
    """Points between two known ones, to be found next."""

    before: int
    after: int
    inner: tuple[int, ...]


def plan_two_stage(
    task: Task,
    *,
    starts: int = 100,
    seed: int = 0,
    jobs: int | None = None,
    basins: int = 6,
    inner: int = 5,
    solver: Solver = SLSQP,
    progress: Progress = SILENT,
    workers: Workers | None = None,
) -> Trajectory:
    """Plan with the two-stage method of the paper, (eq. 19) on Gamma and (eq. 20) between.

    Args:
        task: What is asked.
        starts: Starts of stage 1, and of every gap of the best basin in stage 2; the other basins
            get a tenth.
        seed: Seed of the starts.
        jobs: Number of processes; None takes the processors there are.
        basins: How many distinct minima of stage 1 are carried on.
        inner: Most points of a gap found at once (k in the paper); larger gaps are split again.
        solver: What takes each start to its minimum, the paper's by default. In several processes
            it must be one that they can import.
        progress: Told where the work stands.
        workers: A pool to use instead of `jobs` new processes.

    Returns:
        The best trajectory; `found` is False where no start reached every point.
    """
    clock = Clock.start()
    own = workers is None
    pool = workers or Workers(jobs)
    try:
        problem = task.problem()
        Gamma = task.Gamma
        first = problem.subset(Gamma, task.link_weights(Gamma, task.stage_1_smoothness))
        drawn = common_postures(
            problem.lower, problem.upper, len(Gamma), starts, generator(seed, 1)
        )
        progress.stage(f"stage 1: {len(Gamma)} points, {starts} starts", starts)
        found = _solve_all(pool, [(solver, first, start) for start in drawn], progress)
        feasible = sum(end.feasible for end in found)
        if not feasible and pool.interrupted:
            raise KeyboardInterrupt  # nothing is finished that could be kept
        if not feasible:
            return unreachable(task, problem, "two-stage", name_of(solver), seed, clock)
        minima = distinct(Solutions.of(found))
        progress.line(
            f"stage 1: {feasible} of {starts} starts feasible, {len(minima)} distinct minima, "
            f"best {minima.ends.objective[0]:.4f}"
        )
        candidates = [dict(zip(Gamma, q, strict=True)) for q in minima.ends.q[:basins]]
        few = max(1, starts // 10)
        paths = _fill_all(task, problem, candidates, few, inner, seed, solver, pool, progress)
        if paths and starts > few and not pool.interrupted:
            # The leader gets the full number of starts, the rest had the likely ones.
            leader = [candidates[paths[0][0]]]
            again = _fill_all(task, problem, leader, starts, inner, seed, solver, pool, progress)
            paths = sorted([*paths, *again], key=lambda path: path[1])
        if not paths and pool.interrupted:
            # One basin with the likely start takes a second: better a whole path than none.
            progress.line("stopped: filling in the best answer so far")
            with Workers(1) as here:
                paths = _fill_all(
                    task, problem, candidates[:1], 1, inner, seed, solver, here, progress
                )
        if not paths:
            return unreachable(task, problem, "two-stage", name_of(solver), seed, clock)
        law = LawCount(starts, feasible, len(minima), int(minima.hits[0]))
        return verified(
            task,
            paths[0][2],
            method="two-stage",
            solver=name_of(solver),
            timing=clock.read(workers_cpu_s=pool.cpu_s),
            seed=seed,
            evidence=Evidence(laws={"stage 1": law}),
            notes=TwoStageNotes(
                Gamma=tuple(point + 1 for point in Gamma),
                stage_1_objective=float(minima.ends.objective[0]),
                basins=len(candidates),
                interrupted=pool.interrupted,
            ),
        )
    finally:
        if own:
            pool.close()


def _fill_all(
    task: Task,
    problem: Problem,
    basins: Sequence[Known],
    starts: int,
    inner: int,
    seed: int,
    solver: Solver,
    pool: Workers,
    progress: Progress,
) -> list[tuple[int, float, Array]]:
    """Fill every gap of every basin; return (basin, objective (eq. 19), q (h, n)), best first."""
    filled: dict[int, Known] = {number: dict(basin) for number, basin in enumerate(basins)}
    level = 0
    while True:
        gaps = [
            (number, gap)
            for number, known in filled.items()
            for gap in _gaps(sorted(known), task.path.h, inner)
        ]
        if not gaps:
            break
        level += 1
        progress.stage(
            f"stage 2: {len(filled)} basins, {len(gaps)} gaps, {starts} starts each",
            len(gaps) * starts,
        )
        runs, owner = [], []
        for number, gap in gaps:
            between = _gap_problem(task, problem, filled[number], gap)
            for start in _gap_starts(between, gap, filled[number], starts, seed, level):
                runs.append((solver, between, start))
                owner.append((number, gap))
        found = _solve_all(pool, runs, progress)
        for number, gap in gaps:
            mine = [
                end
                for end, who in zip(found, owner, strict=True)
                if who == (number, gap) and end.feasible
            ]
            if number not in filled:
                continue
            if not mine:
                del filled[number]  # this basin cannot be continued
                continue
            best = min(mine, key=lambda end: end.objective)
            filled[number] |= dict(zip(gap.inner, best.q, strict=True))
    paths = []
    for number, known in filled.items():
        q = np.array([known[point] for point in range(task.path.h)])
        paths.append((number, problem.objective(q), q))
    return sorted(paths, key=lambda path: path[1])


def _gaps(known: Sequence[int], h: int, inner: int) -> list[_Gap]:
    """Return the gaps between known points, each with at most `inner` points spread over it."""
    gaps = []
    for before, after in itertools.pairwise(known):
        missing = after - before - 1
        if missing:
            count = min(inner, missing)
            spread = np.linspace(before, after, count + 2)[1:-1]
            gaps.append(_Gap(before, after, tuple(int(round(point)) for point in spread)))
    return gaps


def _gap_problem(task: Task, problem: Problem, known: Known, gap: _Gap) -> Problem:
    weights = task.link_weights((gap.before, *gap.inner, gap.after), task.smoothness)
    return problem.subset(gap.inner, weights, before=known[gap.before], after=known[gap.after])


def _gap_starts(
    problem: Problem, gap: _Gap, known: Known, starts: int, seed: int, level: int
) -> list[Array]:
    share = (np.array(gap.inner) - gap.before) / (gap.after - gap.before)
    a, b = known[gap.before], known[gap.after]
    linear = a + share[:, None] * (b - a)
    random = generator(seed, 2, level, gap.before)
    drawn = common_postures(problem.lower, problem.upper, problem.k, starts - 1, random)
    return [linear, *drawn]


def _solve_all(
    pool: Workers, runs: Sequence[tuple[Solver, Problem, Array]], progress: Progress
) -> list[Solution]:
    """Solve each; a start that Ctrl-C cut off is solved no more and counts as infeasible."""
    found = pool.run(solve_one, runs, progress.advance)
    return [cut_off(run[2]) if end is None else end for end, run in zip(found, runs, strict=True)]
