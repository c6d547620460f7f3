"""One path, moved until its bodies are far enough apart.

Rounds of witness rows: measure, hold the nearest points apart along the line between them, solve
again from there. Out of a deep collision, where the nearest points jump, capsules lead first; how
much their radii are reduced decides on which side the bodies pass each other.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from dualarm_pin.arrays import Array
from dualarm_pin.engine.solve import Options, solve
from dualarm_pin.problem import Problem
from dualarm_pin.repair.contacts import Contacts
from dualarm_pin.repair.dips import ENOUGH, add_dips, inner_postures, with_room
from dualarm_pin.repair.fitted import fitted_path
from dualarm_pin.repair.repaired import Repaired, Standing, Steps, ended
from dualarm_pin.repair.survey import Survey
from dualarm_pin.repair.witness import (
    AMPLE,
    BACK_OFF,
    FIRST_BACK_OFF,
    REACH,
    asked_apart,
    cuts,
    on_planes,
    witness_table,
)
from dualarm_pin.solution import Solution
from dualarm_pin.tolerance import TOLERANCE

_ROUNDS, _MORE_ROUNDS = 16, 6  # of witness rows; of postures between the points
_PATIENCE, _PROGRESS = 3, 0.8  # rounds in which the worst lack must shrink to this share
_CUTS = 4  # solves with the same planes, each with the corners that the last brought through them
_SLIP, _HALVINGS = 0.02, 2  # m: rows are made anew before bodies are deeper in each other
_WILD = 10.0  # times the objective: a solve that ends there is lost, and no corner helps
_STILL = 5e-3  # rad or m: less movement is no reason for another round
_ITERATIONS = 60  # of a solve
_SMALL = 5e-3  # m: a lack that a few rounds may still take away
_SETTLED = 2e-3  # of the objective: less change is no reason for another round
_MU = 1e-3  # a start is nearly the answer
_LAZY, _LAZY_REACH = 4, 0.2  # solves with more capsules each; m: nearer ones are in the first
_LED_MU = 1e-2  # capsules move it far


class Basin:
    """Moves paths of a survey's problem.

    Attributes:
        survey: What measures.
        between: Whether the postures between the points count too.
        settle: Whether rounds go on after the first path that is apart, while they still gain.
    """

    def __init__(self, survey: Survey, *, between: bool, settle: bool = True) -> None:
        self.survey, self.between, self.settle = survey, between, settle

    def keeps(self, q: Array) -> bool:
        """Tell whether the bodies of a path (k, n) are far enough apart as it is."""
        for postures in (q, inner_postures(q)) if self.between else (q,):
            found = self.survey.contacts(postures, 0.0, enough=TOLERANCE.clearance)
            if not found.kept.all():
                return False
        return True

    def repaired(
        self,
        q: Array,
        reduction: float | None = None,
        limit: float = np.inf,
        *,
        margin: float = 0.0,
    ) -> Repaired | None:
        """Return where a path (k, n) leads, or None where its bodies do not come apart.

        Args:
            q: A path, nearly a minimum of the problem without rows of pairs.
            reduction: Of the capsules that lead [m]; None for witness rows alone.
            limit: Objective above which nothing is looked for.
            margin: Asked of bodies of different arms at first, beyond what is required [m].
        """
        return ended(self.steps(q, reduction, limit, margin=margin))

    def steps(
        self,
        q: Array,
        reduction: float | None = None,
        limit: float = np.inf,
        *,
        margin: float = 0.0,
        fitted: bool = False,
    ) -> Steps:
        """Yield where a path stands after each round, and return what `repaired` does.

        Args:
            q: As of `repaired`.
            reduction: As of `repaired`.
            limit: As of `repaired`.
            margin: As of `repaired`.
            fitted: Capsules that are as far apart as the bodies hold the path first.
        """
        if margin > 0.0:
            more = np.zeros((len(self.survey.pairs.number), len(q)))
            more[self.survey.pairs.loose] = margin
            wider = yield from self._apart(q, more, np.inf, self.settle)
            if wider is None:
                return None
            q = wider.q
        if reduction is not None:
            q = self._led(q, reduction)
        if fitted:
            q = yield from fitted_path(
                self.survey, lambda problem, q: self._solved(problem, q, _MU), q
            )
        nothing = np.zeros((len(self.survey.pairs.number), len(q)))
        return (yield from self._kept(q, nothing, limit))

    def roomier(self, path: Repaired, pair: int, line: int, lack: float) -> Repaired | None:
        """Return where a path leads with more room for a pair on the line after a point.

        Args:
            path: The path.
            pair: Which.
            line: After which point; before the first one for -1.
            lack: What is missing there [m].
        """
        extra = with_room(path.extra, pair, line, lack)
        return ended(self._kept(path.q, extra, np.inf))

    def settled(self, path: Repaired) -> Steps:
        """Yield where a path that is apart stands while its objective comes down."""
        return self._kept(path.q, path.extra.copy(), np.inf)

    def _kept(self, q: Array, extra: Array, limit: float) -> Steps:
        """Return the end of rounds at the points and then between them; `extra` is changed.

        The first path that is apart is yielded; what follows may bring its objective down.
        """
        found = yield from self._clear(q, extra, limit, settle=False)
        if found is None or not self.settle:
            return found
        yield Standing(found.objective, 0.0, True, found)
        settled = yield from self._clear(found.q, extra, limit, settle=True)
        if settled is None or settled.objective > found.objective:
            return found
        return replace(settled, before=found)

    def _clear(self, q: Array, extra: Array, limit: float, *, settle: bool) -> Steps:
        """Return the end of rounds at the points, then with more room where bodies dip between."""
        found = yield from self._apart(q, extra, limit, settle)
        if not self.between:
            return found
        for _ in range(_MORE_ROUNDS):
            if found is None or add_dips(self.survey, found.q, extra) <= ENOUGH:
                return found
            found = yield from self._apart(found.q, extra, limit, settle)
        return None

    def _apart(self, q: Array, extra: Array, limit: float, settle: bool) -> Steps:
        """Return the end of rounds of witness rows, `extra` (p, k) asked beyond what is [m]."""
        best: Repaired | None = None
        lacks: list[float] = []
        vain = 0
        contacts = self.survey.contacts(q, REACH, extra, ample=AMPLE)
        corners = contacts.take(np.zeros(0, dtype=np.int64))
        for _ in range(_ROUNDS):
            lacks.append(contacts.worst)
            if best is None and _hopeless(lacks):
                break
            back_off = BACK_OFF if settle or best is not None else FIRST_BACK_OFF
            path, value, found, corners = self._round(q, contacts, corners, extra, limit, back_off)
            if path is None:
                break
            moved = float(np.abs(path.q - q).max())
            q, contacts = path.q, found
            kept = bool(contacts.kept.all())
            vain = vain + 1 if kept and not np.isfinite(path.objective) else 0
            if vain == _PATIENCE:  # apart, but no joints are on the path and hold that
                break
            yield Standing(value, contacts.worst, kept and not vain)
            if kept and not vain:
                settled = best is not None and path.objective > (1.0 - _SETTLED) * best.objective
                if best is None or path.objective < best.objective:
                    best = path
                if settled or moved < _STILL or not settle:
                    break
        return best

    def _round(
        self,
        q: Array,
        contacts: Contacts,
        corners: Contacts,
        extra: Array,
        limit: float,
        back_off: float,
    ) -> tuple[Repaired | None, float, Contacts, Contacts]:
        """Solve from q with planes made for q, until they hold all that the solve brings near.

        Returns:
            Where it ends, or less far where bodies then collide more than before (with an infinite
            objective), the objective that the last solve came to, the contacts there, and the
            corners that had to be held beside the nearest points; no path where none below the
            limit can come of it.
        """
        survey, start, many = self.survey, q, len(self.survey.pairs.number)
        held = contacts.joined(on_planes(corners, contacts, many))
        most = max(contacts.worst, TOLERANCE.clearance)
        wild = _WILD * max(_value(survey.problem, q), survey.problem.size)
        for _ in range(_CUTS):
            apart = asked_apart(held, back_off)
            problem = survey.problem.with_pairs(witness_table(survey, held, apart, len(q)))
            end = self._solved(problem, start, _MU)
            if end.feasible and end.objective > limit:
                return None, end.objective, contacts, corners
            found = survey.contacts(end.q, REACH, extra, ample=AMPLE)
            if found.worst <= most:
                value = end.objective if end.feasible else np.inf
                path = Repaired(end.q, value, problem, held, apart, extra.copy())
                return path, end.objective, found, corners
            if end.objective > wild and not end.feasible:
                break
            feet, others = cuts(survey, held, end.q, found.take(found.lack > 0.0))
            corners, held, start = corners.joined(feet), held.joined(feet).joined(others), end.q
        at = end.q
        for _ in range(_HALVINGS):
            at = (q + at) / 2.0
            found = survey.contacts(at, REACH, extra, ample=AMPLE)
            if found.worst <= max(most, _SLIP):
                break
        path = Repaired(at, np.inf, problem, held, apart, extra.copy())
        return path, end.objective, found, corners

    def _led(self, q: Array, reduction: float) -> Array:
        """Return where capsules with reduced radii lead a path; rows are added as they are met."""
        survey = self.survey
        reduced = np.minimum(survey.pairs.radius.sum(axis=1), reduction)
        active = np.zeros((len(q), len(reduced)), dtype=bool)
        for _ in range(_LAZY):
            gap = survey.capsule_gaps(q) + reduced
            met = (gap < (0.0 if active.any() else _LAZY_REACH)) & survey.pairs.tight & ~active
            if not met.any():
                break
            active |= met
            problem = survey.problem.with_pairs(survey.capsule_table(active, reduced))
            q = self._solved(problem, q, _LED_MU).q
        return q

    def _solved(self, problem: Problem, q: Array, mu0: float) -> Solution:
        end = solve(problem, q, Options(TOLERANCE.search, _ITERATIONS, mu0, mu0))
        rows = int(problem.inequalities.size.sum())
        self.survey.meter.solved(end.iterations, problem.k, rows)
        return end


def _value(problem: Problem, q: Array) -> float:
    """Return the objective of a path, by the engine."""
    return solve(problem, q, Options(iterations=0, push=TOLERANCE.no_length)).objective


def _hopeless(lacks: list[float]) -> bool:
    """Tell whether the rounds have stopped to bring the bodies apart.

    A start that the first solve leaves far behind is no measure of them.
    """
    if len(lacks) > 1 and lacks[0] < lacks[1]:
        lacks = lacks[1:]
    if len(lacks) <= _PATIENCE:
        return False
    first = max(min(lacks[:-_PATIENCE]), _SMALL)
    return min(lacks[-_PATIENCE:]) > _PROGRESS * first
