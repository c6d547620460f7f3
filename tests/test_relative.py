"""The reference kinematics: against another implementation, and against differences."""

from __future__ import annotations

import json
import pickle
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

from dualarm_pin.cell import Cell
from dualarm_pin.errors import ShapeError
from dualarm_pin.relative import Relative

REFERENCE = Path(__file__).parent / "data" / "ns16_reference.json"


def difference(cell: Cell, q: np.ndarray, step: float = 1e-5) -> np.ndarray:
    """Return J_r (6, n) by central differences of the pose alone."""
    columns = []
    here = Relative(cell, q).T_e1_e2
    for k in range(cell.n):
        e = step * np.eye(cell.n)[k]
        ahead, behind = Relative(cell, q + e).T_e1_e2, Relative(cell, q - e).T_e1_e2
        linear = (ahead.translation - behind.translation) / (2 * step)
        turn = pin.log3(ahead.rotation @ here.rotation.T) - pin.log3(
            behind.rotation @ here.rotation.T
        )
        columns.append(np.r_[linear, turn / (2 * step)])
    return np.column_stack(columns)


def derivative_difference(cell: Cell, q: np.ndarray, step: float = 1e-5) -> np.ndarray:
    """Return dJ_r (6, n, n) by central differences of J_r."""
    E = step * np.eye(cell.n)
    return np.stack(
        [(Relative(cell, q + e).J_r - Relative(cell, q - e).J_r) / (2 * step) for e in E],
        axis=2,
    )


def test_pose_and_jacobian_agree_with_another_implementation(cell: Cell) -> None:
    for case in json.loads(REFERENCE.read_text())["cases"]:
        at = Relative(cell, case["q"])
        np.testing.assert_allclose(at.T_e1_e2.translation, case["position"], atol=1e-9)
        np.testing.assert_allclose(at.T_e1_e2.rotation, case["rotation"], atol=1e-9)
        np.testing.assert_allclose(at.J_r, case["J_r"], atol=1e-9)


@pytest.mark.parametrize("seed", range(3))
def test_jacobian_and_derivative_agree_with_differences(cell: Cell, seed: int) -> None:
    q = np.random.default_rng(seed).uniform(cell.lower, cell.upper)
    at = Relative(cell, q)
    np.testing.assert_allclose(at.J_r, difference(cell, q), atol=1e-8)
    np.testing.assert_allclose(at.dJ_r, derivative_difference(cell, q), atol=1e-8)


def test_results_survive_the_next_call(cell: Cell) -> None:
    first = Relative(cell, np.zeros(12))
    J_r, position = first.J_r.copy(), first.T_e1_e2.translation.copy()
    dJ_r = first.dJ_r.copy()
    again = Relative(cell, np.zeros(12))
    Relative(cell, np.full(12, 0.3))
    np.testing.assert_array_equal(first.J_r, J_r)
    np.testing.assert_array_equal(first.T_e1_e2.translation, position)
    np.testing.assert_array_equal(again.dJ_r, dJ_r)


def test_a_pickled_cell_gives_the_same(cell: Cell) -> None:
    copy = pickle.loads(pickle.dumps(cell))
    q = np.random.default_rng(1).uniform(cell.lower, cell.upper)
    np.testing.assert_array_equal(Relative(copy, q).J_r, Relative(cell, q).J_r)
    assert copy.clearance(q).distance == pytest.approx(cell.clearance(q).distance, abs=1e-12)


def test_a_wrong_shape_names_both_shapes(cell: Cell) -> None:
    with pytest.raises(ShapeError, match=r"\(11,\).*12 joints"):
        Relative(cell, np.zeros(11))
