"""The lower bound: its algebra exactly, its value against a search of the whole problem."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from evidence_cases import minima_of_six, random_path, six_points, whole
from numpy.typing import NDArray

from dualarm_pin.answer.evidence import Bound
from dualarm_pin.evidence import bound as bound_module
from dualarm_pin.evidence.ascent import Ascent, BoundOptions
from dualarm_pin.evidence.bound import bound_minimum, lower_bound
from dualarm_pin.evidence.bundle import Planes, highest
from dualarm_pin.evidence.check import check_minimum, polished
from dualarm_pin.evidence.piece_search import SearchOptions
from dualarm_pin.evidence.pieces import cut_sets, split
from dualarm_pin.problem import Problem
from dualarm_pin.progress import SILENT, Progress
from dualarm_pin.solvers import interior_point as engine

Array = NDArray[np.float64]
SMALL = BoundOptions(search=SearchOptions(wide=150, most=300, postures=60))


@pytest.fixture(scope="module")
def best() -> Array:
    return polished(six_points(), minima_of_six().ends.q[0])


@pytest.fixture(scope="module")
def bound(best: Array) -> Bound:
    found, _ = lower_bound(six_points(), best, seed=0, jobs=2, options=SMALL)
    assert found is not None
    return found


def full_problem() -> Problem:
    """Return a problem that uses every term there is."""
    random = np.random.default_rng(2)
    problem = whole().subset(range(2, 11), random.uniform(1, 3, 10), np.zeros(12), np.ones(12))
    weighted = problem.with_points(
        index_weight=random.uniform(0.5, 2.0, 9), linear=random.standard_normal((9, 12))
    )
    links = problem.links._replace(metric=random.uniform(0.5, 2.0, (9, 12)))
    return replace(weighted, links=links)


@pytest.mark.parametrize("cuts", [(), (4,), (1, 2), (2, 5, 7), tuple(range(1, 8))])
def test_the_pieces_of_a_path_sum_to_its_objective_for_any_multipliers(
    cuts: tuple[int, ...],
) -> None:
    problem = full_problem()
    theta = np.random.default_rng(3).standard_normal((len(cuts), problem.n))
    q = random_path(problem)
    pieces = split(problem, cuts)
    total = sum(piece.tilted(theta).objective(q[piece.points]) for piece in pieces)
    assert total == pytest.approx(problem.objective(q), rel=1e-12)
    for piece in pieces:
        part = q[None, piece.points]
        tilt = np.sum(piece.slopes(part, len(cuts))[0] * theta)
        expected = piece.tilted(theta).objective(part[0]) - piece.problem.objective(part[0])
        assert tilt == pytest.approx(expected, abs=1e-10)


def of_length(h: int) -> Problem:
    problem = whole()
    points = np.minimum(np.arange(h) * 31 // h, 30)
    return problem.subset(points, 3.0)


@pytest.mark.parametrize("h", [2, 3, 4, 5, 6, 7, 11, 12, 16, 23, 31, 61, 250])
def test_cuts_are_inner_points_in_order(h: int) -> None:
    sets = cut_sets(of_length(h))
    assert len(set(sets)) == len(sets) >= 1
    for cuts in sets:
        assert all(a < b for a, b in pairwise((0, *cuts, h - 1)))
    if h <= 3:
        assert sets == [()]
    else:
        assert len(sets[0]) >= 1


def test_no_cut_lies_in_the_fillet_of_the_corner() -> None:
    first, second = cut_sets(whole())
    assert first == (10, 20)
    assert len(second) == 1
    assert not set(first + second) & set(range(12, 19))


def planes(offset: list[float], slope: list[list[float]]) -> Planes:
    return Planes(np.array(offset), np.array(slope), np.zeros((len(offset), 2, 1)))


def test_the_model_is_raised_to_its_highest_point_in_the_box() -> None:
    random = np.random.default_rng(0)
    pieces = [planes(list(random.random(9)), random.standard_normal((9, 2)).tolist()) for _ in "ab"]
    grid = np.stack(np.meshgrid(*[np.linspace(-0.3, 0.7, 401)] * 2), axis=-1).reshape(-1, 2)
    model = sum(np.min(p.offset[:, None] + p.slope @ grid.T, axis=0) for p in pieces)
    theta, height = highest(pieces, np.array([0.2, 0.2]), 0.5)
    assert np.all(np.abs(theta - 0.2) <= 0.5 + 1e-9)
    assert height == pytest.approx(sum(p.lowest(theta) for p in pieces), abs=1e-7)
    assert height >= np.max(model) - 1e-9
    assert height <= np.max(model) + 0.02


def test_of_many_highest_points_the_nearest_is_taken() -> None:
    theta, height = highest([planes([1.0, 0.0], [[0.0], [1.0]])], np.zeros(1), 50.0)
    assert height == pytest.approx(1.0)
    assert theta == pytest.approx([1.0], abs=1e-6)


def test_old_planes_fall_out_but_the_incumbent_stays() -> None:
    many = planes([5.0], [[0.0]])
    for number in range(60):
        many.add(planes([10.0 + number] * 20, [[0.0]] * 20))
    assert len(many.offset) == len(many.slope) == len(many.path) == 800
    assert many.lowest(np.zeros(1)) == 5.0
    assert many.offset[-1] == 69.0


def test_the_bound_is_below_every_path_and_near_the_best(best: Array, bound: Bound) -> None:
    problem = six_points()
    objective = problem.objective(best)
    assert bound.objective == pytest.approx(objective)
    assert bound.value <= objective + 1e-9
    assert bound.value <= minima_of_six().ends.objective.min() + 1e-6
    assert bound.gap < 1e-3
    assert not bound.found_better
    assert bound.pieces == len(bound.starts) == len(bound.hits)
    assert bound.value == max(bound.tried.values())


def test_the_bound_does_not_depend_on_the_number_of_threads(best: Array) -> None:
    options = BoundOptions(search=SearchOptions(wide=40, most=40, postures=20), rounds=1)
    one, two = (
        lower_bound(six_points(), best, seed=4, jobs=jobs, options=options)[0] for jobs in (1, 2)
    )
    assert one is not None
    assert two is not None
    assert (one.value, one.hits) == (two.value, two.hits)


def test_a_wrong_incumbent_shows_as_a_gap_and_the_better_path_is_found(
    best: Array, monkeypatch: pytest.MonkeyPatch
) -> None:
    problem = six_points()
    minima = minima_of_six().ends
    wrong = minima.q[np.flatnonzero(minima.objective > 1.05 * minima.objective[0])[0]]
    q, local = check_minimum(problem, wrong, seed=0, jobs=2)
    found, path = lower_bound(problem, q, seed=0, jobs=2, options=SMALL)
    assert found is not None
    assert found.gap > 0.03
    assert found.value <= problem.objective(best) + 1e-9
    assert found.beaten
    assert path is not None
    assert problem.objective(path) == pytest.approx(problem.objective(best), rel=1e-5)
    monkeypatch.setattr(bound_module, "lower_bound", lambda *_, **__: (found, path))
    q, better, against = bound_minimum(problem, q, local, seed=0, jobs=2)
    assert better.strict
    assert problem.objective(q) == pytest.approx(better.objective)
    assert against is not None
    assert against.gap < 1e-3
    assert against.replaced == pytest.approx(problem.objective(wrong), rel=1e-6)


def test_a_crippled_search_claims_too_much_until_the_wide_search_corrects_it(best: Array) -> None:
    problem = six_points()
    objective = problem.objective(best)
    minima = minima_of_six().ends
    wrong = minima.q[np.flatnonzero(minima.objective > 1.2 * objective)[0]]
    crippled = replace(
        SMALL, search=replace(SMALL.search, pool=1, cheap=0, postures=1), rounds=3, steps=5
    )
    ascent = Ascent(problem, [wrong], (2,), seed=0, jobs=2, options=crippled)
    ascent.climb()
    assert ascent.value > objective  # a false bound: a better path exists
    believed = ascent.value
    assert ascent.recheck(1, to_the_end=False) is None
    assert ascent.value < believed
    wides = ascent.recheck(2, to_the_end=True)
    assert wides is not None
    assert ascent.value == pytest.approx(sum(wide.value for wide in wides))
    assert ascent.value <= objective + 1e-9
    again = Ascent(problem, [wrong], (2,), seed=0, jobs=2, options=crippled)
    result = again.run(SILENT)
    assert result is not None
    assert result.value < believed
    assert result.value <= objective + 1e-9


def test_cuts_whose_pieces_are_hard_to_search_are_left_if_others_may_do_better() -> None:
    problem = six_points()
    minima = minima_of_six().ends
    wrong = minima.q[np.flatnonzero(minima.objective > 1.2 * minima.objective[0])[0]]
    search = replace(SMALL.search, pool=1, cheap=0, postures=1)
    crippled = replace(SMALL, search=search, steps=0, patience=1)
    ascent = Ascent(problem, [wrong], (2,), seed=0, jobs=2, options=crippled)
    assert ascent.run(SILENT, may_give_up=True) is None


@pytest.mark.parametrize("points", [[0, 12], [0, 12, 24]])
def test_a_very_short_path_is_not_cut_but_searched_anew(points: list[int]) -> None:
    problem = whole().subset(points, 1.5)
    starts = np.repeat(minima_of_six().ends.q[:40, :1], len(points), axis=1)
    ends = engine.solve_many(problem, starts, jobs=2)
    q = ends.q[np.argmin(np.where(ends.converged, ends.objective, np.inf))]
    found, _ = lower_bound(problem, q, seed=0, jobs=2, options=SMALL)
    assert found is not None
    assert found.cuts == ()
    assert found.pieces == 1
    assert found.value <= problem.objective(q) + 1e-9


def test_a_free_tool_spin_is_bounded_too() -> None:
    problem = six_points().with_points(pose_rows=np.full(6, 5))
    q = polished(problem, minima_of_six().ends.q[0])
    found, better = lower_bound(problem, q, seed=0, jobs=2, options=SMALL)
    assert found is not None
    lowest = problem.objective(q if better is None else better)
    assert found.value <= lowest + 1e-9
    assert found.value > 0.5 * lowest


@pytest.mark.parametrize("sets", [0, 1])
def test_ctrl_c_leaves_the_last_rechecked_value_or_none(
    best: Array, monkeypatch: pytest.MonkeyPatch, sets: int
) -> None:
    climb, count = Ascent.climb, 0

    def climb_until_ctrl_c(ascent: Ascent, progress: Progress = SILENT) -> None:
        nonlocal count
        count += 1
        if count > sets:
            raise KeyboardInterrupt
        climb(ascent, progress)

    monkeypatch.setattr(Ascent, "climb", climb_until_ctrl_c)
    options = replace(SMALL, steps=1, rounds=1, enough=-1.0)  # so that every set is tried
    found, _ = lower_bound(six_points(), best, seed=0, jobs=2, options=options)
    if sets == 0:
        assert found is None
    else:
        assert found is not None
        assert not found.complete
        assert len(found.tried) == 1
