"""Alternatives of the whole path: the best minima that differ in posture, each an answer."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from dualarm_pin.answer.alternatives import kept
from dualarm_pin.answer.evidence import Evidence
from dualarm_pin.answer.provenance import Clock
from dualarm_pin.answer.trajectory import Trajectory
from dualarm_pin.answer.verify import verified
from dualarm_pin.arrays import Array
from dualarm_pin.evidence.check import check_held
from dualarm_pin.evidence.verdict import Findings, conclude
from dualarm_pin.problem import Problem

if TYPE_CHECKING:
    from dualarm_pin.task import Task

Candidate = tuple[Array, Callable[[], tuple[Problem, Array]]]
"""Free postures (k, n) of a path, and what polishes them: the problem that holds them, and them."""
_SAID = "Another posture than the best answer: one of the minima that its search came to."


def with_alternatives(
    task: Task, best: Trajectory, candidates: Sequence[Candidate], count: int
) -> Trajectory:
    """Return an answer with further ones beside it.

    Args:
        task: What was asked.
        best: The answer.
        candidates: Paths that the search came to, best first.
        count: How many answers there shall be, the best among them; fewer where fewer are found.
    """
    if count < 2 or not best.found:
        return best
    free = task.free()

    def answer(polished: Callable[[], tuple[Problem, Array]]) -> Trajectory:
        clock = Clock.start()
        problem, q = polished()
        return verified(
            task,
            free.whole(q),
            method=best.method,
            solver=best.solver,
            seed=best.seed,
            evidence=local_evidence(problem, q, _SAID, free.constant),
            timing=clock.read(),
            notes=best.notes,
        )

    made = ((free.whole(q), lambda polish=polish: answer(polish)) for q, polish in candidates)
    return replace(best, alternatives=kept(best, made, count, task.cell.joints))


def local_evidence(problem: Problem, q: Array, first: str, constant: float = 0.0) -> Evidence:
    """Return what is known of a path by its neighbourhood alone, without trying starts nearby.

    Args:
        problem: The problem with the rows that hold the path.
        q: Its free postures (k, n).
        first: The first sentence: where it comes from.
        constant: What given postures add to the objective.
    """
    findings = Findings(local=check_held(problem, q)).shifted(constant)
    evidence = conclude(findings)
    _, *rest = evidence.sentences.split("\n")
    return replace(evidence, sentences="\n".join([first, *rest]))
