"""Walks, full turns, the track law and hops: near a path, the same for any number of threads."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from paper_case import TASK

from dualarm_pin.problem import Problem
from dualarm_pin.reference import violation
from dualarm_pin.search.hops import Hops
from dualarm_pin.search.track import Round, TrackLaw
from dualarm_pin.search.turns import draw_postures, fold, wide_joints
from dualarm_pin.search.walk import walk
from dualarm_pin.task import Task

SMALL = Round(postures=40, minima=6)


@pytest.fixture(scope="module")
def round_of(problem: Problem) -> TrackLaw:
    law = TrackLaw(problem, seed=0, jobs=1)
    law.round(Round())
    return law


@pytest.fixture(scope="module")
def wide() -> Problem:
    """The paper's problem with joints that make two turns."""
    task = Task.load(TASK)
    joints = tuple(replace(j, lower=-6.28, upper=6.28) for j in task.cell.joints)
    lower, upper = np.full(12, -6.28), np.full(12, 6.28)
    assert all(joint.kind == "revolute" for joint in joints)
    return task.problem().with_bounds(lower, upper)


def test_a_round_finds_the_best_known_path(round_of: TrackLaw) -> None:
    drawn = round_of.drawn()
    assert drawn is not None
    assert drawn.ends.objective[drawn.ends.converged].min() == pytest.approx(12.730887, abs=1e-5)
    assert drawn.starts == 36
    assert round_of.work > 0


@pytest.mark.parametrize("points", [31, 61])
def test_the_same_seed_gives_the_same_ends_for_any_number_of_threads(points: int) -> None:
    third = (points - 1) // 3
    split = f"path.corner.points=[{third}, {points - 2 * third}, {third}]"
    problem = Task.load(TASK, [split, "two_stage={}"]).problem()
    ends = []
    for jobs in (1, 2):
        law, hops = TrackLaw(problem, seed=5, jobs=jobs), Hops(problem, seed=5, jobs=jobs)
        law.round(SMALL)
        drawn = law.drawn()
        assert drawn is not None
        assert drawn.ends.q.shape[1:] == (points, 12)
        hops.hop(drawn.ends)
        hops.hop(drawn.ends)
        assert hops.ends is not None
        ends.append((drawn.ends.q, hops.ends.q, law.work, hops.work))
    for one, two in zip(*ends, strict=True):
        np.testing.assert_array_equal(one, two)


def test_a_walk_follows_the_path_in_small_steps(problem: Problem, round_of: TrackLaw) -> None:
    drawn = round_of.drawn()
    assert drawn is not None
    best = drawn.best
    assert best is not None
    paths, work = walk(problem, [15, 0], best[[15, 0]], jobs=1)
    assert paths.shape == (2, 31, 12)
    np.testing.assert_array_equal(paths[[0, 1], [15, 0]], best[[15, 0]])
    for path in paths:
        assert violation(problem, path) < 1e-2  # near its poses: only a start of what is refined
        assert np.abs(np.diff(path, axis=0)).max() < 0.6
    assert 30 <= work <= 25 * 60


def test_full_turns_are_one_posture(wide: Problem) -> None:
    assert wide_joints(wide).all()
    q = np.random.default_rng(0).uniform(-1.0, 1.0, (4, 5, 12)) * 0.5
    turned = q + 2.0 * np.pi * np.random.default_rng(1).integers(-1, 2, (4, 1, 12)) * 0.9999
    inside = np.clip(turned, wide.lower, wide.upper)
    np.testing.assert_allclose(fold(wide, inside), q, atol=0.6)
    drawn = draw_postures(wide, 200, np.random.default_rng(2))
    assert np.abs(drawn).max() <= np.pi
    assert np.abs(drawn).max() > 3.0


def test_a_path_that_spans_too_much_stays(wide: Problem, problem: Problem) -> None:
    long = np.linspace(-6.2, 6.2, 5)[None, :, None] * np.ones(12)
    np.testing.assert_array_equal(fold(wide, long), long)
    q = np.random.default_rng(0).uniform(problem.lower, problem.upper, (3, 5, 12))
    np.testing.assert_array_equal(fold(problem, q), q)  # no joint here makes a full turn


def test_hops_never_lose_what_was_known(problem: Problem, round_of: TrackLaw) -> None:
    drawn = round_of.drawn()
    assert drawn is not None
    worse = drawn.ends.take(np.flatnonzero(drawn.ends.objective > 13.0))
    hops = Hops(problem, seed=1, jobs=2)
    for _ in range(6):
        hops.hop(worse)
    assert hops.ends is not None
    found = hops.ends.objective[hops.ends.converged].min()
    assert found < worse.objective[worse.converged].min()  # downhill from its own pool
