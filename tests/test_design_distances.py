"""Distances while a motion is followed: the same as measuring all pairs at every point."""

from __future__ import annotations

import numpy as np
import pytest

from dualarm_pin.clearance.asked import asked_of
from dualarm_pin.clearance.nearest import nearest_along
from dualarm_pin.design import Session
from dualarm_pin.design.distances import Distances
from dualarm_pin.design.places import segment_distance
from dualarm_pin.task.changed import changed_task


@pytest.mark.parametrize("clearance", [0.0, 0.05])
def test_along_a_drag_the_nearest_pair_is_that_of_all_pairs(task, clearance):
    session = Session(task)
    required = asked_of(changed_task(task, clearance=clearance)).required
    distances, lacks, pairs = Distances(task.cell, task.path.h), set(), len(required)
    measured = []
    for step in range(25):
        q = session.move(base2_x=2.5 - 0.45 * np.sin(step / 8), base2_yaw=np.pi + step / 100).q
        cell, before = session.moved_task().cell, distances.measured
        every, near = nearest_along(cell, q, required, inner=0), distances.near(cell, q, required)
        assert near.lacking == any(every.lacking)
        if every.distance.min() > 0.0:
            assert near.distance == pytest.approx(every.distance.min(), abs=1e-6)
            assert near.pair == cell.pairs[every.pair[near.point]]
        else:  # Coal's depth of a collision depends on where it begins to look
            assert near.distance <= 0.0
        lacks.add(near.lacking)
        measured.append(distances.measured - before)
    assert lacks == {True, False}  # both were met
    assert np.mean(measured[1:]) < 0.02 * pairs * task.path.h


def test_pairs_left_out_are_never_measured(task):
    session = Session(task)
    distances = Distances(task.cell, task.path.h)
    nothing = np.full(len(task.cell.pairs), -np.inf)
    assert distances.near(task.cell, session.answer.q, nothing) is None
    assert distances.measured == 0


def test_segments_are_as_far_apart_as_their_nearest_points():
    random = np.random.default_rng(0)
    first, second = random.uniform(-1, 1, (2, 200, 2, 3))
    first[:20, 1] = first[:20, 0]  # points
    second[10:30, 1] = second[10:30, 0]
    second[30:40, 1] = second[30:40, 0] + (first[30:40, 1] - first[30:40, 0])  # parallel
    s = np.linspace(0, 1, 401)
    found = segment_distance(first, second)
    for a, b, distance in zip(first, second, found, strict=True):
        one = a[0] + s[:, None] * (a[1] - a[0])
        along = b[1] - b[0]
        t = np.clip((one - b[0]) @ along / max(along @ along, 1e-24), 0, 1)
        near = np.linalg.norm(one - b[0] - t[:, None] * along, axis=1).min()
        assert near - 1e-5 * 3 <= distance <= near + 1e-12
