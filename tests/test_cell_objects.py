"""Objects of a cell: bodies like links, and every mistake in one message."""

from __future__ import annotations

import pickle
from pathlib import Path

import coal
import numpy as np
import pinocchio as pin
import pytest

from dualarm_pin.cell import Cell
from dualarm_pin.cell.describe import describe
from dualarm_pin.cell.report_text import text_of
from dualarm_pin.errors import InputError
from dualarm_pin.files.resources import urdf_folder
from dualarm_pin.task import Task

NS16 = urdf_folder() / "ns16" / "ns16.urdf"
HEAD = f"""arms:
  arm1: {{urdf: {NS16}, tip: flange}}
  arm2: {{urdf: {NS16}, tip: flange, base: {{xyz: [2.5, 0, 0], rpy_deg: [0, 0, 180]}}}}
objects:
"""
ALL = """  table: {box: [0.6, 1.2, 0.05], at: {xyz: [1.25, 0, 0.225]}}
  part: {mesh: part.stl, scale: 0.001, on: arm1, at: {xyz: [0, 0, 0.06], rpy_deg: [0, 90, 0]}}
  torch: {cylinder: {radius: 0.03, length: 0.2}, on: arm2, at: {xyz: [0, 0, 0.1]}}
  pipe: {capsule: {radius: 0.05, length: 0.3}, on: arm1/link_3, at: {xyz: [0, 0, 0.5]}}
  lamp: {sphere: 0.1, on: arm2/base_link, at: {xyz: [0, 0.9, 1.0]}}
"""


