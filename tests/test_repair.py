"""Paths whose bodies are kept apart: what is measured, the rows made of it, and where they lead."""

from __future__ import annotations

import time
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pinocchio as pin
import pytest
from numpy.typing import NDArray
from paper_case import TASK
from robot_table import needs_robots

import dualarm_pin.evidence.bound as bound_module
from dualarm_pin.answer.folder import load_result, save_result
from dualarm_pin.answer.notes import GlobalNotes
from dualarm_pin.cell import Cell
from dualarm_pin.clearance import ClearanceRule
from dualarm_pin.clearance.asked import asked_of
from dualarm_pin.clearance.extent import corners_of
from dualarm_pin.engine.evaluation import gaps
from dualarm_pin.evidence.ascent import BoundOptions
from dualarm_pin.evidence.check import check_held, polished
from dualarm_pin.evidence.piece_search import SearchOptions
from dualarm_pin.files.resources import urdf_folder
from dualarm_pin.planners.apart import held_problem
from dualarm_pin.planners.effort import BUDGETS
from dualarm_pin.planners.whole_path import plan_global
from dualarm_pin.problem import Problem
from dualarm_pin.repair import few
from dualarm_pin.repair.basin import Basin
from dualarm_pin.repair.bodies import asked_pairs
from dualarm_pin.repair.covers import cover
from dualarm_pin.repair.dips import INNER, inner_postures
from dualarm_pin.repair.known import Known, Measured
from dualarm_pin.repair.meter import Meter, OverError
from dualarm_pin.repair.pool import EFFORTS, Apart, keep_apart
from dualarm_pin.repair.race import Race
from dualarm_pin.repair.repaired import Repaired, Standing, Steps
from dualarm_pin.repair.survey import Survey, box_around
from dualarm_pin.repair.walks import stepped
from dualarm_pin.repair.witness import asked_apart, cuts, witness_table
from dualarm_pin.show.report_tables import tables_of
from dualarm_pin.task import Task
from dualarm_pin.tolerance import TOLERANCE

Array = NDArray[np.float64]


@pytest.fixture(scope="module")
def task() -> Task:
    """The paper's task, the two hands farther apart than on its best path."""
    given = Task.load(urdf_folder() / "tasks" / "paper_corner.yaml")
    arms = [pair for pair in given.cell.pairs if pair[0][:4] != pair[1][:4]]
    rule = ClearanceRule(None, dict.fromkeys(dict.fromkeys(arms), 0.22))
    return replace(given, clearance=rule)


@pytest.fixture(scope="module")
def best(task: Task) -> Array:
    return plan_global(replace(task, clearance=None), effort="quick", seed=0).q


@pytest.fixture(scope="module")
def survey(task: Task) -> Survey:
    return survey_of(task)


def survey_of(task: Task) -> Survey:
    return Survey(task.problem(), asked_pairs(task.cell, asked_of(task).required))


@pytest.fixture(scope="module")
def wrists() -> Task:
    """Arms whose wrists turn within the hull of the link before, a millimetre from it."""
    given = Task.load(urdf_folder() / "tasks" / "b11.yaml")
    return replace(given, clearance=ClearanceRule(0.01, spare_fixed=True))


def test_a_capsule_holds_its_body() -> None:
    cell = Cell.load(urdf_folder() / "cells" / "ns16_pair.yaml")
    for thing in cell.collision.geometryObjects:
        capsule = cover(thing)
        points = corners_of(thing.geometry) @ thing.placement.rotation.T
        points += thing.placement.translation
        start, along = capsule.ends[0], capsule.ends[1] - capsule.ends[0]
        s = np.clip((points - start) @ along / max(along @ along, 1e-12), 0.0, 1.0)
        away = np.linalg.norm(points - start - s[:, None] * along, axis=1)
        assert away.max() <= capsule.radius + 1e-9


def test_what_is_measured_is_what_the_cell_says(task: Task, survey: Survey) -> None:
    random = np.random.default_rng(2)
    q = random.uniform(task.cell.lower, task.cell.upper, (40, task.cell.n))
    exact = np.array([task.cell.distances(x)[survey.pairs.number] for x in q])
    contacts = survey.contacts(q, 0.1)
    near = exact < survey.pairs.required + 0.1
    assert near.sum() == len(contacts.point)
    hulls = exact[contacts.point, contacts.pair]
    assert np.all(contacts.distance >= hulls - 1e-6)  # a mesh is never nearer than its hull
    far = hulls >= survey.pairs.required[contacts.pair]
    np.testing.assert_allclose(contacts.distance[far], hulls[far], atol=1e-6)
    apart = exact > 0.0
    assert np.all((survey.capsule_gaps(q) + survey.pairs.required <= exact + 1e-9)[apart])


