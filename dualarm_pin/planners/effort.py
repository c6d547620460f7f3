"""How much work an effort is, and what a search does with it.

Independent searches (`search.independent`) take turns until they agree or the budget is spent; then
further laws of starts speak for the best path or against it. Work is counted, not measured (see
`search.work`), so that a seed gives the same answer for any number of threads; only a time limit
looks at the clock.
"""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dualarm_pin.answer.evidence import LEAST_SEARCHES, Searches
from dualarm_pin.evidence.laws import count_laws, laws_suffice
from dualarm_pin.problem import Problem
from dualarm_pin.progress import Progress
from dualarm_pin.search.anchored import AnchoredLaw
from dualarm_pin.search.hops import Hops
from dualarm_pin.search.independent import IndependentSearch
from dualarm_pin.search.law import Counted, Drawn, Joined, Law
from dualarm_pin.search.track import Round
from dualarm_pin.search.whole_path import WholePathLaw
from dualarm_pin.search.work import Work
from dualarm_pin.solution import Solutions, distinct
from dualarm_pin.solvers.shipped import InteriorPoint
from dualarm_pin.solvers.solver import Solver
from dualarm_pin.tolerance import TOLERANCE

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Budget:
    """How far a search may go, in seconds of a usual processor, as `Work` counts them.

    Attributes:
        work: Of the independent searches together.
        searches: How many of them.
        joint: Of hops between the paths of all of them, where they do not agree.
        starts_work: Of starts by further laws.
        starts: Starts of each further law at most; 0 for none.
        check: Of the nearby starts that the check makes for each shift.
        bound: Compute the lower bound, which has a budget of its own.
    """

    work: float
    searches: int = 1
    joint: float = 0.0
    starts_work: float = 0.0
    starts: int = 0
    check: float = 0.1
    bound: bool = False


BUDGETS: dict[str, Budget] = {
    "quick": Budget(1.4, check=0.06),
    "normal": Budget(19.0, 8, 5.0, 2.5, 300, 0.4),
    "thorough": Budget(48.0, 12, 6.0, 12.0, 1000, 1.0, bound=True),
}
_PARTS = 100  # of the work, as progress counts it
_LEAST = 0.15  # share of its work that a search does before its agreement with others counts
_STEP = 50  # starts of each further law between two looks
_LONGEST = 150  # iterations of a start: so many are expected until the first were made
_UNSEEN = 0.5  # with more singletons among the minima of single points, most were never seen
_BEYOND = 1.2  # a step like the last one that would end beyond this share is not begun
_LOST = 3  # rounds that came to no path, after which walks are given up
# Of the anchored law: postures, minima screened, paths refined; rounds where no search walks.
_SCOUT, _SCOUTS = (250, 12, 3), 4
_FIRST, _SMALL = Round(80, 8, 10, 4, 3), (80, 8, 2)  # enough where single points have few minima