def cube(side: float) -> bytes:
    """A cube as an STL file."""
    corners = np.array(list(np.ndindex(2, 2, 2)), dtype=float) * side - side / 2
    faces = [(0, 1, 3), (0, 3, 2), (4, 7, 5), (4, 6, 7), (0, 5, 1), (0, 4, 5), (2, 3, 7),
             (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)]  # fmt: skip
    record = np.zeros(12, [("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("rest", "<u2")])
    record["corners"] = corners[np.array(faces)]
    return b" " * 80 + np.uint32(12).tobytes() + record.tobytes()


def bracket() -> bytes:
    """Two plates 0.4 m apart as one STL file: its hull fills what lies between."""
    parts = []
    for x in (-0.2, 0.2):
        plate = np.frombuffer(
            cube(0.2)[84:], [("f0", "<f4", 3), ("f1", "<f4", (3, 3)), ("f2", "<u2")], 12
        ).copy()
        parts.append(plate)
        plate["f1"][:, :, 0] = plate["f1"][:, :, 0] * 0.1 + x
    return b" " * 80 + np.uint32(24).tobytes() + b"".join(part.tobytes() for part in parts)


def write(folder: Path, objects: str) -> Path:
    (folder / "part.stl").write_bytes(cube(100.0))
    (folder / "cell.yaml").write_text(HEAD + objects)
    return folder / "cell.yaml"


@pytest.fixture(scope="module")
def cell(tmp_path_factory: pytest.TempPathFactory) -> Cell:
    return Cell.load(write(tmp_path_factory.mktemp("objects"), ALL))


def body(cell: Cell, name: str) -> pin.GeometryObject:
    [found] = [each for each in cell.collision.geometryObjects if each.name == name]
    return found


def test_they_stand_where_the_file_says(cell: Cell) -> None:
    q = np.random.default_rng(0).uniform(cell.lower, cell.upper)
    data = cell.data()
    pin.framesForwardKinematics(cell.model, data, cell.model_q(q))
    turned = pin.SE3(pin.rpy.rpyToMatrix(0, np.pi / 2, 0), np.array([0, 0, 0.06]))
    wanted = {
        "table": pin.SE3(np.eye(3), np.array([1.25, 0, 0.225])),
        "part": data.oMf[cell.e1] * turned,
        "torch": data.oMf[cell.e2] * pin.SE3(np.eye(3), np.array([0, 0, 0.1])),
        "lamp": pin.SE3(np.diag([-1.0, -1, 1]), np.array([2.5, -0.9, 1.0])),
    }
    for name, pose in wanted.items():
        item = body(cell, name)
        assert (data.oMi[item.parentJoint] * item.placement).isApprox(pose, 1e-9), name
    assert isinstance(body(cell, "part").geometry, coal.ConvexBase)
    extent = np.array(body(cell, "part").geometry.points())
    np.testing.assert_allclose(np.ptp(extent, axis=0), 0.1)
    assert {each.name for each in cell.visual.geometryObjects} >= {"table", "lamp"}


def test_each_is_checked_against_all_that_moves_against_it(cell: Cell) -> None:
    with_part = {pair[0] if pair[1] == "part" else pair[1] for pair in cell.pairs if "part" in pair}
    assert with_part == set(cell.body_names) - {"part", "arm1/link_6"}
    assert ("arm1/base_link", "table") not in cell.pairs  # both stand still
    assert ("arm1/link_1", "table") in cell.pairs
    assert ("table", "lamp") not in cell.pairs


def test_what_an_arm_carries_counts_as_the_arm_between_the_arms(cell: Cell) -> None:
    task = Task.load(urdf_folder() / "tasks" / "paper_corner.yaml")
    from ns16_pair import motions

    q = motions()[0][0][0]
    bare, carrying = (c.clearance(q, between_arms=True) for c in (task.cell, cell))
    assert bare is not None
    assert carrying is not None
    assert carrying.distance < bare.distance
    assert {carrying.first, carrying.second} == {"part", "torch"}


def test_moved_bases_take_along_what_stands_on_them_alone(cell: Cell) -> None:
    base = pin.SE3(np.eye(3), np.array([3.0, 0.2, 0.0]))
    moved = cell.moved(base2=base)
    assert np.allclose(body(moved, "lamp").placement.translation, [3.0, 1.1, 1.0])
    assert np.allclose(body(moved, "table").placement.translation, [1.25, 0, 0.225])
    again = pickle.loads(pickle.dumps(moved))
    q = np.zeros(cell.n)
    np.testing.assert_allclose(again.distances(q), moved.distances(q), atol=1e-9)
    assert [thing.name for thing in again.objects] == ["table", "part", "torch", "pipe", "lamp"]


def test_check_lists_them(cell: Cell) -> None:
    text = text_of(describe(cell))
    assert "Objects (5):" in text
    assert "part: mesh part.stl on arm1 at (0, 0, 0.06) m, rpy (0, 90, 0) deg, extent" in text
    assert "table: box 0.6 x 1.2 x 0.05 m on world" in text


def test_a_task_keeps_them_from_any_folder(tmp_path: Path) -> None:
    write(tmp_path, ALL)
    (tmp_path / "task.yaml").write_text(
        "cell: cell.yaml\npath: {circle: {radius: 0.1, points: 5}}\n"
    )
    (tmp_path / "far").mkdir()
    (tmp_path / "far" / "again.yaml").write_text(Task.load(tmp_path / "task.yaml").as_yaml())
    again = Task.load(tmp_path / "far" / "again.yaml").cell
    assert {thing.name for thing in again.objects} == {"table", "part", "torch", "pipe", "lamp"}


def test_python_says_the_same(cell: Cell) -> None:
    at = pin.SE3(np.eye(3), np.array([1.25, 0, 0.225]))
    mine = Cell.from_urdf(NS16, NS16, objects={"table": {"box": (0.6, 1.2, 0.05), "at": at}})
    assert body(mine, "table").placement.isApprox(body(cell, "table").placement)


def test_a_part_may_touch_what_it_is_allowed_to(tmp_path: Path) -> None:
    deep = "  part: {box: [0.1, 0.1, 0.1], on: arm1, allow: [arm1/link_6, arm1/link_5]}\n"
    cell = Cell.load(write(tmp_path, deep))
    assert ("arm1/link_5", "part") not in cell.pairs


WRONG = {
    "no shape": ("{at: {xyz: [0, 0, 1]}}", "objects.x", "exactly one shape is expected: box"),
    "two shapes": ("{sphere: 1, box: [1, 1, 1]}", "objects.x", "given box, sphere"),
    "flat": ("{box: [1, 1, 0]}", "objects.x.box.2", "greater than 0"),
    "no mesh": ("{mesh: none.stl}", "objects.x.mesh", "no such file: none.stl"),
    "no suffix": ("{mesh: cell.yaml}", "objects.x.mesh", "convert it to STL, OBJ or DAE"),
    "scale": ("{sphere: 1, scale: 2}", "objects.x", "`scale` belongs to a mesh"),
    "nobody": ("{sphere: 0.1, on: arm1/link6}", "objects.x.on", "did you mean 'arm1/link_6'?"),
    "no neighbour": ("{sphere: 0.1, allow: [arm1]}", "objects.x.allow", "no other body 'arm1'"),
    "inside its hand": ("{sphere: 0.1, on: arm1}", "objects.x", "m inside arm1/link_6, which"),
    "in the way": (
        "{box: [1, 1, 1], on: arm1, at: {xyz: [0, 0, 0.2]}, allow: [arm1/link_6]}",
        "objects.x",
        "in nearly every posture",
    ),
    "unknown key": ("{sphere: 0.1, att: 1}", "objects.x.att", "did you mean 'at'"),
}  # fmt: skip


@pytest.mark.parametrize(("thing", "field", "message"), WRONG.values(), ids=WRONG)
def test_a_mistake_names_file_line_and_field(
    tmp_path: Path, thing: str, field: str, message: str
) -> None:
    with pytest.raises(InputError) as error:
        Cell.load(write(tmp_path, f"  x: {thing}\n"))
    assert message in str(error.value)
    assert error.value.field == field
    assert error.value.line == 5


@pytest.mark.parametrize("name", ["arm1", "world", "a/b", "a b"])
def test_a_name_that_would_be_taken_for_something_else_is_refused(
    tmp_path: Path, name: str
) -> None:
    with pytest.raises(InputError, match="cannot name an object"):
        Cell.load(write(tmp_path, f"  {name}: {{sphere: 0.1}}\n"))