def test_a_row_of_a_contact_is_its_distance_less_what_is_asked(survey: Survey, best: Array) -> None:
    contacts = survey.contacts(best, 0.1)
    apart = asked_apart(contacts)
    problem = survey.problem.with_pairs(witness_table(survey, contacts, apart, len(best)))
    at = problem.inequalities
    rows = gaps(problem, best)[np.arange(at.kind.shape[1]) < at.size[:, None]]
    np.testing.assert_allclose(rows, contacts.distance - apart, atol=1e-9)


@pytest.fixture(scope="module")
def basin(survey: Survey) -> Basin:
    return Basin(survey, between=True)


def test_a_path_is_moved_until_its_bodies_are_apart(
    task: Task, survey: Survey, basin: Basin, best: Array
) -> None:
    assert not basin.keeps(best)
    path = basin.repaired(best)
    assert path is not None
    postures = [*path.q, *inner_postures(path.q)]
    distance = np.array([task.cell.distances(x)[survey.pairs.number] for x in postures])
    assert np.all(distance >= survey.pairs.required - 5e-4)
    free = survey.problem.objective(best)
    assert free < path.objective < 1.2 * free
    assert path.objective == pytest.approx(survey.problem.objective(path.q), rel=1e-9)


def test_the_rows_that_hold_a_path_are_known_to_pinocchio(
    task: Task, survey: Survey, basin: Basin, best: Array
) -> None:
    path = basin.repaired(best)
    assert path is not None
    problem = held_problem(task, survey, path)
    assert 0 < len(problem.rows) <= 2 * len(best)
    assert not check_held(task.problem(), path.q).stationary
    assert check_held(problem, polished(path.problem, path.q)).minimum


def test_the_answer_is_found_only_where_the_check_confirms_every_pair(task: Task) -> None:
    answer = plan_global(task, effort="quick", seed=0)
    assert answer.found
    assert answer.checked.apart is not None
    assert answer.checked.apart.kept
    assert answer.evidence.sentences.startswith("With clearance:")
    assert answer.evidence.local is not None
    assert answer.evidence.local.minimum
    assert answer.evidence.verdict == "local_only"


def test_where_bodies_must_not_touch_a_little_more_is_asked_of_the_search() -> None:
    """Contact is never accepted: a dip between two postures of the repair would be refused."""
    near = ["clearance=0", "cell.arms.arm2.base.xyz=[2.2, 0, 0]"]
    answer = plan_global(Task.load(TASK, near), effort="quick", seed=0)
    assert answer.found
    assert answer.checked.apart is not None
    assert answer.checked.apart.level == "certified"
    assert answer.checked.apart.least_between is not None
    assert 0.0 < answer.checked.apart.least_between < 1e-3


