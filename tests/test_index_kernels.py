"""The engine's closed form of every index against Pinocchio's side, easy postures and hard ones."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest
from engine_cases import BareCell, random_pair

from dualarm_pin import indices, reference
from dualarm_pin.engine.evaluation import evaluate
from dualarm_pin.engine.kernels import KERNELS
from dualarm_pin.errors import InputError
from dualarm_pin.problem import Problem
from dualarm_pin.relative import Relative


def gantry(wrist):
    """Return a model of three slides and a wrist whose axes meet in the hand."""
    model, parent = pin.Model(), 0
    slides = [pin.JointModelPX(), pin.JointModelPY(), pin.JointModelPZ()]
    turns = {"x": pin.JointModelRX, "y": pin.JointModelRY, "z": pin.JointModelRZ}
    hand = model.addFrame(pin.Frame("base", 0, pin.SE3.Identity(), pin.FrameType.BODY))
    for number, joint in enumerate([*slides, *(turns[axis]() for axis in wrist)]):
        parent = model.addJoint(parent, joint, pin.SE3.Identity(), f"joint {number}")
    other = model.addFrame(pin.Frame("hand", parent, pin.SE3.Identity(), pin.FrameType.BODY))
    return BareCell(model, hand, other)


CASES = {
    "7 + 7 joints": (lambda: BareCell(*random_pair(21, (7, 7))), np.linspace(-1.0, 1.2, 14)),
    "5 + 6 joints": (lambda: BareCell(*random_pair(8, (5, 6))), np.linspace(1.0, -0.7, 11)),
    "six equal eigenvalues": (lambda: gantry("zyx"), np.zeros(6)),
    "two nearly equal": (lambda: gantry("zyx"), np.array([0, 0, 0, 0.3, 1e-7, 0.2])),
    "nearly singular": (lambda: gantry("zyz"), np.array([0, 0, 0, 0.3, 5e-3, 0.2])),
}
WEIGHTS = {
    "plain": {},
    "weighted": {"task_weights": [1, 2, 1, 0.3, 0.2, 0.1], "joint_centre": 0.2},
    "position alone": {"task_weights": [1, 1, 1, 0, 0, 0]},
}


def problem_of(cell, index):
    n = cell.n
    return Problem.of(
        cell,
        index,
        np.zeros((1, 3)),
        np.eye(3),
        lower=np.full(n, -3.0),
        upper=np.full(n, 3.0),
        u=np.array([[0.3, -0.5, 0.8, 0.1, 0.2, -0.1]]),
        index_weight=1.7,
    )


@pytest.mark.parametrize("name", ["force", *KERNELS])
@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("weights", WEIGHTS)
def test_value_gradient_and_hessian_are_those_of_pinocchio(name, case, weights):
    make, q = CASES[case]
    cell = make()
    given = WEIGHTS[weights] | {"joint_weights": np.linspace(0.5, 2.0, cell.n)}
    if case == "six equal eigenvalues":
        given["joint_weights"] = np.ones(cell.n)
    problem = problem_of(cell, indices.INDICES[name](**given))
    at = evaluate(problem, q[None])

    def gradient(x):
        return reference.point_gradient(problem, 0, Relative(cell, x))[1]

    value, expected = reference.point_gradient(problem, 0, Relative(cell, q))
    assert at.objective == pytest.approx(value, rel=1e-9)
    assert at.gradient[0] == pytest.approx(
        expected, rel=1e-7, abs=1e-9 + 1e-7 * np.abs(expected).max()
    )
    step = 1e-6 * np.eye(cell.n)
    columns = [(gradient(q + d) - gradient(q - d)) / 2e-6 for d in step]
    # the differences are good to the square of the step over the distance to a singular posture
    allowed = 1e-5 * max(1.0, np.abs(columns).max())
    assert np.abs(at.hessian[0] - np.array(columns).T).max() < allowed


def test_an_unknown_kernel_is_named():
    index = replace(indices.velocity(), kernel="speed")
    cell = CASES["5 + 6 joints"][0]()
    with pytest.raises(InputError, match=r"index.kernel: is 'speed', allowed are force, velocity"):
        evaluate(problem_of(cell, index), np.zeros((1, cell.n)))
