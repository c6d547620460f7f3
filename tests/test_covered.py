"""The search with capsules, and walks side by side: starts whose bodies are nearly apart."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from paper_case import TASK

from dualarm_pin.clearance import ClearanceRule
from dualarm_pin.clearance.asked import asked_of
from dualarm_pin.engine.solve import solve
from dualarm_pin.planners.whole_path import plan_global
from dualarm_pin.repair.basin import Basin
from dualarm_pin.repair.bodies import asked_pairs
from dualarm_pin.repair.covered import CoveredSearch, differing
from dualarm_pin.repair.fitted import fitted_path
from dualarm_pin.repair.meter import Meter, OverError
from dualarm_pin.repair.pool import Apart
from dualarm_pin.repair.repaired import Repaired
from dualarm_pin.repair.survey import Survey
from dualarm_pin.repair.walks import walked
from dualarm_pin.task import Task
from dualarm_pin.tolerance import TOLERANCE

Array = NDArray[np.float64]


@pytest.fixture(scope="module")
def task() -> Task:
    """The paper's task, its arms so far apart that no best path without that keeps it."""
    given = Task.load(TASK)
    arms = [pair for pair in given.cell.pairs if pair[0][:4] != pair[1][:4]]
    return replace(given, clearance=ClearanceRule(None, dict.fromkeys(dict.fromkeys(arms), 0.22)))


@pytest.fixture(scope="module")
def best(task: Task) -> Array:
    return plan_global(replace(task, clearance=None), effort="quick", jobs=1).q


def _survey(task: Task) -> Survey:
    return Survey(task.problem(), asked_pairs(task.cell, asked_of(task).required))


@pytest.fixture(scope="module")
def survey(task: Task) -> Survey:
    return _survey(task)


def test_what_capsules_lead_to_lacks_less_and_comes_apart_at_once(
    survey: Survey, best: Array
) -> None:
    search = CoveredSearch(survey, seed=0, jobs=1)
    lack = search.learn(best)
    assert lack > 0.02
    for _ in range(2):
        search.round(0.05)
    value, q, left = search.paths[0]
    assert value > survey.problem.objective(best)
    assert left < 0.5 * lack
    apart = Basin(survey, between=True).repaired(q)
    assert apart is not None
    assert apart.objective == pytest.approx(value, rel=0.1)


def test_the_same_seed_finds_the_same_paths_for_any_number_of_threads(
    task: Task, best: Array
) -> None:
    ends = []
    for jobs in (1, 2):
        search = CoveredSearch(_survey(task), seed=3, jobs=jobs)
        search.learn(best)
        search.round(0.05)
        ends.append(np.array([q for _, q, _ in search.paths]))
    np.testing.assert_array_equal(*ends)


def test_a_round_with_the_rows_of_the_last_goes_on_from_what_that_came_to(
    task: Task, best: Array
) -> None:
    search = CoveredSearch(_survey(task), seed=0, jobs=1)
    search.learn(best)
    values, rows = [], []
    for _ in range(4):
        search.round(0.05)
        values.append(search.paths[0][0])
        rows.append(search.rows)
    assert rows[-2] == rows[-3]
    assert values[-1] < 1.01 * values[-2]  # what is taken off a capsule is measured anew


def test_capsules_as_far_apart_as_the_bodies_mend_what_lacks_little(
    survey: Survey, best: Array
) -> None:
    before = survey.contacts(best, 0.0).worst
    assert before > 0.02
    path = fitted_path(survey, solve, best)
    values = []
    try:
        while True:
            values.append(next(path).value)
    except StopIteration as end:
        assert survey.contacts(end.value, 0.0).worst < 0.3 * before
    assert len(values) == 2
    apart = Basin(survey, between=True).repaired(best)
    assert apart is not None
    assert values[-1] == pytest.approx(apart.objective, rel=0.05)


