"""Walks, full turns, the track law and hops: near a path, the same for any number of threads."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from paper_case import TASK

from dualarm_pin.engine.solve import Options
from dualarm_pin.errors import InputError
from dualarm_pin.problem import Problem
from dualarm_pin.reference import violation
from dualarm_pin.search.coarse import coarse_of
from dualarm_pin.search.hops import Hops
from dualarm_pin.search.independent import IndependentSearch
from dualarm_pin.search.pool import Pool
from dualarm_pin.search.shares import Shares
from dualarm_pin.search.splice import splices
from dualarm_pin.search.sweep import Sweeps
from dualarm_pin.search.track import Round, TrackLaw
from dualarm_pin.search.transfer import Transfers
from dualarm_pin.search.turns import Turns
from dualarm_pin.search.work import Work
from dualarm_pin.solvers import interior_point as engine
from dualarm_pin.task import Task


@pytest.fixture(scope="module")
def round_of(problem: Problem) -> TrackLaw:
    law = TrackLaw(problem, seed=0, jobs=1)
    law.round()
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
    assert drawn.starts == 3 * Round().postures
    assert round_of.rounds == [round_of.pool.best]
    assert 0.0 < round_of.unseen < 0.5
    assert round_of.work.spent > 0.0


@pytest.mark.parametrize("points", [31, 61])
def test_the_same_seed_gives_the_same_pool_for_any_number_of_threads(points: int) -> None:
    third = (points - 1) // 3
    split = f"path.corner.points=[{third}, {points - 2 * third}, {third}]"
    problem = Task.load(TASK, [split, "two_stage={}"]).problem()
    pools, spent = [], []
    for jobs in (1, 2):
        search = IndependentSearch(problem, seed=5, jobs=jobs)
        for _ in range(5):
            search.step()
        assert search.hops.made > 0
        pools.append(search.pool)
        spent.append(search.work.spent)
    assert spent[0] == spent[1]
    np.testing.assert_array_equal(pools[0].paths, pools[1].paths)
    assert pools[0].paths[0].shape == (points, 12)


def test_searches_of_one_seed_share_no_random_numbers(problem: Problem) -> None:
    one, other = (IndependentSearch(problem, seed=0, number=number, jobs=1) for number in (0, 1))
    one.step(Round(postures=20))
    other.step(Round(postures=20))
    assert not np.array_equal(one.pool.objectives, other.pool.objectives)


def test_a_walk_follows_the_path_in_small_steps(problem: Problem, round_of: TrackLaw) -> None:
    best = round_of.pool.paths[0]
    walked = engine.walk_many(problem, best[[15, 0]], [15, 0], jobs=1)
    assert walked.q.shape == (2, 31, 12)
    assert walked.reached.all()
    np.testing.assert_array_equal(walked.q[[0, 1], [15, 0]], best[[15, 0]])
    for path in walked.q:
        assert violation(problem, path) < 1e-2  # near its poses: only a start of what is refined
        assert np.abs(np.diff(path, axis=0)).max() < 0.6
    assert 30 <= walked.steps <= 25 * 60


def test_a_walk_stays_in_its_window_and_stops_where_it_is_lost(
    problem: Problem, round_of: TrackLaw
) -> None:
    best = round_of.pool.paths[0]
    window = engine.walk_many(problem, best[[12]], [12], first=10, points=5, scale=10.0, jobs=1)
    assert window.q.shape == (1, 5, 12)
    assert violation(problem.window(10, 5), window.q[0]) < 1e-2
    far = problem.with_points(position=problem.points.position + np.array([0, 0, 9]))
    lost = engine.walk_many(far, best[[15]], [15], jobs=1)
    assert not lost.reached.any()
    with pytest.raises(InputError, match="leaves the path"):
        engine.walk_many(problem, best[[12]], [12], first=28, points=5)


def test_a_start_above_its_limit_is_dropped_and_no_other(
    problem: Problem, round_of: TrackLaw
) -> None:
    q = np.array([round_of.pool.paths[0]] * 2)
    q += np.random.default_rng(0).normal(scale=0.05, size=q.shape)
    best = round_of.pool.best
    ends = engine.solve_many(problem, q, limit=[best + 1e-3, -1e9], jobs=1)
    assert ends.converged.tolist() == [True, False]
    assert ends[1].message == "dropped"
    assert ends.iterations[1] < ends.iterations[0]


def test_full_turns_are_one_posture(wide: Problem) -> None:
    turns = Turns(wide)
    assert turns.wide.all()
    q = np.random.default_rng(0).uniform(-0.5, 0.5, (4, 5, 12))
    turned = q + 2.0 * np.pi * np.random.default_rng(1).integers(-1, 2, (4, 1, 12))
    np.testing.assert_allclose(turns.folded(turned), q, atol=1e-12)
    assert np.all(turns.upper - turns.lower < 2.0 * np.pi + 1e-12)
    assert np.all(turns.widened(wide).upper > wide.upper + 6.0)


def test_joints_that_make_no_full_turn_stay(problem: Problem) -> None:
    q = np.random.default_rng(0).uniform(problem.lower, problem.upper, (3, 5, 12))
    turns = Turns(problem)
    np.testing.assert_array_equal(turns.folded(q), q)
    np.testing.assert_array_equal(turns.lower, problem.lower)


def test_hops_go_downhill_from_a_worse_path(problem: Problem, round_of: TrackLaw) -> None:
    pool, work = Pool(), Work(problem)
    for q, value in zip(round_of.pool.paths, round_of.pool.objectives, strict=True):
        if value > 13.0:
            pool.offer(q, value)
    worse = pool.best
    hops = Hops(problem, 1, pool, work, jobs=1)
    for _ in range(6):
        hops.make()
    assert pool.best < worse
    assert pool.objectives == sorted(pool.objectives)
    assert problem.objective(pool.paths[0]) == pytest.approx(pool.best)


def test_a_splice_joins_the_cheap_halves_of_two_paths() -> None:
    problem = replace_links(Task.load(TASK).problem())
    paths = np.zeros((3, 31, 12))
    paths[1] += 0.01
    paths[2] += 0.02
    values = np.ones((3, 31))
    values[0, :15] = values[1, 15:] = 0.0
    turns = Turns(problem)
    joined = next(splices(problem, turns, paths, values, np.random.default_rng(1)))
    np.testing.assert_array_equal(joined[:15], paths[0, :15])
    np.testing.assert_array_equal(joined[15:], paths[1, 15:])


def test_a_splice_goes_on_at_the_nearest_turn(wide: Problem) -> None:
    turns = Turns(wide)
    paths = np.zeros((3, 31, 12))
    paths[1, :, 4] += 2.0 * np.pi
    paths[2] += 0.02
    values = np.ones((3, 31))
    values[0, :15] = values[1, 15:] = 0.0
    joined = next(splices(wide, turns, paths, values, np.random.default_rng(1)))
    np.testing.assert_allclose(joined, 0.0, atol=1e-12)


def test_a_window_that_ends_a_turn_away_turns_what_follows(wide: Problem) -> None:
    turns, path = Turns(wide), np.zeros((10, 12))
    window = np.zeros((4, 12))
    window[:, 3] = np.linspace(0.0, 2.0 * np.pi, 4)
    rest, new, beside = turns.joined(path, window, 3, path[[2, 7]])
    whole = rest.copy()
    whole[3:7] = new
    np.testing.assert_allclose(np.diff(whole[:, 3])[[2, 6]], 0.0, atol=1e-12)
    np.testing.assert_allclose(beside, whole[[2, 7]])
    np.testing.assert_allclose(np.ptp(whole[:, 3]), 2.0 * np.pi)
    np.testing.assert_allclose(np.cos(rest), np.cos(path), atol=1e-12)


def test_a_joint_without_the_room_for_a_turn_is_unwound(wide: Problem) -> None:
    turns, path = Turns(wide), np.zeros((10, 12))
    path[7:, 3] = 0.0, 3.0, 6.4  # with a turn more behind the window 12.7 rad of 12.56 there are
    window = np.zeros((4, 12))
    window[:, 3] = np.linspace(0.0, 6.2, 4)
    rest, _, beside = turns.joined(path, window, 3, path[[2, 7]])
    np.testing.assert_allclose(np.ptp(rest[:, 3]), 6.4)
    np.testing.assert_allclose(beside[1] - beside[0], path[7] - path[2])
    assert turns.unwound(np.linspace(-6.5, 6.5, 40)[:, None] * np.ones(12)) is None


def test_what_two_paths_differ_in_is_put_onto_a_third(problem: Problem) -> None:
    pool = Pool()
    middle = np.tile(0.5 * (problem.lower + problem.upper), (5, 1))
    left, right = middle.copy(), middle.copy()
    left[:, 0] += 0.5
    right[:, 7] -= 0.5
    for value, q in ((3.0, middle), (2.0, left), (1.0, right)):
        pool.offer(q, value)
    both = middle.copy()
    both[:, 0] += 0.5
    both[:, 7] -= 0.5
    transfers = Transfers(problem, Turns(problem), pool)
    found = transfers.promising(60)
    (only,) = found  # the other two sums promise more than the best
    np.testing.assert_allclose(only, both)
    assert not len(transfers.promising(60))


def test_a_kind_that_won_gets_more_of_the_work_and_the_others_some() -> None:
    shares, random = Shares([0.5, 0.5]), np.random.default_rng(0)
    for _ in range(4):
        shares.record(0, 0.2, 1.0)
        shares.record(1, 0.2, 0.0)
    drawn = np.bincount([shares.draw(random) for _ in range(1000)], minlength=2)
    assert drawn[0] > 3 * drawn[1] > 0
    assert shares.outdone_by(10.0, 0.8)
    assert not shares.outdone_by(0.0, 0.8)


def test_a_new_best_is_worth_more_than_a_rival_and_a_twin_nothing() -> None:
    pool, q, won = Pool(), np.zeros((3, 2)), []
    for value, shift in ((2.0, 0.0), (1.0, 5.0), (1.0, 9.0), (1.5, 7.0)):
        before = pool.won
        pool.offer(q + shift, value)
        won.append(pool.won - before)
    assert won[:3] == [1.0, 1.0, 0.0]
    assert 0.0 < won[3] < 1.0


def replace_links(problem: Problem) -> Problem:
    return replace(problem, links=problem.links._replace(weight=problem.links.weight * 1e-3))


def test_a_pool_keeps_the_best_of_one_valley_in_order() -> None:
    pool = Pool()
    q = np.zeros((3, 2))
    for value, shift in ((2.0, 0.0), (1.0, 1.0), (1.0005, 1.1), (0.9995, 1.1), (3.0, 5.0)):
        pool.offer(q + shift, value)
    assert pool.objectives == [0.9995, 2.0, 3.0]
    assert pool.merged([pool]).objectives == pool.objectives


def test_a_path_that_was_picked_in_vain_rests() -> None:
    pool, random = Pool(), np.random.default_rng(0)
    for value in (1.0, 2.0):
        pool.offer(np.full((3, 2), value), value)
    early = []
    for _ in range(100):
        pool.picks = [0, 0]
        early.append(pool.pick(random))
    assert early.count(0) > early.count(1) > 0
    assert sum(pool.picks) == 1
    pool.picks = [1000, 0]
    assert [pool.pick(random) for _ in range(20)].count(1) > 10
    pool.offer(np.full((3, 2), 5.0), 0.5)
    assert pool.picks[0] == 0
    assert len(pool.picks) == len(pool.paths) == 3


def test_twins_share_the_chance_of_one_path() -> None:
    pool, random = Pool(), np.random.default_rng(0)
    for place in range(4):
        pool.offer(np.full((3, 2), 10.0 * place), 1.0)
    pool.offer(np.full((3, 2), 50.0), 2.0)
    picked = [pool.pick(random) for _ in range(30)]
    assert picked.count(4) > 3  # with five chances of their own it would be drawn twice at most


def test_sweeps_bring_a_long_path_down_window_by_window(monkeypatch: pytest.MonkeyPatch) -> None:
    split = "path.corner.points=[60, 61, 60]"
    problem = Task.load(TASK, [split, "two_stage={}"]).problem()
    law = TrackLaw(problem, seed=0, jobs=1)
    law.round(Round(40, 8, 8, 4, 1))
    best, path = law.pool.best, law.pool.paths[0]
    rough = path + 0.02 * np.random.default_rng(0).standard_normal(path.shape)
    assert violation(problem, rough) > 1e-3
    work = Work(problem)
    sweeps = Sweeps(problem, work, jobs=1)
    end = sweeps.settled(rough[None], Options(mu0=1e-3, push=1e-3))
    assert end.converged[0]
    assert end.objective[0] == pytest.approx(best, rel=1e-5)
    assert work.spent > 0.0
    # Where the whole solve comes to nothing, the windows alone leave a path that is low.
    monkeypatch.setattr(sweeps, "_most", 0)
    end = sweeps.settled(rough[None], Options(mu0=1e-3, push=1e-3))
    assert not end.converged[0]
    assert violation(problem, end.q[0]) < 1e-6
    assert end.objective[0] == pytest.approx(best, rel=1e-2)
    assert end.objective[0] == pytest.approx(problem.objective(end.q[0]), rel=1e-9)


def test_starts_of_a_long_path_are_told_apart_on_more_points_than_they_were_drawn_on() -> None:
    problem = Task.load(TASK, ["path.corner.points=[60, 61, 60]", "two_stage={}"]).problem()
    coarse = coarse_of(problem, 32)
    random = np.random.default_rng(3)
    postures = random.uniform(problem.lower, problem.upper, (6, 1, problem.n))
    starts = np.array([coarse.start(q) for q in np.tile(postures, (1, 32, 1))])
    work = Work(problem)
    paths, which = Sweeps(problem, work, jobs=1).nested(starts.copy(), Options(mu0=0.1, push=1e-2))
    assert len(paths) == len(which) == 3
    assert len(set(which.tolist()) & set(range(6))) == 3
    values = [problem.objective(q) for q in paths]
    off = [violation(problem, q) for q in paths]
    assert off[0] < 5e-3
    assert values[0] == min(v for v, o in zip(values, off, strict=True) if o < 5e-3)
    assert work.spent > 0.0
