"""The smallest distances along a path: as those of each posture alone, with fewer measured."""

from __future__ import annotations

import numpy as np
import pytest

from dualarm_pin.answer.distances import distances_along
from dualarm_pin.cell import Cell


def between(cell: Cell, points: int, seed: int) -> np.ndarray:
    """Return postures on a straight line in the joints, somewhere."""
    first, last = np.random.default_rng(seed).uniform(cell.lower, cell.upper, (2, cell.n))
    return first + np.linspace(0.0, 0.3, points)[:, None] * (last - first)


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_distances_along_are_those_of_each_posture(cell: Cell, seed: int) -> None:
    q = between(cell, 40, seed)
    for found, arms in zip(distances_along(cell, q), (False, True), strict=True):
        assert found is not None
        for x, distance, pair in zip(q, found.distance, found.pairs, strict=True):
            alone = cell.clearance(x, between_arms=arms)
            assert alone is not None
            if alone.distance <= 0.0:
                alone = cell.clearance(x, between_arms=arms, exact=True)
                assert alone is not None
            assert distance == pytest.approx(alone.distance, abs=1e-5)
            assert pair == (alone.first, alone.second)


def test_most_pairs_are_measured_at_few_points(cell: Cell, monkeypatch: pytest.MonkeyPatch) -> None:
    q, asked = between(cell, 200, 5), {"all": 0, "one": 0}
    distances, distance = Cell.distances, Cell.distance

    def all_of(cell, q):
        asked["all"] += 1
        return distances(cell, q)

    def one_of(cell, q, pair, *, exact=False):
        asked["one"] += 1
        return distance(cell, q, pair, exact=exact)

    monkeypatch.setattr(Cell, "distances", all_of)
    monkeypatch.setattr(Cell, "distance", one_of)
    distances_along(cell, q)
    assert 1 <= asked["all"] <= 20
    assert asked["one"] < 6 * len(q) < len(cell.pairs) * len(q) / 4


def test_one_posture_is_a_path_too(cell: Cell) -> None:
    one, arms = distances_along(cell, between(cell, 1, 3))
    assert one is not None
    assert arms is not None
    assert len(one.distance) == len(arms.pairs) == 1
