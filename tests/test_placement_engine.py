"""Shared parameters in the engine: the arrow system and the derivatives of the optimal value."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pinocchio as pin
import pytest
from engine_cases import BareCell, random_pair

from dualarm_pin.engine.evaluation import evaluate
from dualarm_pin.engine.sensitivity import sensitivity
from dualarm_pin.engine.solve import Options, solve, solve_many
from dualarm_pin.errors import InputError, UnknownNameError
from dualarm_pin.files.resources import urdf_folder
from dualarm_pin.indices import force, yoshikawa
from dualarm_pin.placement.parameters import ELEMENTS, Free, checked, moved_base, workpiece_pose
from dualarm_pin.placement.shared import placed, share
from dualarm_pin.problem import Problem
from dualarm_pin.rows import above, half_space
from dualarm_pin.solution import distinct
from dualarm_pin.task import Task

TIGHT = Options(tolerance=1e-10)
WARM = Options.warm(1e-11)
EVERY = {name: (-0.3, 0.3) for name in ELEMENTS}


@pytest.fixture(scope="module")
def paper(problem):
    """The paper's problem and its best known minimum, with multipliers."""

    starts = np.random.default_rng(0).uniform(problem.lower, problem.upper, (200, 1, 12))
    single = distinct(solve_many(problem, starts, jobs=1, points=np.full(200, 15)))
    whole = solve_many(problem, np.repeat(single.ends.q[:10], 31, axis=1), jobs=1)
    best = whole.q[np.argmin(np.where(whole.converged, whole.objective, np.inf))]
    rough = solve(problem, best, TIGHT)
    return problem, solve(problem, rough.q, WARM, warm=rough.multipliers)


def test_the_gradients_at_the_papers_optimum_are_those_of_solving_again(paper):
    problem, best = paper
    found = sensitivity(problem, best, checked(EVERY, problem.cell))
    slope = dict(zip(found.names, found.gradient, strict=True))
    assert best.objective == pytest.approx(12.730887, abs=1e-6)
    known = {"x": 11.86074, "y": 0.0, "z": 2.54439, "yaw": 0.0}
    assert {axis: slope[f"base2.{axis}"] for axis in known} == pytest.approx(known, abs=1e-5)
    known = {"x": -16.92321, "y": -2.16892, "z": 22.60422, "yaw": 0.0}
    assert {axis: slope[f"workpiece.{axis}"] for axis in known} == pytest.approx(known, abs=1e-5)
    assert slope["tool2.length"] == pytest.approx(13.95903, abs=1e-5)
    ahead = np.where(np.array(found.names) == "base2.x", 0.01, 0.0)
    assert best.objective + found.predicted(ahead) == pytest.approx(12.8499, abs=1e-4)


def test_base_distance_and_height_free_the_paper_comes_to_a_better_base(paper):
    problem, best = paper
    free = checked({"base2.x": (-1.1, 0.5), "base2.z": (-0.5, 0.5)}, problem.cell)
    shared = share(problem, free)
    end = solve(shared, shared.posture(best.q))
    assert end.converged
    assert end.iterations <= 25
    assert end.objective == pytest.approx(8.32838, abs=2e-6)
    values = end.q[0, 12:]
    assert values + np.array([2.5, 0.0]) == pytest.approx([2.1030, 0.0443], abs=1e-4)
    assert (end.q[:, 12:] == values).all()
    base = problem.cell.arms[1].base
    change = dict(zip([each.name for each in free], values, strict=True))
    cell = problem.cell.moved(base2=moved_base(base, change))
    there = replace(problem, cell=cell)
    assert there.objective(np.ascontiguousarray(end.q[:, :12])) == pytest.approx(end.objective)


def _bare(seed: int, joints: tuple[int, int]) -> BareCell:
    cell = BareCell(*random_pair(seed, joints, prismatic=0.4))
    here = pin.SE3.Identity()
    cell.arms = [SimpleNamespace(base=here)] * 2
    cell.moved = lambda **_: cell
    cell.tool_axes = (np.array([0.0, 0.0, 1.0]), np.array([0.6, 0.0, 0.8]))
    return cell


def _random_task(seed: int, joints: tuple[int, int], index) -> Problem:
    """Return a reachable path of five points on two random arms, some joints prismatic."""
    cell, rng = _bare(seed, joints), np.random.default_rng(seed)
    first, last = rng.uniform(-0.6, 0.6, (2, cell.n))
    data, poses = cell.data(), []
    for q in np.linspace(first, first + 0.2 * (last - first), 5):
        pin.forwardKinematics(cell.model, data, q)
        e1, e2 = (pin.updateFramePlacement(cell.model, data, f) for f in (cell.e1, cell.e2))
        poses.append(e1.actInv(e2))
    u = rng.normal(size=6)
    return Problem.of(
        cell,
        index,
        np.array([pose.translation for pose in poses]),
        np.array([pose.rotation for pose in poses]),
        lower=np.full(cell.n, -1.5),
        upper=np.full(cell.n, 1.5),
        spin_axis=(0.0, 0.6, 0.8),
        u=np.tile(u, (5, 1)),
        link_weight=2.0,
    )


def _file(name: str) -> Problem:
    return Task.load(urdf_folder() / "tasks" / f"{name}.yaml").problem()


CASES = {
    "prismatic": lambda: _random_task(3, (5, 4), force()),
    "prismatic, another index": lambda: _random_task(8, (5, 5), yoshikawa()),
    "7 + 7": lambda: _file("b02"),
    "13": lambda: _file("b06"),
    "one URDF": lambda: _file("b08"),
}


