from __future__ import annotations

import numpy as np
import pytest

from dualarm_pin import indices
from dualarm_pin.errors import InputError, ShapeError
from dualarm_pin.indices.spectral import SMOOTHING_ERROR

ALL = [
    indices.force,
    indices.velocity,
    indices.yoshikawa,
    indices.inverse_condition_number,
    indices.smallest_singular_value,
]
WEIGHTS = [None, (1, 1, 1, 0, 0, 0), (1, 1, 1, 0.1, 0.2, 0.3)]


def random_case(seed: int) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    J = rng.normal(size=(6, 9))
    return J, rng.normal(size=6)


@pytest.mark.parametrize("make", ALL)
@pytest.mark.parametrize("weights", WEIGHTS)
def test_derivatives_agree_with_differences(make, weights):
    report = indices.check_derivatives(make(task_weights=weights), n=10, seed=3, tolerance=1e-6)
    assert report.passed, str(report)


def test_values_from_singular_values():
    J, u = random_case(0)
    A = J @ J.T
    sigma = np.linalg.svd(J, compute_uv=False)
    assert indices.force().phi(A, u) == pytest.approx(np.sum((J.T @ u) ** 2))
    assert indices.velocity().phi(A, u) == pytest.approx(u @ np.linalg.solve(A, u))
    assert indices.yoshikawa().phi(A, u) == pytest.approx(-np.prod(sigma))
    assert indices.inverse_condition_number().exact(A, u) == pytest.approx(-sigma[-1] / sigma[0])
    assert indices.smallest_singular_value().exact(A, u) == pytest.approx(-sigma[-1])


SMOOTH = {indices.smallest_singular_value: 1, indices.inverse_condition_number: 2}


@pytest.mark.parametrize(("make", "extremes"), SMOOTH.items())
def test_the_smooth_index_is_as_near_to_the_true_one_as_it_says(make, extremes):
    index, rng = make(), np.random.default_rng(5)
    for spread in (0.0, 1e-9, 1e-3, 0.1, 1.0):
        V = np.linalg.qr(rng.normal(size=(6, 6)))[0]
        A = (V * (1.0 + spread * rng.uniform(size=6))) @ V.T
        share = index.phi(A, np.zeros(6)) / index.exact(A, np.zeros(6))
        least = (1.0 - SMOOTHING_ERROR) ** extremes
        assert least - 1e-12 <= share <= 1.0 + 1e-12
        if spread == 0.0:
            assert share == pytest.approx(least)
    assert SMOOTHING_ERROR < 0.015
    A = np.diag([1e-4, 1.0, 1.1, 1.2, 1.3, 2.0])
    assert indices.smallest_singular_value().phi(A, np.zeros(6)) == pytest.approx(-0.01, rel=1e-12)


@pytest.mark.parametrize("make", ALL)
def test_casadi_computes_the_same_index(make):
    ca = pytest.importorskip("casadi")
    J, u = random_case(4)
    A, symbol = J @ J.T, ca.SX.sym("A", 6, 6)
    value = ca.Function("c", [symbol], [make().expression(ca, symbol, ca.DM(u))])(A)
    assert float(value) == pytest.approx(make().phi(A, u), rel=1e-9)


def test_rows_of_weight_zero_do_not_count():
    J, u = random_case(1)
    J[3:] = 0.0
    A, A3 = J @ J.T, J[:3] @ J[:3].T
    sigma = np.linalg.svd(J[:3], compute_uv=False)
    assert indices.velocity().phi(A, u) == pytest.approx(u[:3] @ np.linalg.solve(A3, u[:3]))
    assert indices.yoshikawa().phi(A, u) == pytest.approx(-np.prod(sigma))
    assert indices.inverse_condition_number().exact(A, u) == pytest.approx(-sigma[-1] / sigma[0])
    assert indices.smallest_singular_value().exact(A, u) == pytest.approx(-sigma[-1])


def test_singular_matrix_gives_no_nan():
    J, u = random_case(2)
    J[5] = J[4]
    A = J @ J.T
    D = np.eye(6)
    for make in ALL:
        index = make()
        assert not np.isnan(index.phi(A, u))
        assert np.isfinite(index.gradient(A, u)).all()
        assert np.isfinite(index.curvature(A, u, D)).all()
    assert indices.velocity().phi(A, u) > 1e10


def test_custom_by_differences_equals_the_written_one():
    J, u = random_case(3)
    A, D = J @ J.T, np.diag(np.arange(6.0))
    written = indices.velocity()
    own = indices.custom("own", written.phi)
    half = indices.custom("half", written.phi, written.gradient)
    G, C = written.gradient(A, u), written.curvature(A, u, D)
    assert np.allclose(own.gradient(A, u), G, rtol=1e-6, atol=1e-8)
    assert np.allclose(half.curvature(A, u, D), C, rtol=1e-6, atol=1e-8)
    assert np.allclose(own.curvature(A, u, D), C, rtol=1e-3, atol=1e-6)


def test_check_derivatives_finds_a_wrong_gradient():
    right = indices.velocity()
    wrong = indices.custom("wrong", right.phi, lambda A, u: 2.0 * right.gradient(A, u))
    report = indices.check_derivatives(wrong)
    assert not report.passed
    assert "DISAGREE" in str(report)
    with pytest.raises(InputError, match="wrong: index 'wrong': derivatives DISAGREE"):
        indices.check_derivatives(wrong, strict=True)


def test_messages():
    with pytest.raises(ShapeError, match=r"task_weights: has shape \(3,\), not \(6,\)"):
        indices.force(task_weights=[1, 1, 1])
    with pytest.raises(InputError, match="joint_weights: must be finite and 0 or more"):
        indices.force(joint_weights=[1, -1])
    with pytest.raises(InputError, match=r"joint_centre: is -1.0, must be 0 or more"):
        indices.force().with_joint_centre(-1)
    with pytest.raises(InputError, match="curvature: needs a gradient"):
        indices.custom("x", lambda A, u: 0.0, curvature=lambda A, u, D: A)
    with pytest.raises(InputError, match="phi: is 3, must be a function"):
        indices.custom("x", 3)
    with pytest.raises(InputError, match="n: is 0, must be 1 or more"):
        indices.check_derivatives(indices.force(), n=0)
