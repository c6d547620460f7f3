"""Every derivative of the engine against central differences, and J_r against Pinocchio."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
from engine_cases import BareCell, ns16_cell, random_pair, random_problem

from dualarm_pin import indices
from dualarm_pin.engine.evaluation import evaluate
from dualarm_pin.problem import Problem

INDICES = [
    indices.force(),
    indices.force(task_weights=[1, 2, 1, 0.3, 0.2, 0.1], joint_weights=np.arange(1.0, 10.0)),
    indices.velocity(joint_centre=0.3),
    indices.velocity(task_weights=[1, 1, 1, 0, 0, 0]),
    indices.yoshikawa(task_weights=[1, 1, 1, 0.1, 0.1, 0.1]),
    indices.inverse_condition_number(joint_weights=np.arange(1.0, 10.0)),
    indices.smallest_singular_value(),
]


def label(index):
    return index.name + ("-weighted" if index.task_weights is not None else "")


def posture(data, seed=5):
    shape = (len(data.points.position), len(data.lower))
    return np.random.default_rng(seed).uniform(-1.0, 1.0, shape)


def differences(function, q, step):
    """Return d function / dq, the last two axes those of q."""
    columns = []
    for i in range(q.shape[0]):
        for k in range(q.shape[1]):
            up, down = q.copy(), q.copy()
            up[i, k] += step
            down[i, k] -= step
            columns.append((function(up) - function(down)) / (2 * step))
    return np.moveaxis(np.array(columns), 0, -1)


def full_hessian(data, at):
    """Return the block tridiagonal Hessian (k n, k n) as a dense matrix."""
    k, n = at.gradient.shape
    H = np.zeros((k, n, k, n))
    for i in range(k):
        H[i, :, i] = at.hessian[i]
    for i in range(k - 1):
        bend = 8.0 * data.links.weight[i] * np.outer(at.link[i], at.link[i])
        H[i + 1, :, i] = H[i, :, i + 1] = -(
            at.stiffness[i] * np.diag(data.links.metric_of(i)) + bend
        )
    return H.reshape(k * n, k * n)


@pytest.mark.parametrize("index", INDICES, ids=label)
@pytest.mark.parametrize("seed", [1, 2])
def test_gradient_and_hessian(index, seed):
    data = random_problem(seed, index)
    q = posture(data)
    y = np.random.default_rng(7).normal(size=(len(q), 6))
    at = evaluate(data, q, y)

    gradient = differences(lambda x: evaluate(data, x).objective, q, 1e-6)
    scale = max(1.0, np.abs(gradient).max())
    assert np.abs(at.gradient.ravel() - gradient).max() < 1e-7 * scale

    def lagrangian_gradient(x):
        there = evaluate(data, x)
        rows = np.arange(6) < data.points.pose_rows[:, None]
        return (there.gradient + np.einsum("ir,irk->ik", y * rows, there.jacobian)).ravel()

    hessian = differences(lagrangian_gradient, q, 1e-6)
    scale = max(1.0, np.abs(hessian).max())
    assert np.abs(full_hessian(data, at) - hessian).max() < 1e-6 * scale


@pytest.mark.parametrize("seed", range(4))
def test_residual_jacobian(seed):
    data = random_problem(seed, indices.force())
    q = posture(data)
    at = evaluate(data, q)
    jacobian = differences(lambda x: evaluate(data, x).residual.ravel(), q, 1e-6)
    k, n = q.shape
    jacobian = jacobian.reshape(k, 6, k, n)
    for i, rows in enumerate(data.points.pose_rows):
        assert np.abs(at.jacobian[i, :rows] - jacobian[i, :rows, i]).max() < 1e-8
        assert np.array_equal(at.residual[i, rows:], np.zeros(6 - rows))


def pose_of(model, e1, e2, q):
    data = model.createData()
    pin.framesForwardKinematics(model, data, q)
    return data.oMf[e1].actInv(data.oMf[e2])


def reference_jacobian(model, e1, e2, q):
    """Return J_r (6, nv) from Pinocchio's frame Jacobians."""
    data = model.createData()
    pin.computeJointJacobians(model, data, q)
    pin.updateFramePlacements(model, data)
    J1, J2 = (
        pin.getFrameJacobian(model, data, e, pin.LOCAL_WORLD_ALIGNED)
        if model.nv  # Pinocchio crashes on a model without joints
        else np.zeros((6, model.nv))
        for e in (e1, e2)
    )
    T1, T2 = data.oMf[e1], data.oMf[e2]
    turning = pin.skew(T2.translation - T1.translation) @ J1[3:]
    R1 = T1.rotation.T
    return np.vstack([R1 @ (J2[:3] - J1[:3] + turning), R1 @ (J2[3:] - J1[3:])])


