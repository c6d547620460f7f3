"""Peers: CasADi on the same problem, Pink on a local one."""

from dataclasses import replace

import numpy as np
import pytest
from paper_case import TASK

from dualarm_pin import indices
from dualarm_pin.errors import InputError, MissingExtraError
from dualarm_pin.planners.methods import plan
from dualarm_pin.reference import index_value, pose_residual
from dualarm_pin.relative import Relative
from dualarm_pin.search.starts import common_postures, generator
from dualarm_pin.task import Task


@pytest.fixture(scope="module")
def task():
    return Task.load(
        TASK,
        ["path.corner.points=[3, 1, 3]", "two_stage.Gamma=[1, 4, 7]"],
    )


@pytest.fixture(scope="module")
def ca():
    return pytest.importorskip("casadi")


def test_symbolic_kinematics_equal_pinocchio(ca, task):
    from dualarm_pin.solvers.casadi_model import kinematics

    q = ca.SX.sym("q", task.cell.n)
    function = ca.Function("f", [q], [ca.densify(x) for x in kinematics(task.cell, q)[:4]])
    random = generator(1)
    for _ in range(20):
        x = random.uniform(task.cell.lower, task.cell.upper)
        position, rotation, _, jacobian = (np.array(value) for value in function(x))
        relative = Relative(task.cell, x)
        assert np.allclose(position.ravel(), relative.T_e1_e2.translation, atol=1e-12)
        assert np.allclose(rotation, relative.T_e1_e2.rotation, atol=1e-12)
        assert np.allclose(jacobian, relative.J_r, atol=1e-12)


@pytest.mark.parametrize("rows", [6, 5, 3])
def test_pose_rows_equal_those_of_the_problem(ca, task, rows):
    from dualarm_pin.chain import quaternion_of
    from dualarm_pin.solvers.casadi_model import kinematics, pose_rows

    axis = np.array([0.6, 0.0, 0.8])
    q = ca.SX.sym("q", task.cell.n)
    pose = kinematics(task.cell, q)
    random = generator(2)
    for _ in range(20):
        x, wanted = random.uniform(task.cell.lower, task.cell.upper, (2, task.cell.n))
        target = Relative(task.cell, wanted).T_e1_e2
        residual = pose_rows(
            pose, target.translation, ca.DM(quaternion_of(target.rotation)), rows, axis
        )
        got = np.array(ca.Function("g", [q], [residual])(x)).ravel()
        expected = pose_residual(
            Relative(task.cell, x), target.translation, target.rotation, rows, axis
        )[0]
        if rows == 6 and got[3:] @ expected[3:] < 0:  # the other quaternion of the same rotation
            got[3:] *= -1.0
        assert np.allclose(got, expected, atol=1e-9)


@pytest.mark.parametrize(
    "index",
    [
        indices.force(),
        indices.force(task_weights=[1, 1, 1, 0.2, 0, 0], joint_weights=np.linspace(0.5, 2, 12)),
        indices.velocity(),
        indices.velocity(task_weights=[1, 1, 1, 0, 0, 0]),
        indices.yoshikawa(),
    ],
    ids=lambda index: index.name,
)
def test_index_expressions_equal_the_indices(ca, task, index):
    from dualarm_pin.solvers.casadi_model import index_expression, kinematics

    q = ca.SX.sym("q", task.cell.n)
    u = np.array([0.6, 0.0, 0.8, 0.1, -0.2, 0.3])
    jacobian = kinematics(task.cell, q).jacobian
    function = ca.Function("c", [q], [index_expression(index, jacobian, ca.SX(ca.DM(u)))])
    random = generator(3)
    for _ in range(10):
        x = random.uniform(task.cell.lower, task.cell.upper)
        expected = index_value(
            index, Relative(task.cell, x), u, x, (task.cell.lower, task.cell.upper)
        )
        assert float(function(x)) == pytest.approx(expected, rel=1e-6)


def test_an_index_without_an_expression_is_refused(ca, task):
    bare = replace(indices.smallest_singular_value(), expression=None)
    with pytest.raises(InputError, match="no expression for the index 'smallest_singular_value'"):
        plan(replace(task, index=bare), "casadi")


