"""Searches for a placement: what is found, what is refused, what is written."""

from __future__ import annotations

import csv
import re
from dataclasses import replace

import numpy as np
import pytest
from paper_case import TASK

from dualarm_pin.answer.folder import load_result
from dualarm_pin.cell import Cell
from dualarm_pin.clearance.asked import asked_of
from dualarm_pin.cli import main
from dualarm_pin.errors import InputError
from dualarm_pin.placement.asked import Area, asked
from dualarm_pin.planners.placement import plan_placement
from dualarm_pin.planners.placement_map import maps_around
from dualarm_pin.planners.slide import slide
from dualarm_pin.planners.whole_path import plan_global
from dualarm_pin.show.placement import save_placement
from dualarm_pin.solvers import interior_point as engine
from dualarm_pin.task import Task
from dualarm_pin.task.moved import moved_task

BOX = {"base2.x": (1.4, 3.0), "base2.z": (-0.5, 0.5)}
SECTION = ["placement.base2.x=[1.4, 3.0]", "placement.base2.z=[-0.5, 0.5]"]


@pytest.fixture(scope="module")
def asked_task() -> Task:
    return Task.load(TASK, SECTION)


@pytest.fixture(scope="module")
def found(asked_task):
    return plan_placement(asked_task, seed=1)


def test_the_papers_base_is_found_again_from_any_seed(asked_task, found):
    assert found.trajectory.found
    assert found.trajectory.objective == pytest.approx(8.32838, abs=1e-5)
    base = found.task.cell.arms[1].base.translation
    assert base == pytest.approx([2.1030, 0.0, 0.0443], abs=1e-4)
    other = plan_placement(asked_task, seed=2)
    assert other.trajectory.objective == pytest.approx(found.trajectory.objective, abs=1e-7)


def test_every_place_is_a_minimum_on_the_moved_cell(asked_task, found):
    for place in found.places[:3]:
        moved = moved_task(asked_task, place.change)
        again = engine.solve(moved.problem(), place.q)
        assert again.objective == pytest.approx(place.objective, rel=1e-6)
        assert moved.problem().objective(place.q) == pytest.approx(place.objective, rel=1e-9)


def test_a_base_that_one_joint_turns_about_is_said_to_be_flat(task):
    may = asked(task.cell, BOX | {"base2.yaw": (np.pi / 2, 1.5 * np.pi)})
    assert plan_placement(task, may).flat == ("base2.yaw +1",)


def test_base_2_keeps_out_of_an_area_and_ends_at_its_edge(task):
    area = Area((2.0, 2.3), (-1.0, 1.0))
    may = asked(task.cell, BOX, keep_out=(area,))
    found = plan_placement(task, may)
    x = found.task.cell.arms[1].base.translation[0]
    assert found.trajectory.found
    assert not area.x[0] + 1e-6 < x < area.x[1] - 1e-6
    assert 8.3284 < found.trajectory.objective < 12.73


def test_workpiece_and_tool_move_in_the_task_that_comes_out(asked_task, tmp_path):
    change = {"base2.yaw": 0.2, "workpiece.x": 0.02, "workpiece.yaw": 0.3, "tool2.length": 0.04}
    moved = moved_task(asked_task, change)
    (tmp_path / "task.yaml").write_text(moved.as_yaml())
    read = Task.load(tmp_path / "task.yaml")
    assert read.placement is None
    assert read.path.position == pytest.approx(moved.path.position)
    assert read.path.rotation == pytest.approx(moved.path.rotation)
    q = np.random.default_rng(0).uniform(read.cell.lower, read.cell.upper, (31, 12))
    assert read.problem().objective(q) == pytest.approx(moved.problem().objective(q))
    assert read.problem().objective(q) != pytest.approx(asked_task.problem().objective(q))


