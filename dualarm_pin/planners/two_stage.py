"""The paper's method: first the points Gamma, then the points between them, with NLopt.

Stage 1 minimises (eq. 19) over Gamma from many starts. Its ranking is not the final one, so
several distinct minima (basins) are carried on. Stage 2 minimises (eq. 20) over at most `inner`
points of each gap between fixed neighbours, the linear interpolation being start 0, and recurs
until every point of the path is in.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from contextlib import nullcontext
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dualarm_pin.answer.evidence import Evidence, LawCount
from dualarm_pin.answer.notes import TwoStageNotes
from dualarm_pin.answer.provenance import Clock
from dualarm_pin.answer.trajectory import Trajectory
from dualarm_pin.answer.verify import verified
from dualarm_pin.arrays import Array
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
    with nullcontext(workers) if workers is not None else Workers(jobs) as pool:
        task.check_first_stage()
        problem, Gamma = task.problem(), task.Gamma
        stages = _Stages(task, problem, solver, inner, seed, pool, progress)
        found = stages.first(starts)
        feasible = sum(end.feasible for end in found)
        if not feasible and pool.interrupted:
            raise KeyboardInterrupt  # nothing is finished that could be kept
        candidates: list[Known] = []
        paths: list[_Filled] = []
        if feasible:
            minima = distinct(Solutions.of(found))
            progress.line(
                f"stage 1: {feasible} of {starts} starts feasible, {len(minima)} distinct minima, "
                f"best {minima.ends.objective[0]:.4f}"
            )
            candidates = [dict(zip(Gamma, q, strict=True)) for q in minima.ends.q[:basins]]
            paths = stages.second(candidates, starts)
        if not paths:
            return unreachable(task, problem, "two-stage", name_of(solver), seed, clock)
        law = LawCount(starts, feasible, len(minima), int(minima.hits[0]))
        return verified(
            task,
            paths[0].q,
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


class _Filled(NamedTuple):
    """A basin with every point found: its number, objective (eq. 19), and joints (h, n)."""

    basin: int
    objective: float
    q: Array


@dataclass(frozen=True)
class _Stages:
    """Both stages with what they share; see `plan_two_stage`."""

    task: Task
    problem: Problem
    solver: Solver
    inner: int
    seed: int
    pool: Workers
    progress: Progress

    def first(self, starts: int) -> list[Solution]:
        """Solve (eq. 19) over Gamma from starts of one posture for all its points."""
        task, problem = self.task, self.problem
        weights = task.link_weights(task.Gamma, task.stage_1_smoothness)
        first, random = problem.subset(task.Gamma, weights), generator(self.seed, 1)
        drawn = common_postures(problem.lower, problem.upper, first.k, starts, random)
        self.progress.stage(f"stage 1: {first.k} points, {starts} starts", starts)
        return self.solve([(first, start) for start in drawn])

    def second(self, candidates: Sequence[Known], starts: int) -> list[_Filled]:
        """Fill the basins, the best of them with all the starts; return the paths, best first."""
        few = max(1, starts // 10)
        paths = self.fill(candidates, few)
        if paths and starts > few and not self.pool.interrupted:
            # The leader gets the full number of starts, the rest had the likely ones.
            again = self.fill([candidates[paths[0].basin]], starts)
            paths = sorted([*paths, *again], key=lambda path: path.objective)
        if not paths and self.pool.interrupted:
            # One basin with the likely start takes a second: better a whole path than none.
            self.progress.line("stopped: filling in the best answer so far")
            with Workers(1) as here:
                paths = replace(self, pool=here).fill(candidates[:1], 1)
        return paths

    def fill(self, basins: Sequence[Known], starts: int) -> list[_Filled]:
        """Fill every gap of every basin by (eq. 20); one that cannot be continued is left out."""
        h, progress = self.task.path.h, self.progress
        filled = {number: dict(basin) for number, basin in enumerate(basins)}
        for level in itertools.count(1):
            gaps = [
                (number, gap)
                for number, known in filled.items()
                for gap in _gaps(sorted(known), h, self.inner)
            ]
            if not gaps:
                break
            progress.stage(
                f"stage 2: {len(filled)} basins, {len(gaps)} gaps, {starts} starts each",
                len(gaps) * starts,
            )
            runs = []
            for number, gap in gaps:
                between = self.between(filled[number], gap)
                drawn = _gap_starts(between, gap, filled[number], starts, self.seed, level)
                runs += [(between, start) for start in drawn]
            found = self.solve(runs)
            for place, (number, gap) in enumerate(gaps):
                ends = found[place * starts : (place + 1) * starts]
                best = min(
                    (end for end in ends if end.feasible),
                    key=lambda end: end.objective,
                    default=None,
                )
                if best is None:
                    filled.pop(number, None)
                elif number in filled:
                    filled[number] |= dict(zip(gap.inner, best.q, strict=True))
        paths = []
        for number, known in filled.items():
            q = np.array([known[point] for point in range(h)])
            paths.append(_Filled(number, self.problem.objective(q), q))
        return sorted(paths, key=lambda path: path.objective)

    def between(self, known: Known, gap: _Gap) -> Problem:
        """Return the problem (eq. 20) of the points of a gap, its ends fixed."""
        points = (gap.before, *gap.inner, gap.after)
        weights = self.task.link_weights(points, self.task.smoothness)
        ends = {"before": known[gap.before], "after": known[gap.after]}
        return self.problem.subset(gap.inner, weights, **ends)

    def solve(self, runs: Sequence[tuple[Problem, Array]]) -> list[Solution]:
        """Solve each; a start that Ctrl-C cut off is solved no more and counts as infeasible."""
        calls = [(self.solver, *run) for run in runs]
        found = self.pool.run(solve_one, calls, self.progress.advance)
        return [
            cut_off(start) if end is None else end
            for end, (_, start) in zip(found, runs, strict=True)
        ]


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


def _gap_starts(
    problem: Problem, gap: _Gap, known: Known, starts: int, seed: int, level: int
) -> list[Array]:
    share = (np.array(gap.inner) - gap.before) / (gap.after - gap.before)
    a, b = known[gap.before], known[gap.after]
    linear = a + share[:, None] * (b - a)
    random = generator(seed, 2, level, gap.before)
    drawn = common_postures(problem.lower, problem.upper, problem.k, starts - 1, random)
    return [linear, *drawn]
