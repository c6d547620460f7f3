"""The whole path at once: search by two laws of starts, polish, evidence."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray

from dualarm_pin.answer.notes import GlobalNotes, PolishNotes
from dualarm_pin.answer.provenance import Clock
from dualarm_pin.answer.trajectory import Trajectory
from dualarm_pin.answer.verify import verified
from dualarm_pin.clearance.asked import asked_of
from dualarm_pin.evidence.laws import count_laws, laws_suffice
from dualarm_pin.planners.forbidden import forbidden
from dualarm_pin.planners.unreachable import unreachable
from dualarm_pin.problem import Problem
from dualarm_pin.progress import SILENT, Progress
from dualarm_pin.search.anchored import AnchoredLaw
from dualarm_pin.search.hops import Hops
from dualarm_pin.search.law import Drawn, Law
from dualarm_pin.search.track import Round, TrackLaw
from dualarm_pin.search.whole_path import WholePathLaw
from dualarm_pin.solution import Solutions
from dualarm_pin.solvers import interior_point as engine
from dualarm_pin.solvers.shipped import ENGINE
from dualarm_pin.solvers.solver import Solver, name_of, solve_one

if TYPE_CHECKING:
    from dualarm_pin.task import Task

Array = NDArray[np.float64]
Effort = Literal["quick", "normal", "thorough"]


@dataclass(frozen=True)
class Budget:
    """How far a search may go.

    Attributes:
        search: Work of rounds and hops while they are not settled, in seconds of a processor of
            5 microseconds a point and iteration of 12 joints; counted, never timed, so that the
            same seed gives the same answer.
        starts: Starts of each further law at least, 0 for none.
        most_starts: Starts of each of them at most, while the laws disagree.
        starts_work: Work of these starts after which no more are made, counted likewise.
        round: What a round draws and walks.
        scout: Postures an anchor, minima screened, paths refined by the anchored law in `quick`.
        bound: Compute the lower bound.
    """

    search: float = 0.8
    starts: int = 0
    most_starts: int = 0
    starts_work: float = 0.0
    round: Round = field(default_factory=Round)
    scout: tuple[int, int, int] = (250, 12, 3)
    bound: bool = False


BUDGETS: dict[str, Budget] = {
    "quick": Budget(),
    "normal": Budget(search=6.0, starts=300, most_starts=1500, starts_work=16.0),
    "thorough": Budget(search=20.0, starts=1000, most_starts=4000, starts_work=60.0, bound=True),
}
_STEP = 100  # starts of each law between two looks at what they say
_HOPS = 0.4  # share of the work that goes into hops
_SCOUTS = 4  # rounds of the anchors while they disagree; each doubles postures and refinements
_UNSEEN = 0.5  # with more singletons among the minima of single points, most were never seen


def plan_global(
    task: Task,
    *,
    effort: str = "normal",
    solver: Solver = ENGINE,
    starts: int | None = None,
    seed: int = 0,
    jobs: int | None = None,
    progress: Progress = SILENT,
) -> Trajectory:
    """Plan the whole path at once and say how good the answer is.

    Args:
        task: What is asked.
        effort: `quick` (walks, hops and check), `normal` (more of them, and starts by two further
            laws) or `thorough` (and the lower bound).
        solver: What takes each start to its minimum. The check and the bound have the compiled
            engine whatever this is.
        starts: Starts of each law; None takes those of the effort, growing while the laws
            disagree.
        seed: Seed of the starts: the same answer for any number of threads.
        jobs: Threads; None takes the processors there are.
        progress: Told where the work stands.

    Returns:
        The best path of all starts; after Ctrl-C the best so far. `found` is False where no
        start reached every point.
    """
    from dualarm_pin.evidence.check import check_minimum
    from dualarm_pin.evidence.verdict import Findings, conclude

    budget = BUDGETS[effort]
    if starts is not None:
        postures, screened, refined = budget.scout
        budget = replace(
            budget,
            starts=starts if budget.starts else 0,
            most_starts=starts,
            scout=(min(postures, starts), screened, refined),
            round=Round(postures=min(Round().postures, starts)),
        )
    problem = task.problem()
    clock = Clock.start()
    never = forbidden(task, "global", name_of(solver), seed, clock)
    if never is not None:
        return never
    compile_s = engine.ensure_compiled(progress.line)
    search = _Search(problem, budget, seed, jobs, solver, progress)
    interrupted = _until_ctrl_c(search.run)
    best = search.best()
    if best is None and interrupted:
        raise KeyboardInterrupt  # nothing is finished that could be kept
    if best is None:
        return unreachable(task, problem, "global", name_of(solver), seed, clock)
    ends = search.ends()
    if asked_of(task).any and ends is not None:
        from dualarm_pin.planners.apart import plan_apart

        apart = plan_apart(
            task,
            best,
            ends,
            effort=effort,
            solver=name_of(solver),
            seed=seed,
            jobs=jobs,
            clock=clock,
            compile_s=compile_s,
            interrupted=interrupted,
            progress=progress,
        )
        if apart is not None:
            return apart
    q, local = check_minimum(problem, best, seed=seed, jobs=jobs)
    bound = None
    if budget.bound and not interrupted:
        from dualarm_pin.evidence.bound import bound_minimum

        # The pieces may show a better path: then that is the answer, with counts of its own.
        q, local, bound = bound_minimum(problem, q, local, seed=seed, jobs=jobs, progress=progress)
    findings = Findings(
        local=local,
        laws=count_laws(search.laws, q),
        agree=search.agree(q),
        bound=bound,
    )
    return verified(
        task,
        q,
        method="global",
        solver=name_of(solver),
        timing=clock.read(compile_s),
        seed=seed,
        evidence=conclude(findings),
        notes=GlobalNotes(effort=effort, interrupted=interrupted),
    )


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


class _Search:
    """Walks and hops until they are settled, then starts by further laws that must agree."""

    def __init__(
        self,
        problem: Problem,
        budget: Budget,
        seed: int,
        jobs: int | None,
        solver: Solver,
        progress: Progress,
    ) -> None:
        self.problem, self.budget, self.progress = problem, budget, progress
        self.anchored = AnchoredLaw(problem, seed, jobs=jobs, solver=solver)
        self.starting: tuple[Law, ...] = (
            self.anchored,
            WholePathLaw(problem, seed, jobs=jobs, solver=solver),
        )
        self.laws: tuple[Law, ...] = self.starting
        self.track: TrackLaw | None = None
        self.hops = Hops(problem, seed, jobs=jobs)
        if solver is ENGINE:  # a walk needs fixed neighbours at every point
            self.track = TrackLaw(problem, seed, jobs=jobs)
            self.laws = (*self.starting, self.track)

    def run(self) -> None:
        """Search as far as the budget goes.

        Raises:
            KeyboardInterrupt: Ctrl-C; what was finished is kept.
        """
        self._walk_and_hop()
        target, step = min(_STEP, self.budget.starts), 0
        while target:
            step += 1
            self.progress.stage(f"{target} starts by each of two laws", len(self.starting))
            for law in self.starting:
                law.grow(target)
                self.progress.advance()
            best = self.best()
            spent = sum(self._work_of(law) for law in self.starting) * self._seconds
            if best is None or target >= self.budget.most_starts:
                break
            if spent > self.budget.starts_work:
                break
            enough = target >= self.budget.starts
            if enough and laws_suffice(count_laws(self.laws, best)):
                break
            target = min(target + _STEP, self.budget.most_starts)

    def _walk_and_hop(self) -> None:
        track, budget = self.track, self.budget
        if self._anchors_settle() or track is None:
            return
        self.progress.stage("paths walked from single points")
        while (track.work + self.hops.work) * self._seconds < budget.search:
            known = [drawn.ends for law in self.laws if (drawn := law.drawn()) is not None]
            if known and self.hops.work < _HOPS * (track.work + self.hops.work):
                self.hops.hop(Solutions.join(known))
            else:
                before = track.work
                track.round(budget.round)
                if track.work == before:
                    return  # no point of the path is reached alone
            self.progress.advance()

    def _anchors_settle(self) -> bool:
        """Tell whether the anchors' minima are mostly seen, and lead to one best path."""
        postures, screened, refined = self.budget.scout
        self.progress.stage("anchored starts", _SCOUTS)
        for level in range(_SCOUTS):
            self.anchored.scout(postures << level, screened << level, refined << level)
            self.progress.advance()
            if self.track is not None and self.anchored.unseen_share() > _UNSEEN:
                return False
            if self.anchored.agree():
                return True
        return False

    @property
    def _seconds(self) -> float:
        """Seconds a point and iteration, by the number of joints."""
        return 1e-6 * (1.9 + 0.023 * self.problem.n**2)

    def _work_of(self, law: Law) -> int:
        drawn = law.drawn()
        return 0 if drawn is None else int(drawn.ends.iterations.sum()) * self.problem.k

    def best(self) -> Array | None:
        """Return the best path (k, n) of all starts and hops so far."""
        ends = self.ends()
        return None if ends is None else Drawn(0, ends).best

    def ends(self) -> Solutions | None:
        """Return the ends of all starts and hops so far."""
        ends = [each.ends for law in self.laws if (each := law.drawn()) is not None]
        if self.hops.ends is not None:
            ends.append(self.hops.ends)
        return Solutions.join(ends) if ends else None

    def agree(self, q: Array) -> bool:
        """Tell whether two laws, or the only one, ended in the basin of q."""
        counts = count_laws(self.laws, q)
        return sum(law.best_hits > 0 for law in counts.values()) >= min(2, len(counts))


def _until_ctrl_c(work: Callable[[], None]) -> bool:
    """Run `work`; return whether Ctrl-C cut it short."""
    try:
        work()
    except KeyboardInterrupt:
        return True
    return False
