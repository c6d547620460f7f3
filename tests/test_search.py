"""Laws of starts and their workers: reproducible, complete, counted honestly."""

from __future__ import annotations

import os
import time

import numpy as np
import paper_case
import pytest

from dualarm_pin.errors import WorkerError
from dualarm_pin.evidence.laws import count_laws
from dualarm_pin.problem import Problem
from dualarm_pin.reference import coupling
from dualarm_pin.search.anchored import AnchoredLaw, anchor_points
from dualarm_pin.search.coarse import coarse_of
from dualarm_pin.search.starts import common_postures, generator
from dualarm_pin.search.whole_path import WholePathLaw
from dualarm_pin.search.workers import Workers
from dualarm_pin.solution import Solutions, same_path


@pytest.fixture(scope="module")
def problem() -> Problem:
    return paper_case.problem().subset(range(0, 31, 5), 3.0)


def test_starts_lie_within_bounds_and_depend_on_the_seed_alone() -> None:
    lower, upper = np.array([-1.0, 2.0]), np.array([1.0, 3.0])
    common = common_postures(lower, upper, 5, 50, generator(3, 1))
    assert common.shape == (50, 5, 2)
    assert np.ptp(common, axis=1).max() == 0.0
    assert np.all((common >= lower) & (common <= upper))
    np.testing.assert_array_equal(common, common_postures(lower, upper, 5, 50, generator(3, 1)))
    assert not np.array_equal(common, common_postures(lower, upper, 5, 50, generator(3, 2)))
    assert not np.array_equal(common, common_postures(lower, upper, 5, 50, generator(4, 1)))


@pytest.mark.parametrize(
    ("k", "points"), [(31, (0, 15, 30)), (2, (0, 1)), (1, (0,)), (3, (0, 1, 2))]
)
def test_anchors_are_first_middle_and_last(k: int, points: tuple[int, ...]) -> None:
    assert anchor_points(k) == points


def test_the_anchored_law_counts_every_posture_once(problem: Problem) -> None:
    search = AnchoredLaw(problem, seed=0)
    search.scout(40, 4, 2)
    drawn = search.drawn()
    assert drawn.starts == 3 * 40
    assert len(drawn.ends) == len(drawn.weight) == 2
    assert 0 < drawn.weight.sum() < drawn.starts
    search.grow(40)
    ends_alone = [anchor.alone for anchor in search.anchors]
    alone = sum(int((ends.converged & ~ends.saddle).sum()) for ends in ends_alone)
    # Every posture that reached its anchor leads somewhere.
    assert search.drawn().weight.sum() == alone


def test_growing_keeps_what_was_found_and_refines_nothing_twice(problem: Problem) -> None:
    search = AnchoredLaw(problem, seed=1)
    search.scout(20, 5, 3)
    first = search.drawn().ends
    search.scout(60, 10, 6)
    second = search.drawn().ends
    np.testing.assert_array_equal(second.q[: len(first)], first.q)
    assert len(first) == 3
    assert 3 < len(second) <= 6 + 3
    for anchor in search.anchors:
        for i, a in enumerate(anchor.seeds):
            assert not any(same_path(a.q, b.q) for b in anchor.seeds[:i])


def test_a_later_seed_in_a_refined_coarse_basin_has_its_path(problem: Problem) -> None:
    search = AnchoredLaw(problem, seed=1)
    search.scout(20, 5, 3)
    search.scout(60, 10, 6)
    search.scout(120, 30, 6)
    seeds = [seed for anchor in search.anchors for seed in anchor.seeds]
    joined = 0
    for a in seeds:
        for b in seeds:
            if a.coarse < b.coarse and same_path(
                search._screened.q[a.coarse], search._screened.q[b.coarse]
            ):
                assert search._path(a) == search._path(b)
                joined += search._path(a) is not None
    assert joined >= 3


