"""Answers to look at: the paper's task, and the three motions of `ns16_pair` checked against it."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
from ns16_pair import motions
from paper_case import task

from dualarm_pin.answer.evidence import Bound, Evidence, LawCount, LocalCheck
from dualarm_pin.answer.notes import GlobalNotes
from dualarm_pin.answer.provenance import Timing
from dualarm_pin.answer.trajectory import Distances, Trajectory
from dualarm_pin.answer.verify import verified

LOCAL = LocalCheck(
    objective=12.7308877,
    feasibility=1e-12,
    stationarity=1e-9,
    min_multiplier=0.0093,
    active_bounds=98,
    curvature_min=0.284,
    free_directions=88,
    sigma_min=0.21,
    return_radius=0.2,
    return_share=1.0,
    limit_cost={"arm1/joint_5": 22.1},
)
BOUND = Bound(12.7308, 12.7308877, (10, 20), (445,) * 3, (15, 6, 3), 5.0, {(10, 20): 12.7308})
EVIDENCE = Evidence(
    verdict="best_known_bounded",
    laws={"anchored": LawCount(300, 280, 46, 9), "whole path": LawCount(300, 290, 80, 4)},
    missed_share_95=0.005,
    laws_agree=True,
    stopping_rule="enough",
    stopping_rule_met=True,
    local=LOCAL,
    bound=BOUND,
    sentences="Best of\n 9 starts.",
)


@cache
def answers() -> dict[str, Trajectory]:
    """Return the three motions as answers `result 0` to `result 2`."""
    return {
        f"result {k}": verified(
            task(), q, method="global", solver="engine", timing=Timing(5.25, 9.5, 0.0), seed=0,
            evidence=EVIDENCE, notes=GlobalNotes("quick", False),
        )
        for k, (q, _) in enumerate(motions())
    }  # fmt: skip


def answer() -> Trajectory:
    return answers()["result 0"]


def changed(trajectory: Trajectory, **checked: Any) -> Trajectory:
    """Return an answer with other findings."""
    return replace(trajectory, checked=replace(trajectory.checked, **checked))


def near(distance: np.ndarray, first: str = "arm1/a", second: str = "arm2/b") -> Distances:
    return Distances(distance, ((first, second),) * len(distance))