def test_a_result_folder_holds_cell_motion_map_and_places(asked_task, found, tmp_path):
    maps = maps_around(asked_task, found, columns=3)
    save_placement(tmp_path, found, maps)
    task, trajectory = load_result(tmp_path)
    assert trajectory.objective == pytest.approx(task.problem().objective(trajectory.q))
    rows = list(csv.DictReader((tmp_path / "places.csv").open()))
    assert float(rows[0]["objective"]) == pytest.approx(found.places[0].objective)
    arrays = np.load(tmp_path / "map.npz")
    height = arrays["x_z_objective"]
    assert height.shape == (3, 3)
    assert np.nanmin(height) >= found.trajectory.objective - 1e-6
    files = {file.name for file in tmp_path.iterdir()}
    assert {"cell.yaml", "task.yaml", "result.json", "map.png", "map.svg"} <= files


def test_where_nothing_is_reached_the_nearest_place_that_is_stands_in_the_message(task):
    may = asked(task.cell, {"base2.x": (4.5, 5.0)})
    found = plan_placement(task, may)
    assert not found.trajectory.found
    assert "no place in these boxes" in found.trajectory.message
    said = re.search(r"the nearest found that does: base2\.x (\S+) m", found.trajectory.message)
    nearest = float(said[1])
    assert 3.0 < nearest < 4.5  # a motion is known at 3.0
    for x, reached in ((nearest - 1e-3, True), (nearest + 0.02, False)):
        there = moved_task(task, {"base2.x": x - 2.5})
        assert plan_global(there, effort="quick").found == reached


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ("placement.base2.x=[3, 1]", "lower bound 3 is not below"),
        ("placement.base2.q=[1, 3]", "base2.q"),
        ("placement.base2.x=[1, .inf]", "finite"),
        ("placement={keep_out: []}", "nothing is free"),
    ],
)
def test_a_wrong_section_is_refused_with_its_field(change, message):
    with pytest.raises(InputError, match=message):
        Task.load(TASK, [change])


def test_a_task_without_a_section_says_what_to_write(task):
    with pytest.raises(InputError, match="give the task a section"):
        plan_placement(replace(task, placement=None))
    with pytest.raises(InputError, match="leave no place"):
        asked(task.cell, BOX, keep_out=(Area((1.0, 4.0), (-2.0, 2.0)),))


def test_with_clearance_a_place_moves_on_and_its_bodies_stay_apart():
    task = Task.load(TASK, ["clearance=0.05", *SECTION])
    start = {"base2.x": -0.8, "base2.z": 0.3}
    there = plan_global(moved_task(task, start), effort="quick", seed=0, jobs=1)
    stand = slide(task, task.placement, start, there.q)
    assert stand.path.objective < 0.8 * there.objective
    assert -1.1 <= stand.change["base2.x"] <= 0.5
    assert -0.5 <= stand.change["base2.z"] <= 0.5
    required = asked_of(stand.task).required
    assert np.sum(required == 0.05) > 50
    for q in stand.path.q:  # measured by Coal where the bodies are then
        lack = required - stand.task.cell.distances(q)
        near = np.flatnonzero(lack > 5e-4)
        assert all(
            stand.task.cell.distance(q, int(k), exact=True) > required[k] - 5e-4 for k in near
        )
    value = stand.task.problem().objective(stand.path.q)
    assert value == pytest.approx(stand.path.objective, rel=1e-8)


def test_the_command_says_where_the_cell_that_it_writes_stands(tmp_path, capsys):
    # Held by its bodies, the place moves on from where it is best without clearance.
    out = tmp_path / "placed"
    change = ["clearance=0.05", "placement.base2.x=[1.4, 2.0]", "placement.base2.z=[-0.5, 0.5]"]
    given = [part for each in change for part in ("--set", each)]
    with pytest.raises(SystemExit) as end:
        main(["place", str(TASK), "--map", "0", "--out", str(out), *given])
    assert end.value.code == 0
    said = capsys.readouterr().out
    x, z = map(float, re.search(r"place +base2\.x (\S+) m, base2\.z (\S+) m", said).groups())
    base = Cell.load(out / "cell.yaml").arms[1].base.translation
    assert (x, z) == pytest.approx((base[0], base[2]), abs=1e-3)
    first = next(csv.DictReader((out / "places.csv").open()))
    assert abs(float(first["base2.x"]) + 2.5 - x) + abs(float(first["base2.z"]) - z) > 0.01
    assert "at a bound   base2.x: a wider box may hold a better place" in said