@pytest.mark.parametrize("case", CASES)
def test_derivatives_are_those_of_solving_again_a_little_further(case):
    problem = CASES[case]()
    rng = np.random.default_rng(0)
    starts = rng.uniform(problem.lower, problem.upper, (60, 1, problem.n))
    ends = solve_many(problem, np.repeat(starts, problem.k, axis=1), jobs=1)
    rough = ends.q[np.argmin(np.where(ends.converged & ~ends.saddle, ends.objective, np.inf))]
    middle = solve(problem, rough, TIGHT)
    best = solve(problem, middle.q, WARM, warm=middle.multipliers)
    names = [name for name in ELEMENTS if case != "one URDF" or not name.startswith("base2")]
    free = checked({name: (-0.3, 0.3) for name in names}, problem.cell)
    found = sensitivity(problem, best, free)
    assert found.regular
    step, size = 1e-4, max(1.0, best.objective)
    for k in range(len(names)):
        sides = []
        for sign in (-1.0, 1.0):
            there = placed(problem, free, sign * step * np.eye(len(names))[k])
            sides.append(solve(there, best.q, WARM, warm=best.multipliers))
        below, above = sides
        slope = (above.objective - below.objective) / (2.0 * step)
        assert slope == pytest.approx(found.gradient[k], abs=1e-6 * size, rel=1e-6), names[k]
        joints = (above.q - below.q) / (2.0 * step)
        assert joints == pytest.approx(found.joints[k], abs=2e-3, rel=2e-3), names[k]
        bend = (above.objective + below.objective - 2.0 * best.objective) / step**2
        assert bend == pytest.approx(found.curvature[k, k], abs=1e-2 * size, rel=1e-2), names[k]
    assert found.curvature == pytest.approx(found.curvature.T, abs=1e-6 * size)


def test_parameters_move_what_pinocchio_moves(paper):
    problem, best = paper
    values = np.random.default_rng(5).uniform(-0.3, 0.3, len(ELEMENTS))
    free = checked(EVERY, problem.cell)
    change = dict(zip([each.name for each in free], values, strict=True))
    there = evaluate(placed(problem, free, values), best.q)
    cell = problem.cell.moved(base2=moved_base(problem.cell.arms[1].base, change))
    piece, length = workpiece_pose(change), change["tool2.length"]
    tool = pin.SE3(np.eye(3), np.array([0.0, 0.0, length]))
    wanted = [
        piece * pin.SE3(R, p) * tool.inverse()
        for R, p in zip(problem.points.rotation, problem.points.position, strict=True)
    ]
    moved = Problem.of(
        cell,
        problem.index,
        np.array([pose.translation for pose in wanted]),
        np.array([pose.rotation for pose in wanted]),
        lower=problem.lower,
        upper=problem.upper,
    )
    here = evaluate(moved, best.q)
    # The tool's tip is `length` ahead of the flange: both miss their targets by the same turn.
    size = np.linalg.norm(there.residual[:, 3:], axis=1)
    assert size == pytest.approx(np.linalg.norm(here.residual[:, 3:], axis=1))
    assert np.abs(there.residual[:, :3]).max() > 0.05


def test_rows_keep_to_their_bodies_when_these_move(problem):
    world = {"frame": "arm2/tip", "z": 0.2}
    rows = (above(**world), half_space("arm1/tip", normal=(1.0, 0.0, 0.0), offset=0.3))
    cell, q = problem.cell, 0.5 * (problem.lower + problem.upper)
    asked = Problem.of(
        cell, problem.index, np.zeros((1, 3)), np.eye(3),
        lower=problem.lower, upper=problem.upper, rows=rows,
    )  # fmt: skip
    free = checked(EVERY, cell)
    values = np.where([each.name.startswith("base2") for each in free], 0.17, 0.0)
    change = dict(zip([each.name for each in free], values, strict=True))
    moved = cell.moved(base2=moved_base(cell.arms[1].base, change))
    gap = evaluate(placed(asked, free, values), q[None]).gap[0]
    assert gap == pytest.approx([float(np.ravel(row.at(moved, q)[0])[0]) for row in rows])
    step, shared = 1e-6, share(asked, free)
    there = evaluate(shared, shared.posture(q[None], values))
    for k in range(shared.shared):
        by = step * np.eye(shared.shared)[k]
        ahead = evaluate(placed(asked, free, values + by), q[None]).gap[0]
        behind = evaluate(placed(asked, free, values - by), q[None]).gap[0]
        slope = (ahead - behind) / (2.0 * step)
        assert there.row_jacobian[0, :, 12 + k] == pytest.approx(slope, abs=1e-7)


def test_a_parameter_that_the_cell_does_not_have_or_a_crossed_box_is_refused(paper):
    cell = paper[0].cell
    with pytest.raises(UnknownNameError, match=r"base2\.yaw"):
        checked({"base2.yow": (0.0, 1.0)}, cell)
    with pytest.raises(InputError, match="lower end must be below"):
        checked({"base2.x": (1.0, 1.0)}, cell)
    with pytest.raises(InputError, match="neither has a base to move"):
        checked({"base2.x": (0.0, 1.0)}, _file("b08").cell)
    weighed = checked((Free("base2.y", -1.0, 1.0, 0.5), Free("base2.x", -1.0, 1.0)), cell)
    assert [each.name for each in weighed] == ["base2.x", "base2.y"]