def test_a_bound_without_clearance_stands_beside_the_answer_that_keeps_one(
    task: Task, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A small budget: what `thorough` does, without its work."""
    small = BoundOptions(SearchOptions(wide=60, most=120, postures=60), steps=8, rounds=1)
    monkeypatch.setattr(bound_module, "BoundOptions", lambda: small)
    monkeypatch.setitem(BUDGETS, "thorough", replace(BUDGETS["quick"], bound=True))
    monkeypatch.setitem(EFFORTS, "thorough", EFFORTS["quick"])
    answer = plan_global(task, effort="thorough", seed=0)
    bound, free = answer.evidence.bound, 12.7309
    assert answer.found
    assert bound is not None
    assert bound.without_clearance == pytest.approx(free, abs=1e-4)
    assert bound.objective == answer.objective > free
    assert bound.value <= free + 1e-4
    first, second, *_ = answer.evidence.sentences.split("\n")
    assert first.startswith("With clearance:")
    assert second.startswith("Without clearance, splitting into")
    assert answer.evidence.verdict == "local_only"
    save_result(tmp_path, task, answer)
    assert load_result(tmp_path)[1].evidence == answer.evidence
    rows = dict(tables_of([(task, answer)])["Evidence"])
    assert rows["lower bound"][0].endswith("made without clearance")
    assert rows["known without clearance"][0].startswith("12.73089; the answer lies ")


def test_a_distance_that_is_known_from_a_nearby_pose_is_never_too_large(survey: Survey) -> None:
    points, radius = survey.pairs.hulls[0]
    known, random = Known(box_around(points, radius)), np.random.default_rng(4)
    pose = np.eye(4)
    measured = Measured(0.2, np.zeros(3), np.ones(3))
    known.add(pose, 0.2, measured)
    assert known.least(pose) == (0.2, False, measured, True)
    for _ in range(20):
        moved = pin.exp6(random.normal(scale=0.05, size=6)).homogeneous
        away = np.linalg.norm(points @ moved[:3, :3].T + moved[:3, 3] - points, axis=1).max()
        assert known.least(moved)[0] <= 0.2 - away + 1e-12
        assert known.least(moved)[2:] == (measured, False)


def test_what_is_measured_again_nearby_is_what_is_measured_anew(task: Task, survey: Survey) -> None:
    random = np.random.default_rng(7)
    q = random.uniform(task.cell.lower, task.cell.upper, (20, task.cell.n))
    survey.contacts(q, 0.1)
    for shift in (0.0, 1e-3, 0.05):
        near = q + shift * random.normal(size=q.shape)
        again = survey.contacts(near, 0.1)
        anew = Survey(task.problem(), survey.pairs).contacts(near, 0.1)
        np.testing.assert_array_equal(again.point, anew.point)
        np.testing.assert_array_equal(again.pair, anew.pair)
        np.testing.assert_allclose(again.distance, anew.distance, atol=2e-4)


@needs_robots
def test_meshes_decide_where_their_hulls_just_keep_what_is_asked(wrists: Task) -> None:
    cell, survey = wrists.cell, survey_of(wrists)
    q = np.random.default_rng(0).uniform(cell.lower, cell.upper, (12, cell.n))
    found = survey.contacts(q, 0.06)
    tight = found.take(found.lack > -9e-4)
    places = zip(q[tight.point], survey.pairs.number[tight.pair].tolist(), strict=True)
    exact = np.array([cell.distance(x, number, exact=True) for x, number in places])
    apart = exact > 0.0
    assert np.count_nonzero(apart) > 10
    np.testing.assert_allclose(tight.distance[apart], exact[apart], atol=2e-4)


@needs_robots
def test_a_pair_that_surely_keeps_more_is_not_measured_anew(wrists: Task) -> None:
    cell = wrists.cell
    q = np.random.default_rng(0).uniform(cell.lower, cell.upper, (12, cell.n))
    nearby = np.concatenate([q, q[:1]]) + 2e-3  # of another number, so that none is recent
    spent, least = [], []
    for ample in (1e-3, np.inf):
        survey = survey_of(wrists)
        survey.contacts(q, 0.06)
        survey.meter = Meter(survey.problem)
        found = survey.contacts(nearby, 0.06, ample=ample)
        spent.append(survey.meter.spent)
        least.append(dict(zip(zip(found.point, found.pair, strict=True), found.lack, strict=True)))
    assert spent[0] < 0.9 * spent[1]
    for where, lack in least[0].items():  # what stands for a distance is never more
        assert lack >= least[1].get(where, -np.inf) - 1e-9
        assert lack <= max(least[1].get(where, -np.inf), -1e-3) + 1e-9


def test_the_corner_that_a_step_brings_through_a_plane_is_held(survey: Survey, best: Array) -> None:
    held = survey.contacts(best, 0.1)
    end = best + np.random.default_rng(5).normal(scale=0.3, size=best.shape)
    lacking = survey.contacts(end, 0.0)
    feet, others = cuts(survey, held, end, lacking)
    assert len(feet.point) > 0
    assert len(feet.point) + len(others.point) <= len(lacking.point)
    rows = survey.problem.with_pairs(witness_table(survey, feet, asked_apart(feet), len(best)))
    at = rows.inequalities
    broken = gaps(rows, end)[np.arange(at.kind.shape[1]) < at.size[:, None]]
    assert np.all(broken < 0.0)


def tightest_line(survey: Survey, q: Array) -> tuple[int, int]:
    """Return the pair that is nearest between the points of a path, and after which point."""
    between = survey.contacts(inner_postures(q), 0.1)
    tightest = int(np.argmax(between.lack))
    return int(between.pair[tightest]), int(between.point[tightest]) // INNER


def test_more_room_on_one_line_moves_a_pair_apart_there(
    task: Task, survey: Survey, basin: Basin, best: Array
) -> None:
    path = basin.repaired(best)
    assert path is not None
    pair, line = tightest_line(survey, path.q)
    wider = basin.roomier(path, pair, line, 5e-3)
    assert wider is not None
    ends = wider.q[line : line + 2]
    distance = [task.cell.distances(x)[survey.pairs.number[pair]] for x in ends]
    assert min(distance) > survey.pairs.required[pair] + 4e-3
    assert np.all(wider.extra >= path.extra)


def test_on_a_long_path_only_the_points_without_room_move(
    task: Task, survey: Survey, basin: Basin, best: Array
) -> None:
    path = basin.repaired(best)
    assert path is not None
    pair, line = tightest_line(survey, path.q)
    wider = few.roomier(basin, path, pair, line, 2e-3)
    assert wider is not None
    number = survey.pairs.number[pair]
    distance = [task.cell.distances(x)[number] for x in wider.q[line : line + 2]]
    assert min(distance) > survey.pairs.required[pair] + 1e-3
    moved = np.abs(wider.q - path.q).max(axis=1) > TOLERANCE.fixed_joint
    assert moved[line : line + 2].any()
    assert np.count_nonzero(moved) < len(best) / 2


def test_ctrl_c_keeps_what_came_apart_so_far(
    survey: Survey, best: Array, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupted(*_: object, **__: object) -> Array:
        raise KeyboardInterrupt

    monkeypatch.setattr("dualarm_pin.repair.walks.Walks.next", interrupted)
    minima = [(survey.problem.objective(best), best)]
    apart = keep_apart(Basin(survey, between=True), minima, EFFORTS["quick"], seed=0, jobs=1)
    assert apart.cut
    assert apart.best is not None
    assert apart.tried == 1


class _Scripted:
    """A basin whose paths stand as they are told, and end; a round costs a tenth of the budget."""

    def __init__(self, problem: Problem, ends: dict[float, list[Standing]]) -> None:
        self.survey = SimpleNamespace(meter=Meter(problem))
        self.ends, self.rounds = ends, list[float]()

    def steps(self, q: Array, way: float | None, *, margin: float, fitted: bool = False) -> Steps:
        name = float(q[0, 0])
        for standing in self.ends[name]:
            self.rounds.append(name)
            self.survey.meter.spent += 0.1
            yield standing
        return None


def _race(problem: Problem, ends: dict[float, list[Standing]]) -> tuple[Race, _Scripted]:
    basin = _Scripted(problem, ends)
    race = Race(cast(Basin, basin), 1.0)
    for name in ends:
        race.enter(np.full((1, 1), name), name, "walk")
    return race, basin


def test_a_round_goes_to_the_path_that_promises_most(task: Task) -> None:
    near, deep = Standing(4.0, 0.0, False), Standing(2.0, 0.3, False)
    race, basin = _race(task.problem(), {3.0: [deep] * 9, 4.5: [near] * 9})
    for _ in range(6):
        race.round(np.inf)
    assert basin.rounds[:2] == [3.0, 3.0]  # at first what it promised before counts
    assert basin.rounds[-1] == 4.5


def test_a_path_that_was_apart_comes_before_one_that_promises_as_much(task: Task) -> None:
    near, apart = Standing(4.0, 0.0, False), Standing(4.05, 0.0, True)
    race, basin = _race(task.problem(), {4.0: [near] * 9, 4.01: [apart] * 9})
    for _ in range(3):
        race.round(np.inf)
    assert basin.rounds == [4.0, 4.01, 4.01]


def test_a_path_that_is_apart_gives_up_where_it_cannot_get_below_the_best(task: Task) -> None:
    falls = [Standing(9.0, 0.0, True), Standing(6.0, 0.0, True), Standing(5.99, 0.0, True)]
    race, _ = _race(task.problem(), {3.0: falls})
    assert race.round(5.0) == (False, None)  # nothing is known of how it falls
    assert race.round(5.0) == (False, None)  # it fell by 3
    assert race.round(5.0) == (True, None)  # it will not fall by 1 any more
    assert len(race) == 0


def test_where_one_path_is_lost_less_is_expected_of_its_kind(task: Task) -> None:
    race, _ = _race(task.problem(), {3.0: [], 4.0: []})
    race.enter(np.full((1, 1), 3.0), 5.0, "minimum")
    assert race.round(np.inf) == (True, None)
    assert race.best == 5.0  # the other walk promised 4 before


def test_a_budget_counts_meshes_by_their_triangles(task: Task) -> None:
    meter = Meter(task.problem(), 1.0)
    meter.meshes(0)
    cheap = meter.spent
    meter.meshes(10_000)
    assert meter.spent > 3.0 * cheap
    meter.found = True
    with pytest.raises(OverError):
        for _ in range(3000):
            meter.meshes(10_000)


def test_a_budget_ends_a_repair_and_what_was_found_is_kept(task: Task, best: Array) -> None:
    problem = task.problem()
    pairs = asked_pairs(task.cell, asked_of(task).required)
    survey = Survey(problem, pairs, Meter(problem, 1e-3))
    with pytest.raises(OverError):
        Basin(survey, between=True).repaired(best)


def test_a_long_path_is_led_apart_by_a_few_of_its_points() -> None:
    task = Task.load(TASK, ["clearance=0.15", "path.corner.points=[60, 21, 60]"])
    answer = plan_global(task, effort="quick", jobs=1)
    assert answer.found, answer.message
    assert answer.q.shape == (141, 12)
    asked = asked_of(task).required
    seen = np.min([task.cell.distances(q) for q in answer.q], axis=0)
    assert np.all(seen >= asked - TOLERANCE.clearance)


@needs_robots
def test_a_long_path_that_many_points_do_not_lead_is_led_by_fewer(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    points, begun = "path.dome_spiral.points=301", list[int]()

    def seen(basin: Basin, *given: Any, **named: Any) -> Apart:
        begun.append(basin.survey.problem.k)
        return keep_apart(basin, *given, **named)

    monkeypatch.setattr("dualarm_pin.repair.few.keep_apart", seen)
    task = Task.load(urdf_folder() / "tasks" / "b06.yaml", ["clearance=0.01", points])
    answer = plan_global(task, effort="quick", jobs=1)
    assert answer.found, answer.message
    assert begun == [96, 48]


def test_a_long_path_that_lost_a_point_is_not_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    set_down = few._set_down

    def lost(basin: Basin, q: Array, extra: Array) -> Repaired | None:
        path = set_down(basin, q, extra)
        assert path is not None
        path.q[len(q) // 2] += 3.0
        return path

    monkeypatch.setattr("dualarm_pin.repair.few._set_down", lost)
    monkeypatch.setattr("dualarm_pin.repair.few._eased", lambda *_: iter(()))  # it might mend that
    task = Task.load(TASK, ["clearance=0.15", "path.corner.points=[60, 21, 60]"])
    answer = plan_global(task, effort="quick", jobs=1)
    assert answer.found, answer.message


@pytest.mark.parametrize("cut", [True, False])
def test_a_long_path_is_not_begun_anew_after_ctrl_c(
    cut: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    begun: list[int] = []

    def stopped(basin: Basin, *_: object, **__: object) -> Apart:
        begun.append(basin.survey.problem.k)
        return Apart(tried=2, complete=False, cut=cut)

    monkeypatch.setattr("dualarm_pin.repair.few.keep_apart", stopped)
    monkeypatch.setattr("dualarm_pin.planners.apart.keep_apart", stopped)
    task = Task.load(TASK, ["clearance=0.15", "path.corner.points=[60, 21, 60]"])
    answer = plan_global(task, effort="quick", jobs=1)
    assert begun == ([96] if cut else [96, 48, 141])
    assert answer.message.startswith(f"none of {2 if cut else 6} paths that were tried")


def test_points_between_those_of_a_path_that_is_apart_are_set_down_one_by_one(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    task = Task.load(
        urdf_folder() / "tasks" / "b06.yaml", ["clearance=0.01", "path.dome_spiral.points=150"]
    )
    answer = plan_global(task, effort="quick", jobs=1)
    assert answer.found, answer.message
    # Points that came apart one by one are no minimum yet: all together they come farther down.
    monkeypatch.setattr("dualarm_pin.repair.few._eased", lambda *_: iter(()))
    alone = plan_global(task, effort="quick", jobs=1)
    assert alone.found
    assert answer.objective < 0.99 * alone.objective


def test_a_point_solved_alone_stays_within_its_reach(survey: Survey, best: Array) -> None:
    i, reach = 15, 0.02
    start = np.clip(best[[i]] + 0.1, survey.problem.lower, survey.problem.upper)
    free, _ = stepped(survey, i, start, best[[i - 1, i + 1]], np.ones(2))
    held, _ = stepped(survey, i, start, best[[i - 1, i + 1]], np.ones(2), reach)
    assert np.abs(free - start).max() > 2.0 * reach
    assert np.abs(held - start).max() <= reach + TOLERANCE.fixed_joint


def test_a_time_limit_leaves_time_for_the_check() -> None:
    task = Task.load(urdf_folder() / "tasks" / "b09.yaml", ["clearance=0.01"])
    limit = 4.0
    begun = time.monotonic()
    answer = plan_global(task, effort="thorough", jobs=1, time_limit=limit)
    assert isinstance(answer.notes, GlobalNotes)
    assert answer.notes.interrupted
    # A step under way and the check are finished: seconds on a busy machine, not the minute that
    # thorough takes.
    assert time.monotonic() - begun < 3.0 * limit
