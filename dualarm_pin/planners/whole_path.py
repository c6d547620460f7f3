"""The whole path at once: search by two laws of starts, polish, evidence."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray

from dualarm_pin.answer.notes import GlobalNotes, PolishNotes
from dualarm_pin.answer.provenance import Clock
from dualarm_pin.answer.trajectory import Trajectory
from dualarm_pin.answer.verify import verified
from dualarm_pin.evidence.laws import count_laws, laws_suffice
from dualarm_pin.planners.unreachable import unreachable
from dualarm_pin.problem import Problem
from dualarm_pin.progress import SILENT, Progress
from dualarm_pin.search.anchored import AnchoredLaw
from dualarm_pin.search.law import Drawn
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
        postures: Postures an anchor in the first round; each round doubles them.
        screened: Minima of an anchor solved on the coarse path; each round doubles them.
        refinements: Distinct coarse minima refined on the whole path; each round doubles them.
        rounds: Most rounds while the anchors disagree.
        starts: Starts of each law, 0 for anchors alone.
        most_starts: Starts of each law at most, while the laws disagree.
        bound: Compute the lower bound.
    """

    postures: int = 250
    screened: int = 12
    refinements: int = 3
    rounds: int = 4
    starts: int = 0
    most_starts: int = 0
    bound: bool = False


BUDGETS: dict[str, Budget] = {
    "quick": Budget(),
    "normal": Budget(starts=300, most_starts=1500),
    "thorough": Budget(starts=1000, most_starts=4000, bound=True),
}


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
        effort: `quick` (anchors and check), `normal` (and starts by two laws) or `thorough` (and
            the lower bound).
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
        budget = replace(budget, starts=starts if budget.starts else 0, most_starts=starts)
        budget = replace(budget, postures=max(1, min(budget.postures, starts)))
    problem = task.problem()
    clock = Clock.start()
    compile_s = engine.ensure_compiled(progress.line)
    search = _Search(problem, budget, seed, jobs, solver, progress)
    interrupted = _until_ctrl_c(search.run)
    best = search.best()
    if best is None and interrupted:
        raise KeyboardInterrupt  # nothing is finished that could be kept
    if best is None:
        return unreachable(task, problem, "global", name_of(solver), seed, clock)
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
    """Both laws, as far as the budget goes."""

    def __init__(
        self,
        problem: Problem,
        budget: Budget,
        seed: int,
        jobs: int | None,
        solver: Solver,
        progress: Progress,
    ) -> None:
        self.budget, self.progress = budget, progress
        self.anchored = AnchoredLaw(problem, seed, jobs=jobs, solver=solver)
        self.laws = (self.anchored, WholePathLaw(problem, seed, jobs=jobs, solver=solver))

    def run(self) -> None:
        """Search until the anchors agree and, if asked, both laws have said enough."""
        budget = self.budget
        self.progress.stage("anchored starts", budget.rounds)
        for level in range(budget.rounds):
            self.anchored.scout(
                budget.postures << level, budget.screened << level, budget.refinements << level
            )
            self.progress.advance()
            if self.anchored.agree():
                break
        target = budget.starts
        while target:
            self.progress.stage(f"{target} starts by each of two laws", 2)
            for law in self.laws:
                law.grow(target)
                self.progress.advance()
            best = self.best()
            if best is None or target >= budget.most_starts:
                break
            if laws_suffice(count_laws(self.laws, best)):
                break
            target = min(target + budget.starts, budget.most_starts)

    def best(self) -> Array | None:
        """Return the best path (k, n) of all starts so far."""
        drawn = [each for law in self.laws if (each := law.drawn()) is not None]
        if not drawn:
            return None
        return Drawn(0, Solutions.join([each.ends for each in drawn])).best

    def agree(self, q: Array) -> bool:
        """Tell whether both laws ended in the basin of q."""
        return all(law.best_hits > 0 for law in count_laws(self.laws, q).values())


def _until_ctrl_c(work: Callable[[], None]) -> bool:
    """Run `work`; return whether Ctrl-C cut it short."""
    try:
        work()
    except KeyboardInterrupt:
        return True
    return False
