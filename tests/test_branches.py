"""Other branches of three joints in a row: the same pose of the tools, within the bounds."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import paper_case
import pytest

from dualarm_pin.chain import segments
from dualarm_pin.files.resources import urdf_folder
from dualarm_pin.problem import Problem
from dualarm_pin.search.branches import Branches
from dualarm_pin.task import Task


def between(problem: Problem, one: np.ndarray, other: np.ndarray) -> float:
    """Return how far the tools are from where they were [m and entries of the rotation]."""
    first, second = (segments(problem.chain, q)[-1].homogeneous for q in (one, other))
    return float(np.abs(first - second).max())


@pytest.fixture(scope="module")
def seven() -> Problem:
    """Two arms of seven joints whose shoulders have axes that meet, with room to turn."""
    problem = Task.load(urdf_folder() / "tasks" / "b04.yaml").problem()
    return replace(problem, lower=np.full(14, -7.0), upper=np.full(14, 7.0))


@pytest.mark.parametrize("element", [5, 8])
def test_a_shoulder_reaches_the_same_pose_the_other_way(seven: Problem, element: int) -> None:
    branches, random = Branches(seven), np.random.default_rng(0)
    assert element in branches.middles
    branches.middles = [element]
    for q in random.uniform(-3.0, 3.0, (5, 14)):
        other = branches.other(q, random)
        assert other is not None
        moved = np.flatnonzero(np.abs(other - q) > 1e-9)
        np.testing.assert_array_equal(moved, np.sort(seven.chain.source[element - 1 : element + 2]))
        assert np.abs(other - q).max() > 1.0
        assert between(seven, q, other) < 1e-4  # its files round pi


def test_three_parallel_joints_reach_the_same_pose_the_other_way() -> None:
    problem = Task.load(urdf_folder() / "tasks" / "b03.yaml").problem()
    branches, random = Branches(problem), np.random.default_rng(0)
    elbows = [e for e in branches.middles if e in (3, 8)]
    assert len(elbows) == 2
    for branches.middles in ([elbow] for elbow in elbows):
        for q in random.uniform(-2.0, 2.0, (5, 12)):
            other = branches.other(q, random)
            assert other is not None
            assert np.abs(other - q).max() > 1e-3
            assert between(problem, q, other) < 1e-4


def test_no_branch_leaves_the_bounds_and_a_far_one_is_none() -> None:
    problem = paper_case.problem()
    branches, random = Branches(problem), np.random.default_rng(1)
    drawn = random.uniform(problem.lower, problem.upper, (50, 12))
    others = [branches.other(q, random) for q in drawn]
    assert any(other is not None for other in others)
    for other in others:
        assert other is None or np.all((other >= problem.lower) & (other <= problem.upper))
    narrow = replace(problem, lower=np.full(12, -0.1), upper=np.full(12, 0.1))
    assert branches.middles
    assert all(Branches(narrow).other(np.full(12, 0.05), random) is None for _ in range(3))
