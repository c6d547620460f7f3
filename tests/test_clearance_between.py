"""Between the points: what is seen is there, and what is certified holds everywhere."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin
import pytest
from ns16_pair import motions

from dualarm_pin.cell import Cell
from dualarm_pin.clearance import between as module
from dualarm_pin.clearance.between import Between, Search
from dualarm_pin.clearance.travel import travel
from dualarm_pin.files.resources import urdf_folder

if TYPE_CHECKING:
    from dualarm_pin.arrays import Array

NS16 = urdf_folder() / "ns16" / "ns16.urdf"
ROD = {
    "post": {"cylinder": {"radius": 0.05, "length": 2.0}, "at": {"xyz": [1.2, 0.5, 1.0]}},
    "rod": {"capsule": {"radius": 0.02, "length": 0.5}, "on": "arm1", "at": {"xyz": [0, 0, 0.3]}},
}


def random_lines(cell: Cell, count: int, length: float, seed: int = 0) -> Array:
    """Postures of which each is a random step of `length` a joint from the one before."""
    random = np.random.default_rng(seed)
    q = [random.uniform(cell.lower, cell.upper)]
    for _ in range(count):
        q.append(np.clip(q[-1] + random.uniform(-length, length, cell.n), cell.lower, cell.upper))
    return np.array(q)


def look(cell: Cell, q: Array, required: Array) -> tuple[Search, Between]:
    search = Search(cell, q, required)
    return search, search.between()


def dense(cell: Cell, q: Array, samples: int = 41) -> Array:
    """Distances (h - 1, samples, p) on the lines between postures."""
    at = np.linspace(0.0, 1.0, samples)
    return np.array([[cell.distances((1 - t) * a + t * b) for t in at] for a, b in pairwise(q)])


@pytest.fixture(scope="module")
def crowded(cell: Cell) -> Cell:
    limits = {name: (-1.0, 1.0) for name in cell.joint_names}
    base = pin.SE3(np.diag([-1.0, -1, 1]), np.array([2.0, 0, 0]))
    return Cell.from_urdf(NS16, NS16, base2=base, limits=limits, objects=ROD)


def test_no_pair_moves_further_than_the_bound_says(crowded: Cell) -> None:
    """And the bound is of the right size: the worst pairs use a good part of it."""
    q = random_lines(crowded, 12, 0.6)
    seen = dense(crowded, q)
    apart = np.where(seen > 0.0, seen, np.nan)  # the depth of a collision is not exact
    changed, bound = np.abs(apart - apart[:, :1]), travel(crowded, q)
    assert np.nanmax(changed - bound[:, None]) <= 1e-6  # what Coal leaves
    assert np.nanmax(changed / np.maximum(bound, 0.1)[:, None]) > 0.4


@pytest.mark.parametrize("seed", range(4))
def test_the_certificate_holds_and_is_near_the_smallest_distance(crowded: Cell, seed: int) -> None:
    q = random_lines(crowded, 8, 0.3, seed)
    seen = dense(crowded, q)
    free = np.flatnonzero(seen.min(axis=(0, 1)) > 0.0)
    required = np.full(len(crowded.pairs), -np.inf)
    required[free] = 0.0
    search, found = look(crowded, q, required)
    least = float(seen[:, :, free].min())
    assert search.kept
    assert found.bound is not None
    assert found.least - 6e-4 <= found.bound <= least + 1e-9
    assert found.least <= least + 6e-4
    i = int(np.argmin(found.distance))
    at = (1 - found.place[i]) * q[i] + found.place[i] * q[i + 1]
    number = crowded.pairs.index(found.pairs[i])
    assert crowded.distances(at)[number] == pytest.approx(found.least, abs=1e-9)


def test_a_collision_between_two_free_points_is_found(crowded: Cell) -> None:
    """A rod that swings through a thin post: free at both points, and at all inner samples."""
    number = (
        crowded.pairs.index(("post", "rod"))
        if ("post", "rod") in crowded.pairs
        else (crowded.pairs.index(("rod", "post")))
    )
    required = np.full(len(crowded.pairs), -np.inf)
    required[number] = 0.0
    for seed in range(200):
        q = random_lines(crowded, 1, 1.0, seed)
        seen = dense(crowded, q, 81)[0, :, number]
        if seen[::20].min() > 0.0 > seen.min():
            search, found = look(crowded, q, required)
            assert not search.kept
            assert found.least <= 0.0
            assert found.bound is not None
            assert 0.0 < search.worst[2] < 1.0
            return
    raise AssertionError("no such swing was drawn: the test proves nothing")


def test_the_motions_of_the_paper_s_task_are_certified_in_few_distances(cell: Cell) -> None:
    required = np.zeros(len(cell.pairs))
    for q, _ in motions():
        search, found = look(cell, q, required)
        assert found.bound is not None
        assert search.kept
        assert found.least == pytest.approx(0.02574, abs=1e-5)
        assert search.distances < 400


def test_a_certificate_that_takes_too_long_is_not_claimed(
    cell: Cell, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "_MOST", 5)
    search, found = look(cell, motions()[0][0], np.zeros(len(cell.pairs)))
    assert found.bound is None
    assert search.kept  # as far as it was looked at


def test_hulls_that_are_too_near_are_measured_as_meshes(tmp_path) -> None:
    """A rod in the middle of a bracket: the hull says collision, the bracket is open there."""
    from test_cell_objects import bracket

    (tmp_path / "bracket.stl").write_bytes(bracket())
    objects = {
        "bracket": {"mesh": tmp_path / "bracket.stl", "at": {"xyz": [1.5, 0, 1.5]}},
        "rod": {"sphere": 0.05, "on": "arm1", "at": {"xyz": [0, 0, 0.1]}},
    }
    limits = {f"arm{a}/joint_{j}": (-0.3, 0.3) for a in (1, 2) for j in range(1, 7)}
    cell = Cell.from_urdf(NS16, NS16, limits=limits, objects=objects)
    q = np.zeros((2, cell.n))
    q[1] = 0.01
    hand = cell.data()
    pin.framesForwardKinematics(cell.model, hand, cell.model_q(q[0]))
    middle = hand.oMf[cell.e1].act(np.array([0, 0, 0.1])).tolist()
    objects["bracket"]["at"] = {"xyz": middle}
    objects["bracket"]["allow"] = ["arm1/link_6"]
    cell = Cell.from_urdf(NS16, NS16, limits=limits, objects=objects)
    pair = ("bracket", "rod") if ("bracket", "rod") in cell.pairs else ("rod", "bracket")
    required = np.full(len(cell.pairs), -np.inf)
    required[cell.pairs.index(pair)] = 0.02
    assert cell.distances(q[0])[cell.pairs.index(pair)] < 0.0
    search, found = look(cell, q, required)
    assert search.kept
    assert found.least > 0.05


@pytest.mark.parametrize(
    "asks", ["0.02", "{required: 0.4}", "{required: 0.0, between_points: false}"]
)
def test_an_answer_says_what_it_keeps_and_a_result_folder_gives_it_back(asks, tmp_path) -> None:
    from paper_case import TASK

    from dualarm_pin.answer.folder import load_result, save_result
    from dualarm_pin.answer.summary import summary
    from dualarm_pin.answer.verify import verified
    from dualarm_pin.task import Task

    task = Task.load(TASK, [f"clearance={asks}"])
    answer = verified(task, motions()[0][0], method="m", solver="s")
    apart = answer.checked.apart
    assert apart is not None
    assert apart.kept == (asks != "{required: 0.4}")
    assert apart.level == ("points" if "false" in asks else "certified")
    assert ("NOT KEPT" in summary(task, answer)) == (not apart.kept)
    save_result(tmp_path / "r", task, answer)
    again = load_result(tmp_path / "r")[1].checked.apart
    assert again is not None
    assert (again.required, again.level, again.kept, again.worst, again.pairs, again.bound) == (
        apart.required, apart.level, apart.kept, apart.worst, apart.pairs, apart.bound
    )  # fmt: skip
    if apart.between is None:
        assert again.between is None
    else:
        np.testing.assert_allclose(again.between, apart.between)
        np.testing.assert_allclose(again.place, apart.place)