@pytest.mark.parametrize("plugin", ["ipopt", "fatrop"])
def test_casadi_ends_where_the_engine_ends(ca, task, plugin):
    from dualarm_pin.solvers import casadi_ipopt
    from dualarm_pin.solvers import interior_point as engine

    problem = task.problem()
    starts = common_postures(problem.lower, problem.upper, problem.k, 40, generator(0))
    ends = engine.solve_many(problem, starts, jobs=1)
    first = int(np.flatnonzero(ends.converged)[0])
    start = ends.q[first] + generator(4).uniform(-0.02, 0.02, ends.q[first].shape)
    end = casadi_ipopt.solve(problem, start, plugin)
    assert end.feasible and end.converged, end.message
    assert end.objective == pytest.approx(ends.objective[first], rel=1e-6)


def test_casadi_solves_between_fixed_neighbours(ca, task):
    from dualarm_pin.solvers import casadi_ipopt
    from dualarm_pin.solvers import interior_point as engine

    whole = task.problem()
    starts = common_postures(whole.lower, whole.upper, whole.k, 40, generator(0))
    ends = engine.solve_many(whole, starts, jobs=1)
    q = ends.q[int(np.flatnonzero(ends.converged)[0])]
    gap = whole.subset([1, 2], 3.0, before=q[0], after=q[3])
    ours, theirs = engine.solve(gap, q[1:3]), casadi_ipopt.solve(gap, q[1:3])
    assert theirs.feasible
    assert theirs.objective == pytest.approx(ours.objective, rel=1e-6)


def test_casadi_as_a_method(ca, task):
    found = plan(task, "casadi", starts=3, seed=1)
    assert found.found and found.method == "casadi" and found.solver == "casadi-ipopt"
    law = found.evidence.laws["whole path"]
    assert law.starts == 3 and 1 <= law.best_hits <= law.converged <= 3
    assert found.evidence.verdict == "local_only"


def test_casadi_hits_of_a_negative_objective_are_counted(ca, task):
    """Yoshikawa's index is below zero: the best start is a hit of itself all the same."""
    law = plan(
        replace(task, index=indices.yoshikawa(), smoothness=0.01), "casadi", starts=3, seed=1
    ).evidence.laws["whole path"]
    assert 1 <= law.best_hits <= law.converged <= 3


def test_minima_of_one_objective_are_told_apart_by_their_joints():
    from dualarm_pin.planners.peers import count_starts
    from dualarm_pin.solvers import Solution

    def end(at, objective, converged=True):
        q = np.full((2, 3), at)
        return Solution(q, objective, 0.0, feasible=True, converged=converged, message="")

    ends = [end(0.0, -2.0), end(0.001, -2.0), end(1.0, -2.0), end(2.0, -1.0), end(3.0, -3.0, False)]
    law = count_starts(ends, ends[0])
    assert (law.starts, law.converged, law.minima, law.best_hits) == (5, 4, 3, 2)
    assert count_starts(ends, ends[4]).best_hits == 0


def test_pink_follows_the_path_and_seeks_manipulability(task):
    pytest.importorskip("pink")
    from dualarm_pin.planners.peers import plan_pink

    found = plan(task, "pink", starts=3)
    assert found.found and found.max_bound_violation == 0.0
    still = plan_pink(task, starts=3, manipulability=0.0)
    assert _manipulability(task, found.q[-1]) > _manipulability(task, still.q[-1])
    assert not hasattr(task.cell.model, "tangent"), "Pink wrote into the cell's model"


def _manipulability(task, q):
    import pinocchio as pin

    model = task.cell.model
    data = model.createData()
    J = pin.computeFrameJacobian(model, data, q, task.cell.e2, pin.LOCAL)
    return float(np.sqrt(np.linalg.det(J @ J.T)))


def test_pink_refuses_what_it_cannot_hold(task):
    pytest.importorskip("pink")
    rows = np.full(task.path.h, 5)
    with pytest.raises(InputError, match="whole poses alone"):
        plan(replace(task, path=replace(task.path, rows=rows)), "pink")


def test_a_missing_extra_is_named(task, monkeypatch):
    import sys

    for module, method, extra in (("casadi", "casadi", "casadi"), ("pink", "pink", "pink")):
        monkeypatch.setitem(sys.modules, module, None)
        with pytest.raises(MissingExtraError, match=rf"dualarm-pin\[{extra}\]"):
            plan(task, method)
