"""The planners: each answer is on the path, and says so only after our own check."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from dualarm_pin.answer.trajectory import Trajectory
from dualarm_pin.answer.verify import verify
from dualarm_pin.errors import UnknownNameError
from dualarm_pin.path.paths import corner
from dualarm_pin.planners.local import plan_local
from dualarm_pin.planners.methods import plan
from dualarm_pin.planners.two_stage import _gaps, plan_two_stage
from dualarm_pin.planners.whole_path import polish
from dualarm_pin.task import Task

Array = NDArray[np.float64]


@pytest.fixture(scope="module")
def short(task: Task) -> Task:
    """A corner of 11 points, so that two stages take seconds."""
    path = corner(0.15, 0.01, 0.3, (4, 3, 4), rotation=np.diag([1.0, -1.0, -1.0]))
    return replace(task, path=path, Gamma=(0, 5, 10))


@pytest.fixture(scope="module")
def two_stage(short: Task) -> Trajectory:
    return plan_two_stage(short, starts=6, seed=1, jobs=1, basins=2, inner=2)


def test_two_stage_fills_every_point_and_is_verified(short: Task, two_stage: Trajectory) -> None:
    assert two_stage.found
    assert two_stage.q.shape == (11, 12)
    assert two_stage.max_position_error < 1e-6
    assert two_stage.max_bound_violation == 0.0
    assert two_stage.min_clearance is not None
    assert two_stage.objective == pytest.approx(short.problem().objective(two_stage.q))


def test_two_stage_gives_the_same_answer_for_any_number_of_workers(
    short: Task, two_stage: Trajectory
) -> None:
    again = plan_two_stage(short, starts=6, seed=1, jobs=2, basins=2, inner=2)
    np.testing.assert_array_equal(again.q, two_stage.q)
    other = plan_two_stage(short, starts=6, seed=2, jobs=2, basins=2, inner=2)
    assert not np.array_equal(other.q, two_stage.q)


def test_polish_is_never_worse_and_keeps_a_good_path(short: Task, two_stage: Trajectory) -> None:
    polished = polish(short, two_stage.q)
    assert polished.found
    assert polished.objective <= two_stage.objective
    again = polish(short, polished.q)
    assert again.objective == pytest.approx(polished.objective, rel=1e-8)
    assert again.objective <= polished.objective


@pytest.mark.parametrize(("h", "inner"), [(31, 5), (12, 3), (7, 10), (100, 4)])
def test_gaps_are_split_until_every_point_is_in(h: int, inner: int) -> None:
    known = {0, h // 3, h - 1}
    while gaps := _gaps(sorted(known), h, inner):
        for gap in gaps:
            assert len(gap.inner) <= inner
            assert list(gap.inner) == sorted(set(gap.inner) - known)
            known |= set(gap.inner)
    assert known == set(range(h))


def test_the_paper_s_gaps_have_five_inner_points() -> None:
    gaps = _gaps([0, 6, 12, 18, 24, 30], 31, 5)
    assert gaps[0].inner == (1, 2, 3, 4, 5)
    assert len(gaps) == 5


def test_the_qp_keeps_the_bounds_that_the_free_variant_leaves(task: Task) -> None:
    q_first = plan_local(task, variant="qp", starts=5, seed=0).q[0]
    free = plan_local(task, q_first, variant="free")
    qp = plan_local(task, q_first, variant="qp")
    clamped = plan_local(task, q_first, variant="clamped")
    assert free.max_position_error < 1e-6
    assert free.max_bound_violation > 0.01
    assert not free.found
    for variant in (qp, clamped):
        assert variant.max_bound_violation == 0.0
    assert qp.found


def test_without_active_bounds_the_qp_is_the_pseudo_inverse(task: Task) -> None:
    wide = replace(
        task,
        cell=replace(
            task.cell,
            joints=tuple(replace(j, lower=-9.0, upper=9.0) for j in task.cell.joints),
        ),
    )
    q_first = plan_local(task, variant="qp", starts=3, seed=0).q[0]
    free = plan_local(wide, q_first, variant="free")
    qp = plan_local(wide, q_first, variant="qp")
    np.testing.assert_allclose(qp.q, free.q, atol=1e-7)


def test_the_null_space_step_lowers_the_index(task: Task) -> None:
    q_first = plan_local(task, variant="qp", starts=3, seed=0).q[0]
    still = plan_local(task, q_first, variant="free", k0=0.0)
    sliding = plan_local(task, q_first, variant="free", k0=5.0)
    assert sliding.mean_index < still.mean_index


def test_an_unknown_variant_method_or_effort_is_refused(task: Task) -> None:
    with pytest.raises(UnknownNameError, match="did you mean 'clamped'"):
        plan_local(task, variant="clampd")  # type: ignore[arg-type]
    with pytest.raises(UnknownNameError, match="did you mean 'two-stage'"):
        plan(task, "two_stage")
    with pytest.raises(UnknownNameError, match="use quick, normal, thorough"):
        plan(task, "global", effort="hasty")
    with pytest.raises(ValueError, match="--starts: 1 to"):
        plan(task, "global", starts=0)


@pytest.mark.parametrize("method", ["two-stage", "local", "global"])
def test_an_unreachable_path_names_the_first_point_out_of_reach(task: Task, method: str) -> None:
    path = corner(0.15, 0.01, 4.5, (2, 1, 2), rotation=np.diag([1.0, -1.0, -1.0]))
    far = replace(task, path=path, Gamma=(0, 2, 4))
    answer = plan(far, method, starts=2, effort="quick", jobs=1)
    assert not answer.found
    assert "point 1 of 5 has no solution" in answer.message
    assert np.isfinite(answer.q).all()


def test_verification_fails_what_is_off_the_path_or_out_of_bounds(
    short: Task, two_stage: Trajectory
) -> None:
    q = two_stage.q.copy()
    q[3, 1] += 1e-4
    assert not verify(short, q).found
    tight = replace(
        short,
        cell=replace(
            short.cell,
            joints=tuple(replace(j, upper=float(j.upper) - 1e-6) for j in short.cell.joints),
        ),
    )
    on_bound = np.any(two_stage.q > tight.cell.upper)
    assert verify(tight, two_stage.q).found == (not on_bound)
    q = two_stage.q.copy()
    q[0, 0] = np.nan
    with pytest.raises(ValueError, match="joints of point 1 are not finite"):
        verify(short, q)


def test_ctrl_c_keeps_what_is_finished(short: Task, monkeypatch: pytest.MonkeyPatch) -> None:
    from dualarm_pin.solvers import slsqp

    calls = 0
    solve = slsqp.solve

    def stop_at_the_eighth(*arguments: object, **options: object) -> object:
        nonlocal calls
        calls += 1
        if calls == 8:
            raise KeyboardInterrupt
        return solve(*arguments, **options)  # type: ignore[arg-type]

    monkeypatch.setattr(slsqp, "solve", stop_at_the_eighth)
    answer = plan_two_stage(short, starts=6, seed=1, jobs=1, basins=2, inner=2)
    assert answer.found
    assert answer.notes.interrupted


def test_ctrl_c_in_the_engine_keeps_the_starts_that_were_finished(
    task: Task, monkeypatch: pytest.MonkeyPatch
) -> None:
    from dualarm_pin.planners.whole_path import plan_global
    from dualarm_pin.solvers import interior_point as engine

    batches = 0
    solve_many = engine.solve_many

    def stop_when_the_first_paths_are_refined(*arguments: object, **options: object) -> object:
        nonlocal batches
        ends = solve_many(*arguments, **options)  # type: ignore[arg-type]
        batches += 1
        return replace(ends, interrupted=True) if batches == 4 else ends

    monkeypatch.setattr(engine, "solve_many", stop_when_the_first_paths_are_refined)
    answer = plan_global(task, effort="normal", seed=0)
    assert answer.found
    assert answer.notes.interrupted
    assert answer.objective == pytest.approx(12.7309, abs=1e-3)


@pytest.mark.parametrize("jobs", [1, 3])
def test_the_whole_path_is_found_alike_for_any_number_of_threads(task: Task, jobs: int) -> None:
    answer = plan(task, "global", effort="quick", seed=3, jobs=jobs)
    assert answer.found
    assert answer.objective == pytest.approx(12.730887, abs=2e-6)
    again = plan(task, "global", effort="quick", seed=3, jobs=2)
    np.testing.assert_array_equal(again.q, answer.q)


def test_a_time_limit_cuts_the_search_and_says_so(task: Task) -> None:
    answer = plan(task, "global", effort="thorough", seed=0, jobs=1, time_limit=1e-6)
    assert answer.found
    assert answer.notes.interrupted
    assert answer.evidence.bound is None
    with pytest.raises(ValueError, match="--time-limit: seconds above 0"):
        plan(task, "global", time_limit=0.0)


def test_independent_searches_that_agree_end_the_search_early(task: Task) -> None:
    answer = plan(task, "global", effort="normal", seed=1, jobs=2)
    searches = answer.evidence.searches
    assert searches is not None
    assert searches.kind == "searches"
    assert searches.agree
    assert answer.evidence.verdict == "best_known"
    assert not answer.notes.interrupted
    assert searches.hops > 0
