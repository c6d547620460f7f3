"""The whole path at once: search, polish, evidence."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray

from dualarm_pin.answer.notes import GlobalNotes, PolishNotes
from dualarm_pin.answer.provenance import Clock
from dualarm_pin.answer.trajectory import Trajectory
from dualarm_pin.answer.verify import verified
from dualarm_pin.clearance.asked import asked_of
from dualarm_pin.evidence.laws import count_laws
from dualarm_pin.planners.alternatives import Candidate, with_alternatives
from dualarm_pin.planners.earlier import resampled
from dualarm_pin.planners.forbidden import forbidden
from dualarm_pin.planners.unreachable import unreachable
from dualarm_pin.progress import SILENT, Progress
from dualarm_pin.solution import same_path
from dualarm_pin.solvers import interior_point as engine
from dualarm_pin.solvers.shipped import ENGINE
from dualarm_pin.solvers.solver import Solver, name_of, solve_one

if TYPE_CHECKING:
    from dualarm_pin.planners.effort import Search
    from dualarm_pin.task import Task
    from dualarm_pin.task.ends import FreePart

Array = NDArray[np.float64]
Effort = Literal["quick", "normal", "thorough"]
_SEARCHED = 0.5  # of a time limit is left to the search, where its paths may have to be moved apart


def plan_global(
    task: Task,
    *,
    effort: str = "normal",
    solver: Solver = ENGINE,
    starts: int | None = None,
    seed: int = 0,
    jobs: int | None = None,
    time_limit: float | None = None,
    warm: Trajectory | None = None,
    alternatives: int = 1,
    progress: Progress = SILENT,
) -> Trajectory:
    """Plan the whole path at once and say how good the answer is.

    Args:
        task: What is asked.
        effort: `quick` (one search and the check), `normal` (independent searches until they
            agree, and starts by further laws) or `thorough` (more of all, and the lower bound).
        solver: What takes each start to its minimum. The check and the bound have the compiled
            engine whatever this is.
        starts: Starts of each further law at most; None takes those of the effort.
        seed: Seed of the starts: the same answer for any number of threads.
        jobs: Threads; None takes the processors there are.
        time_limit: Seconds after which the search is cut: then the answer depends on the machine.
            The step under way is finished and the check is made.
        warm: An earlier result for the same joints: a further start, whose minimum is taken where
            it is better. Its path is put onto this one by arc length.
        alternatives: How many answers there shall be: the best, and in its `alternatives` the next
            ones that differ in posture, fewer where fewer are found.
        progress: Told where the work stands.

    Returns:
        The best path of all starts and hops; after Ctrl-C the best so far. `found` is False where
        no start reached every point.

    Raises:
        InputError: `warm` has other joints.
    """
    from dualarm_pin.evidence.check import check_minimum, polished
    from dualarm_pin.evidence.verdict import Findings, conclude, with_bound_without_clearance
    from dualarm_pin.planners.effort import BUDGETS, Search

    budget = BUDGETS[effort]
    free = task.free()
    problem = free.problem
    further = [] if warm is None else [free.part(resampled(task, warm))]
    clock = Clock.start()
    never = forbidden(task, "global", name_of(solver), seed, clock)
    if never is not None:
        return never
    compile_s = engine.ensure_compiled(progress.line)
    begun, limit = time.monotonic(), np.inf if time_limit is None else time_limit
    search = Search(
        problem,
        budget,
        seed,
        jobs=jobs,
        solver=solver,
        progress=progress,
        starts=starts,
        deadline=_searched_until(task, begun + limit),
    )
    interrupted = _until_ctrl_c(search.run)
    found = search.best()
    if not interrupted:
        interrupted = _until_ctrl_c(lambda: _refine(search, solver, further))
    earlier = [q for _, q in search.given]
    if not interrupted:
        walks = _from_ends(free, solver, jobs)
        interrupted = _until_ctrl_c(lambda: _refine(search, solver, walks))
    best = search.best()
    if best is None and interrupted:
        raise KeyboardInterrupt  # nothing is finished that could be kept
    if best is None:
        return unreachable(task, task.problem(), "global", name_of(solver), seed, clock)
    interrupted = interrupted or search.cut
    q, local, bound = best, None, None
    if budget.bound and not interrupted:
        from dualarm_pin.evidence.bound import bound_minimum

        # The pieces may show a better path: then that is the answer, with counts of its own.
        q, local = check_minimum(problem, best, seed=seed, jobs=jobs, work=budget.check)
        q, local, bound = bound_minimum(problem, q, local, seed=seed, jobs=jobs, progress=progress)
    if asked_of(task).any:
        from dualarm_pin.planners.apart import plan_apart

        apart = plan_apart(
            task,
            q,
            search.minima() if bound is None else [(problem.objective(q), q), *search.minima()],
            effort=effort,
            solver=name_of(solver),
            seed=seed,
            jobs=jobs,
            clock=clock,
            compile_s=compile_s,
            interrupted=interrupted,
            # The bound has time of its own: it is made before, since it may show a better path.
            deadline=begun + limit + (0.0 if bound is None else bound.seconds),
            progress=progress,
            given=further,
            alternatives=alternatives,
        )
        if apart is not None and apart.found and bound is not None:
            known = with_bound_without_clearance(apart, bound.shifted(free.constant))
            return replace(apart, evidence=known)
        if apart is not None:
            return apart
    if local is None:
        q, local = check_minimum(problem, q, seed=seed, jobs=jobs, work=budget.check)
    laws = count_laws(search.laws, q)
    from_earlier = any(same_path(q, end) for end in earlier) and not (
        found is not None and same_path(q, found)
    )
    findings = Findings(
        local=local,
        laws=laws,
        agree=sum(law.best_hits > 0 for law in laws.values()) >= min(2, len(laws)),
        bound=bound,
        searches=search.searches(problem.objective(q)),
    )
    answer = verified(
        task,
        free.whole(q),
        method="global",
        solver=name_of(solver),
        timing=clock.read(compile_s),
        seed=seed,
        evidence=conclude(findings.shifted(free.constant)),
        notes=GlobalNotes(effort, interrupted, None if warm is None else from_earlier),
    )

    def candidate(q: Array) -> Candidate:
        return q, lambda: (problem, polished(problem, q))

    others = [candidate(q) for _, q in search.minima()]
    return with_alternatives(task, answer, others, alternatives)


def polish(task: Task, q: Array, *, solver: Solver = ENGINE, seed: int | None = None) -> Trajectory:
    """Minimise (eq. 19) over all points from joints q (h, n); never worse than q.

    Args:
        task: What is asked.
        q: Joints (h, n).
        solver: What minimises it.
        seed: Seed from which q came, for the record.

    Returns:
        The minimum of the basin of q, or q itself if the solver did not do better.
    """
    problem = task.problem()
    clock = Clock.start()
    compile_s = engine.ensure_compiled() if solver is ENGINE else 0.0
    end = solve_one(solver, problem, q)
    better = end.feasible and end.objective <= problem.objective(q)
    return verified(
        task,
        end.q if better else q,
        method="polish",
        solver=name_of(solver),
        timing=clock.read(compile_s),
        seed=seed,
        notes=PolishNotes(improved=better),
    )


def _searched_until(task: Task, deadline: float) -> float:
    """Return until when to search, if all has to be done by a deadline (monotonic time [s])."""
    if not asked_of(task).any:
        return deadline
    task.cell.collision_meshes  # noqa: B018 - read now, so that it is known what time is left
    begun = time.monotonic()
    return begun + _SEARCHED * (deadline - begun)


def _until_ctrl_c(work: Callable[[], None]) -> bool:
    """Run `work`; return whether Ctrl-C cut it short."""
    try:
        work()
    except KeyboardInterrupt:
        return True
    return False


def _refine(search: Search, solver: Solver, starts: Sequence[Array]) -> None:
    """Add the minima of further starts (k, n) to what a search has found."""
    for start in starts:
        end = solve_one(solver, search.problem, start)
        if end.feasible:
            search.given.append((end.objective, end.q))


def _from_ends(free: FreePart, solver: Solver, jobs: int | None) -> Sequence[Array]:
    """Return the paths (k, n) that lead from postures that are given through all points."""
    ends = [(q, at) for q, at in ((free.before, 0), (free.after, -1)) if q is not None]
    if not ends or solver is not ENGINE:  # only the engine walks
        return []
    at = np.array([at for _, at in ends]) % free.problem.k
    walked = engine.walk_many(free.problem, np.array([q for q, _ in ends]), at, jobs=jobs)
    return list(walked.q[walked.reached])