def test_the_coarse_path_stands_for_the_whole() -> None:
    whole = paper_case.problem()
    coarse = coarse_of(whole)
    assert coarse.points[0] == 0
    assert coarse.points[-1] == 30
    assert coarse.problem.points.index_weight.sum() == pytest.approx(31)
    # A path that moves evenly costs the same in links, coarse or whole.
    ends = np.random.default_rng(0).uniform(-1, 1, (2, 12))
    even = np.linspace(ends[0], ends[1], 31)
    links = coupling(coarse.problem, even[coarse.points])[0]
    assert links == pytest.approx(coupling(whole, even)[0], rel=1e-9)
    np.testing.assert_allclose(coarse.start(even[coarse.points]), even, atol=1e-12)


def test_both_laws_are_counted_against_the_best(problem: Problem) -> None:
    anchored, whole = AnchoredLaw(problem, seed=0), WholePathLaw(problem, seed=0)
    anchored.grow(60)
    whole.grow(80)
    ends = whole.drawn().ends
    best = anchored.drawn().best
    laws = count_laws([anchored, whole], best)
    assert laws["whole path"].starts == 80
    assert laws["whole path"].converged == int(ends.converged.sum())
    assert laws["anchored"].best_hits >= 1
    by_hand = sum(same_path(q, best) for q in ends.q[ends.converged])
    assert laws["whole path"].best_hits == by_hand
    nowhere = count_laws([anchored, whole], best + 1.0)
    assert all(law.best_hits == 0 for law in nowhere.values())


def slow_square(x: int) -> int:
    time.sleep(0.02 * (5 - x))
    return x * x


def process_number(_: int) -> int:
    return os.getpid()


@pytest.mark.parametrize("jobs", [1, 2])
def test_results_come_in_the_order_of_the_calls(jobs: int) -> None:
    ended: list[int] = []
    with Workers(jobs) as workers:
        results = workers.run(slow_square, [(i,) for i in range(5)], ended.append)
    assert results == [0, 1, 4, 9, 16]
    assert sum(ended) == 5


def test_work_leaves_this_process_unless_it_cannot_be_sent() -> None:
    here = os.getpid()
    with Workers(2) as workers:
        assert here not in workers.run(process_number, [(0,), (1,)])
        local = workers.run(lambda i: os.getpid(), [(0,), (1,)])
    assert local == [here, here]


def fail(x: int) -> int:
    raise ValueError(f"bad {x}")


def test_an_error_in_a_worker_reaches_the_caller() -> None:
    with Workers(2) as workers, pytest.raises(ValueError, match="bad"):
        workers.run(fail, [(0,), (1,)])


def interrupt(x: int) -> int:
    if x == 2:
        raise KeyboardInterrupt
    return x


def test_ctrl_c_keeps_what_ended_and_stops_the_rest() -> None:
    with Workers(1) as workers:
        assert workers.run(interrupt, [(i,) for i in range(4)]) == [0, 1, None, None]
        assert workers.interrupted
        assert workers.run(interrupt, [(0,)]) == [None]


def die(x: int) -> int:
    os._exit(3)


def test_a_worker_that_dies_says_what_to_do() -> None:
    with Workers(2) as workers, pytest.raises(WorkerError, match="if __name__ == '__main__'"):
        workers.run(die, [(0,), (1,)])


def test_starts_that_ctrl_c_cut_off_are_not_counted(
    problem: Problem, monkeypatch: pytest.MonkeyPatch
) -> None:
    from dataclasses import replace

    from dualarm_pin.solvers import interior_point as engine

    solve_many = engine.solve_many

    def cut_off(*arguments: object, **options: object) -> Solutions:
        ends = solve_many(*arguments, **options)  # type: ignore[arg-type]
        half = np.arange(len(ends)) < len(ends) // 2
        residual = np.where(half, ends.residual, np.inf)
        ok = ends.converged & half
        return replace(ends, residual=residual, converged=ok, feasible=ok, interrupted=True)

    monkeypatch.setattr(engine, "solve_many", cut_off)
    whole, anchored = WholePathLaw(problem, seed=0), AnchoredLaw(problem, seed=0)
    with pytest.raises(KeyboardInterrupt):
        whole.grow(20)
    assert whole.drawn().starts == 10
    with pytest.raises(KeyboardInterrupt):
        anchored.scout(20, 3, 2)
    assert sum(anchor.starts for anchor in anchored.anchors) == 30