@pytest.mark.parametrize("rows", [6, 5, 3])
def test_residual_vanishes_at_the_pose_and_only_there(rows):
    model, e1, e2 = random_pair(3)
    rng = np.random.default_rng(0)
    q = rng.uniform(-1, 1, model.nv)
    T = pose_of(model, e1, e2, q)
    axis = rng.normal(size=3)
    axis /= np.linalg.norm(axis)
    cell = BareCell(model, e1, e2)

    def residual(turn):
        data = Problem.of(
            cell,
            indices.force(),
            T.translation[None],
            (T.rotation @ turn)[None],
            lower=np.full(model.nv, -3),
            upper=np.full(model.nv, 3),
            pose_rows=[rows],
            spin_axis=axis,
        )
        return evaluate(data, q[None]).residual[0]

    across = np.cross(axis, [0.3, 0.5, 0.7])
    across /= np.linalg.norm(across)
    spin = pin.exp3(1.1 * axis)
    half = pin.exp3(np.pi * across)
    assert np.abs(residual(np.eye(3))).max() < 1e-12
    assert (np.abs(residual(spin)).max() < 1e-12) == (rows < 6)
    # half a turn is the farthest there is, not a second zero
    assert np.linalg.norm(residual(half)) == pytest.approx(2.0 if rows > 3 else 0.0, abs=1e-9)
    assert np.linalg.norm(residual(spin @ pin.exp3(0.4 * across))) == pytest.approx(
        {6: 2 * np.sqrt(1 - (np.cos(0.55) * np.cos(0.2)) ** 2), 5: 2 * np.sin(0.2), 3: 0.0}[rows],
        abs=1e-9,
    )


@pytest.mark.parametrize("joints", [(5, 6), (0, 7), (4, 0), (0, 0)])
def test_relative_jacobian_equals_pinocchio(joints):
    model, e1, e2 = random_pair(11, joints)
    cell = BareCell(model, e1, e2)
    q = np.random.default_rng(1).uniform(-1, 1, model.nv)
    T = pose_of(model, e1, e2, q)
    data = Problem.of(
        cell,
        indices.force(),
        T.translation[None],
        T.rotation[None],
        lower=np.full(model.nv, -3),
        upper=np.full(model.nv, 3),
    )
    at = evaluate(data, q[None])
    assert np.abs(at.residual).max() < 1e-12
    expected = reference_jacobian(model, e1, e2, q)
    assert at.J_r[0].shape == expected.shape
    assert np.allclose(at.J_r[0], expected, atol=1e-12, rtol=0)


def test_mimic_joint_and_common_joint():
    """A joint below both arms cancels; a variable that drives two joints sums their columns."""
    model, e1, e2 = random_pair(4, (3, 3), prismatic=0.0)
    joint_map = np.zeros((6, 5))
    joint_map[:5] = np.eye(5)
    joint_map[5, 1] = 2.0
    offset = np.array([0, 0, 0, 0, 0, 0.4])
    cell = BareCell(model, e1, e2, joint_map, offset)
    q = np.random.default_rng(2).uniform(-1, 1, 5)
    T = pose_of(model, e1, e2, joint_map @ q + offset)
    data = Problem.of(
        cell,
        indices.force(),
        T.translation[None],
        T.rotation[None],
        lower=np.full(5, -3),
        upper=np.full(5, 3),
    )
    at = evaluate(data, q[None])
    assert np.abs(at.residual).max() < 1e-12
    expected = reference_jacobian(model, e1, e2, joint_map @ q + offset) @ joint_map
    assert np.allclose(at.J_r[0], expected, atol=1e-12, rtol=0)


def test_published_cell_reference():
    """Twenty postures of the paper's cell, computed with another implementation."""
    file = Path(__file__).parent / "data" / "ns16_reference.json"
    if not file.exists():
        pytest.skip("tests/data/ns16_reference.json is missing")
    cell = ns16_cell()
    for case in json.loads(file.read_text())["cases"]:
        data = Problem.of(
            cell,
            indices.force(),
            [case["position"]],
            [case["rotation"]],
            lower=np.full(12, -4.0),
            upper=np.full(12, 4.0),
        )
        at = evaluate(data, [case["q"]])
        assert np.abs(at.residual).max() < 1e-9
        assert np.allclose(at.J_r[0], case["J_r"], atol=1e-9, rtol=0)
