"""An independent search: tracks, hops and splices over a pool and with random numbers of its own.

It shares nothing with another one, so that two of them which end at one path speak for each other.
"""

from __future__ import annotations

from dualarm_pin.problem import Problem
from dualarm_pin.search.hops import Hops
from dualarm_pin.search.pool import Pool
from dualarm_pin.search.track import MUS, Round, TrackLaw
from dualarm_pin.search.work import Work

_HOPS = 0.5  # share of the work that goes into hops


class IndependentSearch:
    """Rounds of tracks and hops in turn.

    Attributes:
        pool: The best paths it met.
        track: Its law of starts.
        hops: Its moves.
        work: What it spent.
    """

    def __init__(
        self, problem: Problem, seed: int, *, number: int = 0, jobs: int | None = None
    ) -> None:
        self.pool, self.work = Pool(), Work(problem)
        self.track = TrackLaw(
            problem, seed, number=number, jobs=jobs, pool=self.pool, work=self.work
        )
        self.hops = Hops(problem, seed, self.pool, self.work, number=number, jobs=jobs)
        self._hopped = 0.0

    def step(self, how: Round | None = None) -> None:
        """Make a round, or a batch of hops, whichever has had less of the work; rounds first.

        Raises:
            KeyboardInterrupt: Ctrl-C; what was finished is kept.
        """
        enough = len(self.track.rounds) >= len(MUS)
        if self.pool.paths and enough and self._hopped < _HOPS * self.work.spent:
            before = self.work.spent
            self.hops.make()
            self._hopped += self.work.spent - before
        else:
            self.track.round(how)