def test_what_surely_keeps_enough_is_not_measured_anew(task: Task, best: Array) -> None:
    survey = _survey(task)
    first = survey.contacts(best, 0.2)
    moved = best + 3e-4 * np.sin(np.arange(best.size)).reshape(best.shape)
    measured: list[int] = []
    survey.meter.measured = lambda postures, pairs: measured.append(pairs)  # type: ignore[method-assign]
    again = survey.contacts(moved, 0.2, ample=1e-3)
    new = _survey(task).contacts(moved, 0.2)
    assert measured[0] < 0.7 * len(first.point)
    true = dict(zip(zip(new.point, new.pair, strict=True), new.distance, strict=True))
    known = dict(zip(zip(again.point, again.pair, strict=True), again.distance, strict=True))
    assert all(known[key] <= true[key] + 1e-9 for key in known.keys() & true.keys())
    lacking = {key for key, lack in zip(true, new.lack, strict=True) if lack > -1e-3}
    assert lacking
    assert all(known[key] == pytest.approx(true[key], abs=1e-6) for key in lacking)


def test_before_anything_lacks_no_pair_has_a_row(survey: Survey, best: Array) -> None:
    search = CoveredSearch(survey, seed=0, jobs=1)
    search.round(0.01)
    free = survey.problem.objective(best)
    assert search.paths[0][0] == pytest.approx(free, rel=0.05)  # a round without rows is free
    assert search.paths[0][2] > 0.0


def test_the_work_of_a_round_is_counted_and_ends_it(task: Task, best: Array) -> None:
    survey = _survey(task)
    search = CoveredSearch(survey, seed=0, jobs=1)
    search.learn(best)
    before = survey.meter.spent
    search.round(0.05)
    assert survey.meter.spent >= before + 0.05
    survey.meter = Meter(survey.problem, 0.01)
    with pytest.raises(OverError):
        search.round(10.0)


def test_a_cell_that_the_engine_has_not_seen_yet_is_compared_first() -> None:
    survey = _survey(Task.load(TASK, ["clearance=0.22"]))  # another solver may have searched
    problem = survey.problem
    search = CoveredSearch(survey, seed=0, jobs=1)
    lower, upper = problem.lower, problem.upper
    search.learn(np.random.default_rng(0).uniform(lower, upper, (problem.k, problem.n)))
    assert search.rows > 0
    search.round(0.01)
    assert search.paths


def test_of_twins_one_is_enough() -> None:
    q = np.zeros((2, 3))
    kept = differing([(1.0, q), (1.0005, q), (1.1, q), (1.1, q)])
    assert [value for value, _ in kept] == [1.0, 1.1]


def test_walks_side_by_side_go_where_each_goes_alone(survey: Survey, best: Array) -> None:
    anchors = [0, len(best) // 2, len(best) - 1]
    starts = best[anchors]
    together = walked(survey, anchors, starts)
    for at, start, path in zip(anchors, starts, together, strict=True):
        (alone,) = walked(survey, [at], start[None])
        np.testing.assert_allclose(path, alone, atol=1e-4)  # as far as each point is solved
        np.testing.assert_array_equal(path[at], start)
        assert np.abs(np.diff(path, axis=0)).max() < 1.0


def test_a_path_that_is_apart_is_shown_before_it_settles(survey: Survey, best: Array) -> None:
    shown: list[Repaired] = []
    steps = Basin(survey, between=True).steps(best)
    while True:
        try:
            standing = next(steps)
        except StopIteration as end:
            settled = end.value
            break
        if standing.found is not None:
            shown.append(standing.found)
    assert len(shown) == 1
    assert Basin(survey, between=True).keeps(shown[0].q)
    assert settled is not None
    assert settled.objective <= shown[0].objective
    apart = Apart()
    apart.take(shown[0])
    apart.take(settled)
    assert apart.found == [settled]  # one path, counted once


def test_a_jump_through_a_body_is_seen(survey: Survey, best: Array) -> None:
    search, random, k = CoveredSearch(survey, seed=0, jobs=1), np.random.default_rng(0), len(best)
    problem, need = survey.problem, TOLERANCE.clearance

    def lack(q: Array) -> float:
        return survey.contacts(q[None], 0.0).worst

    for _ in range(1000):
        one, other = random.uniform(problem.lower, problem.upper, (2, problem.n))
        if max(lack(one), lack(other)) < need and lack(0.5 * (one + other)) > 0.1:
            break
    stays, jumps = np.tile(one, (k, 1)), np.tile(one, (k, 1))
    jumps[k // 2 :] = other
    assert search.learn(stays) < need
    assert search.learn(jumps) > 0.1