class Search:
    """All that is done for one path.

    Attributes:
        cut: Whether the time limit ended it.
        given: Objective and path of minima that another search, or a given posture, led to.
    """

    def __init__(
        self,
        problem: Problem,
        budget: Budget,
        seed: int,
        *,
        jobs: int | None,
        solver: Solver,
        progress: Progress,
        starts: int | None = None,
        deadline: float = np.inf,
    ) -> None:
        self.problem, self.budget, self.progress = problem, budget, progress
        self.given: list[tuple[float, Array]] = []
        self.deadline, self.cut, self._told = deadline, False, 0
        self._starts = budget.starts if starts is None or not budget.starts else starts
        self._postures = starts
        self.further: tuple[AnchoredLaw, WholePathLaw] = (
            AnchoredLaw(problem, seed, jobs=jobs, solver=solver),
            WholePathLaw(problem, seed, jobs=jobs, solver=solver),
        )
        self.independent: list[IndependentSearch] = []
        if isinstance(solver, InteriorPoint):  # only the engine walks
            self.independent = [
                IndependentSearch(problem, seed, number=number, jobs=jobs)
                for number in range(budget.searches)
            ]
        self._work = Work(problem)
        self._seed, self._jobs = seed, jobs
        self._joint: Hops | None = None

    def run(self) -> None:
        """Search until what was found is settled, the budget is spent, or the time is up.

        Raises:
            KeyboardInterrupt: Ctrl-C; what was finished is kept.
        """
        self.progress.stage("search", _PARTS)
        self._search()
        if not self.independent or self.best() is None:
            self._scout()
        if self.best() is None:
            return
        if len(self.independent) > 1 and not self._agree():
            self._hop_between()
        self._further_starts()

    @property
    def laws(self) -> list[Counted]:
        """What drew starts."""
        tracks = [Joined([each.track for each in self.independent])] if self.independent else []
        return [*tracks, *self.further]

    def best(self) -> Array | None:
        """Return the best path (k, n) of all starts and hops so far."""
        pools = [each.pool for each in self.independent]
        pools += [self._joint.pool] if self._joint is not None else []
        known = [(pool.best, pool.paths[0]) for pool in pools if pool.paths] + self.given
        value, q = min(known, key=lambda one: one[0], default=(np.inf, None))
        drawn = [each.ends for law in self.laws if (each := law.drawn()) is not None]
        start = Drawn(0, Solutions.join(drawn)).best if drawn else None
        if start is None or (q is not None and value <= self.problem.objective(start)):
            return q
        return start

    def minima(self) -> list[tuple[float, Array]]:
        """Return objective and path of all that was found, the best first."""
        pools = [each.pool for each in self.independent]
        pools += [self._joint.pool] if self._joint is not None else []
        found = [pair for p in pools for pair in zip(p.objectives, p.paths, strict=True)]
        found += self.given
        for law in self.further:
            drawn = law.drawn()
            if drawn is not None:
                ends = distinct(drawn.ends).ends
                found += zip(ends.objective.tolist(), ends.q, strict=True)
        return sorted(found, key=lambda pair: pair[0])

    def searches(self, objective: float) -> Searches | None:
        """Return what the independent searches came to, or the rounds of the only one."""
        if not self.independent:
            return None
        hops = sum(each.hops.made for each in self.independent)
        hops += 0 if self._joint is None else self._joint.made
        if len(self.independent) > 1:
            lowest = tuple(each.pool.best for each in self.independent)
            return Searches("searches", lowest, objective, hops)
        return Searches("rounds", tuple(self.independent[0].track.rounds), objective, hops)

    def _search(self) -> None:
        share, last = self.budget.work / max(1, len(self.independent)), 0.0
        while self.independent and self._goes_on():
            one = min(self.independent, key=lambda each: each.work.spent)
            if one.work.spent >= share:
                return
            lost = not one.pool.paths and len(one.track.rounds) >= _LOST
            if lost or not one.track.reachable:
                return
            if one.pool.paths and one.work.spent + last > _BEYOND * share:
                return  # on a long path one step may be most of the work
            few = len(self.independent) == 1 and not one.track.rounds
            before = one.work.spent
            one.step(_FIRST if few else None)
            last = one.work.spent - before
            if self._settled():
                return

    def _settled(self) -> bool:
        if len(self.independent) > 1:
            least = _LEAST * self.budget.work / len(self.independent)
            return self._agree() and all(each.work.spent >= least for each in self.independent)
        one = self.independent[0]
        if len(one.track.rounds) > 1 or one.track.unseen > _UNSEEN:
            return False
        # Few minima of single points: another law shows whether they lead to one best path.
        self._scout()
        drawn = self.further[0].drawn()
        best = None if drawn is None else drawn.best
        return best is not None and _same(self.problem.objective(best), one.pool.best)

    def _agree(self) -> bool:
        """Tell whether enough searches end at one value: all at first, half of them at the end.

        Searches that still improve disagree; where all are at one value early it is the best one
        that this kind of search finds, where most are there late the others are stuck.
        """
        best = [each.pool.best for each in self.independent]
        if not best or not np.isfinite(min(best)):
            return False
        spent = sum(each.work.spent for each in self.independent) / self.budget.work
        there = sum(_same(value, min(best)) for value in best)
        return there >= max(LEAST_SEARCHES, (1.0 - 0.5 * min(1.0, spent)) * len(best))

    def _scout(self) -> None:
        """Anchors alone, while they disagree: each time with twice the postures."""
        postures, screened, refined = _SMALL if self.independent else _SCOUT
        anchored = self.further[0]
        most = postures if self._postures is None else min(postures, self._postures)
        for level in range(_SCOUTS if not self.independent else 1):
            if not self._goes_on():
                return
            anchored.scout(most << level, screened << level, refined << level)
            if anchored.agree():
                return

    def _hop_between(self) -> None:
        """Hop and splice over the paths of all searches."""
        pool = self.independent[0].pool.merged([each.pool for each in self.independent[1:]])
        self._joint = Hops(
            self.problem,
            self._seed,
            pool,
            self._work,
            number=len(self.independent),
            jobs=self._jobs,
        )
        while self._work.spent < self.budget.joint and self._goes_on():
            before = self._work.spent
            self._joint.make()
            if self._work.spent == before:
                return

    def _further_starts(self) -> None:
        """Make starts of the further laws until they have said enough or cost too much."""
        target, spent, seconds = 0, 0.0, Work(self.problem).seconds(self.problem.k)
        each = (1 + len(self.further[0].anchors)) * _LONGEST * seconds
        while target < self._starts and self._goes_on():
            step = min(_STEP, self._starts - target, int((self.budget.starts_work - spent) / each))
            if step < 1:
                return
            target += step
            for law in self.further:
                law.grow(target)
            spent = seconds * sum(_iterations(law) for law in self.further)
            each = max(spent / target, seconds)
            best = self.best()
            if best is None or laws_suffice(count_laws(self.laws, best)):
                return

    def _goes_on(self) -> bool:
        spent = sum(each.work.spent for each in self.independent)
        done = int(_PARTS * min(1.0, spent / self.budget.work))
        self.progress.advance(done - self._told)
        self._told = done
        best = min((each.pool.best for each in self.independent), default=np.inf)
        if np.isfinite(best):
            self.progress.note(f"best so far {best:.6g}")
        begun = spent > 0.0 or self.further[0].drawn() is not None  # one step is made in any case
        self.cut = self.cut or (begun and time.monotonic() > self.deadline)
        return not self.cut


def _iterations(law: Law) -> int:
    drawn = law.drawn()
    return 0 if drawn is None else int(drawn.ends.iterations.sum())


def _same(one: float, other: float) -> bool:
    """Tell whether two objectives are one, before they are polished."""
    return abs(one - other) <= 10.0 * TOLERANCE.same_objective * max(1.0, abs(other))
